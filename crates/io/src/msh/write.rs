//! Writes meshes as MSH 4.1, text.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;

use kluft_mesh::{Defect, Draft, Shape, TaggedElements};

use crate::atomic::write_atomically;

/// Writes a mesh as MSH 4.1, to a temporary name beside `path`, then renames. The elements of one
/// set of groups are those of one entity.
///
/// # Errors
/// If the file cannot be written.
pub fn write_msh(path: &Path, draft: &Draft) -> Result<(), Defect> {
    write_atomically(path, |out| {
        writeln!(out, "$MeshFormat\n4.1 0 8\n$EndMeshFormat")?;
        names(draft, out)?;
        let blocks = blocks(draft);
        entities(draft, &blocks, out)?;
        nodes(draft, out)?;
        elements(draft, &blocks, out)
    })
}

/// Elements of one shape and one set of groups.
struct Block<'a> {
    dimension: usize,
    set: u32,
    shape: Shape,
    from: &'a TaggedElements,
    elements: Vec<usize>,
}

fn blocks(draft: &Draft) -> Vec<Block<'_>> {
    let kinds = [(1, &draft.lines), (2, &draft.facets), (3, &draft.cells)];
    let mut blocks = Vec::new();
    for (dimension, from) in kinds {
        let mut own: BTreeMap<(u32, i32), Vec<usize>> = BTreeMap::new();
        for (index, &shape) in from.elements.shapes.iter().enumerate() {
            let key = (from.group_set[index], gmsh_number(shape));
            own.entry(key).or_default().push(index);
        }
        blocks.extend(own.into_iter().map(|((set, _), elements)| Block {
            dimension,
            set,
            shape: from.elements.shapes[elements[0]],
            from,
            elements,
        }));
    }
    blocks
}

fn names(draft: &Draft, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "$PhysicalNames\n{}", draft.groups.len())?;
    for group in &draft.groups {
        let name = group.name.replace('"', "'");
        writeln!(out, "{} {} \"{name}\"", group.dimension, group.tag)?;
    }
    writeln!(out, "$EndPhysicalNames")
}

