//! Rates and pressures beside closed forms.

use std::f64::consts::PI;

use glam::DVec3;
use kluft_mesh::structured::Patch;
use kluft_mesh::{Mesh, Shape};

use super::{
    SHAPES, VISCOSITY, apertures, block, channel, flow, is_close, on_side, pressure, solved,
    square, well,
};
use crate::flow::FlowSystem;
use crate::problem::{Conduit, Flow, FlowDrive, Load};

/// `Q = b^3 dp / (12 mu L)` and a linear pressure, exact on any mesh.
#[test]
fn a_channel_has_its_rate_on_every_mesh() {
    for shape in SHAPES {
        let mesh = channel(shape, 4);
        let conditions = vec![
            on_side(&mesh, "side left", pressure(3e5)),
            on_side(&mesh, "side right", pressure(2e5)),
        ];
        let flow = flow(&mesh, conditions);
        let apertures = apertures(&mesh, |_, _| 1e-4);
        let mut system = FlowSystem::of(&mesh, &flow, &apertures).expect("sound conditions");
        system.factorise().expect("positive definite");
        let state = system.solve(&Load::proportional(1.0)).expect("finite");
        let expected = 1e-12 * 1e5 / (12.0 * VISCOSITY * 2.0);
        is_close(state.conditions[0].rate, expected, 1e-11);
        is_close(state.conditions[1].rate, -expected, 1e-11);
        assert!(
            state.balance.mass_error < 1e-12,
            "{shape:?} {:?}",
            state.balance
        );
        for (row, &node) in system.nodes().iter().enumerate() {
            let x = mesh.nodes[node as usize].x;
            is_close(state.pressures[row], 3e5 - 0.5e5 * x, 1e-12);
        }
        let fields = system.fields(&state, &apertures);
        for flux in fields.fluxes {
            assert!(
                (flux - DVec3::X * expected).length() < 1e-10 * expected,
                "{flux}"
            );
        }
        if shape.is_quadratic() {
            // Middles of edges were pushed off the middle of their corners.
            continue;
        }
        let nodes = mesh.facets.elements.nodes.iter();
        for (&node, &found) in nodes.zip(&fields.pressures) {
            is_close(found, 3e5 - 0.5e5 * mesh.nodes[node as usize].x, 1e-12);
        }
    }
}

/// The same with a rate on one side, which is shared by the length of the edges there.
#[test]
fn a_rate_on_a_side_raises_the_pressure_that_drives_it() {
    for shape in SHAPES {
        let mesh = channel(shape, 3);
        let rate = 1e-12 * 1e5 / (12.0 * VISCOSITY * 2.0);
        let conditions = vec![
            on_side(&mesh, "side left", FlowDrive::Rate(rate)),
            on_side(&mesh, "side right", pressure(0.0)),
        ];
        let flow = flow(&mesh, conditions);
        let state = solved(&mesh, &flow, &apertures(&mesh, |_, _| 1e-4));
        is_close(state.conditions[0].pressure, 1e5, 1e-11);
        is_close(state.conditions[1].rate, -rate, 1e-11);
    }
}

const ARMS: [&str; 4] = ["west", "east", "south", "north"];

/// Half planes that share the line `x = y = 1`, and the sides that they end on. They lean: the
/// angles between them do not matter.
fn star() -> Mesh {
    let west = |x: [f64; 3]| x[1] == 1.0 && x[0] <= 1.0;
    let east = |x: [f64; 3]| x[1] == 1.0 && x[0] >= 1.0;
    let south = |x: [f64; 3]| x[0] == 1.0 && x[1] <= 1.0;
    let north = |x: [f64; 3]| x[0] == 1.0 && x[1] >= 1.0;
    let surfaces = [
        Patch::new("west", &west),
        Patch::new("east", &east),
        Patch::new("south", &south),
        Patch::new("north", &north),
        Patch::new("side west", &|x| x[0] == 0.0),
        Patch::new("side east", &|x| x[0] == 2.0),
        Patch::new("side south", &|x| x[1] == 0.0),
        Patch::new("side north", &|x| x[1] == 2.0),
    ];
    let lean = |[x, y, z]: [f64; 3]| [x + 0.3 * (y - 1.0), y + 0.2 * (x - 1.0), z];
    block(Shape::Tet4, ([6, 4, 3], [2.0, 2.0, 1.0]), &surfaces, lean)
}

/// The flow between the ends of the first arms of a star; the others are sealed.
fn between_arms(mesh: &Mesh, open: &[&str]) -> Flow {
    let ends = [3e5, 1e5, 0.0, 2e5];
    let conditions = open.iter().zip(ends);
    let conditions =
        conditions.map(|(name, end)| on_side(mesh, &format!("side {name}"), pressure(end)));
    let mut flow = flow(mesh, conditions.collect());
    for (conduit, name) in flow.conduits.iter_mut().zip(&mesh.fractures) {
        if !open.contains(&name.as_str()) {
            *conduit = Conduit::Sealed;
        }
    }
    flow
}

