//! Boxes with a fracture, cells taken out: what was told by cells is told by place.

use super::*;
use crate::outer_surfaces;
use crate::structured::{Patch, cells_of};
use crate::{FractureEdges, FracturesAtNodes, Shape};

const FACES: [(&str, usize, f64); 6] = [
    ("left", 0, 0.0),
    ("right", 0, 2.0),
    ("front", 1, 0.0),
    ("back", 1, 1.0),
    ("bottom", 2, 0.0),
    ("top", 2, 1.0),
];

/// A box of 2 m by 1 m by 1 m without its cells, with a joint across at `z = 0.5`.
fn surfaces(shape: Shape) -> Draft {
    let on = FACES.map(|(_, axis, at)| move |x: [f64; 3]| x[axis] == at);
    let joint = |x: [f64; 3]| x[2] == 0.5;
    let mut patches = vec![Patch::new("joint", &joint)];
    for ((name, ..), on) in FACES.iter().zip(&on) {
        patches.push(Patch::new(name, on));
    }
    let mut draft = cells_of(shape, [4, 2, 2], [2.0, 1.0, 1.0], &patches);
    draft.cells = crate::TaggedElements::new();
    draft
}

fn roles(draft: &Draft) -> Vec<SurfaceRole> {
    let groups = draft.groups.iter().zip(outer_surfaces(draft));
    let role = |(group, outer): (&crate::Group, bool)| match (group.dimension, outer) {
        (2, true) => SurfaceRole::Boundary,
        (2, false) => SurfaceRole::Fracture,
        _ => SurfaceRole::Unused,
    };
    groups.map(role).collect()
}

#[test]
fn surfaces_keep_what_cells_would_tell_of_the_outside() {
    for shape in [Shape::Tet4, Shape::Tet10, Shape::Hex8, Shape::Hex27] {
        let draft = surfaces(shape);
        let roles = roles(&draft);
        let mesh = Mesh::of_surfaces(draft, &roles).expect("sound surfaces");
        assert_eq!(mesh.fractures, ["joint"]);
        assert_eq!(mesh.boundaries.len(), 6);
        let area: f64 = mesh.facet_areas().iter().map(|area| area.length()).sum();
        assert!((area - 2.0).abs() < 1e-14, "{area}");
        let volume = mesh.volume().expect("a closed surface");
        assert!((volume - 2.0).abs() < 1e-14, "{volume}");
        let at_nodes = FracturesAtNodes::of_mesh(&mesh);
        let edges = FractureEdges::of(&mesh, &at_nodes);
        let outer = edges.meetings().filter(|run| edges.is_outer(run[0].nodes));
        let length: f64 = outer.map(|run| mesh.edge_length(run[0].nodes)).sum();
        assert!((length - 6.0).abs() < 1e-14, "{length}");
    }
}

/// Facets divided twice: sixteen times as many, the same areas, and nodes still shared.
#[test]
fn surfaces_can_be_refined() {
    for shape in [Shape::Tet4, Shape::Tet10, Shape::Hex8, Shape::Hex27] {
        let mut draft = surfaces(shape);
        let roles = roles(&draft);
        let before = draft.facets.elements.len();
        draft.refine(2).expect("few facets");
        assert_eq!(draft.facets.elements.len(), 16 * before);
        let mesh = Mesh::of_surfaces(draft, &roles).expect("sound surfaces");
        let area: f64 = mesh.facet_areas().iter().map(|area| area.length()).sum();
        assert!((area - 2.0).abs() < 1e-13, "{area}");
        assert!((mesh.volume().expect("closed") - 2.0).abs() < 1e-13);
    }
}

#[test]
fn an_open_outside_has_no_volume() {
    let draft = surfaces(Shape::Tet4);
    let mut roles = roles(&draft);
    let top = draft.groups.iter().position(|group| group.name == "top");
    roles[top.expect("a top")] = SurfaceRole::Unused;
    let mesh = Mesh::of_surfaces(draft, &roles).expect("sound surfaces");
    assert_eq!(mesh.volume(), None);
}

#[test]
fn cells_have_the_volume_of_the_box() {
    let roles = [SurfaceRole::Unused, SurfaceRole::Fracture];
    let on = |x: [f64; 3]| x[2] == 0.5;
    let draft = cells_of(
        Shape::Prism6,
        [2, 2, 2],
        [2.0, 1.0, 1.0],
        &[Patch::new("joint", &on)],
    );
    let mesh = Mesh::build(draft, &roles).expect("a sound mesh");
    assert!((mesh.volume().expect("cells") - 2.0).abs() < 1e-14);
}

fn refused(draft: Draft, roles: &[SurfaceRole]) -> String {
    let defects = Mesh::of_surfaces(draft, roles).expect_err("defects");
    defects.iter().map(|defect| format!("{defect}\n")).collect()
}

#[test]
fn defects_of_surfaces_are_named() {
    let draft = surfaces(Shape::Tet4);
    let mut both = roles(&draft);
    both[2] = SurfaceRole::Fracture;
    let said = refused(
        Draft {
            facets: crate::TaggedElements::new(),
            ..draft.clone()
        },
        &both,
    );
    assert!(said.contains("no elements of dimension 2 or 3"), "{said}");

    let mut lost = draft.clone();
    lost.nodes[3][1] = f64::NAN;
    assert!(refused(lost, &both).contains("node 4: a coordinate is not a finite"));

    let mut flat = draft.clone();
    let first = flat.facets.elements.nodes[0] as usize;
    let second = flat.facets.elements.nodes[1] as usize;
    flat.nodes[second] = flat.nodes[first];
    assert!(refused(flat, &both).contains("the facet has no area"));

    // A copy of a node, which half of the facets around it have instead.
    let mut doubled = draft.clone();
    let node = doubled.facets.elements.nodes[0];
    doubled.nodes.push(doubled.nodes[node as usize]);
    doubled.node_tags.push(9999);
    doubled.facets.elements.nodes[0] = doubled.nodes.len() as u32 - 1;
    let said = refused(doubled, &roles(&draft));
    assert!(
        said.contains("share their place") && said.contains("9999"),
        "{said}"
    );
}

#[test]
fn facets_that_are_not_a_fractures_own_are_named() {
    let draft = surfaces(Shape::Tet4);
    let mut twice = draft.clone();
    let own = twice.facets.elements.nodes_of(0).to_vec();
    twice.facets.elements.push(Shape::Tri3, &own);
    twice.facets.tags.push(7777);
    twice.facets.group_set.push(twice.facets.group_set[0]);
    let said = refused(twice, &roles(&draft));
    assert!(
        said.contains("facet 7777: the facet stands in the file twice"),
        "{said}"
    );

    let mut empty = draft.clone();
    empty.groups.push(crate::Group {
        dimension: 2,
        tag: 77,
        name: "ghost".into(),
    });
    let mut with_ghost = roles(&draft);
    with_ghost.push(SurfaceRole::Fracture);
    let said = refused(empty, &with_ghost);
    assert!(
        said.contains("fracture `ghost`") && said.contains("holds no facets"),
        "{said}"
    );

    // A fracture and a boundary that hold the same facets.
    let mut mixed = draft;
    let left = mixed.group_sets.iter().position(|set| set == &[2]);
    mixed.group_sets[left.expect("a set")] = vec![1, 2];
    let said = refused(mixed, &roles(&surfaces(Shape::Tet4)));
    assert!(
        said.contains("fracture `joint`") && said.contains("outer boundary"),
        "{said}"
    );
}
