//! A stream of random numbers that is the same on every machine.
//!
//! ChaCha counts in integers, and `libm` computes in Rust: the mathematics library of the system,
//! whose last digit differs between systems, has no part in it.

use std::f64::consts::PI;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// A stream of random numbers.
pub struct Stream(ChaCha8Rng);

impl Stream {
    /// The stream of a seed for the set of this name: other sets of the same seed have other
    /// streams, whatever their order.
    pub fn new(seed: u64, name: &str) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(fnv(name));
        Self(random)
    }

    /// Uniform in `[0, 1)`.
    pub fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * 2.0_f64.powi(-53)
    }

    /// Uniform in `[low, high)`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Normal with mean 0 and standard deviation 1 (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        // 1 - u is never 0.
        let radius = (-2.0 * libm::log(1.0 - self.uniform())).sqrt();
        radius * libm::cos(2.0 * PI * self.uniform())
    }
}

/// The hash of Fowler, Noll and Vo (FNV-1a): fixed for ever, unlike the standard library's.
fn fnv(text: &str) -> u64 {
    let mix = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    text.bytes().fold(0xcbf2_9ce4_8422_2325, mix)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stream_is_the_same_for_ever() {
        let mut stream = Stream::new(7, "joints");
        let drawn: Vec<u64> = (0..3).map(|_| stream.uniform().to_bits()).collect();
        let expected = [
            4601114356119426788,
            4605153496406879736,
            4603467515046727389,
        ];
        assert_eq!(drawn, expected, "networks of published seeds would change");
    }

    #[test]
    fn sets_have_streams_of_their_own() {
        let first = |seed, name| Stream::new(seed, name).uniform();
        assert_ne!(first(1, "a"), first(1, "b"));
        assert_ne!(first(1, "a"), first(2, "a"));
    }

    #[test]
    fn uniform_and_normal_have_their_moments() {
        let mut stream = Stream::new(1, "moments");
        let count = 200_000;
        let mean =
            |f: &mut dyn FnMut() -> f64| (0..count).map(|_| f()).sum::<f64>() / f64::from(count);
        // Bounds are four standard errors.
        assert!((mean(&mut || stream.uniform()) - 0.5).abs() < 0.0026);
        assert!(mean(&mut || stream.normal()).abs() < 0.009);
        assert!((mean(&mut || stream.normal().powi(2)) - 1.0).abs() < 0.0127);
    }
}
