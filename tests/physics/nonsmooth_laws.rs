//! Laws with kinks on facets of second order: contact with friction at as many points as jumps.

use glam::{DMat3, DVec3};
use kluft_mesh::Shape;
use kluft_mesh::structured::{Patch, cells_of};
use kluft_solver::{
    Discretisation, FacetState, Fracture, LinearMethod, NewtonSettings, Problem, Support,
};
use lie_core::{Closure, FractureLaw, Friction};

use kluft_verification::scenes;

fn rubbing() -> Fracture {
    Fracture {
        law: FractureLaw {
            closure: Closure::contact(0.0),
            shear_stiffness: f64::INFINITY,
            friction: Some(Friction {
                coefficient: 30_f64.to_radians().tan(),
                cohesion: 0.0,
                dilation: 0.0,
            }),
        },
        fluid_pressure: 0.0,
    }
}

/// A cube with a square crack inside that rubs at 30 degrees, on a fixed base.
fn cube(shape: Shape) -> Problem {
    let on: Vec<_> = (0..6)
        .map(|face| move |x: [f64; 3]| x[face / 2] == f64::from(face as u32 % 2))
        .collect();
    let mut patches: Vec<Patch<'_>> = std::iter::zip(&scenes::FACES, &on)
        .map(|(name, contains)| Patch { name, contains })
        .collect();
    let crack =
        |x: [f64; 3]| x[2] == 0.5 && (0.25..=0.75).contains(&x[0]) && (0.25..=0.75).contains(&x[1]);
    patches.push(Patch {
        name: "crack",
        contains: &crack,
    });
    let mesh = scenes::build(cells_of(shape, [8, 8, 4], [1.0; 3], &patches));
    let mut problem = scenes::problem(mesh, rubbing());
    let base = Support::Displacement([Some(0.0); 3]);
    scenes::support(&mut problem, "bottom", base);
    problem
}

/// Pressed by 10 MPa and sheared by 8 MPa the crack slides, and bends with the cube: part of it
/// opens. Walls overlap nowhere, and the second half of the way takes no more iterations than the
/// first.
#[test]
fn walls_rub_on_facets_of_second_order() {
    let shapes = Shape::CELLS
        .into_iter()
        .filter(|shape| shape.is_quadratic());
    for shape in shapes {
        let mut problem = cube(shape);
        scenes::load(&mut problem, "top", DVec3::new(8e6, 2e6, -10e6));
        let steps = scenes::solve_path(&problem, NewtonSettings::default(), [0.5, 1.0, 0.7]);
        let interface = Discretisation::of(&problem)
            .expect("supported")
            .into_interface();
        for (record, solution) in steps {
            assert!(record.converged(), "{shape:?}: {record:?}");
            assert!(
                record.substeps.iter().all(|&count| count <= 12),
                "{shape:?}: {:?}",
                record.substeps
            );
            let nodes = solution.facet_nodes(&problem, &interface);
            assert!(
                nodes
                    .iter()
                    .all(|node| node.aperture >= 0.0 && node.opening > -1e-12)
            );
            assert!(nodes.iter().all(|node| node.normal_traction <= 0.0));
            let sliding = nodes
                .iter()
                .filter(|node| node.state == FacetState::Slipping);
            assert!(sliding.count() > 0);
        }
    }
}

/// A disc in a box a hundred times as wide carries little of the loads. Everything slides from the
/// start, so the second half of the way is the first once more and the first correction of an exact
/// linear solver leads there. One that is exact only against what the disc carries, not against the
/// loads, takes no more iterations.
#[test]
fn a_fracture_that_carries_little_of_the_loads_slides_on() {
    let (half, size) = (100.0, [("h", 0.1), ("h_disc", 0.2), ("grow", 0.8)]);
    let wide = [("half", half), ("h_far", half)];
    let draft = scenes::geometry_of_order("penny", &[&size[..], &wide].concat(), 2);
    let mut problem = scenes::problem(scenes::build(draft), rubbing());
    let psi = 20_f64.to_radians();
    let along = DVec3::new(psi.cos(), 0.0, psi.sin());
    let stress = -100e6 * DMat3::from_cols(along * along.x, along * along.y, along * along.z);
    scenes::load_faces_with_stress(&mut problem, &["left", "right", "bottom", "top"], stress);
    let corner = |x: f64, y: f64| half * DVec3::new(x, y, -1.0);
    scenes::fix(&mut problem, corner(-1.0, -1.0), [Some(0.0); 3]);
    scenes::fix(
        &mut problem,
        corner(1.0, -1.0),
        [None, Some(0.0), Some(0.0)],
    );
    scenes::fix(&mut problem, corner(-1.0, 1.0), [None, None, Some(0.0)]);
    let [direct, iterative] = [LinearMethod::Direct, LinearMethod::Iterative].map(|method| {
        let settings = NewtonSettings {
            linear: Some(method),
            ..NewtonSettings::default()
        };
        let steps = scenes::solve_path(&problem, settings, [0.5, 1.0]);
        for (record, _) in &steps {
            assert!(record.converged(), "{record:?}");
        }
        steps
    });
    let error = direct[1].0.iterations[0].closure_error;
    assert!(error < 1e-3, "{error:e}");
    for (direct, iterative) in direct.iter().zip(&iterative) {
        let [direct, iterative] = [direct, iterative].map(|step| step.0.iterations.len());
        assert!(iterative <= direct, "{iterative} > {direct}");
    }
}

/// However often a step is divided, the first half of a substep serves as the whole of the next
/// one: no increment is solved twice.
#[test]
fn no_increment_of_a_divided_step_is_solved_twice() {
    let mut problem = cube(Shape::Tet4);
    scenes::load(&mut problem, "top", DVec3::new(8e6, 2e6, -10e6));
    let settings = NewtonSettings {
        path: 0.0,
        ..NewtonSettings::default()
    };
    let (steps, _) = scenes::solve_path(&problem, settings, [1.0])
        .pop()
        .expect("a step");
    let mut shares: Vec<f64> = steps.iterations.iter().map(|own| own.share).collect();
    shares.dedup();
    assert!(steps.converged() && shares.len() > 6, "{shares:?}");
    assert_eq!(shares[..6], [1.0, 0.5, 1.0, 0.25, 0.5, 0.125]);
}
