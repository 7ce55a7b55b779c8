//! How far an increment may lead the jumps off the path of the loads.
//!
//! Two estimates, of which the larger counts. An increment is solved in one and in two, and their
//! jumps are compared. That tells nothing of walls that meet in the first half: the laws take walls
//! that stick at the end of an increment to have stuck all along, so both leave them where they
//! were before it, although they have slipped until they met. By how much, the first linear solve
//! tells, which does not know yet that they will. Once the path is lost, that does not matter any
//! more.
//!
//! It tells nothing, too, of walls that are stopped in the second half, as long as the whole
//! increment and the second half do the same. Then the second half is compared with its own halves;
//! the first is where walls slide another way in it than in the second. By how much walls slide on
//! that stop early in the first, their tractions tell (`stopped`).

use glam::DVec3;
use kluft_algebra::largest;
use lie_core::FractureLaw;

use super::Step;
use super::convergence::ratio;
use super::determinacy::{self, Determinacy};
use super::facet_points::interface;
use super::stopped;
use crate::FacetPointState;
use crate::assembly::facet_point::FacetPoint;
use crate::problem::Load;
use crate::system::{State, System};

/// Share of the largest jump by which an increment that is nearly straight moves walls at most
/// otherwise than its first linear solve.
const BENT: f64 = 0.1;
/// Share of the largest jump by which walls slide another way in one half than in the other.
const TURNED: f64 = 0.02;

/// An increment from one state to another.
pub(super) struct Increment<'a> {
    pub(super) from: &'a State,
    pub(super) to: &'a State,
    /// How far its first linear solve moves walls (m); empty if there was none.
    pub(super) predicted: &'a [DVec3],
}

impl Increment<'_> {
    /// The share of the increment after which the walls of a facet point meet as its first linear
    /// solve moves them; none if they are not apart at its start or do not meet.
    pub(super) fn share_until_met(&self, system: &System<'_>, i: usize) -> Option<f64> {
        let point = &interface(system).points[i];
        let from = &self.from.facet_points[i];
        share_until_met(system.law(point), from, self.predicted[i].dot(point.normal))
    }
}

/// How far jumps may be off the path.
pub(super) struct Apart {
    /// At each facet point (m).
    pub(super) lengths: Vec<f64>,
    /// Largest jump (m).
    pub(super) size: f64,
}

