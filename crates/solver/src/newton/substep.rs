//! A part of a load step: what is asked of it, and what it came to.

use super::StepOutcome;
use super::comparison::{End, Ended};
use crate::system::State;

/// A part of a load step.
pub(super) struct Substep {
    pub(super) start: End,
    pub(super) middle: End,
    pub(super) end: End,
    /// What one increment to its end comes to, if a longer substep has tried it.
    pub(super) whole: Option<Result<Ended, StepOutcome>>,
    /// Whether it is not divided any more.
    pub(super) is_smallest: bool,
    /// Whether it is a half of another, which is compared in any case.
    pub(super) is_half: bool,
}

/// What a substep came to.
pub(super) enum Solved {
    /// It stands.
    Accepted(Accepted),
    /// It is to be divided.
    TooLong(TooLong),
}

/// The end of a substep that stands.
pub(super) struct Accepted {
    pub(super) end: Box<State>,
    /// Whether the next substep may be longer.
    pub(super) may_grow: bool,
}

impl Accepted {
    pub(super) fn at(end: State) -> Self {
        Self {
            end: Box::new(end),
            may_grow: true,
        }
    }
}

/// What is known of a substep that is to be divided.
#[derive(Default)]
pub(super) struct TooLong {
    /// Why, if it is not for accuracy.
    pub(super) why: Option<StepOutcome>,
    /// Its end in one increment, if it was found.
    pub(super) whole: Option<Box<State>>,
    /// What one increment to its middle came to, or to a place before that if that is known to be
    /// too far, if it was tried.
    pub(super) half: Option<Half>,
}

impl TooLong {
    /// Where one increment to its end failed.
    pub(super) fn because(outcome: StepOutcome) -> Self {
        Self {
            why: Some(outcome),
            ..Self::default()
        }
    }
}

/// What one increment to the middle of a substep, or of its first half, came to.
pub(super) struct Half {
    /// The share of the load step up to it.
    pub(super) share: f64,
    pub(super) end: Result<Box<Ended>, StepOutcome>,
}

impl Half {
    pub(super) fn of(to: &End, end: Result<Ended, StepOutcome>) -> Self {
        Self {
            share: to.share,
            end: end.map(Box::new),
        }
    }
}
