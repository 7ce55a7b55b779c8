//! Bisection: what it keeps, that it fits together, how fine and how good its cells are.

use glam::DVec3;
use kluft_mesh::structured::{Patch, cells_of};
use kluft_mesh::{
    Draft, Group, Mesh, Shape, SurfaceRole, TaggedElements, cell_volume, facet_area_vector,
};
use rayon::ThreadPoolBuilder;

/// A crack in the middle of a box, one side of which is a boundary.
fn cracked(shape: Shape) -> Draft {
    let in_crack = |x: [f64; 3]| x[2] == 1.0 && x[0] <= 1.0;
    let patches = [
        Patch::new("crack", &in_crack),
        Patch::new("west", &|x: [f64; 3]| x[0] == 0.0),
    ];
    let mut draft = cells_of(shape, [4, 3, 4], [2.0, 1.5, 2.0], &patches);
    // Off the grid, so that edges differ in length.
    for x in &mut draft.nodes {
        let [a, b, c] = *x;
        *x = [a + 0.21 * b - 0.13 * c, b + 0.17 * c, 0.8 * c + 0.07 * a];
    }
    draft
}

fn built(draft: Draft) -> Mesh {
    let role = |name: &str| match name {
        "crack" => SurfaceRole::Fracture,
        "west" => SurfaceRole::Boundary,
        _ => SurfaceRole::Unused,
    };
    let roles: Vec<_> = draft.groups.iter().map(|g| role(&g.name)).collect();
    Mesh::build(draft, &roles).expect("a sound mesh")
}

fn corners(draft: &Draft, cell: usize) -> [DVec3; 4] {
    let nodes = draft.cells.elements.nodes_of(cell);
    std::array::from_fn(|local| DVec3::from(draft.nodes[nodes[local] as usize]))
}

fn volume([a, b, c, d]: [DVec3; 4]) -> f64 {
    (b - a).dot((c - a).cross(d - a)) / 6.0
}

fn size(draft: &Draft, cell: usize) -> f64 {
    (72.0_f64.sqrt() * volume(corners(draft, cell))).cbrt()
}

/// Mean ratio: 1 for a regular tetrahedron, 0 for a flat one.
fn quality(draft: &Draft, cell: usize) -> f64 {
    let own = corners(draft, cell);
    let pairs = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];
    let squares: f64 = pairs
        .iter()
        .map(|&(a, b)| own[a].distance_squared(own[b]))
        .sum();
    12.0 * (3.0 * volume(own)).powf(2.0 / 3.0) / squares
}

fn worst(draft: &Draft) -> f64 {
    let cells = 0..draft.cells.elements.len();
    cells.map(|cell| quality(draft, cell)).fold(1.0, f64::min)
}

/// Targets that are small at the front of the crack.
fn towards_front(draft: &Draft) -> Vec<f64> {
    let front = DVec3::new(0.9, 0.8, 0.85);
    let target = |cell| {
        let centre: DVec3 = corners(draft, cell).iter().sum::<DVec3>() / 4.0;
        0.05 + 0.4 * centre.distance(front)
    };
    (0..draft.cells.elements.len()).map(target).collect()
}

/// Volume of the rock, area of the crack.
fn measures(mesh: &Mesh) -> [f64; 2] {
    let volume = |cell| cell_volume(mesh.cells.shapes[cell], &mesh.corners(&mesh.cells, cell));
    let facets = &mesh.facets.elements;
    let area = |facet| facet_area_vector(&mesh.corners(facets, facet)).length();
    [
        (0..mesh.cells.len()).map(volume).sum(),
        (0..facets.len()).map(area).sum(),
    ]
}

#[test]
fn a_bisected_mesh_is_sound_and_as_large() {
    for shape in [Shape::Tet4, Shape::Tet10] {
        let mut draft = cracked(shape);
        let before = measures(&built(draft.clone()));
        let (count, targets) = (draft.cells.elements.len(), towards_front(&draft));
        draft.bisect(&targets).expect("tetrahedra");
        assert!(draft.cells.elements.len() > 3 * count, "{shape:?}");
        let after = measures(&built(draft));
        for (before, after) in before.iter().zip(after) {
            assert!((before - after).abs() < 1e-13, "{shape:?} {before} {after}");
        }
    }
}

