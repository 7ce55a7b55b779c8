//! Times and viscosities that make no sense beside the apertures and sizes of a scene.

use kluft_mesh::Mesh;
use kluft_solver::{Conduit, Flow, Fracture, Problem};
use lie_core::{ClosureKind, Conduction};

use crate::scene::Scene;
use crate::warning::Doubt;

/// Where pressure spreads by less than this share of a facet in all of a run, nothing flows.
const STANDS: f64 = 1e-2;
/// Share of a facet by which pressure spreads in the unit that a value looks like.
const SPREADS: f64 = 0.1;
/// Where every time step is longer than the pressure takes through the body by this factor, the
/// flow is steady.
const STEADY: f64 = 1e6;
/// Viscosities from which on a value looks like one in mPa s (Pa s).
const THICK: f64 = 0.1;
/// Units that times are mistaken for, in seconds.
const UNITS: [(&str, f64); 4] = [
    ("minutes", 60.0),
    ("hours", 3600.0),
    ("days", 86_400.0),
    ("years", 31_557_600.0),
];

/// How fast pressure spreads in the fractures of a scene, beside their sizes and times.
struct Spreading {
    /// The largest diffusivity of a fracture (m^2/s).
    diffusivity: f64,
    /// Viscosity (Pa s).
    viscosity: f64,
    /// Mean length of the edges of facets (m), and length of the body (m).
    sizes: [f64; 2],
    /// The shortest time step, and all of the run (s).
    times: [f64; 2],
}

/// What the user should look at twice of the times of a flow.
pub(crate) fn warning(scene: &Scene, problem: &Problem, flow: &Flow) -> Option<String> {
    let text = Spreading::of(scene, problem, flow)?.doubt(flow)?;
    scene.warning(Doubt::FluidTimes, &text)
}

impl Spreading {
    /// None if the flow takes no time.
    fn of(scene: &Scene, problem: &Problem, flow: &Flow) -> Option<Self> {
        let schedule = &problem.schedule;
        if !schedule.is_timed || scene.is_rigid() && !flow.is_stored(true) {
            return None;
        }
        let (low, high) = problem.mesh.bounds();
        let length = (high - low).max_element();
        let soft = problem.rocks.iter().map(|rock| length / rock.young_modulus);
        let soft = soft.fold(0.0, f64::max);
        let pairs = problem.fractures.iter().zip(&flow.conduits);
        let all = pairs.filter_map(|(own, conduit)| diffusivity(own, *conduit, flow, soft));
        let mut now = schedule.start().time;
        let start = now;
        let mut shortest = f64::INFINITY;
        for step in &schedule.steps {
            shortest = f64::min(shortest, step.load.time - now);
            now = step.load.time;
        }
        Some(Self {
            diffusivity: all.fold(0.0, f64::max),
            viscosity: flow.fluid.viscosity,
            sizes: [facet_size(&problem.mesh)?, length],
            times: [shortest, now - start],
        })
    }

    /// How far pressure spreads in a time (m).
    fn reach(&self, time: f64) -> f64 {
        (self.diffusivity * time).sqrt()
    }

    fn doubt(&self, flow: &Flow) -> Option<String> {
        let [facet, body] = self.sizes;
        let [step, whole] = self.times;
        let reach = self.reach(whole);
        if self.diffusivity > 0.0 && reach < STANDS * facet {
            return Some(format!(
                "in all of the run ({whole:.4e} s) pressure spreads by {reach:.1e} m, a small part \
                 of a facet ({facet:.1e} m): nothing flows{}",
                self.meant(facet)
            ));
        }
        let passes = body * body / self.diffusivity;
        let gives = flow
            .conditions
            .iter()
            .any(|entry| entry.drive.is_pressure());
        (gives && step > STEADY * passes).then(|| {
            format!(
                "pressure spreads through all of the body in {passes:.1e} s, and the shortest time \
                 step takes {step:.4e} s: the flow is steady at the end of each; steps in place of \
                 times say so, or viscosity (Pa s), apertures (m) or times (s) are in other units"
            )
        })
    }

    /// The unit that a value looks like, in which pressure would spread in a facet.
    fn meant(&self, facet: f64) -> String {
        let least = SPREADS * facet;
        if self.viscosity >= THICK && self.reach(1e3 * self.times[1]) >= least {
            let value = self.viscosity;
            return format!(
                "; the viscosity looks like mPa s: {value} mPa s = {} Pa s",
                1e-3 * value
            );
        }
        let looks = |(_, seconds): &&(&str, f64)| self.reach(seconds * self.times[1]) >= least;
        match UNITS.iter().find(looks) {
            Some((unit, _)) => format!("; times are in seconds, and look like {unit}"),
            None => "; times are in seconds, viscosities in Pa s".to_owned(),
        }
    }
}

/// How fast pressure spreads in a fracture without load (m^2/s), in rock that gives way by `soft`
/// (m/Pa).
fn diffusivity(own: &Fracture, conduit: Conduit, flow: &Flow, soft: f64) -> Option<f64> {
    let Conduit::Open(hydraulic) = conduit else {
        return None;
    };
    let closure = own.law.closure;
    let Conduction {
        hydraulic_aperture, ..
    } = hydraulic.at(closure.aperture);
    let of_law = match closure.kind {
        ClosureKind::Contact => 0.0,
        _ => closure.normal_stiffness,
    };
    let gives = (of_law + soft.recip()).recip();
    let stores = flow.fluid.compressibility * closure.aperture + gives;
    let conducts = hydraulic_aperture.powi(3) / (12.0 * flow.fluid.viscosity);
    (conducts > 0.0 && stores > 0.0).then(|| conducts / stores)
}

/// Mean length of the edges of all facets (m).
fn facet_size(mesh: &Mesh) -> Option<f64> {
    let elements = &mesh.facets.elements;
    let lengths = (0..elements.len()).flat_map(|facet| {
        let corners = mesh.corners(elements, facet);
        let next = corners.iter().cycle().skip(1);
        let pairs = corners.iter().zip(next);
        pairs.map(|(a, b)| a.distance(*b)).collect::<Vec<_>>()
    });
    let (mut sum, mut count) = (0.0, 0_usize);
    for length in lengths {
        sum += length;
        count += 1;
    }
    (count > 0).then(|| sum / count as f64)
}
