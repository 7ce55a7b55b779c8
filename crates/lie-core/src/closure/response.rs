//! What a closure law answers.

/// Answer of the closure law at one aperture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalResponse {
    /// Normal traction `sigma_n` (Pa), tension positive.
    pub traction: f64,
    /// Slope `d sigma_n / d b` (Pa/m).
    pub tangent: f64,
    /// Energy per area `Psi` (J/m^2), zero at `b0`.
    pub potential: f64,
}

impl NormalResponse {
    pub(super) const NONE: Self = Self {
        traction: 0.0,
        tangent: 0.0,
        potential: 0.0,
    };
}