impl Apart {
    /// Of the end of a substep in one increment, against that in two. What is beyond a `tolerance`
    /// of `size` (m) is that of what the loads determine.
    pub(super) fn of(
        step: &Step<'_>,
        whole: &State,
        halves: [&Increment<'_>; 2],
        [size, tolerance]: [f64; 2],
    ) -> Self {
        let (system, end) = (step.system, halves[1].to);
        let differences = differences(system, whole, end);
        let [first, second] = halves.map(|half| match step.lost > 0.0 {
            true => vec![0.0; differences.len()],
            false => slips_until_met(system, half),
        });
        let states = [halves[0].from, halves[0].to, end];
        let stays = |i: usize| !end.facet_points[i].joint.sliding;
        let lengths = (0..differences.len()).map(|i| {
            let before = if stays(i) { first[i] } else { 0.0 };
            let stopped = stopped::slip(system, states, i);
            differences[i]
                .length()
                .max(before.max(second[i]))
                .max(stopped)
        });
        let mut apart = Self {
            lengths: lengths.collect(),
            size,
        };
        if apart.length() > tolerance * size {
            apart.leave_undetermined(system, end, &differences);
        }
        apart
    }

    /// The largest (m).
    pub(super) fn length(&self) -> f64 {
        self.lengths.iter().copied().fold(0.0, f64::max)
    }

    /// The largest against the largest jump.
    pub(super) fn share(&self) -> f64 {
        ratio(self.length(), self.size)
    }

    /// Where it is largest.
    pub(super) fn facet_point(&self) -> Option<usize> {
        let points = 0..self.lengths.len();
        points.max_by(|&a, &b| self.lengths[a].total_cmp(&self.lengths[b]))
    }

    /// Takes away what the loads do not determine in a state: no shorter step would.
    fn leave_undetermined(&mut self, system: &System<'_>, state: &State, jumps: &[DVec3]) {
        let Some(facets) = determinacy::floating(system, state) else {
            return;
        };
        for (i, point) in interface(system).points.iter().enumerate() {
            match facets[point.facet as usize] {
                Determinacy::Aperture => self.lengths[i] = 0.0,
                Determinacy::Slip => self.lengths[i] = jumps[i].dot(point.normal).abs(),
                Determinacy::Determined | Determinacy::Metastable => {}
            }
        }
    }
}

fn differences(system: &System<'_>, a: &State, b: &State) -> Vec<DVec3> {
    let pairs = a.unknowns.iter().zip(&b.unknowns);
    let between: Vec<DVec3> = pairs.map(|(a, b)| *a - *b).collect();
    interface(system).jumps(&between, &Load::NONE)
}

/// The largest jump of a state (m).
pub(super) fn largest_jump(system: &System<'_>, state: &State) -> f64 {
    largest(&interface(system).jumps(&state.unknowns, &state.load))
}

/// Whether nothing slid or broke on the way.
pub(super) fn is_elastic(from: &State, to: &State) -> bool {
    let pairs = from.facet_points.iter().zip(&to.facet_points);
    let unbroken = |(from, to): (&FacetPointState, &FacetPointState)| {
        !to.joint.sliding && from.history.largest_opening == to.history.largest_opening
    };
    pairs.into_iter().all(unbroken)
}

/// Whether walls with friction move, in an increment in which they slide, otherwise than its first
/// linear solve has them by a share of `size` (m) that tells of others that meet or part in it.
pub(super) fn is_bent(system: &System<'_>, increment: &Increment<'_>, size: f64) -> bool {
    let (from, to) = (increment.from, increment.to);
    let points = interface(system).points.iter();
    let changes = differences(system, to, from);
    let moved = interface(system).prescribed_change(&from.load, &to.load);
    let pairs = increment.predicted.iter().zip(changes.iter().zip(&moved));
    points
        .zip(pairs)
        .enumerate()
        .any(|(i, (point, (predicted, (change, moved))))| {
            let slides = [from, to].map(|state| state.facet_points[i].joint.sliding);
            let along = in_facet(*predicted - *change - *moved, point.normal);
            slides.contains(&true) && along.length() > BENT * size
        })
}

/// Whether walls slide another way in the first of two increments than in the second, by a share of
/// `size` (m) that tells of what happens early in the first: both increments and their whole make
/// the same of that.
pub(super) fn turns(system: &System<'_>, halves: [&Increment<'_>; 2], size: f64) -> bool {
    let [first, second] = halves.map(|half| differences(system, half.to, half.from));
    let points = interface(system).points.iter();
    points
        .zip(first.iter().zip(&second))
        .enumerate()
        .any(|(i, (point, (first, second)))| {
            let slides = halves.map(|half| half.to.facet_points[i].joint.sliding);
            let [first, second] = [first, second].map(|jump| in_facet(*jump, point.normal));
            slides == [true, true] && across(first, second).length() > TURNED * size
        })
}

/// What of a vector is in a facet with a unit `normal`.
fn in_facet(vector: DVec3, normal: DVec3) -> DVec3 {
    vector - vector.dot(normal) * normal
}

/// What of a vector is not along another.
fn across(vector: DVec3, way: DVec3) -> DVec3 {
    let share = ratio(vector.dot(way), way.length_squared());
    vector - share.max(0.0) * way
}

