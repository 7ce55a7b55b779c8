//! Refinement: what it keeps, that it fits together, and how good its cells are.

use std::collections::BTreeSet;

use kluft_mesh::structured::{Cut, Patch, cells_of, mixed, tetrahedra};
use kluft_mesh::{Draft, Mesh, Shape, SurfaceRole, cell_volume, facet_area_vector};

type Test = fn([f64; 3]) -> bool;

/// The sides of the box `[0, 2] x [0, 1] x [0, 2]`, and a crack in its middle.
const SURFACES: [(&str, Test); 7] = [
    ("crack", |x| x[2] == 1.0 && x[0] <= 1.0),
    ("west", |x| x[0] == 0.0),
    ("east", |x| x[0] == 2.0),
    ("south", |x| x[1] == 0.0),
    ("north", |x| x[1] == 1.0),
    ("bottom", |x| x[2] == 0.0),
    ("top", |x| x[2] == 2.0),
];
const SIZE: [f64; 3] = [2.0, 1.0, 2.0];

fn patches() -> Vec<Patch<'static>> {
    let patches = SURFACES.iter();
    patches.map(|(name, test)| Patch::new(name, test)).collect()
}

fn boxed(shape: Shape) -> Draft {
    cells_of(shape, [2, 1, 2], SIZE, &patches())
}

fn built(draft: Draft) -> Mesh {
    let role = |name: &str, dimension| match (name, dimension) {
        ("crack", _) => SurfaceRole::Fracture,
        (_, 2) => SurfaceRole::Boundary,
        _ => SurfaceRole::Unused,
    };
    let groups = draft.groups.iter();
    let roles: Vec<_> = groups.map(|g| role(&g.name, g.dimension)).collect();
    Mesh::build(draft, &roles).expect("a sound mesh")
}

fn refined(mut draft: Draft, times: u32) -> Draft {
    draft.refine(times).expect("small");
    draft
}

/// Moves every node.
fn moved(mut draft: Draft, to: impl Fn([f64; 3]) -> [f64; 3]) -> Draft {
    draft.nodes.iter_mut().for_each(|x| *x = to(*x));
    draft
}

fn shear([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x + 0.3 * y - 0.1 * z, y + 0.2 * z, 0.7 * z + 0.05 * x]
}

/// Volumes of the cells, areas of crack and boundaries.
fn sizes(mesh: &Mesh) -> Vec<f64> {
    let volume = |cell| cell_volume(mesh.cells.shapes[cell], &mesh.corners(&mesh.cells, cell));
    let volumes: f64 = (0..mesh.cells.len()).map(volume).sum();
    let surfaces = mesh.boundaries.iter().map(|boundary| &boundary.elements);
    let all = surfaces.chain([&mesh.facets.elements]);
    let areas = all.map(|elements| {
        let area = |facet| facet_area_vector(&mesh.corners(elements, facet)).length();
        (0..elements.len()).map(area).sum()
    });
    [volumes].into_iter().chain(areas).collect()
}

fn facet_counts(mesh: &Mesh) -> Vec<usize> {
    let boundaries = mesh.boundaries.iter();
    let counts = boundaries.map(|boundary| boundary.elements.len());
    counts.chain([mesh.facets.elements.len()]).collect()
}

/// Nodes of the crack by their numbers of sectors: 1 at its front, 2 between its walls.
fn crack_nodes(mesh: &Mesh) -> [usize; 3] {
    let nodes: BTreeSet<u32> = mesh.facets.elements.nodes.iter().copied().collect();
    let mut counts = [0; 3];
    for node in nodes {
        counts[mesh.sectors.count[node as usize] as usize] += 1;
    }
    counts
}

