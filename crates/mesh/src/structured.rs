//! Small structured drafts for tests, examples and benchmarks.

use crate::draft::{Draft, Elements, Group, TaggedElements};
use crate::shape::Shape;

/// A plane piece of fracture on grid planes: all triangles whose corners satisfy `contains`.
pub struct Patch<'a> {
    /// Name of the physical surface.
    pub name: &'a str,
    /// Whether a point belongs to the patch. All corners of a facet must.
    pub contains: &'a dyn Fn([f64; 3]) -> bool,
}

/// A box `[0, size]` of `counts` cubes, six tetrahedra each (Kuhn), so that the planes of the grid
/// are meshed conformingly; `patches` become physical surfaces, also on the outside. One volume,
/// `rock`.
pub fn tetrahedra(counts: [usize; 3], size: [f64; 3], patches: &[Patch<'_>]) -> Draft {
    let mut draft = Draft {
        source: "structured box".into(),
        nodes: grid(counts, size),
        groups: vec![group(3, 1, "rock")],
        group_sets: vec![vec![0]],
        cells: TaggedElements::new(),
        facets: TaggedElements::new(),
        ..Draft::default()
    };
    draft.node_tags = (1..=draft.nodes.len() as u64).collect();
    for cube in cubes(counts) {
        for tet in kuhn(cube, counts) {
            push(&mut draft.cells, Shape::Tet4, &tet, 0);
        }
    }
    for (index, patch) in patches.iter().enumerate() {
        draft.groups.push(group(2, index as i32 + 1, patch.name));
        draft.group_sets.push(vec![index + 1]);
        let inside: Vec<bool> = draft.nodes.iter().map(|&x| (patch.contains)(x)).collect();
        for facet in faces_within(&draft.cells.elements, &inside) {
            push(&mut draft.facets, Shape::Tri3, &facet, index as u32 + 1);
        }
    }
    draft
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

/// The six tetrahedra of a cube around its main diagonal, positively oriented.
fn kuhn(cube: [usize; 3], counts: [usize; 3]) -> [[u32; 4]; 6] {
    const PATHS: [[usize; 3]; 6] = [
        [0, 1, 2],
        [1, 2, 0],
        [2, 0, 1],
        [0, 2, 1],
        [2, 1, 0],
        [1, 0, 2],
    ];
    let number =
        |at: [usize; 3]| ((at[0] * (counts[1] + 1) + at[1]) * (counts[2] + 1) + at[2]) as u32;
    PATHS.map(|path| {
        let mut at = cube;
        let mut tet = [number(at); 4];
        for (step, axis) in path.into_iter().enumerate() {
            at[axis] += 1;
            tet[step + 1] = number(at);
        }
        let odd = matches!(path, [0, 2, 1] | [2, 1, 0] | [1, 0, 2]);
        if odd {
            tet.swap(2, 3);
        }
        tet
    })
}

fn faces_within(cells: &Elements, inside: &[bool]) -> Vec<[u32; 3]> {
    let mut found = std::collections::BTreeMap::new();
    for cell in 0..cells.len() {
        let nodes = cells.nodes_of(cell);
        for face in cells.shapes[cell].faces() {
            let corners = [0, 1, 2].map(|i| nodes[face.nodes[i] as usize]);
            if corners.iter().all(|&node| inside[node as usize]) {
                let mut key = corners;
                key.sort_unstable();
                found.entry(key).or_insert(corners);
            }
        }
    }
    found.into_values().collect()
}
