//! A fracture as a convex planar polygon.

use std::f64::consts::PI;

use glam::DVec3;
use kluft_mesh::Orientation;

/// Given corners may be off their common plane by this part of the polygon's extent: what three
/// decimals of a coordinate leave, not a fold.
const FLAT: f64 = 1e-3;

/// Corners may be re-entrant by this part of the extent (rounding of given coordinates).
const CONVEX: f64 = 1e-9;

/// The outline of a fracture in its plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outline {
    /// A regular polygon with the area of the disc.
    Disc {
        /// Radius of the disc (m).
        radius: f64,
        /// Number of corners.
        sides: usize,
        /// Turn of the first corner from the strike towards the dip (degrees).
        rotation: f64,
    },
    /// A polygon with the area of the ellipse.
    Ellipse {
        /// Longer half axis (m).
        semi_major: f64,
        /// Shorter half axis (m).
        semi_minor: f64,
        /// Turn of the longer axis from the strike towards the dip (degrees).
        rotation: f64,
        /// Number of corners.
        sides: usize,
    },
    /// A rectangle.
    Rectangle {
        /// Length of the first side (m).
        length: f64,
        /// Length of the second side (m).
        width: f64,
        /// Turn of the first side from the strike towards the dip (degrees).
        rotation: f64,
    },
}

impl Outline {
    /// Corners along strike and dip, around the centre.
    fn corners(self) -> Vec<[f64; 2]> {
        match self {
            Outline::Disc {
                radius,
                sides,
                rotation,
            } => ring(radius, radius, rotation, sides),
            Outline::Ellipse {
                semi_major,
                semi_minor,
                rotation,
                sides,
            } => ring(semi_major, semi_minor, rotation, sides),
            Outline::Rectangle {
                length,
                width,
                rotation,
            } => {
                let (a, b) = (length / 2.0, width / 2.0);
                let corners = [[-a, -b], [a, -b], [a, b], [-a, b]];
                corners.map(|corner| turned(corner, rotation)).to_vec()
            }
        }
    }
}

fn turned([a, b]: [f64; 2], rotation: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(rotation.to_radians());
    [a * cos - b * sin, a * sin + b * cos]
}

/// Corners on an ellipse a little larger, so that the polygon has the area of the ellipse.
fn ring(semi_major: f64, semi_minor: f64, rotation: f64, sides: usize) -> Vec<[f64; 2]> {
    let step = 2.0 * PI / sides as f64;
    let grow = (step / libm::sin(step)).sqrt();
    let corner = |number: usize| {
        let (sin, cos) = libm::sincos(step * number as f64);
        turned([semi_major * grow * cos, semi_minor * grow * sin], rotation)
    };
    (0..sides).map(corner).collect()
}

/// A convex polygon in a plane; its corners run counter-clockwise around the normal.
#[derive(Debug, Clone, PartialEq)]
pub struct Polygon {
    corners: Vec<DVec3>,
    normal: DVec3,
}

impl Polygon {
    /// An outline around `centre` (m) in a plane of the given orientation.
    pub fn placed(outline: Outline, centre: DVec3, orientation: Orientation) -> Self {
        let (strike, fall) = orientation.strike_and_fall();
        let corners = outline.corners().into_iter().rev();
        Self {
            corners: corners
                .map(|[a, b]| centre + a * strike + b * fall)
                .collect(),
            normal: orientation.pole(),
        }
    }

    /// The polygon with these corners (m), moved into their common plane.
    ///
    /// # Errors
    /// What is wrong with the corners, and what to do.
    pub fn through(corners: &[DVec3]) -> Result<Self, (String, String)> {
        let complain = |problem: &str, remedy: &str| Err((problem.to_owned(), remedy.to_owned()));
        if corners.len() < 3 {
            return complain("a polygon needs three corners", "give three or more points");
        }
        let sum = newell(corners);
        let extent = extent(corners);
        if sum.length() <= 1e-9 * extent * extent {
            let remedy = "give corners that are not in one line, in order around the polygon";
            return complain("the corners enclose no area", remedy);
        }
        let normal = sum.normalize();
        let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
        let offset = |corner: &DVec3| (*corner - middle).dot(normal);
        let off = corners.iter().map(|c| offset(c).abs()).fold(0.0, f64::max);
        if off > FLAT * extent {
            let problem = format!("a corner is {off:.3e} m off the common plane of the corners");
            return complain(&problem, "split a bent fracture into planar ones");
        }
        let flat = corners.iter().map(|c| *c - offset(c) * normal);
        let flat: Vec<DVec3> = flat.collect();
        match Self::new(flat, normal) {
            Some(polygon) => Ok(polygon),
            None => complain(
                "the polygon is not convex, or a corner stands twice",
                "split it into convex polygons, and give each corner once",
            ),
        }
    }

