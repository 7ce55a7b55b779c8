//! Folders of files, claimed once and twice, and whole after every interruption.

use std::fs;
use std::path::Path;

use tempfile::TempDir;

use super::ClaimedFolder;

fn scratch() -> TempDir {
    tempfile::tempdir().expect("a folder")
}

fn claimed(path: &Path) -> ClaimedFolder {
    ClaimedFolder::claim(path).expect("a folder of ours")
}

#[test]
fn a_folder_is_claimed_once_until_it_is_given_back() {
    let scratch = scratch();
    let path = scratch.path().join("a/b");
    let first = claimed(&path);
    assert!(first.is_locked());
    let defect = ClaimedFolder::claim(&path).expect_err("claimed");
    assert_eq!(defect.place, path.display().to_string());
    let process = format!("process {}", std::process::id());
    assert!(defect.problem.contains(&process), "{defect}");
    assert!(defect.remedy.contains("--out") && defect.remedy.contains("wait"));
    assert_eq!(defect.code, None);
    drop(first);
    claimed(&path);
}

#[test]
fn names_are_listed_before_there_are_files_and_survive() {
    let scratch = scratch();
    let mut folder = claimed(scratch.path());
    assert!(!folder.has_list());
    folder
        .list(["b", "a", "../c", "d\ne"].into_iter())
        .expect("listed");
    // As after a sudden end: nothing is tidied up.
    fs::write(folder.unfinished("b"), "half").expect("written");
    let unfinished = folder.unfinished("b");
    std::mem::forget(folder);
    let mut lock = fs::File::open(scratch.path().join(".kluft/lock")).expect("the lock");
    assert!(lock.try_lock().is_err(), "a forgotten folder stays claimed");
    lock = fs::File::create_new(scratch.path().join(".kluft/lock.new")).expect("another lock");
    drop(lock);
    fs::rename(
        scratch.path().join(".kluft/lock.new"),
        scratch.path().join(".kluft/lock"),
    )
    .expect("renamed");
    let mut folder = claimed(scratch.path());
    assert!(folder.has_list() && !unfinished.exists());
    assert_eq!(folder.own().iter().collect::<Vec<_>>(), ["a", "b"]);
    folder
        .write("a", |path| crate::write_atomically(path, |_| Ok(())))
        .expect("written");
    folder.forget_missing().expect("listed");
    assert_eq!(folder.own().iter().collect::<Vec<_>>(), ["a"]);
}

#[test]
fn strangers_and_inputs_are_protected() {
    let scratch = scratch();
    let path = |name: &str| scratch.path().join(name);
    let mut folder = claimed(scratch.path());
    folder.list(["ours", "given"].into_iter()).expect("listed");
    for name in ["ours", "given", "theirs"] {
        fs::write(path(name), name).expect("written");
    }
    fs::create_dir(path("sub")).expect("a folder");
    let input = path("sub/../given");
    let names = ["ours", "given", "theirs", "nothing"];
    let defects = folder.protect(names.into_iter(), &[&input, Path::new("no/such")]);
    let defects = defects.expect_err("two");
    let places: Vec<&str> = defects.iter().map(|defect| &defect.place[..]).collect();
    let expected = [path("given"), path("theirs")].map(|path| path.display().to_string());
    assert_eq!(places, expected);
    assert!(defects[0].problem.contains("made from"), "{}", defects[0]);
}

#[cfg(unix)]
#[test]
fn links_in_the_place_of_what_is_ours_do_no_harm() {
    use std::os::unix::fs::symlink;
    let (scratch, elsewhere) = (scratch(), scratch());
    let precious = elsewhere.path().join("precious");
    fs::write(&precious, "precious").expect("written");
    let inner = scratch.path().join(".kluft");
    fs::create_dir(&inner).expect("a folder");
    for name in ["lock", "holder", "files"] {
        symlink(&precious, inner.join(name)).expect("a link");
    }
    symlink(elsewhere.path(), inner.join("tmp")).expect("a link");
    let mut folder = claimed(scratch.path());
    assert!(!folder.has_list(), "the list of somebody else is none");
    folder.list(["a"].into_iter()).expect("listed");
    drop(folder);
    assert_eq!(fs::read_to_string(&precious).expect("a text"), "precious");
    let other = claimed(&scratch.path().join("other"));
    drop(other);
    fs::remove_dir_all(scratch.path().join("other/.kluft")).expect("removed");
    symlink(elsewhere.path(), scratch.path().join("other/.kluft")).expect("a link");
    let defect = ClaimedFolder::claim(&scratch.path().join("other")).expect_err("a link");
    assert!(defect.problem.contains("is no folder"), "{defect}");
}

#[test]
fn what_cannot_be_written_is_named_by_its_place() {
    let scratch = scratch();
    let folder = claimed(scratch.path());
    fs::create_dir(scratch.path().join("a")).expect("a folder");
    let written = folder.write("a", |path| crate::write_atomically(path, |_| Ok(())));
    let defect = written.expect_err("a folder of that name");
    assert_eq!(defect.place, scratch.path().join("a").display().to_string());
    assert_eq!(defect.code, Some(crate::NOT_WRITTEN));
}
