//! How far a run is from closed forms, and what it amounts to where there are none.

use glam::DVec3;
use kluft_solver::{FacetResult, Solution, System};
use lie_core::{Closure, FacetQuadrature, FacetRulePoint, Rock, facet_points};

use kluft_scene::{Extent, JumpProfile, Oracle};

use crate::crack_front::{Behind, stress_intensity};
use crate::measure::Measure;
use crate::summary::FractureSummary;

/// Jump at one quadrature point of a facet.
struct Sample {
    position: DVec3,
    opening: f64,
    slip: f64,
    /// m^2.
    area: f64,
}

/// The measures of a solution: of each fracture, what its summary says, and errors where it has a
/// closed form (`oracles`, one entry for each fracture). Fields are compared at the quadrature
/// points of the facets, between nodes too.
pub fn measures(
    system: &System<'_>,
    solution: &Solution,
    fractures: &[(String, FractureSummary)],
    oracles: &[Option<Oracle>],
) -> Vec<Measure> {
    let of = |(index, (name, summary)): (usize, &(String, FractureSummary))| {
        let oracle = oracles.get(index).copied().flatten();
        let errors =
            oracle.map(|oracle| MeasuredFracture::of(system, solution, index).errors(&oracle));
        let all = errors.into_iter().flatten().chain(values(summary));
        all.map(|measure| Measure {
            fracture: Some(name.clone()),
            ..measure
        })
        .collect::<Vec<_>>()
    };
    fractures.iter().enumerate().flat_map(of).collect()
}

/// What is measured without a closed form.
fn values(summary: &FractureSummary) -> [Measure; 4] {
    [
        ("mean_aperture", summary.aperture.mean),
        ("max_aperture", summary.aperture.max),
        ("mean_normal_traction", summary.normal_traction.mean),
        ("max_slip", summary.slip_max),
    ]
    .map(|(name, value)| plain(name, value))
}

/// The measure of the whole body: the energy stored in the rock (J).
pub fn energy(joules: f64) -> Measure {
    plain("energy", joules)
}

/// The measure of a reduction of strength: the last stable factor.
pub fn factor_of_safety(stable: f64) -> Measure {
    plain("factor_of_safety", stable)
}

/// A fracture of a solution.
struct MeasuredFracture<'a> {
    rock: &'a Rock,
    closure: Closure,
    samples: Vec<Sample>,
    /// Results at the facet points, with their places and areas.
    points: Vec<(&'a FacetResult, DVec3, f64)>,
}

impl<'a> MeasuredFracture<'a> {
    fn of(system: &'a System<'_>, solution: &'a Solution, index: usize) -> Self {
        let facets = &system.problem().mesh.facets;
        let own: Vec<usize> = facets.of_fracture(index).collect();
        let points = system.discretisation().interface().points().iter();
        let points = points.zip(&solution.facet_points);
        let points = points.filter(|(point, _)| point.fracture as usize == index);
        let beside = own.first().map_or(0, |&facet| facets.plus[facet] as usize);
        Self {
            rock: system.problem().rock(beside),
            closure: system.problem().fractures[index].law.closure,
            samples: own
                .iter()
                .flat_map(|&facet| samples(system, solution, facet))
                .collect(),
            points: points
                .map(|(point, result)| (result, point.position, point.area))
                .collect(),
        }
    }

    /// Errors against a closed form.
    fn errors(&self, oracle: &Oracle) -> Vec<Measure> {
        let mut found = Vec::new();
        if let Some(exact) = oracle.opening(self.rock) {
            found.extend(self.field("opening", oracle, |sample| sample.opening, &exact));
            found.push(self.at_centre(&exact));
            let whole = self.samples.iter().map(|sample| sample.area).sum();
            let volume: f64 = self.samples.iter().map(|s| s.opening * s.area).sum();
            found.push(compared("volume", volume, exact.volume(whole)));
        }
        found.extend(self.intensity(oracle));
        if let Some(exact) = oracle.slip(self.rock) {
            found.extend(self.field("slip", oracle, |sample| sample.slip, &exact));
        }
        if let Some(exact) = oracle.aperture(self.rock, &self.closure) {
            found.extend(self.constant("aperture", oracle, |result| result.aperture, exact));
        }
        if let Some(exact) = oracle.normal_traction(self.rock, &self.closure) {
            let of = |result: &FacetResult| result.normal_traction;
            found.extend(self.constant("normal_traction", oracle, of, exact));
        }
        found
    }

    /// Errors of what is the same everywhere, at the facet points.
    fn constant(
        &self,
        name: &str,
        oracle: &Oracle,
        of: fn(&FacetResult) -> f64,
        exact: f64,
    ) -> Vec<Measure> {
        norms(name, oracle, || {
            let points = self.points.iter();
            points.map(move |(result, x, area)| (*x, of(result) - exact, exact, *area))
        })
    }

