//! ParaView collections: the files of a sequence of steps, each with its time.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use kluft_mesh::Defect;

use crate::atomic::write_atomically;
use crate::xml::escape;

/// Writes a `.pvd` that lists `entries`: a time, and a file name relative to the folder of `path`.
///
/// Writes to a temporary name beside `path`, then renames.
///
/// # Panics
/// When a time is not finite: an error of the caller.
pub fn write_pvd(path: &Path, entries: &[(f64, String)]) -> Result<(), Defect> {
    for (time, file) in entries {
        assert!(time.is_finite(), "the time of {file} is {time}");
    }
    write_atomically(path, |out| write_collection(out, entries))
}

fn write_collection(out: &mut BufWriter<File>, entries: &[(f64, String)]) -> io::Result<()> {
    writeln!(out, r#"<?xml version="1.0" encoding="UTF-8"?>"#)?;
    writeln!(out, r#"<VTKFile type="Collection" version="0.1">"#)?;
    writeln!(out, "  <Collection>")?;
    for (time, file) in entries {
        let file = escape(file);
        writeln!(
            out,
            r#"    <DataSet timestep="{time}" part="0" file="{file}"/>"#
        )?;
    }
    writeln!(out, "  </Collection>")?;
    writeln!(out, "</VTKFile>")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::atomic::scratch_folder;
    use std::fs;

    #[test]
    fn lists_every_step_with_its_exact_time() {
        let folder = scratch_folder("pvd");
        let path = folder.join("rock.pvd");
        let third = 1.0 / 3.0;
        let entries = [(0.25, "a.vtu".to_owned()), (third, "b<&>\".vtu".to_owned())];
        write_pvd(&path, &entries).expect("written");
        let text = fs::read_to_string(&path).expect("a text");
        assert!(text.contains(r#"timestep="0.25" part="0" file="a.vtu""#));
        assert!(text.contains(&format!(r#"timestep="{third}""#)));
        assert!(text.contains(r#"file="b&lt;&amp;&gt;&quot;.vtu""#));
        fs::remove_dir_all(folder).expect("removed");
    }
}