/// Apertures by which arms that are longer than 1 m because they lean conduct like those of 1 m.
fn arm_apertures(mesh: &Mesh) -> Vec<f64> {
    let arms = [(1e-4, 1.04), (2e-4, 1.04), (0.5e-4, 1.09), (1.5e-4, 1.09)];
    apertures(mesh, |_, fracture| {
        let name = mesh.fractures[fracture].as_str();
        let (width, square): (f64, f64) =
            arms[ARMS.iter().position(|arm| *arm == name).unwrap_or(0)];
        width * square.sqrt().cbrt()
    })
}

/// `p = sum T p / sum T` on the line.
#[test]
fn half_planes_share_the_pressure_of_their_line() {
    let mesh = star();
    let apertures = arm_apertures(&mesh);
    // As many digits as the table has.
    let table = 1e-6;
    for (junction, expected) in [
        (1.222222e5, &[1.481481e-5, -1.481481e-5][..]),
        (1.205479e5, &[1.495434e-5, -1.369863e-5, -0.1255708e-5][..]),
        (
            1.420000e5,
            &[1.316667e-5, -2.8e-5, -0.1479167e-5, 1.63125e-5][..],
        ),
    ] {
        let flow = between_arms(&mesh, &ARMS[..expected.len()]);
        let mut system = FlowSystem::of(&mesh, &flow, &apertures).expect("sound conditions");
        system.factorise().expect("positive definite");
        let state = system.solve(&Load::proportional(1.0)).expect("finite");
        assert_eq!(system.networks().len(), 1);
        for (found, expected) in state.conditions.iter().zip(expected) {
            is_close(found.rate, *expected, table);
        }
        let line = DVec3::new(1.0, 1.0, 0.0);
        for (row, &node) in system.nodes().iter().enumerate() {
            let x = mesh.nodes[node as usize];
            if x.with_z(0.0).distance(line) < 1e-12 {
                is_close(state.pressures[row], junction, table);
            }
        }
        assert!(state.balance.mass_error < 1e-12, "{:?}", state.balance);
    }
}

/// `b` from 1e-4 to 2e-4 over 2 m: `Q = 1.111111e-5`, of second order.
#[test]
fn a_wedge_converges_with_the_square_of_the_size() {
    let error = |n: usize| {
        let mesh = channel(Shape::Tet4, n);
        let conditions = vec![
            on_side(&mesh, "side left", pressure(1e5)),
            on_side(&mesh, "side right", pressure(0.0)),
        ];
        let flow = flow(&mesh, conditions);
        let wedge = apertures(&mesh, |x, _| 1e-4 * (1.0 + 0.5 * x.x));
        let rate = solved(&mesh, &flow, &wedge).conditions[0].rate;
        let square: f64 = 2.0 * 1e-8 * 4e-8 / 3e-4;
        let expected = square * 1e5 / (12.0 * VISCOSITY * 2.0);
        is_close(expected, 1.111111e-5, 1e-6);
        (rate - expected).abs() / expected
    };
    let errors = [4, 8, 16].map(error);
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!(order > 1.85, "{errors:?}");
    }
    assert!(errors[2] < 5e-3, "{errors:?}");
}

/// A closed channel of 10 m that stands upright: `p = rho g depth`, and nothing flows.
#[test]
fn a_fluid_at_rest_stays_at_rest() {
    let surfaces = [
        Patch::new("joint", &|x| x[0] == 0.5),
        Patch::new("side top", &|x| x[2] == 10.0),
    ];
    let bend = |[x, y, z]: [f64; 3]| [x, y, z + 0.3 * (5.0 * y).sin() * (0.1 * z * (10.0 - z))];
    for shape in SHAPES {
        let mesh = block(shape, ([2, 3, 8], [1.0, 1.0, 10.0]), &surfaces, bend);
        let mut flow = flow(&mesh, vec![on_side(&mesh, "side top", pressure(0.0))]);
        flow.fluid.density = 1000.0;
        flow.gravity = DVec3::new(0.0, 0.0, -9.81);
        let uneven = apertures(&mesh, |x, _| 1e-4 * (1.1 + (7.0 * x.z + 3.0 * x.y).sin()));
        let mut system = FlowSystem::of(&mesh, &flow, &uneven).expect("sound conditions");
        system.factorise().expect("positive definite");
        let state = system.solve(&Load::proportional(1.0)).expect("finite");
        for (row, &node) in system.nodes().iter().enumerate() {
            let depth = 10.0 - mesh.nodes[node as usize].z;
            assert!(
                (state.pressures[row] - 9810.0 * depth).abs() < 1e-9,
                "{shape:?}"
            );
        }
        let fields = system.fields(&state, &uneven);
        let largest = fields
            .fluxes
            .iter()
            .map(|flux| flux.length())
            .fold(0.0, f64::max);
        // What 1 Pa/m would drive is some 1e-9 m2/s.
        assert!(largest < 1e-22, "{shape:?} {largest}");
        assert_eq!(state.balance.mass_error, 0.0);
    }
}

