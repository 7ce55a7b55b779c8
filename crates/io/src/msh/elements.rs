//! `$Elements`: the blocks, checked against the bytes that exist.

use kluft_mesh::Defect;
use mshio::ElementType;
use num_traits::FromPrimitive;

use super::cursor::{Cursor, ItemRange};
use super::entities::EntityKey;
use super::nodes::check_header;

/// One block: elements of one type on one entity.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Block {
    pub(super) entity: EntityKey,
    pub(super) kind: ElementType,
    pub(super) count: usize,
    /// Where its elements stand: a tag and the tags of the nodes each.
    pub(super) ranges: Vec<ItemRange>,
}

/// Walks the section to its end.
pub(super) fn walk(mut cursor: Cursor) -> Result<Vec<Block>, Defect> {
    let count = cursor.count("number of element blocks", 4)?;
    let total = cursor.count("number of elements", 2)?;
    check_header(&mut cursor, total, "element")?;
    let mut blocks = Vec::with_capacity(count);
    for _ in 0..count {
        blocks.push(walk_block(&mut cursor)?);
    }
    let found: usize = blocks.iter().map(|block: &Block| block.count).sum();
    if found != total {
        let problem = format!("the header promises {total} elements, there are {found}");
        return Err(cursor.defect(problem));
    }
    cursor.finish()?;
    Ok(blocks)
}

fn walk_block(cursor: &mut Cursor) -> Result<Block, Defect> {
    let dimension = cursor.int("dimension of an element block")?;
    let tag = cursor.int("entity of an element block")?;
    let number = cursor.int("element type")?;
    let dimension = usize::try_from(dimension).ok().filter(|&d| d <= 3);
    let Some(dimension) = dimension else {
        return Err(cursor.defect("the dimension of an element block is none of 0, 1, 2, 3"));
    };
    let Some((kind, nodes)) = type_of(number) else {
        return Err(unknown_type(cursor, number));
    };
    let count = cursor.count("number of elements in a block", 1 + nodes as u64)?;
    let ranges = cursor.ranges("node tag of an element", count, 1 + nodes)?;
    let entity = (dimension, tag);
    Ok(Block {
        entity,
        kind,
        count,
        ranges,
    })
}

/// The type of that number and how many nodes it has.
fn type_of(number: i32) -> Option<(ElementType, usize)> {
    let kind = ElementType::from_i32(number)?;
    match kind {
        // mshio holds this prism to have 28 nodes.
        ElementType::Pri18 => Some((kind, 18)),
        _ => kind.nodes().ok().map(|nodes| (kind, nodes)),
    }
}

fn unknown_type(cursor: &Cursor, number: i32) -> Defect {
    Defect {
        problem: format!("elements of gmsh type {number} cannot be read"),
        remedy:
            "mesh with tetrahedra, hexahedra, prisms or pyramids: no polygons, polyhedra or cut \
                 elements"
                .to_owned(),
        ..cursor.defect("")
    }
}
