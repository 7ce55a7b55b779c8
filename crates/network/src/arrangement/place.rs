//! Where a point lies that several planes share.

use glam::DVec3;

use super::sheet::Plane;

/// Planes closer than this [sine] to those that a point is on already are taken as given by them.
const INDEPENDENT: f64 = 1e-3;

/// The point on all planes that is reached from `start` (m) by going to one after the other, each
/// within those before; none if they have no common point within `tolerance` (m).
pub(super) fn on_all<'a>(
    start: DVec3,
    planes: impl Iterator<Item = &'a Plane> + Clone,
    tolerance: f64,
) -> Option<DVec3> {
    let mut at = start;
    let mut taken: Vec<DVec3> = Vec::new();
    for plane in planes.clone() {
        let mut free = plane.normal;
        for direction in &taken {
            free -= free.dot(*direction) * *direction;
        }
        if taken.len() < 3 && free.length() > INDEPENDENT {
            let free = free.normalize();
            at -= free * (plane.height(at) / plane.normal.dot(free));
            taken.push(free);
        }
    }
    for plane in planes.clone() {
        for axis in 0..3 {
            // Planes across an axis are met to the last bit.
            if plane.normal[axis].abs() == 1.0 {
                at[axis] = plane.origin[axis];
            }
        }
    }
    let mut all = planes;
    all.all(|plane| plane.height(at).abs() <= tolerance)
        .then_some(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(origin: [f64; 3], normal: [f64; 3]) -> Plane {
        Plane::new(origin.into(), DVec3::from(normal).normalize())
    }

    #[test]
    fn a_point_goes_to_the_nearest_of_a_line_and_to_a_corner() {
        let floor = plane([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]);
        let wall = plane([2.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
        let slope = plane([0.0, 5.0, 0.0], [1.0, 1.0, 0.0]);
        let start = DVec3::new(1.0, 7.0, 1.5);
        let on = |planes: &[Plane]| on_all(start, planes.iter(), 1e-12);
        assert_eq!(on(&[floor, wall]), Some(DVec3::new(2.0, 7.0, 1.0)));
        let corner = on(&[floor, wall, slope]).expect("a corner");
        assert!(corner.distance(DVec3::new(2.0, 3.0, 1.0)) < 1e-12);
    }

    #[test]
    fn four_planes_share_a_point_only_by_chance() {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mut planes: Vec<Plane> = axes.iter().map(|&axis| plane([0.0; 3], axis)).collect();
        planes.push(plane([0.0; 3], [1.0, 1.0, 1.0]));
        assert_eq!(on_all(DVec3::ONE, planes.iter(), 1e-12), Some(DVec3::ZERO));
        planes[3] = plane([0.01, 0.0, 0.0], [1.0, 1.0, 1.0]);
        assert_eq!(on_all(DVec3::ONE, planes.iter(), 1e-12), None);
    }
}
