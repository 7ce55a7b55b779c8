//! The reader against what gmsh really writes.

mod rewrite;

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use kluft_io::{GmshOptions, load_msh, parse_msh, read_msh};
use kluft_mesh::{Draft, Shape, TaggedElements};
use rewrite::{retag, swap_byte_order};

/// Two blocks with a surface between them, and group names of all kinds.
const BLOCKS: &str = r#"SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 1, 1};
Rectangle(20) = {0, 0, 0.5, 1, 1};
BooleanFragments{ Volume{1}; Delete; }{ Surface{20}; Delete; }
MeshSize{:} = 0.4;
Physical Volume("upper rock", 1) = {1};
Physical Volume("lower // Köln", 2) = {2};
Physical Surface("joint one", 5) = {20};
Physical Surface("all $EndPhysicalNames \surfaces", 6) = {20, -21, 22};
Physical Surface(7) = {21};
"#;

/// A folder of its own, removed in the end.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("kluft-msh-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a temporary folder");
        Self(folder)
    }

    /// Runs gmsh on a geometry and answers with the path of the mesh.
    fn mesh(&self, geometry: &str, arguments: &str) -> PathBuf {
        let input = self.0.join("in.geo");
        fs::write(&input, geometry).expect("written");
        let output = self
            .0
            .join(format!("{}.msh", arguments.replace([' ', '-'], "_")));
        let mut gmsh = Command::new("gmsh");
        gmsh.arg(&input)
            .args(["-3", "-v", "1"])
            .args(arguments.split_whitespace());
        let status = gmsh
            .arg("-o")
            .arg(&output)
            .status()
            .expect("gmsh is installed");
        assert!(status.success(), "{arguments}");
        output
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn read(path: &Path) -> Draft {
    read_msh(path).unwrap_or_else(|defects| panic!("{}: {defects:?}", path.display()))
}

/// Names of the groups of every element, with its nodes' coordinates; all in no order, as gmsh
/// turns elements round when it writes version 2.
fn described(draft: &Draft, elements: &TaggedElements) -> HashSet<(Vec<String>, Vec<[i64; 3]>)> {
    (0..elements.elements.len())
        .map(|index| {
            let set = &draft.group_sets[elements.group_set[index] as usize];
            let mut names: Vec<String> =
                set.iter().map(|&g| draft.groups[g].name.clone()).collect();
            names.sort();
            let nodes = elements.elements.nodes_of(index).iter();
            let rounded = |x: f64| (x * 1e12).round() as i64;
            let places = nodes.map(|&n| draft.nodes[n as usize].map(rounded));
            let mut places: Vec<[i64; 3]> = places.collect();
            places.sort_unstable();
            (names, places)
        })
        .collect()
}

fn assert_same_geometry(a: &Draft, b: &Draft) {
    assert!(described(a, &a.cells) == described(b, &b.cells));
    assert!(described(a, &a.facets) == described(b, &b.facets));
    assert_eq!(a.cells.tags.len(), b.cells.tags.len());
    assert_eq!(a.facets.tags.len(), b.facets.tags.len());
}

#[test]
fn text_and_binary_give_the_same_draft() {
    let scratch = Scratch::new("encodings");
    let text = read(&scratch.mesh(BLOCKS, "-format msh41"));
    let binary = read(&scratch.mesh(BLOCKS, "-format msh41 -bin"));
    assert!(text.cells.elements.len() > 100);
    assert_eq!(text.node_tags, binary.node_tags);
    assert_eq!(text.groups, binary.groups);
    assert_eq!(text.group_sets, binary.group_sets);
    for (a, b) in [(&text.cells, &binary.cells), (&text.facets, &binary.facets)] {
        assert_eq!(a.elements.nodes, b.elements.nodes);
        assert_eq!((&a.tags, &a.group_set), (&b.tags, &b.group_set));
    }
    // Text files carry 16 digits, one too few to be exact.
    let pairs = text
        .nodes
        .as_flattened()
        .iter()
        .zip(binary.nodes.as_flattened());
    assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-15));
}

#[test]
fn binary_files_of_the_other_byte_order() {
    let scratch = Scratch::new("order");
    let path = scratch.mesh(BLOCKS, "-format msh41 -bin");
    let swapped = swap_byte_order(&fs::read(&path).expect("there"));
    let draft = parse_msh(&swapped, "swapped").expect("a draft");
    let original = read(&path);
    assert_eq!(draft.nodes, original.nodes);
    assert_eq!(draft.cells.elements.nodes, original.cells.elements.nodes);
    assert_eq!(draft.group_sets, original.group_sets);
}

