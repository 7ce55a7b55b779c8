//! A run as a library: a scene and a mesh go in, the results of all load steps come out as values.
//!
//! [`run`] takes a [`Request`] (scene, mesh, thread pool, where results go) and an [`Observer`],
//! and returns an [`Outcome`]. It prints nothing, sets nothing global and ends no process; two runs
//! with different numbers of threads may work side by side.
//!
//! | file | part of a run |
//! |---|---|
//! | `run` | the story: former run, mesh, problem, load steps, summary |
//! | `stages`, `steps` | what is computed once, and what at each load step |
//! | `step_results` | what is taken of a load step that was solved |
//! | `strength`, `strength_motion`, `strength_summary` | the factor of safety, by strength reduction |
//! | `sequence` | one body after the other, where phases remove and add volumes |
//! | `advance`, `cases` | load steps on prepared rock, as a caller asks for them |
//! | `flow`, `flow_summary` | the flow of a run, and its numbers |
//! | `permeability`, `flow_history` | the equivalent permeability; the history of a flow |
//! | `rigid`, `fluid_step` | flow alone in rigid rock; what a fluid adds in rock that deforms |
//! | `prepare`, `adapt` | the mesh file; the search for a mesh that meets a tolerance |
//! | `summary`, `measure`, `measures`, `accuracy` | the numbers of a run, and how accurate they are |
//! | `ranks`, `pieces` | a run that many processes share, and what each of them writes |
//! | `output`, `grids`, `checkpoint`, `resume`, `former`, `save` | files |
//! | `page`, `provenance`, `machine` | the page of a run; what it was made with |
//! | `decisions`, `failures` | what the program decided, and why a run failed, in words |
//!
//! ```
//! use kluft_run::{Ending, MeshInput, Request, run};
//! use kluft_scene::Scene;
//!
//! let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../geometries/closing-blocks");
//! let scene = Scene::read(&std::path::Path::new(folder).join("scene.toml")).expect("a scene");
//! # let is_meshed = kluft_io::gmsh::version(&Default::default()).is_some();
//! # if !is_meshed { return; }
//! let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
//! let request = Request::in_memory(&scene, MeshInput::OfScene, &pool);
//! let outcome = run(request, &mut ()).expect("no defects");
//! assert_eq!(outcome.ending, Ending::Solved);
//! let last = outcome.steps.last().expect("a load step");
//! assert!(last.fractures.iter().all(|(_, numbers)| numbers.aperture.min > 0.0));
//! ```

mod accuracy;
mod adapt;
mod advance;
mod begin;
mod cases;
mod checkpoint;
mod choice;
mod choose;
mod crack_front;
mod decisions;
mod doubts;
mod ending;
mod facts;
mod failures;
mod flow;
mod flow_history;
mod flow_summary;
mod fluid_step;
mod former;
mod fractures;
mod grids;
mod history;
mod json;
mod machine;
mod measure;
mod measures;
pub mod memory;
mod observer;
mod outcome;
mod output;
mod page;
mod permeability;
mod permeability_summary;
mod pieces;
mod prepare;
mod probes;
mod progress;
mod provenance;
mod rank_plan;
mod ranks;
mod request;
mod resume;
mod rigid;
mod rows;
mod run;
mod save;
mod sequence;
mod set_up;
mod spread;
mod stages;
mod step_files;
mod step_results;
mod steps;
mod strength;
mod strength_motion;
mod strength_summary;
mod summary;
mod threads;
mod undetermined;
mod unresolved;

pub use advance::{Advance, PreparedRock, with_prepared_rock};
pub use cases::{ActingCases, GRAVITY};
pub use ending::Ending;
pub use failures::too_large;
pub use flow::RunFlow;
pub use flow_summary::{
    ConduitSummary, FlowSummary, Hydraulics, NetworkSummary, SourceFlow, StepFlow,
};
pub use grids::{integer_field, real_field};
pub use machine::Machine;
pub use measure::Measure;
pub use observer::{Observer, Stage, StepStart};
pub use outcome::{Outcome, StepResult};
pub use output::Output;
pub use page::NAME as REPORT;
pub use permeability_summary::{PermeabilitySummary, PrincipalPermeability, TensorSummary};
pub use prepare::{MESH, folder_for, inputs, mesh_file, read_mesh, unfinished_mesh_file};
pub use provenance::{InputFile, Provenance};
pub use ranks::Ranks;
pub use request::{Caller, MeshInput, Origin, Request};
pub use run::run;
pub use save::Saving;
pub use spread::Spread;
pub use stages::Interruption;
pub use strength_summary::{MotionSummary, StrengthSummary, Trial};
pub use summary::{
    FractureSummary, RankSummary, StepFracture, StepMeasures, StepSummary, Summary, Undetermined,
};
pub use threads::{ThreadCount, pool, thread_count};
