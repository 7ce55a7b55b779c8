//! Where the sections of a file begin and end.

use std::ops::Range;

use kluft_mesh::Defect;

use super::source::{Encoding, MshSource, is_space};

/// The body of one `$Name` ... `$EndName` section.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct MshSection {
    pub(super) name: String,
    /// From behind the line break of `$Name` up to the `$` of `$EndName`.
    pub(super) body: Range<usize>,
}

/// Sections that a file may hold only once.
const UNIQUE: [&str; 6] = [
    "MeshFormat",
    "PhysicalNames",
    "Entities",
    "PartitionedEntities",
    "Nodes",
    "Elements",
];

/// All sections in file order. Only white space may stand between them.
pub(super) fn split(source: MshSource) -> Result<Vec<MshSection>, Defect> {
    let mut sections = Vec::new();
    let mut at = skip_space(source.bytes, 0);
    while at < source.bytes.len() {
        let (section, end) = section_at(source, at)?;
        sections.push(section);
        at = skip_space(source.bytes, end);
    }
    check_unique(source, &sections)?;
    Ok(sections)
}

/// The section of that name, or a defect that says it is missing.
pub(super) fn required<'s>(
    source: MshSource,
    sections: &'s [MshSection],
    name: &str,
) -> Result<&'s MshSection, Defect> {
    optional(sections, name).ok_or_else(|| {
        let remedy = "write the file again, with the mesh: `gmsh GEO -3 -format msh41 -o OUT.msh`";
        source.defect(format!("there is no ${name} section"), remedy)
    })
}

/// The section of that name.
pub(super) fn optional<'s>(sections: &'s [MshSection], name: &str) -> Option<&'s MshSection> {
    sections.iter().find(|section| section.name == name)
}

fn check_unique(source: MshSource, sections: &[MshSection]) -> Result<(), Defect> {
    let occurs = |name: &str| sections.iter().filter(|s| s.name == name).count();
    match UNIQUE.iter().find(|name| occurs(name) > 1) {
        None => Ok(()),
        Some(name) => Err(source.defect(
            format!("there are {} ${name} sections", occurs(name)),
            "merge the meshes in gmsh and write one file",
        )),
    }
}

/// The section whose `$` is at `at`, and the offset behind its end marker.
fn section_at(source: MshSource, at: usize) -> Result<(MshSection, usize), Defect> {
    let (name, name_end) = section_name(source, at)?;
    let line_end = memchr::memchr(b'\n', &source.bytes[name_end..])
        .map_or(source.bytes.len(), |length| name_end + length + 1);
    let end = find_marker(source.bytes, line_end, &format!("$End{name}")).ok_or_else(|| {
        let problem = format!("the section ${name} has no $End{name}: the file is cut off");
        source.defect_at(at, Encoding::Text, problem)
    })?;
    let marker_end = end + "$End".len() + name.len();
    let body = line_end..end;
    Ok((MshSection { name, body }, marker_end))
}

fn section_name(source: MshSource, at: usize) -> Result<(String, usize), Defect> {
    let rest = &source.bytes[at..];
    let length = rest.iter().position(|&b| is_space(b)).unwrap_or(rest.len());
    let name = rest[..length].strip_prefix(b"$").unwrap_or_default();
    if name.is_empty() || name.starts_with(b"End") || !name.iter().all(u8::is_ascii_alphanumeric) {
        let problem = "expected a section such as $Nodes here";
        return Err(source.defect_at(at, Encoding::Text, problem));
    }
    Ok((String::from_utf8_lossy(name).into_owned(), at + length))
}

/// A physical name may hold the marker. Elsewhere binary data may stand right before it, so only
/// there it must begin a line.
fn find_marker(bytes: &[u8], from: usize, marker: &str) -> Option<usize> {
    let anywhere = marker != "$EndPhysicalNames";
    let begins = |at: usize| anywhere || bytes[..at].last() == Some(&b'\n');
    let ends = |at: usize| {
        bytes
            .get(at + marker.len())
            .is_none_or(|&byte| is_space(byte))
    };
    memchr::memmem::find_iter(&bytes[from..], marker)
        .map(|at| from + at)
        .find(|&at| begins(at) && ends(at))
}

fn skip_space(bytes: &[u8], from: usize) -> usize {
    let rest = &bytes[from..];
    from + rest.iter().take_while(|&&byte| is_space(byte)).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split_text(text: &str) -> Result<Vec<MshSection>, Defect> {
        let bytes = text.as_bytes();
        split(MshSource { name: "t", bytes })
    }

    #[test]
    fn bodies_lie_between_their_markers() {
        let text = "$A\n1 2\n$EndA\r\n\n$Nodes \n3\n$EndNodesX\n$EndNodes";
        let sections = split_text(text).expect("well formed");
        let bodies: Vec<&str> = sections.iter().map(|s| &text[s.body.clone()]).collect();
        assert_eq!(bodies, ["1 2\n", "3\n$EndNodesX\n"]);
    }

    #[test]
    fn stray_text_and_open_or_repeated_sections_are_defects() {
        for (text, problem) in [
            ("$A\n$EndA\n5\n", "expected a section"),
            ("$EndA\n", "expected a section"),
            ("$Nodes\n1\n", "no $EndNodes"),
            ("$Nodes\n$EndNodes\n$Nodes\n$EndNodes\n", "2 $Nodes"),
            ("$Nodes", "no $EndNodes"),
            ("$", "expected a section"),
        ] {
            let defect = split_text(text).expect_err(text);
            assert!(defect.problem.contains(problem), "{text:?}: {defect}");
        }
    }
}