#[test]
fn every_group_of_every_element_is_kept() {
    let scratch = Scratch::new("groups");
    let draft = read(&scratch.mesh(BLOCKS, "-format msh41 -bin"));
    let names: Vec<(usize, i32, &str)> = draft
        .groups
        .iter()
        .map(|g| (g.dimension, g.tag, g.name.as_str()))
        .collect();
    assert_eq!(
        names,
        [
            (2, 5, "joint one"),
            (2, 6, "all $EndPhysicalNames \\surfaces"),
            (3, 1, "upper rock"),
            (3, 2, "lower // Köln"),
            (2, 7, "7"),
        ]
    );
    let sets: HashSet<Vec<usize>> = draft.group_sets.iter().cloned().collect();
    let expected = [vec![0, 1], vec![1, 4], vec![1], vec![2], vec![3]];
    assert_eq!(sets, HashSet::from(expected));
}

#[test]
fn shuffled_node_tags_give_the_same_geometry() {
    let scratch = Scratch::new("shuffled");
    let path = scratch.mesh(BLOCKS, "-format msh41");
    let original = read(&path);
    let text = fs::read_to_string(&path).expect("text");
    for stretch in [1, 1_000_003] {
        let count = original.nodes.len() as u64;
        assert_ne!(count % 7, 0, "7 must not divide the number of nodes");
        // With `stretch` 1, the same tags as before on other nodes: mshio alone sees no difference.
        let shuffled = retag(&text, |tag| (7 * tag % count + 1) * stretch);
        let draft = parse_msh(shuffled.as_bytes(), "shuffled").expect("a draft");
        assert_ne!(draft.node_tags, original.node_tags);
        assert_same_geometry(&draft, &original);
    }
}

#[test]
fn partitioned_meshes_keep_their_groups() {
    let scratch = Scratch::new("partitioned");
    let whole = read(&scratch.mesh(BLOCKS, "-format msh41 -bin"));
    for arguments in ["-part 3", "-bin -part 3", "-bin -part 2 -part_ghosts"] {
        let parted = read(&scratch.mesh(BLOCKS, &format!("-format msh41 {arguments}")));
        assert!(
            !parted.node_tags.is_sorted(),
            "this is what mshio alone gets wrong"
        );
        assert!(described(&parted, &parted.cells) == described(&whole, &whole.cells));
        // Faces between partitions come on top; they belong to no group.
        let facets = described(&parted, &parted.facets);
        assert!(facets.is_superset(&described(&whole, &whole.facets)));
    }
}

#[test]
fn cracked_meshes_have_their_nodes_twice() {
    let scratch = Scratch::new("cracked");
    let crack = "\nMesh 3;\nPlugin(Crack).Dimension = 2;\nPlugin(Crack).PhysicalGroup = 5;\n\
        Plugin(Crack).Run;\n";
    let whole = read(&scratch.mesh(BLOCKS, "-format msh41"));
    let plane = |draft: &Draft| {
        draft
            .nodes
            .iter()
            .filter(|x| (x[2] - 0.5).abs() < 1e-9)
            .count()
    };
    let text = read(&scratch.mesh(&format!("{BLOCKS}{crack}"), "-format msh41 -0"));
    let binary = read(&scratch.mesh(&format!("{BLOCKS}{crack}"), "-format msh41 -0 -bin"));
    assert!(plane(&text) > plane(&whole));
    assert_same_geometry(&text, &binary);
    assert!(described(&text, &text.cells) == described(&whole, &whole.cells));
}

#[test]
fn older_versions_are_converted() {
    let scratch = Scratch::new("older");
    let current = read(&scratch.mesh(BLOCKS, "-format msh41 -bin"));
    for arguments in ["-format msh22", "-format msh22 -bin", "-format msh40"] {
        let path = scratch.mesh(BLOCKS, arguments);
        assert!(
            read_msh(&path).expect_err(arguments)[0]
                .problem
                .contains("version")
        );
        let converted = load_msh(&path, &scratch.0, &GmshOptions::default()).expect(arguments);
        assert_same_geometry(&converted, &current);
        assert_eq!(converted.source, path.display().to_string());
    }
    let left = fs::read_dir(&scratch.0).expect("there").count();
    assert_eq!(left, 1 + 1 + 3, "the converted file is removed");
}

