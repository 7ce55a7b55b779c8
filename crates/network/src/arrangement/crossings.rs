//! Points where traces cross, and points that lie on segments.

use glam::{DVec2, DVec3};

use super::segments::Segments;

/// Traces within this angle [radians] have no crossing that rounding leaves alone.
const PARALLEL: f64 = 1e-9;

/// Adds to all segments the points of their surfaces that lie on them, and those where traces
/// cross.
pub(super) fn cross(segments: &mut Segments) {
    for surface in 0..segments.within.len() {
        cross_traces(segments, surface);
    }
    let mut changed: Vec<usize> = (0..segments.within.len()).collect();
    while !changed.is_empty() {
        let mut next: Vec<usize> = changed
            .iter()
            .flat_map(|&surface| gather(segments, surface))
            .collect();
        next.sort_unstable();
        next.dedup();
        changed = next;
    }
}

/// Two points in a plane (m), and the distance between them.
struct Flat {
    from: DVec2,
    along: DVec2,
    length: f64,
}

fn cross_traces(segments: &mut Segments, surface: usize) {
    let plane = segments.planes[surface];
    let traces = segments.within[surface].iter().copied();
    let traces: Vec<usize> = traces
        .filter(|&segment| segments.all[segment].is_trace)
        .collect();
    let flat: Vec<Flat> = traces
        .iter()
        .map(|&trace| {
            let ends = segments.all[trace].ends;
            let [from, to] = ends.map(|end| plane.flat(segments.points.all()[end]));
            Flat {
                from,
                along: to - from,
                length: from.distance(to),
            }
        })
        .collect();
    for (rank, &first) in traces.iter().enumerate() {
        for (other, &second) in traces.iter().enumerate().skip(rank + 1) {
            let Some(part) = crossing(&flat[rank], &flat[other], segments.tolerance) else {
                continue;
            };
            let [from, to] = segments.all[first]
                .ends
                .map(|end| segments.points.all()[end]);
            let number = segments.points.number(from.lerp(to, part));
            segments.all[first].on.insert(number);
            segments.all[second].on.insert(number);
        }
    }
}

/// How far along the first segment the second crosses it, as a part of its length.
fn crossing(a: &Flat, b: &Flat, tolerance: f64) -> Option<f64> {
    let turn = a.along.perp_dot(b.along);
    if turn.abs() <= PARALLEL * a.length * b.length {
        return None;
    }
    let between = b.from - a.from;
    let (on_a, on_b) = (
        between.perp_dot(b.along) / turn,
        between.perp_dot(a.along) / turn,
    );
    let within = |part: f64, length: f64| {
        let over = tolerance / length;
        part >= -over && part <= 1.0 + over
    };
    (within(on_a, a.length) && within(on_b, b.length)).then_some(on_a)
}

/// Adds to the segments of a surface its points that lie on them; returns the surfaces of those
/// that have changed.
fn gather(segments: &mut Segments, surface: usize) -> Vec<usize> {
    let within = &segments.within[surface];
    let mut numbers = segments.contacts[surface].clone();
    for &segment in within {
        numbers.extend(&segments.all[segment].on);
    }
    let numbers: Vec<(usize, DVec3)> = numbers
        .into_iter()
        .map(|number| (number, segments.points.all()[number]))
        .collect();
    let near = 20.0 * segments.tolerance;
    let mut changed = Vec::new();
    for &segment in within {
        let [from, to] = segments.all[segment]
            .ends
            .map(|end| segments.points.all()[end]);
        let (along, squared) = (to - from, from.distance_squared(to));
        let (low, high) = (from.min(to) - near, from.max(to) + near);
        let lies_on = |point: DVec3| {
            if point.cmplt(low).any() || point.cmpgt(high).any() {
                return false;
            }
            let part = ((point - from).dot(along) / squared).clamp(0.0, 1.0);
            point.distance(from + part * along) <= near
        };
        let own = &mut segments.all[segment];
        let before = own.on.len();
        let on = numbers.iter().filter(|(_, point)| lies_on(*point));
        own.on.extend(on.map(|(number, _)| *number));
        if own.on.len() > before {
            changed.extend(&own.surfaces);
        }
    }
    changed
}
