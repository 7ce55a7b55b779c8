//! Whether the loads are enough to push the walls of fractures through each other.

use glam::DVec3;
use kluft_mesh::{Survey, facet_area_vector};
use kluft_solver::{
    Condition, Field, LoadField, Problem, Support, SurfaceLoad, VaryingLoad, principal,
};
use lie_core::{Closure, ClosureKind};

use super::findings::{Inspection, WallFinding};

/// Compares the compression that the loads suggest with the one at which the walls of each
/// fracture meet.
pub fn judge(problem: &Problem, survey: &Survey, inspection: &mut Inspection) {
    let outside = compression(problem);
    for (index, fracture) in problem.fractures.iter().enumerate() {
        let closure = &fracture.law.closure;
        let factor = problem
            .schedule
            .largest_factor(problem.schedule.cases.of_fracture(index));
        let suction = (-factor * fracture.fluid_pressure).max(0.0);
        let suction = suction + varying_suction(problem, index);
        let expected = outside.map(|outside| outside + suction);
        let (law, limit) = meeting(closure);
        let overlap = match (limit, expected) {
            (None, _) => "never",
            (Some(_), None) => "unknown",
            (Some(limit), Some(expected)) if expected > limit => "yes",
            _ => "no",
        };
        let finding = WallFinding {
            fracture: problem.mesh.fractures[index].clone(),
            law,
            limit,
            expected,
            overlap,
        };
        if survey.fractures[index].facets > 0 {
            inspection.warnings.extend(warning(&finding));
        }
        inspection.walls.push(finding);
    }
}

/// Largest suction (Pa) of fluid pressures that vary within a fracture.
fn varying_suction(problem: &Problem, fracture: usize) -> f64 {
    let own = problem.varying.pressures.iter();
    let own = own.filter(|pressure| pressure.fracture == fracture);
    let largest = own.map(|pressure| {
        let factor = problem.schedule.largest_factor(pressure.case);
        let places = problem.places_of_fracture(fracture).into_iter();
        let values = places.map(|place| -factor * pressure.field.at(place, pressure.time));
        values.fold(0.0, f64::max)
    });
    largest.fold(0.0, f64::max)
}

fn warning(finding: &WallFinding) -> Option<String> {
    let (limit, expected) = (finding.limit?, finding.expected?);
    (finding.overlap == "yes").then(|| {
        format!(
            "the walls of `{}` meet at {limit:.3e} Pa and the loads suggest up to {expected:.3e} Pa: they may overlap; closure = \"logarithmic\" without cutoff_aperture never does",
            finding.fracture
        )
    })
}

/// The law in words, and the compression (Pa) at which its walls meet:
/// `K_n0 b0 (1 - ln(b_cut/b0))^2` with a cutoff, `K_n0 b0` for a linear one.
fn meeting(closure: &Closure) -> (&'static str, Option<f64>) {
    let scale = closure.normal_stiffness * closure.aperture;
    match closure.kind {
        ClosureKind::Contact => ("contact", None),
        ClosureKind::Hyperbolic { .. } => ("hyperbolic", None),
        ClosureKind::Own(law) => (law.name, None),
        _ if scale == 0.0 => ("free crack", Some(0.0)),
        ClosureKind::Linear => ("linear", Some(scale)),
        ClosureKind::Logarithmic { cutoff: None } => ("logarithmic", None),
        ClosureKind::Logarithmic {
            cutoff: Some(cutoff),
        } => {
            let stretch = 1.0 - (cutoff / closure.aperture).ln();
            ("logarithmic with cutoff", Some(scale * stretch.powi(2)))
        }
    }
}

/// Compression (Pa) that surface loads, weight and initial stress can cause in rock without
/// fractures: the sum of the largest of each. None if displacements are prescribed. Corners, tips
/// and fractures can concentrate it further.
fn compression(problem: &Problem) -> Option<f64> {
    let schedule = &problem.schedule;
    if prescribes_displacement(problem) {
        return None;
    }
    let conditions = problem.conditions.iter().enumerate();
    let surface = conditions.map(|(index, condition)| {
        let case = schedule.cases.of_condition(index);
        let factors = schedule.steps.iter().map(|step| step.load.factor(case));
        let of_steps = factors.map(|factor| pressed(problem, condition, factor));
        of_steps.fold(0.0, f64::max)
    });
    let (low, high) = problem.mesh.bounds();
    let density = problem.rocks.iter().map(|rock| rock.density);
    let gravity = schedule.largest_factor(schedule.cases.gravity) * problem.gravity.abs();
    let weight = density.fold(0.0, f64::max) * gravity.dot(high - low);
    let initial = problem.initial_stress.as_ref().map_or(0.0, |stress| {
        let ends = [low, high].map(|at| {
            let s = stress.at(at);
            let [x, y, z] = [s.x_axis, s.y_axis, s.z_axis];
            -principal(&[x.x, y.y, z.z, x.y, y.z, x.z])[0]
        });
        ends[0].max(ends[1]).max(0.0)
    });
    let varying = problem.varying.loads.iter();
    let varying = varying.map(|load| varying_compression(problem, load));
    let surface = surface.chain(varying).fold(0.0, f64::max);
    Some(surface + weight + initial)
}

