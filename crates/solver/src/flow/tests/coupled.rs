//! Flow that follows the walls of a joint between two slabs, and opens it.
//!
//! The slabs are soft against the joint and nothing holds them together, so that each part of the
//! joint opens by what the pressure there does to its law.

use glam::DVec3;
use kluft_field::Field;
use kluft_mesh::structured::Patch;
use kluft_mesh::{Mesh, Shape};
use lie_core::{Closure, ClosureKind, FractureLaw, Rock};

use super::{SHAPES, block, flow, is_close, on_side, pressure, times};
use crate::flow::FlowState;
use crate::newton::{Newton, NewtonSettings, StepRecord, unobserved};
use crate::problem::{
    Condition, Flow, FlowCondition, Fracture, InitialStress, Problem, Schedule, Support,
    SurfaceLoad,
};
use crate::system::{Discretisation, State, System};

pub(super) const NORMAL_STIFFNESS: f64 = 1e11;
pub(super) const APERTURE: f64 = 1e-5;

/// A slab of `n` by 1 by 2 cells and this length (m), its joint half way up.
pub(super) fn slab(shape: Shape, n: usize, length: f64) -> Mesh {
    bent_slab(shape, n, length, |x| x)
}

/// The same with cells that `along` moves along it.
fn bent_slab(shape: Shape, n: usize, length: f64, along: impl Fn(f64) -> f64) -> Mesh {
    let right = move |x: [f64; 3]| x[0] == length;
    let surfaces = [
        Patch::new("joint", &|x| x[2] == 0.5),
        Patch::new("side left", &|x| x[0] == 0.0),
        Patch::new("side right", &right),
        Patch::new("side bottom", &|x| x[2] == 0.0),
        Patch::new("side top", &|x| x[2] == 1.0),
        Patch::new("side front", &|x| x[1] == 0.0),
        Patch::new("side back", &|x| x[1] == 1.0),
    ];
    let bend = |[x, y, z]: [f64; 3]| [along(x), y, z];
    block(shape, ([n, 1, 2], [length, 1.0, 1.0]), &surfaces, bend)
}

pub(super) fn linear() -> Closure {
    Closure::new(APERTURE, NORMAL_STIFFNESS, ClosureKind::Linear)
}

pub(super) fn problem(mesh: &Mesh, closure: Closure, schedule: Schedule) -> Problem {
    let rock = Rock {
        young_modulus: 1e7,
        poisson_ratio: 0.0,
        density: 0.0,
        anisotropy: None,
    };
    let side = |name: &str| mesh.boundaries.iter().position(|side| side.name == name);
    let held = |name: &str, support: Support| Condition {
        boundary: side(name).expect("a side"),
        load: None,
        support: Some(support),
    };
    Problem {
        fractures: vec![Fracture {
            law: FractureLaw::elastic(closure, NORMAL_STIFFNESS),
            fluid_pressure: 0.0,
        }],
        conditions: vec![
            held("side bottom", Support::Displacement([Some(0.0); 3])),
            held("side front", Support::Symmetry),
            held("side back", Support::Symmetry),
        ],
        schedule,
        ..Problem::of_rock(mesh.clone(), rock)
    }
}

/// A path of load steps.
pub(super) struct Path {
    pub(super) records: Vec<StepRecord>,
    pub(super) state: FlowState,
    pub(super) walls: State,
}

pub(super) fn solved(problem: &Problem, flow: &Flow) -> Path {
    let discretisation = Discretisation::of(problem).expect("held");
    let mut system = System::assemble(problem, discretisation);
    system.couple(flow).expect("sound");
    let settings = NewtonSettings {
        time: 1.0,
        ..NewtonSettings::default()
    };
    let mut newton = Newton::new(&system, settings).expect("analysis");
    let mut walls = system.initial_state();
    let steps = problem.schedule.steps.iter();
    let records = steps.map(|step| {
        let record = newton.solve_step(&system, &mut walls, &step.load, unobserved);
        assert!(record.converged(), "{record:#?}");
        record
    });
    let records = records.collect();
    let coupling = system.coupling().expect("coupled");
    let fluid = walls.fluid.as_ref().expect("a fluid");
    let state = coupling.state(fluid, &walls.load);
    Path {
        records,
        state,
        walls,
    }
}

