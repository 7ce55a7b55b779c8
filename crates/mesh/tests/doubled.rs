//! Rock that touches without sharing nodes: found, refused, welded, taken as a fracture.

use glam::{DMat3, DVec3};
use kluft_mesh::structured::{Cut, Patch, cells_of, mixed, tetrahedra};
use kluft_mesh::{
    CommonSurface, DOUBLED_NODES, Defect, DoubledSurface, Draft, Elements, FACES_NOT_MATCHING,
    FRACTURE_ON_DOUBLED_NODES, Faces, Group, Joined, Joining, Mesh, Shape, SurfaceRole, Touch,
};

type Place = [f64; 3];

const MIDDLE: &dyn Fn(Place) -> bool = &|x| x[2] == 0.5;
const HALF: &dyn Fn(Place) -> bool = &|x| x[2] == 0.5 && x[0] <= 0.5;

/// Gives the cells above z = 0.5 to a volume of their own.
fn with_upper(mut draft: Draft) -> Draft {
    draft.groups.push(Group {
        dimension: 3,
        tag: 2,
        name: "upper".into(),
    });
    draft.group_sets.push(vec![draft.groups.len() - 1]);
    let set = draft.group_sets.len() as u32 - 1;
    for cell in 0..draft.cells.elements.len() {
        if is_above(&draft, cell) {
            draft.cells.group_set[cell] = set;
        }
    }
    draft
}

fn is_above(draft: &Draft, cell: usize) -> bool {
    let nodes = draft.cells.elements.nodes_of(cell).iter();
    let height: f64 = nodes.map(|&node| draft.nodes[node as usize][2]).sum();
    height > 0.5 * draft.cells.elements.nodes_of(cell).len() as f64
}

/// Doubles the nodes of a surface in z = 0.5: the cells above it get copies, which are numbered
/// behind all others.
fn split(mut draft: Draft, on: impl Fn(Place) -> bool) -> Draft {
    let mut copy = vec![None; draft.nodes.len()];
    for (cell, range) in (0..draft.cells.elements.len())
        .map(|cell| (cell, draft.cells.elements.range(cell)))
        .collect::<Vec<_>>()
    {
        if !is_above(&draft, cell) {
            continue;
        }
        for slot in range {
            let node = draft.cells.elements.nodes[slot] as usize;
            if !on(draft.nodes[node]) {
                continue;
            }
            let next = draft.nodes.len() as u32;
            let copied = *copy[node].get_or_insert(next);
            if copied == next {
                draft.nodes.push(draft.nodes[node]);
                draft.node_tags.push(u64::from(next) + 1);
            }
            draft.cells.elements.nodes[slot] = copied;
        }
    }
    draft
}

/// Two boxes, one on the other, of so many cubes along each axis.
fn stacked(below: usize, above: usize) -> Draft {
    let size = [1.0, 1.0, 0.5];
    let mut draft = tetrahedra([below; 3], size, &[]);
    let top = tetrahedra([above; 3], size, &[]);
    let first = draft.nodes.len() as u32;
    draft
        .nodes
        .extend(top.nodes.iter().map(|&[x, y, z]| [x, y, z + 0.5]));
    draft.node_tags = (1..=draft.nodes.len() as u64).collect();
    for cell in 0..top.cells.elements.len() {
        let nodes = top.cells.elements.nodes_of(cell).iter();
        let nodes: Vec<u32> = nodes.map(|node| node + first).collect();
        draft.cells.elements.push(Shape::Tet4, &nodes);
        draft.cells.tags.push(draft.cells.tags.len() as u64 + 1);
        draft.cells.group_set.push(0);
    }
    with_upper(draft)
}

fn built(draft: Draft) -> Result<Mesh, Vec<Defect>> {
    let roles = vec![SurfaceRole::Fracture; draft.groups.len()];
    Mesh::build(draft, &roles)
}