#[test]
fn cells_become_as_small_as_asked_for_and_hardly_smaller() {
    let mut draft = cracked(Shape::Tet4);
    let count = draft.cells.elements.len();
    let before = worst(&draft);
    for target in [0.2, 0.1, 0.05] {
        let targets = vec![target; draft.cells.elements.len()];
        draft.bisect(&targets).expect("tetrahedra");
        let sizes: Vec<f64> = (0..draft.cells.elements.len())
            .map(|cell| size(&draft, cell))
            .collect();
        assert!(sizes.iter().all(|size| *size <= 1.13 * target));
        let mean = sizes.iter().sum::<f64>() / sizes.len() as f64;
        assert!(mean > 0.6 * target, "{mean} for {target}");
    }
    assert!(draft.cells.elements.len() > 100 * count);
    assert!(worst(&draft) > 0.3 * before, "{} {before}", worst(&draft));
}

#[test]
fn what_is_small_enough_stays_as_it_is() {
    let mut draft = cracked(Shape::Tet4);
    draft.arrange();
    let before = draft.clone();
    let targets = vec![f64::INFINITY; draft.cells.elements.len()];
    draft.bisect(&targets).expect("tetrahedra");
    assert_eq!(draft.nodes, before.nodes);
    assert_eq!(draft.cells.elements.nodes, before.cells.elements.nodes);
    let targets = towards_front(&draft);
    let coarse = targets
        .iter()
        .map(|target| target * 20.0)
        .collect::<Vec<_>>();
    draft.bisect(&coarse).expect("tetrahedra");
    assert_eq!(draft.cells.tags, before.cells.tags);
}

#[test]
fn tags_stay_unique_and_groups_stay() {
    let mut draft = cracked(Shape::Tet10);
    let groups = |draft: &Draft| draft.group_sizes(&draft.facets);
    let before = groups(&draft);
    draft.bisect(&towards_front(&draft)).expect("tetrahedra");
    for tags in [&draft.cells.tags, &draft.facets.tags, &draft.node_tags] {
        let mut sorted = tags.clone();
        sorted.sort_unstable();
        sorted.dedup();
        assert_eq!(sorted.len(), tags.len());
    }
    for (before, after) in before.into_iter().zip(groups(&draft)) {
        assert!(after >= before);
    }
}

/// The map of a parabolic cell is kept: middles of the parts of a curved edge lie on it.
#[test]
fn curved_edges_stay_curved() {
    let mut draft = cells_of(Shape::Tet10, [1, 1, 1], [1.0; 3], &[]);
    let bulge = |x: [f64; 3]| [x[0] + 0.2 * x[1] * x[1], x[1], x[2] - 0.1 * x[0] * x[1]];
    draft.nodes.iter_mut().for_each(|x| *x = bulge(*x));
    let targets = vec![0.3; draft.cells.elements.len()];
    draft.bisect(&targets).expect("tetrahedra");
    assert!(draft.cells.elements.len() > 20);
    for &[x, y, z] in &draft.nodes {
        // The inverse map: a node of a quadratic map of a cube.
        let a = x - 0.2 * y * y;
        let c = z + 0.1 * a * y;
        let place = |value: f64| (value * 64.0 - (value * 64.0).round()).abs();
        assert!(place(a) + place(y) + place(c) < 1e-9, "{x} {y} {z}");
    }
}

#[test]
fn threads_change_nothing() {
    let made = [1, 2].map(|threads| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| {
            let mut draft = cracked(Shape::Tet10);
            draft.bisect(&towards_front(&draft)).expect("tetrahedra");
            (
                draft.nodes,
                draft.cells.elements.nodes,
                draft.facets.elements.nodes,
            )
        })
    });
    assert_eq!(made[0], made[1]);
}

#[test]
fn other_cells_are_refused() {
    let mut draft = cells_of(Shape::Hex8, [1, 1, 1], [1.0; 3], &[]);
    let defects = draft.bisect(&[0.1]).expect_err("a hexahedron");
    assert!(
        defects[0].to_string().contains("tetrahedra"),
        "{}",
        defects[0]
    );
}

