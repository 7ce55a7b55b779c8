//! What enters, what leaves, what is stored, and what is missing between them.

use serde::{Deserialize, Serialize};

/// Flow through one condition.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ConditionFlow {
    /// Pressure there (Pa): at the wall of a borehole, else the mean of the nodes.
    pub pressure: f64,
    /// What enters through it at that time (m^3/s); negative where it leaves.
    pub rate: f64,
    /// What has entered through it in the last increment, in the mean of that time (m^3/s): the
    /// rate itself in steady flow, and where a pressure drives it.
    pub mean_rate: f64,
}

impl ConditionFlow {
    /// A flow at a pressure (Pa) with one rate (m^3/s) all the time.
    pub(super) fn steady(pressure: f64, rate: f64) -> Self {
        Self {
            pressure,
            rate,
            mean_rate: rate,
        }
    }
}

/// The mass balance of a flow.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct FlowBalance {
    /// What enters (m^3/s).
    pub inflow: f64,
    /// What leaves (m^3/s).
    pub outflow: f64,
    /// What fractures take up (m^3/s); negative where they give it off, zero in steady flow.
    pub stored: f64,
    /// The largest of what enters, leaves, is taken up and given off, and moves within networks
    /// that keep what they hold (m^3/s).
    pub moved: f64,
    /// What nodes lose or gain that should not, as a share of what moves; 0 if nothing moves but
    /// rounding.
    pub mass_error: f64,
    /// The part of it that rounding explains.
    pub rounding: f64,
}

/// Rates below this share of the terms they are made of are their rounding.
pub(super) const ROUNDING: f64 = 1e-15;

impl FlowBalance {
    /// The balance of what enters through conditions and what is stored at nodes (m^3/s) with what
    /// flows; `within` moves between nodes of networks that keep what they hold, `missing` is the
    /// sum of the sizes of the differences, `terms` that of the terms of all rates.
    pub(super) fn of(
        entering: impl Iterator<Item = f64>,
        (stored, within): (&[f64], f64),
        [missing, terms]: [f64; 2],
    ) -> Self {
        let (inflow, outflow) = sums(entering);
        let (taken_up, given_off) = sums(stored.iter().copied());
        let moved = [outflow, taken_up, given_off, within]
            .into_iter()
            .fold(inflow, f64::max);
        let share = |value: f64| match moved > ROUNDING * terms {
            true => value / moved,
            false => 0.0,
        };
        Self {
            inflow,
            outflow,
            stored: taken_up - given_off,
            moved,
            mass_error: share(missing),
            rounding: share(ROUNDING * terms),
        }
    }
}

/// Sums of what is positive, and of the sizes of what is negative.
fn sums(rates: impl Iterator<Item = f64>) -> (f64, f64) {
    let (mut positive, mut negative) = (0.0, 0.0);
    for rate in rates {
        if rate > 0.0 {
            positive += rate;
        } else {
            negative -= rate;
        }
    }
    (positive, negative)
}