    fn field(
        &self,
        name: &str,
        oracle: &Oracle,
        of: fn(&Sample) -> f64,
        exact: &JumpProfile,
    ) -> Vec<Measure> {
        norms(name, oracle, || {
            self.samples.iter().map(move |sample| {
                let expected = exact.at(sample.position);
                let difference = of(sample) - expected;
                (sample.position, difference, expected, sample.area)
            })
        })
    }

    /// Opening at the place nearest to the centre, against the closed form there.
    fn at_centre(&self, exact: &JumpProfile) -> Measure {
        let rho = |sample: &&Sample| exact.extent.rho(sample.position);
        let nearest = self.samples.iter().min_by(|a, b| rho(a).total_cmp(&rho(b)));
        let (value, expected) = nearest.map_or((f64::NAN, f64::NAN), |sample| {
            (sample.opening, exact.at(sample.position))
        });
        compared("centre_opening", value, expected)
    }

    fn intensity(&self, oracle: &Oracle) -> Option<Measure> {
        let (exact, radius) = (oracle.stress_intensity()?, oracle.extent.radius()?);
        let behind = self.samples.iter().map(|sample| Behind {
            distance: radius * (1.0 - oracle.extent.rho(sample.position)),
            opening: sample.opening,
            area: sample.area,
        });
        let modulus = self.rock.young_modulus / (1.0 - self.rock.poisson_ratio.powi(2));
        let value = stress_intensity(behind, radius, modulus)?;
        Some(compared("stress_intensity", value, exact))
    }
}

/// Errors of a field given by place, difference, closed form and area: root mean square and
/// largest, as shares of those of the closed form, everywhere and (with a ring) without the ring
/// along the front.
fn norms<I: Iterator<Item = (DVec3, f64, f64, f64)>>(
    name: &str,
    oracle: &Oracle,
    points: impl Fn() -> I,
) -> Vec<Measure> {
    let largest_exact = points().fold(0.0, |largest: f64, (_, _, exact, _)| {
        largest.max(exact.abs())
    });
    let measure = |suffix: &str, within: f64| {
        let chosen = points().filter(|(x, ..)| oracle.extent.rho(*x) <= within);
        let (mut square, mut whole, mut largest) = (0.0, 0.0, 0.0_f64);
        for (_, difference, exact, area) in chosen {
            square += area * difference * difference;
            whole += area * exact * exact;
            largest = largest.max(difference.abs());
        }
        [
            field_error(format!("{name}_l2{suffix}"), (square / whole).sqrt()),
            field_error(format!("{name}_max{suffix}"), largest / largest_exact),
        ]
    };
    let all = measure("", f64::INFINITY);
    match oracle.extent {
        Extent::Everywhere => all.to_vec(),
        _ => all
            .into_iter()
            .chain(measure("_inside", 1.0 - oracle.ring))
            .collect(),
    }
}

fn field_error(name: String, error: f64) -> Measure {
    Measure {
        name,
        fracture: None,
        value: None,
        exact: None,
        error: Some(error).filter(|error| error.is_finite()),
    }
}

fn plain(name: &str, value: f64) -> Measure {
    Measure {
        name: name.into(),
        fracture: None,
        value: Some(value).filter(|value| value.is_finite()),
        exact: None,
        error: None,
    }
}

fn compared(name: &str, value: f64, exact: f64) -> Measure {
    let error = (value - exact).abs() / exact.abs();
    Measure {
        exact: Some(exact).filter(|exact| exact.is_finite()),
        error: Some(error).filter(|error| error.is_finite()),
        ..plain(name, value)
    }
}

/// The jump of a facet at its quadrature points.
fn samples(system: &System<'_>, solution: &Solution, facet: usize) -> Vec<Sample> {
    let mesh = &system.problem().mesh;
    let elements = &mesh.facets.elements;
    let wall = |slots: &[u32], local: usize| {
        let slot = slots[elements.range(facet).start + local] as usize;
        let point = system.discretisation().points().of_cell_node[slot] as usize;
        solution.displacements[point]
    };
    let nodes = elements.nodes_of(facet);
    let nodes: Vec<DVec3> = nodes
        .iter()
        .map(|&node| mesh.nodes[node as usize])
        .collect();
    let jump =
        |local: usize| wall(&mesh.facets.plus_slots, local) - wall(&mesh.facets.minus_slots, local);
    let jumps: Vec<DVec3> = (0..nodes.len()).map(jump).collect();
    let sample = |point: &FacetRulePoint| {
        let shares = point.nodes.iter();
        let jump: DVec3 = shares
            .map(|&(local, share)| share * jumps[local as usize])
            .sum();
        let normal = point.area.normalize();
        let opening = jump.dot(normal);
        Sample {
            position: point.position,
            opening,
            slip: (jump - opening * normal).length(),
            area: point.area.length(),
        }
    };
    let rule = facet_points(elements.shapes[facet], &nodes, FacetQuadrature::Gauss);
    rule.iter().map(sample).collect()
}