/// A plate of 2 m by 1 m of triangles of either order, with a crack along the middle of its left
/// half; rows and columns are counted in halves of cells, so that middles of edges are nodes.
fn plate(shape: Shape) -> Draft {
    const COLUMNS: u32 = 16;
    const ROWS: u32 = 8;
    let node = |column: u32, row: u32| row * (COLUMNS + 1) + column;
    let mut draft = Draft {
        groups: [(2, 1, "rock"), (1, 2, "crack"), (1, 3, "west")]
            .map(|(dimension, tag, name)| Group {
                dimension,
                tag,
                name: name.to_owned(),
            })
            .into(),
        group_sets: vec![vec![0], vec![1], vec![2]],
        cells: TaggedElements::new(),
        facets: TaggedElements::new(),
        lines: TaggedElements::new(),
        ..Draft::default()
    };
    for row in 0..=ROWS {
        for column in 0..=COLUMNS {
            let [x, y] = [column, row].map(|count| f64::from(count) / 8.0);
            // Sheared, so that edges differ in length.
            draft.nodes.push([x + 0.3 * y, y, 0.0]);
            draft.node_tags.push(u64::from(node(column, row)) + 1);
        }
    }
    let push = |elements: &mut TaggedElements, shape: Shape, corners: &[[u32; 2]], set: u32| {
        let mut nodes: Vec<u32> = corners.iter().map(|&[a, b]| node(a, b)).collect();
        if shape.is_quadratic() {
            for &[a, b] in shape.edges() {
                let [a, b] = [a, b].map(|end| corners[end as usize]);
                nodes.push(node((a[0] + b[0]) / 2, (a[1] + b[1]) / 2));
            }
        }
        elements.elements.push(shape, &nodes);
        elements.tags.push(elements.tags.len() as u64 + 1);
        elements.group_set.push(set);
    };
    let line = match shape {
        Shape::Tri3 => Shape::Line2,
        _ => Shape::Line3,
    };
    for row in (0..ROWS).step_by(2) {
        for x in (0..COLUMNS).step_by(2) {
            let [a, b] = [[x, row], [x + 2, row]];
            let [c, d] = [[x + 2, row + 2], [x, row + 2]];
            push(&mut draft.facets, shape, &[a, b, c], 0);
            push(&mut draft.facets, shape, &[a, c, d], 0);
        }
        push(&mut draft.lines, line, &[[0, row], [0, row + 2]], 2);
    }
    let middle = ROWS / 2;
    for x in (0..COLUMNS / 2).step_by(2) {
        push(&mut draft.lines, line, &[[x, middle], [x + 2, middle]], 1);
    }
    draft
}

/// Triangles of the plane: as large as before, none larger than asked for, lines cut with them.
#[test]
fn triangles_of_the_plane_are_bisected_with_their_lines() {
    for shape in [Shape::Tri3, Shape::Tri6] {
        let mut draft = plate(shape);
        let corner = |draft: &Draft, facet: usize, local: usize| {
            DVec3::from(draft.nodes[draft.facets.elements.nodes_of(facet)[local] as usize])
        };
        let front = DVec3::new(1.15, 0.5, 0.0);
        let target = |draft: &Draft, facet: usize| {
            let corners = [0, 1, 2].map(|local| corner(draft, facet, local));
            0.01 + 0.2
                * corners
                    .map(|at| at.distance(front))
                    .into_iter()
                    .fold(2.0, f64::min)
        };
        let count = draft.facets.elements.len();
        let targets: Vec<f64> = (0..count).map(|facet| target(&draft, facet)).collect();
        let before = measures(&built(draft.clone().extruded()));
        draft.bisect(&targets).expect("triangles");
        let after = draft.facets.elements.len();
        assert!(after > 5 * count, "{shape:?} {after}");
        // Small at the front, where a parent asked for a sixth of its size.
        let size = |facet: usize| {
            let [a, b, c] = [0, 1, 2].map(|local| corner(&draft, facet, local));
            let is_near = [a, b, c].iter().any(|at| at.distance(front) < 1e-9);
            let area = (b - a).cross(c - a).length() / 2.0;
            is_near.then(|| (4.0 / 3.0_f64.sqrt() * area).sqrt())
        };
        let near: Vec<f64> = (0..after).filter_map(size).collect();
        assert!(
            near.len() > 2 && near.iter().all(|size| *size < 1.2 * 0.01),
            "{near:?}"
        );
        assert!(draft.lines.elements.len() > 8, "{shape:?}");
        let mesh = built(draft.extruded());
        for (before, after) in before.iter().zip(measures(&mesh)) {
            assert!((before - after).abs() < 1e-12, "{shape:?} {before} {after}");
        }
        let crack = &mesh.facets.elements;
        assert!(crack.len() > 4, "{shape:?} {}", crack.len());
    }
    let mut squares = plate(Shape::Tri3);
    squares.facets = TaggedElements::new();
    squares.facets.elements.push(Shape::Quad4, &[0, 2, 36, 34]);
    squares.facets.tags.push(1);
    squares.facets.group_set.push(0);
    let defects = squares.bisect(&[0.1]).expect_err("a quadrangle");
    assert!(
        defects[0].to_string().contains("triangles"),
        "{}",
        defects[0]
    );
}