pub(super) fn ends(mesh: &Mesh, left: f64, right: f64) -> Vec<FlowCondition> {
    vec![
        on_side(mesh, "side left", pressure(left)),
        on_side(mesh, "side right", pressure(right)),
    ]
}

/// With a linear law `b^4` is linear: `q = K_n (b_1^4 - b_2^4) / (48 mu L)`, of second order in the
/// size of the cells, and better where jumps are of second order.
#[test]
fn a_steady_flow_opens_its_joint() {
    for shape in SHAPES {
        let errors = [8, 16].map(|n| {
            let mesh = slab(shape, n, 2.0);
            let problem = problem(&mesh, linear(), Schedule::proportional(vec![1.0]));
            let flow = flow(&mesh, ends(&mesh, 9e5, 0.0));
            let path = solved(&problem, &flow);
            assert!(path.records[0].iterations.len() <= 6, "{shape:?}");
            assert!(path.state.balance.mass_error <= 1e-10, "{shape:?}");
            (path.state.conditions[0].rate / 1.253_344e-7 - 1.0).abs()
        });
        assert!(errors[1] < 1.5e-3, "{shape:?} {errors:?}");
        let is_second_order = (3.5..4.5).contains(&(errors[0] / errors[1]));
        assert!(is_second_order || errors[1] < 1e-6, "{shape:?} {errors:?}");
    }
}

/// The similarity solution of `b_t = (b^3 K_n b_x)_x / (12 mu)` (Wijesinghe 1986): what has entered
/// after 100 s, of first order in the time step where that decides.
#[test]
fn a_joint_fills_as_the_similarity_solution_says() {
    for shape in [Shape::Tet4, Shape::Hex8, Shape::Prism6] {
        let mesh = slab(shape, 100, 25.0);
        let problem = problem(&mesh, linear(), times(100.0, 20));
        let flow = flow(&mesh, ends(&mesh, 9e5, 0.0)[..1].to_vec());
        let path = solved(&problem, &flow);
        is_close(path.state.entered[0], 1.868_300e-5, 5e-3);
        for record in &path.records {
            assert!(
                record.substeps.iter().all(|count| *count <= 6),
                "{record:#?}"
            );
        }
        assert!(path.state.balance.mass_error <= 1e-10, "{shape:?}");
    }
}

/// Stiff rock with cells that are fine at the inlet carries the opening on, and closes the joint
/// ahead of it: a law that is linear would let its walls pass through each other on the way.
#[test]
fn a_linear_joint_in_stiff_rock_fills_in_one_increment() {
    let substeps = filled_in_stiff_rock(linear());
    assert!(substeps.len() == 1 && substeps[0] <= 8, "{substeps:?}");
}

/// A law with a cutoff goes on linearly below it, but stiffens up to there.
#[test]
fn a_joint_with_a_cutoff_in_stiff_rock_fills_in_one_increment() {
    for share in [0.01, 0.3, 0.9, 1.0] {
        let cutoff = Some(share * APERTURE);
        let kind = ClosureKind::Logarithmic { cutoff };
        let substeps = filled_in_stiff_rock(Closure::new(APERTURE, NORMAL_STIFFNESS, kind));
        assert!(
            substeps.len() == 1 && substeps[0] <= 15,
            "{share}: {substeps:?}"
        );
    }
}

