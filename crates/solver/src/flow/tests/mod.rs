//! Flow against closed forms and in words of its defects, on meshes of all shapes.

mod closed_forms;
mod coupled;
mod leakoff;
mod permeability;
mod push;
mod ramped;
mod refusals;
mod transient;
mod undrained;

use glam::DVec3;
use kluft_mesh::structured::{Patch, cells_of};
use kluft_mesh::{Draft, Mesh, Shape, SurfaceRole};
use lie_core::{HydraulicAperture, Roughness};

use crate::flow::{FlowState, FlowSystem};
use crate::problem::{
    Conduit, Field, Flow, FlowCondition, FlowDrive, FlowPlace, Fluid, Load, Schedule, Step,
};

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
            compressibility: 0.0,
        },
        initial_pressure: Field::default(),
        conduits: vec![smooth(); mesh.fractures.len()],
        of_facets: Vec::new(),
        inactive: Vec::new(),
        conditions,
        gravity: DVec3::ZERO,
        gravity_case: 0,
        lines: Vec::new(),
        is_undrained: false,
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
    FlowDrive::Pressure(Field::constant(value))
}

/// Time steps of equal length up to an end (s), all loads from the beginning.
fn times(end: f64, count: usize) -> Schedule {
    let step = |index: usize| Step {
        load: Load {
            time: end * (index + 1) as f64 / count as f64,
            factors: vec![1.0],
        },
        phase: None,
    };
    Schedule {
        steps: (0..count).map(step).collect(),
        is_timed: true,
        goes_on_from: None,
        sudden: vec![1.0],
        ..Schedule::proportional(vec![1.0])
    }
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
        Patch::new("side top", &|x| x[2] == 1.0),
        Patch::new("side bottom", &|x| x[2] == 0.0),
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
