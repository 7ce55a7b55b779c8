//! Random sets of fractures.

use glam::DVec3;
use kluft_mesh::Orientation;

use crate::clip::Domain;
use crate::fisher::Fisher;
use crate::polygon::{Outline, Polygon};
use crate::random::Stream;
use crate::size::SizeLaw;

/// A set that needs more fractures than this was not meant.
const MOST: usize = 100_000;

/// Rests in the domain smaller than this part of the smallest size are crumbs.
const CRUMB: f64 = 0.1;

/// How many fractures a set has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Amount {
    /// So many fractures that reach into the domain.
    Count(usize),
    /// Fractures until their area inside the domain is this part of its volume [m^2/m^3].
    P32(f64),
}

/// The shape of the fractures of a set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FractureShape {
    /// Regular polygons with the area of a disc; the size is the radius of the disc.
    Disc {
        /// Number of corners.
        sides: usize,
    },
    /// Rectangles with the longer side along the strike; the size is half that side.
    Rectangle {
        /// Length over width.
        aspect: f64,
    },
}

/// A random set of fractures.
#[derive(Debug, Clone, PartialEq)]
pub struct StochasticSet {
    /// Its name.
    pub name: String,
    /// Directions of the poles.
    pub orientation: Fisher,
    /// Sizes.
    pub size: SizeLaw,
    /// Shape.
    pub shape: FractureShape,
    /// How many.
    pub amount: Amount,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// A fracture as drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnFracture {
    /// The whole of it.
    pub polygon: Polygon,
    /// Its size (m).
    pub size: f64,
    /// Its pole, which may point down.
    pub pole: DVec3,
    /// Area inside the domain (m^2).
    pub area_inside: f64,
}

impl StochasticSet {
    /// Draws the set, fractures that miss the domain included: centres are uniform in the domain
    /// enlarged by the largest radius, so that the network is as dense at the faces as within. A
    /// fracture of which a crumb is in the domain counts as missing it. The mesh has no say in what
    /// is drawn: a study of finer meshes needs one network.
    ///
    /// # Errors
    /// What makes the set endless, and what to do.
    pub fn draw(&self, domain: &Domain) -> Result<Vec<DrawnFracture>, (String, String)> {
        self.check(domain)?;
        let mut stream = Stream::new(self.seed, &self.name);
        let mut drawn = Vec::new();
        let (mut area, mut count) = (0.0, 0);
        while match self.amount {
            Amount::Count(wanted) => count < wanted,
            Amount::P32(wanted) => area < wanted * domain.volume(),
        } {
            if drawn.len() == 100 * MOST {
                return Err((
                    "hardly any fracture reaches the domain".into(),
                    TOO_MANY.into(),
                ));
            }
            let fracture = self.draw_one(domain, &mut stream);
            area += fracture.area_inside;
            count += usize::from(fracture.area_inside > 0.0);
            drawn.push(fracture);
        }
        Ok(drawn)
    }

    fn check(&self, domain: &Domain) -> Result<(), (String, String)> {
        if self.size.accepted() < 1e-4 {
            let problem = "hardly any size of the lognormal law lies between its bounds";
            return Err((problem.into(), "let min and max enclose the mean".into()));
        }
        let expected = match self.amount {
            Amount::Count(count) => count as f64,
            Amount::P32(p32) => {
                p32 * domain.volume() / (self.shape.area(1.0) * self.size.moment(2.0))
            }
        };
        if expected > MOST as f64 {
            return Err((
                format!("the set would have about {expected:.0} fractures"),
                TOO_MANY.into(),
            ));
        }
        Ok(())
    }

    fn draw_one(&self, domain: &Domain, stream: &mut Stream) -> DrawnFracture {
        let margin = self.shape.reach(self.size.largest());
        let (low, high) = (domain.low - margin, domain.high + margin);
        let coordinate = |axis: usize, stream: &mut Stream| stream.between(low[axis], high[axis]);
        let x = coordinate(0, stream);
        let y = coordinate(1, stream);
        let z = coordinate(2, stream);
        let pole = self.orientation.draw(stream);
        let size = self.size.draw(stream);
        let outline = self.shape.outline(size, stream);
        let polygon = Polygon::placed(outline, DVec3::new(x, y, z), Orientation::of_normal(pole));
        let inside = domain.clip_large(&polygon, CRUMB * self.size.smallest());
        let area_inside = inside.map_or(0.0, |clipped| clipped.area());
        DrawnFracture {
            polygon,
            size,
            pole,
            area_inside,
        }
    }
}

