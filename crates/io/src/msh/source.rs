//! The bytes of a file, and how to say where in them something is wrong.

use kluft_mesh::Defect;

/// A file in memory under the name that messages give it.
#[derive(Clone, Copy)]
pub(super) struct MshSource<'a> {
    pub(super) name: &'a str,
    pub(super) bytes: &'a [u8],
}

/// How numbers stand in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

impl MshSource<'_> {
    /// Something about the file as a whole.
    pub(super) fn defect(&self, problem: impl Into<String>, remedy: &str) -> Defect {
        Defect::new(self.name, problem, remedy)
    }

    /// Something at a byte offset: its line in a text file, its byte in a binary one.
    pub(super) fn defect_at(
        &self,
        offset: usize,
        encoding: Encoding,
        problem: impl Into<String>,
    ) -> Defect {
        Defect::new(
            format!("{}, {}", self.name, self.position(offset, encoding)),
            problem,
            "the file is damaged or was not written by gmsh: write it again",
        )
    }

    fn position(&self, offset: usize, encoding: Encoding) -> String {
        let before = &self.bytes[..offset.min(self.bytes.len())];
        match encoding {
            Encoding::Text => format!("line {}", 1 + memchr::memchr_iter(b'\n', before).count()),
            _ => format!("byte {}", before.len()),
        }
    }
}

/// The white space of the format; the same set as mshio's.
pub(super) fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r' | b'\n')
}
