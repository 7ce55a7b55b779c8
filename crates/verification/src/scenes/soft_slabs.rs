//! A joint between soft slabs that nothing holds together, filled with water: each part of it opens
//! by what the pressure there does to its law, so that one equation of the aperture says all.

use glam::DVec3;
use kluft_mesh::structured::Patch;
use kluft_mesh::{Mesh, Shape};
use kluft_solver::{
    Condition, Discretisation, Field, Flow, FlowState, FlowSystem, Fracture, InitialStress, Load,
    Newton, NewtonSettings, Problem, Schedule, State, Step, StepRecord, Support, SurfaceLoad,
    System, unobserved,
};
use lie_core::{Closure, FractureLaw, Rock};

use super::flow::block;

/// Soft enough to carry no load from one part of the joint to the next (Pa).
const YOUNG_MODULUS: f64 = 1e4;

/// Slabs of `n` by 1 by 2 cells, 1 m high; `bend` moves the nodes of the unit cube, z stays.
fn slabs(shape: Shape, n: usize, bend: impl Fn([f64; 2]) -> [f64; 2]) -> Mesh {
    let surfaces = [
        Patch::new("joint", &|x| x[2] == 0.5),
        Patch::new("side left", &|x| x[0] == 0.0),
        Patch::new("side right", &|x| x[0] == 1.0),
        Patch::new("side bottom", &|x| x[2] == 0.0),
        Patch::new("side top", &|x| x[2] == 1.0),
    ];
    block(shape, ([n, 1, 2], [1.0; 3]), &surfaces, |[x, y, z]| {
        let [x, y] = bend([x, y]);
        [x, y, z]
    })
}

/// Slabs of a length and width (m). Cells grow from the left end by the power `growth` of the share
/// of the length: 1 leaves them equal.
pub fn strip(shape: Shape, n: usize, [length, width]: [f64; 2], growth: f64) -> Mesh {
    slabs(shape, n, |[x, y]| [length * x.powf(growth), width * y])
}

/// A thin sector, whose chords are off by the square of its angle; `radius` (m) by the share of the
/// way outwards.
pub fn sector(shape: Shape, n: usize, radius: impl Fn(f64) -> f64) -> Mesh {
    slabs(shape, n, |[x, y]| {
        let (sine, cosine) = (SECTOR * (y - 0.5)).sin_cos();
        [radius(x) * cosine, radius(x) * sine]
    })
}

/// A radius (m) between two others, whose logarithm grows evenly.
pub fn logarithmic([inner, outer]: [f64; 2]) -> impl Fn(f64) -> f64 {
    move |share| inner * (outer / inner).powf(share)
}

/// Angle of a sector (rad).
pub const SECTOR: f64 = 0.01;

/// The joint with a closure under a normal stress (Pa, pressure positive) from the beginning.
pub fn problem(mesh: &Mesh, closure: Closure, pressed: f64, schedule: Schedule) -> Problem {
    let rock = Rock {
        young_modulus: YOUNG_MODULUS,
        poisson_ratio: 0.0,
        density: 0.0,
        anisotropy: None,
    };
    let side = |name: &str| mesh.boundaries.iter().position(|side| side.name == name);
    let mut initial_stress = InitialStress::default();
    initial_stress.components[2] = Field::constant(-pressed);
    Problem {
        fractures: vec![Fracture {
            law: FractureLaw::elastic(closure, closure.normal_stiffness),
            fluid_pressure: 0.0,
        }],
        conditions: vec![
            Condition {
                boundary: side("side bottom").expect("a side"),
                load: None,
                support: Some(Support::Displacement([Some(0.0); 3])),
            },
            Condition {
                boundary: side("side top").expect("a side"),
                load: Some(SurfaceLoad::Pressure(pressed)),
                support: None,
            },
        ],
        initial_stress: Some(initial_stress),
        schedule,
        ..Problem::of_rock(mesh.clone(), rock)
    }
}

/// Load steps that end at these times (s) and factors of what drives the flow, which begins
/// suddenly; the normal stress stays.
pub fn times(steps: impl IntoIterator<Item = (f64, f64)>) -> Schedule {
    let steps = steps.into_iter().map(|(time, factor)| Step {
        load: Load {
            time,
            factors: vec![1.0, factor],
        },
        phase: None,
    });
    Schedule {
        steps: steps.collect(),
        is_timed: true,
        sudden: vec![1.0; 2],
        ..Schedule::proportional(vec![1.0])
    }
}

/// One step to the steady state.
pub fn steady() -> Schedule {
    let mut schedule = times([(1.0, 1.0)]);
    schedule.is_timed = false;
    schedule
}

