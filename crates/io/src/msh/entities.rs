//! `$Entities` and `$PartitionedEntities`: which physical groups each entity belongs to.
//!
//! Read here for both sections, because mshio knows only the first.

use std::collections::HashMap;

use kluft_mesh::Defect;

use super::cursor::Cursor;

/// An entity by its dimension (0 to 3) and its tag.
pub(super) type EntityKey = (usize, i32);

/// The physical tags of each entity that the file lists; never negative.
pub(super) type EntityGroups = HashMap<EntityKey, Vec<i32>>;

/// An entity by name, for messages: `surface 7`.
pub(super) fn entity_name((dimension, tag): EntityKey) -> String {
    let kind = ["point", "curve", "surface"]
        .get(dimension)
        .unwrap_or(&"volume");
    format!("{kind} {tag}")
}

/// Walks `$Entities`.
pub(super) fn walk_entities(mut cursor: Cursor, found: &mut EntityGroups) -> Result<(), Defect> {
    walk_all(&mut cursor, found, |_| Ok(()))?;
    cursor.finish()
}

/// Walks `$PartitionedEntities`, whose entities stand in for those they are parts of.
pub(super) fn walk_partitioned(mut cursor: Cursor, found: &mut EntityGroups) -> Result<(), Defect> {
    cursor.size("number of partitions")?;
    let ghosts = cursor.count("number of ghost entities", 2)?;
    skip_ints(&mut cursor, 2 * ghosts)?;
    walk_all(&mut cursor, found, skip_parent)?;
    cursor.finish()
}

/// What a partitioned entity has beyond an ordinary one, behind its tag.
fn skip_parent(cursor: &mut Cursor) -> Result<(), Defect> {
    skip_ints(cursor, 2)?;
    let partitions = cursor.count("number of partitions of an entity", 1)?;
    skip_ints(cursor, partitions)
}

fn walk_all(
    cursor: &mut Cursor,
    found: &mut EntityGroups,
    skip_parent: fn(&mut Cursor) -> Result<(), Defect>,
) -> Result<(), Defect> {
    let mut counts = [0; 4];
    for count in &mut counts {
        *count = cursor.count("number of entities", 5)?;
    }
    for (dimension, &count) in counts.iter().enumerate() {
        for _ in 0..count {
            let tag = cursor.int("entity tag")?;
            skip_parent(cursor)?;
            let groups = walk_one(cursor, dimension)?;
            found.entry((dimension, tag)).or_default().extend(groups);
        }
    }
    Ok(())
}

/// The rest of one entity: its box (a point: its place), its physical tags, its boundary.
fn walk_one(cursor: &mut Cursor, dimension: usize) -> Result<Vec<i32>, Defect> {
    for _ in 0..if dimension == 0 { 3 } else { 6 } {
        cursor.double("bound of an entity")?;
    }
    let count = cursor.count("number of physical tags", 1)?;
    // A negative tag means the group sees the entity reversed; membership is the same.
    let groups: Result<Vec<i32>, Defect> = (0..count)
        .map(|_| cursor.int("physical tag").map(i32::saturating_abs))
        .collect();
    if dimension > 0 {
        let boundary = cursor.count("number of bounding entities", 1)?;
        skip_ints(cursor, boundary)?;
    }
    groups
}

fn skip_ints(cursor: &mut Cursor, count: usize) -> Result<(), Defect> {
    (0..count).try_for_each(|_| cursor.int("entity tag").map(drop))
}