    /// A polygon of corners that lie in the plane of `normal`; none if they are fewer than three,
    /// coincide or do not run convexly around the normal.
    pub(crate) fn new(corners: Vec<DVec3>, normal: DVec3) -> Option<Self> {
        let extent = extent(&corners);
        let count = corners.len();
        let corner = |index: usize| corners[index % count];
        let turns_left = |i: usize| {
            let (before, after) = (corner(i + 1) - corner(i), corner(i + 2) - corner(i + 1));
            let is_edge = before.length() > CONVEX * extent;
            is_edge && before.cross(after).dot(normal) >= -CONVEX * extent * extent
        };
        // A pentagram turns left everywhere too, but encloses its middle twice.
        let fits = count >= 3 && (0..count).all(turns_left) && turns_once(&corners, normal);
        fits.then_some(Self { corners, normal })
    }

    /// The corners (m).
    pub fn corners(&self) -> &[DVec3] {
        &self.corners
    }

    /// The unit normal.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }

    /// The edges, from corner to corner.
    pub fn edges(&self) -> impl Iterator<Item = [DVec3; 2]> + Clone + '_ {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().zip(next).map(|(a, b)| [*a, *b])
    }

    /// Area (m^2).
    pub fn area(&self) -> f64 {
        newell(&self.corners).dot(self.normal) / 2.0
    }

    /// Mean of the corners (m).
    pub fn middle(&self) -> DVec3 {
        self.corners.iter().sum::<DVec3>() / self.corners.len() as f64
    }

    /// Height of a point above the plane (m), along the normal.
    pub fn height(&self, point: DVec3) -> f64 {
        (point - self.corners[0]).dot(self.normal)
    }

    /// Lowest and highest coordinates (m).
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let widen = |(low, high): (DVec3, DVec3), c: &DVec3| (low.min(*c), high.max(*c));
        self.corners.iter().fold(start, widen)
    }

    /// How far a point of the plane lies inside of the nearest edge (m); negative outside.
    pub fn depth(&self, point: DVec3) -> f64 {
        let inside = |[a, b]: [DVec3; 2]| {
            let inwards = self.normal.cross(b - a).normalize_or_zero();
            (point - a).dot(inwards)
        };
        self.edges().map(inside).fold(f64::INFINITY, f64::min)
    }
}

/// Twice the area, as a vector along the normal.
fn newell(corners: &[DVec3]) -> DVec3 {
    let Some(&origin) = corners.first() else {
        return DVec3::ZERO;
    };
    let pairs = corners.windows(2);
    pairs
        .map(|pair| (pair[0] - origin).cross(pair[1] - origin))
        .sum()
}

fn extent(corners: &[DVec3]) -> f64 {
    let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (low, high) = corners
        .iter()
        .fold(start, |(low, high), c| (low.min(*c), high.max(*c)));
    if corners.is_empty() {
        0.0
    } else {
        low.distance(high)
    }
}

fn turns_once(corners: &[DVec3], normal: DVec3) -> bool {
    let count = corners.len();
    let edge = |i: usize| corners[(i + 1) % count] - corners[i % count];
    let turn = |i: usize| {
        let (a, b) = (edge(i), edge(i + 1));
        libm::atan2(a.cross(b).dot(normal), a.dot(b))
    };
    let sum: f64 = (0..count).map(turn).sum();
    (sum - 2.0 * PI).abs() < 0.1
}

