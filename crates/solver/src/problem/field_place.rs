//! Where on a facet a value that varies is taken for a facet point.

use glam::DVec3;

/// How far outside an edge a position still counts as inside, as a share of the facet: rounding.
const SLACK: f64 = 1e-9;

/// Where a value is taken for a facet point.
///
/// Points of the corners of facets of second order have their barycentre outside the facet, where
/// there may be no rock and no value. There the value is continued from the middle of the facet
/// over the corner, which is exact for linear ones: `f(n) + s (f(n) - f(c))`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FieldPlace {
    /// The position, or the corner `n` (m).
    at: DVec3,
    /// The middle of the facet `c` (m), and `s`.
    beyond: Option<(DVec3, f64)>,
}

impl FieldPlace {
    /// A position (m) that is in the rock.
    pub(crate) fn inside(at: DVec3) -> Self {
        Self { at, beyond: None }
    }

    /// The place for a position (m) on a facet with these corners (m), or beside it.
    pub(crate) fn of(corners: &[DVec3], position: DVec3) -> Self {
        let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
        let ends = || corners.iter().zip(corners.iter().cycle().skip(1));
        let turn = |(a, b): (&DVec3, &DVec3), x: DVec3| (*b - *a).cross(x - *a);
        let normal: DVec3 = ends().map(|edge| turn(edge, middle)).sum();
        let slack = SLACK * normal.length_squared();
        let is_inside = ends().all(|edge| turn(edge, position).dot(normal) >= -slack);
        let distance = |corner: &DVec3| corner.distance_squared(position);
        let nearest = corners
            .iter()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)));
        match nearest {
            Some(corner) if !is_inside => {
                let share = position.distance(middle) / corner.distance(middle) - 1.0;
                Self {
                    at: *corner,
                    beyond: Some((middle, share)),
                }
            }
            _ => Self::inside(position),
        }
    }

    /// The value of `f` there.
    pub(crate) fn value(&self, f: impl Fn(DVec3) -> f64) -> f64 {
        let own = f(self.at);
        let more = |(middle, share): (DVec3, f64)| share * (own - f(middle));
        own + self.beyond.map_or(0.0, more)
    }

    /// The value of a parameter that must not change its sign: not less than half the one at the
    /// corner, nor more than twice.
    pub(crate) fn kept_value(&self, f: impl Fn(DVec3) -> f64) -> f64 {
        let own = f(self.at);
        let (half, twice) = (0.5 * own, 2.0 * own);
        self.value(f).max(half.min(twice)).min(half.max(twice))
    }

    /// The positions that it asks for (m).
    pub(crate) fn positions(self) -> impl Iterator<Item = DVec3> {
        [self.at]
            .into_iter()
            .chain(self.beyond.map(|(middle, _)| middle))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_values_are_continued_over_corners_and_signs_are_kept() {
        let corners = [
            DVec3::ZERO,
            DVec3::new(3.0, 0.0, 0.0),
            DVec3::new(0.0, 3.0, 0.0),
        ];
        let inside = DVec3::new(1.0, 0.5, 0.0);
        assert_eq!(FieldPlace::of(&corners, inside), FieldPlace::inside(inside));
        let outside = FieldPlace::of(&corners, DVec3::new(-0.2, -0.2, 0.0));
        let linear = |x: DVec3| 2.0 + 3.0 * x.x - x.y;
        assert!((outside.value(linear) - 1.6).abs() < 1e-15);
        assert_eq!(outside.kept_value(linear), outside.value(linear));
        let steep = |x: DVec3| 1e-3 + x.x;
        assert!(outside.value(steep) < 0.0);
        assert_eq!(outside.kept_value(steep), 0.5e-3);
        assert_eq!(outside.positions().count(), 2);
    }
}
