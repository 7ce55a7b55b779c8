//! The survey of structured meshes, whose lengths, angles and counts are known.

use kluft_mesh::structured::{Cut, Patch, cells_of, mixed};
use kluft_mesh::{Draft, Mesh, Shape, SurfaceRole, Survey, cell_angles};

type Contains<'a> = &'a dyn Fn([f64; 3]) -> bool;

fn build(draft: Draft) -> (Mesh, Survey) {
    let roles = vec![SurfaceRole::Fracture; draft.groups.len()];
    let mesh = Mesh::build(draft, &roles).unwrap_or_else(|defects| panic!("{defects:?}"));
    let survey = Survey::of(&mesh);
    (mesh, survey)
}

/// A unit cube of 4 x 4 x 4 cubes of one shape, with these fractures.
fn survey_of(shape: Shape, fractures: &[Contains<'_>]) -> (Mesh, Survey) {
    let patches: Vec<Patch<'_>> = ["a", "b", "c"]
        .into_iter()
        .zip(fractures)
        .map(|(name, &contains)| Patch { name, contains })
        .collect();
    build(cells_of(shape, [4; 3], [1.0; 3], &patches))
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12
}

#[test]
fn a_half_plane_has_one_tip_and_three_sides_on_the_surface() {
    let half: Contains<'_> = &|x| x[2] == 0.5 && x[0] <= 0.5;
    for shape in Shape::CELLS {
        let (_, survey) = survey_of(shape, &[half]);
        let found = &survey.fractures[0];
        assert_eq!((found.tip_edges, found.trace_edges), (4, 8), "{shape:?}");
        assert!(
            near(found.tip_length, 1.0) && near(found.trace_length, 2.0),
            "{shape:?}"
        );
        assert!(near(found.area, 0.5), "{shape:?}");
        assert_eq!((found.components, found.closed), (1, false), "{shape:?}");
        assert_eq!(found.junction_nodes, [0; 6], "{shape:?}");
        assert!(survey.contacts.is_empty() && survey.unresolved_patches.is_empty());
        let tips: usize = survey
            .tip_edges_of_facet
            .iter()
            .map(|&tips| tips as usize)
            .sum();
        assert_eq!(tips, 4, "{shape:?}");
        assert_eq!(survey.blocks.len(), 1, "{shape:?}");
    }
}

#[test]
fn a_t_ends_and_an_x_crosses() {
    let through: Contains<'_> = &|x| x[2] == 0.5;
    let upright: Contains<'_> = &|x| x[0] == 0.5;
    let abutting: Contains<'_> = &|x| x[0] == 0.5 && x[2] <= 0.5;
    for shape in [Shape::Tet4, Shape::Hex8, Shape::Prism6, Shape::Tet10] {
        let (_, t) = survey_of(shape, &[through, abutting]);
        let contact = &t.contacts[0];
        assert!(near(contact.ending_length[1], 1.0), "{contact:?}");
        assert_eq!(
            (contact.ending_length[0], contact.crossing_length),
            (0.0, 0.0)
        );
        assert!(near(contact.smallest_angle.expect("an edge"), 90.0));
        assert_eq!(
            t.fractures[1].tip_edges, 0,
            "the end on the other is no tip"
        );
        let nodes = if shape == Shape::Tet10 { 9 } else { 5 };
        assert_eq!(t.fractures[0].junction_nodes, [nodes, 0, 0, 0, 0, 0]);
        let (_, x) = survey_of(shape, &[through, upright]);
        let contact = &x.contacts[0];
        assert!(near(contact.crossing_length, 1.0), "{contact:?}");
        assert_eq!((contact.nodes, contact.ending_length), (nodes, [0.0; 2]));
        assert_eq!(x.fractures[0].junction_nodes, [0, nodes, 0, 0, 0, 0]);
    }
}

#[test]
fn three_planes_cut_eight_equal_blocks() {
    let planes: [Contains<'_>; 3] = [&|x| x[0] == 0.5, &|x| x[1] == 0.5, &|x| x[2] == 0.5];
    let (_, survey) = survey_of(Shape::Tet4, &planes);
    assert_eq!(survey.contacts.len(), 3);
    assert_eq!(survey.blocks.len(), 8);
    for block in &survey.blocks {
        assert!(near(block.volume, 0.125));
        assert!(near((block.bounds.1 - block.bounds.0).max_element(), 0.5));
        assert_eq!(block.on_fracture, [true; 3]);
    }
    for found in &survey.fractures {
        assert_eq!(found.junction_nodes, [0, 8, 0, 0, 0, 1]);
        assert!(near(found.trace_length, 4.0) && found.tip_edges == 0);
    }
    let dips: Vec<[f64; 2]> = survey
        .fractures
        .iter()
        .map(|found| [found.orientation.dip, found.orientation.dip_direction])
        .collect();
    assert_eq!(dips, [[90.0, 90.0], [90.0, 0.0], [0.0, 0.0]]);
    assert!(
        survey
            .fractures
            .iter()
            .all(|f| f.orientation.deviation < 1e-9)
    );
}

/// A plane that falls towards +x (east) by 45 degrees.
#[test]
fn dip_and_dip_direction_are_a_geologists() {
    let falling: Contains<'_> = &|x| near(x[0] + x[2], 1.0);
    let draft = cells_of(Shape::Tet4, [4; 3], [1.0; 3], &[]);
    let mirrored = Draft {
        nodes: draft.nodes.iter().map(|&[x, y, z]| [x, z, y]).collect(),
        ..draft
    };
    // The Kuhn cut has faces on x = y; mirrored and turned, these fall towards +x.
    let turned = |[x, y, z]: [f64; 3]| [1.0 - x, 1.0 - z, y];
    let nodes: Vec<[f64; 3]> = mirrored.nodes.iter().map(|&x| turned(x)).collect();
    let draft = cells_of(
        Shape::Tet4,
        [4; 3],
        [1.0; 3],
        &[Patch {
            name: "falling",
            contains: &|x| falling(turned([x[0], x[2], x[1]])),
        }],
    );
    let (_, survey) = build(Draft { nodes, ..draft });
    let found = survey.fractures[0].orientation;
    assert!((found.dip - 45.0).abs() < 1e-9, "{found:?}");
    assert!((found.dip_direction - 90.0).abs() < 1e-9, "{found:?}");
}

#[test]
fn a_single_facet_inside_is_unresolved() {
    let corners = [[0.5, 0.5, 0.5], [0.75, 0.5, 0.5], [0.75, 0.75, 0.5]];
    let one: Contains<'_> = &|x| corners.contains(&x);
    let big: Contains<'_> = &|x| x[2] == 0.25;
    let (_, survey) = survey_of(Shape::Tet4, &[one, big]);
    let [patch] = &survey.unresolved_patches[..] else {
        panic!("{:?}", survey.unresolved_patches);
    };
    assert_eq!((patch.fracture, patch.facets, patch.whole), (0, 1, true));
    assert!(near(patch.area, 1.0 / 32.0));
    assert!(near(patch.centre.x, 2.0 / 3.0) && near(patch.centre.z, 0.5));
    assert_eq!(survey.patch_of_facet.iter().flatten().count(), 1);
    assert_eq!(survey.fractures[0].tip_edges, 3);
}

#[test]
fn a_facet_in_a_corner_of_a_fracture_is_unresolved_but_not_the_whole() {
    let square: Contains<'_> =
        &|x| x[2] == 0.5 && (0.25..=0.75).contains(&x[0]) && (0.25..=0.75).contains(&x[1]);
    let (_, survey) = survey_of(Shape::Tet4, &[square]);
    let facets: usize = survey
        .unresolved_patches
        .iter()
        .map(|patch| patch.facets)
        .sum();
    assert_eq!(facets, 2, "the Kuhn cut leaves two triangles in corners");
    assert!(survey.unresolved_patches.iter().all(|patch| !patch.whole));
    let (_, hexahedra) = survey_of(Shape::Hex8, &[square]);
    assert!(hexahedra.unresolved_patches.is_empty());
}

#[test]
fn the_surface_of_a_cube_is_closed_and_cuts_a_block_free() {
    let inside = |c: f64| (0.25..=0.75).contains(&c);
    let cube: Contains<'_> =
        &|x| x.into_iter().all(inside) && x.into_iter().any(|c| c == 0.25 || c == 0.75);
    for shape in [Shape::Hex8, Shape::Hex27, Shape::Pyramid5] {
        // Faces inside the cube have all corners on its surface only if the cube is one cell wide.
        let (mesh, survey) = survey_of(shape, &[cube]);
        let found = &survey.fractures[0];
        assert!(found.closed, "{shape:?}");
        assert!(near(found.area, 6.0 * 0.25), "{shape:?}");
        assert_eq!(
            (found.tip_edges, found.trace_edges, found.components),
            (0, 0, 1)
        );
        assert_eq!(survey.blocks.len(), 2, "{shape:?}");
        assert!(near(survey.blocks[1].volume, 0.125), "{shape:?}");
        assert!(near(found.branching_length, 0.0) && mesh.boundaries.is_empty());
    }
}

#[test]
fn fractures_that_share_one_node_touch() {
    let low: Contains<'_> = &|x| x[2] == 0.5 && x[0] <= 0.5 && x[1] <= 0.5;
    let high: Contains<'_> = &|x| x[0] == 0.5 && x[1] >= 0.5 && x[2] >= 0.5;
    let (_, survey) = survey_of(Shape::Hex8, &[low, high]);
    let contact = &survey.contacts[0];
    assert_eq!((contact.nodes, contact.smallest_angle), (1, None));
    assert_eq!(contact.at.to_array(), [0.5; 3]);
}

#[test]
fn angles_of_regular_cells_are_known() {
    for (shape, smallest, largest) in [
        (Shape::Hex8, 90.0, 90.0),
        (Shape::Hex20, 90.0, 90.0),
        (Shape::Prism6, 45.0, 90.0),
        (Shape::Tet4, 45.0, 90.0),
        (Shape::Pyramid5, 45.0, 120.0),
    ] {
        let (mesh, survey) = survey_of(shape, &[]);
        let angles = cell_angles(&mesh, 0);
        assert!(
            (angles.smallest - smallest).abs() < 1e-6,
            "{shape:?}: {angles:?}"
        );
        assert!(
            (angles.largest - largest).abs() < 1e-6,
            "{shape:?}: {angles:?}"
        );
        let volume: f64 = survey.quality.volumes.iter().sum();
        assert!(near(volume, 1.0), "{shape:?}");
        assert_eq!(
            survey.quality.histogram.iter().sum::<usize>(),
            mesh.cells.len()
        );
    }
}

#[test]
fn the_worst_cells_are_found_and_belong_to_their_fractures() {
    let plane: Contains<'_> = &|x| x[2] == 0.5;
    let patch = [Patch {
        name: "a",
        contains: plane,
    }];
    let mut draft = mixed([4; 3], [1.0; 3], &patch, |_| Cut::Hexahedron);
    let moved = draft.nodes.iter().position(|&x| x == [0.5, 0.5, 0.25]);
    draft.nodes[moved.expect("a grid position")][2] = 0.45;
    let (mesh, survey) = build(draft);
    let quality = &survey.quality;
    let sorted = |cells: &[u32]| {
        cells
            .windows(2)
            .all(|pair| quality.of_cell[pair[0] as usize] <= quality.of_cell[pair[1] as usize])
    };
    assert!(sorted(&quality.worst) && quality.worst.len() == 10);
    assert_eq!(
        quality.worst_of_fracture,
        [Some(quality.worst_at_fractures[0])]
    );
    let lowest = quality
        .of_cell
        .iter()
        .copied()
        .fold(f64::INFINITY, f64::min);
    assert_eq!(quality.of_cell[quality.worst[0] as usize], lowest);
    let nodes = mesh.cells.nodes_of(quality.worst_at_fractures[0] as usize);
    assert!(nodes.iter().any(|&node| survey.at_nodes.any(node)));
}
