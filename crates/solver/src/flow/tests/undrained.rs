//! Networks in steady flow that keep what they hold, in a joint between soft slabs that opens by
//! what the pressure there does to its linear law.

use kluft_mesh::structured::Patch;
use kluft_mesh::{Mesh, Shape};

use super::coupled::{APERTURE, NORMAL_STIFFNESS, Path, ends, linear, problem, slab, solved};
use super::{VISCOSITY, block, flow, is_close, on_side};
use crate::problem::{Condition, Flow, FlowDrive, Problem, Schedule, SurfaceLoad};
use crate::system::{Discretisation, System};

fn undrained(mesh: &Mesh, rates: &[(&str, f64)]) -> Flow {
    let rates = rates.iter();
    let rates = rates.map(|(side, rate)| on_side(mesh, side, FlowDrive::Rate(*rate)));
    Flow {
        is_undrained: true,
        ..flow(mesh, rates.collect())
    }
}

/// The same with a pressure on the upper slab (Pa).
fn pressed(mut problem: Problem, pressure: f64) -> Problem {
    let mut sides = problem.mesh.boundaries.iter();
    let top = sides.position(|side| side.name == "side top");
    problem.conditions.push(Condition {
        boundary: top.expect("a side"),
        load: Some(SurfaceLoad::Pressure(pressure)),
        support: None,
    });
    problem
}

fn apertures(path: &Path) -> impl Iterator<Item = f64> + '_ {
    let points = path.walls.facet_points.iter();
    points.map(|point| point.joint.separation.aperture)
}

/// A load `sigma` on a joint that keeps its fluid: `(1 + c p) (b_0 - (sigma - p)/K_n) = b_0`, in
/// two load steps, the second of which must start from what the first has kept.
#[test]
fn a_network_that_nothing_drives_carries_what_its_fluid_does() {
    let load = 4e5;
    for (shape, compressibility) in [
        (Shape::Tet4, 0.0),
        (Shape::Tet4, 4e-7),
        (Shape::Tet10, 4e-7),
        (Shape::Hex8, 1e-5),
    ] {
        let mesh = slab(shape, 4, 2.0);
        let steps = Schedule::proportional(vec![0.3, 1.0]);
        let problem = pressed(problem(&mesh, linear(), steps), load);
        let mut flow = undrained(&mesh, &[]);
        flow.fluid.compressibility = compressibility;
        let path = solved(&problem, &flow);
        let stiff = APERTURE * NORMAL_STIFFNESS;
        // c p^2 + (c (b_0 K_n - sigma) + 1) p - sigma = 0
        let half = 0.5 * (compressibility * (stiff - load) + 1.0);
        let pressure = load / (half + (half * half + compressibility * load).sqrt());
        for found in &path.state.pressures {
            is_close(*found, pressure, 1e-7);
        }
        let closed = APERTURE - (load - pressure) / NORMAL_STIFFNESS;
        apertures(&path).for_each(|aperture| is_close(aperture, closed, 1e-7));
        assert!(path.state.balance.stored == 0.0, "{shape:?}");
        for record in &path.records {
            assert!(record.iterations.len() <= 6, "{shape:?} {record:#?}");
        }
    }
}

