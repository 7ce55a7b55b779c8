//! A change of surfaces around one point, tried before it is made.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use super::sheet::{Plane, Sheet, edge};

/// Edges from one point at a smaller angle [sine] lie on each other.
const APART: f64 = 1e-3;

/// Angles below this [radians], of planes and of edges to the line of two planes, are none.
const ON_LINE: f64 = 1e-6;

/// Surfaces as they would be if a point moved.
pub(super) struct Change<'a> {
    /// The points as they are (m).
    pub(super) points: &'a [DVec3],
    /// The point that moves.
    pub(super) moved: usize,
    /// Where it goes (m).
    pub(super) to: DVec3,
    /// The changed surfaces by their numbers.
    pub(super) sheets: BTreeMap<usize, Sheet>,
    /// Edges that are new where two surfaces have come to share two points.
    pub(super) joined: BTreeSet<[usize; 2]>,
}

impl Change<'_> {
    pub(super) fn at(&self, point: usize) -> DVec3 {
        if point == self.moved {
            self.to
        } else {
            self.points[point]
        }
    }

    /// Gives two surfaces the edges between the points that they share: planes that share two
    /// points share all between them.
    pub(super) fn join(&mut self, pair: [usize; 2]) {
        let [Some(a), Some(b)] = pair.map(|number| self.sheets.get(&number)) else {
            return;
        };
        let along = a.plane.normal.cross(b.plane.normal);
        let in_both = a.points().intersection(&b.points()).copied().collect();
        let mut shared: Vec<usize> = in_both;
        let position = |point: &usize| self.at(*point).dot(along);
        shared.sort_by(|p, q| position(p).total_cmp(&position(q)));
        for ends in shared.windows(2) {
            let between = edge(ends[0], ends[1]);
            for number in pair {
                let Some(sheet) = self.sheets.get_mut(&number) else {
                    continue;
                };
                if !sheet.edges().contains(&between) {
                    sheet.traces.insert(between);
                    sheet.tidy();
                    self.joined.insert(between);
                }
            }
        }
    }

    /// Whether all changed surfaces are sound: their outlines run once around, and no edges cross
    /// or come closer than `clear` (m).
    pub(super) fn is_sound(&self, clear: f64) -> bool {
        let mut all = self.sheets.values();
        all.all(|sheet| self.is_simple(sheet) && self.is_clear(sheet, clear))
    }

    fn is_simple(&self, sheet: &Sheet) -> bool {
        let distinct: BTreeSet<&usize> = sheet.outline.iter().collect();
        sheet.outline.len() >= 3 && distinct.len() == sheet.outline.len()
    }

    fn is_clear(&self, sheet: &Sheet, clear: f64) -> bool {
        let flat = |point: usize| sheet.plane.flat(self.at(point));
        let edges = sheet.edges();
        let is_new = |ends: &[usize; 2]| ends.contains(&self.moved) || self.joined.contains(ends);
        for new in edges.iter().filter(|ends| is_new(ends)) {
            let [a, b] = new.map(flat);
            let (low, high) = (a.min(b) - clear, a.max(b) + clear);
            for other in edges.iter().filter(|other| *other != new) {
                let [p, q] = other.map(flat);
                if p.max(q).cmplt(low).any() || p.min(q).cmpgt(high).any() {
                    continue;
                }
                let is_well = match common(*new, *other) {
                    Some([at, first, second]) => are_apart([at, first, second].map(flat)),
                    None => between([a, b], [p, q]) >= clear,
                };
                if !is_well {
                    return false;
                }
            }
            let mut contacts = sheet.contacts.iter();
            if contacts.any(|&contact| to_segment([a, b], flat(contact)) < clear) {
                return false;
            }
        }
        true
    }

    /// Whether two surfaces that share a point go on along the line of their planes without sharing
    /// an edge there.
    pub(super) fn overlap(&self, at: usize, [a, b]: [&Sheet; 2]) -> bool {
        let along = a.plane.normal.cross(b.plane.normal);
        if along.length() < ON_LINE {
            return false;
        }
        let shares = |direction: DVec3| {
            let mut edges = a.edges_at(at).into_iter();
            edges.any(|other| {
                b.has_edge(edge(at, other)) && (self.at(other) - self.at(at)).dot(direction) > 0.0
            })
        };
        [along, -along].into_iter().any(|direction| {
            self.goes_into(a, at, direction)
                && self.goes_into(b, at, direction)
                && !shares(direction)
        })
    }

    /// Whether a direction in the plane of a surface leads from a point into it or along its rim.
    fn goes_into(&self, sheet: &Sheet, at: usize, direction: DVec3) -> bool {
        let Some(place) = sheet.outline.iter().position(|&point| point == at) else {
            return true;
        };
        let count = sheet.outline.len();
        let from = sheet.plane.flat(self.at(at));
        let to = |place: usize| sheet.plane.flat(self.at(sheet.outline[place % count])) - from;
        let (next, before) = (to(place + 1), to(place + count - 1));
        let turn = |other: DVec2| {
            let angle = libm::atan2(next.perp_dot(other), next.dot(other));
            if angle < -ON_LINE {
                angle + 2.0 * PI
            } else {
                angle
            }
        };
        turn(sheet.plane.flat(self.at(at) + direction) - from) <= turn(before) + ON_LINE
    }

    /// Whether an edge between two points goes through a surface that neither is on.
    pub(super) fn pierces(&self, ends: [usize; 2], plane: &Plane, outline: &[usize]) -> bool {
        let [a, b] = ends.map(|point| self.at(point));
        let (from, to) = (plane.height(a), plane.height(b));
        if from * to > 0.0 || from == to {
            return false;
        }
        let at = plane.flat(a.lerp(b, from / (from - to)));
        let ring = outline.iter().map(|&point| plane.flat(self.at(point)));
        is_inside(&ring.collect::<Vec<_>>(), at)
    }
}

