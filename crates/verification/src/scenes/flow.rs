//! Flow in fractures of structured blocks: channels, stars of half planes, squares with wells.

use glam::DVec3;
use kluft_mesh::structured::{Patch, cells_of};
use kluft_mesh::{Mesh, Shape, SurfaceRole};
use kluft_solver::{
    Conduit, Field, Flow, FlowCondition, FlowDrive, FlowPlace, FlowState, FlowSystem, Fluid, Load,
};
use lie_core::{HydraulicAperture, Roughness};

/// Viscosity of water (Pa s).
pub const VISCOSITY: f64 = 1e-3;

/// A block of cells, `[0, size]` before it is bent: surfaces whose names begin with `side` are
/// parts of its outside, the others fractures.
pub fn block(
    shape: Shape,
    (counts, size): ([usize; 3], [f64; 3]),
    surfaces: &[Patch<'_>],
    bend: impl Fn([f64; 3]) -> [f64; 3],
) -> Mesh {
    let mut draft = cells_of(shape, counts, size, surfaces);
    for node in &mut draft.nodes {
        *node = bend(*node);
    }
    let role = |name: &str| match name {
        "rock" => SurfaceRole::Unused,
        name if name.starts_with("side") => SurfaceRole::Boundary,
        _ => SurfaceRole::Fracture,
    };
    let roles: Vec<SurfaceRole> = draft.groups.iter().map(|group| role(&group.name)).collect();
    Mesh::build(draft, &roles).unwrap_or_else(|defects| panic!("{defects:?}"))
}

/// Water in all fractures, each as wide for it as its walls are apart.
pub fn water(mesh: &Mesh, conditions: Vec<FlowCondition>) -> Flow {
    let smooth = Conduit::Open(HydraulicAperture::OfWalls {
        roughness: Roughness::Factor(1.0),
        residual: 0.0,
    });
    Flow {
        initial_pressure: Field::default(),
        fluid: Fluid {
            viscosity: VISCOSITY,
            density: 0.0,
            compressibility: 0.0,
        },
        conduits: vec![smooth; mesh.fractures.len()],
        of_facets: Vec::new(),
        inactive: Vec::new(),
        conditions,
        gravity: DVec3::ZERO,
        gravity_case: 0,
        lines: Vec::new(),
        is_undrained: false,
    }
}

/// The same pressure (Pa) wherever fractures meet a side.
pub fn on_side(mesh: &Mesh, name: &str, value: f64) -> FlowCondition {
    let found = mesh.boundaries.iter().position(|side| side.name == name);
    FlowCondition {
        name: name.into(),
        place: FlowPlace::Boundary(found.expect("a side")),
        drive: FlowDrive::Pressure(Field::constant(value)),
        case: 0,
    }
}

/// A rate (m^3/s) that enters where fractures meet a side.
pub fn fed_from_side(mesh: &Mesh, name: &str, rate: f64) -> FlowCondition {
    FlowCondition {
        drive: FlowDrive::Rate(rate),
        ..on_side(mesh, name, 0.0)
    }
}

/// A borehole at the node nearest to a place.
pub fn well(mesh: &Mesh, at: DVec3, radius: f64, drive: FlowDrive) -> FlowCondition {
    let nodes = 0..mesh.nodes.len();
    let distance = |node: &usize| mesh.nodes[*node].distance(at);
    let node = nodes.min_by(|a, b| distance(a).total_cmp(&distance(b)));
    FlowCondition {
        name: format!("well at {at}"),
        place: FlowPlace::Well {
            node: node.expect("nodes") as u32,
            radius,
        },
        drive,
        case: 0,
    }
}

/// Apertures (m) by place and fracture, one for each entry of the flat node list of the facets.
pub fn apertures(mesh: &Mesh, of: impl Fn(DVec3, usize) -> f64) -> Vec<f64> {
    let facets = mesh.facets.fracture.iter().enumerate();
    let all = facets.flat_map(|(facet, &fracture)| {
        let nodes = mesh.facets.elements.nodes_of(facet).iter();
        let of = &of;
        nodes.map(move |&node| of(mesh.nodes[node as usize], fracture as usize))
    });
    all.collect()
}

/// A flow that was solved.
pub struct Solved<'a> {
    /// The discrete flow.
    pub system: FlowSystem<'a>,
    /// Its state under the whole load.
    pub state: FlowState,
}

/// Solves a flow at these apertures (m).
pub fn solved<'a>(mesh: &'a Mesh, flow: &'a Flow, apertures: &[f64]) -> Solved<'a> {
    let system = FlowSystem::of(mesh, flow, apertures);
    let mut system = system.unwrap_or_else(|defects| panic!("{defects:?}"));
    system.factorise().expect("positive definite");
    let state = system.solve(&Load::proportional(1.0)).expect("finite");
    Solved { system, state }
}

impl Solved<'_> {
    /// Largest difference of the pressures from those expected (Pa).
    pub fn pressure_error(&self, mesh: &Mesh, expected: impl Fn(DVec3) -> f64) -> f64 {
        let nodes = self.system.nodes().iter().zip(&self.state.pressures);
        let errors =
            nodes.map(|(&node, found)| (found - expected(mesh.nodes[node as usize])).abs());
        errors.fold(0.0, f64::max)
    }
}

/// The channel `z = 0.5` between the sides at `x = 0` and `x = 2`, 1 m wide, its nodes pushed about
/// in its plane.
pub fn channel(shape: Shape, n: usize) -> Mesh {
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

/// The arms of a star.
pub const ARMS: [&str; 4] = ["west", "east", "south", "north"];

/// Four half planes that meet in the line `x = y = 1`, 1 m high, 1 m long before they lean: those
/// to the south and north by `lean` m a metre.
pub fn star(shape: Shape, lean: f64) -> Mesh {
    let on: [&dyn Fn([f64; 3]) -> bool; 8] = [
        &|x| x[1] == 1.0 && x[0] <= 1.0,
        &|x| x[1] == 1.0 && x[0] >= 1.0,
        &|x| x[0] == 1.0 && x[1] <= 1.0,
        &|x| x[0] == 1.0 && x[1] >= 1.0,
        &|x| x[0] == 0.0,
        &|x| x[0] == 2.0,
        &|x| x[1] == 0.0,
        &|x| x[1] == 2.0,
    ];
    let names = ARMS.map(str::to_owned).into_iter();
    let names: Vec<String> = names.chain(ARMS.map(|arm| format!("side {arm}"))).collect();
    let surfaces = names.iter().zip(on);
    let surfaces: Vec<Patch<'_>> = surfaces.map(|(name, on)| Patch::new(name, on)).collect();
    let bend = |[x, y, z]: [f64; 3]| [x + lean * (y - 1.0), y, z];
    block(shape, ([4, 4, 2], [2.0, 2.0, 1.0]), &surfaces, bend)
}
