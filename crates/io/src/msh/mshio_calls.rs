//! The two calls of mshio. Each gets one section that the guard has walked, behind a clean header.

use lie_mesh::Defect;
use mshio::{Elements, MshData, MshParserError, Nodes};

use super::source::{Encoding, Source};

/// Parses the body of `$Nodes`.
pub(super) fn nodes(
    source: Source,
    encoding: Encoding,
    body: &[u8],
) -> Result<Nodes<u64, i32, f64>, Defect> {
    let data = parse(source, encoding, "Nodes", body)?;
    data.nodes
        .ok_or_else(|| refused(source, "Nodes", "no section"))
}

/// Parses the body of `$Elements`.
pub(super) fn elements(
    source: Source,
    encoding: Encoding,
    body: &[u8],
) -> Result<Elements<u64, i32>, Defect> {
    let data = parse(source, encoding, "Elements", body)?;
    data.elements
        .ok_or_else(|| refused(source, "Elements", "no section"))
}

/// Only this section is handed on: mshio searches the end of others in quadratic time.
fn parse(
    source: Source,
    encoding: Encoding,
    section: &str,
    body: &[u8],
) -> Result<MshData<u64, i32, f64>, Defect> {
    let file = alone(encoding, section, body);
    match mshio::parse_msh_bytes(&file) {
        Ok(file) => Ok(file.data),
        Err(error) => Err(refused(source, section, &reason(&error))),
    }
}

/// A file with this section only.
fn alone(encoding: Encoding, section: &str, body: &[u8]) -> Vec<u8> {
    let format: &[u8] = match encoding {
        Encoding::Text => b"4.1 0 8\n",
        Encoding::LittleEndian => b"4.1 1 8\n\x01\0\0\0\n",
        Encoding::BigEndian => b"4.1 1 8\n\0\0\0\x01\n",
    };
    let begin = format!("$EndMeshFormat\n${section}\n");
    let end = format!("\n$End{section}\n");
    [
        b"$MeshFormat\n",
        format,
        begin.as_bytes(),
        body,
        end.as_bytes(),
    ]
    .concat()
}

fn refused(source: Source, section: &str, reason: &str) -> Defect {
    source.defect(
        format!("mshio refuses ${section}: {reason}"),
        "open the file in gmsh and save it again as MSH 4.1",
    )
}

/// The error without its hex dump, which would hold the rest of the file.
fn reason(error: &MshParserError<&[u8]>) -> String {
    let kinds: Vec<String> = error
        .filter_msh_errors()
        .map(|(_, kind)| kind.to_string())
        .collect();
    kinds.join(", in ")
}
