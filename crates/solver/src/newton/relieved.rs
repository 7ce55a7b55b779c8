//! Walls that slide for a part of an increment only, until others relieve them.
//!
//! At its end they stick, and the laws take walls that stick there to have stuck all along; so do
//! its halves, if the others slide or meet early in the first. Its first linear solve tells, which
//! does not know yet that they will: up to there the tractions go the straight way that it finds,
//! and exceed what friction bears. Where gaps close in the first half it may not tell either, and
//! the half is compared with its own halves.

use glam::DVec3;
use kluft_algebra::largest;
use lie_core::JointState;

use super::facet_points::{interface, tangent};
use super::path_error::Increment;
use crate::system::System;

/// Shear traction beyond what friction bears, against the largest traction then, that tells of
/// walls that slide.
const OVERLOADED: f64 = 0.1;
/// Bisections of the way to where walls begin to slide.
const BISECTIONS: usize = 30;

/// The straight way of the tractions of a facet point that an increment begins with.
struct StraightWay {
    joint: JointState,
    /// Normal and shear traction (Pa) that the whole of it adds.
    normal: f64,
    shear: DVec3,
}

/// Whether walls stick at both ends of an increment but must have slid in it, before those that
/// slide at its end began to, or those that touch there met; and other walls had moved by more than
/// a `slip` (m) until then, which theirs hardly exceeds.
pub(super) fn any_slid(system: &System<'_>, increment: &Increment<'_>, slip: f64) -> bool {
    let moved = largest(increment.predicted);
    let Some(share) = relief(system, increment).filter(|share| share * moved > slip) else {
        return false;
    };
    let [from, to] = [increment.from, increment.to].map(|state| state.reached.traction);
    let least = OVERLOADED * (from + share * (to - from));
    (0..increment.predicted.len()).any(|i| {
        let ends = [increment.from, increment.to].map(|state| state.facet_points[i].joint.sliding);
        ends == [false, false] && overload(system, increment, i, share) > least
    })
}

/// Whether others met in an increment, which had moved by more than a `slip` (m) until then, beside
/// walls with friction that stick at both its ends. These may have slid until then, and their own
/// tractions do not tell: what slides beside them takes load off them as soon as it does, and the
/// first linear solve does not know that it will.
pub(super) fn any_may_have_slid(system: &System<'_>, increment: &Increment<'_>, slip: f64) -> bool {
    let met = mean_share(system, |i| share_until_touching(system, increment, i));
    let moved = largest(increment.predicted);
    if !met.is_some_and(|share| share * moved > slip) {
        return false;
    }
    let mut points = interface(system).points.iter().enumerate();
    points.any(|(i, point)| {
        let [from, to] = [increment.from, increment.to].map(|state| &state.facet_points[i].joint);
        let sticks = !from.sliding && !to.sliding && to.normal_traction < 0.0;
        sticks && system.law(point).friction.is_some()
    })
}

/// The share of an increment after which walls that slide at its end begin to, and those that touch
/// there meet: the mean over their area, as the first of them relieve nothing; none if there are no
/// such walls.
fn relief(system: &System<'_>, increment: &Increment<'_>) -> Option<f64> {
    mean_share(system, |i| {
        let [from, to] = [increment.from, increment.to].map(|state| &state.facet_points[i].joint);
        match to.sliding && !from.sliding {
            true => share_until_sliding(system, increment, i),
            false => share_until_touching(system, increment, i),
        }
    })
}

/// The mean over the area of the facet points that have a share; none if none has.
fn mean_share(system: &System<'_>, share: impl Fn(usize) -> Option<f64>) -> Option<f64> {
    let (mut sum, mut area) = (0.0, 0.0);
    for (i, point) in interface(system).points.iter().enumerate() {
        if let Some(share) = share(i) {
            sum += share * point.area;
            area += point.area;
        }
    }
    (area > 0.0).then(|| sum / area)
}

/// The share of an increment after which walls meet that touch at its end.
fn share_until_touching(system: &System<'_>, increment: &Increment<'_>, i: usize) -> Option<f64> {
    let touches = increment.to.facet_points[i].joint.normal_traction < 0.0;
    touches.then(|| increment.share_until_met(system, i))?
}

/// The share of its straight way after which a facet point exceeds what friction bears, if it does.
fn share_until_sliding(system: &System<'_>, increment: &Increment<'_>, i: usize) -> Option<f64> {
    let is_beyond = |share: f64| overload(system, increment, i, share) > 0.0;
    let narrowed = |(low, high): (f64, f64), _| {
        let middle = 0.5 * (low + high);
        if is_beyond(middle) {
            (low, middle)
        } else {
            (middle, high)
        }
    };
    is_beyond(1.0).then(|| (0..BISECTIONS).fold((0.0, 1.0), narrowed).1)
}

/// Shear traction beyond what friction bears (Pa) at a facet point after a share of its straight
/// way, negative below; that of walls without friction is always below.
fn overload(system: &System<'_>, increment: &Increment<'_>, i: usize, share: f64) -> f64 {
    let point = &interface(system).points[i];
    let (law, from) = (system.law(point), &increment.from.facet_points[i]);
    let way = StraightWay::of(
        from.joint,
        point.normal,
        tangent(law, point, from).exact * increment.predicted[i],
    );
    law.overload(&way.at(share), &from.history)
}

impl StraightWay {
    /// From a state, across a facet with a unit `normal`, by a change of its traction (Pa).
    fn of(joint: JointState, normal: DVec3, change: DVec3) -> Self {
        let across = change.dot(normal);
        Self {
            joint,
            normal: across,
            shear: change - across * normal,
        }
    }

    /// What is carried after a share of it.
    fn at(&self, share: f64) -> JointState {
        JointState {
            normal_traction: self.joint.normal_traction + share * self.normal,
            shear: self.joint.shear + share * self.shear,
            ..self.joint
        }
    }
}
