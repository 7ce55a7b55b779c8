//! The stages of a run that are done once: mesh, problem, unknowns, matrix, linear solver.

use std::io::Write;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use kluft_io::{Meshed, fingerprint_of, write_atomically};
use kluft_mesh::{Defect, Draft, Mesh};
use kluft_scene::{Binding, MeshSource, Oracle, SolverEntry};
use kluft_solver::{Iteration, LinearFailure, NewtonSettings, System};

use crate::begin::provenance;
use crate::checkpoint::{self, Identity};
use crate::choice::Choice;
use crate::ending::Ending;
use crate::facts::facts;
use crate::failures;
use crate::flow_history::FlowHistory;
use crate::history::History;
use crate::memory;
use crate::observer::{Observer, Stage};
use crate::outcome::{Outcome, StepResult};
use crate::output::{Output, SUMMARY};
use crate::page::{self, Iterations, StrengthShown, Told};
use crate::prepare::{self, MeshFile};
use crate::probes::ProbeTable;
use crate::provenance::InputFile;
use crate::ranks::agreed;
use crate::request::{MeshInput, Request};
use crate::resume::FormerRun;
use crate::summary::{MeshSummary, RankSummary, Seconds, StepMeasures, Summary};

/// What ends a run early.
pub enum Interruption {
    /// A load step did not converge: which, where and why.
    NotConverged(String),
    /// The observer said so.
    Stopped,
    /// The input is wrong, or a file cannot be written.
    Defects(Vec<Defect>),
}

impl From<Vec<Defect>> for Interruption {
    fn from(defects: Vec<Defect>) -> Self {
        Self::Defects(defects)
    }
}

impl From<Defect> for Interruption {
    fn from(defect: Defect) -> Self {
        Self::Defects(vec![defect])
    }
}

/// A run under way.
pub struct Run<'a> {
    /// What is asked for.
    pub request: Request<'a>,
    /// Where results go.
    pub output: Output,
    /// Who follows it.
    pub observer: &'a mut dyn Observer,
    /// What `summary.json` will hold.
    pub summary: Summary,
    /// What checkpoints belong to.
    pub identity: Identity,
    /// The finished load steps.
    pub finished: Vec<StepMeasures>,
    /// How they went.
    pub history: History,
    /// How they went in rigid rock.
    pub flow_history: FlowHistory,
    /// Every iteration, for the page.
    pub iterations: Iterations,
    /// What the page shows of a reduction of strength.
    pub strength_shown: Option<StrengthShown>,
    /// Values of probes after all of them, a table.
    pub probes: ProbeTable,
    /// The results that are kept.
    pub kept: Vec<StepResult>,
    /// The linear solver.
    pub choice: Choice,
    /// What is hardly meant of scene and mesh.
    pub doubts: Vec<String>,
    /// Closed form of each fracture that has one.
    pub oracles: Vec<Option<Oracle>>,
    /// Number of load steps after which the checkpoint that is there goes on.
    pub checkpointed: usize,
    /// Whether the observer wants no more.
    is_stopped: bool,
    /// Whether its mesh came from memory; no checkpoint could tell it from another.
    pub has_own_mesh: bool,
    /// When it would have begun, had a former run not been interrupted.
    start: Instant,
    /// How long the last stage took.
    took: Duration,
    /// What the next mesh is made by.
    meshing: Remeshing,
}

/// How a scene that adapts its mesh gets the next one.
enum Remeshing {
    /// As the geometry says.
    Given,
    /// With these sizes.
    Sized(PathBuf),
    /// Not at all: the last one stays.
    Kept,
}

impl<'a> Run<'a> {
    /// A run of a scene, or of what is left of it.
    pub fn new(
        request: Request<'a>,
        output: Output,
        observer: &'a mut dyn Observer,
        identity: Identity,
        former: Option<&FormerRun>,
    ) -> Self {
        let mut summary = Summary {
            kluft: env!("CARGO_PKG_VERSION"),
            title: request.scene.title.clone(),
            provenance: provenance(&request, &identity),
            threads: rayon::current_num_threads(),
            ..Summary::default()
        };
        let mut start = Instant::now();
        if let Some(former) = former {
            summary.seconds = former.progress.seconds.clone();
            summary.peak_memory_bytes = former.progress.peak_memory_bytes;
            let before = Duration::try_from_secs_f64(summary.seconds.total).unwrap_or_default();
            start = start.checked_sub(before).unwrap_or(start);
        }
        let has_own_mesh = matches!(request.mesh, MeshInput::Draft(_));
        Self {
            request,
            has_own_mesh,
            output,
            observer,
            summary,
            identity,
            finished: Vec::new(),
            history: History::default(),
            flow_history: FlowHistory::default(),
            iterations: Iterations::default(),
            strength_shown: None,
            probes: ProbeTable::default(),
            kept: Vec::new(),
            choice: Choice::default(),
            doubts: Vec::new(),
            oracles: Vec::new(),
            checkpointed: former.map_or(0, |former| former.progress.files.len()),
            is_stopped: false,
            start,
            took: Duration::ZERO,
            meshing: Remeshing::Given,
        }
    }

