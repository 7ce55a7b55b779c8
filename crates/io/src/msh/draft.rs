//! From mshio's data and the guard's survey to a [`Draft`].

use std::collections::BTreeMap;

use kluft_mesh::{Defect, Draft, Elements, Shape, TaggedElements, sample};
use mshio::ElementType;
use num_traits::FromPrimitive;
use rayon::prelude::*;

use super::cursor::ItemRange;
use super::elements::Block;
use super::entities::{EntityKey, entity_name};
use super::groups::Groups;
use super::guard::{FileSurvey, keep};
use super::source::Encoding;
use super::tags::TagIndex;
use super::{mshio_calls, nodes};

/// The shapes that can be solved on.
fn shape_of(kind: ElementType) -> Option<Shape> {
    match kind {
        ElementType::Lin2 => Some(Shape::Line2),
        ElementType::Lin3 => Some(Shape::Line3),
        ElementType::Tri3 => Some(Shape::Tri3),
        ElementType::Tri6 => Some(Shape::Tri6),
        ElementType::Qua4 => Some(Shape::Quad4),
        ElementType::Qua8 => Some(Shape::Quad8),
        ElementType::Qua9 => Some(Shape::Quad9),
        ElementType::Tet4 => Some(Shape::Tet4),
        ElementType::Tet10 => Some(Shape::Tet10),
        ElementType::Hex8 => Some(Shape::Hex8),
        ElementType::Hex20 => Some(Shape::Hex20),
        ElementType::Hex27 => Some(Shape::Hex27),
        ElementType::Pri6 => Some(Shape::Prism6),
        ElementType::Pri15 => Some(Shape::Prism15),
        ElementType::Pri18 => Some(Shape::Prism18),
        ElementType::Pyr5 => Some(Shape::Pyramid5),
        ElementType::Pyr13 => Some(Shape::Pyramid13),
        ElementType::Pyr14 => Some(Shape::Pyramid14),
        _ => None,
    }
}

/// The shape of an element of a number that gmsh gives its types, if it can be solved on.
pub fn shape_of_gmsh_element(number: i32) -> Option<Shape> {
    ElementType::from_i32(number).and_then(shape_of)
}

/// Builds the draft, or lists everything that stands against it.
pub(super) fn build(mut survey: FileSurvey) -> Result<Draft, Vec<Defect>> {
    let groups = Groups::new(survey.names.clone(), &survey.entities);
    let mut defects = nodes::defects(survey.source, &survey.nodes);
    defects.extend(too_large(&survey));
    defects.extend(unknown_entities(&survey));
    defects.extend(unsupported_elements(&survey, &groups));
    let mut draft = Draft {
        source: survey.source.name.to_owned(),
        cells: TaggedElements::new(),
        facets: TaggedElements::new(),
        lines: TaggedElements::new(),
        ..Draft::default()
    };
    let (nodes, elements) = rayon::join(
        || survey.nodes_are_readable().then(|| coordinates(&survey)),
        || fill_elements(&survey, groups, &mut draft),
    );
    let nodes = nodes.and_then(|nodes| keep(&mut defects, nodes));
    keep(&mut defects, elements);
    draft.nodes = nodes.unwrap_or_default();
    draft.node_tags = std::mem::take(&mut survey.nodes.tags);
    if defects.is_empty() {
        draft.name_curves();
        if has_cells(&survey) {
            draft.lines = TaggedElements::new();
        }
        Ok(draft)
    } else {
        Err(defects)
    }
}

fn coordinates(survey: &FileSurvey) -> Result<Vec<[f64; 3]>, Defect> {
    let parsed = mshio_calls::nodes(survey.source, survey.encoding, survey.nodes_body)?;
    let nodes = parsed.node_blocks.iter().flat_map(|block| &block.nodes);
    let nodes: Vec<[f64; 3]> = nodes.map(|node| [node.x, node.y, node.z]).collect();
    if nodes.len() != survey.nodes.tags.len() {
        return Err(disagreement(survey, "nodes"));
    }
    Ok(nodes)
}

fn fill_elements(survey: &FileSurvey, mut groups: Groups, draft: &mut Draft) -> Result<(), Defect> {
    let index = TagIndex::new(&survey.nodes.tags);
    make_room(survey, &mut groups, draft);
    let found: Vec<Result<Dangling, Defect>> = readings(survey, draft)
        .into_par_iter()
        .map(|reading| reading.run(survey, &index))
        .collect();
    draft.groups = groups.groups;
    draft.group_sets = groups.sets;
    let mut dangling = Dangling::default();
    for found in found {
        let mut found = found?;
        dangling.elements.append(&mut found.elements);
        dangling.nodes.append(&mut found.nodes);
    }
    dangling.check(survey.source.name)
}

