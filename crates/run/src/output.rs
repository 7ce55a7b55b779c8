//! The folder of the results: grids for ParaView and their collections.

use std::panic::resume_unwind;
use std::path::{Path, PathBuf};

use kluft_io::{
    About, ClaimedFolder, EncodedGrid, Fingerprint, Grid, fingerprint_of, sync_folder, write_pvd,
    write_pvtu, write_vtm,
};
use kluft_mesh::Defect;
use kluft_report::Surface;
use rayon::prelude::*;
use tempfile::TempDir;

use crate::checkpoint::{self, StepFiles};
use crate::flow::SOURCES;
use crate::former::{self, TOGETHER};
use crate::history;
use crate::page::{self, Shown};
use crate::pieces::{Piece, some_of};
use crate::probes;
use crate::ranks::Ranks;
use crate::step_files::{names, parts};
use crate::strength_summary;

/// The collections of the grids of all load steps.
pub const COLLECTIONS: [&str; 2] = ["rock.pvd", "fractures.pvd"];

/// Files of every run beside the grids of its load steps.
pub const OWN: [&str; 6] = [
    SUMMARY,
    history::NAME,
    checkpoint::NAME,
    COLLECTIONS[0],
    COLLECTIONS[1],
    TOGETHER,
];

/// The numbers of a run.
pub const SUMMARY: &str = "summary.json";

/// Writes the results of a run into one folder, step by step; the collections always list exactly
/// the steps that are complete.
///
/// An output nowhere has a temporary folder for what gmsh needs, which goes with it, and keeps
/// nothing.
pub struct Output {
    place: Place,
    rock: Vec<(f64, String)>,
    fractures: Vec<(f64, String)>,
    /// The sums of the grids of each load step.
    sums: Vec<StepFiles>,
    /// What the grids say of themselves, but their times.
    about: About,
    /// Whether what the page shows is kept.
    shows: bool,
    /// What the page shows: the load step that was written last.
    shown: Option<Shown>,
    /// How many files hold a grid together.
    pub pieces: usize,
}

enum Place {
    Kept(ClaimedFolder),
    /// The first rank has claimed it, and writes everything but the pieces.
    Beside(PathBuf),
    Nowhere(TempDir),
}

impl Output {
    /// Prepares the folder for files of these names, made from `inputs`, and keeps every other
    /// process out of it.
    ///
    /// # Errors
    /// If it cannot be made or written to, if another run writes there, and if a file would be
    /// written over that is an input or no result.
    pub fn prepare(folder: &Path, names: &[&str], inputs: &[&Path]) -> Result<Self, Vec<Defect>> {
        let mut folder = ClaimedFolder::claim(folder).map_err(|defect| vec![defect])?;
        if !folder.has_list() {
            let former = former::named_files(folder.path());
            list(&mut folder, former.iter().map(String::as_str))?;
        }
        folder.protect(names.iter().copied(), inputs)?;
        list(&mut folder, names.iter().copied())?;
        Ok(Self::at(Place::Kept(folder)))
    }

    /// An output that keeps nothing.
    ///
    /// # Errors
    /// If there is no place for temporary files.
    pub fn nowhere() -> Result<Self, Vec<Defect>> {
        let temporary = tempfile::tempdir().map_err(|error| {
            vec![Defect::new(
                std::env::temp_dir().display().to_string(),
                format!("no temporary folder can be made: {error}"),
                "name a folder you may write to in the environment variable TMPDIR",
            )]
        })?;
        Ok(Self::at(Place::Nowhere(temporary)))
    }

    /// An output into a folder that the first of several ranks has claimed: pieces alone.
    pub fn beside(folder: &Path, ranks: usize) -> Self {
        Self {
            pieces: ranks,
            ..Self::at(Place::Beside(folder.to_owned()))
        }
    }

    fn at(place: Place) -> Self {
        Self {
            pieces: 1,
            place,
            rock: Vec::new(),
            fractures: Vec::new(),
            sums: Vec::new(),
            about: About::default(),
            shows: false,
            shown: None,
        }
    }

    /// Keeps of the last load step what the page of a run shows.
    #[must_use]
    pub fn with_page(self, shows: bool) -> Self {
        Self { shows, ..self }
    }

    /// Lets the grids say these facts of themselves.
    pub fn tell(&mut self, facts: Vec<(String, i32)>) {
        self.about.facts = facts;
    }

    /// What the page shows, if a load step was written.
    pub fn shown(&self) -> Option<&Shown> {
        self.shown.as_ref()
    }

