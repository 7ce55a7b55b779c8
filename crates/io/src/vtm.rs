//! Multi-block files of VTK: several grids that are opened together, each with a name.

use std::io::Write;
use std::path::Path;

use kluft_mesh::Defect;

use crate::atomic::write_atomically;
use crate::xml::escape;

/// Writes a `.vtm` of blocks: a name, and a file relative to the folder of `path`.
///
/// # Errors
/// If the file cannot be written.
pub fn write_vtm(path: &Path, blocks: &[(&str, &str)]) -> Result<(), Defect> {
    write_atomically(path, |out| {
        writeln!(out, r#"<?xml version="1.0" encoding="UTF-8"?>"#)?;
        writeln!(
            out,
            r#"<VTKFile type="vtkMultiBlockDataSet" version="1.0">"#
        )?;
        writeln!(out, "  <vtkMultiBlockDataSet>")?;
        for (index, (name, file)) in blocks.iter().enumerate() {
            let (name, file) = (escape(name), escape(file));
            writeln!(
                out,
                r#"    <DataSet index="{index}" name="{name}" file="{file}"/>"#
            )?;
        }
        writeln!(out, "  </vtkMultiBlockDataSet>")?;
        writeln!(out, "</VTKFile>")
    })
}
