//! Gives values that vary to the parts of a problem.

use glam::DVec3;
use kluft_mesh::{Defect, Mesh};
use kluft_solver::{LawParameter, Problem, VaryingLaw, VaryingLoad, VaryingPressure};
use lie_core::{ClosureKind, FacetQuadrature, FractureLaw, Tension, facet_points};

use crate::bind_displacements::bind_displacements;
use crate::bind_rocks::vary_rocks;
use crate::cases::Bound;
use crate::conditions::FractureEntry;
use crate::field::FieldEntry;
use crate::look::Look;
use crate::scene::{Named, Scene};
use crate::timed_cases::cases;

/// Gives a problem what varies in it; returns what is odd about the values.
///
/// # Errors
/// Values that are out of their range, or that a table or samples do not reach, each with a place.
pub(crate) fn bind_fields(
    scene: &Scene,
    bound: &Bound<'_>,
    problem: &mut Problem,
    decisions: &mut Vec<String>,
) -> Result<Vec<String>, Vec<Defect>> {
    let mut look = Look::of(scene, decisions);
    for (index, entry) in bound.fractures.iter().enumerate() {
        bind_law(problem, index, entry, &mut look);
        bind_pressure(problem, index, entry, &mut look);
    }
    let mut conditions = bound.boundaries.iter().enumerate();
    conditions.try_for_each(|(index, _)| bind_load(problem, bound, index, &mut look));
    bind_displacements(problem, bound, &mut look);
    look_at_springs(problem, bound, &mut look);
    vary_rocks(problem, &mut look);
    bind_initial_stress(problem, &mut look);
    match look.defects.is_empty() {
        true => Ok(look.warnings),
        false => Err(look.defects),
    }
}

fn bind_law(
    problem: &mut Problem,
    fracture: usize,
    entry: &Named<FractureEntry>,
    look: &mut Look<'_>,
) {
    if entry.value.fields.is_empty() {
        return;
    }
    let places = problem.places_of_fracture(fracture);
    let mut parameters = Vec::new();
    for (parameter, field) in &entry.value.fields {
        let Some(seen) = look.at(field, &places, &[0.0]) else {
            continue;
        };
        parameter.set(&mut problem.fractures[fracture].law, seen.mean);
        parameters.push((*parameter, field.field.clone()));
    }
    if parameters.len() < entry.value.fields.len() {
        return;
    }
    let law = VaryingLaw {
        fracture,
        parameters,
    };
    let base = problem.fractures[fracture].law;
    let refused = places.iter().find_map(|place| {
        let refusal = together(&law.at_position(&base, *place), &law)?;
        Some((place, refusal))
    });
    if let Some((place, refusal)) = refused {
        let [x, y, z] = place.to_array();
        let problem = format!("at ({x:.6}, {y:.6}, {z:.6}) {refusal}");
        let remedy = "change one of the two values there";
        look.defects
            .push(Defect::new(&entry.place, problem, remedy));
    }
    problem.varying.laws.push(law);
}

/// What parameters of a law refuse of one another, where one of them varies.
fn together(law: &FractureLaw, varying: &VaryingLaw) -> Option<String> {
    let closure = &law.closure;
    let aperture = closure.aperture;
    let varies = |wanted: LawParameter| varying.parameters.iter().any(|(own, _)| *own == wanted);
    match closure.kind {
        ClosureKind::Logarithmic {
            cutoff: Some(cutoff),
        } if cutoff > aperture => {
            return Some(format!(
                "cutoff_aperture {cutoff:e} is above the aperture {aperture:e}"
            ));
        }
        ClosureKind::Hyperbolic { max_closure } if max_closure > aperture => {
            return Some(format!(
                "max_closure {max_closure:e} is above the aperture {aperture:e}"
            ));
        }
        _ => {}
    }
    if let Tension::Cohesive { strength, energy } = closure.tension {
        let stored = strength * strength / 2.0 / closure.normal_stiffness;
        if energy <= stored {
            return Some(format!(
                "fracture_energy {energy:e} J/m^2 is not more than the {stored:.4e} J/m^2 stored at the strength"
            ));
        }
    }
    let friction = law.friction?;
    if friction.dilation > friction.coefficient {
        return Some("dilation_angle is above friction_angle".into());
    }
    (law.shear_stiffness == 0.0 && varies(LawParameter::ShearStiffness))
        .then(|| "shear_stiffness is 0, so that there is nothing for friction to limit".into())
}

