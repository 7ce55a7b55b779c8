//! Ordinary files: a pipe or a device could let one wait, or read, for ever.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

/// Opens a file to read it.
///
/// # Errors
/// If it cannot be opened, or is a folder, a pipe or a device.
pub fn open_ordinary(path: &Path) -> io::Result<File> {
    let about = fs::metadata(path)?;
    if about.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    if !about.is_file() {
        let problem = "it is no ordinary file (a pipe or a device)";
        return Err(io::Error::other(problem));
    }
    File::open(path)
}

/// The text of a file.
///
/// # Errors
/// As [`open_ordinary`]; if it cannot be read, or is not UTF-8.
pub fn ordinary_text(path: &Path) -> io::Result<String> {
    io::read_to_string(open_ordinary(path)?)
}

/// The bytes of a file.
///
/// # Errors
/// As [`open_ordinary`]; if it cannot be read.
pub fn ordinary_bytes(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open_ordinary(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}
