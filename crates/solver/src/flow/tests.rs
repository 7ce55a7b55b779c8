//! Flow against closed forms, on meshes of all shapes.

use glam::DVec3;
use kluft_mesh::structured::{Patch, cells_of};
use kluft_mesh::{Defect, Draft, Mesh, Shape, SurfaceRole};
use lie_core::{HydraulicAperture, Roughness};

use crate::flow::{FlowState, FlowSystem, NO_PRESSURE};
use crate::problem::{Conduit, Flow, FlowCondition, FlowDrive, FlowPlace, Fluid, Load, Profile};

const VISCOSITY: f64 = 1e-3;
const SHAPES: [Shape; 6] = [
    Shape::Tet4,
    Shape::Tet10,
    Shape::Hex8,
    Shape::Hex20,
    Shape::Hex27,
    Shape::Prism6,
];

/// The box `[0, size]` with surfaces on its planes `x = value`, those inside as fractures.
fn block(
    shape: Shape,
    (counts, size): ([usize; 3], [f64; 3]),
    surfaces: &[Patch<'_>],
    bend: impl Fn([f64; 3]) -> [f64; 3],
) -> Mesh {
    let mut draft: Draft = cells_of(shape, counts, size, surfaces);
    for node in &mut draft.nodes {
        *node = bend(*node);
    }
    let role = |name: &str| match name {
        "rock" => SurfaceRole::Unused,
        name if name.starts_with("side") => SurfaceRole::Boundary,
        _ => SurfaceRole::Fracture,
    };
    let roles: Vec<SurfaceRole> = draft.groups.iter().map(|group| role(&group.name)).collect();
    Mesh::build(draft, &roles).expect("a sound mesh")
}

fn smooth() -> Conduit {
    Conduit::Open(HydraulicAperture::OfWalls {
        roughness: Roughness::Factor(1.0),
        residual: 0.0,
    })
}

fn flow(mesh: &Mesh, conditions: Vec<FlowCondition>) -> Flow {
    Flow {
        fluid: Fluid {
            viscosity: VISCOSITY,
            density: 0.0,
        },
        conduits: vec![smooth(); mesh.fractures.len()],
        conditions,
        gravity: DVec3::ZERO,
        gravity_case: 0,
    }
}

fn on_side(mesh: &Mesh, name: &str, drive: FlowDrive) -> FlowCondition {
    let found = mesh.boundaries.iter().position(|side| side.name == name);
    FlowCondition {
        name: name.into(),
        place: FlowPlace::Boundary(found.expect("a boundary")),
        drive,
        case: 0,
    }
}

fn pressure(value: f64) -> FlowDrive {
    FlowDrive::Pressure(Profile {
        value,
        ..Profile::default()
    })
}

fn apertures(mesh: &Mesh, of: impl Fn(DVec3, usize) -> f64) -> Vec<f64> {
    let facets = mesh.facets.fracture.iter().enumerate();
    let all = facets.flat_map(|(facet, &fracture)| {
        let nodes = mesh.facets.elements.nodes_of(facet).iter();
        let of = &of;
        nodes.map(move |&node| of(mesh.nodes[node as usize], fracture as usize))
    });
    all.collect()
}

fn solved(mesh: &Mesh, flow: &Flow, apertures: &[f64]) -> FlowState {
    let mut system = FlowSystem::of(mesh, flow, apertures).expect("sound conditions");
    system.factorise().expect("positive definite");
    system.solve(&Load::proportional(1.0)).expect("finite")
}

fn refused(mesh: &Mesh, flow: &Flow, apertures: &[f64]) -> Vec<Defect> {
    match FlowSystem::of(mesh, flow, apertures) {
        Ok(_) => Vec::new(),
        Err(defects) => defects,
    }
}

fn is_close(found: f64, expected: f64, tolerance: f64) {
    let error = (found - expected).abs();
    assert!(error <= tolerance * expected.abs(), "{found} {expected}");
}

/// The channel between the sides at `x = 0` and `x = 2`, its nodes pushed about in its plane.
fn channel(shape: Shape, n: usize) -> Mesh {
    let surfaces = [
        Patch::new("joint", &|x| x[2] == 0.5),
        Patch::new("side left", &|x| x[0] == 0.0),
        Patch::new("side right", &|x| x[0] == 2.0),
    ];
    block(
        shape,
        ([2 * n, n, 2], [2.0, 1.0, 1.0]),
        &surfaces,
        |[x, y, z]| {
            let inside = (0.5 * std::f64::consts::PI * x).sin();
            let bulge = 0.1 * inside * (3.0 * y + 0.3).cos();
            [x + bulge, y + 0.5 * bulge * y * (1.0 - y), z]
        },
    )
}

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

/// Half planes that share a line: `p = sum T p / sum T` there.
#[test]
fn half_planes_share_the_pressure_of_their_line() {
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
    let rates = [
        (2, 1.222222e5, [1.481481e-5, -1.481481e-5, 0.0, 0.0]),
        (
            3,
            1.205479e5,
            [1.495434e-5, -1.369863e-5, -0.1255708e-5, 0.0],
        ),
        (
            4,
            1.420000e5,
            [1.316667e-5, -2.800000e-5, -0.1479167e-5, 1.631250e-5],
        ),
    ];
    let ends = [3e5, 1e5, 0.0, 2e5];
    for (count, junction, expected) in rates {
        // The angles between the half planes do not matter.
        let lean = |[x, y, z]: [f64; 3]| [x + 0.3 * (y - 1.0), y + 0.2 * (x - 1.0), z];
        let mesh = block(Shape::Tet4, ([6, 4, 3], [2.0, 2.0, 1.0]), &surfaces, lean);
        let names = ["west", "east", "south", "north"];
        let open = &names[..count];
        let conditions = open.iter().zip(ends);
        let conditions =
            conditions.map(|(name, end)| on_side(&mesh, &format!("side {name}"), pressure(end)));
        let mut flow = flow(&mesh, conditions.collect());
        for (conduit, name) in flow.conduits.iter_mut().zip(&mesh.fractures) {
            if !open.contains(&name.as_str()) {
                *conduit = Conduit::Sealed;
            }
        }
        let widths = [1e-4, 2e-4, 0.5e-4, 1.5e-4];
        let width = |name: &str| widths[names.iter().position(|n| *n == name).unwrap_or(0)];
        // Half planes that lean are longer: conduct as much as those of 1 m by being wider.
        let apertures = apertures(&mesh, |_, fracture| {
            let name = mesh.fractures[fracture].as_str();
            let longer: f64 = if ["west", "east"].contains(&name) {
                1.04
            } else {
                1.09
            };
            width(name) * longer.sqrt().cbrt()
        });
        let mut system = FlowSystem::of(&mesh, &flow, &apertures).expect("sound conditions");
        system.factorise().expect("positive definite");
        let state = system.solve(&Load::proportional(1.0)).expect("finite");
        assert_eq!(system.networks().len(), 1);
        for (found, expected) in state.conditions.iter().zip(expected) {
            // As many digits as the table has.
            is_close(found.rate, expected, 1e-6);
        }
        let is_shared = |node: u32| {
            let x = mesh.nodes[node as usize];
            (x.x - 1.0).abs() + (x.y - 1.0).abs() < 1e-12
        };
        for (row, _) in system
            .nodes()
            .iter()
            .enumerate()
            .filter(|(_, node)| is_shared(**node))
        {
            is_close(state.pressures[row], junction, 1e-6);
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

/// The fracture `z = 0.5` of a square of 1 m, closed all around.
fn square(n: usize) -> Mesh {
    let surfaces = [
        Patch::new("joint", &|x| x[2] == 0.5),
        Patch::new("side left", &|x| x[0] == 0.0),
    ];
    block(Shape::Hex8, ([n, n, 2], [1.0, 1.0, 1.0]), &surfaces, |x| x)
}

fn well(mesh: &Mesh, place: [f64; 3], drive: FlowDrive) -> FlowCondition {
    let at = DVec3::from(place);
    let node = mesh.nodes.iter().position(|x| x.distance(at) < 1e-12);
    FlowCondition {
        name: format!("well at {place:?}"),
        place: FlowPlace::Well {
            node: node.expect("a node") as u32,
            radius: 1e-3,
        },
        drive,
        case: 0,
    }
}

/// A quarter of the five-spot pattern (Muskat 1937), one well in a corner and the other in the
/// opposite one, a distance `d` apart: `4 Q = pi T dp / (ln(d / r_w) - 0.6190)`. Squares take the
/// radius of their node 4 % too large or too small, which is as much in a logarithm of about 6.6.
#[test]
fn wells_have_the_pressure_of_their_wall() {
    for n in [8, 16, 32] {
        let mesh = square(n);
        let conditions = vec![
            well(&mesh, [0.0, 0.0, 0.5], FlowDrive::Rate(1e-6)),
            well(&mesh, [1.0, 1.0, 0.5], pressure(1e6)),
        ];
        let flow = flow(&mesh, conditions);
        let state = solved(&mesh, &flow, &apertures(&mesh, |_, _| 1e-4));
        let transmissivity = 1e-12 / (12.0 * VISCOSITY);
        let logarithm = (2.0_f64.sqrt() / 1e-3).ln() - 0.6190;
        let drop = 4.0 * 1e-6 * logarithm / (std::f64::consts::PI * transmissivity);
        is_close(state.conditions[0].pressure - 1e6, drop, 0.02);
        is_close(state.conditions[1].rate, -1e-6, 1e-11);
        assert_eq!(state.conditions[1].pressure, 1e6);
    }
}

#[test]
fn a_borehole_wider_than_the_cells_is_refused() {
    let mesh = square(8);
    let mut wide = well(&mesh, [0.5, 0.5, 0.5], pressure(1e6));
    wide.place = match wide.place {
        FlowPlace::Well { node, .. } => FlowPlace::Well { node, radius: 0.1 },
        other => other,
    };
    let flow = flow(&mesh, vec![wide]);
    let defects = refused(&mesh, &flow, &apertures(&mesh, |_, _| 1e-4));
    assert!(
        defects[0].problem.contains("radius of 0.1 m"),
        "{defects:?}"
    );
}

/// Two joints that do not meet.
fn apart() -> Mesh {
    let surfaces = [
        Patch::new("low", &|x| x[2] == 0.5),
        Patch::new("high", &|x| x[2] == 1.5),
        Patch::new("side left", &|x| x[0] == 0.0),
        Patch::new("side right", &|x| x[0] == 1.0),
        Patch::new("side top", &|x| x[2] == 2.0),
    ];
    block(Shape::Tet4, ([2, 2, 4], [1.0, 1.0, 2.0]), &surfaces, |x| x)
}

#[test]
fn networks_without_a_pressure_are_refused_by_the_names_of_their_fractures() {
    let mesh = apart();
    let apertures = apertures(&mesh, |_, _| 1e-4);
    let rate = |value: f64, z: f64| well(&mesh, [0.5, 0.5, z], FlowDrive::Rate(value));
    let high = well(&mesh, [0.5, 0.5, 1.5], pressure(0.0));
    let cases = [
        (vec![high.clone()], "nothing drives"),
        (vec![high.clone(), rate(1e-6, 0.5)], "add up to 1.000000e-6"),
        (
            vec![
                high,
                rate(1e-6, 0.5),
                on_side(&mesh, "side left", FlowDrive::Rate(0.0)),
                well(&mesh, [0.5, 0.0, 0.5], FlowDrive::Rate(-1e-6)),
            ],
            "up to a constant",
        ),
    ];
    for (conditions, said) in cases {
        let defects = refused(&mesh, &flow(&mesh, conditions), &apertures);
        assert_eq!(defects.len(), 1, "{defects:?}");
        assert_eq!(defects[0].code, Some(NO_PRESSURE));
        assert_eq!(defects[0].place, "fracture `low`");
        assert!(defects[0].problem.contains(said), "{}", defects[0]);
    }
    let sealed = Flow {
        conduits: vec![Conduit::Sealed, smooth()],
        ..flow(&mesh, vec![well(&mesh, [0.5, 0.5, 1.5], pressure(0.0))])
    };
    assert!(refused(&mesh, &sealed, &apertures).is_empty());
}

#[test]
fn what_cannot_act_is_refused_by_name() {
    let mesh = apart();
    let sides = |names: [(&str, f64); 2]| {
        let all = names.map(|(name, value)| on_side(&mesh, name, pressure(value)));
        flow(&mesh, all.to_vec())
    };
    let open = apertures(&mesh, |_, _| 1e-4);
    let dry = refused(
        &mesh,
        &sides([("side left", 1.0), ("side top", 0.0)]),
        &open,
    );
    assert!(dry.len() == 1 && dry[0].place == "side top", "{dry:?}");
    let shut = apertures(&mesh, |_, fracture| 1e-4 * fracture as f64);
    let shut = refused(
        &mesh,
        &sides([("side left", 1.0), ("side right", 0.0)]),
        &shut,
    );
    assert!(
        shut.len() == 1 && shut[0].place == "fracture `low`",
        "{shut:?}"
    );
    let mut twice = sides([("side left", 1e5), ("side left", 2e5)]);
    let defects = refused(&mesh, &twice, &open);
    assert!(
        defects.len() == 1 && defects[0].problem.contains("200000 Pa"),
        "{defects:?}"
    );
    twice.conditions[1].drive = pressure(1e5);
    assert!(refused(&mesh, &twice, &open).is_empty());
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
