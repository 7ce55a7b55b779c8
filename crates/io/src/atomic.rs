//! Files that are either whole or absent, whatever interrupts the writing.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use kluft_mesh::Defect;

/// Lets `fill` write a temporary file beside `path`, then renames it to `path`.
///
/// A reader of `path` sees the former file or the whole new one. Upon failure the temporary file
/// is removed and the former file stays.
pub fn write_atomically(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), Defect> {
    let temporary = temporary_name(path).map_err(|error| defect(path, &error))?;
    fill_file(&temporary, fill)
        .and_then(|()| fs::rename(&temporary, path))
        .map_err(|error| {
            // The first error is the one to report; the temporary file may not even exist.
            let _ = fs::remove_file(&temporary);
            defect(path, &error)
        })
}

fn fill_file(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> io::Result<()> {
    let mut out = BufWriter::new(File::create(path)?);
    fill(&mut out)?;
    // A BufWriter that is dropped swallows the error of its last write.
    out.flush()
}

/// The same folder, because a rename is atomic only within one file system.
fn temporary_name(path: &Path) -> io::Result<PathBuf> {
    let name = path.file_name().ok_or(io::ErrorKind::InvalidFilename)?;
    let mut temporary = std::ffi::OsString::from(".");
    temporary.push(name);
    temporary.push(".tmp");
    Ok(path.with_file_name(temporary))
}

fn defect(path: &Path, error: &io::Error) -> Defect {
    let remedy = match error.kind() {
        io::ErrorKind::NotFound => "create the folder first, or name another output folder",
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            "name an output folder you may write to"
        }
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "free some space, or name an output folder on another disk"
        }
        io::ErrorKind::IsADirectory => "a folder has this name: rename it, or name another output",
        _ => "check that the output folder exists, may be written to and has room",
    };
    Defect::new(
        path.display().to_string(),
        format!("cannot be written: {error}"),
        remedy,
    )
}

/// A folder of one test, which removes it when it passes.
#[cfg(test)]
pub(crate) fn scratch_folder(test: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("kluft-io-{}-{test}", std::process::id()));
    fs::create_dir_all(&folder).expect("a scratch folder");
    folder
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        fs::read_dir(folder)
            .expect("a folder")
            .map(|entry| entry.expect("an entry").file_name().display().to_string())
            .collect()
    }

    #[test]
    fn replaces_the_former_file_and_leaves_nothing_else() {
        let folder = scratch_folder("replace");
        let path = folder.join("text");
        for text in ["former", "new"] {
            write_atomically(&path, |out| out.write_all(text.as_bytes())).expect("written");
        }
        assert_eq!(fs::read_to_string(&path).expect("a text"), "new");
        assert_eq!(names(&folder), ["text"]);
        fs::remove_dir_all(folder).expect("removed");
    }

    #[test]
    fn a_failure_keeps_the_former_file_and_names_the_path() {
        let folder = scratch_folder("failure");
        let path = folder.join("text");
        write_atomically(&path, |out| out.write_all(b"former")).expect("written");
        let defect = write_atomically(&path, |out| {
            out.write_all(b"half")?;
            Err(io::ErrorKind::StorageFull.into())
        })
        .expect_err("a failure");
        assert_eq!(defect.place, path.display().to_string());
        assert!(defect.remedy.contains("space"), "{}", defect.remedy);
        assert_eq!(fs::read_to_string(&path).expect("a text"), "former");
        assert_eq!(names(&folder), ["text"]);
        fs::remove_dir_all(folder).expect("removed");
    }

    #[test]
    fn a_missing_folder_is_a_defect() {
        let path = std::env::temp_dir().join("kluft-io-no-such-folder/file");
        let defect = write_atomically(&path, |_| Ok(())).expect_err("a failure");
        assert!(defect.remedy.contains("create the folder"));
    }

    #[test]
    fn a_path_without_a_name_is_a_defect() {
        assert!(write_atomically(Path::new("/"), |_| Ok(())).is_err());
    }
}
