//! What enters, what leaves, and what is missing between them.

/// Flow through one condition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConditionFlow {
    /// Pressure there (Pa): at the wall of a borehole, else the mean of the nodes.
    pub pressure: f64,
    /// What enters through it (m^3/s); negative where it leaves.
    pub rate: f64,
}

/// The mass balance of a flow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlowBalance {
    /// What enters (m^3/s).
    pub inflow: f64,
    /// What leaves (m^3/s).
    pub outflow: f64,
    /// What nodes lose or gain that should not, as a share of what moves; 0 if nothing moves but
    /// rounding.
    pub mass_error: f64,
}

/// Rates below this share of the terms they are made of are their rounding.
const ROUNDING: f64 = 1e-13;

impl FlowBalance {
    /// The balance of what enters at each node (m^3/s) with what conditions drive there; `missing`
    /// is the sum of the sizes of the differences, `terms` that of the terms of all rates.
    pub(super) fn of(entering: impl Iterator<Item = f64>, missing: f64, terms: f64) -> Self {
        let (mut inflow, mut outflow) = (0.0, 0.0);
        for rate in entering {
            if rate > 0.0 {
                inflow += rate;
            } else {
                outflow -= rate;
            }
        }
        let moved = f64::max(inflow, outflow);
        let mass_error = match moved > ROUNDING * terms {
            true => missing / moved,
            false => 0.0,
        };
        Self {
            inflow,
            outflow,
            mass_error,
        }
    }
}