    /// Tells the observer of an iteration, and asks whether to go on.
    pub fn ask_after(&mut self, number: usize, iteration: &Iteration) -> ControlFlow<()> {
        self.iterations.add(iteration);
        let answer = self.observer.iteration(number, iteration);
        self.is_stopped |= answer.is_break();
        answer
    }

    /// Whether the observer wants more: a load step may converge in the iteration that it stops at.
    ///
    /// # Errors
    /// [`Interruption::Stopped`] if not.
    pub fn go_on_if_asked(&self) -> Result<(), Interruption> {
        match self.is_stopped {
            true => Err(Interruption::Stopped),
            false => Ok(()),
        }
    }

    /// Does the work of a stage: tells the observer and takes the time.
    pub fn stage<T>(&mut self, stage: Stage, work: impl FnOnce(&mut Self) -> T) -> T {
        self.observer.stage_begins(stage);
        let start = Instant::now();
        let result = work(self);
        self.took = start.elapsed();
        if let Some(seconds) = seconds_of(&mut self.summary.seconds, stage) {
            *seconds += self.took.as_secs_f64();
        }
        self.observer.stage_ends(stage, self.took);
        result
    }

    /// Tells what came out of the last stage, and how long it took.
    pub fn note_timed(&mut self, kind: &str, text: &str) {
        let text = format!("{text} ({:.2} s)", self.took.as_secs_f64());
        self.observer.note(kind, &text);
    }

    /// From the scene to a checked problem, whose decisions are taken over.
    ///
    /// # Errors
    /// Defects of geometry, mesh and scene, and a mesh that is not the one of the former run.
    pub fn prepare(&mut self, former: Option<&FormerRun>) -> Result<Binding, Interruption> {
        let mut binding = self.read_mesh(former, |run, draft| run.bind(draft))?;
        self.oracles = std::mem::take(&mut binding.oracles);
        self.note_mesh();
        Ok(binding)
    }

    /// Makes something of the mesh as read.
    ///
    /// # Errors
    /// Defects of the geometry, the mesh and what is made of it.
    pub fn read_mesh<T>(
        &mut self,
        former: Option<&FormerRun>,
        make: impl FnOnce(&mut Self, Draft) -> Result<T, Vec<Defect>>,
    ) -> Result<T, Interruption> {
        let file = match &self.request.mesh {
            MeshInput::OfScene => Some(self.mesh_file(former)?),
            MeshInput::Draft(_) => None,
        };
        let made = self.stage(Stage::Read, |run| {
            let draft = run.draft(file.as_ref(), former)?;
            make(run, draft)
        })?;
        Ok(made)
    }

    /// Tells how large the mesh is.
    pub fn note_mesh(&mut self) {
        let mesh = &self.summary.mesh;
        let size = format!(
            "{} nodes, {} cells, {} fracture facets, at most {} sectors at a node",
            mesh.nodes, mesh.cells, mesh.fracture_facets, mesh.max_sectors
        );
        self.note_timed("read", &size);
    }

    /// The mesh as read; one in memory is taken.
    fn draft(
        &mut self,
        file: Option<&MeshFile>,
        former: Option<&FormerRun>,
    ) -> Result<Draft, Vec<Defect>> {
        let Some(file) = file else {
            return match std::mem::replace(&mut self.request.mesh, MeshInput::OfScene) {
                MeshInput::Draft(draft) => {
                    prepare::check_cells(&draft, self.request.scene.refine)?;
                    Ok(*draft)
                }
                MeshInput::OfScene => Err(Vec::new()),
            };
        };
        let scratch = self.output.unfinished("");
        let scene = self.request.scene;
        let draft = prepare::read_mesh(&file.path, scene.refine, &scratch, &self.request.gmsh)?;
        let fingerprint = fingerprint_of(&file.path);
        self.identity.mesh = fingerprint.map_err(|defect| vec![defect])?;
        let input = InputFile::new(&file.path, self.identity.mesh);
        let inputs = &mut self.summary.provenance.inputs;
        inputs.retain(|known| known.file != input.file);
        inputs.push(input);
        if former.is_some_and(|former| former.mesh != self.identity.mesh) {
            let is_made = file.meshed.is_some();
            return Err(vec![checkpoint::other_mesh(&file.path, is_made)]);
        }
        Ok(draft)
    }

