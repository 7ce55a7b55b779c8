//! Snaps fractures whose ends nearly touch: in its own plane, a corner closer than the smallest gap
//! to another fracture or to a face of the domain moves onto it, whether it ends before that or
//! goes beyond; edges shorter than the gap are merged. Where planes are not at right angles a
//! corner moves farther within its own than the gap is wide.

use glam::DVec3;

use crate::clip::{Domain, FACES, drop_doubles};
use crate::fracture::{CellSizes, NetworkFracture, close_pairs};
use crate::intersections::common_line;
use crate::polygon::Polygon;

/// A corner that moves may bring another within reach; more rounds have not been seen to help.
const ROUNDS: usize = 4;

/// In a plane at a small angle a corner would have to move far to close a small gap: at most this
/// many gaps.
const FARTHEST: f64 = 2.0;

/// Lines that cross at less than this angle [radians] have no useful crossing.
const NEARLY_PARALLEL: f64 = 0.2;

/// A line in the plane of a fracture that its corners should be on or well away from.
struct Line {
    point: DVec3,
    along: DVec3,
    /// Sine of the angle between the planes.
    steep: f64,
    /// The other fracture, if the line is not on a face of the domain.
    other: Option<usize>,
    /// How messages call it.
    name: String,
}

impl Line {
    fn foot(&self, point: DVec3) -> DVec3 {
        self.point + (point - self.point).dot(self.along) * self.along
    }
}

/// Snaps all fractures and notes the changes in them.
pub(crate) fn snap(domain: &Domain, sizes: &CellSizes, fractures: &mut [NetworkFracture]) {
    let gap = sizes.gap();
    for _ in 0..ROUNDS {
        let mut near = vec![Vec::new(); fractures.len()];
        for [a, b] in close_pairs(fractures, gap) {
            near[a].push(b);
            near[b].push(a);
        }
        let mut has_changed = false;
        for (index, near) in near.iter().enumerate() {
            let lines = lines(domain, sizes, fractures, index, near);
            has_changed |= snap_one(domain, gap, fractures, index, &lines);
        }
        if !has_changed {
            break;
        }
    }
}

fn lines(
    domain: &Domain,
    sizes: &CellSizes,
    fractures: &[NetworkFracture],
    own: usize,
    near: &[usize],
) -> Vec<Line> {
    let plane = &fractures[own].polygon;
    let least = sizes.small_angle.to_radians().sin();
    let line = |point: DVec3, normal: DVec3, other: Option<usize>, name: String| {
        let steep = plane.normal().cross(normal).length();
        let shared = common_line((plane.middle(), plane.normal()), (point, normal));
        let (point, along) = shared.filter(|_| steep > least)?;
        Some(Line {
            point,
            along,
            steep,
            other,
            name,
        })
    };
    let faces = (0..FACES.len()).filter_map(|face| {
        let (name, axis, _) = FACES[face];
        let mut normal = DVec3::ZERO;
        normal[axis] = 1.0;
        line(
            normal * domain.face(face),
            normal,
            None,
            format!("the face `{name}`"),
        )
    });
    let others = near.iter().filter_map(|&other| {
        let polygon = &fractures[other].polygon;
        let name = format!("`{}`", fractures[other].name);
        line(polygon.middle(), polygon.normal(), Some(other), name)
    });
    faces.chain(others).collect()
}

/// Where a corner should be, and on which lines.
fn target<'a>(
    corner: DVec3,
    lines: &'a [Line],
    fractures: &[NetworkFracture],
    gap: f64,
    tolerance: f64,
) -> Option<(DVec3, Vec<&'a Line>)> {
    let holds = |line: &Line, point: DVec3| {
        line.other
            .is_none_or(|other| fractures[other].polygon.depth(point) >= -tolerance)
    };
    let mut near: Vec<(f64, &Line)> = lines
        .iter()
        .map(|line| (line.foot(corner).distance(corner), line))
        .filter(|(away, line)| away * line.steep < gap && *away < FARTHEST * gap)
        .filter(|(_, line)| holds(line, line.foot(corner)))
        .collect();
    // Faces first: a corner that leaves the face of the domain would leave a new gap there.
    near.sort_by(|a, b| {
        a.1.other
            .is_some()
            .cmp(&b.1.other.is_some())
            .then(a.0.total_cmp(&b.0))
    });
    let (_, first) = *near.first()?;
    let crossing = near[1..].iter().find_map(|(_, second)| {
        let point = crossing(first, second)?;
        let fits =
            point.distance(corner) < 2.0 * gap && holds(first, point) && holds(second, point);
        fits.then_some((point, vec![first, *second]))
    });
    Some(crossing.unwrap_or_else(|| (first.foot(corner), vec![first])))
}

/// Where two lines of one plane cross.
fn crossing(first: &Line, second: &Line) -> Option<DVec3> {
    let normal = first.along.cross(second.along);
    if normal.length() < NEARLY_PARALLEL {
        return None;
    }
    let across = normal.cross(second.along);
    let step = (second.point - first.point).dot(across) / first.along.dot(across);
    Some(first.point + step * first.along)
}

