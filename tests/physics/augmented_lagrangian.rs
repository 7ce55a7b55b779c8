//! The augmented Lagrangian against statics.

use kluft_solver::{Discretisation, NewtonSettings, System};
use lie_core::Closure;

use kluft_verification::methods::augmented_lagrangian::augmented;
use kluft_verification::scenes::pressed::{inclined, inclined_traction};

/// The fixed point of Uzawa's iteration does not depend on `r`. The stress of the scene is
/// uniaxial, so the traction is known; 1e-9 is the tolerance of both iterations.
#[test]
fn its_fixed_point_is_the_traction_of_statics() {
    let scene = inclined();
    let problem = scene.with(Closure::contact(0.0));
    let discretisation = Discretisation::of(&problem).expect("supported");
    let system = System::assemble(&problem, discretisation);
    let exact = inclined_traction();
    for contrast in [1.0, 1e2] {
        let found = augmented(&system, contrast * scene.scale, NewtonSettings::default());
        let found = found.expect("converges");
        for traction in &found.tractions {
            assert!((traction / exact - 1.0).abs() < 1e-9, "{traction:e}");
        }
    }
}
