//! Removes what is far smaller than the cells from an arrangement: short edges lose one of their
//! points, and points close to an edge move onto it.
//!
//! A point stays in all its planes, so that it moves along a trace or within a fracture and those
//! where three planes meet stay. So outlines change, and planes never do.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;

use super::arrange::Arrangement;
use super::change::Change;
use super::place::on_all;
use super::sheet::{Sheet, edge};
use crate::clip::FACES;

/// What is collapsed may leave something else small; more rounds have not been seen to help.
const ROUNDS: usize = 4;

/// A point moves at most by this many times the length below which edges are too short.
const FARTHEST: f64 = 2.0;

/// Edges that come closer than this part of that length are taken to cross.
const CLEAR: f64 = 1e-5;

/// A point of a surface that has been moved.
#[derive(Debug, Clone, PartialEq)]
pub struct Moved {
    /// The surface whose outline it is on.
    pub sheet: usize,
    /// How far it was moved (m).
    pub by: f64,
    /// Other surfaces that it is on now.
    pub onto: Vec<usize>,
}

/// Collapses edges shorter than `short` (m), and gaps as narrow between points and edges of one
/// surface; planes are kept within `tolerance` (m).
pub fn collapse(arrangement: &mut Arrangement, short: f64, tolerance: f64) -> Vec<Moved> {
    let mut on = vec![BTreeSet::new(); arrangement.points.len()];
    for (number, sheet) in arrangement.sheets.iter().enumerate() {
        for point in sheet.points() {
            on[point].insert(number);
        }
    }
    let mut collapsing = Collapsing {
        near: neighbours(arrangement, FARTHEST * short),
        arrangement,
        on,
        short,
        tolerance,
        moved: Vec::new(),
    };
    for _ in 0..ROUNDS {
        let shortened = collapsing.short_edges();
        let closed = collapsing.narrow_gaps();
        if !(shortened || closed) {
            break;
        }
    }
    collapsing.moved
}

struct Collapsing<'a> {
    arrangement: &'a mut Arrangement,
    /// The surfaces that each point is on.
    on: Vec<BTreeSet<usize>>,
    /// The fractures close to each.
    near: Vec<Vec<usize>>,
    short: f64,
    tolerance: f64,
    moved: Vec<Moved>,
}