fn refused(draft: Draft) -> Vec<Defect> {
    built(draft).expect_err("a defect")
}

fn surfaces(draft: &Draft) -> Vec<DoubledSurface> {
    Faces::of(draft).doubled_surfaces(draft)
}

fn joined(draft: &mut Draft, joining: &Joining) -> Joined {
    let joined = draft.join(Faces::of(draft), joining);
    joined.unwrap_or_else(|defects| panic!("{defects:?}"))
}

const WELD: Joining = Joining {
    weld: true,
    surfaces: Vec::new(),
};

fn between(volumes: [usize; 2]) -> Joining {
    let surface = CommonSurface {
        name: "between".into(),
        volumes,
    };
    Joining {
        weld: false,
        surfaces: vec![surface],
    }
}

#[test]
fn volumes_that_share_no_nodes_are_refused_with_place_and_area() {
    let draft = split(with_upper(tetrahedra([4; 3], [1.0; 3], &[])), MIDDLE);
    let [surface] = &surfaces(&draft)[..] else {
        panic!("one surface");
    };
    assert_eq!(surface.volumes, ["rock", "upper"]);
    assert_eq!(surface.touch, Touch::Matching);
    // 4 x 4 squares of two triangles, seen from both sides.
    assert_eq!(surface.faces, 2 * 4 * 4 * 2);
    assert!((surface.area - 1.0).abs() < 1e-14);
    assert_eq!(surface.at.z, 0.5);
    let [defect] = &refused(draft)[..] else {
        panic!("one defect");
    };
    assert_eq!(defect.code, Some(DOUBLED_NODES));
    for text in [
        "`rock` and `upper`",
        "64 outer faces",
        "1.000000 m2",
        "0.500000)",
    ] {
        assert!(format!("{defect}").contains(text), "{defect}");
    }
}

#[test]
fn a_split_mesh_welded_is_the_whole_one() {
    for on in [MIDDLE, HALF] {
        let whole = with_upper(tetrahedra([4; 3], [1.0; 3], &[Patch::new("joint", on)]));
        let mut draft = split(whole.clone(), on);
        let copies = draft.nodes.len() - whole.nodes.len();
        let joined = joined(&mut draft, &WELD);
        assert!(copies > 0);
        assert_eq!(joined.welded, copies);
        assert_eq!(draft.nodes, whole.nodes);
        assert_eq!(draft.node_tags, whole.node_tags);
        assert_eq!(draft.cells.elements.nodes, whole.cells.elements.nodes);
        assert_eq!(draft.facets.elements.nodes, whole.facets.elements.nodes);
        built(draft).expect("a sound mesh");
    }
}

#[test]
fn the_lowest_tag_wins_whatever_the_order_of_the_nodes() {
    let whole = with_upper(tetrahedra([2; 3], [1.0; 3], &[]));
    let mut draft = split(whole.clone(), MIDDLE);
    let count = draft.node_tags.len() as u64;
    draft
        .node_tags
        .iter_mut()
        .for_each(|tag| *tag = count - *tag);
    joined(&mut draft, &WELD);
    let kept: Vec<u64> = draft.node_tags.clone();
    // The copies stood last, so they have the lowest tags now.
    let copies = count - whole.nodes.len() as u64;
    assert!((0..copies).all(|tag| kept.contains(&tag)));
    assert_eq!(draft.nodes.len(), whole.nodes.len());
}

