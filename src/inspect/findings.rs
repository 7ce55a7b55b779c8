//! What an inspection finds, as `--json` prints it. Lengths are in m, stresses in Pa, angles in
//! degrees.

use std::path::Path;

use glam::DVec3;
use kluft_mesh::{Defect, Draft};
use serde::Serialize;

use kluft_run::Hydraulics;
use kluft_scene::Scene;

/// A position (m).
pub type Place = [f64; 3];

/// Everything. Lists stay empty and options none where a defect of the input stood in the way.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Inspection {
    /// Version of the program.
    pub kluft: &'static str,
    /// The file inspected.
    pub input: String,
    /// Title of the scene, if there is one.
    pub title: Option<String>,
    /// Counts.
    pub mesh: MeshCounts,
    /// Physical groups.
    pub groups: Vec<GroupFinding>,
    /// Where outer faces lie on one another.
    pub doubled_surfaces: Vec<DoubledFinding>,
    /// Fractures.
    pub fractures: Vec<FractureFinding>,
    /// Fractures that meet, by pair.
    pub contacts: Vec<ContactFinding>,
    /// Patches of fractures without a jump of their own.
    pub unresolved_patches: Vec<PatchFinding>,
    /// Parts of the rock that fractures cut apart.
    pub blocks: Vec<BlockFinding>,
    /// Which fractures fluid can pass between, if there is a fluid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hydraulics: Option<Hydraulics>,
    /// Quality of the cells.
    pub cells: Option<CellFindings>,
    /// Unknowns.
    pub unknowns: Option<UnknownFindings>,
    /// What solvers will need.
    pub solvers: Vec<SolverFinding>,
    /// Whether walls would pass through each other.
    pub walls: Vec<WallFinding>,
    /// What was decided on the way from the scene to its problem.
    pub decisions: Vec<String>,
    /// What the user should look at.
    pub warnings: Vec<String>,
    /// What is wrong with the input.
    pub defects: Vec<DefectFinding>,
    /// Wall-clock time of the inspection, with gmsh (s).
    pub seconds: f64,
}

/// Numbers of the mesh.
#[derive(Debug, Clone, Default, Serialize)]
pub struct MeshCounts {
    /// Nodes.
    pub nodes: usize,
    /// Cells.
    pub cells: usize,
    /// Surface elements.
    pub facets: usize,
    /// Lowest and highest coordinates (m).
    pub bounds: Option<[Place; 2]>,
}

impl MeshCounts {
    /// What a draft holds.
    pub fn of(draft: &Draft) -> Self {
        Self {
            nodes: draft.nodes.len(),
            cells: draft.cells.elements.len(),
            facets: draft.facets.elements.len(),
            bounds: None,
        }
    }
}

/// A physical group.
#[derive(Debug, Clone, Serialize)]
pub struct GroupFinding {
    /// Name.
    pub name: String,
    /// Dimension, 0 to 3.
    pub dimension: usize,
    /// Number in the file.
    pub tag: i32,
    /// Number of elements; none for points and curves, which are not read.
    pub elements: Option<usize>,
    /// `rock`, `fracture`, `boundary`, `welded`, `free`, `unused` or `unknown`.
    pub role: &'static str,
    /// The rock's section, or what acts on a boundary.
    pub detail: String,
}

/// Outer faces that lie on one another in the file: rock that touches without sharing nodes.
#[derive(Debug, Clone, Serialize)]
pub struct DoubledFinding {
    /// Physical volumes, one or two; an empty name for cells in none.
    pub volumes: Vec<String>,
    /// Physical surfaces that hold some of the faces.
    pub surfaces: Vec<String>,
    /// `doubled nodes`, `not matching` or `same side`.
    pub kind: &'static str,
    /// Number of faces, those of both sides.
    pub faces: usize,
    /// Area on which they lie on one another (m^2).
    pub area: f64,
    /// Middle of one of the largest faces (m).
    pub at: Place,
}