impl Collapsing<'_> {
    fn at(&self, point: usize) -> DVec3 {
        self.arrangement.points[point]
    }

    fn length(&self, [a, b]: [usize; 2]) -> f64 {
        self.at(a).distance(self.at(b))
    }

    /// The surfaces that an edge is in.
    fn sheets_with(&self, ends: [usize; 2]) -> Vec<usize> {
        let both = self.on[ends[0]].intersection(&self.on[ends[1]]);
        let has_it = |number: &&usize| self.arrangement.sheets[**number].has_edge(ends);
        both.filter(has_it).copied().collect()
    }

    fn short_edges(&mut self) -> bool {
        let all = self.arrangement.sheets.iter().flat_map(Sheet::edges);
        let all: BTreeSet<[usize; 2]> = all.collect();
        let mut short: Vec<(f64, [usize; 2])> = all
            .into_iter()
            .map(|ends| (self.length(ends), ends))
            .collect();
        short.retain(|(length, _)| *length < self.short);
        sort(&mut short);
        let mut has_changed = false;
        for (_, ends) in short {
            if self.length(ends) < self.short && !self.sheets_with(ends).is_empty() {
                has_changed |= self.merge(ends);
            }
        }
        has_changed
    }

    fn narrow_gaps(&mut self) -> bool {
        let sheets = self.arrangement.sheets.iter();
        let mut narrow: Vec<(f64, (usize, [usize; 2]))> =
            sheets.flat_map(|sheet| self.gaps_of(sheet)).collect();
        sort(&mut narrow);
        narrow.dedup();
        let mut has_changed = false;
        for (_, (point, ends)) in narrow {
            let sheets = self.sheets_with(ends);
            if ends.contains(&point) || !sheets.iter().any(|sheet| self.on[point].contains(sheet)) {
                continue;
            }
            let [a, b] = ends.map(|end| self.length([end, point]));
            let nearer = if a <= b { ends[0] } else { ends[1] };
            let is_at_end = a.min(b) < self.short;
            has_changed |= is_at_end && self.merge([nearer, point])
                || self.insert(point, ends, &sheets)
                || a.min(b) < FARTHEST * self.short && self.merge([nearer, point]);
        }
        has_changed
    }

    /// Points of a surface that are too close to edges of it.
    fn gaps_of(&self, sheet: &Sheet) -> Vec<(f64, (usize, [usize; 2]))> {
        let points: Vec<(usize, DVec3)> = sheet
            .points()
            .into_iter()
            .map(|point| (point, self.at(point)))
            .collect();
        let mut found = Vec::new();
        for ends in sheet.edges() {
            let [from, to] = ends.map(|end| self.at(end));
            let (low, high) = (from.min(to) - self.short, from.max(to) + self.short);
            for (point, at) in &points {
                if ends.contains(point) || at.cmplt(low).any() || at.cmpgt(high).any() {
                    continue;
                }
                let along = to - from;
                let part = ((at - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
                let away = at.distance(from + part * along);
                if away < self.short {
                    found.push((away, (*point, ends)));
                }
            }
        }
        found
    }

    /// Makes one point of two.
    fn merge(&mut self, [kept, gone]: [usize; 2]) -> bool {
        let [first, second] = [kept, gone].map(|point| self.at(point));
        let sheets: BTreeSet<usize> = self.on[kept].union(&self.on[gone]).copied().collect();
        let starts = [first, second, first.midpoint(second)];
        let Some(to) = self.place(&starts, &[first, second], &sheets) else {
            return false;
        };
        let replaced = |point: usize| if point == gone { kept } else { point };
        let changed = |number: &usize| {
            let mut sheet = self.arrangement.sheets[*number].clone();
            sheet
                .outline
                .iter_mut()
                .for_each(|point| *point = replaced(*point));
            sheet.outline.dedup();
            if sheet.outline.len() > 1 && sheet.outline.first() == sheet.outline.last() {
                sheet.outline.pop();
            }
            let traces = sheet
                .traces
                .iter()
                .map(|&[a, b]| edge(replaced(a), replaced(b)));
            sheet.traces = traces.filter(|[a, b]| a != b).collect();
            sheet.contacts = sheet
                .contacts
                .iter()
                .map(|&point| replaced(point))
                .collect();
            // Where a trace has become a point, the surfaces still touch.
            sheet.contacts.insert(kept);
            sheet.tidy();
            (*number, sheet)
        };
        let known = [self.on[kept].clone(), self.on[gone].clone()];
        let changed = sheets.iter().map(changed).collect();
        self.make((kept, to), changed, &known)
            .then(|| {
                let gone = std::mem::take(&mut self.on[gone]);
                self.note(first.distance(to), &known[0], kept);
                self.note(second.distance(to), &gone, kept);
            })
            .is_some()
    }

    /// Moves a point onto an edge, which becomes two.
    fn insert(&mut self, point: usize, ends: [usize; 2], with_edge: &[usize]) -> bool {
        let from = self.at(point);
        let mut sheets = self.on[point].clone();
        sheets.extend(with_edge);
        let [a, b] = ends.map(|end| self.at(end));
        let part = (from - a).dot(b - a) / a.distance_squared(b);
        let Some(to) = self.place(&[from, a.lerp(b, part)], &[from], &sheets) else {
            return false;
        };
        let changed = |number: &usize| {
            let mut sheet = self.arrangement.sheets[*number].clone();
            let place = sheet.rim().position(|[a, b]| edge(a, b) == ends);
            if let Some(place) = place {
                sheet.outline.insert(place + 1, point);
            } else if sheet.traces.remove(&ends) {
                sheet.traces.extend(ends.map(|end| edge(end, point)));
            }
            sheet.tidy();
            (*number, sheet)
        };
        let known = [self.on[point].clone(), with_edge.iter().copied().collect()];
        let changed = sheets.iter().map(changed).collect();
        self.make((point, to), changed, &known)
            .then(|| self.note(from.distance(to), &known[0], point))
            .is_some()
    }

    /// The place on all surfaces that is nearest to where the points come from.
    fn place(
        &self,
        starts: &[DVec3],
        come_from: &[DVec3],
        sheets: &BTreeSet<usize>,
    ) -> Option<DVec3> {
        // Faces of the domain first: they are met exactly.
        let planes = sheets
            .iter()
            .rev()
            .map(|&sheet| &self.arrangement.sheets[sheet].plane);
        let found = starts.iter().filter_map(|&start| {
            let at = on_all(start, planes.clone(), self.tolerance)?;
            let by = come_from
                .iter()
                .map(|from| from.distance(at))
                .fold(0.0, f64::max);
            (by <= FARTHEST * self.short && self.is_in_domain(at)).then_some((by, at))
        });
        found.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, at)| at)
    }

    fn is_in_domain(&self, at: DVec3) -> bool {
        let sheets = &self.arrangement.sheets;
        let faces = sheets[sheets.len() - FACES.len()..].iter();
        faces.zip(FACES).all(|(face, (_, axis, upper))| {
            let level = face.plane.origin[axis];
            if upper {
                at[axis] <= level
            } else {
                at[axis] >= level
            }
        })
    }

    /// Makes a change if all surfaces stay sound; `known` are surfaces that knew of each other.
    fn make(
        &mut self,
        (point, to): (usize, DVec3),
        sheets: BTreeMap<usize, Sheet>,
        known: &[BTreeSet<usize>; 2],
    ) -> bool {
        let numbers: BTreeSet<usize> = sheets.keys().copied().collect();
        let mut change = Change {
            points: &self.arrangement.points,
            moved: point,
            to,
            sheets,
            joined: BTreeSet::new(),
        };
        for &a in &numbers {
            for &b in numbers.range(a + 1..) {
                if !known
                    .iter()
                    .any(|known| known.contains(&a) && known.contains(&b))
                {
                    change.join([a, b]);
                }
            }
        }
        if !change.is_sound(CLEAR * self.short) || self.overlaps(&change) || self.pierces(&change) {
            return false;
        }
        let sheets = change.sheets;
        for (number, sheet) in sheets {
            self.arrangement.sheets[number] = sheet;
        }
        self.arrangement.points[point] = to;
        self.on[point] = numbers;
        true
    }

    /// Whether surfaces that share a point whose edges have changed overlap beyond it.
    fn overlaps(&self, change: &Change) -> bool {
        let rims = change.sheets.values().flat_map(Sheet::rim);
        let at_moved = rims.filter(|ends| ends.contains(&change.moved));
        let mut points: BTreeSet<usize> = at_moved.flatten().collect();
        points.insert(change.moved);
        points.into_iter().any(|point| {
            let mut all: BTreeMap<usize, &Sheet> = self.on[point]
                .iter()
                .map(|&number| (number, &self.arrangement.sheets[number]))
                .collect();
            let changed = change.sheets.iter();
            all.extend(changed.map(|(&number, sheet)| (number, sheet)));
            all.retain(|_, sheet| sheet.has_point(point));
            let pairs = all
                .iter()
                .flat_map(|a| all.range(a.0 + 1..).map(move |b| (a, b)));
            let mut pairs = pairs.filter(|((a, _), (b, _))| {
                change.sheets.contains_key(*a) || change.sheets.contains_key(*b)
            });
            pairs.any(|((_, a), (_, b))| change.overlap(point, [*a, *b]))
        })
    }

    /// Whether an outline that has moved goes through a fracture nearby, or one nearby through it.
    fn pierces(&self, change: &Change) -> bool {
        let fractures = self.arrangement.sheets.len() - FACES.len();
        let mut changed = change
            .sheets
            .iter()
            .filter(|(number, _)| **number < fractures);
        changed.any(|(number, sheet)| {
            if !sheet.outline.contains(&change.moved) {
                return false;
            }
            let others = self.near[*number].iter();
            let mut others = others.filter(|other| !change.sheets.contains_key(other));
            others.any(|other| {
                let other = &self.arrangement.sheets[*other];
                let goes_through = |ends: &[usize; 2], of: &Sheet| {
                    let is_met = ends.iter().any(|&end| of.has_point(end));
                    !is_met && change.pierces(*ends, &of.plane, &of.outline)
                };
                let mut moved = sheet.rim().filter(|ends| ends.contains(&change.moved));
                moved.any(|ends| goes_through(&ends, other))
                    || other.rim().any(|ends| goes_through(&ends, sheet))
            })
        })
    }

    /// Notes that a point of the outlines of some surfaces has moved.
    fn note(&mut self, by: f64, before: &BTreeSet<usize>, point: usize) {
        if by <= self.tolerance {
            return;
        }
        for &sheet in before {
            if self.arrangement.sheets[sheet].outline.contains(&point) {
                let onto = self.on[point].iter().copied();
                let onto = onto.filter(|other| *other != sheet).collect();
                self.moved.push(Moved { sheet, by, onto });
            }
        }
    }
}

fn sort<T: Ord>(found: &mut [(f64, T)]) {
    found.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
}

/// The fractures whose bounds come closer to those of each than `gap` (m).
fn neighbours(arrangement: &Arrangement, gap: f64) -> Vec<Vec<usize>> {
    let fractures = arrangement.sheets.len() - FACES.len();
    let bounds: Vec<(DVec3, DVec3)> = arrangement.sheets[..fractures]
        .iter()
        .map(|sheet| {
            let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            let corners = sheet.outline.iter().map(|&point| arrangement.points[point]);
            corners.fold(start, |(low, high), at| (low.min(at), high.max(at)))
        })
        .collect();
    let mut near = vec![Vec::new(); arrangement.sheets.len()];
    for [a, b] in crate::intersections::close_bounds(&bounds, 2.0 * gap) {
        near[a].push(b);
        near[b].push(a);
    }
    near
}
