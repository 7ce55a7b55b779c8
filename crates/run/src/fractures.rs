//! Each fracture of a solution, summed up.

use glam::DVec3;
use kluft_solver::{FacetPoint, FacetResult, FacetState, Interface, Problem, Solution};

use crate::spread::Spread;
use crate::summary::{FractureSummary, Undetermined};

/// Sums up the fractures of a solution; `nodes` are its results at the nodes of the facets.
pub fn fractures(
    problem: &Problem,
    interface: &Interface,
    solution: &Solution,
    nodes: &[FacetResult],
) -> Vec<(String, FractureSummary)> {
    let names = problem.mesh.fractures.iter().enumerate();
    names
        .map(|(fracture, name)| {
            let own = Fracture::of(interface, [&solution.facet_points, nodes], fracture as u32);
            (name.clone(), own.summary(problem, fracture as u32))
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
    fn of(interface: &'a Interface, [results, nodes]: [&'a [FacetResult]; 2], own: u32) -> Self {
        let all = interface.points().iter().enumerate();
        let points = all.filter(|(_, point)| point.fracture == own);
        let points: Vec<Point> = points
            .map(|(i, at)| Point {
                at,
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

    fn summary(&self, problem: &Problem, own: u32) -> FractureSummary {
        let facets = &problem.mesh.facets;
        let of_fracture = (0..facets.elements.len()).filter(|&f| facets.fracture[f] == own);
        let is_below = |i: usize| self.results[i].state == FacetState::BelowCutoff;
        let below = of_fracture.clone();
        let below = below.filter(|&facet| facets.elements.range(facet).any(is_below));
        let slip = self.spread(|result, _| result.slip.length());
        let open_area = self.area_where(|result| result.state == FacetState::Open);
        let forces = self.points.iter();
        let force: DVec3 = forces
            .map(|point| point.at.area * point.result.traction)
            .sum();
        FractureSummary {
            facets: of_fracture.count(),
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
