//! Damping of walls that nothing holds (Levenberg 1944, Marquardt 1963).
//!
//! Before a contact closes, or once a fracture has let go, a linear solve moves blocks as far as
//! next to nothing holds them: far beyond the gap that would have stopped them, and to another
//! equilibrium than the one that the loads lead to. An iterate that does so is taken back and
//! solved for with springs on all facet points, a share of the stiffness of the rock beside them.
//! They enter the matrix only and no balance.

/// Share while nothing overshoots: walls that nothing holds at all have a tangent too.
const LEAST: f64 = 1e-6;
/// The same in late iterations: where fractures a millionth as stiff as the rock beside them hold a
/// block, springs as stiff as they are would make Newton's method converge linearly.
const LEAST_LATE: f64 = 1e-10;
/// The most beside dashpots, against their stiffness.
const SHARE_OF_DASHPOTS: f64 = 1e-2;
/// Iterations of an increment after which they are late.
const EARLY: usize = 8;
/// Share that holds walls like rock.
const LARGEST: f64 = 1.0;
/// Factor from one share to the next.
const FACTOR: f64 = 100.0;

/// Springs on the facet points of an iterate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Damping {
    /// Their stiffness, against that of the rock beside them.
    pub(super) share: f64,
    /// The least in early iterations.
    least_early: f64,
    /// The least that linear solvers bear in late iterations.
    least_late: f64,
}

impl Damping {
    /// That of the first iteration.
    pub(super) const FIRST: Self = Self {
        share: LEAST,
        least_early: LEAST,
        least_late: LEAST_LATE,
    };

    /// That of the first iteration beside dashpots of a `share` of the stiffness of the rock:
    /// springs stiffer than they are would hold walls back that nothing else holds.
    pub(super) fn beside_dashpots(share: f64) -> Self {
        let least = f64::min(SHARE_OF_DASHPOTS * share, LEAST);
        Self {
            share: least,
            least_early: least,
            least_late: f64::min(least, LEAST_LATE),
        }
    }

    /// That to take after an iterate that overshoots; none if this is the largest.
    pub(super) fn stronger(self) -> Option<Self> {
        let share = (FACTOR * self.share).min(LARGEST);
        (self.share < LARGEST).then_some(Self { share, ..self })
    }

    /// That to take after one that does not, in iteration `count` of an increment.
    pub(super) fn weaker(self, count: usize) -> Self {
        let least = if count > EARLY {
            self.least_late
        } else {
            self.least_early
        };
        let share = (self.share / FACTOR).max(least);
        Self { share, ..self }
    }

    /// That to take where a linear solver has failed; none if this is no weaker than the first.
    pub(super) fn as_at_first(self) -> Option<Self> {
        let first = Self {
            share: LEAST,
            least_early: LEAST,
            least_late: LEAST,
        };
        (self.share < LEAST).then_some(first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn springs_soften_late_and_stay_as_stiff_as_solvers_need_them() {
        let late = (1..30).fold(Damping::FIRST, Damping::weaker);
        assert_eq!(
            (1..=EARLY).fold(Damping::FIRST, Damping::weaker).share,
            LEAST
        );
        assert_eq!(late.share, LEAST_LATE);
        let borne = late.as_at_first().expect("stronger");
        assert_eq!((9..30).fold(borne, Damping::weaker).share, LEAST);
        assert!(borne.as_at_first().is_none());
        let strong = borne.stronger().expect("stronger");
        assert!(strong.share > borne.share);
    }

    #[test]
    fn springs_beside_dashpots_stay_softer_than_they_are() {
        for share in [1e4, 1.0, 1e-3, 1e-9] {
            let mut damping = Damping::beside_dashpots(share);
            for count in 1..30 {
                assert!(damping.share <= SHARE_OF_DASHPOTS * share);
                damping = damping.weaker(count);
            }
        }
    }
}
