//! The folder of one run of gmsh, the only one that it writes to.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use kluft_mesh::Defect;

/// A folder beside the file that gmsh is to make, so that it can be renamed; it goes in the end.
pub(super) struct Workspace {
    folder: PathBuf,
}

impl Workspace {
    pub(super) fn beside(output: &Path) -> Result<Self, Defect> {
        let stem = output.file_stem().unwrap_or_default().to_string_lossy();
        let name = format!(".{stem}.{}{ENDING}", std::process::id());
        let folder = output.with_file_name(name);
        let made = match fs::create_dir(&folder) {
            // Left by a process that had the same number and was killed.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                fs::remove_dir_all(&folder).and_then(|()| fs::create_dir(&folder))
            }
            made => made,
        };
        made.map_err(|error| cannot_write(output, &error))?;
        Ok(Self { folder })
    }

    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Moves a file out of the folder.
    pub(super) fn publish(&self, name: &str, output: &Path) -> Result<(), Defect> {
        fs::rename(self.path(name), output).map_err(|error| cannot_write(output, &error))
    }
}

impl Drop for Workspace {
    fn drop(&mut self) {
        // What stays is removed by the next run into the folder.
        let _ = fs::remove_dir_all(&self.folder);
    }
}

const ENDING: &str = ".gmsh";

fn cannot_write(output: &Path, error: &io::Error) -> Defect {
    let remedy = match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => "free some space there",
        _ => "check that the folder may be written to",
    };
    let problem = format!("cannot be written: {error}");
    Defect::new(output.display().to_string(), problem, remedy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_workspace_goes_with_its_owner() {
        let output = std::env::temp_dir().join("kluft-io.work space.msh");
        let workspace = Workspace::beside(&output).expect("a folder");
        let folder = workspace.folder().to_owned();
        fs::write(workspace.path("a"), "b").expect("written");
        drop(workspace);
        assert!(!folder.exists());
    }
}
