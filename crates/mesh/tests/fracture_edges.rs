//! Where fractures meet on structured meshes, by hand.

use kluft_mesh::structured::{Patch, tetrahedra};
use kluft_mesh::{FractureEdges, FracturesAtNodes, Mesh, SurfaceRole};

type Contains<'a> = &'a dyn Fn([f64; 3]) -> bool;

/// The unit cube with four cells an edge, and these fractures on planes of its grid.
fn mesh(patches: &[Contains<'_>]) -> Mesh {
    let patch = |&contains| Patch {
        name: "fracture",
        contains,
    };
    let patches: Vec<Patch<'_>> = patches.iter().map(patch).collect();
    let draft = tetrahedra([4; 3], [1.0; 3], &patches);
    let roles = vec![SurfaceRole::Fracture; draft.groups.len()];
    Mesh::build(draft, &roles).unwrap_or_else(|defects| panic!("{defects:?}"))
}

/// Total length of the edges with these numbers of facets, by fracture, inside or on the outside.
fn length(mesh: &Mesh, numbers: &[usize], on_outside: bool) -> f64 {
    let edges = FractureEdges::of(mesh, &FracturesAtNodes::of_mesh(mesh));
    let chosen = edges.meetings().filter(|meeting| {
        let of_fractures = meeting.chunk_by(|a, b| a.fracture == b.fracture);
        let found: Vec<usize> = of_fractures.map(<[_]>::len).collect();
        found == numbers && edges.is_outer(meeting[0].nodes) == on_outside
    });
    chosen
        .map(|meeting| mesh.edge_length(meeting[0].nodes))
        .sum()
}

const FLOOR: Contains<'_> = &|x| x[2] == 0.5;

#[test]
fn planes_cross_along_a_line_and_end_on_the_faces() {
    let mesh = mesh(&[FLOOR, &|x| x[0] == 0.5]);
    assert_eq!(length(&mesh, &[2, 2], false), 1.0);
    assert_eq!(length(&mesh, &[1, 2], false), 0.0);
    // The outlines of both, which lie on the faces of the cube.
    assert_eq!(length(&mesh, &[1], true), 8.0);
    assert_eq!(length(&mesh, &[1], false), 0.0);
}

#[test]
fn a_plane_that_ends_on_another_has_one_facet_there() {
    let mesh = mesh(&[FLOOR, &|x| x[0] == 0.5 && x[2] <= 0.5]);
    assert_eq!(length(&mesh, &[2, 1], false), 1.0);
    assert_eq!(length(&mesh, &[2, 2], false), 0.0);
}

#[test]
fn a_plane_that_ends_in_the_rock_has_a_tip() {
    let mesh = mesh(&[&|x| x[2] == 0.5 && x[0] <= 0.5]);
    assert_eq!(length(&mesh, &[1], false), 1.0);
    assert_eq!(length(&mesh, &[1], true), 2.0);
}
