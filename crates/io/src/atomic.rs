//! Files that are either whole or absent, whatever interrupts the writing.

use std::ffi::OsString;
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

use kluft_mesh::Defect;

/// Code of a defect that is none of the input: a file could not be written.
pub const NOT_WRITTEN: &str = "a file could not be written";

/// Lets `fill` write a temporary file beside `path`, brings it to the disk, then renames it to
/// `path`.
///
/// A reader of `path` sees the former file or the whole new one. Upon failure the temporary file
/// is removed and the former file stays. The temporary file is made anew under a name that nobody
/// can foresee, so that no file and no link of others is ever written through. That the new name
/// outlasts a loss of power is promised by [`sync_folder`].
///
/// # Errors
/// With the code [`NOT_WRITTEN`], if the file cannot be written.
pub fn write_atomically(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), Defect> {
    replace(path, fill).map_err(|error| not_written(path, &error))
}

fn replace(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> io::Result<()> {
    let name = path.file_name().ok_or(io::ErrorKind::InvalidFilename)?;
    let mut prefix = OsString::from(".");
    prefix.push(name);
    prefix.push(".");
    // The same folder, because a rename is atomic only within one file system.
    let temporary = tempfile::Builder::new()
        .prefix(&prefix)
        .suffix(".tmp")
        .make_in(folder_of(path), |temporary| File::create_new(temporary))
        .map_err(|error| io::Error::from(error.kind()))?;
    let (file, temporary) = temporary.into_parts();
    let mut out = BufWriter::new(file);
    fill(&mut out)?;
    // A BufWriter that is dropped swallows the error of its last write.
    let file = out.into_inner().map_err(|error| error.into_error())?;
    // A rename may reach the disk before what the file holds.
    file.sync_all()?;
    temporary.persist(path).map_err(|error| error.error)
}

/// Brings the names of the files in a folder to the disk: once for all files that were written.
///
/// # Errors
/// With the code [`NOT_WRITTEN`], if the disk refuses.
pub fn sync_folder(folder: &Path) -> Result<(), Defect> {
    sync(folder).map_err(|error| not_written(folder, &error))
}

/// Other systems open no folders, and keep names by themselves.
fn sync(folder: &Path) -> io::Result<()> {
    if !cfg!(unix) {
        return Ok(());
    }
    match File::open(folder)?.sync_all() {
        // Some file systems of networks know no such thing.
        Err(error) if error.kind() == io::ErrorKind::InvalidInput => Ok(()),
        done => done,
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// A file that could not be written, with the code [`NOT_WRITTEN`].
pub(crate) fn not_written(path: &Path, error: &io::Error) -> Defect {
    defect(path, error).with_code(NOT_WRITTEN)
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
pub(crate) fn scratch_folder(test: &str) -> std::path::PathBuf {
    let folder = std::env::temp_dir().join(format!("kluft-io-{}-{test}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a scratch folder");
    folder
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::io::Write;

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

    #[test]
    fn a_path_without_a_folder_is_in_the_present_one() {
        assert_eq!(folder_of(Path::new("text")), Path::new("."));
        assert_eq!(folder_of(Path::new("a/text")), Path::new("a"));
    }

    #[cfg(unix)]
    #[test]
    fn links_and_files_of_others_are_not_written_through() {
        let folder = tempfile::tempdir().expect("a folder");
        let (precious, path) = (folder.path().join("precious"), folder.path().join("text"));
        fs::write(&precious, "precious").expect("written");
        for name in [".text.tmp", "text"] {
            std::os::unix::fs::symlink(&precious, folder.path().join(name)).expect("a link");
        }
        write_atomically(&path, |out| out.write_all(b"new")).expect("written");
        let read = |path: &Path| fs::read_to_string(path).expect("a text");
        assert_eq!(
            (read(&path), read(&precious)),
            ("new".into(), "precious".into())
        );
        assert!(fs::symlink_metadata(&path).expect("a file").is_file());
    }

    #[cfg(unix)]
    #[test]
    fn what_is_written_may_be_read_by_whom_the_user_lets() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().expect("a folder");
        let mode = |path: &Path| fs::metadata(path).expect("a file").permissions().mode();
        let (plain, path) = (folder.path().join("plain"), folder.path().join("text"));
        fs::write(&plain, "").expect("written");
        write_atomically(&path, |_| Ok(())).expect("written");
        assert_eq!(mode(&path), mode(&plain));
        sync_folder(folder.path()).expect("synced");
    }
}