/// Load case of what drives the flow in [`times`].
pub const DRIVEN: usize = 1;

/// How many equal steps to an end (s), what drives the flow standing still.
pub fn equal_steps(count: usize, end: f64) -> Schedule {
    times((1..=count).map(|step| (end * step as f64 / count as f64, 1.0)))
}

/// What implicit steps of no length would give, by what so many steps gave and twice as many.
pub fn extrapolated(few: &[f64], many: &[f64]) -> Vec<f64> {
    let pairs = few.iter().zip(many);
    pairs.map(|(few, many)| 2.0 * many - few).collect()
}

/// Steps as they are given, never divided for the accuracy in time.
pub fn as_given() -> NewtonSettings {
    NewtonSettings {
        time: 1.0,
        ..NewtonSettings::default()
    }
}

/// The end of a load step.
pub struct Frame {
    /// How it was solved.
    pub record: StepRecord,
    /// The flow.
    pub flow: FlowState,
    /// Apertures at the nodes of the pressures (m).
    pub apertures: Vec<f64>,
}

/// A path of load steps.
pub struct Path {
    /// Where the pressures are (m).
    pub places: Vec<DVec3>,
    /// One for each load step that converged.
    pub frames: Vec<Frame>,
    /// The load step that did not.
    pub failed: Option<StepRecord>,
    /// The state at the end.
    pub state: State,
    /// Number of unknowns, pressures among them.
    pub unknowns: usize,
}

impl Path {
    /// The end of the path, all of whose steps must have converged.
    ///
    /// # Panics
    /// If one did not.
    pub fn end(&self) -> &Frame {
        assert!(self.failed.is_none(), "{:#?}", self.failed);
        self.frames.last().expect("steps")
    }

    /// Largest share that nodes miss of what moves, in all steps where rounding does not explain
    /// it; 0 if there are none.
    pub fn mass_error(&self) -> f64 {
        let balances = self.frames.iter().map(|frame| frame.flow.balance);
        let unexplained = balances.filter(|balance| balance.mass_error > balance.rounding);
        unexplained
            .map(|balance| balance.mass_error)
            .fold(0.0, f64::max)
    }

    /// Most Newton iterations of a part of a step.
    pub fn iterations(&self) -> usize {
        let parts = self.frames.iter().flat_map(|frame| &frame.record.substeps);
        parts.copied().max().unwrap_or(0)
    }
}

/// Solves all load steps, up to the first that does not converge.
pub fn path(problem: &Problem, flow: &Flow, settings: NewtonSettings) -> Path {
    let discretisation = Discretisation::of(problem).unwrap_or_else(|d| panic!("{d:?}"));
    let mut system = System::assemble(problem, discretisation);
    system.couple(flow).unwrap_or_else(|d| panic!("{d:?}"));
    let nodes = pressure_nodes(problem, flow);
    let mut newton = Newton::new(&system, settings).expect("analysis");
    let mut state = system.initial_state();
    let mut path = Path {
        places: places(&problem.mesh, &nodes),
        frames: Vec::new(),
        failed: None,
        unknowns: system.discretisation().unknown_count() + nodes.len(),
        state: state.clone(),
    };
    for step in &problem.schedule.steps {
        let record = newton.solve_step(&system, &mut state, &step.load, unobserved);
        if !record.converged() {
            path.failed = Some(record);
            break;
        }
        path.frames.push(frame(&system, &state, record, &nodes));
    }
    path.state = state;
    path
}

fn frame(system: &System<'_>, state: &State, record: StepRecord, nodes: &[u32]) -> Frame {
    let coupling = system.coupling().expect("coupled");
    let fluid = state.fluid.as_ref().expect("a fluid");
    let facets = &system.problem().mesh.facets.elements;
    let mut apertures = vec![f64::NAN; nodes.len()];
    for (node, point) in facets.nodes.iter().zip(&state.facet_points) {
        if let Ok(row) = nodes.binary_search(node) {
            apertures[row] = point.joint.separation.aperture;
        }
    }
    Frame {
        flow: coupling.state(fluid, &state.load),
        apertures,
        record,
    }
}

/// The nodes that have a pressure, ascending.
fn pressure_nodes(problem: &Problem, flow: &Flow) -> Vec<u32> {
    let apertures = vec![1.0; problem.mesh.facets.elements.nodes.len()];
    let system = FlowSystem::of(&problem.mesh, flow, &apertures);
    system.unwrap_or_else(|d| panic!("{d:?}")).nodes().to_vec()
}

fn places(mesh: &Mesh, nodes: &[u32]) -> Vec<DVec3> {
    let of = |&node: &u32| mesh.nodes[node as usize];
    nodes.iter().map(of).collect()
}
