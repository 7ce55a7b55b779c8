//! Volumes that lie in one another without sharing faces.

use glam::DVec3;
use rayon::prelude::*;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use crate::disjoint_sets::DisjointSets;
use crate::draft::Elements;
use crate::facets::Facets;
use crate::geometry::{corners, facet_area_vector, facet_centre};

/// A box with the number of what it is around.
type Numbered = GeomWithData<Rectangle<[f64; 3]>, u32>;

/// Cells whose centre lies in a cell of another part of the body, ascending. Parts hang together by
/// faces, across fractures too; `block` has the block of each cell, of `count`.
pub(crate) fn cells_in_others(
    (cells, nodes): (&Elements, &[DVec3]),
    (block, count): (&[u32], usize),
    facets: &Facets,
) -> Vec<u32> {
    let part = part_of_blocks(block, count, facets);
    if part.iter().all(|part| *part == 0) {
        return Vec::new();
    }
    let part_of = |cell: u32| part[block[cell as usize] as usize];
    let mut bounds = vec![[DVec3::INFINITY, DVec3::NEG_INFINITY]; count];
    for cell in 0..cells.len() as u32 {
        let ([low, high], around) = (
            &mut bounds[part_of(cell) as usize],
            bounds_of(cells, nodes, cell),
        );
        (*low, *high) = (low.min(around[0]), high.max(around[1]));
    }
    let parts = (0..count as u32).filter(|&own| part[own as usize] == own);
    let parts = RTree::bulk_load(
        parts
            .map(|own| numbered(bounds[own as usize], own))
            .collect(),
    );
    let near_others = (0..cells.len() as u32).into_par_iter().filter_map(|cell| {
        let around = bounds_of(cells, nodes, cell);
        let [low, high] = around.map(|at| at.to_array());
        let mut near = parts.locate_in_envelope_intersecting(&AABB::from_corners(low, high));
        let is_near = near.any(|found: &Numbered| found.data != part_of(cell));
        is_near.then(|| numbered(around, cell))
    });
    let near_others: Vec<Numbered> = near_others.collect();
    let candidates: Vec<u32> = near_others.iter().map(|found| found.data).collect();
    let tree = RTree::bulk_load(near_others);
    let is_in_another = |&cell: &u32| {
        let centre = facet_centre(&corners(cells, cell as usize, nodes));
        let mut found = tree.locate_all_at_point(&centre.to_array());
        found.any(|other| {
            part_of(other.data) != part_of(cell) && holds((cells, nodes), other.data, centre)
        })
    };
    candidates.into_par_iter().filter(is_in_another).collect()
}

/// The part of the body that each block belongs to, by its lowest block.
fn part_of_blocks(block: &[u32], count: usize, facets: &Facets) -> Vec<u32> {
    let mut parts = DisjointSets::new(count);
    for (&minus, &plus) in facets.minus.iter().zip(&facets.plus) {
        parts.join(block[minus as usize], block[plus as usize]);
    }
    (0..count as u32).map(|block| parts.root(block)).collect()
}

/// Lowest and highest coordinates of the nodes of a cell (m).
fn bounds_of(cells: &Elements, nodes: &[DVec3], cell: u32) -> [DVec3; 2] {
    let own = cells.nodes_of(cell as usize).iter();
    let places = own.map(|&node| nodes[node as usize]);
    places.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], at| {
        [low.min(at), high.max(at)]
    })
}

fn numbered([low, high]: [DVec3; 2], number: u32) -> Numbered {
    let around = Rectangle::from_corners(low.to_array(), high.to_array());
    GeomWithData::new(around, number)
}

/// Whether a position (m) lies in a cell, behind all its faces: a cell that touches it has it on
/// one of them.
fn holds((cells, nodes): (&Elements, &[DVec3]), cell: u32, at: DVec3) -> bool {
    let own = corners(cells, cell as usize, nodes);
    let faces = cells.shapes[cell as usize].faces().iter();
    let mut distances = faces.map(|face| {
        let face: Vec<DVec3> = face
            .corners()
            .iter()
            .map(|&local| own[local as usize])
            .collect();
        (at - facet_centre(&face)).dot(facet_area_vector(&face))
    });
    distances.all(|distance| distance < 0.0)
}