/// A fracture.
#[derive(Debug, Clone, Serialize)]
pub struct FractureFinding {
    /// Name.
    pub name: String,
    /// Number of facets.
    pub facets: usize,
    /// Area (m^2).
    pub area: f64,
    /// Mean dip (degrees); none for a closed surface.
    pub dip: Option<f64>,
    /// Mean dip direction, clockwise from north = +y (degrees); none for a closed surface.
    pub dip_direction: Option<f64>,
    /// Largest angle of a facet against the mean plane (degrees); none for a closed surface.
    pub deviation: Option<f64>,
    /// Whether the surface has no rim.
    pub closed: bool,
    /// Number of separate surfaces.
    pub components: usize,
    /// Lowest and highest coordinates (m).
    pub bounds: [Place; 2],
    /// Edges where it ends in the rock.
    pub tip_edges: usize,
    /// Their length (m).
    pub tip_length: f64,
    /// Edges on the outer surface.
    pub trace_edges: usize,
    /// Their length (m).
    pub trace_length: f64,
    /// Length along which it crosses itself (m).
    pub branching_length: f64,
    /// Its nodes by number of sectors: 3, 4, 5, 6, 7, `8+`.
    pub junction_nodes: SectorCounts,
    /// Its facets without a jump.
    pub unresolved_facets: usize,
    /// The worst cell that touches it.
    pub worst_cell: Option<CellFinding>,
}

/// Nodes by number of sectors.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct SectorCounts {
    /// 3 sectors: a T.
    #[serde(rename = "3")]
    pub three: usize,
    /// 4 sectors: an X.
    #[serde(rename = "4")]
    pub four: usize,
    /// 5 sectors.
    #[serde(rename = "5")]
    pub five: usize,
    /// 6 sectors.
    #[serde(rename = "6")]
    pub six: usize,
    /// 7 sectors.
    #[serde(rename = "7")]
    pub seven: usize,
    /// 8 sectors or more: three planes.
    #[serde(rename = "8+")]
    pub many: usize,
}

impl From<[usize; 6]> for SectorCounts {
    fn from([three, four, five, six, seven, many]: [usize; 6]) -> Self {
        Self {
            three,
            four,
            five,
            six,
            seven,
            many,
        }
    }
}

/// Two fractures that meet.
#[derive(Debug, Clone, Serialize)]
pub struct ContactFinding {
    /// Their names.
    pub fractures: [String; 2],
    /// `crosses`, `first ends on second`, `second ends on first`, `rim to rim` or `touches`: the
    /// longest of these.
    pub kind: &'static str,
    /// Length along which they cross (m).
    pub crossing_length: f64,
    /// Length along which the first ends on the second (m).
    pub first_ends_length: f64,
    /// Length along which the second ends on the first (m).
    pub second_ends_length: f64,
    /// Length along which both end (m).
    pub rim_length: f64,
    /// Number of nodes they share.
    pub nodes: usize,
    /// Smallest angle between them (degrees).
    pub smallest_angle: Option<f64>,
    /// Where that is (m).
    pub at: Place,
}

/// A patch without a jump.
#[derive(Debug, Clone, Serialize)]
pub struct PatchFinding {
    /// Name of its fracture.
    pub fracture: String,
    /// Number of facets.
    pub facets: usize,
    /// Area (m^2).
    pub area: f64,
    /// Its middle (m).
    pub at: Place,
    /// Whether it is a whole component of the fracture and not a corner of one.
    pub whole: bool,
}

/// A block of rock.
#[derive(Debug, Clone, Serialize)]
pub struct BlockFinding {
    /// Number of cells.
    pub cells: usize,
    /// Volume (m^3).
    pub volume: f64,
    /// Lowest and highest coordinates (m).
    pub bounds: [Place; 2],
    /// Boundaries it has a part of.
    pub boundaries: Vec<String>,
    /// Fractures it has a part of.
    pub fractures: Vec<String>,
    /// Whether a support holds some of it; none without a scene.
    pub supported: Option<bool>,
    /// Whether a load acts on its surface; none without a scene.
    pub loaded: Option<bool>,
    /// Whether nothing but fractures holds it; none without a scene.
    pub held_by_fractures_only: Option<bool>,
}

/// The cells.
#[derive(Debug, Clone, Serialize)]
pub struct CellFindings {
    /// What quality means.
    pub measure: &'static str,
    /// Mean quality.
    pub mean_quality: f64,
    /// Number of cells in each tenth from 0 to 1.
    pub histogram: [usize; 10],
    /// The worst cells.
    pub worst: Vec<CellFinding>,
    /// The worst cells with a node on a fracture.
    pub worst_at_fractures: Vec<CellFinding>,
}

