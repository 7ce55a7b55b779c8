//! Checks a file before mshio sees it.
//!
//! mshio trusts the counts of a file: it would panic on some and reserve absurd memory for others.
//! It also drops node tags, physical names and partitioned entities. So all sections that matter
//! are walked here first, number by number.

use kluft_mesh::{Defect, Group};

use super::cursor::Cursor;
use super::elements::{self, Block};
use super::entities::{EntityGroups, walk_entities, walk_partitioned};
use super::names;
use super::nodes::{self, NodeSurvey};
use super::sections::{MshSection, optional, required, split};
use super::source::{Encoding, MshSource};

/// What the walk has found. All counts agree with the bytes of the file.
pub(super) struct FileSurvey<'a> {
    pub(super) source: MshSource<'a>,
    pub(super) encoding: Encoding,
    pub(super) names: Vec<Group>,
    pub(super) entities: EntityGroups,
    pub(super) nodes: NodeSurvey,
    pub(super) blocks: Vec<Block>,
    /// Body of `$Nodes`.
    pub(super) nodes_body: &'a [u8],
}

impl FileSurvey<'_> {
    /// Whether mshio reads the coordinates as they stand.
    pub(super) fn nodes_are_readable(&self) -> bool {
        !self.nodes.parametric && self.nodes.not_finite.is_empty()
    }
}

/// Walks the sections that matter. A section that is damaged gives one defect.
pub(super) fn survey(
    source: MshSource<'_>,
    encoding: Encoding,
) -> Result<FileSurvey<'_>, Vec<Defect>> {
    let sections = split(source).map_err(|defect| vec![defect])?;
    let mut defects = Vec::new();
    let names = keep(&mut defects, physical_names(source, &sections));
    let entities = keep(&mut defects, entity_groups(source, encoding, &sections));
    let nodes_at = keep(&mut defects, required(source, &sections, "Nodes"));
    let elements_at = keep(&mut defects, required(source, &sections, "Elements"));
    let cursor = |at: &MshSection| Cursor::new(source, encoding, at.body.clone());
    let nodes = nodes_at.and_then(|at| keep(&mut defects, nodes::walk(cursor(at))));
    let blocks = elements_at.and_then(|at| keep(&mut defects, elements::walk(cursor(at))));
    let (Some(names), Some(entities), Some(nodes), Some(blocks)) = (names, entities, nodes, blocks)
    else {
        return Err(defects);
    };
    let body = |at: Option<&MshSection>| at.map_or(&[][..], |at| &source.bytes[at.body.clone()]);
    Ok(FileSurvey {
        source,
        encoding,
        names,
        entities,
        nodes,
        blocks,
        nodes_body: body(nodes_at),
    })
}

/// Whether the file holds elements of a dimension; looks at nothing else.
pub(super) fn holds_elements(
    source: MshSource,
    encoding: Encoding,
    dimension: usize,
) -> Result<bool, Defect> {
    let sections = split(source)?;
    let body = required(source, &sections, "Elements")?.body.clone();
    let blocks = elements::walk(Cursor::new(source, encoding, body))?;
    Ok(blocks
        .iter()
        .any(|block| block.entity.0 == dimension && block.count > 0))
}

/// Puts a defect aside.
pub(super) fn keep<T>(defects: &mut Vec<Defect>, result: Result<T, Defect>) -> Option<T> {
    result.map_err(|defect| defects.push(defect)).ok()
}

fn physical_names(source: MshSource, sections: &[MshSection]) -> Result<Vec<Group>, Defect> {
    match optional(sections, "PhysicalNames") {
        None => Ok(Vec::new()),
        Some(MshSection { body, .. }) => {
            names::read(source, &source.bytes[body.clone()], body.start)
        }
    }
}

fn entity_groups(
    source: MshSource,
    encoding: Encoding,
    sections: &[MshSection],
) -> Result<EntityGroups, Defect> {
    let mut found = EntityGroups::new();
    let cursor = |at: &MshSection| Cursor::new(source, encoding, at.body.clone());
    if let Some(at) = optional(sections, "Entities") {
        walk_entities(cursor(at), &mut found)?;
    }
    if let Some(at) = optional(sections, "PartitionedEntities") {
        walk_partitioned(cursor(at), &mut found)?;
    }
    Ok(found)
}