/// What is wrong with the name of a fracture, if anything.
pub fn check_name(name: &str) -> Result<(), (String, String)> {
    let reserved = [
        "rock", "default", "left", "right", "front", "back", "bottom", "top",
    ];
    if name.is_empty() {
        return Err((
            "the name is empty".into(),
            "give a name, e.g. fault-1".into(),
        ));
    }
    if reserved.contains(&name) {
        let problem = format!("the name `{name}` means something else in a scene");
        let remedy = format!("choose another, e.g. `{name}-fracture`");
        return Err((problem, remedy));
    }
    if name
        .chars()
        .any(|c| c.is_control() || c == '"' || c == '\\' || c == '%')
    {
        let problem = format!(
            "the name `{}` holds characters that gmsh mistakes",
            name.escape_debug()
        );
        return Err((problem, "use letters, digits, `-`, `_` and spaces".into()));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEVEL: Orientation = Orientation {
        dip: 0.0,
        dip_direction: 0.0,
    };

    #[test]
    fn outlines_have_the_areas_of_their_shapes() {
        let tilted = Orientation {
            dip: 50.0,
            dip_direction: 200.0,
        };
        let rotation = 20.0;
        for (outline, area) in [
            (
                Outline::Disc {
                    radius: 2.0,
                    sides: 12,
                    rotation,
                },
                4.0 * PI,
            ),
            (
                Outline::Ellipse {
                    semi_major: 3.0,
                    semi_minor: 1.0,
                    rotation,
                    sides: 7,
                },
                3.0 * PI,
            ),
            (
                Outline::Rectangle {
                    length: 3.0,
                    width: 2.0,
                    rotation,
                },
                6.0,
            ),
        ] {
            let polygon = Polygon::placed(outline, DVec3::new(1.0, 2.0, 3.0), tilted);
            assert!((polygon.area() - area).abs() < 1e-12 * area, "{outline:?}");
            let sound = Polygon::through(polygon.corners()).expect("convex and planar");
            assert!(sound.normal().distance(polygon.normal()) < 1e-12);
        }
    }

    #[test]
    fn a_rectangle_has_its_length_along_the_strike() {
        let east = Orientation {
            dip: 90.0,
            dip_direction: 90.0,
        };
        let outline = Outline::Rectangle {
            length: 4.0,
            width: 2.0,
            rotation: 0.0,
        };
        let (low, high) = Polygon::placed(outline, DVec3::ZERO, east).bounds();
        assert!((high - low).distance(DVec3::new(0.0, 4.0, 2.0)) < 1e-14);
        let outline = Outline::Rectangle {
            length: 4.0,
            width: 2.0,
            rotation: 90.0,
        };
        let (low, high) = Polygon::placed(outline, DVec3::ZERO, east).bounds();
        assert!((high - low).distance(DVec3::new(0.0, 2.0, 4.0)) < 1e-14);
    }

    #[test]
    fn depth_counts_from_the_nearest_edge() {
        let outline = Outline::Rectangle {
            length: 4.0,
            width: 2.0,
            rotation: 0.0,
        };
        let polygon = Polygon::placed(outline, DVec3::ZERO, LEVEL);
        assert!((polygon.depth(DVec3::ZERO) - 1.0).abs() < 1e-15);
        assert!((polygon.depth(DVec3::new(0.0, 3.0, 0.0)) + 2.0).abs() < 1e-15);
    }

    #[test]
    fn corners_that_make_no_convex_polygon_are_refused() {
        let point = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let arrow = [
            point(0.0, 0.0),
            point(2.0, 0.0),
            point(0.5, 0.5),
            point(0.0, 2.0),
        ];
        let bow = [
            point(0.0, 0.0),
            point(3.0, 2.0),
            point(3.0, 0.0),
            point(0.0, 1.0),
        ];
        let double = [
            point(0.0, 0.0),
            point(1.0, 0.0),
            point(1.0, 0.0),
            point(0.0, 1.0),
        ];
        for corners in [arrow, bow, double] {
            let (problem, _) = Polygon::through(&corners).expect_err("refused");
            assert!(problem.contains("not convex"), "{problem}");
        }
        let line = [point(0.0, 0.0), point(1.0, 0.0), point(2.0, 0.0)];
        assert!(Polygon::through(&line).is_err());
        let bent = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.3), DVec3::Y];
        let (problem, _) = Polygon::through(&bent).expect_err("refused");
        assert!(problem.contains("off the common plane"), "{problem}");
    }

    #[test]
    fn a_pentagram_is_refused() {
        let corner = |i: usize| {
            let (sin, cos) = libm::sincos(i as f64 * 4.0 * PI / 5.0);
            DVec3::new(cos, sin, 0.0)
        };
        assert!(Polygon::through(&std::array::from_fn::<_, 5, _>(corner)).is_err());
    }

    #[test]
    fn names_that_scenes_or_gmsh_mistake_are_refused() {
        for name in ["", "top", "a\"b", "a\nb", "100%"] {
            assert!(check_name(name).is_err(), "{name:?}");
        }
        for name in ["fault-1", "Große Kluft", "set 1/fracture 2"] {
            assert!(check_name(name).is_ok(), "{name:?}");
        }
    }
}
