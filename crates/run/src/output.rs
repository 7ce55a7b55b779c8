//! The folder of the results: grids for ParaView and their collections.

use std::path::{Path, PathBuf};

use kluft_io::gmsh::is_workspace;
use kluft_io::{Grid, write_pvd, write_vtu};
use kluft_mesh::Defect;
use tempfile::TempDir;

use crate::checkpoint;

/// Writes the results of a run into one folder, step by step; the collections always list exactly
/// the steps that are complete.
///
/// An output nowhere has a temporary folder for what gmsh needs, which goes with it, and keeps
/// nothing.
pub struct Output {
    folder: PathBuf,
    temporary: Option<TempDir>,
    rock: Vec<(f64, String)>,
    fractures: Vec<(f64, String)>,
}

impl Output {
    /// Prepares the folder.
    ///
    /// # Errors
    /// If it cannot be made or written to.
    pub fn prepare(folder: &Path) -> Result<Self, Defect> {
        let refused = |error: std::io::Error| {
            Defect::new(
                folder.display().to_string(),
                format!("the results cannot be written here: {error}"),
                "name a folder you may write to with --out DIR",
            )
        };
        std::fs::create_dir_all(folder).map_err(refused)?;
        let probe = folder.join(".kluft-probe");
        std::fs::write(&probe, b"").map_err(refused)?;
        std::fs::remove_file(&probe).map_err(refused)?;
        Ok(Self {
            folder: folder.to_owned(),
            temporary: None,
            rock: Vec::new(),
            fractures: Vec::new(),
        })
    }

    /// An output that keeps nothing.
    ///
    /// # Errors
    /// If there is no place for temporary files.
    pub fn nowhere() -> Result<Self, Defect> {
        let temporary = tempfile::tempdir().map_err(|error| {
            Defect::new(
                std::env::temp_dir().display().to_string(),
                format!("no temporary folder can be made: {error}"),
                "name a folder you may write to in the environment variable TMPDIR",
            )
        })?;
        Ok(Self {
            folder: temporary.path().to_owned(),
            temporary: Some(temporary),
            rock: Vec::new(),
            fractures: Vec::new(),
        })
    }

    /// Whether results are kept.
    pub fn is_kept(&self) -> bool {
        self.temporary.is_none()
    }

    /// A path in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Goes on after load steps that a former run has written, which end at `times`.
    pub fn go_on_after(&mut self, times: impl Iterator<Item = f64>) {
        for (index, time) in times.enumerate() {
            let [rock, fractures] = names(index + 1);
            self.rock.push((time, rock));
            self.fractures.push((time, fractures));
        }
    }

    /// Checks that the results of the first `count` load steps are there.
    ///
    /// # Errors
    /// Those that are not.
    pub fn check_steps(&self, count: usize) -> Result<(), Vec<Defect>> {
        let files = (1..=count).flat_map(|number| names(number).map(|name| self.path(&name)));
        let missing = files.filter(|file| !file.is_file()).map(|file| {
            let problem = "the results of a finished load step are gone";
            let remedy = "put the file back, or run without --resume: it starts from the beginning";
            Defect::new(file.display().to_string(), problem, remedy)
        });
        let missing: Vec<Defect> = missing.collect();
        if missing.is_empty() {
            return Ok(());
        }
        Err(missing)
    }

    /// Removes what another run has written: its load steps, so that the folder never holds steps
    /// of two runs, its checkpoint, and what it left unfinished.
    ///
    /// # Errors
    /// If a file cannot be removed.
    pub fn remove_former(&self) -> Result<(), Defect> {
        let remove = || -> std::io::Result<()> {
            let entries = std::fs::read_dir(&self.folder)?;
            let names = entries.map(|entry| entry.map(|entry| entry.file_name()));
            let mut names = names.collect::<std::io::Result<Vec<_>>>()?;
            names.retain(|name| name.to_str().is_some_and(is_result));
            // The checkpoint first, so that none ever continues steps that are gone, then the
            // collections, so that none ever lists a grid that is gone.
            names.sort_by_key(|name| {
                let is_collection = name.as_encoded_bytes().ends_with(b".pvd");
                (name != checkpoint::NAME, !is_collection)
            });
            names.iter().try_for_each(|name| {
                let path = self.folder.join(name);
                if name.to_str().is_some_and(is_workspace) {
                    std::fs::remove_dir_all(path)
                } else {
                    std::fs::remove_file(path)
                }
            })
        };
        remove().map_err(|error| {
            Defect::new(
                self.folder.display().to_string(),
                format!("the results of a former run cannot be removed: {error}"),
                "remove them, or name another folder with --out DIR",
            )
        })
    }

    /// Writes the grids of one load step with its time for ParaView.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write_step(
        &mut self,
        time: f64,
        rock_grid: impl FnOnce() -> Grid + Send,
        fracture_grid: impl FnOnce() -> Grid + Send,
    ) -> Result<(), Defect> {
        if !self.is_kept() {
            return Ok(());
        }
        let [rock, fractures] = names(self.rock.len() + 1);
        let of_rock = || write_vtu(&self.path(&rock), rock_grid());
        let of_fractures = || write_vtu(&self.path(&fractures), fracture_grid());
        let (rock_written, fractures_written) = rayon::join(of_rock, of_fractures);
        rock_written?;
        fractures_written?;
        self.rock.push((time, rock));
        self.fractures.push((time, fractures));
        write_pvd(&self.path("rock.pvd"), &self.rock)?;
        write_pvd(&self.path("fractures.pvd"), &self.fractures)
    }
}

/// Names of the grids of a load step.
fn names(number: usize) -> [String; 2] {
    [
        format!("rock_{number:04}.vtu"),
        format!("fractures_{number:04}.vtu"),
    ]
}

/// Whether a run writes files of this name beside its mesh and its summary, or leaves them if it is
/// killed.
fn is_result(name: &str) -> bool {
    let unfinished = name
        .strip_prefix('.')
        .and_then(|name| name.strip_suffix(".tmp"));
    let is_left = is_workspace(name);
    let name = unfinished.unwrap_or(name);
    let is_summary = unfinished.is_some() && ["summary.json", "sizes.pos"].contains(&name);
    is_left || is_summary || name == checkpoint::NAME || is_step(name)
}

/// Whether [`Output::write_step`] writes files of this name.
fn is_step(name: &str) -> bool {
    let of_kind = |kind: &str| {
        let Some(rest) = name.strip_prefix(kind) else {
            return false;
        };
        let number = rest
            .strip_prefix('_')
            .and_then(|rest| rest.strip_suffix(".vtu"));
        let is_number =
            |text: &str| text.len() >= 4 && text.bytes().all(|byte| byte.is_ascii_digit());
        rest == ".pvd" || number.is_some_and(is_number)
    };
    of_kind("rock") || of_kind("fractures")
}
