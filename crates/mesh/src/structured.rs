//! Small structured drafts for tests, examples and benchmarks.

use std::collections::BTreeMap;

use crate::draft::{Draft, Elements, Group, TaggedElements};
use crate::shape::Shape;

/// A plane piece of fracture on grid planes: all triangles whose corners satisfy `contains`.
pub struct Patch<'a> {
    /// Name of the physical surface.
    pub name: &'a str,
    /// Whether a point belongs to the patch. All corners of a facet must.
    pub contains: &'a dyn Fn([f64; 3]) -> bool,
}

impl<'a> Patch<'a> {
    /// The patch `name` of all triangles whose corners satisfy `contains`.
    pub fn new(name: &'a str, contains: &'a dyn Fn([f64; 3]) -> bool) -> Self {
        Self { name, contains }
    }
}

/// How a cube of the grid is cut into cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cut {
    /// Six tetrahedra around the main diagonal (Kuhn).
    Tetrahedra,
    /// One hexahedron.
    Hexahedron,
    /// Two prisms along z; their triangles fit the tetrahedra above and below.
    Prisms,
    /// Six pyramids with their tops in the middle; their bases fit hexahedra.
    Pyramids,
}

/// A box `[0, size]` of `counts` cubes, six tetrahedra each, so that the planes of the grid are
/// meshed conformingly; `patches` become physical surfaces, also on the outside. One volume,
/// `rock`.
pub fn tetrahedra(counts: [usize; 3], size: [f64; 3], patches: &[Patch<'_>]) -> Draft {
    mixed(counts, size, patches, |_| Cut::Tetrahedra)
}

/// The same box of cells of one shape.
pub fn cells_of(shape: Shape, counts: [usize; 3], size: [f64; 3], patches: &[Patch<'_>]) -> Draft {
    let cut = match shape.corner_count() {
        4 => Cut::Tetrahedra,
        5 => Cut::Pyramids,
        6 => Cut::Prisms,
        _ => Cut::Hexahedron,
    };
    let mut draft = mixed(counts, size, patches, |_| cut);
    if shape.is_quadratic() {
        raise(&mut draft, shape);
    }
    draft
}

/// The same box with a cut of its own for each cube; neighbours must fit.
pub fn mixed(
    counts: [usize; 3],
    size: [f64; 3],
    patches: &[Patch<'_>],
    cut: impl Fn([usize; 3]) -> Cut,
) -> Draft {
    let mut draft = Draft {
        source: "structured box".into(),
        nodes: grid(counts, size),
        groups: vec![group(3, 1, "rock")],
        group_sets: vec![vec![0]],
        cells: TaggedElements::new(),
        facets: TaggedElements::new(),
        ..Draft::default()
    };
    for cube in cubes(counts) {
        let corners = corners(cube, counts);
        match cut(cube) {
            Cut::Tetrahedra => {
                for tet in kuhn(corners) {
                    push(&mut draft.cells, Shape::Tet4, &tet, 0);
                }
            }
            Cut::Hexahedron => push(&mut draft.cells, Shape::Hex8, &corners, 0),
            Cut::Prisms => {
                for prism in [[0, 1, 2, 4, 5, 6], [0, 2, 3, 4, 6, 7]] {
                    let prism = prism.map(|corner: usize| corners[corner]);
                    push(&mut draft.cells, Shape::Prism6, &prism, 0);
                }
            }
            Cut::Pyramids => push_pyramids(&mut draft, &corners),
        }
    }
    draft.node_tags = (1..=draft.nodes.len() as u64).collect();
    for (index, patch) in patches.iter().enumerate() {
        draft.groups.push(group(2, index as i32 + 1, patch.name));
        draft.group_sets.push(vec![index + 1]);
        let inside: Vec<bool> = draft.nodes.iter().map(|&x| (patch.contains)(x)).collect();
        for (shape, facet) in faces_within(&draft.cells.elements, &inside) {
            push(&mut draft.facets, shape, &facet, index as u32 + 1);
        }
    }
    draft
}

/// Replaces all linear cells by `shape`, which must be of their family, and the facets to match.
fn raise(draft: &mut Draft, shape: Shape) {
    let linear = std::mem::replace(&mut draft.cells, TaggedElements::new());
    let mut middles = BTreeMap::new();
    for cell in 0..linear.elements.len() {
        let corners = linear.elements.nodes_of(cell);
        let nodes: Vec<u32> = (0..shape.node_count())
            .map(|local| {
                let members = shape.members(local);
                let mut key: Vec<u32> = members.iter().map(|&m| corners[m as usize]).collect();
                key.sort_unstable();
                if let [corner] = key[..] {
                    return corner;
                }
                *middles
                    .entry(key)
                    .or_insert_with_key(|key| middle_node(draft, key))
            })
            .collect();
        push(&mut draft.cells, shape, &nodes, linear.group_set[cell]);
    }
    draft.node_tags = (1..=draft.nodes.len() as u64).collect();
    raise_facets(draft);
}

fn middle_node(draft: &mut Draft, corners: &[u32]) -> u32 {
    let share = 1.0 / corners.len() as f64;
    let sum = |axis: usize| -> f64 {
        corners
            .iter()
            .map(|&corner| draft.nodes[corner as usize][axis])
            .sum()
    };
    let middle = [0, 1, 2].map(|axis| share * sum(axis));
    draft.nodes.push(middle);
    draft.nodes.len() as u32 - 1
}

/// Gives each facet the nodes of the cell face it lies on.
fn raise_facets(draft: &mut Draft) {
    let cells = &draft.cells.elements;
    let mut faces = BTreeMap::new();
    for cell in 0..cells.len() {
        let nodes = cells.nodes_of(cell);
        for face in cells.shapes[cell].faces() {
            let mut key: Vec<u32> = face.corners().iter().map(|&c| nodes[c as usize]).collect();
            key.sort_unstable();
            let all: Vec<u32> = face
                .nodes
                .iter()
                .map(|&local| nodes[local as usize])
                .collect();
            faces.entry(key).or_insert((face.shape, all));
        }
    }
    let linear = std::mem::replace(&mut draft.facets, TaggedElements::new());
    for facet in 0..linear.elements.len() {
        let mut key = linear.elements.nodes_of(facet).to_vec();
        key.sort_unstable();
        if let Some((shape, nodes)) = faces.get(&key) {
            push(&mut draft.facets, *shape, nodes, linear.group_set[facet]);
        }
    }
}

fn group(dimension: usize, tag: i32, name: &str) -> Group {
    Group {
        dimension,
        tag,
        name: name.into(),
    }
}

fn push(list: &mut TaggedElements, shape: Shape, nodes: &[u32], group_set: u32) {
    list.elements.push(shape, nodes);
    list.tags.push(list.tags.len() as u64 + 1);
    list.group_set.push(group_set);
}

fn grid(counts: [usize; 3], size: [f64; 3]) -> Vec<[f64; 3]> {
    let step = |axis: usize, i: usize| size[axis] * i as f64 / counts[axis] as f64;
    let mut nodes = Vec::new();
    for i in 0..=counts[0] {
        for j in 0..=counts[1] {
            nodes.extend((0..=counts[2]).map(|k| [step(0, i), step(1, j), step(2, k)]));
        }
    }
    nodes
}

fn cubes(counts: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    let [nx, ny, nz] = counts;
    (0..nx * ny * nz).map(move |n| [n / (ny * nz), n / nz % ny, n % nz])
}

/// Corners of a cube in the order of a hexahedron.
fn corners(cube: [usize; 3], counts: [usize; 3]) -> [u32; 8] {
    const OFFSETS: [[usize; 3]; 8] = [
        [0, 0, 0],
        [1, 0, 0],
        [1, 1, 0],
        [0, 1, 0],
        [0, 0, 1],
        [1, 0, 1],
        [1, 1, 1],
        [0, 1, 1],
    ];
    OFFSETS.map(|offset| {
        let [i, j, k] = [0, 1, 2].map(|axis| cube[axis] + offset[axis]);
        ((i * (counts[1] + 1) + j) * (counts[2] + 1) + k) as u32
    })
}

/// Six tetrahedra around the diagonal from corner 0 to corner 6.
fn kuhn(corners: [u32; 8]) -> [[u32; 4]; 6] {
    const TETRAHEDRA: [[usize; 4]; 6] = [
        [0, 1, 2, 6],
        [0, 2, 3, 6],
        [0, 3, 7, 6],
        [0, 7, 4, 6],
        [0, 4, 5, 6],
        [0, 5, 1, 6],
    ];
    TETRAHEDRA.map(|tet| tet.map(|corner| corners[corner]))
}

fn push_pyramids(draft: &mut Draft, corners: &[u32; 8]) {
    let top = middle_node(draft, corners);
    for face in Shape::Hex8.faces() {
        let mut pyramid: Vec<u32> = face.nodes.iter().map(|&c| corners[c as usize]).collect();
        // Seen from the middle the outward face runs clockwise, a base must run the other way.
        pyramid.reverse();
        pyramid.push(top);
        push(&mut draft.cells, Shape::Pyramid5, &pyramid, 0);
    }
}

/// All faces, inside or outside, with all corners on the patch; each once.
fn faces_within(cells: &Elements, inside: &[bool]) -> Vec<(Shape, Vec<u32>)> {
    let mut found = BTreeMap::new();
    for cell in 0..cells.len() {
        let nodes = cells.nodes_of(cell);
        for face in cells.shapes[cell].faces() {
            let corners: Vec<u32> = face
                .nodes
                .iter()
                .map(|&local| nodes[local as usize])
                .collect();
            if corners.iter().all(|&node| inside[node as usize]) {
                let mut key = corners.clone();
                key.sort_unstable();
                found.entry(key).or_insert((face.shape, corners));
            }
        }
    }
    found.into_values().collect()
}