#[test]
fn copies_of_a_facet_on_both_walls_become_one() {
    let whole = with_upper(tetrahedra([4; 3], [1.0; 3], &[Patch::new("joint", HALF)]));
    let mut draft = split(whole.clone(), HALF);
    // The walls above as gmsh's plugin leaves them: each facet once more, on the copies.
    let copy_of = |node: u32| {
        let place = draft.nodes[node as usize];
        let last = draft.nodes.iter().rposition(|&other| other == place);
        last.expect("itself") as u32
    };
    let facets = whole.facets.elements.len();
    let mut doubled = draft.facets.clone();
    for facet in 0..facets {
        let nodes = whole.facets.elements.nodes_of(facet).iter();
        let nodes: Vec<u32> = nodes.map(|&node| copy_of(node)).collect();
        doubled.elements.push(Shape::Tri3, &nodes);
        doubled.tags.push((facets + facet) as u64 + 1);
        doubled.group_set.push(whole.facets.group_set[facet]);
    }
    draft.facets = doubled;
    let codes: Vec<_> = refused(draft.clone())
        .iter()
        .map(|defect| defect.code)
        .collect();
    assert_eq!(
        codes,
        [Some(DOUBLED_NODES), Some(FRACTURE_ON_DOUBLED_NODES)]
    );
    joined(&mut draft, &WELD);
    assert_eq!(draft.facets.tags, whole.facets.tags);
    let mesh = built(draft).expect("a sound mesh");
    assert_eq!(mesh.facets.elements.len(), facets);
}

#[test]
fn nodes_that_do_not_match_are_refused_and_cannot_be_welded() {
    let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    let shift = DVec3::new(430_000.0, 5_600_000.0, -2450.0);
    for (moved, tolerance) in [(false, 1e-12), (true, 1e-6)] {
        let mut draft = stacked(2, 3);
        if moved {
            for node in &mut draft.nodes {
                *node = (turn * DVec3::from(*node) + shift).to_array();
            }
        }
        let found = surfaces(&draft);
        let [surface] = &found[..] else {
            panic!("one surface, not {found:?}");
        };
        assert_eq!(surface.touch, Touch::NotMatching);
        assert!((surface.area - 1.0).abs() < tolerance, "{}", surface.area);
        assert_eq!(surface.faces, 2 * (4 + 9));
        joined(&mut draft, &WELD);
        let defects = refused(draft);
        assert_eq!(defects.len(), 1);
        assert_eq!(defects[0].code, Some(FACES_NOT_MATCHING));
    }
}

#[test]
fn faces_of_other_shapes_do_not_match() {
    let cut = |cube: [usize; 3]| match cube[2] {
        0 => Cut::Hexahedron,
        _ => Cut::Tetrahedra,
    };
    let found = surfaces(&mixed([2; 3], [1.0; 3], &[], cut));
    let [surface] = &found[..] else {
        panic!("one surface, not {found:?}");
    };
    assert_eq!(surface.touch, Touch::NotMatching);
    assert!((surface.area - 1.0).abs() < 1e-14);
}

#[test]
fn a_gap_is_no_contact_and_a_copy_is_one_on_the_same_side() {
    let mut apart = stacked(2, 2);
    let above = apart.nodes.len() / 2;
    for node in &mut apart.nodes[above..] {
        node[2] += 1e-4;
    }
    assert_eq!(surfaces(&apart), []);
    assert_eq!(built(apart.clone()).expect("two bodies").block_count, 2);
    for node in &mut apart.nodes[above..] {
        node[2] -= 0.5 + 1e-4;
    }
    let found = surfaces(&apart);
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].touch, Touch::SameSide);
}

#[test]
fn volumes_that_overlap_without_sharing_faces_are_refused() {
    // A box through another: their cells lie in one another, and no faces on one another.
    let mut through = stacked(3, 3);
    let above = through.nodes.len() / 2;
    for node in &mut through.nodes[above..] {
        *node = [
            0.3 + 0.4 * node[0],
            0.31 + 0.4 * node[1],
            1.3 * node[2] - 0.7,
        ];
    }
    assert_eq!(surfaces(&through), []);
    let defects = refused(through.clone());
    assert_eq!(defects.len(), 1, "{defects:?}");
    assert!(
        defects[0].problem.contains("volumes overlap"),
        "{defects:?}"
    );
    for node in &mut through.nodes[above..] {
        node[2] += 2.0;
    }
    assert_eq!(built(through).expect("two bodies").block_count, 2);
}

