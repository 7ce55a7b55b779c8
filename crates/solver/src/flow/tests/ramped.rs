//! Rates that grow in time, beside closed forms: what has entered is `q t / 2` of one that grows
//! from 0 to `q`, in any number of steps.

use kluft_mesh::Shape;

use super::coupled::{APERTURE, NORMAL_STIFFNESS, linear, problem, slab, solved};
use super::{apertures, flow, is_close, on_side, times};
use crate::flow::{FlowSystem, TransientFlow};
use crate::problem::{Flow, FlowCondition, FlowDrive, FlowPlace, Load, Schedule};

const RATE: f64 = 2e-8;
const END: f64 = 100.0;

/// Steps to the end in which everything grows from nothing.
fn ramp(count: usize) -> Schedule {
    let mut schedule = times(END, count);
    schedule.sudden = Vec::new();
    for step in &mut schedule.steps {
        step.load = Load {
            factors: vec![step.load.time / END],
            ..step.load.clone()
        };
    }
    schedule
}

#[test]
fn walls_that_do_not_move_store_the_mean_of_a_growing_rate() {
    let compressibility = 1e-7;
    for (shape, count) in [(Shape::Tet4, 1), (Shape::Tet10, 3), (Shape::Hex8, 7)] {
        let mesh = slab(shape, 4, 2.0);
        let fed = on_side(&mesh, "side left", FlowDrive::Rate(RATE));
        let mut flow = flow(&mesh, vec![fed]);
        flow.fluid.compressibility = compressibility;
        let apertures = apertures(&mesh, |_, _| APERTURE);
        let system = FlowSystem::of(&mesh, &flow, &apertures).expect("a flow");
        let schedule = ramp(count);
        let mut transient = TransientFlow::of(&system, &apertures, &schedule, 1.0);
        for step in &schedule.steps {
            let state = transient.step(&schedule, &step.load).expect("finite").state;
            let share = step.load.time / END;
            is_close(state.conditions[0].rate, share * RATE, 1e-12);
            is_close(state.entered[0], 0.5 * RATE * END * share * share, 1e-12);
            is_close(state.balance.stored, state.balance.inflow, 1e-9);
        }
    }
}

/// A joint with a linear law between soft slabs opens by what enters all over it:
/// `(1 + c p) (b_0 + p / K_n) = b_0 + q t / (2 A)`.
#[test]
fn walls_open_by_the_mean_of_a_growing_rate() {
    let compressibility = 4e-7;
    let mesh = slab(Shape::Tet4, 4, 2.0);
    for count in [1, 4] {
        let problem = problem(&mesh, linear(), ramp(count));
        let fed = FlowCondition {
            place: FlowPlace::Fracture(0),
            ..on_side(&mesh, "side left", FlowDrive::Rate(RATE))
        };
        let flow = Flow {
            fluid: crate::problem::Fluid {
                compressibility,
                ..flow(&mesh, Vec::new()).fluid
            },
            ..flow(&mesh, vec![fed])
        };
        let path = solved(&problem, &flow);
        let height = 0.5 * RATE * END / 2.0;
        is_close(path.state.entered[0], 2.0 * height, 1e-9);
        is_close(path.state.conditions[0].rate, RATE, 1e-12);
        let stiff = APERTURE * NORMAL_STIFFNESS;
        // c p^2 + (1 + c b_0 K_n) p - K_n q t / (2 A) = 0
        let half = 0.5 * (1.0 + compressibility * stiff);
        let right = NORMAL_STIFFNESS * height;
        let pressure = right / (half + (half * half + compressibility * right).sqrt());
        for found in &path.state.pressures {
            is_close(*found, pressure, 1e-7);
        }
    }
}
