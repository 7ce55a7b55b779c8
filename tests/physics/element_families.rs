//! Every element family: a uniform stress through an inclined joint and through three crossing
//! joints with eight octants, to 1e-9.

use glam::{DMat3, DVec3};
use kluft_mesh::structured::{Cut, Patch, cells_of, mixed};
use kluft_mesh::{Draft, Shape};

use kluft_verification::oracles::closed_aperture;
use kluft_verification::scenes::{self, EXACT, joint};

const STRESS: DMat3 = DMat3::from_cols(
    DVec3::new(-4.0e6, 1.0e6, -0.5e6),
    DVec3::new(1.0e6, -6.0e6, 0.7e6),
    DVec3::new(-0.5e6, 0.7e6, -9.0e6),
);

/// Shears the box, so that no plane of the grid but those of constant y keeps its direction.
fn sheared(mut draft: Draft) -> Draft {
    for [x, _, z] in &mut draft.nodes {
        (*x, *z) = (*x + 0.3 * *z, *z + 0.4 * *x);
    }
    draft
}

fn with_patches<T>(planes: &[usize], build: impl Fn(&[Patch<'_>]) -> T) -> T {
    let on = |axis: usize, at: f64| move |x: [f64; 3]| x[axis] == at;
    let faces: Vec<_> = (0..6)
        .map(|face| on(face / 2, f64::from(face as u32 % 2)))
        .collect();
    let joints: Vec<_> = planes.iter().map(|&axis| on(axis, 0.5)).collect();
    let mut patches: Vec<Patch<'_>> = scenes::FACES
        .iter()
        .zip(&faces)
        .map(|(name, contains)| Patch { name, contains })
        .collect();
    let names = ["x", "y", "z"];
    let fractures = planes.iter().zip(&joints);
    patches.extend(fractures.map(|(&axis, contains)| Patch {
        name: names[axis],
        contains,
    }));
    build(&patches)
}

/// The uniform stress must come out in every cell, and its traction and jump at every facet node.
fn carries_uniform_stress(name: &str, draft: Draft) {
    let mut problem = scenes::problem(scenes::build(sheared(draft)), joint(EXACT));
    scenes::load_with_stress(&mut problem, STRESS);
    // Two neighbours of the corner in its block: along the sheared x and along y.
    let neighbour = |along: DVec3| {
        let on = problem
            .mesh
            .nodes
            .iter()
            .filter(|x| x.cross(along).length() < 1e-12);
        let nearest = on.filter(|x| x.length() > 0.0).copied();
        nearest
            .min_by(|a, b| a.length().total_cmp(&b.length()))
            .expect("a neighbour")
    };
    let (x, y) = (neighbour(DVec3::new(1.0, 0.0, 0.4)), neighbour(DVec3::Y));
    // The first direction is inclined, so x is held beside z there instead of along it.
    scenes::fix(&mut problem, DVec3::ZERO, [Some(0.0); 3]);
    scenes::fix(&mut problem, x, [None, Some(0.0), Some(0.0)]);
    scenes::fix(&mut problem, y, [None, None, Some(0.0)]);
    let solution = scenes::solve(&problem);
    for stress in &solution.stresses {
        let expected = [-4.0e6, -6.0e6, -9.0e6, 1.0e6, 0.7e6, -0.5e6];
        for (value, expected) in stress.iter().zip(expected) {
            assert!(
                (value - expected).abs() < 1e-9 * 9.0e6,
                "{name}: {stress:?}"
            );
        }
    }
    for (facet, area) in problem.mesh.facet_areas().iter().enumerate() {
        let normal = area.normalize();
        let traction = STRESS * normal;
        let across = traction.dot(normal);
        let aperture = 1e-4 * closed_aperture(-across / (50e9 * 1e-4));
        let slip = (traction - across * normal) / 20e9;
        for index in problem.mesh.facets.elements.range(facet) {
            let point = &solution.facet_points[index];
            assert!(
                (point.traction - traction).length() < 1e-9 * 9.0e6,
                "{name}"
            );
            assert!((point.aperture / aperture - 1.0).abs() < 1e-9, "{name}");
            assert!(
                (point.slip - slip).length() < 1e-9 * slip.length(),
                "{name}"
            );
        }
    }
}

#[test]
fn every_family_passes_an_inclined_joint() {
    for shape in Shape::CELLS {
        let draft = with_patches(&[2], |patches| {
            cells_of(shape, [2, 2, 4], [1.0; 3], patches)
        });
        carries_uniform_stress(&format!("{shape:?}"), draft);
    }
}

#[test]
fn every_family_passes_eight_octants() {
    for shape in Shape::CELLS {
        let draft = with_patches(&[0, 1, 2], |p| cells_of(shape, [4; 3], [1.0; 3], p));
        carries_uniform_stress(&format!("{shape:?}"), draft);
    }
}

#[test]
fn mixed_meshes_pass_eight_octants() {
    let in_a_row =
        |[i, _, _]: [usize; 3]| [Cut::Hexahedron, Cut::Pyramids, Cut::Prisms, Cut::Hexahedron][i];
    let stacked = |[_, _, k]: [usize; 3]| {
        if k % 2 == 0 {
            Cut::Prisms
        } else {
            Cut::Tetrahedra
        }
    };
    let draft = with_patches(&[0, 1, 2], |p| mixed([4; 3], [1.0; 3], p, in_a_row));
    carries_uniform_stress("in a row", draft);
    let draft = with_patches(&[0, 1, 2], |p| mixed([4; 3], [1.0; 3], p, stacked));
    carries_uniform_stress("stacked", draft);
}
