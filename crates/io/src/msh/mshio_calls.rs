//! The two calls of mshio. Each gets what the guard has walked, behind a clean header: the section
//! of nodes, or a range of a block of elements in a text file, many of which can be read at the
//! same time.

use kluft_mesh::Defect;
use mshio::{Element, ElementType, MshData, MshParserError, Nodes};

use super::cursor::ItemRange;
use super::source::{Encoding, MshSource};

/// Parses the body of `$Nodes`.
pub(super) fn nodes(
    source: MshSource,
    encoding: Encoding,
    body: &[u8],
) -> Result<Nodes<u64, i32, f64>, Defect> {
    let data = parse(source, encoding, "Nodes", body)?;
    data.nodes
        .ok_or_else(|| refused(source, "Nodes", "no section"))
}

/// Parses elements of one type in a text file, as many as the guard has counted.
pub(super) fn elements(
    source: MshSource,
    kind: ElementType,
    range: &ItemRange,
) -> Result<Vec<Element<u64>>, Defect> {
    let body = lone_block(source, kind, range);
    let data = parse(source, Encoding::Text, "Elements", &body)?;
    let blocks = data.elements.map(|section| section.element_blocks);
    match blocks.unwrap_or_default().pop() {
        Some(block) if block.elements.len() == range.count => Ok(block.elements),
        _ => Err(refused(source, "Elements", "another number of elements")),
    }
}

/// The body of a section with this range for its only block. Only the type and the number of the
/// elements matter.
fn lone_block(source: MshSource, kind: ElementType, range: &ItemRange) -> Vec<u8> {
    let kind = match kind {
        // mshio takes the 18-node prism for one of 28 nodes; this is another type of 18 nodes.
        ElementType::Pri18 => ElementType::Tri18,
        kind => kind,
    };
    let (kind, count) = (kind as i32, range.count);
    // Blocks, elements, lowest and highest tag: with the true tags, mshio would index sparse ones.
    let mut body = format!("1 {count} 1 {count} 3 1 {kind} {count} ").into_bytes();
    body.extend_from_slice(&source.bytes[range.bytes.clone()]);
    body
}

/// Only this section is handed on: mshio searches the end of others in quadratic time.
fn parse(
    source: MshSource,
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

fn refused(source: MshSource, section: &str, reason: &str) -> Defect {
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