    /// Whether results are kept.
    pub fn is_kept(&self) -> bool {
        matches!(self.place, Place::Kept(_))
    }

    /// Whether the folder holds what a run has written.
    pub fn has_results(&self) -> bool {
        let told = [SUMMARY, checkpoint::NAME].map(|name| self.path(name));
        told.iter().any(|file| file.exists())
    }

    /// Whether another process could write into the folder, because its file system has no locks.
    pub fn is_unguarded(&self) -> bool {
        matches!(&self.place, Place::Kept(folder) if !folder.is_locked())
    }

    /// A path in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        match &self.place {
            Place::Kept(folder) => folder.path().join(name),
            Place::Beside(folder) => folder.join(name),
            Place::Nowhere(folder) => folder.path().join(name),
        }
    }

    /// Where a file stands until [`Self::publish`] gives it its place.
    pub fn unfinished(&self, name: &str) -> PathBuf {
        match &self.place {
            Place::Kept(folder) => folder.unfinished(name),
            Place::Beside(folder) => ClaimedFolder::unfinished_in(folder, name),
            Place::Nowhere(folder) => folder.path().join(name),
        }
    }

    /// Gives a finished file its place.
    ///
    /// # Errors
    /// If it cannot be renamed.
    pub fn publish(&self, name: &str) -> Result<(), Defect> {
        match &self.place {
            Place::Kept(folder) => folder.publish(name),
            Place::Beside(_) | Place::Nowhere(_) => Ok(()),
        }
    }

    /// Lets `write` write a file, whole or not at all, and gives it its place.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(
        &self,
        name: &str,
        write: impl FnOnce(&Path) -> Result<(), Defect>,
    ) -> Result<(), Defect> {
        match &self.place {
            Place::Kept(folder) => folder.write(name, write),
            Place::Beside(_) => Ok(()),
            Place::Nowhere(folder) => write(&folder.path().join(name)),
        }
    }

    /// Makes what was written outlast a loss of power.
    ///
    /// # Errors
    /// If the disk refuses.
    pub fn sync(&self) -> Result<(), Defect> {
        match &self.place {
            Place::Kept(folder) => sync_folder(folder.path()),
            Place::Beside(_) | Place::Nowhere(_) => Ok(()),
        }
    }

    /// Takes what was not written off the list of the folder's files.
    ///
    /// # Errors
    /// If the list cannot be written.
    pub fn close(&mut self) -> Result<(), Defect> {
        match &mut self.place {
            Place::Kept(folder) => folder.forget_missing(),
            Place::Beside(_) | Place::Nowhere(_) => Ok(()),
        }
    }

    /// Goes on after load steps that a former run has written, which end at `times`.
    pub fn go_on_after(&mut self, times: impl Iterator<Item = f64>, sums: Vec<StepFiles>) {
        for (index, time) in times.enumerate() {
            let [rock, fractures] = names(index + 1, self.pieces);
            self.rock.push((time, rock));
            self.fractures.push((time, fractures));
        }
        self.sums = sums;
    }

    /// The sums of the grids of each load step.
    pub fn sums(&self) -> &[StepFiles] {
        &self.sums
    }

    /// Checks that the results of load steps are there, and have these sums.
    ///
    /// # Errors
    /// Those that are not.
    pub fn check_steps(&self, sums: &[StepFiles]) -> Result<(), Vec<Defect>> {
        if matches!(self.place, Place::Beside(_)) {
            return Ok(());
        }
        let files = sums.iter().enumerate();
        let files =
            files.flat_map(|(index, sums)| names(index + 1, self.pieces).into_iter().zip(*sums));
        let files: Vec<(String, u128)> = files.collect();
        let check = |(name, sum): &(String, u128)| -> Option<Defect> {
            let file = self.path(name);
            let problem = match self.sum_of(name) {
                Ok(found) if found == *sum => return None,
                Ok(_) => "the results of a finished load step are not those of this run",
                Err(_) => "the results of a finished load step are gone",
            };
            let remedy = "put the file back, or run without --resume: it starts from the beginning";
            Some(Defect::new(file.display().to_string(), problem, remedy))
        };
        let spoilt: Vec<Defect> = files.par_iter().filter_map(check).collect();
        if spoilt.is_empty() {
            return Ok(());
        }
        Err(spoilt)
    }

    /// Prepares for the grids of `count` load steps, after those that [`Self::go_on_after`] names.
    /// Nothing is touched upon an error.
    ///
    /// # Errors
    /// Each file of such a name that no run has written.
    pub fn expect_steps(&mut self, count: usize) -> Result<(), Vec<Defect>> {
        let Place::Kept(folder) = &mut self.place else {
            return Ok(());
        };
        let pieces = self.pieces;
        let grids = (1..=count).flat_map(|number| names(number, pieces));
        let names: Vec<String> = grids
            .flat_map(|name| [parts(&name, pieces), vec![name]].concat())
            .collect();
        folder.protect(names.iter().map(String::as_str), &[])?;
        list(folder, names.iter().map(String::as_str))
    }

    /// Removes what another run has written: its load steps, so that the folder never holds steps
    /// of two runs, and its checkpoint. Files that no list names are those of somebody else.
    ///
    /// # Errors
    /// If a file cannot be removed.
    pub fn remove_former(&self) -> Result<(), Defect> {
        let Place::Kept(folder) = &self.place else {
            return Ok(());
        };
        let mut names: Vec<&String> = folder.own().iter().collect();
        names.retain(|name| is_of_run(name));
        // The checkpoint first, so that none ever continues steps that are gone, then the
        // collections, so that none ever lists a grid that is gone.
        names.sort_by_key(|name| (*name != checkpoint::NAME, !name.ends_with(".pvd")));
        let removed = names.iter().try_for_each(|name| {
            match std::fs::remove_file(folder.path().join(name)) {
                Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(error),
                _ => Ok(()),
            }
        });
        removed.map_err(|error| {
            Defect::new(
                folder.path().display().to_string(),
                format!("the results of a former run cannot be removed: {error}"),
                "remove them, or name another folder with --out DIR",
            )
        })
    }

    /// Writes the grids of one load step with its time for ParaView. While the disk takes them, the
    /// threads at hand do what there is to do `meanwhile`.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write_step(
        &mut self,
        time: f64,
        rock_grid: impl FnOnce() -> Grid + Send,
        fracture_grid: impl FnOnce() -> Grid + Send,
        meanwhile: impl FnOnce(),
    ) -> Result<(), Defect> {
        if !self.is_kept() {
            meanwhile();
            return Ok(());
        }
        let names = names(self.rock.len() + 1, self.pieces);
        let [rock, fractures] = &names;
        self.about.time = Some(time);
        let of_rock = || {
            let grid = rock_grid();
            let body = box_of(&grid.points);
            (self.encoded(rock, grid), body)
        };
        let of_fractures = || {
            let grid = fracture_grid();
            let surface = self.shows.then(|| Surface::of(&grid, &page::fields()));
            (self.encoded(fractures, grid), surface)
        };
        let ((rock_grid, body), (fracture_grid, surface)) = rayon::join(of_rock, of_fractures);
        let (rock_grid, fracture_grid) = (rock_grid?, fracture_grid?);
        let write = || -> Result<StepFiles, Defect> {
            let sums = [
                self.write_grid(rock, &rock_grid)?,
                self.write_grid(fractures, &fracture_grid)?,
            ];
            self.publish(rock)?;
            self.publish(fractures)?;
            Ok(sums)
        };
        let sums = beside(write, meanwhile)?;
        self.shown = surface.map(|surface| Shown { surface, body });
        self.collect(time, names, sums)
    }

    /// Lets the collections list the grids of one load step, which are in their places.
    fn collect(&mut self, time: f64, names: [String; 2], sums: StepFiles) -> Result<(), Defect> {
        let [rock, fractures] = names;
        self.sums.push(sums);
        self.rock.push((time, rock));
        self.fractures.push((time, fractures));
        for (name, entries) in COLLECTIONS.into_iter().zip([&self.rock, &self.fractures]) {
            self.write(name, |path| write_pvd(path, entries))?;
        }
        let last = self.rock.last().zip(self.fractures.last());
        let Some(((_, rock), (_, fractures))) = last else {
            return Ok(());
        };
        let blocks = [("rock", rock.as_str()), ("fractures", fractures.as_str())];
        self.write(TOGETHER, |path| write_vtm(path, &blocks))
    }

    /// Writes the piece of this rank of the grids of one load step, rock and fractures; the first
    /// rank gives all pieces their places, and lists them.
    ///
    /// # Errors
    /// If a file cannot be written, here or by another rank.
    pub fn write_pieces(
        &mut self,
        time: f64,
        (rock, fractures): (impl FnOnce() -> Grid, impl FnOnce() -> Grid),
        piece: &Piece,
        ranks: Ranks<'_>,
    ) -> Result<(), Vec<Defect>> {
        if matches!(self.place, Place::Nowhere(_)) {
            return Ok(());
        }
        let names = names(self.rock.len() + 1, self.pieces);
        self.about.time = Some(time);
        // One after the other: all ranks of a machine share its memory.
        let rock = rock();
        let corners = ranks.communicator.gathered(&box_of(&rock.points));
        let fields = some_of(&rock, &[]);
        let first = self.write_piece(&names[0], rock, ranks);
        let fractures = fractures();
        self.shown = (self.shows && self.is_kept()).then(|| Shown {
            surface: Surface::of(&fractures, &page::fields()),
            body: box_of(&corners),
        });
        let second = self.write_piece(&names[1], some_of(&fractures, &piece.facets), ranks);
        ranks.agree(first.and(second).map_err(|defect| vec![defect]))?;
        if !self.is_kept() {
            self.rock.push((time, String::new()));
            return Ok(());
        }
        let placed = self.place_pieces(time, [&fields, &fractures], names);
        placed.map_err(|defect| vec![defect])
    }

    fn write_piece(&self, name: &str, grid: Grid, ranks: Ranks<'_>) -> Result<(), Defect> {
        let name = &parts(name, self.pieces)[ranks.rank()];
        let grid = self.encoded(name, grid)?;
        self.write_grid(name, &grid).map(|_| ())
    }

    fn place_pieces(
        &mut self,
        time: f64,
        grids: [&Grid; 2],
        names: [String; 2],
    ) -> Result<(), Defect> {
        for (name, grid) in names.iter().zip(grids) {
            let pieces = parts(name, self.pieces);
            pieces.iter().try_for_each(|piece| self.publish(piece))?;
            self.write(name, |path| write_pvtu(path, grid, &pieces))?;
        }
        let sums = [self.sum_of(&names[0])?, self.sum_of(&names[1])?];
        self.collect(time, names, sums)
    }

    /// The sum of a grid, with those of its pieces.
    fn sum_of(&self, name: &str) -> Result<Fingerprint, Defect> {
        let pieces = parts(name, self.pieces);
        let files = pieces.iter().map(String::as_str).chain([name]);
        files
            .enumerate()
            .try_fold(0, |sum: Fingerprint, (place, file)| {
                let own = fingerprint_of(&self.path(file))?;
                // Turned by its place, so that exchanged files are told.
                Ok(sum ^ own.rotate_left(place as u32))
            })
    }

    fn encoded(&self, name: &str, grid: Grid) -> Result<EncodedGrid, Defect> {
        EncodedGrid::of(grid, &self.path(name))
    }

    /// Writes a grid that is not yet published, and sums up its bytes.
    fn write_grid(&self, name: &str, grid: &EncodedGrid) -> Result<Fingerprint, Defect> {
        let written = grid.write(&self.unfinished(name), &self.about);
        written.map_err(|defect| Defect {
            place: self.path(name).display().to_string(),
            ..defect
        })
    }
}

