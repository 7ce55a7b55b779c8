//! What several sections have.

use crate::range::Range;
use crate::table::Need;

/// Beyond this no rock is, and closure laws answer with numbers that overflow.
pub(super) const INITIAL: Range = Range::Within(-1e12, 1e12);
/// The same of a gradient.
pub(super) const INITIAL_GRADIENT: Range = Range::Within(-1e9, 1e9);

/// What holds without a history.
pub(super) const GROWS_ONCE: Need = Need::Without("grows once");
