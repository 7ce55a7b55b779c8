//! Random choices that are the same on every machine, each case with a stream of its own.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// The choices of one case.
pub struct RandomStream(ChaCha8Rng);

impl RandomStream {
    /// Those of a case: cases of one seed have streams of their own, whatever their order.
    pub fn new(seed: u64, case: usize) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(case as u64);
        Self(random)
    }

    /// A whole number below `end`; 0 if there is none.
    pub fn below(&mut self, end: usize) -> usize {
        (self.0.next_u64() % end.max(1) as u64) as usize
    }

    /// One of some items.
    pub fn pick<T: Clone>(&mut self, items: &[T]) -> T {
        items[self.below(items.len())].clone()
    }

    /// A number in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        let unit = (self.0.next_u64() >> 11) as f64 * 2.0_f64.powi(-53);
        low + (high - low) * unit
    }

    /// Ten to a power in [low, high), with three digits, as one would type it.
    pub fn decades(&mut self, low: f64, high: f64) -> f64 {
        rounded(10.0_f64.powf(self.between(low, high)))
    }

    /// Whether something with this probability happens.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.between(0.0, 1.0) < probability
    }
}

/// A number with three digits.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}
