//! Stress intensity at a crack front, from the opening behind it.

/// Opening at a distance behind the front.
#[derive(Debug, Clone, Copy)]
pub(super) struct Behind {
    /// Distance from the front (m).
    pub(super) distance: f64,
    /// Opening there (m).
    pub(super) opening: f64,
    /// Area that it stands for (m^2).
    pub(super) area: f64,
}

/// Distances used, as shares of the radius: nearer the elements cannot follow the square root,
/// farther the expansion has more than two terms.
const NEAREST: f64 = 0.05;
const FARTHEST: f64 = 0.4;

/// `K_I` (Pa sqrt(m)) from `w = 8 K_I / E' sqrt(d / (2 pi))`, `E' = E / (1 - nu^2)` (G. R. Irwin,
/// J. Appl. Mech. 24, 1957): a straight line is fitted to `w^2 / d`, which is linear in `d` for an
/// ellipse, and taken at `d = 0`. `None` if there are too few places.
pub(super) fn stress_intensity(
    places: impl Iterator<Item = Behind>,
    radius: f64,
    plane_modulus: f64,
) -> Option<f64> {
    let range = NEAREST * radius..FARTHEST * radius;
    let used = places.filter(|place| range.contains(&place.distance));
    let mut sums = [0.0; 5];
    for Behind {
        distance,
        opening,
        area,
    } in used
    {
        let value = opening * opening.abs() / distance;
        let terms = [1.0, distance, distance * distance, value, value * distance];
        for (sum, term) in sums.iter_mut().zip(terms) {
            *sum += area * term;
        }
    }
    let [one, d, dd, v, vd] = sums;
    let determinant = one * dd - d * d;
    let at_front = (v * dd - vd * d) / determinant;
    let is_fitted = determinant > 1e-9 * one * dd && at_front.is_finite();
    let opening_scale = at_front.abs().sqrt().copysign(at_front);
    is_fitted.then(|| plane_modulus / 8.0 * (2.0 * std::f64::consts::PI).sqrt() * opening_scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pressurised strip: `w = 4 p / E' sqrt(a^2 - x^2)`, `K_I = p sqrt(pi a)`.
    #[test]
    fn an_ellipse_has_the_intensity_of_its_closed_form() {
        let (p, a, modulus) = (2e6, 1.5, 26e9);
        let places = (1..100).map(|i| {
            let distance = 0.01 * f64::from(i) * a;
            let x = a - distance;
            Behind {
                distance,
                opening: 4.0 * p / modulus * (a * a - x * x).sqrt(),
                area: 1.0,
            }
        });
        let found = stress_intensity(places, a, modulus).unwrap();
        let exact = p * (std::f64::consts::PI * a).sqrt();
        assert!((found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
    }

    #[test]
    fn nothing_is_fitted_to_one_place() {
        let place = Behind {
            distance: 0.2,
            opening: 1e-4,
            area: 1.0,
        };
        assert_eq!(stress_intensity([place].into_iter(), 1.0, 1e9), None);
    }
}