#[test]
fn sound_meshes_have_no_doubled_faces() {
    for shape in Shape::CELLS {
        let draft = cells_of(shape, [2, 3, 2], [1.0; 3], &[Patch::new("joint", MIDDLE)]);
        assert_eq!(surfaces(&draft), [], "{shape:?}");
    }
}

#[test]
fn the_surface_between_two_volumes_becomes_a_fracture() {
    let reference = built(with_upper(tetrahedra(
        [4; 3],
        [1.0; 3],
        &[Patch::new("joint", MIDDLE)],
    )));
    let reference = reference.expect("a sound mesh");
    let shared = with_upper(tetrahedra([4; 3], [1.0; 3], &[]));
    for mut draft in [shared.clone(), split(shared, MIDDLE)] {
        let found = joined(&mut draft, &between([0, 1]));
        assert_eq!(found.facets, [32]);
        let mesh = built(draft).expect("a sound mesh");
        assert_eq!(mesh.fractures, ["between"]);
        assert_eq!(mesh.block_count, 2);
        assert_eq!(mesh.sectors.count, reference.sectors.count);
        assert!(mesh.facet_areas().iter().all(|area| area.z > 0.0));
    }
}

#[test]
fn the_crack_within_a_volume_becomes_a_fracture() {
    let whole = tetrahedra([4; 3], [1.0; 3], &[Patch::new("joint", HALF)]);
    let reference = built(whole).expect("a sound mesh");
    let mut draft = split(tetrahedra([4; 3], [1.0; 3], &[]), |x| {
        // The front stays one.
        HALF(x) && x[0] < 0.5
    });
    let found = joined(&mut draft, &between([0, 0]));
    assert_eq!(found.facets, [16]);
    assert_eq!(found.welded, 10);
    let mesh = built(draft).expect("a sound mesh");
    assert_eq!(mesh.sectors.count, reference.sectors.count);
    assert_eq!(mesh.cells.nodes, reference.cells.nodes);
}

#[test]
fn between_welds_only_what_it_names() {
    // The doubled faces lie between two volumes, none of them within one.
    let draft = split(with_upper(tetrahedra([4; 3], [1.0; 3], &[])), MIDDLE);
    let mut other = draft.clone();
    let found = joined(&mut other, &between([0, 0]));
    assert_eq!((found.facets, found.welded), (vec![0], 0));
    assert_eq!(other.nodes, draft.nodes);
}

#[test]
fn second_order_nodes_are_welded_too_or_refused() {
    let whole = with_upper(cells_of(Shape::Tet10, [2; 3], [1.0; 3], &[]));
    let mut draft = split(whole.clone(), MIDDLE);
    joined(&mut draft, &WELD);
    assert_eq!(draft.cells.elements.nodes, whole.cells.elements.nodes);
    let mut bent = split(whole.clone(), MIDDLE);
    let corners = corners(&whole.cells.elements);
    for node in whole.nodes.len()..bent.nodes.len() {
        let at = bent.nodes[node];
        let original = whole.nodes.iter().position(|&x| x == at).expect("it");
        if !corners[original] {
            bent.nodes[node][0] += 0.01;
        }
    }
    assert_eq!(surfaces(&bent)[0].touch, Touch::NotMatching);
    let defects = bent.join(Faces::of(&bent), &WELD).err().expect("a defect");
    assert!(
        defects[0].problem.contains("not the middles"),
        "{}",
        defects[0]
    );
}

/// Which nodes are corners.
fn corners(cells: &Elements) -> Vec<bool> {
    let count = cells
        .nodes
        .iter()
        .max()
        .map_or(0, |&node| node as usize + 1);
    let mut is_corner = vec![false; count];
    for cell in 0..cells.len() {
        for &node in &cells.nodes_of(cell)[..cells.shapes[cell].corner_count()] {
            is_corner[node as usize] = true;
        }
    }
    is_corner
}