/// A quarter of the five-spot pattern, one well in a corner and the other in the opposite one, a
/// distance `d` apart: `4 Q = pi T dp / (ln(d / r_w) - ln K)` with the complete elliptic integral
/// `K(1/sqrt(2))`, by which `sn^2` maps the square to a half plane (Muskat 1937 has 0.6190 for
/// `ln K`). On squares, and on triangles whose nodes are pushed about: of second order until the
/// rings around a node end.
#[test]
fn wells_have_the_pressure_of_their_wall() {
    let triangles = |n: usize| {
        let surfaces = [Patch::new("joint", &|x| x[2] == 0.5)];
        block(
            Shape::Tet4,
            ([n, n, 2], [1.0; 3]),
            &surfaces,
            |[x, y, z]| {
                let inside = 0.3 / n as f64 * (PI * x).sin() * (PI * y).sin();
                let [u, v] = [37.0 * x + 61.0 * y, 53.0 * x - 29.0 * y];
                [x + inside * u.sin(), y + inside * v.cos(), z]
            },
        )
    };
    let meshes: [&dyn Fn(usize) -> Mesh; 2] = [&square, &triangles];
    let errors = meshes.map(|mesh| [8, 16, 32].map(|n| five_spot(&mesh(n))));
    for errors in errors {
        assert!(errors[0] < 3e-3, "{errors:?}");
        assert!(errors[1] < 0.4 * errors[0], "{errors:?}");
        assert!(errors[2] < 2e-4, "{errors:?}");
    }
}

/// Error of the pressure between the walls of two wells in opposite corners.
fn five_spot(mesh: &Mesh) -> f64 {
    let conditions = vec![
        well(mesh, [0.0, 0.0, 0.5], FlowDrive::Rate(1e-6)),
        well(mesh, [1.0, 1.0, 0.5], pressure(1e6)),
    ];
    let flow = flow(mesh, conditions);
    let state = solved(mesh, &flow, &apertures(mesh, |_, _| 1e-4));
    let transmissivity = 1e-12 / (12.0 * VISCOSITY);
    let logarithm = (2.0_f64.sqrt() / 1e-3).ln() - 1.854_074_677_301_371_7_f64.ln();
    let drop = 4.0 * 1e-6 * logarithm / (PI * transmissivity);
    is_close(state.conditions[1].rate, -1e-6, 1e-11);
    assert_eq!(state.conditions[1].pressure, 1e6);
    ((state.conditions[0].pressure - 1e6) / drop - 1.0).abs()
}

/// A pressure that two conditions give is counted once, and a small difference of large pressures
/// keeps its digits.
#[test]
fn mass_is_kept_where_pressures_hardly_differ() {
    let mesh = channel(Shape::Tet4, 6);
    let conditions = vec![
        on_side(&mesh, "side left", pressure(5e7 + 1e-3)),
        on_side(&mesh, "side left", pressure(5e7 + 1e-3)),
        on_side(&mesh, "side right", pressure(5e7)),
    ];
    let flow = flow(&mesh, conditions);
    let uneven = apertures(&mesh, |x, _| if x.y < 0.4 { 1e-6 } else { 1e-3 });
    let state = solved(&mesh, &flow, &uneven);
    assert_eq!(state.conditions[1].rate, 0.0);
    assert!(state.balance.mass_error < 1e-10, "{:?}", state.balance);
    let missing = state.balance.inflow - state.balance.outflow;
    assert!(
        missing.abs() < 1e-10 * state.balance.inflow,
        "{:?}",
        state.balance
    );
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let mesh = channel(Shape::Tet4, 12);
    let conditions = vec![
        on_side(&mesh, "side left", pressure(1e5)),
        on_side(&mesh, "side right", FlowDrive::Rate(-1e-7)),
    ];
    let flow = flow(&mesh, conditions);
    let uneven = apertures(&mesh, |x, _| 1e-4 * (1.2 + (9.0 * x.x).sin()));
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads")
            .install(|| solved(&mesh, &flow, &uneven))
    };
    assert_eq!(with(1), with(3));
}
