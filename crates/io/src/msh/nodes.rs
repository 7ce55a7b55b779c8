//! `$Nodes`: the tags in file order, which mshio throws away when it takes them for dense.

use std::collections::HashSet;

use kluft_mesh::{Defect, sample};

use super::cursor::Cursor;
use super::source::MshSource;

/// What the walk over `$Nodes` has found; all counts agree with the bytes of the section.
#[derive(Debug, Default)]
pub(super) struct NodeSurvey {
    /// Tags in file order.
    pub(super) tags: Vec<u64>,
    /// Tags of nodes with a coordinate that is infinite or not a number.
    pub(super) not_finite: Vec<u64>,
    /// Whether there are blocks with parametric coordinates, which mshio refuses.
    pub(super) parametric: bool,
}

/// Walks the section to its end.
pub(super) fn walk(mut cursor: Cursor) -> Result<NodeSurvey, Defect> {
    let blocks = cursor.count("number of node blocks", 4)?;
    let total = cursor.count("number of nodes", 4)?;
    check_header(&mut cursor, total, "node")?;
    let mut survey = NodeSurvey::default();
    for _ in 0..blocks {
        walk_block(&mut cursor, &mut survey)?;
    }
    if survey.tags.len() != total {
        let problem = format!(
            "the header promises {total} nodes, there are {}",
            survey.tags.len()
        );
        return Err(cursor.defect(problem));
    }
    cursor.finish()?;
    Ok(survey)
}

/// The rest of the head of `$Nodes` or `$Elements`; mshio subtracts these numbers unchecked.
pub(super) fn check_header(cursor: &mut Cursor, total: usize, what: &str) -> Result<(), Defect> {
    let smallest = cursor.size("smallest tag")?;
    let largest = cursor.size("largest tag")?;
    if total == 0 {
        return Err(cursor.defect(format!("the file holds no {what}")));
    }
    if smallest == 0 || largest < smallest {
        return Err(cursor.defect(format!(
            "{what} tags cannot run from {smallest} to {largest}"
        )));
    }
    Ok(())
}

fn walk_block(cursor: &mut Cursor, survey: &mut NodeSurvey) -> Result<(), Defect> {
    let dimension = cursor.int("dimension of a node block")?;
    cursor.int("entity of a node block")?;
    let parametric = cursor.int("parametric flag")?;
    if !(0..=3).contains(&dimension) || !(0..=1).contains(&parametric) {
        let problem = format!("a block of dimension {dimension}, parametric flag {parametric}");
        return Err(cursor.defect(problem));
    }
    survey.parametric |= parametric == 1;
    let count = cursor.count("number of nodes in a block", 4)?;
    let first = survey.tags.len();
    for _ in 0..count {
        survey.tags.push(cursor.size("node tag")?);
    }
    for index in first..first + count {
        if !walk_node(cursor, parametric * dimension)? {
            survey.not_finite.push(survey.tags[index]);
        }
    }
    Ok(())
}

/// Steps over the coordinates of a node and answers whether they are finite.
fn walk_node(cursor: &mut Cursor, parameters: i32) -> Result<bool, Defect> {
    let mut finite = true;
    for _ in 0..3 {
        finite &= cursor.double("coordinate")?.is_finite();
    }
    for _ in 0..parameters {
        cursor.double("parametric coordinate")?;
    }
    Ok(finite)
}

/// Everything about the nodes that a file must not have.
pub(super) fn defects(source: MshSource, survey: &NodeSurvey) -> Vec<Defect> {
    let mut found = Vec::new();
    if survey.parametric {
        let remedy = "write it again without them: Mesh.SaveParametric = 0";
        found.push(source.defect("the nodes have parametric coordinates", remedy));
    }
    if !survey.not_finite.is_empty() {
        let place = format!("{}, nodes {}", source.name, sample(&survey.not_finite));
        let problem = "a coordinate is infinite or not a number";
        found.push(Defect::new(
            place,
            problem,
            "correct the geometry and mesh again",
        ));
    }
    if survey.tags.contains(&0) {
        let remedy = "number the nodes from 1: open and save the file with gmsh";
        found.push(source.defect("a node has the tag 0, which the format reserves", remedy));
    }
    let repeated = repeated(&survey.tags);
    if !repeated.is_empty() {
        let place = format!("{}, nodes {}", source.name, sample(&repeated));
        let remedy = "give every node its own tag: the file was merged or edited wrongly";
        found.push(Defect::new(
            place,
            "the tag stands for more than one node",
            remedy,
        ));
    }
    found
}

/// Tags that occur more than once, ascending.
fn repeated(tags: &[u64]) -> Vec<u64> {
    // By far most files list most tags in ascending order: no need to look them up.
    if tags.is_sorted_by(|a, b| a < b) {
        return Vec::new();
    }
    let mut seen = HashSet::with_capacity(tags.len());
    let mut twice: Vec<u64> = tags
        .iter()
        .copied()
        .filter(|&tag| !seen.insert(tag))
        .collect();
    twice.sort_unstable();
    twice.dedup();
    twice
}
