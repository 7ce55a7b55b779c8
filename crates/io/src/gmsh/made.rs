//! Whether what gmsh wrote is a mesh.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use kluft_mesh::{Defect, cell_defects};

use super::options::{Dimension, NOT_MESHED, WITHOUT_VOLUMES};
use crate::msh::{holds_elements, read_msh};

/// gmsh answers with success and a file also when it has found nothing to mesh, or when the disk is
/// full.
pub(super) fn check_made(
    made: &Path,
    (geometry, dimension): (&Path, Dimension),
    output: &Path,
) -> Result<(), Defect> {
    let place = geometry.display().to_string();
    if !made.exists() {
        let remedy = "remove `Exit` and `Abort` from the geometry";
        return Err(Defect::new(place, "gmsh wrote no mesh", remedy));
    }
    let end = end_of(made).map_err(|error| {
        let problem = format!("the mesh that gmsh made cannot be read: {error}");
        Defect::new(&place, problem, "check the permissions")
    })?;
    if is_cut_off(&end) {
        let problem = "the mesh file that gmsh wrote is cut off, as it is when a disk is full";
        let output = output.display();
        let remedy = format!("free some space where {output} goes, or write to another disk");
        return Err(Defect::new(place, problem, remedy).with_code(NOT_MESHED));
    }
    let (number, what, remedy) = match dimension {
        Dimension::Volumes => (
            3,
            "volume elements",
            "define a volume, and a `Physical Volume` if there are other physical groups",
        ),
        Dimension::Surfaces => (
            2,
            "surface elements",
            "give the fractures `Physical Surface`s",
        ),
    };
    if holds_elements(made, number).unwrap_or(false) {
        return Ok(());
    }
    let problem = format!("the mesh that gmsh made holds no {what}");
    let defect = Defect::new(place, problem, remedy);
    Err(match dimension {
        Dimension::Volumes => defect.with_code(WITHOUT_VOLUMES),
        Dimension::Surfaces => defect,
    })
}

/// Whether every cell has a volume of its own.
pub(super) fn check_cells(made: &Path) -> Result<(), Vec<Defect>> {
    let defects = cell_defects(&read_msh(made)?);
    if defects.is_empty() {
        Ok(())
    } else {
        Err(defects)
    }
}

/// The last bytes of a file.
fn end_of(path: &Path) -> io::Result<Vec<u8>> {
    const LENGTH: u64 = 64;
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(LENGTH)))?;
    let mut end = Vec::new();
    file.read_to_end(&mut end).map(|_| end)
}

/// Whether the last section of a file is not closed.
pub(super) fn is_cut_off(bytes: &[u8]) -> bool {
    let last_line = bytes.trim_ascii_end().rsplit(|&byte| byte == b'\n').next();
    !last_line.is_some_and(|line| line.starts_with(b"$End"))
}