fn prescribes_displacement(problem: &Problem) -> bool {
    let schedule = &problem.schedule;
    let moves = |(case, components): (usize, [Option<f64>; 3])| {
        schedule.largest_factor(case) != 0.0 && components.iter().flatten().any(|d| *d != 0.0)
    };
    let conditions = problem.conditions.iter().enumerate();
    let of_conditions = conditions.filter_map(|(index, condition)| match condition.support {
        Some(Support::Displacement(components)) => {
            Some((schedule.cases.of_condition(index), components))
        }
        _ => None,
    });
    let varying = problem.varying.displacements.iter();
    let mut varying = varying.map(|own| schedule.largest_factor(own.case));
    let fixed = problem.fixed_points.iter().enumerate();
    let fixed = fixed.map(|(index, point)| {
        let case = schedule.cases.of_fixed_point(index);
        (case, point.displacement)
    });
    varying.any(|factor| factor != 0.0) || of_conditions.chain(fixed).any(moves)
}

/// Largest compression (Pa) beside a loaded face: for a traction with normal part `s` and
/// tangential part `t` it is `sqrt(s^2/4 + t^2) - s/2`.
fn pressed(problem: &Problem, condition: &Condition, factor: f64) -> f64 {
    let boundary = &problem.mesh.boundaries[condition.boundary];
    match condition.load {
        None => 0.0,
        Some(SurfaceLoad::Pressure(pressure)) => (factor * pressure).max(0.0),
        Some(SurfaceLoad::Traction(traction)) => {
            let facets = 0..boundary.elements.len();
            let normals = facets.map(|facet| {
                let corners = problem.mesh.corners(&boundary.elements, facet);
                facet_area_vector(&corners).normalize_or_zero()
            });
            let beside = |normal: DVec3| beside(factor * traction, normal);
            normals.map(beside).fold(0.0, f64::max)
        }
    }
}

/// The same of a load that varies within its face: the largest over the nodes of its facets.
fn varying_compression(problem: &Problem, load: &VaryingLoad) -> f64 {
    let factor = problem.schedule.largest_factor(load.case);
    let elements = &problem.mesh.boundaries[load.boundary].elements;
    let of_facet = |facet: usize| {
        let corners = problem.mesh.corners(elements, facet);
        let normal = facet_area_vector(&corners).normalize_or_zero();
        let at = |field: &Field, corner: &DVec3| factor * field.at(*corner, load.time);
        let of_corner = |corner: &DVec3| match &load.load {
            LoadField::Pressure(field) => at(field, corner).max(0.0),
            LoadField::Traction(fields) => {
                let traction = DVec3::from([0, 1, 2].map(|axis| at(&fields[axis], corner)));
                beside(traction, normal)
            }
        };
        corners.iter().map(of_corner).fold(0.0, f64::max)
    };
    (0..elements.len()).map(of_facet).fold(0.0, f64::max)
}

/// Largest compression (Pa) beside a face with this normal, under a traction.
fn beside(traction: DVec3, normal: DVec3) -> f64 {
    let across = traction.dot(normal);
    let along = (traction - across * normal).length();
    (0.25 * across * across + along * along).sqrt() - 0.5 * across
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_meet_at_the_cutoff_where_the_law_says() {
        let closure = |kind| Closure::new(1e-4, 5e10, kind);
        for kind in [
            ClosureKind::Linear,
            ClosureKind::Logarithmic { cutoff: Some(1e-5) },
        ] {
            let closure = closure(kind);
            let limit = meeting(&closure).1.expect("a limit");
            let traction = closure.at_aperture(0.0).traction;
            assert!((limit + traction).abs() < 1e-9 * limit, "{kind:?}");
        }
        let exact = closure(ClosureKind::Logarithmic { cutoff: None });
        assert_eq!(meeting(&exact).1, None);
    }
}
