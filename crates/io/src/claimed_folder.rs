//! A folder that one process at a time writes to, and that knows which files are its own.
//!
//! What the program keeps for itself stands in `.kluft` inside the folder:
//!
//! | name | holds |
//! |---|---|
//! | `lock` | the lock, which the system gives back when the process ends, however it ends |
//! | `holder` | the number of the process that holds it |
//! | `files` | the names of the files in the folder that commands have written, or are about to |
//! | `tmp` | files that are not finished; whoever claims the folder next removes them |

use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use kluft_mesh::Defect;

use crate::atomic::{NOT_WRITTEN, not_written, sync_folder, write_atomically};

/// What the program keeps for itself in a folder.
const INNER: &str = ".kluft";
/// First line of the list.
const HEAD: &str = "files that kluft has written here, and may write over or remove";

/// A folder that this process alone writes to until the value is dropped.
#[derive(Debug)]
pub struct ClaimedFolder {
    path: PathBuf,
    /// None where the file system knows no locks.
    lock: Option<File>,
    own: BTreeSet<String>,
    has_list: bool,
}

impl ClaimedFolder {
    /// Makes the folder if it has to, and claims it.
    ///
    /// # Errors
    /// If the folder cannot be made or written to, or somebody else has claimed it. Only a disk
    /// that is full has the code [`NOT_WRITTEN`].
    pub fn claim(path: &Path) -> Result<Self, Defect> {
        let lock = prepare(path).map_err(|error| unusable(path, &error))?;
        let lock = match lock.try_lock() {
            Ok(()) => Some(lock),
            Err(TryLockError::WouldBlock) => return Err(held(path)),
            Err(TryLockError::Error(_)) => None,
        };
        let mut folder = Self {
            path: path.to_owned(),
            lock,
            own: BTreeSet::new(),
            has_list: false,
        };
        folder.begin().map_err(|error| unusable(path, &error))?;
        Ok(folder)
    }

    /// Removes what a former process has left unfinished, and reads its list.
    fn begin(&mut self) -> io::Result<()> {
        // Without an end of `/`, which would follow a link.
        let unfinished = self.inner("tmp");
        match fs::remove_dir_all(&unfinished) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => fs::create_dir(&unfinished)?,
        }
        let holder = self.unfinished("holder");
        fs::write(&holder, std::process::id().to_string())?;
        fs::rename(&holder, self.inner("holder"))?;
        let list = match fs::read_to_string(self.inner("files")) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
            list => list?,
        };
        let mut lines = list.lines();
        self.has_list = lines.next() == Some(HEAD);
        if self.has_list {
            self.own = lines
                .filter(|name| is_plain(name))
                .map(str::to_owned)
                .collect();
        }
        Ok(())
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether nobody else can claim it: not every file system knows locks.
    pub fn is_locked(&self) -> bool {
        self.lock.is_some()
    }

    /// Whether it has a list of its files; a folder of an older version has none.
    pub fn has_list(&self) -> bool {
        self.has_list
    }

    /// The names of the files that commands have written, or were about to.
    pub fn own(&self) -> &BTreeSet<String> {
        &self.own
    }

    /// Where a file stands until it is finished: a folder that nobody else knows.
    pub fn unfinished(&self, name: &str) -> PathBuf {
        Self::unfinished_in(&self.path, name)
    }

    /// The same for a folder that another process has claimed, which writes together with this one.
    pub fn unfinished_in(folder: &Path, name: &str) -> PathBuf {
        folder.join(INNER).join("tmp").join(name)
    }

    fn inner(&self, name: &str) -> PathBuf {
        self.path.join(INNER).join(name)
    }

    /// Refuses to write files of these names where they are `inputs`, or were not written by a
    /// command before.
    ///
    /// # Errors
    /// Each such file.
    pub fn protect<'a>(
        &self,
        names: impl Iterator<Item = &'a str>,
        inputs: &[&Path],
    ) -> Result<(), Vec<Defect>> {
        let true_path = |path: &Path| fs::canonicalize(path).ok();
        let inputs: Vec<PathBuf> = inputs.iter().filter_map(|path| true_path(path)).collect();
        let folder = true_path(&self.path).unwrap_or_else(|| self.path.clone());
        let refused = names.filter_map(|name| {
            let problem = if inputs.contains(&folder.join(name)) {
                "the results would be written over this file, which they are made from"
            } else if !self.own.contains(name) && self.exists(name) {
                "the results would be written over this file, which no list names as a result"
            } else {
                return None;
            };
            let remedy = "name another folder with --out DIR, or move the file elsewhere";
            Some(Defect::new(
                self.path.join(name).display().to_string(),
                problem,
                remedy,
            ))
        });
        let refused: Vec<Defect> = refused.collect();
        if refused.is_empty() {
            return Ok(());
        }
        Err(refused)
    }

    fn exists(&self, name: &str) -> bool {
        fs::symlink_metadata(self.path.join(name)).is_ok()
    }

    /// Lists files of these names as the folder's own, before they are written.
    ///
    /// # Errors
    /// If the list cannot be written.
    pub fn list<'a>(&mut self, names: impl Iterator<Item = &'a str>) -> Result<(), Defect> {
        let before = self.own.len();
        self.own
            .extend(names.filter(|name| is_plain(name)).map(str::to_owned));
        if self.has_list && self.own.len() == before {
            return Ok(());
        }
        self.write_list()
    }

    /// Takes files off the list that are not there.
    ///
    /// # Errors
    /// If the list cannot be written.
    pub fn forget_missing(&mut self) -> Result<(), Defect> {
        let mut own = std::mem::take(&mut self.own);
        let before = own.len();
        own.retain(|name| self.exists(name));
        self.own = own;
        if self.own.len() == before {
            return Ok(());
        }
        self.write_list()
    }

    fn write_list(&mut self) -> Result<(), Defect> {
        let (unfinished, list) = (self.unfinished("files"), self.inner("files"));
        write_atomically(&unfinished, |out| {
            writeln!(out, "{HEAD}")?;
            self.own.iter().try_for_each(|name| writeln!(out, "{name}"))
        })?;
        fs::rename(&unfinished, &list).map_err(|error| not_written(&list, &error))?;
        self.has_list = true;
        sync_folder(&self.path.join(INNER))
    }

    /// Gives a finished file its place. [`sync_folder`] makes it lasting.
    ///
    /// # Errors
    /// If it cannot be renamed.
    pub fn publish(&self, name: &str) -> Result<(), Defect> {
        let path = self.path.join(name);
        fs::rename(self.unfinished(name), &path).map_err(|error| not_written(&path, &error))
    }

    /// Lets `write` write a file, whole or not at all, and gives it its place.
    ///
    /// # Errors
    /// As [`Self::publish`] and `write`, whose defects name the place.
    pub fn write(
        &self,
        name: &str,
        write: impl FnOnce(&Path) -> Result<(), Defect>,
    ) -> Result<(), Defect> {
        let written = write(&self.unfinished(name));
        written.map_err(|defect| Defect {
            place: self.path.join(name).display().to_string(),
            ..defect
        })?;
        self.publish(name)
    }
}

