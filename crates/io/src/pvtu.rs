//! Unstructured grids that several files hold together, piece by piece.

use std::io::{self, Write};
use std::path::Path;

use kluft_mesh::Defect;

use crate::atomic::write_atomically;
use crate::vtu::{Field, Grid, Values};

/// Writes a `.pvtu` that lists `pieces`, file names relative to the folder of `path`; all of them
/// have the fields of `grid`. Writes to a temporary name beside `path`, then renames.
///
/// # Errors
/// If the file cannot be written.
pub fn write_pvtu(path: &Path, grid: &Grid, pieces: &[String]) -> Result<(), Defect> {
    write_atomically(path, |out| {
        writeln!(out, r#"<?xml version="1.0" encoding="UTF-8"?>"#)?;
        writeln!(
            out,
            r#"<VTKFile type="PUnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">"#
        )?;
        writeln!(out, r#"  <PUnstructuredGrid GhostLevel="0">"#)?;
        fields(out, "PPointData", &grid.point_fields)?;
        fields(out, "PCellData", &grid.cell_fields)?;
        writeln!(out, "    <PPoints>")?;
        array(out, "Float64", "Points", 3)?;
        writeln!(out, "    </PPoints>")?;
        for piece in pieces {
            writeln!(out, r#"    <Piece Source="{piece}"/>"#)?;
        }
        writeln!(out, "  </PUnstructuredGrid>")?;
        writeln!(out, "</VTKFile>")
    })
}

fn fields(out: &mut impl Write, element: &str, fields: &[Field]) -> io::Result<()> {
    writeln!(out, "    <{element}>")?;
    for field in fields {
        let kind = match field.values {
            Values::Real(_) => "Float64",
            Values::Integer(_) => "Int32",
        };
        array(out, kind, field.name, field.components)?;
    }
    writeln!(out, "    </{element}>")
}

fn array(out: &mut impl Write, kind: &str, name: &str, components: u32) -> io::Result<()> {
    writeln!(
        out,
        r#"      <PDataArray type="{kind}" Name="{name}" NumberOfComponents="{components}"/>"#
    )
}
