//! Flow in time between walls that do not move, beside closed forms.

use std::f64::consts::PI;

use kluft_mesh::structured::Patch;
use kluft_mesh::{Mesh, Shape};
use lie_core::HydraulicAperture;

use super::{VISCOSITY, block, flow, is_close, on_side, pressure, smooth, times};
use crate::flow::{FlowSystem, TimeStep, TransientFlow};
use crate::problem::{Conduit, Flow, FlowCondition, FlowDrive, Schedule};

const APERTURE: f64 = 1e-4;
const COMPRESSIBILITY: f64 = 4.5e-10;
/// `b^2 / (12 mu c)` (m^2/s).
const DIFFUSIVITY: f64 = APERTURE * APERTURE / (12.0 * VISCOSITY * COMPRESSIBILITY);

/// A joint of 25 m by 1 m in 100 by 1 cells.
fn strip(shape: Shape) -> Mesh {
    let surfaces = [
        Patch::new("joint", &|x| x[2] == 0.5),
        Patch::new("side left", &|x| x[0] == 0.0),
    ];
    block(shape, ([100, 1, 2], [25.0, 1.0, 1.0]), &surfaces, |x| x)
}

fn compressible(mesh: &Mesh, conditions: Vec<FlowCondition>) -> Flow {
    let mut flow = flow(mesh, conditions);
    flow.fluid.compressibility = COMPRESSIBILITY;
    flow.conduits = vec![smooth(); mesh.fractures.len()];
    flow
}

fn solved(mesh: &Mesh, flow: &Flow, schedule: &Schedule, accuracy: f64) -> Vec<TimeStep> {
    let apertures = vec![APERTURE; mesh.facets.elements.nodes.len()];
    let system = FlowSystem::of(mesh, flow, &apertures).expect("a flow");
    let mut transient = TransientFlow::of(&system, &apertures, schedule, accuracy);
    let steps = schedule.steps.iter();
    steps
        .map(|step| transient.step(schedule, &step.load).expect("finite"))
        .collect()
}

/// A pressure at the end of a long joint: `2 p c b sqrt(D t / pi)` has entered a metre of it.
#[test]
fn a_joint_takes_up_what_diffusion_says() {
    for shape in [Shape::Tet4, Shape::Tet10, Shape::Hex8] {
        let mesh = strip(shape);
        let flow = compressible(&mesh, vec![on_side(&mesh, "side left", pressure(1e6))]);
        let end = 0.01;
        let exact = 2.0 * 1e6 * COMPRESSIBILITY * APERTURE * (DIFFUSIVITY * end / PI).sqrt();
        let error = |accuracy: f64, count: usize| {
            let steps = solved(&mesh, &flow, &times(end, count), accuracy);
            for step in &steps {
                assert!(step.state.balance.mass_error <= 1e-12, "{shape:?}");
            }
            (steps[count - 1].state.entered[0] / exact - 1.0).abs()
        };
        let errors = [20, 40].map(|count| error(1.0, count));
        assert!(
            errors[1] < 0.02 && errors[1] < 0.75 * errors[0],
            "{shape:?} {errors:?}"
        );
        assert!(error(1e-3, 10) < 4e-3, "{shape:?} {}", error(1e-3, 10));
    }
}

/// What enters a closed joint at a constant rate raises its pressure by `q t / (c V)`, whatever the
/// steps; nothing needs a pressure.
#[test]
fn a_closed_joint_fills_at_its_rate() {
    let mesh = strip(Shape::Tet4);
    let drive = FlowDrive::Rate(2e-9);
    let flow = compressible(&mesh, vec![on_side(&mesh, "side left", drive)]);
    let steps = solved(&mesh, &flow, &times(100.0, 3), 1e-2);
    let last = &steps[2];
    let risen = last.state.entered[0] / (COMPRESSIBILITY * APERTURE * 25.0);
    let mean = last.state.pressures.iter().sum::<f64>() / last.state.pressures.len() as f64;
    is_close(last.state.balance.stored, last.state.balance.inflow, 1e-9);
    is_close(mean, risen, 1e-2);
}

#[test]
fn constant_apertures_store_by_what_they_hold() {
    let mesh = strip(Shape::Tet4);
    let mut flow = compressible(&mesh, vec![on_side(&mesh, "side left", pressure(1e6))]);
    flow.conduits = vec![Conduit::Open(HydraulicAperture::Constant(APERTURE)); 1];
    let constant = solved(&mesh, &flow, &times(0.01, 5), 1.0);
    flow.conduits = vec![smooth(); 1];
    let of_walls = solved(&mesh, &flow, &times(0.01, 5), 1.0);
    assert_eq!(constant[4].state.pressures, of_walls[4].state.pressures);
}
