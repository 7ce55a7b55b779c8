//! The file of a scene: where it may be, and how it gets there.

use std::fs::File;
use std::io::{self, ErrorKind, Write};
use std::path::Path;

use kluft_io::NOT_WRITTEN;
use kluft_mesh::Defect;

use crate::input::is_named_otherwise;
use crate::printing::shell_path;

/// Refuses a name that is no scene's, or that is there already.
///
/// # Errors
/// What the file is or would be.
pub fn check_place(file: &Path) -> Result<(), Defect> {
    if is_named_otherwise(file) {
        let named = shell_path(&file.with_extension("toml"));
        return Err(Defect::new(
            file.display().to_string(),
            "a file of this name is no scene",
            format!("let the name end in .toml: --out {named}"),
        ));
    }
    match std::fs::symlink_metadata(file).is_ok() {
        true => Err(there_already(file)),
        false => Ok(()),
    }
}

/// Writes a file, whole or not at all, that is not there, not even since it was looked for.
///
/// # Errors
/// If it is there; if it cannot be written, with the code [`NOT_WRITTEN`] where neither the place
/// nor the name is to blame.
pub fn write(file: &Path, text: &str) -> Result<(), Defect> {
    create(file, text).map_err(|error| not_written(file, &error))
}

fn create(file: &Path, text: &str) -> io::Result<()> {
    let folder = file.parent().filter(|folder| *folder != Path::new(""));
    let folder = folder.unwrap_or(Path::new("."));
    let mut unfinished = tempfile::Builder::new()
        .prefix(".kluft-init.")
        .suffix(".tmp")
        .make_in(folder, |path| File::create_new(path))
        .map_err(|error| io::Error::from(error.kind()))?;
    unfinished.write_all(text.as_bytes())?;
    unfinished.as_file().sync_all()?;
    let placed = unfinished.persist_noclobber(file);
    placed.map(drop).map_err(|error| error.error)
}

fn not_written(file: &Path, error: &io::Error) -> Defect {
    let place = file.display().to_string();
    let problem = format!("cannot be written: {error}");
    match error.kind() {
        ErrorKind::AlreadyExists => there_already(file),
        ErrorKind::NotFound | ErrorKind::NotADirectory => {
            let remedy = "create the folder first, or name a file in another one with --out";
            Defect::new(place, "there is no such folder to write it in", remedy)
        }
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            let remedy = "choose a folder that you may write to: --out FOLDER/scene.toml";
            Defect::new(place, problem, remedy)
        }
        ErrorKind::InvalidFilename | ErrorKind::IsADirectory => {
            Defect::new(place, problem, "name another file with --out")
        }
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            let remedy = "make room, or name a file on another disk with --out";
            Defect::new(place, problem, remedy).with_code(NOT_WRITTEN)
        }
        _ => {
            let remedy = "check the limits and the disk, or name a file elsewhere with --out";
            Defect::new(place, problem, remedy).with_code(NOT_WRITTEN)
        }
    }
}

fn there_already(file: &Path) -> Defect {
    let (problem, remedy) = match file.is_dir() {
        true => (
            "this is a folder",
            "name a file in it with --out, such as scene.toml",
        ),
        false => (
            "there is a file of this name already",
            "name another one with --out, or remove it",
        ),
    };
    Defect::new(file.display().to_string(), problem, remedy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_remedy_is_that_of_the_cause() {
        for (kind, cure, code) in [
            (ErrorKind::PermissionDenied, "may write to", None),
            (ErrorKind::ReadOnlyFilesystem, "may write to", None),
            (ErrorKind::NotFound, "create the folder", None),
            (ErrorKind::StorageFull, "make room", Some(NOT_WRITTEN)),
            (ErrorKind::QuotaExceeded, "make room", Some(NOT_WRITTEN)),
            (ErrorKind::Other, "--out", Some(NOT_WRITTEN)),
        ] {
            let defect = not_written(Path::new("a/scene.toml"), &kind.into());
            assert_eq!((defect.place.as_str(), defect.code), ("a/scene.toml", code));
            assert!(defect.remedy.contains(cure), "{defect}");
        }
    }

    #[test]
    fn a_file_is_written_whole_and_never_over_another() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("scene.toml");
        write(&file, "mine").expect("written");
        let defect = write(&file, "another").expect_err("it is there");
        assert!(defect.problem.contains("already"), "{defect}");
        assert_eq!(std::fs::read_to_string(&file).expect("a text"), "mine");
        let left = std::fs::read_dir(folder.path()).expect("a folder");
        assert_eq!(left.count(), 1, "nothing unfinished stays");
        let defect = write(&folder.path().join("no/scene.toml"), "").expect_err("no folder");
        assert!(defect.remedy.contains("create the folder"), "{defect}");
    }

    #[test]
    fn names_that_a_run_would_refuse_are_none_for_a_scene() {
        for name in ["a.msh", "a.GEO", "a.vtu", "a.json", "a.csv"] {
            let defect = check_place(Path::new(name)).expect_err(name);
            assert!(defect.remedy.contains("--out a.toml"), "{defect}");
        }
        for name in ["a.toml", "a.TOML", "a"] {
            check_place(Path::new(name)).expect(name);
        }
    }
}