fn bind_pressure(
    problem: &mut Problem,
    fracture: usize,
    entry: &Named<FractureEntry>,
    look: &mut Look<'_>,
) {
    let Some(field) = &entry.value.varying_pressure else {
        return;
    };
    let own = problem.schedule.cases.of_fracture(fracture);
    let in_time = field.field.depends_on_time();
    let Some(cases) = cases(
        problem,
        (in_time, own),
        &entry.value.history,
        look,
        &field.place,
    ) else {
        return;
    };
    let places = problem.places_of_fracture(fracture);
    let times: Vec<f64> = cases.iter().map(|(time, _)| *time).collect();
    look.at(field, &places, &times);
    let of_case = |(time, case)| VaryingPressure {
        fracture,
        field: field.field.clone(),
        time,
        case,
    };
    let pressures = cases.into_iter().map(of_case);
    problem.varying.pressures.extend(pressures);
}

fn bind_load(
    problem: &mut Problem,
    bound: &Bound<'_>,
    condition: usize,
    look: &mut Look<'_>,
) -> Option<()> {
    let entry = bound.boundaries[condition];
    let Some(load) = entry.value.varying_load() else {
        return Some(());
    };
    let own = problem.schedule.cases.of_condition(condition);
    let in_time = load.load.depends_on_time();
    let cases = cases(
        problem,
        (in_time, own),
        &entry.value.history,
        look,
        &entry.place,
    )?;
    let boundary = problem.conditions[condition].boundary;
    let places = places_of_boundary(&problem.mesh, boundary);
    let times: Vec<f64> = cases.iter().map(|(time, _)| *time).collect();
    for field in &load.fields {
        let own = match field.field.depends_on_time() {
            true => &times[..],
            false => &[0.0],
        };
        look.at(field, &places, own);
    }
    let of_case = |(time, case)| VaryingLoad {
        boundary,
        load: load.load.clone(),
        time,
        case,
    };
    let loads = cases.into_iter().map(of_case);
    problem.varying.loads.extend(loads);
    Some(())
}

fn look_at_springs(problem: &Problem, bound: &Bound<'_>, look: &mut Look<'_>) {
    for (entry, condition) in bound.boundaries.iter().zip(&problem.conditions) {
        let fields = entry.value.spring_fields();
        if fields.is_empty() {
            continue;
        }
        let places = places_of_boundary(&problem.mesh, condition.boundary);
        for field in fields {
            look.at(field, &places, &[0.0]);
        }
    }
}

/// Positions at which a load of a part of the outer surface is asked for (m).
fn places_of_boundary(mesh: &Mesh, boundary: usize) -> Vec<DVec3> {
    let elements = &mesh.boundaries[boundary].elements;
    let places = (0..elements.len()).flat_map(|facet| {
        let nodes = elements.nodes_of(facet).iter();
        let nodes: Vec<DVec3> = nodes.map(|&node| mesh.nodes[node as usize]).collect();
        let points = facet_points(elements.shapes[facet], &nodes, FacetQuadrature::Gauss);
        points.into_iter().map(|point| point.position)
    });
    places.collect()
}

fn bind_initial_stress(problem: &Problem, look: &mut Look<'_>) {
    let fields = look.scene.initial_stress.iter();
    let fields: Vec<&FieldEntry> = fields.flat_map(|entry| &entry.fields).collect();
    if fields.is_empty() {
        return;
    }
    let used = (0..problem.mesh.nodes.len()).filter(|&node| problem.mesh.sectors.count[node] > 0);
    let places: Vec<DVec3> = used.map(|node| problem.mesh.nodes[node]).collect();
    for field in fields {
        look.at(field, &places, &[0.0]);
    }
}