    fn bind(&mut self, draft: Draft) -> Result<Binding, Vec<Defect>> {
        let mut binding = self.request.scene.problem(draft)?;
        self.summary.decisions.append(&mut binding.decisions);
        self.doubts = std::mem::take(&mut binding.warnings);
        self.summary.warnings.clone_from(&self.doubts);
        self.count_mesh(&binding.problem.mesh);
        Ok(binding)
    }

    /// Lets the grids that follow tell their units, and the names of their rocks and fractures.
    fn tell_facts(&mut self, mesh: &Mesh) {
        let rocks = self.request.scene.rocks.iter();
        let rocks: Vec<&str> = rocks.map(|rock| rock.name.as_str()).collect();
        self.summary.facts = facts(&self.summary, &rocks, &mesh.fractures);
        self.output.tell(self.summary.facts.clone());
    }

    /// Sums up the mesh that the grids which follow are of.
    pub fn count_mesh(&mut self, mesh: &Mesh) {
        self.tell_facts(mesh);
        let counts = mesh.sectors.count.iter();
        let own = (0..mesh.nodes.len()).filter(|&node| mesh.is_own(node as u32));
        self.summary.mesh = MeshSummary {
            nodes: match mesh.cells.is_empty() {
                true => mesh.nodes.len(),
                false => own.filter(|&node| mesh.sectors.count[node] > 0).count(),
            },
            cells: mesh.cells.len(),
            fracture_facets: mesh.facets.elements.len(),
            max_sectors: counts.copied().max().unwrap_or(0),
        };
    }

    /// The mesh file; gmsh makes it if it has to.
    fn mesh_file(&mut self, former: Option<&FormerRun>) -> Result<MeshFile, Vec<Defect>> {
        let is_kept = matches!(self.meshing, Remeshing::Kept);
        if is_kept || former.is_some_and(|former| former.mesh_is_kept) {
            return Ok(MeshFile {
                path: self.output.path(prepare::MESH),
                meshed: None,
            });
        }
        let sizes = match &self.meshing {
            Remeshing::Sized(path) => Some(path.as_path()),
            _ => None,
        };
        let scene = self.request.scene;
        let ranks = self.request.ranks;
        let made = match ranks.is_none_or(|ranks| ranks.is_first()) {
            true => prepare::mesh_file(
                scene,
                &self.output,
                sizes,
                &self.request.gmsh,
                self.observer,
            ),
            false => Ok(MeshFile {
                path: match &scene.mesh {
                    MeshSource::Geometry { .. } => self.output.path(prepare::MESH),
                    MeshSource::File(file) => file.clone(),
                },
                meshed: None,
            }),
        };
        let file = agreed(ranks, made)?;
        if let (Some(meshed), MeshSource::Geometry { geometry, .. }) = (&file.meshed, &scene.mesh) {
            self.note_meshed(meshed, &geometry.display().to_string());
        }
        Ok(file)
    }

    /// Tells where a mesh came from.
    fn note_meshed(&mut self, meshed: &Meshed, geometry: &str) {
        self.summary.provenance.gmsh.clone_from(&meshed.version);
        if meshed.is_kept {
            self.summary.seconds.mesh_spared += meshed.seconds;
            let text = format!(
                "{geometry}: nothing that it is made of has changed since it was meshed in {:.2} s \
                 (--remesh meshes again)",
                meshed.seconds
            );
            self.observer.note("mesh kept", &text);
        } else {
            self.summary.seconds.mesh += meshed.seconds;
            self.took = Duration::from_secs_f64(meshed.seconds);
            self.note_timed("meshed", geometry);
        }
    }

    /// Keeps the mesh for what follows.
    pub fn keep_mesh(&mut self) {
        self.meshing = Remeshing::Kept;
    }

