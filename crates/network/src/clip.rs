//! The box of rock, and fractures cut to it.

use glam::DVec3;

use crate::polygon::Polygon;

/// Names of the faces of the box, with the axis each is normal to and whether it is the upper one.
pub const FACES: [(&str, usize, bool); 6] = [
    ("left", 0, false),
    ("right", 0, true),
    ("front", 1, false),
    ("back", 1, true),
    ("bottom", 2, false),
    ("top", 2, true),
];

/// A box of rock with edges along the axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Domain {
    /// Lowest corner (m).
    pub low: DVec3,
    /// Highest corner (m).
    pub high: DVec3,
}

impl Domain {
    /// The box between two corners (m).
    pub fn between(low: [f64; 3], high: [f64; 3]) -> Self {
        Self {
            low: low.into(),
            high: high.into(),
        }
    }

    /// Volume (m^3).
    pub fn volume(&self) -> f64 {
        (self.high - self.low).element_product()
    }

    /// Length of the space diagonal (m).
    pub fn diagonal(&self) -> f64 {
        self.low.distance(self.high)
    }

    /// Lengths that rounding may leave (m).
    pub(crate) fn tolerance(&self) -> f64 {
        1e-9 * self.diagonal()
    }

    /// Coordinate of a face (m), along its axis.
    pub fn face(&self, face: usize) -> f64 {
        let (_, axis, upper) = FACES[face];
        if upper {
            self.high[axis]
        } else {
            self.low[axis]
        }
    }

    /// The part of a polygon inside the box; none if it has no area.
    pub fn clip(&self, polygon: &Polygon) -> Option<Polygon> {
        let mut corners = polygon.corners().to_vec();
        for (face, (_, axis, upper)) in FACES.iter().enumerate() {
            corners = cut(&corners, *axis, *upper, self.face(face));
        }
        let apart = 1e-9 * self.diagonal();
        drop_doubles(&mut corners, apart);
        let clipped = Polygon::new(corners, polygon.normal())?;
        (clipped.area() > apart * self.diagonal()).then_some(clipped)
    }

    /// What is in the domain of a polygon, or why nothing is; a rest less than `gap` (m) across is
    /// nothing.
    pub(crate) fn clip_large(&self, polygon: &Polygon, gap: f64) -> Result<Polygon, String> {
        let Some(clipped) = self.clip(polygon) else {
            return Err("outside the domain".into());
        };
        if let Some(face) = self.face_under(&clipped, 1e3 * self.tolerance()) {
            let reason =
                format!("it lies on the face `{face}` of the domain, with rock on one side only");
            return Err(reason);
        }
        let (low, high) = clipped.bounds();
        if low.distance(high) < gap || clipped.area() < gap * gap {
            return Err(format!(
                "only {:.3e} m2 of it, {:.3e} m across, are inside the domain: too small for the \
                 cells",
                clipped.area(),
                low.distance(high)
            ));
        }
        Ok(clipped)
    }

    /// The face that all corners lie on, if there is one, within `tolerance` (m).
    pub fn face_under(&self, polygon: &Polygon, tolerance: f64) -> Option<&'static str> {
        let is_under = |&face: &usize| {
            let (axis, level) = (FACES[face].1, self.face(face));
            let mut corners = polygon.corners().iter();
            corners.all(|corner| (corner[axis] - level).abs() <= tolerance)
        };
        (0..FACES.len()).find(is_under).map(|face| FACES[face].0)
    }
}

/// Removes corners that are closer than `apart` to the one before.
pub(crate) fn drop_doubles(corners: &mut Vec<DVec3>, apart: f64) {
    corners.dedup_by(|next, kept| next.distance(*kept) <= apart);
    while corners.len() > 1 && corners[0].distance(corners[corners.len() - 1]) <= apart {
        corners.pop();
    }
}

/// The part of a convex ring on the inner side of one face; new corners lie exactly on the face.
fn cut(corners: &[DVec3], axis: usize, upper: bool, level: f64) -> Vec<DVec3> {
    let outside = |corner: DVec3| {
        if upper {
            corner[axis] - level
        } else {
            level - corner[axis]
        }
    };
    let next = corners.iter().cycle().skip(1);
    let mut kept = Vec::with_capacity(corners.len() + 1);
    for (&a, &b) in corners.iter().zip(next) {
        let (from, to) = (outside(a), outside(b));
        if from <= 0.0 {
            kept.push(a);
        }
        if from * to < 0.0 {
            let mut crossing = a + (b - a) * (from / (from - to));
            crossing[axis] = level;
            kept.push(crossing);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Orientation, Outline};

    const UNIT: Domain = Domain {
        low: DVec3::ZERO,
        high: DVec3::ONE,
    };

    fn rectangle(length: f64, width: f64, centre: [f64; 3], dip: f64, direction: f64) -> Polygon {
        let outline = Outline::Rectangle {
            length,
            width,
            rotation: 0.0,
        };
        let orientation = Orientation {
            dip,
            dip_direction: direction,
        };
        Polygon::placed(outline, centre.into(), orientation)
    }

    fn clipped_area(polygon: &Polygon) -> f64 {
        UNIT.clip(polygon).map_or(0.0, |clipped| clipped.area())
    }

    #[test]
    fn areas_after_clipping() {
        for (polygon, area) in [
            (rectangle(0.5, 0.5, [0.5; 3], 30.0, 70.0), 0.25),
            (rectangle(9.0, 9.0, [0.5; 3], 0.0, 0.0), 1.0),
            (rectangle(9.0, 9.0, [0.5; 3], 45.0, 90.0), 2.0_f64.sqrt()),
            (rectangle(1.0, 1.0, [1.0, 1.0, 0.5], 0.0, 0.0), 0.25),
            (rectangle(9.0, 9.0, [5.0, 0.5, 0.5], 90.0, 90.0), 0.0),
        ] {
            assert!((clipped_area(&polygon) - area).abs() < 1e-12, "{polygon:?}");
        }
        // The plane x + y + z = 3/2 cuts the unit cube in a hexagon of area 3/4 sqrt(3).
        let diagonal = 3.0_f64.sqrt().recip().acos().to_degrees();
        let hexagon = rectangle(9.0, 9.0, [0.5; 3], diagonal, 45.0);
        assert!((clipped_area(&hexagon) - 0.75 * 3.0_f64.sqrt()).abs() < 1e-12);
        assert_eq!(
            UNIT.clip(&hexagon).map(|clipped| clipped.corners().len()),
            Some(6)
        );
    }

    #[test]
    fn cut_corners_lie_exactly_on_the_faces() {
        let clipped = UNIT
            .clip(&rectangle(9.0, 9.0, [0.3, 0.4, 0.5], 37.0, 63.0))
            .expect("inside");
        for corner in clipped.corners() {
            assert!(
                corner.to_array().iter().any(|&x| x == 0.0 || x == 1.0),
                "{corner}"
            );
        }
    }

    #[test]
    fn a_polygon_on_a_face_is_recognised() {
        let lid = rectangle(0.5, 0.5, [0.5, 0.5, 1.0], 0.0, 0.0);
        assert_eq!(UNIT.face_under(&lid, 1e-9), Some("top"));
        let tilted = rectangle(0.5, 0.5, [0.5, 0.5, 1.0], 1.0, 0.0);
        assert_eq!(UNIT.face_under(&tilted, 1e-9), None);
    }
}
