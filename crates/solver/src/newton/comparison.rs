//! The end of a substep in one increment, compared with that in two.

use glam::DVec3;

use super::Step;
use super::path_error::{Apart, Increment};
use crate::flow::Coupling;
use crate::problem::Load;
use crate::system::{State, System};

/// The end of a substep in one increment and in two.
pub(super) struct Both<'a> {
    pub(super) from: &'a State,
    /// Where on the way of the loads it starts.
    pub(super) start: &'a End,
    pub(super) whole: &'a State,
    pub(super) half: &'a Ended,
    pub(super) end: Ended,
    /// Whether anything slid or broke on the way.
    pub(super) slides: bool,
    /// Whether the substep is not divided any more.
    pub(super) is_smallest: bool,
    /// Whether it is a half of another.
    pub(super) is_half: bool,
}

/// A place on the way of the loads.
#[derive(Clone)]
pub(super) struct End {
    pub(super) load: Load,
    /// The share of the load step up to it.
    pub(super) share: f64,
}

/// How far the end of a substep in one increment is from that in two.
pub(super) struct Compared {
    /// In its jumps, if they depend on the path.
    pub(super) apart: Option<Apart>,
    /// In its flow, if that takes time.
    pub(super) in_time: Option<f64>,
    /// The larger, against what is allowed.
    pub(super) error: f64,
}

/// Where an increment has led.
#[derive(Clone)]
pub(super) struct Ended {
    pub(super) state: State,
    /// The share of the load step up to it.
    pub(super) share: f64,
    /// How far its first linear solve moved walls (m).
    pub(super) predicted: Vec<DVec3>,
}

impl Compared {
    /// Of a substep whose largest jump is `size` (m): its jumps may be off by a share of `path` of
    /// it, and its flow by `time`.
    pub(super) fn of(step: &Step<'_>, both: &Both<'_>, size: f64, [path, time]: [f64; 2]) -> Self {
        let (whole, halves) = (both.whole, &both.end.state);
        let flows = step.system.coupling().is_some_and(Coupling::is_transient);
        let apart = both.slides.then(|| {
            let [first, second] = both.increments();
            Apart::of(step, whole, [&first, &second], [size, path])
        });
        let in_time = flows.then(|| flows_apart(step.system, whole, halves));
        let of_flow = in_time.map(|apart| apart / time);
        let of_path = apart.as_ref().map(|apart| apart.share() / path);
        let error = of_path.into_iter().chain(of_flow).fold(0.0, f64::max);
        Self {
            apart,
            in_time,
            error,
        }
    }
}

impl Ended {
    /// Where it is on the way of the loads.
    pub(super) fn place(&self) -> End {
        End {
            load: self.state.load.clone(),
            share: self.share,
        }
    }

    /// The increment that it is the end of.
    pub(super) fn since<'a>(&'a self, from: &'a State) -> Increment<'a> {
        Increment {
            from,
            to: &self.state,
            predicted: &self.predicted,
        }
    }
}

impl End {
    /// A share of the way of a load step.
    pub(super) fn between(start: &Load, end: &Load, share: f64) -> Self {
        let load = match share == 1.0 {
            true => end.clone(),
            false => Load::between(start, end, share),
        };
        Self { load, share }
    }
}

impl Both<'_> {
    /// The two increments.
    pub(super) fn increments(&self) -> [Increment<'_>; 2] {
        [self.half.since(self.from), self.end.since(&self.half.state)]
    }
}

/// How far two states are apart in what their fluids fill and in their pressures.
fn flows_apart(system: &System<'_>, a: &State, b: &State) -> f64 {
    let fluids = a.fluid.as_ref().zip(b.fluid.as_ref());
    let both = system.coupling().zip(fluids);
    both.map_or(0.0, |(flow, (first, second))| {
        let largest = [b.reached.displacement, b.reached.pressure];
        flow.difference([first, second], &b.load, largest)
    })
}