/// Shapes and groups of all elements; nodes and tags remain 0.
fn make_room(survey: &FileSurvey, groups: &mut Groups, draft: &mut Draft) {
    let (mut cells, mut facets, mut lines) = (Vec::new(), Vec::new(), Vec::new());
    for block in &survey.blocks {
        let targets = Targets {
            cells: (&mut cells, &mut draft.cells.group_set),
            facets: (&mut facets, &mut draft.facets.group_set),
            lines: (&mut lines, &mut draft.lines.group_set),
        };
        if let Some(((blocks, sets), shape)) = target_of(block, targets) {
            let set = groups.set_of(block.entity, &survey.entities);
            blocks.push((shape, block.count));
            sets.resize(sets.len() + block.count, set);
        }
    }
    for (elements, blocks) in [
        (&mut draft.cells, cells),
        (&mut draft.facets, facets),
        (&mut draft.lines, lines),
    ] {
        elements.elements = Elements::blank(&blocks);
        elements.tags = vec![0; elements.elements.len()];
    }
}

/// Where elements belong.
struct Targets<T> {
    cells: T,
    facets: T,
    lines: T,
}

fn has_cells(survey: &FileSurvey) -> bool {
    survey.blocks.iter().any(|block| block.entity.0 == 3)
}

/// Where the elements of a block belong, if anywhere, and their shape.
fn target_of<T>(block: &Block, targets: Targets<T>) -> Option<(T, Shape)> {
    let shape = shape_of(block.kind)?;
    let target = match block.entity.0 {
        3 => Some(targets.cells),
        2 => Some(targets.facets),
        1 => Some(targets.lines),
        _ => None,
    };
    target.map(|target| (target, shape))
}

/// A range of a block, and where its elements go.
struct Reading<'a> {
    kind: ElementType,
    range: &'a ItemRange,
    tags: &'a mut [u64],
    nodes: &'a mut [u32],
}

/// Everything there is to read, in the order of the file.
fn readings<'a>(survey: &'a FileSurvey, draft: &'a mut Draft) -> Vec<Reading<'a>> {
    let room = |of: &'a mut TaggedElements| (&mut of.tags[..], &mut of.elements.nodes[..]);
    let (mut cells, mut facets) = (room(&mut draft.cells), room(&mut draft.facets));
    let mut lines = room(&mut draft.lines);
    let mut readings = Vec::new();
    for block in &survey.blocks {
        let targets = Targets {
            cells: &mut cells,
            facets: &mut facets,
            lines: &mut lines,
        };
        let Some((rest, shape)) = target_of(block, targets) else {
            continue;
        };
        for range in &block.ranges {
            let (tags, nodes) = std::mem::take(rest);
            let (tags, tags_left) = tags.split_at_mut(range.count);
            let (nodes, nodes_left) = nodes.split_at_mut(range.count * shape.node_count());
            *rest = (tags_left, nodes_left);
            readings.push(Reading {
                kind: block.kind,
                range,
                tags,
                nodes,
            });
        }
    }
    readings
}

impl Reading<'_> {
    fn run(self, survey: &FileSurvey, index: &TagIndex) -> Result<Dangling, Defect> {
        match survey.encoding {
            Encoding::Text => self.text(survey, index),
            Encoding::LittleEndian => self.binary(survey, index, u64::from_le_bytes),
            Encoding::BigEndian => self.binary(survey, index, u64::from_be_bytes),
        }
    }

    fn text(self, survey: &FileSurvey, index: &TagIndex) -> Result<Dangling, Defect> {
        let elements = mshio_calls::elements(survey.source, self.kind, self.range)?;
        let elements = elements.iter();
        Ok(self.fill(
            index,
            elements.map(|element| (element.element_tag, element.nodes.iter().copied())),
        ))
    }

    /// Each element is a row of numbers of one width: nothing that mshio would have to parse, and
    /// its vector for each element takes far longer than the numbers.
    fn binary(
        self,
        survey: &FileSurvey,
        index: &TagIndex,
        number: impl Fn([u8; 8]) -> u64,
    ) -> Result<Dangling, Defect> {
        let (numbers, rest) = survey.source.bytes[self.range.bytes.clone()].as_chunks();
        if !rest.is_empty() || numbers.len() != self.tags.len() + self.nodes.len() {
            return Err(disagreement(survey, "element nodes"));
        }
        let width = numbers.len() / self.range.count;
        let rows = numbers.chunks_exact(width);
        Ok(self.fill(
            index,
            rows.map(|row| (number(row[0]), row[1..].iter().map(|&bytes| number(bytes)))),
        ))
    }

    /// Puts elements, each a tag and the tags of its nodes, into their places.
    fn fill<N: Iterator<Item = u64>>(
        self,
        index: &TagIndex,
        elements: impl Iterator<Item = (u64, N)>,
    ) -> Dangling {
        let mut dangling = Dangling::default();
        let width = self.nodes.len() / self.range.count;
        let places = self.tags.iter_mut().zip(self.nodes.chunks_exact_mut(width));
        for ((element, node_tags), (tag, nodes)) in elements.zip(places) {
            *tag = element;
            let missing = dangling.nodes.len();
            for (place, tag) in nodes.iter_mut().zip(node_tags) {
                match index.get(tag) {
                    Some(node) => *place = node,
                    None => dangling.nodes.push(tag),
                }
            }
            if dangling.nodes.len() > missing {
                dangling.elements.push(*tag);
            }
        }
        dangling
    }
}

