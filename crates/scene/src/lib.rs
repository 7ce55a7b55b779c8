//! What a user may say: the scene file, its reader, and where it meets a mesh.
//!
//! [`Scene::read`] turns a TOML file into a [`Scene`], or into every defect of the file, each with
//! its line and a remedy. [`Scene::problem`] is the only way from a scene and a mesh as read to a
//! problem that a solver takes. Values are in SI units.

mod anisotropy;
mod bind;
mod bind_conduits;
mod bind_displacements;
mod bind_fields;
mod bind_flow;
mod bind_probes;
mod bind_rocks;
mod bisected_curves;
mod cases;
mod conditions;
mod conduit;
mod doubts;
mod drive;
mod field;
mod fluid;
mod fluid_doubts;
mod fracture;
mod history;
mod initial_stress;
mod isolated;
mod join;
mod lines;
mod load;
mod look;
mod oracle;
mod place;
mod placed;
mod point_contacts;
mod probe;
mod profile;
mod read;
pub mod reader;
mod refine;
mod remedies;
mod rock;
mod roles;
mod scene;
mod setting;
mod sources;
mod stage_plans;
mod stages;
mod strength;
mod surfaces;
mod timed_cases;
mod warning;
mod words;
mod wrong_boundaries;

pub use bind::{Binding, bind};
pub use bind_probes::{Hit, Probe, ProbePoint};
pub use conditions::{
    BodyEntry, BoundaryEntry, FixedPointEntry, FractureEntry, LoadEntry, SpringEntry,
    VaryingLoadEntry,
};
pub use drive::{DriveEntry, PressureEntry};
pub use field::FieldEntry;
pub use fluid::{FluidEntry, LeakoffEntry, SourceEntry, SourcePlace};
pub use fracture::{read_fracture, refused_keys};
pub use history::{LoadHistory, PhaseEntry, StepEnd, Timetable};
pub use initial_stress::InitialStressEntry;
pub use join::{JoinedDraft, join};
pub use load::Clock;
pub use oracle::{Extent, JumpProfile, Oracle};
pub use place::SurfacePlace;
pub use placed::name_places;
pub use probe::{ProbeEntry, ProbedPart};
pub use read::check_conditions;
pub use refine::refine;
pub use remedies::in_terms_of_scene;
pub use rock::RockEntry;
pub use roles::{Roles, repeated_name, roles};
pub use scene::{Adapt, AdaptBy, Isolated, MeshSource, Named, Scene, SolverEntry};
pub use setting::{FluidUse, Setting};
pub use stages::{StageBinding, Staged};
pub use strength::StrengthReduction;
pub use surfaces::{SurfaceMesh, surface_mesh};
pub use warning::Doubt;
pub use words::counted;