/// Iterations of each increment in which a joint of this law fills.
fn filled_in_stiff_rock(closure: Closure) -> Vec<usize> {
    let mesh = bent_slab(Shape::Hex8, 50, 25.0, |x| 25.0 * (x / 25.0).powf(1.5));
    let mut problem = problem(&mesh, closure, times(10.0, 1));
    problem.rocks[0].young_modulus = 60e9;
    let flow = flow(&mesh, ends(&mesh, 9e5, 0.0));
    let path = solved(&problem, &flow);
    path.records[0].substeps.clone()
}

/// A fluid that neither gives way nor leaves carries the whole load: no effective stress, no
/// motion, the same pressure at every node.
#[test]
fn a_closed_joint_hands_its_load_to_the_fluid() {
    for shape in SHAPES {
        let mesh = slab(shape, 4, 2.0);
        let mut problem = problem(&mesh, linear(), times(1e-6, 1));
        let top = mesh
            .boundaries
            .iter()
            .position(|side| side.name == "side top");
        problem.conditions.push(Condition {
            boundary: top.expect("a side"),
            load: Some(SurfaceLoad::Pressure(1e6)),
            support: None,
        });
        let path = solved(&problem, &flow(&mesh, Vec::new()));
        for pressure in &path.state.pressures {
            is_close(*pressure, 1e6, 1e-6);
        }
        for point in &path.walls.facet_points {
            is_close(point.joint.separation.aperture, APERTURE, 1e-9);
        }
    }
}

/// A cube of 10 m with a joint that carries 10 MPa beside water of 10 MPa, of which 15 MPa come in
/// at one end; from free to stiff joints, from undrained to drained steps and to steady flow.
#[test]
fn a_logarithmic_joint_opens_in_one_increment() {
    let mesh = cube();
    for stiffness in [1e10, 1e11, 1e13] {
        let law = logarithmic(stiffness);
        let diffusion_time = diffusion_time(law);
        for ratio in [None, Some(1e-9), Some(1e-3), Some(1.0), Some(1e9)] {
            let schedule = match ratio {
                None => Schedule::proportional(vec![1.0]),
                Some(ratio) => times(ratio * diffusion_time, 1),
            };
            let record = opened(&mesh, law, (schedule, 15e6));
            let count = record.iterations.len();
            assert!(
                record.converged() && count <= 8,
                "{stiffness:e} {ratio:?} {record:#?}"
            );
            assert_eq!(record.substeps, [count], "{stiffness:e} {ratio:?}");
            let linear = record.linear_iterations();
            assert!(linear <= 12 * count, "{stiffness:e} {ratio:?} {linear}");
        }
    }
}

/// A joint that its normal stress has closed to less than a thousandth of its aperture opens by
/// orders of magnitude, in a time in which hardly anything would flow through it as it was.
#[test]
fn a_closed_joint_is_blown_open_in_one_increment() {
    let (mesh, law) = (cube(), logarithmic(1e9));
    for inlet in [16e6, 22e6, 24e6] {
        for ratio in [1e-6, 1e-3, 1.0, 1e4] {
            let schedule = times(ratio * diffusion_time(law), 1);
            let record = opened(&mesh, law, (schedule, inlet));
            let count = record.iterations.len();
            assert!(
                record.converged() && count <= 10,
                "{inlet:e} {ratio:e} {record:#?}"
            );
            assert_eq!(record.substeps, [count], "{inlet:e} {ratio:e}");
        }
    }
}

/// A cube of 10 m with a joint half way up.
fn cube() -> Mesh {
    let surfaces = [
        Patch::new("joint", &|x| x[2] == 5.0),
        Patch::new("side left", &|x| x[0] == 0.0),
        Patch::new("side right", &|x| x[0] == 10.0),
        Patch::new("side bottom", &|x| x[2] == 0.0),
        Patch::new("side top", &|x| x[2] == 10.0),
        Patch::new("side front", &|x| x[1] == 0.0),
        Patch::new("side back", &|x| x[1] == 10.0),
    ];
    block(Shape::Hex8, ([6; 3], [10.0; 3]), &surfaces, |x| x)
}

