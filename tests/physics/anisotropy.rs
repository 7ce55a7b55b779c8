//! Rock that is stiffer in some directions than in others, with axes that no mesh knows.

use glam::{DMat3, DVec3};
use kluft_mesh::Shape;
use kluft_mesh::structured::{Patch, cells_of};
use kluft_solver::Discretisation;
use lie_core::{Orthotropy, Rock};

use kluft_verification::scenes::uniform_stress::{errors, uniform};
use kluft_verification::scenes::{self, EXACT, joint};

fn axes() -> DMat3 {
    DMat3::from_euler(glam::EulerRot::XYZ, 0.4, -1.1, 0.7)
}

fn orthotropy() -> Orthotropy {
    Orthotropy {
        young_moduli: [60e9, 20e9, 35e9],
        poisson_ratios: [0.3, 0.1, 0.25],
        shear_moduli: [9e9, 12e9, 15e9],
        axes: axes(),
    }
}

/// Strain by the constants: stresses are turned to the axes, and strains back.
fn strain(stress: DMat3) -> DMat3 {
    let Orthotropy {
        young_moduli: [e1, e2, e3],
        poisson_ratios: [nu12, nu23, nu13],
        shear_moduli: [g12, g23, g13],
        axes,
    } = orthotropy();
    let s = axes.transpose() * stress * axes;
    let (s1, s2, s3) = (s.x_axis.x, s.y_axis.y, s.z_axis.z);
    let along = [
        s1 / e1 - nu12 / e1 * s2 - nu13 / e1 * s3,
        s2 / e2 - nu12 / e1 * s1 - nu23 / e2 * s3,
        s3 / e3 - nu13 / e1 * s1 - nu23 / e2 * s2,
    ];
    let (xy, yz, xz) = (
        s.y_axis.x / (2.0 * g12),
        s.z_axis.y / (2.0 * g23),
        s.z_axis.x / (2.0 * g13),
    );
    let own = DMat3::from_cols(
        DVec3::new(along[0], xy, xz),
        DVec3::new(xy, along[1], yz),
        DVec3::new(xz, yz, along[2]),
    );
    axes * own * axes.transpose()
}

/// A joint across the middle of a cube of cells of one shape.
fn jointed(shape: Shape) -> kluft_mesh::Draft {
    let on: Vec<_> = (0..6)
        .map(|face| move |x: [f64; 3]| x[face / 2] == f64::from(face as u32 % 2))
        .collect();
    let faces = scenes::FACES.iter().zip(&on);
    let faces = faces.map(|(name, contains)| Patch { name, contains });
    let mut patches: Vec<Patch<'_>> = faces.collect();
    patches.push(Patch {
        name: "joint",
        contains: &|x| x[2] == 0.5,
    });
    cells_of(shape, [2; 3], [1.0; 3], &patches)
}

/// Patch test: stress, traction and jump do not depend on the rock, the displacement is that of
/// Hooke's law written out. Round-off, divided by the share of the joint in it.
#[test]
fn a_uniform_stress_is_exact_in_all_shapes() {
    for shape in Shape::CELLS {
        let mut problem = uniform(jointed(shape), joint(EXACT));
        problem.rocks[0] = Rock::orthotropic(&orthotropy(), 0.0);
        let found = errors(&problem);
        assert!(
            found.iter().all(|error| *error < 1e-9),
            "{shape:?}: {found:?}"
        );
        let solution = scenes::solve(&problem);
        let stress = DMat3::from_cols(
            DVec3::new(-4.0e6, 1.0e6, -0.5e6),
            DVec3::new(1.0e6, -6.0e6, 0.7e6),
            DVec3::new(-0.5e6, 0.7e6, -9.0e6),
        );
        let wanted = strain(stress);
        let discretisation = Discretisation::of(&problem).expect("supported");
        let moved = |at: DVec3| {
            let node = scenes::node_at(&problem.mesh, at);
            let mut points = discretisation.points().node.iter();
            let point = points.position(|&other| other == node);
            solution.displacements[point.expect("a point")]
        };
        let [origin, east, north] = [DVec3::ZERO, DVec3::X, DVec3::Y].map(moved);
        let (east, north) = (east - origin, north - origin);
        for (found, wanted) in [
            (east.x, wanted.x_axis.x),
            (north.y, wanted.y_axis.y),
            (east.y + north.x, 2.0 * wanted.x_axis.y),
        ] {
            assert!(
                (found - wanted).abs() < 1e-12 * 1e-3,
                "{found:e} {wanted:e}"
            );
        }
    }
}