#[test]
fn every_shape_keeps_volume_areas_and_crack() {
    for shape in Shape::CELLS {
        let draft = moved(boxed(shape), shear);
        let coarse = built(draft.clone());
        for times in [1, 2] {
            let cells = draft.refined_cells(times);
            let fine = built(refined(draft.clone(), times));
            assert_eq!(fine.cells.len() as u64, cells, "{shape:?}");
            if shape.corner_count() != 5 {
                assert_eq!(cells, 8_u64.pow(times) * coarse.cells.len() as u64);
                assert!(fine.cells.shapes.iter().all(|own| *own == shape));
            }
            for (before, after) in sizes(&coarse).into_iter().zip(sizes(&fine)) {
                assert!(
                    (before - after).abs() < 1e-14 * 8.0,
                    "{shape:?} {before} {after}"
                );
            }
            let quadrupled = facet_counts(&coarse).into_iter();
            let quadrupled: Vec<usize> =
                quadrupled.map(|count| count * 4_usize.pow(times)).collect();
            assert_eq!(facet_counts(&fine), quadrupled, "{shape:?}");
            // The front is as long in edges as the box is wide, and has a node more than edges.
            let per_edge = if shape.is_quadratic() { 2 } else { 1 };
            let [_, front, walls] = crack_nodes(&fine);
            assert_eq!(front, per_edge * 2_usize.pow(times) + 1, "{shape:?}");
            assert!(walls > crack_nodes(&coarse)[2], "{shape:?}");
        }
    }
}

#[test]
fn pyramids_become_six_and_four_tetrahedra() {
    for (shape, inner) in [
        (Shape::Pyramid5, Shape::Tet4),
        (Shape::Pyramid13, Shape::Tet10),
        (Shape::Pyramid14, Shape::Tet10),
    ] {
        let draft = boxed(shape);
        let parents = draft.cells.elements.len();
        let fine = refined(draft, 1);
        let count = |wanted| {
            let shapes = fine.cells.elements.shapes.iter();
            shapes.filter(|shape| **shape == wanted).count()
        };
        assert_eq!([count(shape), count(inner)], [6 * parents, 4 * parents]);
    }
}

#[test]
fn shapes_of_all_kinds_fit_together() {
    let along_x = |cube: [usize; 3]| match cube[0] {
        0 => Cut::Hexahedron,
        1 => Cut::Pyramids,
        _ => Cut::Prisms,
    };
    let upwards = |cube: [usize; 3]| match cube[2] {
        0 => Cut::Prisms,
        _ => Cut::Tetrahedra,
    };
    let drafts = [
        mixed([3, 1, 2], SIZE, &patches(), along_x),
        mixed([2, 1, 2], SIZE, &patches(), upwards),
    ];
    for draft in drafts {
        let coarse = built(moved(draft.clone(), shear));
        let fine = built(refined(moved(draft, shear), 2));
        for (before, after) in sizes(&coarse).into_iter().zip(sizes(&fine)) {
            assert!((before - after).abs() < 1e-13, "{before} {after}");
        }
        let sixteen = facet_counts(&coarse).into_iter().map(|count| 16 * count);
        assert_eq!(facet_counts(&fine), sixteen.collect::<Vec<_>>());
    }
}

/// Elements of second order hold every field of second order, so that bending a refined mesh and
/// refining a bent one are the same.
#[test]
fn new_nodes_lie_on_the_curves_of_their_parents() {
    let bend = |[x, y, z]: [f64; 3]| {
        [
            x + 0.05 * y * y - 0.03 * x * z,
            y + 0.04 * x * x + 0.02 * y * z,
            z + 0.03 * x * y - 0.02 * z * z,
        ]
    };
    let quadratic = Shape::CELLS
        .into_iter()
        .filter(|shape| shape.is_quadratic());
    for shape in quadratic {
        let draft = boxed(shape);
        // Sheared, so that no diagonal is as long as another and bending changes none.
        let sheared = moved(draft, shear);
        let small = |x: [f64; 3]| {
            let bent = bend(x);
            [0, 1, 2].map(|axis| x[axis] + 0.1 * (bent[axis] - x[axis]))
        };
        let one = moved(refined(sheared.clone(), 1), small);
        let other = refined(moved(sheared, small), 1);
        let by_tag = |draft: &Draft| {
            let tagged = draft.node_tags.iter().copied().zip(draft.nodes.clone());
            let mut all: Vec<(u64, [f64; 3])> = tagged.collect();
            all.sort_by_key(|(tag, _)| *tag);
            all
        };
        let (one, other) = (by_tag(&one), by_tag(&other));
        assert_eq!(one.len(), other.len());
        for ((_, a), (_, b)) in one.iter().zip(&other) {
            for axis in 0..3 {
                assert!((a[axis] - b[axis]).abs() < 1e-14, "{shape:?} {a:?} {b:?}");
            }
        }
    }
}

