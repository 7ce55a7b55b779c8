//! The push of a fluid on walls.

use glam::DVec3;
use kluft_mesh::Mesh;
use lie_core::{Closure, ClosureKind, FractureLaw, Rock};

use super::{SHAPES, apertures, channel, flow, is_close, on_side, pressure};
use crate::flow::FlowSystem;
use crate::problem::{Condition, Flow, Fracture, Problem, Support};
use crate::system::{Discretisation, System};

/// Loads of a system in rock whose joint has a given pressure, and a law that may be in contact.
fn loads(mesh: &Mesh, closure: Closure, given: f64, flow: Option<&Flow>) -> Vec<DVec3> {
    let rock = Rock {
        young_modulus: 1e9,
        poisson_ratio: 0.25,
        density: 0.0,
        anisotropy: None,
    };
    let law = FractureLaw::elastic(closure, 1e9);
    let problem = Problem {
        fractures: vec![Fracture {
            law,
            fluid_pressure: given,
        }],
        conditions: (0..mesh.boundaries.len())
            .filter(|&side| ["side top", "side bottom"].contains(&&*mesh.boundaries[side].name))
            .map(|boundary| Condition {
                boundary,
                load: None,
                support: Some(Support::Displacement([Some(0.0); 3])),
            })
            .collect(),
        ..Problem::of_rock(mesh.clone(), rock)
    };
    let discretisation = Discretisation::of(&problem).expect("held");
    let mut system = System::assemble(&problem, discretisation);
    if let Some(flow) = flow {
        let mut made = FlowSystem::of(mesh, flow, &apertures(mesh, |_, _| 1e-4)).expect("sound");
        made.factorise().expect("positive definite");
        system.push_walls(&made).expect("finite");
    }
    system.loads().cases()[0].applied.clone()
}

/// An even pressure pushes as one that is given, and one that is linear with its mean, on all
/// facets and where laws with kinks are evaluated at control points.
#[test]
fn a_fluid_pushes_the_walls_apart() {
    let linear = Closure::new(1e-4, 1e9, ClosureKind::Linear);
    for shape in SHAPES {
        for closure in [linear, Closure::contact(1e-4)] {
            let mesh = channel(shape, 2);
            let between = |left: f64, right: f64| {
                let conditions = vec![
                    on_side(&mesh, "side left", pressure(left)),
                    on_side(&mesh, "side right", pressure(right)),
                ];
                loads(&mesh, closure, 0.0, Some(&flow(&mesh, conditions)))
            };
            let given = loads(&mesh, closure, 2e6, None);
            let (even, falling) = (between(2e6, 2e6), between(3e6, 1e6));
            let largest = given.iter().map(|force| force.length()).fold(0.0, f64::max);
            for (given, even) in given.iter().zip(&even) {
                assert!((*given - *even).length() < 1e-12 * largest, "{shape:?}");
            }
            let moment = |forces: &[DVec3]| forces.iter().map(|force| force.z.abs()).sum::<f64>();
            if !shape.is_quadratic() {
                is_close(moment(&falling), moment(&given), 1e-11);
            }
            assert!(falling != even);
        }
    }
}
