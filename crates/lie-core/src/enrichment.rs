//! How the unknowns of a node combine to the displacement of each of its sectors.
//!
//! A node with `s` sectors has one continuous displacement (unknown 0) and `s - 1` jumps (unknowns
//! 1 to `s - 1`), each a 3-vector. The displacement of sector `i` is
//! `u_i = sum_k coefficient(s, i, k) y_k`, with the *centred* table
//!
//! ```text
//! coefficient(s, i, 0) = 1
//! coefficient(s, i, k) = [i = k] - 1/s
//! ```
//!
//! so the continuous displacement is the mean of the sectors' displacements, and with two sectors
//! the jump enters with -1/2 and +1/2. The space is that of Heaviside functions 0/1; the block of
//! the continuous displacements is the stiffness of the intact rock.

/// Entry of the table: weight of `unknown` in the displacement of `sector` at a node with `sectors`
/// sectors.
pub fn coefficient(sectors: u32, sector: u32, unknown: u32) -> f64 {
    if unknown == 0 {
        return 1.0;
    }
    f64::from(u8::from(sector == unknown)) - 1.0 / f64::from(sectors)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn continuous_displacement_is_the_mean_and_jumps_are_integer() {
        for sectors in 1..=8 {
            for unknown in 1..sectors {
                let sum: f64 = (0..sectors).map(|i| coefficient(sectors, i, unknown)).sum();
                assert!(sum.abs() < 1e-15);
                for (plus, minus) in [(unknown, 0), (0, unknown)] {
                    let jump =
                        coefficient(sectors, plus, unknown) - coefficient(sectors, minus, unknown);
                    assert!((jump.abs() - 1.0).abs() < 1e-15);
                }
            }
        }
        assert_eq!([0, 1].map(|sector| coefficient(2, sector, 1)), [-0.5, 0.5]);
    }
}