fn snap_one(
    domain: &Domain,
    gap: f64,
    fractures: &mut [NetworkFracture],
    index: usize,
    lines: &[Line],
) -> bool {
    let tolerance = domain.tolerance();
    let mut has_changed = false;
    let mut corner = 0;
    while corner < fractures[index].polygon.corners().len() {
        let from = fractures[index].polygon.corners()[corner];
        let found = target(from, lines, fractures, gap, tolerance);
        let Some((to, onto)) = found.filter(|(to, _)| *to != from) else {
            corner += 1;
            continue;
        };
        let fracture = &mut fractures[index];
        let count = fracture.polygon.corners().len();
        let moved = from.distance(to);
        if let Some(polygon) = with_corner(domain, &fracture.polygon, corner, to) {
            fracture.polygon = polygon;
            if moved > tolerance {
                let names: Vec<&str> = onto.iter().map(|line| line.name.as_str()).collect();
                let text = format!(
                    "a corner was moved by {moved:.3e} m onto {}",
                    names.join(" and ")
                );
                fracture.changes.push(text);
                fracture.farthest_move = fracture.farthest_move.max(moved);
                has_changed = true;
            }
        }
        // A corner that met its neighbour is gone, and the next has taken its place.
        if fracture.polygon.corners().len() == count {
            corner += 1;
        }
    }
    has_changed | merge_short_edges(domain, gap, fractures, index, lines)
}

/// The polygon with one corner elsewhere; none if that is another one altogether, or leaves the
/// domain.
fn with_corner(domain: &Domain, polygon: &Polygon, corner: usize, to: DVec3) -> Option<Polygon> {
    // Clamping more than rounding would leave the plane.
    let inside = to.clamp(domain.low, domain.high);
    if inside.distance(to) > domain.tolerance() {
        return None;
    }
    let mut corners = polygon.corners().to_vec();
    corners[corner] = inside;
    drop_doubles(&mut corners, domain.tolerance());
    straighten(&mut corners, polygon.normal());
    let changed = Polygon::new(corners, polygon.normal())?;
    let is_like = (0.7..1.4).contains(&(changed.area() / polygon.area()));
    is_like.then_some(changed)
}

/// Drops corners that turn inwards, as the neighbours of one that has moved out may.
fn straighten(corners: &mut Vec<DVec3>, normal: DVec3) {
    let turns_inwards = |corners: &[DVec3], i: usize| {
        let count = corners.len();
        let (before, after) = (corners[(i + count - 1) % count], corners[(i + 1) % count]);
        (corners[i] - before).cross(after - corners[i]).dot(normal) < 0.0
    };
    while corners.len() > 3
        && let Some(inward) = (0..corners.len()).find(|&i| turns_inwards(corners, i))
    {
        corners.remove(inward);
    }
}

/// Removes the looser corner of each edge shorter than the gap: never one that lies on a line the
/// other is not on.
fn merge_short_edges(
    domain: &Domain,
    gap: f64,
    fractures: &mut [NetworkFracture],
    index: usize,
    lines: &[Line],
) -> bool {
    let tolerance = domain.tolerance();
    let mut has_changed = false;
    loop {
        let polygon = &fractures[index].polygon;
        let corners = polygon.corners();
        let on = |corner: DVec3| -> Vec<usize> {
            let touches = |line: &Line| {
                line.foot(corner).distance(corner) <= tolerance
                    && line
                        .other
                        .is_none_or(|other| fractures[other].polygon.depth(corner) >= -tolerance)
            };
            (0..lines.len())
                .filter(|&line| touches(&lines[line]))
                .collect()
        };
        let count = corners.len();
        let removable = (0..count).find_map(|first| {
            let second = (first + 1) % count;
            let (a, b) = (on(corners[first]), on(corners[second]));
            let is_short = corners[first].distance(corners[second]) < gap;
            let within = |a: &[usize], b: &[usize]| a.iter().all(|line| b.contains(line));
            match is_short {
                true if within(&a, &b) => without(polygon, first),
                true if within(&b, &a) => without(polygon, second),
                _ => None,
            }
        });
        let Some((smaller, length)) = removable else {
            return has_changed;
        };
        let fracture = &mut fractures[index];
        fracture.polygon = smaller;
        fracture.changes.push(format!(
            "an edge of {length:.3e} m was merged with the next"
        ));
        has_changed = true;
    }
}