#[test]
fn tags_tell_parents_and_stay_apart() {
    let draft = boxed(Shape::Pyramid5);
    let fine = refined(draft.clone(), 2);
    let tags: BTreeSet<u64> = fine.cells.tags.iter().copied().collect();
    assert_eq!(tags.len(), fine.cells.elements.len());
    let parents: BTreeSet<u64> = tags.iter().map(|tag| tag / 100).collect();
    assert_eq!(parents, draft.cells.tags.iter().copied().collect());
    let nodes: BTreeSet<u64> = fine.node_tags.iter().copied().collect();
    assert_eq!(nodes.len(), fine.nodes.len());
    let place = |draft: &Draft, tag: u64| {
        let index = draft.node_tags.iter().position(|own| *own == tag);
        draft.nodes[index.expect("it is there")]
    };
    for &tag in &draft.node_tags {
        assert_eq!(place(&draft, tag), place(&fine, tag));
    }
    let of_facets = |draft: &Draft, facet: usize| {
        let set = draft.facets.group_set[facet] as usize;
        (draft.facets.tags[facet], draft.group_sets[set].clone())
    };
    for facet in 0..fine.facets.elements.len() {
        let (tag, groups) = of_facets(&fine, facet);
        assert_eq!((tag / 100, groups), of_facets(&draft, facet / 16));
    }
}

#[test]
fn the_number_of_threads_does_not_matter() {
    // Cells enough for several tasks, and diagonals as long as others.
    let draft = tetrahedra([13, 12, 11], SIZE, &patches());
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a pool").install(|| refined(draft.clone(), 1))
    };
    let (one, two) = (on(1), on(2));
    assert_eq!(one.nodes, two.nodes);
    assert_eq!(one.node_tags, two.node_tags);
    for (one, two) in [(&one.cells, &two.cells), (&one.facets, &two.facets)] {
        assert_eq!(one.elements.nodes, two.elements.nodes);
        assert_eq!(one.elements.offsets, two.elements.offsets);
        assert_eq!(one.tags, two.tags);
        assert_eq!(one.group_set, two.group_set);
    }
}

#[test]
fn diagonals_do_not_depend_on_the_order_of_nodes_and_cells() {
    let draft = tetrahedra([3, 2, 2], SIZE, &[]);
    let mut turned = draft.clone();
    turned.arrange();
    let children = |draft: Draft| {
        let fine = refined(draft, 2);
        let cells = &fine.cells.elements;
        let places = |cell: usize| {
            let own = cells.nodes_of(cell).iter();
            let mut own: Vec<[u64; 3]> = own
                .map(|&node| fine.nodes[node as usize].map(f64::to_bits))
                .collect();
            own.sort_unstable();
            own
        };
        let all: BTreeSet<_> = (0..cells.len()).map(places).collect();
        all
    };
    let again = children(draft.clone());
    assert_eq!(again.len(), 64 * draft.cells.elements.len());
    assert_eq!(children(turned), again);
}

/// `12 (3 V)^(2/3)` over the sum of the squared edges: 1 for the regular tetrahedron, 0 for a flat
/// one (A. Liu and B. Joe, BIT 34, 1994).
fn mean_ratios(draft: &Draft) -> Vec<f64> {
    let cells = &draft.cells.elements;
    let ratio = |cell: usize| {
        let nodes = cells.nodes_of(cell).iter();
        let corners: Vec<glam::DVec3> = nodes
            .map(|&node| draft.nodes[node as usize].into())
            .collect();
        let volume = cell_volume(Shape::Tet4, &corners);
        let edges = Shape::Tet4.edges().iter();
        let squares: f64 = edges
            .map(|&[a, b]| corners[a as usize].distance_squared(corners[b as usize]))
            .sum();
        12.0 * (3.0 * volume).powf(2.0 / 3.0) / squares
    };
    (0..cells.len()).map(ratio).collect()
}

