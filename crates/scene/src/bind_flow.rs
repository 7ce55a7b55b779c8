//! Where what a scene says of a fluid meets a mesh.

use kluft_keys::section_head;
use kluft_mesh::{Defect, Mesh};
use kluft_solver::{Cases, Conduit, Flow, FlowCondition, FlowDrive, FlowPlace, LineShare};

use crate::bind_conduits::{Conduits, nodes_of_fracture, places};
use crate::cases::Bound;
use crate::conditions::BoundaryEntry;
use crate::history::Timetable;
use crate::look::Look;
use crate::scene::{Isolated, Named, Scene};
use crate::sources::Drilling;

/// The flow of a scene, if it has a fluid; what the user should know of it goes to `decisions`.
///
/// # Errors
/// A fluid that no fracture conducts, and boreholes that hit no fracture.
pub(crate) fn bind_flow(
    scene: &Scene,
    mesh: &Mesh,
    bound: &Bound<'_>,
    cases: &Cases,
    decisions: &mut Vec<String>,
) -> Result<Option<Flow>, Vec<Defect>> {
    let Some(fluid) = &scene.fluid else {
        return Ok(None);
    };
    if scene.isolated == Isolated::Undrained && scene.is_rigid() {
        return Err(vec![Defect::new(
            &fluid.place,
            "isolated = \"undrained\", but the rock is rigid: what networks hold tells no pressure",
            "isolated = \"inactive\" leaves them out; a young_modulus lets their walls move",
        )]);
    }
    let Conduits {
        of_fractures: conduits,
        of_facets,
    } = Conduits::of(scene, mesh, (bound, &fluid.place), decisions)?;
    let weight = fluid.value.fluid.density * scene.body.gravity.z;
    let mut lines = Vec::new();
    let fractures = (mesh, &conduits[..]);
    let drilled = from_sources(
        fractures,
        (bound, cases),
        weight,
        (&mut lines, &mut *decisions),
    );
    let mut refused = [leaks_in_no_time(scene, bound), unweighed(scene, bound)].concat();
    if let Ok(drilled) = &drilled {
        let mut look = Look::of(scene, decisions);
        look_at_sources(mesh, bound, (drilled, &lines), &mut look);
        refused.extend(look.defects);
    }
    let drilled = match (drilled, refused) {
        (Ok(drilled), early) if early.is_empty() => drilled,
        (drilled, early) => return Err([early, drilled.err().unwrap_or_default()].concat()),
    };
    let mut conditions = on_boundaries(mesh, (bound, weight), cases);
    conditions.extend(in_fractures(mesh, bound, cases));
    conditions.extend(leaking(mesh, bound, cases));
    conditions.extend(drilled.into_iter().flatten());
    let flow = Flow {
        is_undrained: scene.isolated == Isolated::Undrained
            && !matches!(scene.timetable, Timetable::Times { .. }),
        fluid: fluid.value.fluid,
        initial_pressure: fluid.value.initial_pressure.resolved(weight),
        conduits,
        of_facets,
        inactive: Vec::new(),
        conditions,
        lines,
        gravity: scene.body.gravity,
        gravity_case: cases.gravity,
    };
    decisions.extend(decided(scene, &flow));
    Ok(Some(flow))
}

