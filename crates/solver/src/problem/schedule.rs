//! When what acts: load cases, each with a factor of its own, and the load steps.

use serde::{Deserialize, Serialize};

/// How far the loads have grown: a time and one factor for each load case.
///
/// A factor scales the loads (surface loads, gravity, fluid pressure) and the prescribed
/// displacements of its case. A case without a factor does not act. The initial stress is a state
/// and not a load: nothing scales it.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Load {
    /// Time, in the unit that the user chose.
    pub time: f64,
    /// Factor on each load case.
    pub factors: Vec<f64>,
}

impl Load {
    /// No load and no prescribed displacement.
    pub const NONE: Self = Self {
        time: 0.0,
        factors: Vec::new(),
    };

    /// One load case at a factor.
    pub fn proportional(factor: f64) -> Self {
        Self {
            time: factor,
            factors: vec![factor],
        }
    }

    /// The load at a `share` of the way from `a` (0) to `b` (1).
    pub fn between(a: &Self, b: &Self, share: f64) -> Self {
        Self::combination([(1.0 - share, a), (share, b)].into_iter())
    }

    /// The sum of loads of the same cases, each with its weight.
    pub(crate) fn combination<'a>(terms: impl Iterator<Item = (f64, &'a Self)>) -> Self {
        let mut sum = Self::NONE;
        for (weight, load) in terms {
            sum.time += weight * load.time;
            sum.factors
                .resize(load.factors.len().max(sum.factors.len()), 0.0);
            for (sum, factor) in sum.factors.iter_mut().zip(&load.factors) {
                *sum += weight * factor;
            }
        }
        sum
    }

    /// Factor on a load case.
    pub fn factor(&self, case: usize) -> f64 {
        self.factors.get(case).copied().unwrap_or(0.0)
    }

    /// The factor, if there is one load case only.
    pub fn single_factor(&self) -> Option<f64> {
        match self.factors[..] {
            [factor] => Some(factor),
            _ => None,
        }
    }

    /// Largest difference of a factor from that of another load.
    pub(crate) fn distance(&self, other: &Self) -> f64 {
        let cases = 0..self.factors.len().max(other.factors.len());
        cases
            .map(|case| (self.factor(case) - other.factor(case)).abs())
            .fold(0.0, f64::max)
    }
}

/// The end of a load step.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// What acts then.
    pub load: Load,
    /// The phase it belongs to, if the user named phases.
    pub phase: Option<String>,
}

/// Load case of each thing that a load factor scales. What a list does not reach is in case 0.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Cases {
    /// Of each of [`crate::Problem::conditions`].
    pub conditions: Vec<usize>,
    /// Of what drives the fluid at the surface of each of [`crate::Problem::conditions`].
    pub boundary_flows: Vec<usize>,
    /// Of the fluid pressure in each of [`crate::Problem::fractures`].
    pub fractures: Vec<usize>,
    /// Of each of [`crate::Problem::fixed_points`].
    pub fixed_points: Vec<usize>,
    /// Of each borehole of the user's.
    pub sources: Vec<usize>,
    /// Of gravity.
    pub gravity: usize,
}

impl Cases {
    /// Load case of a condition.
    pub fn of_condition(&self, condition: usize) -> usize {
        self.conditions.get(condition).copied().unwrap_or(0)
    }

    /// Load case of what drives the fluid at the surface of a condition.
    pub fn of_boundary_flow(&self, condition: usize) -> usize {
        self.boundary_flows.get(condition).copied().unwrap_or(0)
    }

    /// Load case of the fluid pressure in a fracture.
    pub fn of_fracture(&self, fracture: usize) -> usize {
        self.fractures.get(fracture).copied().unwrap_or(0)
    }

    /// Load case of a borehole.
    pub fn of_source(&self, source: usize) -> usize {
        self.sources.get(source).copied().unwrap_or(0)
    }

    /// Load case of a fixed point.
    pub fn of_fixed_point(&self, point: usize) -> usize {
        self.fixed_points.get(point).copied().unwrap_or(0)
    }
}

/// The load cases and the load steps of a problem. It starts at time 0 with nothing acting, unless
/// it goes on from what another has led to.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    /// What belongs to which case.
    pub cases: Cases,
    /// The load steps, at least one, all with the same number of factors.
    pub steps: Vec<Step>,
    /// Whether the times are the user's; if not, they count the steps.
    pub is_timed: bool,
    /// What acts where it goes on from, if it does.
    pub goes_on_from: Option<Load>,
    /// Factor on each load case right after time 0, as a flow that takes time sees it; zero where
    /// none stands.
    pub sudden: Vec<f64>,
}

impl Schedule {
    /// One load case for everything, and one step for each of `factors`.
    pub fn proportional(factors: Vec<f64>) -> Self {
        let steps = factors.into_iter().enumerate().map(|(index, factor)| Step {
            load: Load {
                time: (index + 1) as f64,
                factors: vec![factor],
            },
            phase: None,
        });
        Self {
            cases: Cases::default(),
            steps: steps.collect(),
            is_timed: false,
            goes_on_from: None,
            sudden: Vec::new(),
        }
    }

    /// Number of load cases.
    pub fn case_count(&self) -> usize {
        let counts = self.steps.iter().map(|step| step.load.factors.len());
        counts.max().unwrap_or(0).max(1)
    }

    /// What acts before the first step: nothing at time 0, or what it goes on from.
    pub fn start(&self) -> Load {
        let nothing = || Load {
            time: 0.0,
            factors: vec![0.0; self.case_count()],
        };
        self.goes_on_from.clone().unwrap_or_else(nothing)
    }

    /// What a step begins with whose loads walk in time: what acts right after time 0, or what the
    /// step before has ended with.
    pub(crate) fn walked_from(&self, before: &Load) -> Load {
        let factors = match before.time > 0.0 || self.sudden.is_empty() {
            true => before.factors.clone(),
            false => self.sudden.clone(),
        };
        Load {
            time: before.time,
            factors,
        }
    }

    /// Largest size that the factor of a case reaches at the end of a step.
    pub fn largest_factor(&self, case: usize) -> f64 {
        let factors = self.steps.iter().map(|step| step.load.factor(case).abs());
        factors.fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn load(time: f64, factors: &[f64]) -> Load {
        Load {
            time,
            factors: factors.to_vec(),
        }
    }

    #[test]
    fn between_two_loads_everything_is_linear() {
        let (a, b) = (load(1.0, &[0.0, 2.0]), load(3.0, &[1.0, -2.0]));
        assert_eq!(Load::between(&a, &b, 0.25), load(1.5, &[0.25, 1.0]));
        assert_eq!(Load::between(&a, &b, 0.0), a);
        assert_eq!(Load::between(&a, &b, 1.0), b);
    }

    #[test]
    fn what_is_not_listed_is_in_the_first_case() {
        let schedule = Schedule::proportional(vec![0.5, -2.0, 1.0]);
        assert_eq!(schedule.cases.of_condition(7), 0);
        assert_eq!(
            (schedule.case_count(), schedule.largest_factor(0)),
            (1, 2.0)
        );
        assert_eq!(schedule.steps[2].load, load(3.0, &[1.0]));
    }
}
