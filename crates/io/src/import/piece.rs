//! Reads the one piece of an unstructured grid of VTK (.vtu).

use std::error::Error;
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

/// A file that the reader of VTK does not take.
fn foreign(path: &Path, reason: &str) -> Vec<Defect> {
    let problem = format!("is no file that the VTK reader understands: {reason}");
    let remedy = "write it again as .vtu, from ParaView or meshio; one that is cut off: copy it \
                  again";
    vec![Defect::new(path.display().to_string(), problem, remedy)]
}

/// Reads the piece of a file.
///
/// # Errors
/// If the file cannot be read, or holds no unstructured grid of one piece.
pub(super) fn read_piece(path: &Path) -> Result<UnstructuredGridPiece, Vec<Defect>> {
    let bytes = bytes_of(path).map_err(|defect| vec![defect])?;
    if !is_plain(&bytes) {
        return Err(unread(path, "its tags are none of a grid's".to_owned()));
    }
    // What is damaged may be more than the reader checks.
    let read = std::panic::catch_unwind(|| load(path, &bytes));
    read.unwrap_or_else(|_| Err(foreign(path, "it is damaged")))
}

/// Lets VTK's reader read the piece of a file that holds these bytes.
fn load(path: &Path, bytes: &[u8]) -> Result<UnstructuredGridPiece, Vec<Defect>> {
    let read = Vtk::import(path).map_err(|error| foreign(path, &reason(bytes, &error)))?;
    let DataSet::UnstructuredGrid { pieces, .. } = read.data else {
        return Err(unread(path, "it holds no unstructured grid".to_owned()));
    };
    let mut pieces = pieces.into_iter();
    let (Some(piece), None) = (pieces.next(), pieces.next()) else {
        return Err(unread(path, "it holds several pieces, or none".to_owned()));
    };
    let piece = piece.into_loaded_piece_data(Some(path));
    piece.map_err(|error| foreign(path, &in_short(&error)))
}

/// Why the reader does not take a file of these bytes.
fn reason(bytes: &[u8], error: &dyn Error) -> String {
    let has = |tag: &str| memmem::find(bytes, tag.as_bytes()).is_some();
    match (has("<VTKFile"), has("</VTKFile>")) {
        (false, _) => "it has no <VTKFile>".to_owned(),
        (true, false) => "it is cut off, </VTKFile> is missing".to_owned(),
        (true, true) => in_short(error),
    }
}

/// The innermost reason of an error, on one line that is not long.
fn in_short(error: &dyn Error) -> String {
    const LONGEST: usize = 100;
    let mut inner = error;
    while let Some(source) = inner.source() {
        inner = source;
    }
    let text = inner.to_string();
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let end = text.char_indices().nth(LONGEST).map(|(end, _)| end);
    match end {
        Some(end) => format!("{}...", &text[..end]),
        None => text,
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = r#"type="UnstructuredGrid" version="0.1" byte_order="LittleEndian""#;

    fn told(name: &str, files: &[(&str, &str)]) -> String {
        let folder = tempfile::tempdir().expect("a folder");
        for (name, text) in files {
            std::fs::write(folder.path().join(name), text).expect("written");
        }
        let defects = read_piece(&folder.path().join(name)).expect_err("no grid");
        defects[0].to_string()
    }

    #[test]
    fn what_the_reader_does_not_understand_is_told_in_words() {
        let cut = format!("<VTKFile {HEAD}>\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"4\"");
        let crossed = format!("<VTKFile {HEAD}><UnstructuredGrid></Piece></VTKFile>");
        let other = format!("<VTKFile {HEAD}>{}</VTKFile>", "words ".repeat(100));
        for (text, reason) in [
            ("no grid at all", "it has no <VTKFile>"),
            ("", "it has no <VTKFile>"),
            (&cut, "it is cut off"),
            (&crossed, ""),
            (&other, ""),
        ] {
            let told = told("a.vtu", &[("a.vtu", text)]);
            let problem = format!("is no file that the VTK reader understands: {reason}");
            for part in [&problem[..], "ParaView or meshio", "copy it again"] {
                assert!(told.contains(part), "{part}: {told}");
            }
            for raw in ["XML error", "Custom(", "InvalidXml(", "IllFormed("] {
                assert!(!told.contains(raw), "{raw}: {told}");
            }
            assert!(told.len() < 500, "{told}");
        }
    }

    #[test]
    fn damage_in_a_file_that_is_named_is_a_defect_too() {
        let parallel = r#"<VTKFile type="PUnstructuredGrid" version="1.0" byte_order="LittleEndian">
  <PUnstructuredGrid GhostLevel="1">
    <PPoints>
      <PDataArray type="Float32" Name="Points" NumberOfComponents="3"/>
    </PPoints>
    <Piece Source="b.vtu"/>
  </PUnstructuredGrid>
</VTKFile>"#;
        let pointless = format!(
            "<VTKFile {HEAD}><UnstructuredGrid><Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"/>\
             </UnstructuredGrid></VTKFile>"
        );
        let told = told("a.pvtu", &[("a.pvtu", parallel), ("b.vtu", &pointless)]);
        assert!(told.contains("understands: it is damaged"), "{told}");
    }
}