fn entities(draft: &Draft, blocks: &[Block<'_>], out: &mut impl Write) -> io::Result<()> {
    let mut all: Vec<(usize, u32)> = blocks.iter().map(|b| (b.dimension, b.set)).collect();
    all.dedup();
    let count = |dimension| all.iter().filter(|(of, _)| *of == dimension).count();
    writeln!(out, "$Entities\n0 {} {} {}", count(1), count(2), count(3))?;
    let ends = bounds(draft);
    for (dimension, set) in all {
        let groups = draft.group_sets[set as usize].iter();
        let groups = groups.filter(|group| draft.groups[**group].dimension == dimension);
        let tags: Vec<String> = groups
            .map(|group| draft.groups[*group].tag.to_string())
            .collect();
        let [low, high] = ends;
        writeln!(
            out,
            "{} {} {} {} {} {} {} {} {} 0",
            set + 1,
            low[0],
            low[1],
            low[2],
            high[0],
            high[1],
            high[2],
            tags.len(),
            tags.join(" ")
        )?;
    }
    writeln!(out, "$EndEntities")
}

fn bounds(draft: &Draft) -> [[f64; 3]; 2] {
    let start = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    draft.nodes.iter().fold(start, |[low, high], x| {
        [
            std::array::from_fn(|axis| low[axis].min(x[axis])),
            std::array::from_fn(|axis| high[axis].max(x[axis])),
        ]
    })
}

fn nodes(draft: &Draft, out: &mut impl Write) -> io::Result<()> {
    let count = draft.nodes.len();
    let tags = &draft.node_tags;
    let low = tags.iter().min().copied().unwrap_or(0);
    let high = tags.iter().max().copied().unwrap_or(0);
    // All of them belong to the first entity that there is.
    let (dimension, entity) = match blocks(draft).last() {
        Some(block) => (block.dimension, block.set + 1),
        None => (0, 0),
    };
    writeln!(
        out,
        "$Nodes\n1 {count} {low} {high}\n{dimension} {entity} 0 {count}"
    )?;
    for tag in tags {
        writeln!(out, "{tag}")?;
    }
    for [x, y, z] in &draft.nodes {
        // The shortest text that reads back to the same bits.
        writeln!(out, "{x:?} {y:?} {z:?}")?;
    }
    writeln!(out, "$EndNodes")
}

fn elements(draft: &Draft, blocks: &[Block<'_>], out: &mut impl Write) -> io::Result<()> {
    let count: usize = blocks.iter().map(|block| block.elements.len()).sum();
    writeln!(out, "$Elements\n{} {count} 1 {count}", blocks.len())?;
    let mut tag = 0;
    for block in blocks {
        let number = gmsh_number(block.shape);
        let (entity, own) = (block.set + 1, block.elements.len());
        writeln!(out, "{} {entity} {number} {own}", block.dimension)?;
        for &element in &block.elements {
            tag += 1;
            write!(out, "{tag}")?;
            for &node in block.from.elements.nodes_of(element) {
                write!(out, " {}", draft.node_tags[node as usize])?;
            }
            writeln!(out)?;
        }
    }
    writeln!(out, "$EndElements")
}

/// The number that gmsh gives a shape.
fn gmsh_number(shape: Shape) -> i32 {
    match shape {
        Shape::Line2 => 1,
        Shape::Line3 => 8,
        Shape::Tri3 => 2,
        Shape::Tri6 => 9,
        Shape::Quad4 => 3,
        Shape::Quad8 => 16,
        Shape::Quad9 => 10,
        Shape::Tet4 => 4,
        Shape::Tet10 => 11,
        Shape::Hex8 => 5,
        Shape::Hex20 => 17,
        Shape::Hex27 => 12,
        Shape::Prism6 => 6,
        Shape::Prism15 => 18,
        Shape::Prism18 => 13,
        Shape::Pyramid5 => 7,
        Shape::Pyramid13 => 19,
        Shape::Pyramid14 => 14,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::msh::{read_msh, shape_of_gmsh_element};
    use kluft_mesh::structured::cells_of;

    #[test]
    fn numbers_are_those_that_are_read() {
        let lines = [Shape::Line2, Shape::Line3];
        for shape in Shape::CELLS.into_iter().chain(Shape::FACETS).chain(lines) {
            assert_eq!(shape_of_gmsh_element(gmsh_number(shape)), Some(shape));
        }
    }

    #[test]
    fn what_is_written_is_read_again_bit_for_bit() {
        for shape in Shape::CELLS {
            let contains = |x: [f64; 3]| x[2] == 0.5;
            let patch = kluft_mesh::structured::Patch {
                name: "joint",
                contains: &contains,
            };
            let mut draft = cells_of(shape, [2, 1, 2], [1.0; 3], &[patch]);
            for (number, node) in draft.nodes.iter_mut().enumerate() {
                node[0] += 1e-3 * (number as f64).sin();
            }
            let folder = tempfile::tempdir().expect("a folder");
            let file = folder.path().join("mesh.msh");
            write_msh(&file, &draft).expect("written");
            let read = read_msh(&file).unwrap_or_else(|defects| panic!("{defects:?}"));
            assert_eq!(read.nodes, draft.nodes);
            assert_eq!(read.cells.elements.nodes, draft.cells.elements.nodes);
            assert_eq!(read.facets.elements.nodes, draft.facets.elements.nodes);
            let sizes = |draft: &Draft| {
                let facets = draft.group_sizes(&draft.facets);
                let cells = draft.group_sizes(&draft.cells);
                let named = draft.groups.iter().zip(facets.iter().zip(cells));
                let named = named.map(|(g, (f, c))| (g.dimension, g.name.clone(), f + c));
                let mut named: Vec<(usize, String, usize)> = named.collect();
                named.sort();
                named
            };
            assert_eq!(sizes(&read), sizes(&draft));
        }
    }
}