/// The polygon without one corner, and the length of the shorter edge there.
fn without(polygon: &Polygon, corner: usize) -> Option<(Polygon, f64)> {
    let mut corners = polygon.corners().to_vec();
    let count = corners.len();
    let at = corners.remove(corner);
    let (before, after) = (
        polygon.corners()[(corner + count - 1) % count],
        polygon.corners()[(corner + 1) % count],
    );
    let smaller = Polygon::new(corners, polygon.normal())?;
    let is_like = smaller.area() > 0.9 * polygon.area();
    is_like.then(|| (smaller, at.distance(before).min(at.distance(after))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::intersections::intersection;
    use crate::samples::{DOMAIN, FLOOR, SIZES, fracture, wall};

    fn snapped(mut fractures: Vec<NetworkFracture>) -> Vec<NetworkFracture> {
        snap(&DOMAIN, &SIZES, &mut fractures);
        fractures
    }

    #[test]
    fn an_end_that_falls_short_or_goes_beyond_moves_onto_the_other() {
        for low in [5.15, 4.85] {
            let fractures = snapped(vec![
                fracture("floor", &FLOOR),
                fracture("wall", &wall(low)),
            ]);
            let wall = &fractures[1];
            assert!((wall.polygon.area() - 6.0).abs() < 1e-12, "{low}");
            assert_eq!(wall.changes.len(), 2, "{:?}", wall.changes);
            assert!(
                wall.changes[0].contains("1.500e-1 m onto `floor`"),
                "{}",
                wall.changes[0]
            );
            let shared =
                intersection(&fractures[0].polygon, &wall.polygon, 1e-9).expect("abutting");
            assert!((shared.length() - 3.0).abs() < 1e-12);
            assert!(fractures[0].changes.is_empty());
        }
    }

    #[test]
    fn ends_farther_than_the_gap_stay() {
        for low in [5.25, 4.75] {
            let before = vec![fracture("floor", &FLOOR), fracture("wall", &wall(low))];
            assert_eq!(snapped(before.clone()), before);
        }
    }

    #[test]
    fn an_end_close_to_a_face_moves_onto_it() {
        let near = [
            [0.1, 3.0, 4.0],
            [3.0, 3.0, 4.0],
            [3.0, 6.0, 4.0],
            [0.1, 6.0, 4.0],
        ];
        let fractures = snapped(vec![fracture("near", &near)]);
        assert!((fractures[0].polygon.area() - 9.0).abs() < 1e-12);
        assert!(fractures[0].changes[0].contains("the face `left`"));
    }

    #[test]
    fn a_corner_close_to_two_fractures_moves_to_where_they_meet() {
        let other = fracture(
            "other",
            &[
                [4.0, 2.9, 2.0],
                [8.0, 2.9, 2.0],
                [8.0, 2.9, 8.0],
                [4.0, 2.9, 8.0],
            ],
        );
        let fractures = snapped(vec![
            fracture("floor", &FLOOR),
            other,
            fracture("wall", &wall(5.1)),
        ]);
        let corners = fractures[2].polygon.corners();
        assert!(
            corners
                .iter()
                .any(|c| c.distance(DVec3::new(5.0, 2.9, 5.0)) < 1e-12),
            "{corners:?}"
        );
    }

    #[test]
    fn neighbours_of_a_corner_that_moves_out_give_way() {
        // Nearly a straight edge: the corner in the middle of it moves 0.1 m down to the floor.
        let blunt = [
            [5.0, 3.0, 5.12],
            [5.0, 4.5, 5.1],
            [5.0, 6.0, 5.12],
            [5.0, 6.0, 7.0],
            [5.0, 3.0, 7.0],
        ];
        let fractures = snapped(vec![fracture("floor", &FLOOR), fracture("blunt", &blunt)]);
        let lowest = fractures[1]
            .polygon
            .corners()
            .iter()
            .filter(|corner| corner.z == 5.0);
        assert!(lowest.count() >= 2, "{:?}", fractures[1]);
    }

    #[test]
    fn snapped_corners_stay_in_their_plane_and_in_the_domain() {
        // The roof meets the wall's plane beyond the face `front`, within reach of the wall's
        // corner.
        let roof = fracture(
            "roof",
            &[
                [4.0, 0.0, 7.05],
                [6.0, 0.0, 7.05],
                [6.0, 3.0, 7.95],
                [4.0, 3.0, 7.95],
            ],
        );
        let wall = fracture(
            "wall",
            &[
                [5.0, 0.01, 5.0],
                [5.0, 3.0, 5.0],
                [5.0, 3.0, 7.0],
                [5.0, 0.01, 7.0],
            ],
        );
        for fracture in snapped(vec![roof, wall]) {
            let polygon = &fracture.polygon;
            for &corner in polygon.corners() {
                assert!(polygon.height(corner).abs() < 1e-12, "{fracture:?}");
                assert_eq!(
                    corner,
                    corner.clamp(DOMAIN.low, DOMAIN.high),
                    "{fracture:?}"
                );
            }
        }
    }

    #[test]
    fn short_edges_merge_but_not_off_a_face() {
        let cut = [
            [0.0, 3.0, 4.0],
            [3.0, 3.0, 4.0],
            [3.0, 5.9, 4.0],
            [2.9, 6.0, 4.0],
            [0.0, 6.0, 4.0],
        ];
        let fractures = snapped(vec![fracture("cut", &cut)]);
        let polygon = &fractures[0].polygon;
        assert_eq!(polygon.corners().len(), 4);
        let at_face = polygon
            .corners()
            .iter()
            .filter(|corner| corner.x == 0.0)
            .count();
        assert_eq!(at_face, 2);
    }
}