/// How far off the walls are that stick at the end of an increment, by what they have slipped in it
/// until they met, at each facet point (m).
pub(super) fn slips_until_met(system: &System<'_>, increment: &Increment<'_>) -> Vec<f64> {
    let points = &interface(system).points;
    let mut slips = vec![0.0; points.len()];
    for (i, moved) in increment.predicted.iter().enumerate() {
        let [from, to] = [increment.from, increment.to].map(|state| &state.facet_points[i]);
        let (law, normal) = (system.law(&points[i]), points[i].normal);
        if law.friction.is_some() && !to.joint.sliding {
            slips[i] = slip_until_met(law, from, *moved, normal) * held(law, &points[i]);
        }
    }
    slips
}

/// How far walls slip that a linear solve has `moved` (m), until they meet and stick.
fn slip_until_met(law: &FractureLaw, from: &FacetPointState, moved: DVec3, normal: DVec3) -> f64 {
    let across = moved.dot(normal);
    let along = in_facet(moved, normal);
    share_until_met(law, from, across).map_or(0.0, |share| share * along.length())
}

/// The share of their way after which walls meet that a linear solve moves `across` (m), at most 1;
/// none if they are not apart or do not come closer.
fn share_until_met(law: &FractureLaw, from: &FacetPointState, across: f64) -> Option<f64> {
    let gap = open_by(law, from);
    (gap > 0.0 && across < 0.0).then(|| (gap / -across).min(1.0))
}

/// What counts of a slip at which walls are taken to stick although it is no elastic one: as much
/// as they hold against the rock, all of it without elastic slip, or what it would open them by.
fn held(law: &FractureLaw, point: &FacetPoint) -> f64 {
    let along = 1.0 / (1.0 + point.rock_stiffness().shear / law.shear_stiffness);
    let across = law.friction.map_or(0.0, |friction| friction.dilation);
    along.max(across)
}

/// By how much walls are apart that carry nothing (m), else 0.
fn open_by(law: &FractureLaw, state: &FacetPointState) -> f64 {
    let undilated = law.undilated(&state.joint, &state.history);
    match state.joint.normal_traction >= 0.0 {
        true => law.closure.gap(undilated).max(0.0),
        false => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use lie_core::{Closure, ClosureKind, Friction, JointState};

    use super::*;

    fn rough(aperture: f64) -> FractureLaw {
        let closure = Closure::new(aperture, f64::INFINITY, ClosureKind::Contact);
        FractureLaw {
            friction: Some(Friction {
                coefficient: 0.6,
                cohesion: 0.0,
                dilation: 0.0,
            }),
            ..FractureLaw::elastic(closure, f64::INFINITY)
        }
    }

    fn at(law: &FractureLaw, joint: JointState) -> FacetPointState {
        FacetPointState {
            joint: JointState {
                separation: law.closure.opened(0.0),
                ..joint
            },
            jump_residual: DVec3::ZERO,
            history: Default::default(),
        }
    }

    #[test]
    fn what_is_not_along_a_way_is_across_it_or_back() {
        let way = DVec3::new(2.0, 0.0, 0.0);
        assert_eq!(across(DVec3::new(3.0, 4.0, 0.0), way), 4.0 * DVec3::Y);
        assert_eq!(across(DVec3::new(-3.0, 4.0, 0.0), way).length(), 5.0);
        assert_eq!(across(DVec3::ZERO, DVec3::ZERO), DVec3::ZERO);
    }

    /// Walls 0.3 mm apart that approach by 1 mm meet after three tenths of the way.
    #[test]
    fn walls_slip_until_their_gap_is_closed() {
        let law = rough(3e-4);
        let open = at(&law, JointState::default());
        let slip = |moved| slip_until_met(&law, &open, moved, DVec3::Z);
        assert!((slip(DVec3::new(3e-4, 4e-4, -1e-3)) - 1.5e-4).abs() < 1e-18);
        assert_eq!(slip(DVec3::new(3e-4, 0.0, 1e-3)), 0.0);
    }
}