/// Elements whose nodes the file does not hold.
#[derive(Default)]
struct Dangling {
    elements: Vec<u64>,
    nodes: Vec<u64>,
}

impl Dangling {
    fn check(mut self, source: &str) -> Result<(), Defect> {
        if self.elements.is_empty() {
            return Ok(());
        }
        self.nodes.sort_unstable();
        self.nodes.dedup();
        Err(Defect::new(
            format!("{source}, elements {}", sample(&self.elements)),
            format!(
                "they refer to nodes that are not there: {}",
                sample(&self.nodes)
            ),
            "the file was cut or edited wrongly: write it again with gmsh",
        ))
    }
}

/// Node indices and the flat lists of element nodes are 32 bits wide.
fn too_large(survey: &FileSurvey) -> Option<Defect> {
    const LIMIT: usize = u32::MAX as usize;
    let width = |block: &Block| shape_of(block.kind).map_or(0, Shape::node_count);
    let element_nodes: usize = survey.blocks.iter().map(|b| b.count * width(b)).sum();
    (survey.nodes.tags.len() >= LIMIT || element_nodes >= LIMIT).then(|| {
        let remedy = "mesh more coarsely";
        survey
            .source
            .defect("the mesh is too large for 32-bit indices", remedy)
    })
}

/// Elements of an entity that is not listed would silently lose their groups.
fn unknown_entities(survey: &FileSurvey) -> Option<Defect> {
    let listed = |key: &EntityKey| survey.entities.contains_key(key);
    let has_any = |dimension| survey.entities.keys().any(|key| key.0 == dimension);
    let (surfaces, volumes) = (has_any(2), has_any(3));
    let expected = |key: &EntityKey| (key.0 == 2 && surfaces) || (key.0 == 3 && volumes);
    let entities = survey.blocks.iter().map(|block| block.entity);
    let unknown = entities.filter(|key| expected(key) && !listed(key));
    let names: Vec<String> = unknown.map(entity_name).collect();
    let first = names[..names.len().min(5)].join(", ");
    (!names.is_empty()).then(|| {
        Defect::new(
            format!("{}, {first}", survey.source.name),
            format!(
                "{} entities have elements but are not listed in $Entities",
                names.len()
            ),
            "open the file in gmsh and save it again as MSH 4.1",
        )
    })
}

/// One defect for each element type of dimension 2 or 3 that has no shape here, or lies on an
/// entity of another dimension.
fn unsupported_elements(survey: &FileSurvey, groups: &Groups) -> Vec<Defect> {
    let mut by_kind: BTreeMap<i32, Vec<&Block>> = BTreeMap::new();
    let solid = |block: &&Block| block.entity.0 >= 1 && block.count > 0;
    let fits = |block: &Block| match shape_of(block.kind) {
        Some(shape) => shape.dimension() == block.entity.0,
        // Lines of any order may bound surfaces.
        None => block.entity.0 == 1,
    };
    for block in survey
        .blocks
        .iter()
        .filter(solid)
        .filter(|block| !fits(block))
    {
        by_kind.entry(block.kind as i32).or_default().push(block);
    }
    by_kind
        .values()
        .map(|blocks| unsupported(survey, groups, blocks))
        .collect()
}

fn unsupported(survey: &FileSurvey, groups: &Groups, blocks: &[&Block]) -> Defect {
    const SHOWN: usize = 5;
    let mut places: Vec<String> = blocks
        .iter()
        .map(|block| groups.describe(block.entity, &survey.entities))
        .collect();
    places.dedup();
    places.truncate(SHOWN);
    let count: usize = blocks.iter().map(|block| block.count).sum();
    let kind = blocks[0].kind;
    Defect::new(
        format!("{}, {}", survey.source.name, places.join(", ")),
        format!(
            "{count} elements are of gmsh type {} ({kind:?}), which cannot be used here",
            kind as i32
        ),
        "mesh with tetrahedra, hexahedra, prisms or pyramids of first or second order: \
         Mesh.ElementOrder = 1 or 2",
    )
}

fn disagreement(survey: &FileSurvey, what: &str) -> Defect {
    survey.source.defect(
        format!("there is another number of {what} than the file says"),
        "open the file in gmsh and save it again as MSH 4.1",
    )
}
