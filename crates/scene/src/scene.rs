//! A scene: what is meshed, of what rock, cut by which fractures, under which loads.

use std::path::{Path, PathBuf};

use kluft_mesh::{Defect, Draft};
use kluft_solver::LinearMethod;
use lie_core::FacetQuadrature;

use crate::conditions::{BodyEntry, BoundaryEntry, FixedPointEntry, FractureEntry};
use crate::fluid::{FluidEntry, SourceEntry};
use crate::history::{PhaseEntry, Timetable};
use crate::initial_stress::InitialStressEntry;
use crate::oracle::Oracle;
use crate::probe::ProbeEntry;
use crate::rock::RockEntry;
use crate::strength::StrengthReduction;

/// Something the scene says about a named group, and where it says so.
#[derive(Debug, Clone)]
pub struct Named<T> {
    /// Name of the group, or `default`.
    pub name: String,
    /// File and line.
    pub place: String,
    /// What it says.
    pub value: T,
}

/// Where the mesh comes from.
#[derive(Debug, Clone)]
pub enum MeshSource {
    /// A gmsh geometry.
    Geometry {
        /// The .geo file.
        geometry: PathBuf,
        /// Values handed to gmsh.
        parameters: Vec<(String, f64)>,
        /// Order of the elements, 1 or 2.
        order: u32,
        /// Whether only fractures and outer faces are meshed.
        surfaces_alone: bool,
        /// How far to refine it, if not as the geometry says.
        adapt: Option<Adapt>,
    },
    /// A mesh file.
    File(PathBuf),
}

/// A mesh that follows the estimated error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adapt {
    /// Largest estimated error of the mean jump of a fracture, as a share of it.
    pub tolerance: f64,
    /// Unknowns beyond which no mesh goes.
    pub max_unknowns: f64,
    /// Most meshes.
    pub max_rounds: usize,
    /// How the next mesh is made.
    pub by: AdaptBy,
}

/// How a mesh that follows the error becomes finer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AdaptBy {
    /// gmsh makes it anew.
    Meshing,
    /// Its tetrahedra are bisected.
    Bisection,
}

/// What is asked of the linear solver.
#[derive(Debug, Clone, Copy, Default)]
pub struct SolverEntry {
    /// The solver; chosen by predicted cost if not given.
    pub linear: Option<LinearMethod>,
    /// Memory it may take (bytes); what the machine has free if not given.
    pub memory_limit: Option<f64>,
    /// Largest difference between a load step in one part and in two, against the largest jump,
    /// where the path of the loads matters; 1e-3 if not given.
    pub path_accuracy: Option<f64>,
    /// Largest difference between a step in time in one increment and in two.
    pub time_accuracy: Option<f64>,
    /// How fractures are integrated over their facets.
    pub facets: FacetQuadrature,
}

/// What becomes of networks of fractures that no pressure and no rate acts on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Isolated {
    /// They are refused by their names.
    #[default]
    Refused,
    /// They are left out of the flow.
    Inactive,
    /// They keep the fluid that they hold, also those whose rates add up to zero.
    Undrained,
}