const TOO_MANY: &str = "ask for a smaller p32 or count, for larger fractures or a smaller domain";

impl FractureShape {
    /// Area of a fracture of this size (m^2).
    pub fn area(self, size: f64) -> f64 {
        match self {
            FractureShape::Disc { .. } => std::f64::consts::PI * size * size,
            FractureShape::Rectangle { aspect } => 4.0 * size * size / aspect,
        }
    }

    /// How far a fracture of this size reaches from its centre, at most (m).
    fn reach(self, size: f64) -> f64 {
        match self {
            FractureShape::Disc { sides } => {
                let step = 2.0 * std::f64::consts::PI / sides as f64;
                size * (step / libm::sin(step)).sqrt()
            }
            FractureShape::Rectangle { aspect } => size * (1.0 + aspect.powi(-2)).sqrt(),
        }
    }

    fn outline(self, size: f64, stream: &mut Stream) -> Outline {
        match self {
            FractureShape::Disc { sides } => Outline::Disc {
                radius: size,
                sides,
                rotation: stream.between(0.0, 360.0),
            },
            FractureShape::Rectangle { aspect } => Outline::Rectangle {
                length: 2.0 * size,
                width: 2.0 * size / aspect,
                rotation: 0.0,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOMAIN: Domain = Domain {
        low: DVec3::ZERO,
        high: DVec3::new(10.0, 8.0, 6.0),
    };

    fn set(amount: Amount) -> StochasticSet {
        StochasticSet {
            name: "joints".into(),
            orientation: Fisher {
                mean: Orientation {
                    dip: 70.0,
                    dip_direction: 30.0,
                },
                kappa: 15.0,
            },
            size: SizeLaw::PowerLaw {
                exponent: 2.5,
                min: 0.5,
                max: 4.0,
            },
            shape: FractureShape::Disc { sides: 12 },
            amount,
            seed: 11,
        }
    }

    #[test]
    fn p32_is_reached_within_the_last_fracture() {
        for wanted in [0.1, 0.7, 3.0] {
            let drawn = set(Amount::P32(wanted)).draw(&DOMAIN).expect("drawn");
            let area: f64 = drawn.iter().map(|fracture| fracture.area_inside).sum();
            let last = drawn.last().map_or(0.0, |fracture| fracture.area_inside);
            let target = wanted * DOMAIN.volume();
            assert!(
                area >= target && area - last < target,
                "{area} {last} {target}"
            );
        }
    }

    #[test]
    fn the_count_is_of_fractures_that_reach_the_domain() {
        let drawn = set(Amount::Count(40)).draw(&DOMAIN).expect("drawn");
        assert_eq!(drawn.iter().filter(|one| one.area_inside > 0.0).count(), 40);
        assert!(drawn.len() > 40, "some fall beside it");
    }

    #[test]
    fn a_seed_gives_one_network() {
        let set = set(Amount::Count(10));
        let again = set.draw(&DOMAIN);
        assert_eq!(set.draw(&DOMAIN), again);
        let other = StochasticSet { seed: 12, ..set };
        assert_ne!(other.draw(&DOMAIN), again);
    }

    /// Without the margin, the faces would see half the fractures of the middle.
    #[test]
    fn the_network_is_as_dense_at_the_faces_as_within() {
        let drawn = set(Amount::P32(20.0)).draw(&DOMAIN).expect("drawn");
        let density = |low: f64, high: f64| {
            let slab = Domain {
                low: DVec3::new(low, 0.0, 0.0),
                high: DVec3::new(high, 8.0, 6.0),
            };
            let areas = drawn.iter().filter_map(|one| slab.clip(&one.polygon));
            areas.map(|clipped| clipped.area()).sum::<f64>() / slab.volume()
        };
        let (face, middle) = (density(0.0, 1.0), density(4.5, 5.5));
        assert!((face / middle - 1.0).abs() < 0.15, "{face} {middle}");
    }

    #[test]
    fn endless_sets_are_refused() {
        assert!(set(Amount::P32(1e6)).draw(&DOMAIN).is_err());
        let mut out_of_bounds = set(Amount::Count(1));
        out_of_bounds.size = SizeLaw::Lognormal {
            mean: 1.0,
            sd: 0.1,
            min: 50.0,
            max: 60.0,
        };
        assert!(out_of_bounds.draw(&DOMAIN).is_err());
    }
}