/// Writes on a thread of its own, if there is one to be had, and does something else meanwhile.
fn beside<T: Send>(write: impl Fn() -> T + Sync, meanwhile: impl FnOnce()) -> T {
    std::thread::scope(|scope| {
        let writing = std::thread::Builder::new().spawn_scoped(scope, &write);
        meanwhile();
        match writing {
            Ok(writing) => writing.join().unwrap_or_else(|panic| resume_unwind(panic)),
            Err(_) => write(),
        }
    })
}

/// Lowest and highest coordinates.
pub fn box_of(points: &[[f64; 3]]) -> [[f64; 3]; 2] {
    let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for point in points {
        for axis in 0..3 {
            bounds[0][axis] = bounds[0][axis].min(point[axis]);
            bounds[1][axis] = bounds[1][axis].max(point[axis]);
        }
    }
    bounds
}

/// Whether a file belongs to one run and must not outlive it.
fn is_of_run(name: &str) -> bool {
    let tables = [history::NAME, probes::NAME, SOURCES];
    tables.contains(&name)
        || strength_summary::GRIDS.contains(&name)
        || [checkpoint::NAME, page::NAME, TOGETHER].contains(&name)
        || former::is_step(name)
}

fn list<'a>(
    folder: &mut ClaimedFolder,
    names: impl Iterator<Item = &'a str>,
) -> Result<(), Vec<Defect>> {
    folder.list(names).map_err(|defect| vec![defect])
}