/// A joint of 0.1 mm of a normal stiffness (Pa/m).
fn logarithmic(stiffness: f64) -> FractureLaw {
    let kind = ClosureKind::Logarithmic { cutoff: None };
    FractureLaw::elastic(Closure::new(1e-4, stiffness, kind), stiffness)
}

/// Diffusion time (s) of the joint of the cube under 10 MPa.
fn diffusion_time(law: FractureLaw) -> f64 {
    let traction = -10e6 * DVec3::Z;
    let walls = law.under_initial_stress(traction, DVec3::Z).separation;
    let conducts = walls.aperture.powi(3) / 12e-3;
    100.0 / (law.closure.at(walls).tangent * conducts)
}

/// What a step records from 10 MPa of water under a normal stress of 20 MPa to a pressure at one
/// end (Pa).
fn opened(mesh: &Mesh, law: FractureLaw, (schedule, inlet): (Schedule, f64)) -> StepRecord {
    let conditions = (0..mesh.boundaries.len()).map(|boundary| Condition {
        boundary,
        load: None,
        support: Some(Support::Symmetry),
    });
    let mut initial_stress = InitialStress::default();
    initial_stress.components[2] = Field::constant(-20e6);
    let rock = Rock {
        young_modulus: 25e9,
        poisson_ratio: 0.25,
        density: 0.0,
        anisotropy: None,
    };
    let takes_time = schedule.is_timed;
    let problem = Problem {
        fractures: vec![Fracture {
            law,
            fluid_pressure: 0.0,
        }],
        conditions: conditions.collect(),
        schedule,
        initial_stress: Some(initial_stress),
        ..Problem::of_rock(mesh.clone(), rock)
    };
    let mut conditions = ends(mesh, inlet, 10e6);
    if takes_time {
        conditions.truncate(1);
    }
    let mut flow = flow(mesh, conditions);
    flow.initial_pressure = Field::constant(10e6);
    solved(&problem, &flow).records.remove(0)
}

/// What the solver makes of a problem does not depend on the threads, to the last bit.
#[test]
fn threads_change_no_bit_of_a_coupled_flow() {
    let mesh = slab(Shape::Tet4, 12, 2.0);
    let problem = problem(&mesh, linear(), times(10.0, 2));
    let flow = flow(&mesh, ends(&mesh, 9e5, 0.0));
    let [one, three] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let path = pool
            .build()
            .expect("threads")
            .install(|| solved(&problem, &flow));
        (path.state, path.walls.unknowns)
    });
    assert!(one == three);
}

/// As the pressures of the nodes at the facet points push, point by point.
#[test]
fn the_matrix_of_pushes_sums_the_facet_points() {
    for shape in SHAPES {
        let mesh = slab(shape, 3, 1.0);
        let flow = flow(&mesh, ends(&mesh, 1.0, 0.0));
        let problem = problem(&mesh, linear(), Schedule::proportional(vec![1.0]));
        let discretisation = Discretisation::of(&problem).expect("held");
        let mut system = System::assemble(&problem, discretisation);
        system.couple(&flow).expect("sound");
        let coupling = system.coupling().expect("coupled");
        let pressure = |row: usize| (1.0 + row as f64).sin();
        let interface = &system.discretisation().interface;
        let mut expected = vec![DVec3::ZERO; system.initial_state().unknowns.len()];
        interface.add_pressures(&coupling.points.at_points(pressure), &mut expected);
        let mut found = vec![DVec3::ZERO; expected.len()];
        coupling.push.add(pressure, &mut found);
        let largest = expected
            .iter()
            .fold(0.0, |most: f64, f| most.max(f.length()));
        assert!(largest > 0.0);
        for (found, expected) in found.iter().zip(&expected) {
            let off = (*found - *expected).length();
            assert!(
                off <= 1e-14 * largest,
                "{shape:?}: {found} is not {expected}"
            );
        }
    }
}
