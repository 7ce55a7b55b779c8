//! Each fracture of a solution, summed up.

use glam::DVec3;
use kluft_solver::{FacetPoint, FacetResult, FacetState, Interface, Lists, Problem, Solution};
use rayon::prelude::*;

use crate::spread::Spread;
use crate::summary::{FractureSummary, Undetermined};

/// Sums up the fractures of a solution; `nodes` are its results at the nodes of the facets.
pub fn fractures(
    problem: &Problem,
    interface: &Interface,
    solution: &Solution,
    nodes: &[FacetResult],
) -> Vec<(String, FractureSummary)> {
    let names = &problem.mesh.fractures;
    let facets = problem.mesh.facets.fracture.iter().copied();
    let points = interface.points().iter().map(|point| point.fracture);
    let facets = Lists::group(facets, names.len());
    let points = Lists::group(points, names.len());
    let numbered = names.par_iter().enumerate();
    numbered
        .map(|(fracture, name)| {
            let results = [&solution.facet_points, nodes];
            let own = Fracture::of(interface, points.of(fracture), results);
            (name.clone(), own.summary(problem, facets.of(fracture)))
        })
        .collect()
}

/// One point of a fracture.
struct Point<'a> {
    at: &'a FacetPoint,
    /// As the law sees it: at a control point, control values, which have the right integral.
    result: &'a FacetResult,
    /// Of the walls there.
    wall: &'a FacetResult,
}

/// The points of a fracture. Means and areas are taken from the results of the laws, extremes from
/// the walls.
struct Fracture<'a> {
    points: Vec<Point<'a>>,
    /// m^2.
    area: f64,
    /// Of all points of all fractures.
    results: &'a [FacetResult],
}

impl<'a> Fracture<'a> {
    fn of(
        interface: &'a Interface,
        points: &[u32],
        [results, nodes]: [&'a [FacetResult]; 2],
    ) -> Self {
        let points = points.iter().map(|&i| i as usize);
        let points: Vec<Point> = points
            .map(|i| Point {
                at: &interface.points()[i],
                result: &results[i],
                wall: nodes.get(i).unwrap_or(&results[i]),
            })
            .collect();
        Self {
            area: points.iter().map(|point| point.at.area).sum(),
            points,
            results,
        }
    }

    fn area_where(&self, holds: impl Fn(&FacetResult) -> bool) -> f64 {
        let chosen = self.points.iter().filter(|point| holds(point.result));
        // An empty sum of floats is -0.0.
        chosen.fold(0.0, |sum, point| sum + point.at.area)
    }

    /// Of a value of a result and the normal there.
    fn spread(&self, value: impl Fn(&FacetResult, DVec3) -> f64) -> Spread {
        let points = self.points.iter();
        let parts = points.clone();
        let parts = parts.map(|point| value(point.result, point.at.normal) * point.at.area);
        let at_walls = points.map(|point| value(point.wall, point.at.normal));
        Spread {
            min: at_walls.clone().fold(f64::INFINITY, f64::min),
            mean: parts.sum::<f64>() / self.area,
            max: at_walls.fold(f64::NEG_INFINITY, f64::max),
        }
    }

    /// `facets` are those of the fracture.
    fn summary(&self, problem: &Problem, facets: &[u32]) -> FractureSummary {
        let elements = &problem.mesh.facets.elements;
        let is_below = |i: usize| self.results[i].state == FacetState::BelowCutoff;
        let below = facets.iter();
        let below = below.filter(|&&facet| elements.range(facet as usize).any(is_below));
        let slip = self.spread(|result, _| result.slip.length());
        let open_area = self.area_where(|result| result.state == FacetState::Open);
        let forces = self.points.iter();
        let force: DVec3 = forces
            .map(|point| point.at.area * point.result.traction)
            .sum();
        FractureSummary {
            facets: facets.len(),
            area: self.area,
            aperture: self.spread(|result, _| result.aperture),
            normal_traction: self.spread(|result, _| result.normal_traction),
            shear_traction: self.spread(|result, normal| {
                (result.traction - result.normal_traction * normal).length()
            }),
            slip,
            slip_max: slip.max.max(0.0),
            force: force.to_array(),
            open_area,
            sliding_area: self.area_where(|result| result.state == FacetState::Slipping),
            closed_area: self.area - open_area,
            below_cutoff_area: self.area_where(|result| result.state == FacetState::BelowCutoff),
            below_cutoff_facets: below.count(),
            overlap_area: self.area_where(|result| result.aperture < 0.0),
            undetermined: Undetermined::default(),
            aperture_uncertainty: None,
            slip_uncertainty: None,
        }
    }
}
