//! What the reader says against files that are wrong.

use kluft_io::parse_msh;
use kluft_mesh::Defect;

/// One tetrahedron with one tagged face.
const TETRAHEDRON: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n\
    $PhysicalNames\n2\n2 5 \"face\"\n3 1 \"rock\"\n$EndPhysicalNames\n\
    $Entities\n0 0 1 1\n7 0 0 0 1 1 1 1 5 0\n3 0 0 0 1 1 1 1 1 1 7\n$EndEntities\n\
    $Nodes\n1 4 1 4\n3 3 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n\
    $Elements\n2 2 1 2\n2 7 2 1\n1 1 3 2\n3 3 4 1\n2 1 2 3 4\n$EndElements\n";

fn defects_after(changes: &[(&str, &str)]) -> Vec<Defect> {
    let mut text = TETRAHEDRON.to_owned();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    parse_msh(text.as_bytes(), "t.msh")
        .err()
        .unwrap_or_default()
}

#[test]
fn the_tetrahedron_is_sound() {
    let draft = parse_msh(TETRAHEDRON.as_bytes(), "t.msh").expect("a draft");
    assert_eq!(draft.cells.elements.nodes, [0, 1, 2, 3]);
    assert_eq!(draft.facets.elements.nodes, [0, 2, 1]);
    assert_eq!(
        (&draft.cells.tags, &draft.facets.tags),
        (&vec![2], &vec![1])
    );
    assert_eq!(draft.group_sets, [vec![0], vec![1]]);
    assert_eq!(draft.nodes[3], [0.0, 0.0, 1.0]);
}

#[test]
fn all_kinds_of_defects_are_reported_at_once() {
    let defects = defects_after(&[
        ("1\n2\n3\n4\n0 0 0", "3\n2\n3\n0\nnan 0 0"),
        ("2 7 2 1\n1 1 3 2", "2 7 21 1\n1 1 3 2 9 9 9 9 9 9 9"),
        ("3 3 4 1", "3 8 4 1"),
    ]);
    let all = defects
        .iter()
        .map(|defect| format!("{defect}\n"))
        .collect::<String>();
    for expected in [
        "nodes 3: a coordinate is infinite",
        "a node has the tag 0",
        "nodes 3: the tag stands for more than one node",
        "volume 8: 1 entities have elements but are not listed",
        "\"face\": 1 elements are of gmsh type 21 (Tri10)",
        "elements 2: they refer to nodes that are not there: 1, 4",
    ] {
        assert!(all.contains(expected), "{expected}:\n{all}");
    }
    assert_eq!(defects.len(), 6, "{all}");
}

#[test]
fn a_file_without_entities_has_no_groups_on_its_elements() {
    let start = TETRAHEDRON.find("$Entities").expect("there");
    let end = TETRAHEDRON.find("$Nodes").expect("there");
    let text = format!("{}{}", &TETRAHEDRON[..start], &TETRAHEDRON[end..]);
    let draft = parse_msh(text.as_bytes(), "t.msh").expect("a draft");
    assert_eq!(draft.groups.len(), 2);
    assert_eq!(draft.group_sets, [Vec::<usize>::new()]);
}

#[test]
fn line_breaks_of_windows_make_no_difference() {
    let text = TETRAHEDRON.replace('\n', "\r\n");
    let draft = parse_msh(text.as_bytes(), "t.msh").expect("a draft");
    assert_eq!(draft.cells.elements.nodes, [0, 1, 2, 3]);
    assert_eq!(draft.groups[0].name, "face");
}

#[test]
fn structural_damage_names_the_place() {
    for (from, to, expected) in [
        ("1 4 1 4", "1 5 1 4", "promises 5 nodes, there are 4"),
        ("1 4 1 4", "1 0 0 0", "holds no node"),
        ("1 4 1 4", "1 4 4 1", "cannot run from 4 to 1"),
        ("1 4 1 4", "1 99999 1 4", "number of nodes is 99999"),
        ("2 2 1 2", "2 0 1 2", "holds no element"),
        (
            "2 2 1 2",
            "3 2 1 2",
            "t.msh, line 31: the section ends where",
        ),
        ("2 2 1 2", "1 1 1 2", "goes on where its counts say it ends"),
        ("2 7 2 1", "2 7 34 1", "gmsh type 34"),
        ("2 7 2 1", "4 7 2 1", "dimension of an element block"),
        (
            "2 7 2 1",
            "2 7 2 18446744073709551615",
            "is 18446744073709551615",
        ),
        (
            "2 7 2 1\n",
            "1 7 2 1\n",
            "curve 7: 1 elements are of gmsh type 2",
        ),
        ("3 3 0 4", "3 3 2 4", "parametric flag 2"),
        ("0 0 1 1\n7", "0 0 9 1\n7", "entities"),
        ("$EndElements", "", "cut off"),
        ("$Nodes\n", "$Knots\n", "no $EndKnots"),
        ("4.1 0 8", "2.2 0 8", "version 2.2"),
        (
            "0 1 0\n",
            "0 1,0 0\n",
            "line 23: `1,0` is not a valid coordinate",
        ),
    ] {
        let defects = defects_after(&[(from, to)]);
        let all = defects
            .iter()
            .map(|defect| format!("{defect}\n"))
            .collect::<String>();
        assert!(all.contains(expected), "{to}: {expected}:\n{all}");
    }
}
