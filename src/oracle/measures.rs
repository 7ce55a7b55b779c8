//! How far a run is from closed forms, and what it amounts to where there are none.

use glam::DVec3;
use lie_core::{Rock, RulePoint, rule};
use lie_solver::{FacetResult, Solution, System};
use serde::{Deserialize, Serialize};

use super::front::{Behind, stress_intensity};
use super::{Extent, Oracle, Profile};

/// One number by which runs are compared.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measure {
    /// What is measured.
    pub name: String,
    /// The fracture; none for the whole body.
    pub fracture: Option<String>,
    /// Its value, if it is one number.
    pub value: Option<f64>,
    /// Its value in closed form.
    pub exact: Option<f64>,
    /// Error as a share of the closed form; of a field, of its norm.
    pub error: Option<f64>,
}

/// Jump at one quadrature point of a facet.
struct Sample {
    position: DVec3,
    opening: f64,
    slip: f64,
    /// m^2.
    area: f64,
}

/// The measures of a solution: of each fracture, and errors where it has a closed form (`oracles`, one
/// entry for each fracture). Fields are compared at the quadrature points of the facets, between nodes
/// too.
pub fn measures(
    system: &System<'_>,
    solution: &Solution,
    oracles: &[Option<Oracle>],
) -> Vec<Measure> {
    let names = &system.problem.mesh.fractures;
    let of = |(fracture, name): (usize, &String)| {
        let fracture = Fracture::of(system, solution, fracture);
        let oracle = oracles.get(fracture.index).copied().flatten();
        let found = oracle.map(|oracle| fracture.errors(&oracle));
        let plain = fracture.plain().into_iter();
        let all = found.into_iter().flatten().chain(plain);
        all.map(|measure| Measure {
            fracture: Some(name.clone()),
            ..measure
        })
        .collect::<Vec<_>>()
    };
    names.iter().enumerate().flat_map(of).collect()
}

/// The measure of the whole body: the energy stored in the rock (J).
pub fn energy(joules: f64) -> Measure {
    plain("energy", joules)
}

/// A fracture of a solution.
struct Fracture<'a> {
    index: usize,
    rock: Rock,
    samples: Vec<Sample>,
    /// Results at the facet points, with their places and areas.
    points: Vec<(&'a FacetResult, DVec3, f64)>,
    /// Results at the nodes of its facets.
    nodes: Vec<FacetResult>,
}

impl<'a> Fracture<'a> {
    fn of(system: &System<'_>, solution: &'a Solution, index: usize) -> Self {
        let facets = &system.problem.mesh.facets;
        let own = |&facet: &usize| facets.fracture[facet] as usize == index;
        let own: Vec<usize> = (0..facets.elements.len()).filter(own).collect();
        let points = system.discretisation.interface.points.iter();
        let points = points.zip(&solution.facet_points);
        let points = points.filter(|(point, _)| point.fracture as usize == index);
        let beside = own.first().map_or(0, |&facet| facets.plus[facet] as usize);
        Self {
            index,
            rock: *system.problem.rock(beside),
            samples: own
                .iter()
                .flat_map(|&facet| samples(system, solution, facet))
                .collect(),
            nodes: {
                let nodes = solution.facet_nodes(system.problem, &system.discretisation.interface);
                let ranges = own.iter().flat_map(|&facet| facets.elements.range(facet));
                ranges.map(|slot| nodes[slot]).collect()
            },
            points: points
                .map(|(point, result)| (result, point.position, point.area))
                .collect(),
        }
    }

    /// What is measured without a closed form.
    fn plain(&self) -> Vec<Measure> {
        let area: f64 = self.points.iter().map(|(.., area)| area).sum();
        let mean = |of: fn(&FacetResult) -> f64| {
            let parts = self
                .points
                .iter()
                .map(|(result, _, area)| of(result) * area);
            parts.sum::<f64>() / area
        };
        let largest = |of: fn(&FacetResult) -> f64| {
            let values = self.nodes.iter().map(of);
            values.fold(f64::NEG_INFINITY, f64::max)
        };
        let values = [
            ("mean_aperture", mean(|result| result.aperture)),
            ("max_aperture", largest(|result| result.aperture)),
            (
                "mean_normal_traction",
                mean(|result| result.normal_traction),
            ),
            ("max_slip", largest(|result| result.slip.length())),
        ];
        values.map(|(name, value)| plain(name, value)).to_vec()
    }

    /// Errors against a closed form.
    fn errors(&self, oracle: &Oracle) -> Vec<Measure> {
        let mut found = Vec::new();
        if let Some(exact) = oracle.opening(&self.rock) {
            found.extend(self.field("opening", oracle, |sample| sample.opening, &exact));
            found.push(self.at_centre(&exact));
            let whole = self.samples.iter().map(|sample| sample.area).sum();
            let volume: f64 = self.samples.iter().map(|s| s.opening * s.area).sum();
            found.push(compared("volume", volume, exact.volume(whole)));
        }
        found.extend(self.intensity(oracle));
        if let Some(exact) = oracle.slip(&self.rock) {
            found.extend(self.field("slip", oracle, |sample| sample.slip, &exact));
        }
        if let Some(exact) = oracle.normal_traction {
            let points = || {
                let points = self.points.iter();
                points.map(|(result, x, area)| (*x, result.normal_traction - exact, exact, *area))
            };
            found.extend(norms("normal_traction", oracle, points));
        }
        found
    }

    fn field(
        &self,
        name: &str,
        oracle: &Oracle,
        of: fn(&Sample) -> f64,
        exact: &Profile,
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
    fn at_centre(&self, exact: &Profile) -> Measure {
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

/// Errors of a field given by place, difference, closed form and area: root mean square and largest, as
/// shares of those of the closed form, everywhere and (with a ring) without the ring along the front.
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
    let mesh = &system.problem.mesh;
    let elements = &mesh.facets.elements;
    let wall = |slots: &[u32], local: usize| {
        let slot = slots[elements.range(facet).start + local] as usize;
        let point = system.discretisation.points.of_cell_node[slot] as usize;
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
    let sample = |point: &RulePoint| {
        let along = |axis: usize| -> DVec3 {
            let terms = nodes.iter().zip(&point.gradient);
            terms.map(|(x, gradient)| *x * gradient[axis]).sum()
        };
        let mix = |values: &[DVec3]| -> DVec3 {
            let terms = values.iter().zip(&point.shape);
            terms.map(|(value, share)| *value * *share).sum()
        };
        let area = along(0).cross(along(1));
        let (normal, jump) = (area.normalize(), mix(&jumps));
        let opening = jump.dot(normal);
        Sample {
            position: mix(&nodes),
            opening,
            slip: (jump - opening * normal).length(),
            area: point.weight * area.length(),
        }
    };
    let places = &rule(elements.shapes[facet]).points;
    places.iter().map(sample).collect()
}
