//! Hydraulic apertures by the size of fractures.

use std::f64::consts::PI;

/// The hydraulic aperture `coefficient (r / 1 m)^exponent` of a fracture as large as a disc of
/// radius `r`. Transmissivities that go with a power of the size (de Dreuzy et al. 2002; Hyman et
/// al. 2016) are a third of their exponent here.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ApertureLaw {
    /// Hydraulic aperture at a radius of 1 m (m).
    pub coefficient: f64,
    /// Exponent of the radius.
    pub exponent: f64,
}

impl ApertureLaw {
    /// The hydraulic aperture (m) of a fracture of this area (m^2).
    pub fn of_area(self, area: f64) -> f64 {
        self.coefficient * libm::pow((area / PI).sqrt(), self.exponent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_times_the_area_is_twice_the_radius() {
        let law = ApertureLaw {
            coefficient: 1e-5,
            exponent: 0.5,
        };
        assert!((law.of_area(PI) - 1e-5).abs() < 1e-20);
        assert!((law.of_area(4.0 * PI) / law.of_area(PI) - 2.0_f64.sqrt()).abs() < 1e-15);
    }
}
