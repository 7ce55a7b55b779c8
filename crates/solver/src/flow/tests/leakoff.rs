//! What leaks off into the rock, beside closed forms.

use kluft_mesh::Shape;

use super::coupled::{APERTURE, NORMAL_STIFFNESS, linear, problem, slab, solved};
use super::{apertures, flow, is_close, on_side, times};
use crate::flow::{FlowSystem, TransientFlow};
use crate::problem::{Flow, FlowCondition, FlowDrive, FlowPlace, Leakoff};

const COEFFICIENT: f64 = 1e-8;

fn leaking(exposed: f64) -> FlowCondition {
    FlowCondition {
        name: "leak-off".into(),
        place: FlowPlace::Fracture(0),
        drive: FlowDrive::Leakoff(Leakoff {
            coefficient: COEFFICIENT,
            varying: None,
            exposed,
        }),
        case: 0,
    }
}

/// Carter's loss (m): `4 C (sqrt(t - t_0) - sqrt(-t_0))`.
fn lost(time: f64, exposed: f64) -> f64 {
    4.0 * COEFFICIENT * ((time - exposed).sqrt() - (-exposed).sqrt())
}

/// A closed joint of 2 m by 1 m loses what Carter's law says, in any number of steps, and its
/// pressure falls by that over `c b`.
#[test]
fn walls_that_do_not_move_store_what_has_not_leaked_off() {
    let (aperture, compressibility, rate) = (1e-4, 1e-7, 1e-7);
    for (shape, exposed) in [(Shape::Tet4, 0.0), (Shape::Tet10, -3.0), (Shape::Hex8, 0.0)] {
        let mesh = slab(shape, 4, 2.0);
        let fed = on_side(&mesh, "side left", FlowDrive::Rate(rate));
        let mut flow = flow(&mesh, vec![fed, leaking(exposed)]);
        flow.fluid.compressibility = compressibility;
        let apertures = apertures(&mesh, |_, _| aperture);
        let system = FlowSystem::of(&mesh, &flow, &apertures).expect("a flow");
        let schedule = times(20.0, 7);
        let mut transient = TransientFlow::of(&system, &apertures, &schedule, 1e-2);
        for step in &schedule.steps {
            let time = step.load.time;
            let state = transient.step(&schedule, &step.load).expect("finite").state;
            assert!(state.balance.mass_error <= 1e-10, "{shape:?}");
            is_close(state.entered[0], rate * time, 1e-12);
            is_close(state.entered[1], -2.0 * lost(time, exposed), 1e-12);
            let risen = (state.entered[0] + state.entered[1]) / (2.0 * aperture * compressibility);
            let mean = state.pressures.iter().sum::<f64>() / state.pressures.len() as f64;
            assert!((mean - risen).abs() < 2e-2 * risen.abs(), "{mean} {risen}");
            is_close(state.conditions[1].pressure, risen, 1e-9);
        }
    }
}

/// A joint with a linear law between soft slabs closes by what it loses: `(1 + c p) (b_0 + p/K_n) =
/// b_0 - 4 C sqrt(t)`.
#[test]
fn walls_close_on_what_leaks_off() {
    let compressibility = 4e-7;
    let mesh = slab(Shape::Tet4, 4, 2.0);
    let problem = problem(&mesh, linear(), times(100.0, 4));
    let flow = Flow {
        fluid: crate::problem::Fluid {
            compressibility,
            ..flow(&mesh, Vec::new()).fluid
        },
        ..flow(&mesh, vec![leaking(0.0)])
    };
    let path = solved(&problem, &flow);
    let stiff = APERTURE * NORMAL_STIFFNESS;
    // c p^2 + (1 + c b_0 K_n) p + K_n lost = 0
    let half = 0.5 * (1.0 + compressibility * stiff);
    let left = NORMAL_STIFFNESS * lost(100.0, 0.0);
    let pressure = -left / (half + (half * half - compressibility * left).sqrt());
    for found in &path.state.pressures {
        is_close(*found, pressure, 1e-7);
    }
    is_close(path.state.entered[0], -2.0 * lost(100.0, 0.0), 1e-12);
}
