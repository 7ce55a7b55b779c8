//! Values between samples: positions, each with a value.

use glam::DVec3;
use rstar::RTree;
use rstar::primitives::GeomWithData;

use super::frame::Frame;
use super::grid::Grid;
use super::plane::Triangles;
use super::sample::{Method, Sample};
use crate::coordinate::{Beyond, Coordinate};
use crate::table::Table;

/// Values at positions, and what lies between them.
#[derive(Debug, Clone)]
pub struct Samples {
    all: Vec<Sample>,
    /// 1 for each coordinate that the samples have, and 0 for those that they have not, in which
    /// the values do not vary.
    given: DVec3,
    nearest: RTree<GeomWithData<[f64; 3], usize>>,
    between: Between,
    beyond: Beyond,
}

/// What lies between samples.
#[derive(Debug, Clone)]
enum Between {
    Nothing,
    Line(Frame, Table),
    Plane(Frame, Triangles),
    Grid(Grid),
}

impl Samples {
    /// Samples at places (m), each with a value. Where all have one z, values do not vary along it.
    ///
    /// # Errors
    /// What is wrong with them, or keeps the method from its work, and what helps.
    pub fn of(all: &[([f64; 3], f64)], way: (Method, Beyond)) -> Result<Self, [String; 2]> {
        let Some(([_, _, first], _)) = all.first() else {
            return Err(["there are no samples".into(), "write values".into()]);
        };
        if let Some((place, value)) = all.iter().find(|(_, value)| !value.is_finite()) {
            let problem = format!("the value at {place:?} is {value}");
            return Err([problem, "leave the place out, or give it a value".into()]);
        }
        let is_flat = all.iter().all(|([_, _, z], _)| z == first);
        let given = DVec3::new(1.0, 1.0, f64::from(!is_flat));
        let samples = all.iter().map(|&(place, value)| Sample {
            position: given * DVec3::from(place),
            value,
        });
        Self::new(samples.collect(), given, way)
    }

    /// Samples with the coordinates that `given` has a 1 for; the others are 0.
    ///
    /// # Errors
    /// What keeps the method from its work, and what helps.
    pub(crate) fn new(
        all: Vec<Sample>,
        given: DVec3,
        (method, beyond): (Method, Beyond),
    ) -> Result<Self, [String; 2]> {
        let between = match method {
            Method::Nearest => Between::Nothing,
            Method::Linear => between(&all)?,
        };
        let places = all.iter().enumerate();
        let places =
            places.map(|(index, sample)| GeomWithData::new(sample.position.to_array(), index));
        Ok(Self {
            nearest: RTree::bulk_load(places.collect()),
            all,
            given,
            between,
            beyond,
        })
    }

    /// Number of samples.
    pub fn count(&self) -> usize {
        self.all.len()
    }

    /// The value at a position (m); not a number beyond the samples, unless the nearest is to
    /// serve.
    pub fn at(&self, position: DVec3) -> f64 {
        let position = self.given * position;
        let nearest = || {
            self.nearest(position)
                .map_or(f64::NAN, |sample| sample.value)
        };
        let inside = match &self.between {
            Between::Nothing => return nearest(),
            Between::Line(frame, table) => table.at(DVec3::X * frame.in_frame(position).x, 0.0),
            Between::Plane(frame, triangles) => triangles.at(frame.in_frame(position), &self.all),
            Between::Grid(grid) => grid.at(position),
        };
        match inside.is_nan() && self.beyond == Beyond::Nearest {
            true => nearest(),
            false => inside,
        }
    }

    /// Distance of a position from the nearest sample (m), in the coordinates that samples have.
    pub fn reach(&self, position: DVec3) -> f64 {
        let position = self.given * position;
        let nearest = self.nearest(position);
        nearest.map_or(f64::INFINITY, |sample| sample.position.distance(position))
    }

    fn nearest(&self, position: DVec3) -> Option<&Sample> {
        let found = self.nearest.nearest_neighbor(&position.to_array());
        found.and_then(|found| self.all.get(found.data))
    }
}

impl PartialEq for Samples {
    fn eq(&self, other: &Self) -> bool {
        let method = |samples: &Self| std::mem::discriminant(&samples.between);
        (&self.all, self.given, self.beyond, method(self))
            == (&other.all, other.given, other.beyond, method(other))
    }
}