    /// Makes the next mesh with the sizes of a file.
    pub fn mesh_again_with(&mut self, sizes: PathBuf) {
        self.meshing = Remeshing::Sized(sizes);
        self.summary.decisions.clear();
    }

    /// Writes the summary of what is finished so far.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write_summary(&mut self) -> Result<(), Defect> {
        self.summary.seconds.total = self.start.elapsed().as_secs_f64();
        let peak = memory::peak_bytes() as u64;
        self.summary.peak_memory_bytes = self.summary.peak_memory_bytes.max(peak);
        if let Some(ranks) = self.request.ranks {
            let peaks = ranks
                .communicator
                .gathered(&[self.summary.peak_memory_bytes]);
            self.summary.ranks = Some(RankSummary {
                count: ranks.count(),
                largest_peak_memory_bytes: peaks.iter().copied().max().unwrap_or(0),
                sum_of_peak_memory_bytes: peaks.iter().sum(),
            });
        }
        if !self.output.is_kept() {
            return Ok(());
        }
        self.output.write(SUMMARY, |path| self.summary.write(path))
    }

    /// Ends the run.
    ///
    /// # Errors
    /// If the summary or the list of files cannot be written.
    pub fn finish(mut self, ending: Ending) -> Result<Outcome, Vec<Defect>> {
        self.close(&ending).map_err(|defect| vec![defect])?;
        Ok(self.into_outcome(ending))
    }

    /// Removes what another run has written, unless this one goes on from it.
    ///
    /// # Errors
    /// If a file cannot be removed.
    pub fn remove_former(&self) -> Result<(), Defect> {
        match self.checkpointed {
            0 => self.output.remove_former(),
            _ => Ok(()),
        }
    }

    fn close(&mut self, ending: &Ending) -> Result<(), Defect> {
        self.summary.ending = Some(ending.clone());
        if self.output.sums().is_empty() {
            // A run may end before its first load step begins: its summary belongs to no grids.
            self.remove_former()?;
        }
        self.write_summary()?;
        self.write_page()?;
        self.output.sync()?;
        if *ending == Ending::Solved {
            self.write_last_checkpoint()?;
        }
        self.output.close()
    }

    fn write_page(&self) -> Result<(), Defect> {
        if !self.output.is_kept() || !self.request.report {
            return Ok(());
        }
        let history = match self.history.text() {
            "" => self.flow_history.text(),
            text => text,
        };
        let told = Told {
            summary: &self.summary,
            history,
            probes: &self.probes.text,
            iterations: &self.iterations,
            shown: self.output.shown(),
            strength: self.strength_shown.as_ref(),
            scene: self.request.origin.map(|origin| origin.text),
        };
        let html = told.html();
        let write = |path: &Path| write_atomically(path, |out| out.write_all(html.as_bytes()));
        self.output.write(page::NAME, write)
    }

    /// What came out of it.
    pub fn into_outcome(self, ending: Ending) -> Outcome {
        Outcome {
            ending,
            summary: self.summary,
            history: self.history.into_text(),
            steps: self.kept,
        }
    }
}

/// Where the time of a stage is added up; that of gmsh and of a load step is told by themselves.
fn seconds_of(seconds: &mut Seconds, stage: Stage) -> Option<&mut f64> {
    match stage {
        Stage::Read => Some(&mut seconds.read),
        Stage::Enrich => Some(&mut seconds.enrich),
        Stage::Assemble => Some(&mut seconds.assemble),
        Stage::ChooseSolver | Stage::PrepareSolver | Stage::RestoreSolver => {
            Some(&mut seconds.factorise)
        }
        Stage::Estimate => Some(&mut seconds.estimate),
        Stage::Write => Some(&mut seconds.write),
        Stage::Mesh | Stage::Solve => None,
    }
}

/// The failure of a linear solver in words.
pub fn solved<T>(result: Result<T, LinearFailure>, system: &System<'_>) -> Result<T, Interruption> {
    result.map_err(|failure| {
        let why = failures::linear_failure(system.problem(), system, &failure);
        Interruption::NotConverged(why)
    })
}

/// The settings of Newton's method that a scene asks for.
pub fn newton_settings(asked: &SolverEntry) -> NewtonSettings {
    let settings = NewtonSettings::default();
    NewtonSettings {
        path: asked.path_accuracy.unwrap_or(settings.path),
        time: asked.time_accuracy.unwrap_or(settings.time),
        ..settings
    }
}