/// What each source does to the flow, for the weight of its fluid (Pa/m).
///
/// # Errors
/// Those that meet no fracture that conducts.
fn from_sources(
    (mesh, conduits): (&Mesh, &[Conduit]),
    (bound, cases): (&Bound<'_>, &Cases),
    weight: f64,
    (lines, decisions): (&mut Vec<Vec<LineShare>>, &mut Vec<String>),
) -> Result<Vec<Vec<FlowCondition>>, Vec<Defect>> {
    let (mut conditions, mut defects) = (Vec::new(), Vec::new());
    for (index, entry) in bound.sources.iter().enumerate() {
        let drilling = Drilling {
            mesh,
            conduits,
            bound,
            weight,
            case: cases.of_source(index),
        };
        match drilling.conditions(entry, (&mut *lines, &mut *decisions)) {
            Ok(own) => conditions.push(own),
            Err(defect) => defects.push(defect),
        }
    }
    match defects.is_empty() {
        true => Ok(conditions),
        false => Err(defects),
    }
}

/// Looks at pressures of sources that change from place to place, at the nodes where they act.
fn look_at_sources(
    mesh: &Mesh,
    bound: &Bound<'_>,
    (drilled, lines): (&[Vec<FlowCondition>], &[Vec<LineShare>]),
    look: &mut Look<'_>,
) {
    for (entry, conditions) in bound.sources.iter().zip(drilled) {
        let Some(field) = entry.value.drive.in_space() else {
            continue;
        };
        let nodes = conditions.iter().flat_map(|own| match own.place {
            FlowPlace::Well { node, .. } => vec![node],
            FlowPlace::Line(line) => lines[line].iter().map(|share| share.node).collect(),
            FlowPlace::Fracture(fracture) => nodes_of_fracture(mesh, fracture).collect(),
            FlowPlace::Boundary(_) => Vec::new(),
        });
        look.at(field, &places(mesh, nodes), &[0.0]);
    }
}

/// Conditions on parts of the outer surface, for the weight of the fluid (Pa/m).
fn on_boundaries(
    mesh: &Mesh,
    (bound, weight): (&Bound<'_>, f64),
    cases: &Cases,
) -> Vec<FlowCondition> {
    let entries = bound.boundaries.iter().enumerate();
    let conditions = entries.filter_map(|(index, entry)| {
        let boundary = mesh.boundaries.iter().position(|b| b.name == entry.name)?;
        Some(FlowCondition {
            name: section_head("boundary", &entry.name),
            place: FlowPlace::Boundary(boundary),
            drive: entry.value.fluid.as_ref()?.resolved(weight),
            case: cases.of_boundary_flow(index),
        })
    });
    conditions.collect()
}

/// Pressures that are given all over a fracture.
fn in_fractures(mesh: &Mesh, bound: &Bound<'_>, cases: &Cases) -> Vec<FlowCondition> {
    let entries = bound.fractures.iter().zip(&mesh.fractures).enumerate();
    let conditions = entries.filter_map(|(index, (entry, name))| {
        Some(FlowCondition {
            name: section_head("fracture", name),
            place: FlowPlace::Fracture(index),
            drive: entry.value.given_pressure.as_ref()?.drive.clone(),
            case: cases.of_fracture(index),
        })
    });
    conditions.collect()
}

/// What leaks off from fractures.
fn leaking(mesh: &Mesh, bound: &Bound<'_>, cases: &Cases) -> Vec<FlowCondition> {
    let entries = bound.fractures.iter().zip(&mesh.fractures).enumerate();
    let conditions = entries.filter_map(|(index, (entry, name))| {
        Some(FlowCondition {
            name: format!("leak-off from {name}"),
            place: FlowPlace::Fracture(index),
            drive: FlowDrive::Leakoff(entry.value.leakoff.as_ref()?.leakoff.clone()),
            case: cases.of_fracture(index),
        })
    });
    conditions.collect()
}

/// Refuses water tables where the fluid has no weight, or one that is not along z.
fn unweighed(scene: &Scene, bound: &Bound<'_>) -> Vec<Defect> {
    let gravity = scene.body.gravity;
    let problem = match (gravity.z == 0.0, gravity.x == 0.0 && gravity.y == 0.0) {
        (true, _) => "there is a water table, but no gravity along z",
        (false, false) => "there is a water table, but gravity is not along z",
        (false, true) => return Vec::new(),
    };
    let initial = scene.fluid.iter();
    let initial = initial.map(|entry| (&entry.place, entry.value.initial_pressure.water_table));
    let driven = |entry: &Named<BoundaryEntry>| entry.value.fluid.as_ref()?.water_table;
    let boundaries = bound.boundaries.iter();
    let boundaries = boundaries.map(|entry| (&entry.place, driven(entry)));
    let sources = bound.sources.iter();
    let sources = sources.map(|entry| (&entry.place, entry.value.drive.water_table));
    let tables = initial
        .chain(boundaries)
        .chain(sources)
        .filter(|(_, level)| level.is_some());
    let remedy = "add [body] with gravity = [0, 0, -9.81], or write value and per_metre";
    tables
        .map(|(place, _)| Defect::new(place, problem, remedy))
        .collect()
}

/// Refuses what would leak off in no time, or out of fractures that store nothing.
fn leaks_in_no_time(scene: &Scene, bound: &Bound<'_>) -> Vec<Defect> {
    let is_timed = matches!(scene.timetable, Timetable::Times { .. });
    let fluid = scene.fluid.as_ref().map(|entry| entry.value.fluid);
    let stores = fluid.is_some_and(|fluid| fluid.compressibility > 0.0);
    let (problem, remedy) = match (is_timed, scene.is_rigid() && !stores) {
        (false, _) => (
            "fluid leaks off with the root of time, but the flow is steady",
            "give times = [...] (s) under [load] in place of steps, or remove leakoff",
        ),
        (true, true) => (
            "fluid leaks off, but the rock is rigid and the fluid does not give way: nothing is stored",
            "add compressibility = 4.5e-10 (1/Pa) to [fluid], or remove leakoff",
        ),
        (true, false) => return Vec::new(),
    };
    let leaking = bound.fractures.iter();
    let leaking = leaking.filter(|entry| entry.value.leakoff.is_some());
    leaking
        .map(|entry| Defect::new(&entry.place, problem, remedy))
        .collect()
}

/// How much model the flow needs.
fn decided(scene: &Scene, flow: &Flow) -> Vec<String> {
    let is_timed = matches!(scene.timetable, Timetable::Times { .. });
    let how = match (scene.is_rigid(), flow.follows_walls(is_timed)) {
        (true, _) => {
            "no young_modulus: the rock is rigid, flow alone in fractures of constant aperture"
        }
        (false, true) => {
            "flow and rock are solved together: apertures follow the pressure, and the flow them"
        }
        (false, false) => {
            "hydraulic apertures are constant: the flow is solved first, and its pressure pushes \
             the walls apart"
        }
    };
    let when = match (is_timed, scene.is_rigid()) {
        (true, false) => {
            "times are given: the flow takes time (s), fractures store what they open for"
        }
        (true, true) if flow.is_stored(is_timed) => {
            "times are given: the flow takes time (s), fractures store what pressure compresses"
        }
        _ => "the flow is steady at the end of every load step: no fluid is stored",
    };
    vec![how.to_owned(), when.to_owned()]
}
