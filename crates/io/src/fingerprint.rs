//! Sums by which files and texts are known again.

use std::io::{self, BufReader, Write};
use std::path::Path;

use kluft_defect::open_ordinary;
use kluft_mesh::Defect;
use twox_hash::XxHash3_128;

/// A sum over some bytes (XXH3, 128 bits): equal for equal bytes, and for others never in practice.
pub type Fingerprint = u128;

/// Sum of a file's bytes.
///
/// # Errors
/// If the file cannot be read, or is no ordinary one.
pub fn fingerprint_of(path: &Path) -> Result<Fingerprint, Defect> {
    let sum = || -> io::Result<Fingerprint> {
        let mut file = BufReader::with_capacity(1 << 18, open_ordinary(path)?);
        let mut out = SumWriter::new(io::sink());
        io::copy(&mut file, &mut out)?;
        Ok(out.finish())
    };
    sum().map_err(|error| {
        let place = path.display().to_string();
        let problem = format!("the file cannot be read: {error}");
        Defect::new(place, problem, "check the path and the permissions")
    })
}

/// Sum of a text.
pub fn fingerprint(text: &str) -> Fingerprint {
    XxHash3_128::oneshot(text.as_bytes())
}

/// A writer that sums up what passes through it.
pub(crate) struct SumWriter<W> {
    out: W,
    sum: XxHash3_128,
}

impl<W: Write> SumWriter<W> {
    pub(crate) fn new(out: W) -> Self {
        let sum = XxHash3_128::new();
        Self { out, sum }
    }

    /// The sum of all that was written.
    pub(crate) fn finish(self) -> Fingerprint {
        self.sum.finish_128()
    }
}

impl<W: Write> Write for SumWriter<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.out.write(bytes)?;
        self.sum.write(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_has_the_sum_of_its_bytes() {
        let mut out = SumWriter::new(Vec::new());
        write!(out, "a{}", "b".repeat(9999)).expect("written");
        let text = format!("a{}", "b".repeat(9999));
        assert_eq!(out.out, text.as_bytes());
        assert_eq!(out.finish(), fingerprint(&text));
    }

    #[test]
    fn a_file_has_the_sum_of_its_text() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("text");
        let text = "0123456789".repeat(100_000);
        std::fs::write(&path, &text).expect("written");
        assert_eq!(fingerprint_of(&path).expect("a sum"), fingerprint(&text));
        assert!(fingerprint_of(&folder.path().join("none")).is_err());
    }
}
