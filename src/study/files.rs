//! The folder of a study, and what of it is the study's own.

use std::fs;
use std::path::Path;

use kluft_io::ClaimedFolder;
use kluft_mesh::Defect;

/// The page and the table.
pub(super) const PAGE: &str = "study.html";
pub(super) const TABLE: &str = "study.csv";
/// The scene and the record of a setting, and the folder of its results.
pub(super) const SCENE: &str = "scene.toml";
pub(super) const RECORD: &str = "point.json";
pub(super) const RESULTS: &str = "out";

/// Claims the folder for page, table and `charts`.
///
/// # Errors
/// If it cannot be written to, another study is under way in it, or a file would be written over
/// that is an input or no study's.
pub(super) fn claim(
    folder: &Path,
    charts: &[String],
    inputs: &[&Path],
) -> Result<ClaimedFolder, Vec<Defect>> {
    let mut folder = ClaimedFolder::claim(folder).map_err(|defect| vec![defect])?;
    let names = || charts.iter().map(String::as_str).chain([PAGE, TABLE]);
    let table = fs::read_to_string(folder.path().join(TABLE)).unwrap_or_default();
    // A study of an older version has left no list.
    let list = |folder: &mut ClaimedFolder| folder.list(names()).map_err(|defect| vec![defect]);
    if !folder.has_list() && table.starts_with("folder,") {
        list(&mut folder)?;
    }
    folder.protect(names(), inputs)?;
    list(&mut folder)?;
    Ok(folder)
}

/// Removes the folder of a setting.
///
/// # Errors
/// If it cannot be removed, or holds what no study has written.
pub(super) fn remove_setting(folder: &Path) -> Result<(), Defect> {
    let place = || folder.display().to_string();
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(()),
        entries => entries.map_err(|error| unwritable(folder, &error))?,
    };
    for entry in entries {
        let name = entry
            .map_err(|error| unwritable(folder, &error))?
            .file_name();
        if ![SCENE, RECORD, RESULTS].iter().any(|own| name == *own) {
            let problem = format!("`{}` in it is not of a study", name.display());
            let remedy = "move it elsewhere, or name another folder with --out";
            return Err(Defect::new(place(), problem, remedy));
        }
    }
    fs::remove_dir_all(folder).map_err(|error| unwritable(folder, &error))
}

/// A folder that cannot be changed.
pub(super) fn unwritable(folder: &Path, error: &std::io::Error) -> Defect {
    let problem = format!("cannot be written: {error}");
    Defect::new(
        folder.display().to_string(),
        problem,
        "check the permissions and the space, or name another folder with --out",
    )
    .with_code(kluft_io::NOT_WRITTEN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_a_study_wrote_is_removed() {
        let scratch = tempfile::tempdir().expect("a folder");
        let folder = scratch.path().join("point");
        remove_setting(&folder).expect("nothing to remove");
        fs::create_dir_all(folder.join(RESULTS)).expect("a folder");
        fs::write(folder.join(SCENE), "").expect("written");
        fs::write(folder.join("mine"), "").expect("written");
        let defect = remove_setting(&folder).expect_err("a stranger");
        assert!(defect.problem.contains("`mine`"), "{defect}");
        assert!(folder.join(SCENE).exists());
        fs::remove_file(folder.join("mine")).expect("removed");
        remove_setting(&folder).expect("removed");
        assert!(!folder.exists());
    }

    #[test]
    fn a_table_of_an_older_study_is_known() {
        let scratch = tempfile::tempdir().expect("a folder");
        let table = scratch.path().join(TABLE);
        fs::write(&table, "name,price\n").expect("written");
        let defects = claim(scratch.path(), &[], &[]).expect_err("a stranger");
        assert_eq!(defects[0].place, table.display().to_string());
        fs::write(&table, "folder,mesh\n").expect("written");
        claim(scratch.path(), &[], &[]).expect("a study's");
        claim(scratch.path(), &[], &[]).expect("listed");
    }
}
