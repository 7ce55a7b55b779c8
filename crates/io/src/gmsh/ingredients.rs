//! All that a mesh is made of, as one sum.

use std::fmt::Write as _;
use std::path::Path;
use std::time::UNIX_EPOCH;

use super::attempts::Attempt;
use super::options::{Dimension, Meshing};
use super::review::{Review, folder_of, review};
use crate::fingerprint::{Fingerprint, fingerprint, fingerprint_of};

/// Begins what is summed; a change of how gmsh is called is another number.
const FORMAT: &str = "mesh 1";

/// The sum of the files that a geometry opens, the parameters, the order, the sizes, the ways to
/// try and the program itself. None if the geometry depends on more than that, or a file cannot be
/// read.
pub(super) fn sum(
    meshing: &Meshing,
    review: &Review,
    attempts: &[Attempt],
    program: &Path,
) -> Option<Fingerprint> {
    let files = files(meshing.geometry, review)?;
    let mut all = format!("{FORMAT}\n{}\n", program_identity(program)?);
    // Writing to a string cannot fail.
    let _ = writeln!(all, "order {}\n{attempts:?}", meshing.order);
    if meshing.dimension == Dimension::Surfaces {
        all.push_str("surfaces alone\n");
    }
    for (name, value) in meshing.parameters {
        let _ = writeln!(all, "parameter {name} {:x}", value.to_bits());
    }
    all.push_str(&files);
    if let Some(sizes) = meshing.sizes {
        let _ = writeln!(all, "sizes {:x}", fingerprint_of(sizes).ok()?);
    }
    Some(fingerprint(&all))
}

/// The sum of a geometry and the files that it opens. None if what it describes depends on more
/// than that, or a file cannot be read.
pub fn geometry_fingerprint(geometry: &Path) -> Option<Fingerprint> {
    // What it may do to the machine is judged where gmsh is to open it.
    files(geometry, &review(geometry, true)).map(|files| fingerprint(&files))
}

/// A line for each file that a geometry opens, with the sum of its bytes.
fn files(geometry: &Path, review: &Review) -> Option<String> {
    if review.depends_on_more {
        return None;
    }
    let folder = folder_of(geometry).canonicalize().ok()?;
    let mut opened: Vec<_> = review.opened.iter().collect();
    opened.sort();
    let mut all = String::new();
    for file in opened {
        // A body that moves as a whole keeps its mesh.
        let name = file.strip_prefix(&folder).unwrap_or(file);
        let _ = writeln!(all, "file {name:?} {:x}", fingerprint_of(file).ok()?);
    }
    Some(all)
}

/// Which gmsh it is: another version has another file.
fn program_identity(program: &Path) -> Option<String> {
    let file = program.canonicalize().ok()?;
    let about = file.metadata().ok()?;
    let changed = about.modified().ok()?.duration_since(UNIX_EPOCH).ok()?;
    Some(format!("{file:?} {} {changed:?}", about.len()))
}