#[test]
fn names_with_quotes_survive_the_conversion() {
    let scratch = Scratch::new("quotes");
    let path = scratch.mesh(BLOCKS, "-format msh22");
    let text = fs::read_to_string(&path).expect("text");
    let quoted = text.replace("\"joint one\"", "\"he said \"hi\" there\"");
    assert!(quoted != text);
    fs::write(&path, quoted).expect("written");
    let names = load_msh(&path, &scratch.0, &GmshOptions::default())
        .expect("a draft")
        .groups;
    let names: Vec<&str> = names.iter().map(|group| group.name.as_str()).collect();
    for name in [
        "he said \"hi\" there",
        "all $EndPhysicalNames \\surfaces",
        "7",
    ] {
        assert!(names.contains(&name), "{name}: {names:?}");
    }
}

#[test]
fn what_gmsh_cannot_convert_is_a_defect() {
    let scratch = Scratch::new("cut");
    let path = scratch.mesh(BLOCKS, "-format msh22");
    let bytes = fs::read(&path).expect("there");
    for length in [40, bytes.len() / 4, bytes.len() / 2] {
        fs::write(&path, &bytes[..length]).expect("written");
        assert!(
            load_msh(&path, &scratch.0, &GmshOptions::default()).is_err(),
            "{length} bytes"
        );
    }
    assert!(
        load_msh(&scratch.0, &scratch.0, &GmshOptions::default()).is_err(),
        "a folder"
    );
    assert!(
        load_msh(
            &scratch.0.join("nix.msh"),
            &scratch.0,
            &GmshOptions::default()
        )
        .is_err()
    );
    fs::write(&path, "").expect("written");
    assert!(
        load_msh(&path, &scratch.0, &GmshOptions::default()).is_err(),
        "an empty file"
    );
}

#[test]
fn elements_that_cannot_be_used_are_named() {
    let scratch = Scratch::new("elements");
    let extruded = |groups: &str| {
        format!(
            "SetFactory(\"OpenCASCADE\");\nRectangle(1) = {{0, 0, 0, 1, 1}};\nMeshSize{{:}} = 0.5;\n\
             Extrude {{0, 0, 1}} {{ Surface{{1}}; Layers{{2}}; Recombine; }}\n{groups}"
        )
    };
    let third = scratch.mesh(
        &extruded("Physical Volume(\"slab\") = {1};\n"),
        "-format msh41 -order 3",
    );
    let defects = read_msh(&third).expect_err("third order");
    assert_eq!(defects.len(), 1, "{defects:?}");
    let text = format!("{defects:?}");
    assert!(
        text.contains("\\\"slab\\\"") && text.contains("Pri40"),
        "{text}"
    );
}

/// All prisms and their faces, of both orders, in text and binary: mshio alone misreads those of 18
/// nodes.
#[test]
fn prisms_of_both_orders_are_read() {
    let scratch = Scratch::new("prisms");
    let slab = "SetFactory(\"OpenCASCADE\");\nRectangle(1) = {0, 0, 0, 1, 1};\nMeshSize{:} = 0.5;\n\
                Extrude {0, 0, 1} { Surface{1}; Layers{2}; Recombine; }\n";
    for (order, cell, facets) in [
        ("1", Shape::Prism6, [Shape::Tri3, Shape::Quad4]),
        ("2", Shape::Prism18, [Shape::Tri6, Shape::Quad9]),
    ] {
        let read = |format: &str| {
            let path = scratch.mesh(slab, &format!("-format msh41 {format} -order {order}"));
            read_msh(&path).unwrap_or_else(|defects| panic!("{defects:?}"))
        };
        let (text, binary) = (read(""), read("-bin"));
        for draft in [&text, &binary] {
            assert!(
                draft
                    .cells
                    .elements
                    .shapes
                    .iter()
                    .all(|shape| *shape == cell)
            );
            assert!(
                draft
                    .facets
                    .elements
                    .shapes
                    .iter()
                    .all(|shape| facets.contains(shape))
            );
            assert!(!draft.cells.elements.is_empty());
        }
        assert_eq!(text.cells.elements.nodes, binary.cells.elements.nodes);
        assert_eq!(text.facets.elements.nodes, binary.facets.elements.nodes);
    }
}

#[test]
fn parametric_nodes_are_named_with_their_remedy() {
    let scratch = Scratch::new("parametric");
    for arguments in [
        "-format msh41 -save_parametric",
        "-format msh41 -bin -save_parametric",
    ] {
        let defects = read_msh(&scratch.mesh(BLOCKS, arguments)).expect_err("parametric");
        assert_eq!(defects.len(), 1, "{defects:?}");
        assert!(defects[0].remedy.contains("SaveParametric"));
    }
}
