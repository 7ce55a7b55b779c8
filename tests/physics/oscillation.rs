//! B11: traction behind a crack front in a stiff joint, nodal rule against Gauss points.
//!
//! A unit cube is pulled apart; one half of its middle plane is a free crack, the other half a joint
//! of stiffness `K = L E/h`. The joint is in tension everywhere, so a negative traction is an
//! artefact of quadrature (Schellekens & de Borst 1993).

use lie_core::{ClosureKind, FacetQuadrature};
use lie_mesh::Shape;
use lie_mesh::structured::{Patch, cells_of};
use lie_solver::{Discretisation, Support};

use crate::scenes::{self, ROCK, joint};

const CUBES: usize = 8;
const STIFFNESS: [f64; 3] = [1.0, 1e4, 1e8];

/// Smallest normal traction of the joint over its largest.
fn worst(shape: Shape, quadrature: FacetQuadrature, stiffness: f64) -> f64 {
    let on: Vec<_> = (0..6)
        .map(|face| move |x: [f64; 3]| x[face / 2] == f64::from(face as u32 % 2))
        .collect();
    let mut patches: Vec<Patch<'_>> = scenes::FACES
        .iter()
        .zip(&on)
        .map(|(name, contains)| Patch { name, contains })
        .collect();
    let crack = |x: [f64; 3]| x[2] == 0.5 && x[0] <= 0.5;
    let ahead = |x: [f64; 3]| x[2] == 0.5 && x[0] >= 0.5;
    patches.push(Patch {
        name: "crack",
        contains: &crack,
    });
    patches.push(Patch {
        name: "joint",
        contains: &ahead,
    });
    let draft = cells_of(shape, [CUBES, 2, CUBES], [1.0; 3], &patches);
    let mut problem = scenes::problem(scenes::build(draft), joint(ClosureKind::Linear));
    problem.facet_quadrature = quadrature;
    let stiff = stiffness * ROCK.young_modulus * CUBES as f64;
    for (fracture, k) in problem.fractures.iter_mut().zip([0.0, stiff]) {
        fracture.law.closure.normal_stiffness = k;
        fracture.law.shear_stiffness = k;
    }
    let pull = |z: f64| Support::Displacement([None, None, Some(z)]);
    scenes::support(&mut problem, "bottom", pull(0.0));
    scenes::support(&mut problem, "top", pull(1e-4));
    scenes::support(&mut problem, "left", Support::Symmetry);
    scenes::support(&mut problem, "front", Support::Symmetry);
    let solution = scenes::solve(&problem);
    let interface = Discretisation::of(&problem).expect("supported").interface;
    let points = std::iter::zip(&interface.points, &solution.facet_points);
    let tractions: Vec<f64> = points
        .filter(|(point, _)| point.fracture == 1)
        .map(|(_, result)| result.normal_traction)
        .collect();
    let largest = tractions.iter().copied().fold(0.0, f64::max);
    tractions.iter().copied().fold(f64::INFINITY, f64::min) / largest
}

#[test]
fn nodal_rules_have_no_traction_of_the_wrong_sign() {
    println!("smallest over largest normal traction ahead of a crack, over K h / E");
    let mut gauss_fails = 0;
    for shape in Shape::CELLS {
        for quadrature in [FacetQuadrature::Nodal, FacetQuadrature::Gauss] {
            let ratios = STIFFNESS.map(|stiffness| worst(shape, quadrature, stiffness));
            let text: Vec<String> = ratios.iter().map(|ratio| format!("{ratio:>9.4}")).collect();
            println!(
                "{:<10} {:<6} {}",
                format!("{shape:?}"),
                format!("{quadrature:?}"),
                text.join("")
            );
            match quadrature {
                FacetQuadrature::Nodal => {
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