/// What lies between samples, by how they are spread.
fn between(all: &[Sample]) -> Result<Between, [String; 2]> {
    let positions: Vec<DVec3> = all.iter().map(|sample| sample.position).collect();
    let frame = Frame::of(&positions);
    match frame.dimension {
        0 => Err([
            "there is nothing between samples at one place".into(),
            "give more samples, or write method = \"nearest\"".into(),
        ]),
        1 => {
            let row = |sample: &Sample| [frame.in_frame(sample.position).x, sample.value];
            let rows = all.iter().map(row).collect();
            let table = Table::new(rows, Coordinate::X, 0.0, Beyond::Refuse);
            let table = table.ok_or_else(|| {
                let problem = "two samples lie at one place of their line";
                [problem.to_owned(), "keep one of them".to_owned()]
            })?;
            Ok(Between::Line(frame, table))
        }
        2 => Ok(Between::Plane(frame, Triangles::of(&positions, &frame)?)),
        _ => Grid::of(all).map(Between::Grid).ok_or_else(|| {
            let problem = "the samples lie neither on a line, nor in a plane, nor on a grid whose \
                           planes are those of the axes";
            let remedy = "write method = \"nearest\", or leave out a coordinate in which the value \
                          does not vary";
            [problem.to_owned(), remedy.to_owned()]
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(positions: &[[f64; 3]], value: fn(DVec3) -> f64, beyond: Beyond) -> Samples {
        let sample = |&position: &[f64; 3]| Sample {
            position: position.into(),
            value: value(position.into()),
        };
        let all = positions.iter().map(sample).collect();
        Samples::new(all, DVec3::ONE, (Method::Linear, beyond)).expect("samples")
    }

    fn linear(x: DVec3) -> f64 {
        3.0 + 2.0 * x.x - x.y + 0.5 * x.z
    }

    /// A linear function is its own interpolation, and the walls of triangles have no gaps.
    #[test]
    fn a_linear_function_is_reproduced_on_a_line_in_a_plane_and_on_a_grid() {
        let line = samples(
            &[[0.0, 0.0, 0.0], [2.0, 4.0, 6.0], [1.0, 2.0, 3.0]],
            linear,
            Beyond::Refuse,
        );
        let at = DVec3::new(0.3, 0.6, 0.9);
        assert!((line.at(at) - linear(at)).abs() < 1e-14);
        assert!(line.at(DVec3::new(3.0, 6.0, 9.0)).is_nan());

        // The plane z = x / 2.
        let mut scattered = Vec::new();
        for i in 0..12 {
            for j in 0..9 {
                let (x, y) = (f64::from(i), f64::from(j));
                let shift = if i % 11 * (j % 8) > 0 {
                    0.3 * (x * y).sin()
                } else {
                    0.0
                };
                scattered.push([x + shift, y + 0.5 * shift, 0.5 * (x + shift)]);
            }
        }
        let plane = samples(&scattered, linear, Beyond::Refuse);
        for i in 0..=55 {
            for j in 0..=40 {
                let (x, y) = (0.2 * f64::from(i), 0.2 * f64::from(j));
                let at = DVec3::new(x, y, 0.5 * x);
                assert!((plane.at(at) - linear(at)).abs() < 1e-12, "{at}");
            }
        }
        assert!(plane.at(DVec3::new(11.5, 1.0, 5.75)).is_nan());

        let axis = [0.0, 1.0, 3.0];
        let all = axis.map(|x| axis.map(|y| axis.map(|z| [x, y, z])));
        let grid = samples(all.as_flattened().as_flattened(), linear, Beyond::Nearest);
        for at in [DVec3::new(0.5, 2.0, 2.9), DVec3::ZERO, DVec3::splat(3.0)] {
            assert!((grid.at(at) - linear(at)).abs() < 1e-14);
        }
        assert_eq!(grid.at(DVec3::new(9.0, 0.0, 0.0)), linear(DVec3::X * 3.0));
    }

    #[test]
    fn the_nearest_serves_in_the_coordinates_that_samples_have() {
        let all = [(0.0, 1.0), (10.0, 2.0)];
        let all = all.map(|(x, value)| Sample {
            position: DVec3::X * x,
            value,
        });
        let way = (Method::Nearest, Beyond::Refuse);
        let samples = Samples::new(all.to_vec(), DVec3::X, way).expect("samples");
        let at = DVec3::new(6.0, 1e3, -1e3);
        assert_eq!((samples.at(at), samples.reach(at)), (2.0, 4.0));
    }

    #[test]
    fn samples_without_order_have_no_values_between_them() {
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for positions in [&corners[..], &corners[..1]] {
            let sample = |&position: &[f64; 3]| Sample {
                position: position.into(),
                value: 1.0,
            };
            let all = positions.iter().map(sample).collect();
            let way = (Method::Linear, Beyond::Refuse);
            let [_, remedy] = Samples::new(all, DVec3::ONE, way).expect_err("no order");
            assert!(remedy.contains("nearest"));
        }
    }
}
