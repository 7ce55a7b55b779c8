//! Traction behind a crack front in a stiff joint, nodes and control points against Gauss points.

use kluft_mesh::Shape;
use lie_core::FacetQuadrature;

use kluft_verification::scenes::crack_front::tractions;

const STIFFNESS: [f64; 3] = [1.0, 1e4, 1e8];

/// Smallest normal traction of the joint over its largest.
fn worst(shape: Shape, quadrature: FacetQuadrature, stiffness: f64) -> f64 {
    let tractions = tractions(shape, quadrature, stiffness);
    let tractions = || tractions.iter().map(|(_, traction)| *traction);
    tractions().fold(f64::INFINITY, f64::min) / tractions().fold(0.0, f64::max)
}

#[test]
fn nodal_rules_have_no_traction_of_the_wrong_sign() {
    println!("smallest over largest normal traction ahead of a crack, over K h / E");
    let mut gauss_fails = 0;
    for shape in Shape::CELLS {
        for quadrature in [
            FacetQuadrature::Nodal,
            FacetQuadrature::Control,
            FacetQuadrature::Gauss,
        ] {
            let ratios = STIFFNESS.map(|stiffness| worst(shape, quadrature, stiffness));
            let text: Vec<String> = ratios.iter().map(|ratio| format!("{ratio:>9.4}")).collect();
            println!(
                "{:<10} {:<7} {}",
                format!("{shape:?}"),
                format!("{quadrature:?}"),
                text.join("")
            );
            match quadrature {
                FacetQuadrature::Nodal | FacetQuadrature::Control => {
                    assert!(
                        ratios.iter().all(|ratio| *ratio > 0.0),
                        "{shape:?}: {ratios:?}"
                    );
                }
                FacetQuadrature::Gauss => {
                    gauss_fails += ratios.iter().filter(|ratio| **ratio < 0.0).count();
                }
            }
        }
    }
    assert!(
        gauss_fails > 0,
        "the problem no longer shows what the rule is for"
    );
}