/// A cell.
#[derive(Debug, Clone, Serialize)]
pub struct CellFinding {
    /// Number in the file.
    pub tag: u64,
    /// Quality, 0 to 1.
    pub quality: f64,
    /// Smallest dihedral angle (degrees).
    pub smallest_angle: f64,
    /// Largest dihedral angle (degrees).
    pub largest_angle: f64,
    /// Its middle (m).
    pub at: Place,
    /// Fractures it touches.
    pub fractures: Vec<String>,
}

/// Scalar unknowns.
#[derive(Debug, Clone, Serialize)]
pub struct UnknownFindings {
    /// All; those that supports hold are left out if `without_held`.
    pub total: usize,
    /// Whether `total` leaves held directions out.
    pub without_held: bool,
    /// Components of jumps.
    pub jumps: usize,
    /// Nodes in intact rock and on tips: 1 sector.
    pub plain_nodes: usize,
    /// Nodes inside one fracture: 2 sectors.
    pub fracture_nodes: usize,
    /// Nodes with more sectors.
    pub junction_nodes: SectorCounts,
}

/// What a solver will need: a prediction.
#[derive(Debug, Clone, Serialize)]
pub struct SolverFinding {
    /// Name of the solver.
    pub name: &'static str,
    /// Always true: nothing has been solved.
    pub is_prediction: bool,
    /// Whether a run would choose it.
    pub is_chosen: bool,
    /// Entries of the Cholesky factor; 0 without one.
    pub factor_entries: usize,
    /// Memory of the solver at its largest, mesh and matrix not included (bytes).
    pub memory_bytes: usize,
    /// Floating-point operations of one factorisation; 0 without one.
    pub operations: f64,
    /// Time of all linear solves of the run on an ordinary machine (s).
    pub seconds: f64,
}

/// Whether the walls of a fracture would pass through each other.
#[derive(Debug, Clone, Serialize)]
pub struct WallFinding {
    /// Name of the fracture.
    pub fracture: String,
    /// `linear`, `logarithmic with cutoff`, `logarithmic` or `free crack`.
    pub law: &'static str,
    /// Compression at which the walls meet (Pa); none if they never do.
    pub limit: Option<f64>,
    /// Compression that the loads suggest (Pa); none if displacements are prescribed.
    pub expected: Option<f64>,
    /// `never`, `no`, `yes` or `unknown`.
    pub overlap: &'static str,
}

/// A defect of the input.
#[derive(Debug, Clone, Serialize)]
pub struct DefectFinding {
    /// Where.
    pub place: String,
    /// What.
    pub problem: String,
    /// What to do.
    pub remedy: String,
}

impl From<&Defect> for DefectFinding {
    fn from(defect: &Defect) -> Self {
        Self {
            place: defect.place.clone(),
            problem: defect.problem.clone(),
            remedy: defect.remedy.clone(),
        }
    }
}

impl Inspection {
    /// Starts with what needs no look at the mesh.
    pub fn of(input: &Path, scene: Option<&Scene>, draft: &Draft) -> Self {
        Self {
            kluft: env!("CARGO_PKG_VERSION"),
            input: input.display().to_string(),
            title: scene.map(|scene| scene.title.clone()),
            mesh: MeshCounts::of(draft),
            ..Self::default()
        }
    }
}

impl DoubledFinding {
    /// The volumes, with the surfaces on their faces, in words.
    pub fn between(&self) -> String {
        let volumes = self.volumes.iter().map(|name| match name.is_empty() {
            true => "cells in no physical volume".to_owned(),
            false => format!("`{name}`"),
        });
        let volumes: Vec<String> = volumes.collect();
        let surfaces = match self.surfaces.as_slice() {
            [] => String::new(),
            names => format!(" on `{}`", names.join("`, `")),
        };
        format!("{}{surfaces}", volumes.join(" and "))
    }
}

/// Lowest and highest coordinates as they are printed.
pub fn box_of((low, high): (DVec3, DVec3)) -> [Place; 2] {
    [low.to_array(), high.to_array()]
}