/// The point that two edges share, and their other ends.
fn common(a: [usize; 2], b: [usize; 2]) -> Option<[usize; 3]> {
    for (at, first) in [(a[0], a[1]), (a[1], a[0])] {
        for (other, second) in [(b[0], b[1]), (b[1], b[0])] {
            if at == other {
                return Some([at, first, second]);
            }
        }
    }
    None
}

fn are_apart([at, first, second]: [DVec2; 3]) -> bool {
    let (a, b) = (first - at, second - at);
    a.dot(b) <= 0.0 || a.perp_dot(b).abs() > APART * a.length() * b.length()
}

/// Distance between two segments (m), 0 where they cross.
fn between(a: [DVec2; 2], b: [DVec2; 2]) -> f64 {
    let side = |[from, to]: [DVec2; 2], point: DVec2| (to - from).perp_dot(point - from);
    let crosses = |one: [DVec2; 2], other: [DVec2; 2]| side(one, other[0]) * side(one, other[1]);
    if crosses(a, b) < 0.0 && crosses(b, a) < 0.0 {
        return 0.0;
    }
    let of_a = a.map(|end| to_segment(b, end));
    let of_b = b.map(|end| to_segment(a, end));
    of_a.into_iter().chain(of_b).fold(f64::INFINITY, f64::min)
}

fn to_segment([from, to]: [DVec2; 2], point: DVec2) -> f64 {
    let along = to - from;
    let part = (point - from).dot(along) / along.length_squared();
    let part = if part.is_finite() {
        part.clamp(0.0, 1.0)
    } else {
        0.0
    };
    point.distance(from + part * along)
}

/// Whether a point is inside of a ring, by the number of times that a ray leaves it.
pub(super) fn is_inside(ring: &[DVec2], point: DVec2) -> bool {
    let next = ring.iter().cycle().skip(1);
    let crossings = ring.iter().zip(next).filter(|(a, b)| {
        (a.y > point.y) != (b.y > point.y)
            && point.x < (b.x - a.x) * (point.y - a.y) / (b.y - a.y) + a.x
    });
    crossings.count() % 2 == 1
}
