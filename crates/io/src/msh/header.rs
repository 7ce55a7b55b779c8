//! `$MeshFormat`: version and encoding.

use kluft_mesh::Defect;

use super::source::{Encoding, MshSource, is_space};

/// What kind of file this is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Format {
    /// MSH 4.1, which this reader knows.
    Current(Encoding),
    /// An older version that gmsh can convert.
    Older(f64),
}

const REMEDY: &str = "write it with gmsh: `gmsh GEO -3 -format msh41 -bin -o OUT.msh`";

/// Reads the head of the file; never looks beyond `$EndMeshFormat`.
pub(super) fn read(source: MshSource) -> Result<Format, Defect> {
    let start = source.bytes.iter().take_while(|&&b| is_space(b)).count();
    let bytes = &source.bytes[start..];
    if bytes.is_empty() {
        return Err(source.defect("the file is empty", REMEDY));
    }
    if bytes.starts_with(b"$NOD") && bytes.get(4).is_some_and(|&b| is_space(b)) {
        return Ok(Format::Older(1.0));
    }
    let body = bytes.strip_prefix(b"$MeshFormat").ok_or_else(|| {
        let problem = "this is not a gmsh mesh: it does not begin with $MeshFormat";
        source.defect(problem, REMEDY)
    })?;
    format_of(body).map_err(|problem| source.defect(problem, REMEDY))
}

fn format_of(body: &[u8]) -> Result<Format, String> {
    let (words, rest) = header_line(body).ok_or("$MeshFormat is cut off")?;
    let [version, kind, size] = words.as_slice() else {
        return Err(format!("$MeshFormat holds {} numbers, not 3", words.len()));
    };
    let number: f64 = version
        .parse()
        .map_err(|_| format!("`{version}` is not a version"))?;
    if (1.0..4.1).contains(&number) {
        return Ok(Format::Older(number));
    }
    match (number == 4.1, kind.as_str(), size.as_str()) {
        (false, ..) => Err(format!(
            "MSH version {version} is not known, only up to 4.1"
        )),
        (_, "0", "8") => Ok(Format::Current(Encoding::Text)),
        (_, "1", "8") => byte_order(rest).map(Format::Current),
        (_, "0" | "1", _) => Err(format!("the data size is {size}, not 8 bytes")),
        _ => Err(format!(
            "the file type is {kind}, neither 0 (text) nor 1 (binary)"
        )),
    }
}

/// The words of the line behind `$MeshFormat`, and the bytes behind its line break.
fn header_line(body: &[u8]) -> Option<(Vec<String>, &[u8])> {
    let first = memchr::memchr(b'\n', body)? + 1;
    let length = memchr::memchr(b'\n', &body[first..])?;
    let line = String::from_utf8_lossy(&body[first..first + length]);
    let words = line.split_ascii_whitespace().map(str::to_owned).collect();
    Some((words, &body[first + length + 1..]))
}

fn byte_order(rest: &[u8]) -> Result<Encoding, String> {
    match rest.first_chunk() {
        Some([1, 0, 0, 0]) => Ok(Encoding::LittleEndian),
        Some([0, 0, 0, 1]) => Ok(Encoding::BigEndian),
        _ => Err("the binary file does not tell its byte order".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_bytes(bytes: &[u8]) -> Result<Format, Defect> {
        read(MshSource { name: "t", bytes })
    }

    #[test]
    fn versions_and_encodings() {
        for (bytes, format) in [
            (
                &b"$MeshFormat\n4.1 0 8\n$End"[..],
                Format::Current(Encoding::Text),
            ),
            (
                b"$MeshFormat\r\n4.1 0 8\r\n",
                Format::Current(Encoding::Text),
            ),
            (
                b"$MeshFormat\n4.1 1 8\n\x01\0\0\0\n",
                Format::Current(Encoding::LittleEndian),
            ),
            (
                b"$MeshFormat\n4.1 1 8\n\0\0\0\x01\n",
                Format::Current(Encoding::BigEndian),
            ),
            (b"$MeshFormat\n2.2 1 8\n", Format::Older(2.2)),
            (b"$MeshFormat\n4 0 8\n", Format::Older(4.0)),
            (b"$NOD\n1\n", Format::Older(1.0)),
        ] {
            assert_eq!(read_bytes(bytes), Ok(format));
        }
    }

    #[test]
    fn headers_that_mshio_would_panic_on() {
        for (bytes, problem) in [
            (&b"$MeshFormat\n4.1 1 3\n\x01\0\0\0\n"[..], "data size is 3"),
            (
                b"$MeshFormat\n4.1 1 99999999999999999999999\n\x01\0\0\0\n",
                "data size",
            ),
            (b"$MeshFormat\n4.1 2 8\n", "file type is 2"),
            (b"$MeshFormat\n4.1 1 8\n\x01\x01\0\0\n", "byte order"),
            (b"$MeshFormat\n4.1 1 8\n\x01", "byte order"),
            (b"$MeshFormat\nnan 0 8\n", "version nan"),
            (b"$MeshFormat\n5 0 8\n", "version 5"),
            (b"$MeshFormat\n", "cut off"),
            (b" \n", "empty"),
            (b"solid", "not a gmsh mesh"),
        ] {
            let defect = read_bytes(bytes).expect_err("a defect");
            assert!(defect.problem.contains(problem), "{defect}");
        }
    }
}
