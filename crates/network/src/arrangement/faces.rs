//! A surface split along the closed loops of its traces.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec2, DVec3};

use super::change::is_inside;
use super::sheet::{Plane, Sheet, edge, ring_area};

/// A part of a surface that no closed loop of traces divides.
#[derive(Debug, Clone, PartialEq)]
pub struct Face {
    /// The loop around it, and those around its holes, as points.
    pub rings: Vec<Vec<usize>>,
    /// Traces that end in it.
    pub traces: Vec<[usize; 2]>,
    /// Points in it on no edge.
    pub contacts: Vec<usize>,
}

impl Face {
    /// The whole of a surface as one face.
    pub fn whole(sheet: &Sheet) -> Self {
        Self {
            rings: vec![sheet.outline.clone()],
            traces: sheet.traces.iter().copied().collect(),
            contacts: sheet.contacts.iter().copied().collect(),
        }
    }

    /// Area without the holes (m^2), of points by their numbers.
    pub fn area(&self, plane: &Plane, points: &[DVec3]) -> f64 {
        let areas = self.rings.iter();
        areas.map(|ring| ring_area(plane, ring, points)).sum()
    }
}

/// The faces of a surface; one, if its traces close no loop.
pub fn faces(sheet: &Sheet, points: &[DVec3]) -> Vec<Face> {
    let flat: BTreeMap<usize, DVec2> = sheet
        .points()
        .into_iter()
        .map(|point| (point, sheet.plane.flat(points[point])))
        .collect();
    let (walks, loose) = closed_walks(sheet, &flat);
    let mut rooms: Vec<Room> = Vec::new();
    let mut holes = Vec::new();
    let rim: BTreeSet<[usize; 2]> = sheet.rim().map(|[a, b]| edge(a, b)).collect();
    for ring in walks {
        let area = ring_area(&sheet.plane, &ring, points);
        if area > 0.0 {
            rooms.push(Room::of(ring, area, &flat));
        } else if ring_edges(&ring).any(|ends| !rim.contains(&ends)) {
            holes.push(ring);
        }
    }
    match fill(&mut rooms, holes, loose, sheet, &flat) {
        Some(()) => rooms.into_iter().map(|room| room.face).collect(),
        // What rounding has put outside of everything stays with the whole.
        None => vec![Face::whole(sheet)],
    }
}

/// A face as it is found.
struct Room {
    face: Face,
    area: f64,
    outline: Vec<DVec2>,
}

impl Room {
    fn of(ring: Vec<usize>, area: f64, flat: &BTreeMap<usize, DVec2>) -> Self {
        Self {
            outline: ring.iter().map(|point| flat[point]).collect(),
            area,
            face: Face {
                rings: vec![ring],
                traces: Vec::new(),
                contacts: Vec::new(),
            },
        }
    }
}

/// Puts holes, traces and contacts into the smallest faces around them.
fn fill(
    rooms: &mut [Room],
    holes: Vec<Vec<usize>>,
    loose: BTreeSet<[usize; 2]>,
    sheet: &Sheet,
    flat: &BTreeMap<usize, DVec2>,
) -> Option<()> {
    for hole in holes {
        let room = smallest_around(rooms, flat[&hole[0]], &hole)?;
        rooms[room].face.rings.push(hole);
    }
    for [a, b] in loose {
        let room = smallest_around(rooms, flat[&a].midpoint(flat[&b]), &[])?;
        rooms[room].face.traces.push([a, b]);
    }
    for &contact in &sheet.contacts {
        let room = smallest_around(rooms, flat[&contact], &[])?;
        rooms[room].face.contacts.push(contact);
    }
    Some(())
}

/// The smallest face around a point, of those whose loop has none of some points.
fn smallest_around(rooms: &[Room], at: DVec2, without: &[usize]) -> Option<usize> {
    let around = (0..rooms.len()).filter(|&room| {
        let room = &rooms[room];
        let is_apart = || {
            let mut ring = room.face.rings[0].iter();
            !ring.any(|point| without.contains(point))
        };
        is_inside(&room.outline, at) && is_apart()
    });
    around.min_by(|&a, &b| rooms[a].area.total_cmp(&rooms[b].area))
}

fn ring_edges(ring: &[usize]) -> impl Iterator<Item = [usize; 2]> + '_ {
    let next = ring.iter().cycle().skip(1);
    ring.iter().zip(next).map(|(&a, &b)| edge(a, b))
}

/// Walks around all faces with the face on the left, and the edges that have one face on both
/// sides.
fn closed_walks(
    sheet: &Sheet,
    flat: &BTreeMap<usize, DVec2>,
) -> (Vec<Vec<usize>>, BTreeSet<[usize; 2]>) {
    let mut edges = sheet.edges();
    let mut loose = BTreeSet::new();
    loop {
        let walks = walks(&edges, flat);
        let mut sides: BTreeMap<[usize; 2], Vec<usize>> = BTreeMap::new();
        for (number, walk) in walks.iter().enumerate() {
            for ends in ring_edges(walk) {
                sides.entry(ends).or_default().push(number);
            }
        }
        let bridges: BTreeSet<[usize; 2]> = sides
            .into_iter()
            .filter(|(_, walks)| walks.windows(2).any(|pair| pair[0] == pair[1]))
            .map(|(ends, _)| ends)
            .collect();
        if bridges.is_empty() {
            return (walks, loose);
        }
        edges.retain(|ends| !bridges.contains(ends));
        loose.extend(bridges);
    }
}

fn walks(edges: &BTreeSet<[usize; 2]>, flat: &BTreeMap<usize, DVec2>) -> Vec<Vec<usize>> {
    let mut around: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for &[a, b] in edges {
        around.entry(a).or_default().push(b);
        around.entry(b).or_default().push(a);
    }
    for (point, others) in &mut around {
        let angle = |other: &usize| {
            let to = flat[other] - flat[point];
            libm::atan2(to.y, to.x)
        };
        others.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    }
    let mut done: BTreeSet<[usize; 2]> = BTreeSet::new();
    let mut walks = Vec::new();
    for start in edges.iter().flat_map(|&[a, b]| [[a, b], [b, a]]) {
        let mut walk = Vec::new();
        let mut step = start;
        while done.insert(step) {
            walk.push(step[0]);
            step = turn(&around, step);
        }
        if !walk.is_empty() {
            walks.push(walk);
        }
    }
    walks
}

/// The step after this one: the first edge clockwise from where it comes.
fn turn(around: &BTreeMap<usize, Vec<usize>>, [from, to]: [usize; 2]) -> [usize; 2] {
    let others = &around[&to];
    let place = others.iter().position(|&other| other == from).unwrap_or(0);
    [to, others[(place + others.len() - 1) % others.len()]]
}
