//! What pressures in fractures open, patch by patch.
//!
//! An even pressure over a patch of a fracture of width `h` opens it by
//!
//! ```text
//! c(h) = 1 / (k + r(h)),   r(h) = r(h_0) h_0 / h
//! ```
//!
//! per pascal, with the stiffness `k` of the joint and `r` of the rock, which is the softer the
//! wider the patch is: a penny-shaped crack opens as its radius (Sneddon 1946). What the row of a
//! node has by itself gives `k` and `r(h_0)`. With nested patches `P` of area `a_P = h_P^2`, of
//! which the rows have the areas `a`, pressures `p` open the volumes
//!
//! ```text
//! sum_P g_P a (a . p)_P / a_P,   g_P = c(h_P) - mean of c over the parts of P
//! ```
//!
//! beyond what each row opens by itself, so that a pressure that is even over a patch meets its
//! compliance: an additive multilevel operator as in J. H. Bramble, J. E. Pasciak, J. Xu, "Parallel
//! multilevel preconditioners", Math. Comp. 55 (1990).

use std::sync::Arc;

use super::patches::Patches;

/// What rows open by themselves.
pub(super) struct OwnCompliance<'s> {
    /// Area of each row (m^2).
    pub(super) areas: &'s [f64],
    /// What a unit pressure opens at each row (m^3/Pa), with the stiffness of the joints and
    /// without.
    pub(super) opened: [&'s [f64]; 2],
}

/// How much more patches open than their parts by themselves.
pub(super) struct PatchCompliance {
    patches: Arc<Patches>,
    /// `a sqrt(rho / dt)` of each row (m^2 s^-1/2).
    shares: Vec<f64>,
    /// `g_P / a_P` of each patch of each level (1/(m Pa)).
    weights: Vec<Vec<f64>>,
}

/// Sums over a patch: its area `a`, and `a c`, `a k` and `a r h`.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    area: f64,
    opened: f64,
    joint: f64,
    rock: f64,
}

impl Sums {
    /// Of one row; nothing where it does not open.
    fn of_row(own: &OwnCompliance<'_>, row: usize) -> Self {
        let area = own.areas[row];
        let [whole, rock] = own.opened.map(|opened| opened[row] / area);
        if !(area > 0.0 && whole > 0.0 && rock >= whole) {
            return Self::default();
        }
        Self {
            area,
            opened: area * whole,
            joint: area * (whole.recip() - rock.recip()),
            rock: area * rock.recip() * area.sqrt(),
        }
    }

    fn add(&mut self, part: Self) {
        self.area += part.area;
        self.opened += part.opened;
        self.joint += part.joint;
        self.rock += part.rock;
    }

    /// `g_P / a_P`; from then on `a c` is that of the whole patch.
    fn widened(&mut self) -> f64 {
        if self.area <= 0.0 {
            return 0.0;
        }
        let wide = self.area.powi(2) / (self.joint + self.rock / self.area.sqrt());
        let more = (wide - self.opened).max(0.0);
        self.opened += more;
        more / self.area.powi(2)
    }
}

impl PatchCompliance {
    /// That of patches; `storing` is `rho / dt` of each row (kg/(m^3 s), of the density at rest).
    pub(super) fn of(
        patches: Arc<Patches>,
        own: &OwnCompliance<'_>,
        storing: impl Fn(usize) -> f64,
    ) -> Self {
        let rows = 0..own.areas.len();
        let share = |row: usize| own.areas[row] * storing(row).sqrt();
        let shares = rows.clone().map(share).collect();
        let mut parts: Vec<Sums> = rows.map(|row| Sums::of_row(own, row)).collect();
        let mut weights = Vec::new();
        for level in &patches.levels {
            let mut sums = vec![Sums::default(); level.count];
            for (part, &parent) in parts.iter().zip(&level.parents) {
                sums[parent as usize].add(*part);
            }
            weights.push(sums.iter_mut().map(Sums::widened).collect());
            parts = sums;
        }
        Self {
            patches,
            shares,
            weights,
        }
    }

    /// What pressures of the rows (Pa) store in each of them (m^3/s).
    pub(super) fn stored(&self, pressure: impl Fn(usize) -> f64) -> Vec<f64> {
        let shares = self.shares.iter().enumerate();
        let mut parts: Vec<f64> = shares.map(|(row, share)| share * pressure(row)).collect();
        let mut sums: Vec<Vec<f64>> = Vec::with_capacity(self.patches.levels.len());
        for level in &self.patches.levels {
            let mut own = vec![0.0; level.count];
            for (part, &parent) in parts.iter().zip(&level.parents) {
                own[parent as usize] += part;
            }
            sums.push(own.clone());
            parts = own;
        }
        // Of the widest patches, then of all parts of them.
        let mut opened = vec![0.0; parts.len()];
        let levels = self.patches.levels.iter().zip(&self.weights).zip(sums);
        for ((level, weights), sums) in levels.rev() {
            for ((opened, weight), sum) in opened.iter_mut().zip(weights).zip(sums) {
                *opened += weight * sum;
            }
            let parents = level.parents.iter();
            opened = parents.map(|&parent| opened[parent as usize]).collect();
        }
        let pairs = self.shares.iter().zip(opened);
        pairs.map(|(share, opened)| share * opened).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kluft_algebra::Lists;

    /// Rows on a line that are neighbours of the next ones.
    fn line(count: u32) -> Arc<Patches> {
        let around = |row: u32| (row.saturating_sub(1)..count.min(row + 2)).collect();
        let lists: Vec<Vec<u32>> = (0..count).map(around).collect();
        Arc::new(Patches::of(&Lists::collect(&lists)))
    }

    /// Rows of area 1 beside rock of stiffness 2 (Pa/m at this width) with a joint of `stiffness`.
    fn compliance(count: u32, stiffness: f64) -> PatchCompliance {
        let rows = count as usize;
        let own = OwnCompliance {
            areas: &vec![1.0; rows],
            opened: [&vec![1.0 / (stiffness + 2.0); rows], &vec![0.5; rows]],
        };
        PatchCompliance::of(line(count), &own, |_| 1.0)
    }

    #[test]
    fn an_even_pressure_meets_the_compliance_of_the_whole_fracture() {
        for stiffness in [0.0, 3.0, 1e9] {
            let count = 81;
            let found = compliance(count, stiffness).stored(|_| 1.0);
            let alone = 1.0 / (stiffness + 2.0);
            let wide = 1.0 / (stiffness + 2.0 / f64::from(count).sqrt());
            let opened = alone + found.iter().sum::<f64>() / f64::from(count);
            assert!((opened - wide).abs() < 1e-12 * wide, "{stiffness}");
        }
    }

    #[test]
    fn it_is_symmetric_and_opens_where_pressures_push() {
        let compliance = compliance(30, 0.1);
        let unit = |of: usize| compliance.stored(move |row| f64::from(u8::from(row == of)));
        let columns: Vec<Vec<f64>> = (0..30).map(unit).collect();
        for (row, column) in columns.iter().enumerate() {
            for (other, entry) in column.iter().enumerate() {
                assert!((entry - columns[other][row]).abs() < 1e-15);
                assert!(*entry > 0.0);
            }
        }
    }
}