/// A child has at least three quarters of the mean ratio of its parent, and what follows loses no
/// more. Of tetrahedra that are not squeezed no new shapes occur soon.
#[test]
fn tetrahedra_stay_as_good_as_they_were() {
    let squeezes = [[1.0, 1.0, 1.0], [1.0, 0.3, 1.0], [1.0, 0.2, 0.05]];
    for squeeze in squeezes {
        let uneven = |[x, y, z]: [f64; 3]| {
            let wave = 0.2 * (7.0 * x + 3.0 * y + 5.0 * z).sin();
            [
                squeeze[0] * (x + wave),
                squeeze[1] * (y - 0.5 * wave),
                squeeze[2] * (z + 0.6 * wave),
            ]
        };
        let coarse = moved(tetrahedra([2, 1, 2], SIZE, &[]), uneven);
        let of_parents = mean_ratios(&coarse);
        assert!(of_parents.iter().all(|ratio| *ratio > 0.0));
        let parent = |tag: u64| of_parents[tag as usize - 1];
        let mut shapes = Vec::new();
        for times in 1..=5 {
            let fine = refined(coarse.clone(), times);
            let ratios = mean_ratios(&fine);
            let first = fine.cells.tags.iter().map(|tag| tag / 10_u64.pow(times));
            for (tag, ratio) in first.zip(&ratios) {
                assert!(*ratio > 0.75 * parent(tag), "{squeeze:?} {times} {ratio}");
            }
            let rounded = ratios.iter().map(|ratio| (1e9 * ratio).round() as u64);
            let of_first: BTreeSet<u64> = rounded
                .zip(&fine.cells.tags)
                .filter(|(_, tag)| **tag / 10_u64.pow(times) == 1)
                .map(|(ratio, _)| ratio)
                .collect();
            shapes.push(of_first);
        }
        let is_squeezed = squeeze != [1.0; 3];
        assert!(
            is_squeezed || shapes[3] == shapes[4],
            "new shapes: {shapes:?}"
        );
    }
}

#[test]
fn what_cannot_be_numbered_is_refused() {
    let mut draft = boxed(Shape::Tet4);
    let defects = draft.clone().refine(11).expect_err("8^11 times 24 cells");
    let said = defects[0].to_string();
    assert!(said.contains("206158430208 cells"), "{said}");
    draft.cells.tags[3] = u64::MAX / 50;
    let defects = draft.refine(2).expect_err("two digits more");
    assert!(
        defects[0].to_string().contains("RenumberMesh"),
        "{}",
        defects[0]
    );
}

#[test]
fn faceted_surfaces_are_told_from_planes_and_edges() {
    let surfaces: [(&str, Test); 2] = [("all", |_| true), ("top", |x| x[2] == 2.0)];
    let patches: Vec<Patch<'_>> = surfaces
        .iter()
        .map(|(name, test)| Patch::new(name, test))
        .collect();
    let draft = tetrahedra([6, 3, 6], SIZE, &patches[1..]);
    assert!(draft.faceted_surfaces().is_empty());
    let bowl = |[x, y, z]: [f64; 3]| [x, y, z + 0.1 * x * x];
    let named = |draft: &Draft| -> Vec<String> {
        let found = draft.faceted_surfaces().into_iter();
        found
            .map(|group| draft.groups[group].name.clone())
            .collect()
    };
    assert_eq!(named(&moved(draft.clone(), bowl)), ["top"]);
    // A roof of two planes.
    let roof = |[x, y, z]: [f64; 3]| [x, y, z + 0.3 * (x - 1.0).abs()];
    assert!(named(&moved(draft, roof)).is_empty());
    let second = cells_of(Shape::Tet10, [4, 2, 4], SIZE, &patches[1..]);
    assert!(named(&moved(second, bowl)).is_empty(), "its facets follow");
}