/// What enters on the left leaves on the right: `b^4` is linear, `q = K_n (b_1^4 - b_2^4) / (48 mu
/// L)`, and the joint holds what it held, `4 L (b_1^5 - b_2^5) / (5 (b_1^4 - b_2^4)) = L b_0`.
#[test]
fn rates_that_cancel_leave_a_network_what_it_holds() {
    let length = 2.0;
    // With b_1 = 1.5 b_0 k and b_2 = b_0 k.
    let (ratio, powers): (f64, f64) = (1.5, 1.5_f64.powi(4) - 1.0);
    let thin = APERTURE * 1.25 * powers / (ratio.powi(5) - 1.0);
    let rate = NORMAL_STIFFNESS * thin.powi(4) * powers / (48.0 * VISCOSITY * length);
    for shape in [Shape::Tet4, Shape::Hex8] {
        let errors = [16, 32].map(|n| {
            let mesh = slab(shape, n, length);
            let problem = problem(&mesh, linear(), Schedule::proportional(vec![1.0]));
            let flow = undrained(&mesh, &[("side left", rate), ("side right", -rate)]);
            let path = solved(&problem, &flow);
            assert!(path.state.balance.mass_error <= 1e-10, "{shape:?}");
            let ends = [0, 1].map(|end| path.state.conditions[end].pressure);
            let exact = [ratio * thin, thin];
            let exact = exact.map(|aperture| NORMAL_STIFFNESS * (aperture - APERTURE));
            let pairs = ends.iter().zip(exact);
            pairs.fold(0.0, |most, (p, exact)| f64::max(most, (p - exact).abs())) / exact[0]
        });
        let is_second_order = (3.5..4.5).contains(&(errors[0] / errors[1]));
        assert!(errors[1] < 2e-3 && is_second_order, "{shape:?} {errors:?}");
    }
}

/// Of two joints the lower one has pressures at its ends, `q = K_n (b_1^4 - b_2^4) / (48 mu L)`
/// under the load, and the upper one nothing: its fluid, which does not give way, carries all of
/// the load.
#[test]
fn a_network_keeps_what_it_holds_beside_one_that_is_driven() {
    let left = |x: [f64; 3]| x[0] == 0.0 && x[2] <= 0.5;
    let right = |x: [f64; 3]| x[0] == 2.0 && x[2] <= 0.5;
    let surfaces = [
        Patch::new("low", &|x| x[2] == 0.5),
        Patch::new("high", &|x| x[2] == 1.0),
        Patch::new("side left", &left),
        Patch::new("side right", &right),
        Patch::new("side bottom", &|x| x[2] == 0.0),
        Patch::new("side top", &|x| x[2] == 1.5),
        Patch::new("side front", &|x| x[1] == 0.0),
        Patch::new("side back", &|x| x[1] == 1.0),
    ];
    let counts = [32, 1, 3];
    let mesh = block(Shape::Hex8, (counts, [2.0, 1.0, 1.5]), &surfaces, |x| x);
    let load = 1e5;
    let problem = problem(&mesh, linear(), Schedule::proportional(vec![1.0]));
    let mut problem = pressed(problem, load);
    problem.fractures.push(problem.fractures[0]);
    let flow = Flow {
        is_undrained: true,
        ..flow(&mesh, ends(&mesh, 9e5, 2e5))
    };
    let path = solved(&problem, &flow);
    let [wide, thin] = [9e5, 2e5].map(|p: f64| APERTURE + (p - load) / NORMAL_STIFFNESS);
    let rate = NORMAL_STIFFNESS * (wide.powi(4) - thin.powi(4)) / (48.0 * VISCOSITY * 2.0);
    is_close(path.state.conditions[0].rate, rate, 2e-3);
    assert!(path.state.balance.mass_error <= 1e-10);
    let points = path.walls.facet_points.iter();
    let facets = mesh.facets.fracture.iter();
    let high: Vec<bool> = facets.flat_map(|&fracture| [fracture == 1; 4]).collect();
    let held = points.zip(high).filter(|(_, is_high)| *is_high);
    let apertures = held.map(|(point, _)| point.joint.separation.aperture);
    let apertures: Vec<f64> = apertures.collect();
    let mean = apertures.iter().sum::<f64>() / apertures.len() as f64;
    is_close(mean, APERTURE, 1e-9);
}

#[test]
fn a_network_that_cannot_keep_its_rates_is_refused() {
    let mesh = slab(Shape::Tet4, 2, 1.0);
    let problem = problem(&mesh, linear(), Schedule::proportional(vec![1.0]));
    let flow = undrained(&mesh, &[("side left", 1e-9)]);
    let discretisation = Discretisation::of(&problem).expect("held");
    let mut system = System::assemble(&problem, discretisation);
    let refused = system.couple(&flow).expect_err("no steady state");
    assert!(refused[0].problem.contains("add up to 1.000000e-9"));
}