impl Drop for ClaimedFolder {
    fn drop(&mut self) {
        // Whoever claims the folder next removes what could not be removed.
        let _ = fs::remove_dir_all(self.inner("tmp"));
        let _ = fs::remove_file(self.inner("holder"));
    }
}

/// Makes the folder and opens its lock.
fn prepare(path: &Path) -> io::Result<File> {
    fs::create_dir_all(path)?;
    let inner = path.join(INNER);
    match fs::create_dir(&inner) {
        Err(error) if error.kind() != io::ErrorKind::AlreadyExists => return Err(error),
        _ if !fs::symlink_metadata(&inner)?.is_dir() => {
            return Err(io::Error::other(format!("`{INNER}` in it is no folder")));
        }
        _ => {}
    }
    // The folder itself, not only what is inside `.kluft`.
    drop(tempfile::tempfile_in(path).map_err(|error| io::Error::from(error.kind()))?);
    let lock = inner.join("lock");
    let mut open = OpenOptions::new();
    open.read(true).write(true);
    match open.clone().create_new(true).open(&lock) {
        // Nothing is ever written to it, so that a link in its place does no harm.
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => open.open(&lock),
        made => made,
    }
}

/// Whether a name is that of a file in the folder, on a line of its own.
fn is_plain(name: &str) -> bool {
    let is_odd = |c: char| c.is_control() || c == '/' || c == '\\';
    !name.is_empty() && name != "." && name != ".." && !name.contains(is_odd)
}

fn held(path: &Path) -> Defect {
    let holder = fs::read_to_string(path.join(INNER).join("holder")).ok();
    let holder = holder.filter(|text| text.bytes().all(|byte| byte.is_ascii_digit()));
    let holder = holder.map_or_else(String::new, |holder| format!(" (process {holder})"));
    Defect::new(
        path.display().to_string(),
        format!("another run is writing to this folder{holder}"),
        "name another folder with --out DIR, or wait until that run has ended",
    )
}

fn unusable(path: &Path, error: &io::Error) -> Defect {
    let defect = Defect::new(
        path.display().to_string(),
        format!("the results cannot be written here: {error}"),
        "name a folder you may write to with --out DIR",
    );
    match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => defect.with_code(NOT_WRITTEN),
        _ => defect,
    }
}

#[cfg(test)]
mod tests;
