//! Sectors, blocks and orientation on structured meshes, and what the door refuses.

use kluft_mesh::structured::{Patch, tetrahedra};
use kluft_mesh::{Draft, Mesh, SurfaceRole};

type Contains<'a> = &'a dyn Fn([f64; 3]) -> bool;

fn draft(patches: &[(&str, Contains<'_>)]) -> Draft {
    let patches: Vec<Patch<'_>> = patches
        .iter()
        .map(|&(name, contains)| Patch { name, contains })
        .collect();
    tetrahedra([4; 3], [1.0; 3], &patches)
}

fn mesh(patches: &[(&str, Contains<'_>)]) -> Mesh {
    let draft = draft(patches);
    let roles = vec![SurfaceRole::Fracture; draft.groups.len()];
    Mesh::build(draft, &roles).unwrap_or_else(|defects| panic!("{defects:?}"))
}

/// Number of sectors at a grid position.
fn sectors(mesh: &Mesh, at: [f64; 3]) -> u32 {
    let node = mesh.nodes.iter().position(|x| x.to_array() == at);
    mesh.sectors.count[node.expect("a grid position")]
}

/// How many nodes have 1, 2, ... sectors.
fn histogram(mesh: &Mesh) -> Vec<usize> {
    let most = *mesh.sectors.count.iter().max().expect("nodes") as usize;
    (1..=most)
        .map(|n| {
            mesh.sectors
                .count
                .iter()
                .filter(|&&count| count as usize == n)
                .count()
        })
        .collect()
}

#[test]
fn a_tip_has_one_sector_and_the_inside_two() {
    let half: Contains<'_> = &|x| x[2] == 0.5 && x[0] <= 0.5;
    let mesh = mesh(&[("half", half)]);
    for y in [0.0, 0.25, 0.5, 0.75, 1.0] {
        assert_eq!(sectors(&mesh, [0.5, y, 0.5]), 1, "the tip");
        assert_eq!(sectors(&mesh, [0.25, y, 0.5]), 2, "the inside");
        assert_eq!(sectors(&mesh, [0.0, y, 0.5]), 2, "the mouth at the surface");
    }
    assert_eq!(histogram(&mesh), [125 - 10, 10]);
    assert_eq!(mesh.block_count, 1);
}

#[test]
fn a_t_has_three_sectors() {
    let through: Contains<'_> = &|x| x[2] == 0.5;
    let abutting: Contains<'_> = &|x| x[0] == 0.5 && x[2] <= 0.5;
    let mesh = mesh(&[("through", through), ("abutting", abutting)]);
    assert_eq!(sectors(&mesh, [0.5, 0.25, 0.5]), 3);
    assert_eq!(histogram(&mesh), [125 - 35, 30, 5]);
    assert_eq!(mesh.block_count, 3);
}

#[test]
fn an_x_has_four_sectors() {
    let a: Contains<'_> = &|x| x[2] == 0.5;
    let b: Contains<'_> = &|x| x[0] == 0.5;
    let mesh = mesh(&[("a", a), ("b", b)]);
    assert_eq!(sectors(&mesh, [0.5, 0.25, 0.5]), 4);
    assert_eq!(histogram(&mesh), [125 - 45, 40, 0, 5]);
    assert_eq!(mesh.block_count, 4);
}

#[test]
fn three_planes_have_eight_sectors_at_their_point() {
    let planes: [Contains<'_>; 3] = [&|x| x[0] == 0.5, &|x| x[1] == 0.5, &|x| x[2] == 0.5];
    let mesh = mesh(&[("x", planes[0]), ("y", planes[1]), ("z", planes[2])]);
    assert_eq!(sectors(&mesh, [0.5; 3]), 8);
    assert_eq!(histogram(&mesh), [64, 48, 0, 12, 0, 0, 0, 1]);
    assert_eq!(mesh.block_count, 8);
}

/// The tip of one fracture lies on another: the other's two sides are all there is.
#[test]
fn a_tip_that_touches_a_fracture_adds_no_sector() {
    let through: Contains<'_> = &|x| x[2] == 0.5;
    let crossing: Contains<'_> = &|x| x[0] == 0.5 && x[1] <= 0.5;
    let x = mesh(&[("through", through), ("crossing", crossing)]);
    assert_eq!(sectors(&x, [0.5, 0.5, 0.5]), 2, "end of an X");
    assert_eq!(sectors(&x, [0.5, 0.25, 0.5]), 4, "on the X");
    assert_eq!(sectors(&x, [0.5, 0.5, 0.25]), 1, "on the tip");
    let abutting: Contains<'_> = &|x| x[0] == 0.5 && x[1] <= 0.5 && x[2] <= 0.5;
    let t = mesh(&[("through", through), ("abutting", abutting)]);
    assert_eq!(sectors(&t, [0.5, 0.5, 0.5]), 2, "end of a T");
    assert_eq!(sectors(&t, [0.5, 0.25, 0.5]), 3, "on the T");
    assert_eq!(sectors(&t, [0.5, 0.5, 0.25]), 1, "on the tip");
}

#[test]
fn facets_of_a_fracture_agree_and_lie_between_their_cells() {
    let a: Contains<'_> = &|x| x[2] == 0.5;
    let b: Contains<'_> = &|x| x[0] == 0.5;
    let mesh = mesh(&[("a", a), ("b", b)]);
    let areas = mesh.facet_areas();
    for (facet, area) in areas.iter().enumerate() {
        let fracture = mesh.facets.fracture[facet] as usize;
        let expected = [glam::DVec3::Z, glam::DVec3::X][fracture];
        assert!(area.normalize().dot(expected) > 1.0 - 1e-15);
        let centre = kluft_mesh::facet_centre(&mesh.corners(&mesh.facets.elements, facet));
        let side = |cell: u32| {
            let corners = mesh.corners(&mesh.cells, cell as usize);
            (kluft_mesh::facet_centre(&corners) - centre).dot(*area)
        };
        assert!(side(mesh.facets.plus[facet]) > 0.0);
        assert!(side(mesh.facets.minus[facet]) < 0.0);
    }
}

#[test]
fn boundaries_face_outwards() {
    let top: Contains<'_> = &|x| x[2] == 1.0;
    let draft = draft(&[("top", top)]);
    let roles = vec![SurfaceRole::Boundary; draft.groups.len()];
    let mesh = Mesh::build(draft, &roles).expect("a good mesh");
    let top = &mesh.boundaries[0];
    assert_eq!(top.elements.len(), 32);
    for facet in 0..top.elements.len() {
        let area = kluft_mesh::facet_area_vector(&mesh.corners(&top.elements, facet));
        assert!(area.z > 0.0);
    }
}

#[test]
fn a_draft_without_cells_is_refused() {
    let defects = Mesh::build(Draft::default(), &[]).expect_err("no cells");
    assert!(defects[0].problem.contains("no cells"), "{defects:?}");
}

/// Joined by several tasks; a plane leaves two sectors at each of its nodes, and two blocks.
#[test]
fn sectors_and_blocks_of_a_large_mesh() {
    let level = |x: [f64; 3]| x[2] == 0.5;
    let plane = Patch {
        name: "level",
        contains: &level,
    };
    let mut draft = tetrahedra([24; 3], [1.0; 3], &[plane]);
    for arranged in [false, true] {
        if arranged {
            draft.arrange();
        }
        let mesh = Mesh::build(draft.clone(), &[SurfaceRole::Fracture; 2]).expect("a mesh");
        assert!(mesh.cells.len() > 65_536);
        assert_eq!(histogram(&mesh), [24 * 25 * 25, 25 * 25]);
        assert_eq!(mesh.block_count, 2);
        let upper = mesh
            .facets
            .plus
            .iter()
            .map(|&cell| mesh.block[cell as usize]);
        let lower = mesh
            .facets
            .minus
            .iter()
            .map(|&cell| mesh.block[cell as usize]);
        assert!(upper.zip(lower).all(|(upper, lower)| upper == 1 - lower));
    }
}