/// A scene, all values in SI units.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Its title.
    pub title: String,
    /// Its mesh.
    pub mesh: MeshSource,
    /// Metres that one unit of the coordinates of the mesh is.
    pub scale: f64,
    /// Whether second-order cells at crack fronts become quarter-point elements.
    pub quarter_points: bool,
    /// Whether nodes at one place become one node.
    pub weld: bool,
    /// How many times each cell is divided into eight.
    pub refine: u32,
    /// Rocks by physical volume.
    pub rocks: Vec<Named<RockEntry>>,
    /// Fractures by physical surface.
    pub fractures: Vec<Named<FractureEntry>>,
    /// Conditions by physical surface.
    pub boundaries: Vec<Named<BoundaryEntry>>,
    /// Nodes held by themselves.
    pub fixed_points: Vec<Named<FixedPointEntry>>,
    /// What acts in all of the rock.
    pub body: BodyEntry,
    /// What flows in the fractures.
    pub fluid: Option<Named<FluidEntry>>,
    /// What becomes of networks that nothing drives.
    pub isolated: Isolated,
    /// Whether the equivalent permeability is asked for.
    pub equivalent_permeability: bool,
    /// Boreholes.
    pub sources: Vec<Named<SourceEntry>>,
    /// Stress before any load.
    pub initial_stress: Option<InitialStressEntry>,
    /// Load steps.
    pub timetable: Timetable,
    /// What is asked of the linear solver.
    pub solver: SolverEntry,
    /// How far strength is reduced after the last load step, if it is.
    pub strength_reduction: Option<StrengthReduction>,
    /// Probes.
    pub probes: Vec<Named<ProbeEntry>>,
    /// Closed forms by fracture.
    pub oracles: Vec<Named<Oracle>>,
    /// What is a defect if the mesh is one of the plane: values that vary along z.
    pub in_plane: Vec<Defect>,
    /// Values that are possible but hardly meant, each with its place.
    pub warnings: Vec<String>,
    /// Names of the warnings that are not told.
    pub silenced: Vec<&'static str>,
}

impl Scene {
    /// A mesh as read, its coordinates in metres, and one cell thick if it is of the plane.
    pub fn taken(&self, mut draft: Draft) -> Draft {
        if self.scale != 1.0 {
            draft.scale(self.scale);
        }
        match self.is_of_plane(&draft) {
            true => draft.extruded(),
            false => draft,
        }
    }

    /// Whether a mesh is one of the plane. In rigid rock a flat surface may be a fracture, unless
    /// fractures are lines.
    fn is_of_plane(&self, draft: &Draft) -> bool {
        let is_line = |name: &str| {
            let mut groups = draft.groups.iter();
            groups.any(|group| group.dimension == 1 && group.name == name)
        };
        let mut fractures = self.fractures.iter();
        draft.is_plane() && (!self.is_rigid() || fractures.any(|entry| is_line(&entry.name)))
    }

    /// The files that values come from, each once, in the order of the scene.
    pub fn value_files(&self) -> Vec<&Path> {
        let fractures = self.fractures.iter();
        let fractures = fractures.flat_map(|entry| entry.value.varying());
        let loads = self
            .boundaries
            .iter()
            .flat_map(|entry| entry.value.fields());
        let fixed = self.fixed_points.iter();
        let fixed = fixed.flat_map(|entry| &entry.value.fields);
        let loads = loads.chain(fixed.map(|(_, field)| field));
        let rocks = self.rocks.iter().flat_map(|entry| entry.value.varying());
        let fractures = rocks.chain(fractures);
        let stress = self.initial_stress.iter().flat_map(|entry| &entry.fields);
        let fluid = self.fluid.iter();
        let fluid = fluid.filter_map(|entry| entry.value.initial_pressure.field.as_ref());
        let sources = self.sources.iter();
        let sources = sources.filter_map(|entry| entry.value.drive.field.as_deref());
        let mut files: Vec<&Path> = Vec::new();
        for file in fractures
            .chain(loads)
            .chain(stress)
            .chain(fluid)
            .chain(sources)
            .filter_map(|field| field.file.as_deref())
        {
            if !files.contains(&file) {
                files.push(file);
            }
        }
        files
    }

    /// The phases, if the load steps have any.
    pub fn phases(&self) -> &[PhaseEntry] {
        self.timetable.phases()
    }

    /// Whether phases remove or add volumes.
    pub fn has_stages(&self) -> bool {
        self.timetable.has_stages()
    }

    /// Whether the rock is rigid, and flow is all that happens.
    pub fn is_rigid(&self) -> bool {
        self.fluid.is_some() && self.rocks.iter().all(|entry| entry.value.rock.is_rigid())
    }
}
