//! Reads the one piece of an unstructured grid of VTK (.vtu).

use std::path::Path;

use kluft_mesh::Defect;
use memchr::memmem;
use vtkio::model::{DataSet, UnstructuredGridPiece, Vtk};

use crate::msh::bytes_of;

/// A grid that cannot be used.
pub(super) fn unread(path: &Path, problem: String) -> Vec<Defect> {
    let remedy = "write it as an XML file of one unstructured grid, uncompressed or with zlib \
                  (ParaView: Save Data, .vtu)";
    vec![Defect::new(path.display().to_string(), problem, remedy)]
}

/// Reads the piece of a file.
///
/// # Errors
/// If the file cannot be read, or holds no unstructured grid of one piece.
pub(super) fn read_piece(path: &Path) -> Result<UnstructuredGridPiece, Vec<Defect>> {
    let unread = |problem: String| unread(path, problem);
    let bytes = bytes_of(path).map_err(|defect| vec![defect])?;
    if !is_plain(&bytes) {
        return Err(unread("its tags are none of a grid's".to_owned()));
    }
    // What is damaged may be more than the reader checks.
    let read = std::panic::catch_unwind(|| Vtk::import(path));
    let read = read.map_err(|_| unread("cannot be read: it is damaged".to_owned()))?;
    let read = read.map_err(|error| unread(format!("cannot be read: {error}")))?;
    let DataSet::UnstructuredGrid { pieces, .. } = read.data else {
        return Err(unread("it holds no unstructured grid".to_owned()));
    };
    let mut pieces = pieces.into_iter();
    let (Some(piece), None) = (pieces.next(), pieces.next()) else {
        return Err(unread("it holds several pieces, or none".to_owned()));
    };
    let piece = piece.into_loaded_piece_data(Some(path));
    piece.map_err(|error| unread(format!("cannot be read: {error}")))
}

/// Whether no tag has more attributes than those of a grid have, or name spaces: the reader takes
/// long over many.
fn is_plain(bytes: &[u8]) -> bool {
    const MOST: usize = 40;
    let tags = match memmem::find(bytes, b"<AppendedData") {
        // Behind it raw bytes may follow.
        Some(end) => &bytes[..end],
        None => bytes,
    };
    let mut tags = tags.split(|byte| *byte == b'<');
    tags.all(|tag| {
        let tag = tag.split(|byte| *byte == b'>').next().unwrap_or_default();
        let attributes = memchr::memchr_iter(b'=', tag).take(MOST + 1).count();
        attributes <= MOST && memmem::find(tag, b"xmlns").is_none()
    })
}
