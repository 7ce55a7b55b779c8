//! What of a grid is drawn: triangles, lines in the plane, and values on their corners.

use glam::{DVec3, Vec3};
use kluft_io::{Field, Grid, Values};
use kluft_mesh::Shape;

/// Facets as triangles, those of the plane as lines, with fields on their points.
#[derive(Debug, Clone, Default)]
pub struct Surface {
    /// Middle of the points (m); in single precision they are far enough from each other only
    /// when counted from there.
    pub(crate) origin: DVec3,
    /// Points, from the origin (m).
    pub(crate) points: Vec<Vec3>,
    /// Points of the triangles.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Points of the lines.
    pub(crate) lines: Vec<[u32; 2]>,
    fields: Vec<(&'static str, Vec<f32>)>,
}

impl Surface {
    /// The facets of a grid with its fields of these names on points, vectors by their length.
    pub fn of(grid: &Grid, names: &[&str]) -> Self {
        let [low, high] = bounds(&grid.points);
        let origin = 0.5 * (low + high);
        let points = grid.points.iter();
        let points = points.map(|&point| (DVec3::from(point) - origin).as_vec3());
        let mut triangles = Vec::with_capacity(grid.shapes.len());
        let mut lines = Vec::new();
        for (facet, &shape) in grid.shapes.iter().enumerate() {
            let nodes = &grid.nodes[grid.offsets[facet] as usize..];
            let corners = corners(shape).iter();
            triangles.extend(corners.map(|corners| corners.map(|corner| nodes[corner])));
            let ends = ends(shape).iter();
            lines.extend(ends.map(|ends| ends.map(|end| nodes[end])));
        }
        let fields = grid.point_fields.iter();
        let fields = fields.filter(|field| names.contains(&field.name));
        Self {
            origin,
            points: points.collect(),
            triangles,
            lines,
            fields: fields.map(|field| (field.name, numbers(field))).collect(),
        }
    }

    /// Whether there is nothing to draw.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty() && self.lines.is_empty()
    }

    /// The values of a field on the points; none if there is no such field.
    pub fn field(&self, name: &str) -> Option<&[f32]> {
        let mut fields = self.fields.iter();
        let found = fields.find(|(known, _)| *known == name);
        found.map(|(_, values)| values.as_slice())
    }
}

/// Lowest and highest coordinates of points (m).
pub(crate) fn bounds(points: &[[f64; 3]]) -> [DVec3; 2] {
    let points = points.iter().map(|&point| DVec3::from(point));
    let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let bounds = points.fold(none, |[low, high], point| [low.min(point), high.max(point)]);
    match bounds[0].is_finite() {
        true => bounds,
        false => [DVec3::ZERO; 2],
    }
}

fn numbers(field: &Field) -> Vec<f32> {
    let length = |part: &[f64]| match part {
        [value] => *value as f32,
        vector => vector.iter().map(|x| x * x).sum::<f64>().sqrt() as f32,
    };
    match &field.values {
        Values::Real(values) => values
            .chunks(field.components as usize)
            .map(length)
            .collect(),
        Values::Integer(values) => values.iter().map(|&value| value as f32).collect(),
    }
}

/// The triangles that a facet is drawn as: those between its corners and middles.
fn corners(shape: Shape) -> &'static [[usize; 3]] {
    match shape {
        Shape::Tri3 => &[[0, 1, 2]],
        Shape::Tri6 => &[[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]],
        Shape::Quad4 => &[[0, 1, 2], [0, 2, 3]],
        Shape::Quad8 => &[
            [0, 4, 7],
            [4, 1, 5],
            [5, 2, 6],
            [6, 3, 7],
            [4, 5, 7],
            [5, 6, 7],
        ],
        Shape::Quad9 => &[
            [0, 4, 8],
            [4, 1, 8],
            [1, 5, 8],
            [5, 2, 8],
            [2, 6, 8],
            [6, 3, 8],
            [3, 7, 8],
            [7, 0, 8],
        ],
        _ => &[],
    }
}

/// The lines that a facet of the plane is drawn as: those between its ends and its middle.
fn ends(shape: Shape) -> &'static [[usize; 2]] {
    match shape {
        Shape::Line2 => &[[0, 1]],
        Shape::Line3 => &[[0, 2], [2, 1]],
        _ => &[],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Area of the triangles of a facet whose nodes lie at the places of gmsh.
    fn area(shape: Shape, nodes: &[[f64; 2]]) -> f64 {
        let place = |node: usize| DVec3::new(nodes[node][0], nodes[node][1], 0.0);
        let areas = corners(shape).iter().map(|triangle| {
            let [a, b, c] = triangle.map(place);
            0.5 * (b - a).cross(c - a).z
        });
        areas.sum()
    }

    #[test]
    fn facets_of_every_shape_are_covered_once() {
        let triangle = [
            [0.0, 0.0],
            [1.0, 0.0],
            [0.0, 1.0],
            [0.5, 0.0],
            [0.5, 0.5],
            [0.0, 0.5],
        ];
        assert_eq!(area(Shape::Tri3, &triangle), 0.5);
        assert_eq!(area(Shape::Tri6, &triangle), 0.5);
        let square = [
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, 1.0],
            [0.0, 1.0],
            [0.5, 0.0],
            [1.0, 0.5],
            [0.5, 1.0],
            [0.0, 0.5],
            [0.5, 0.5],
        ];
        for shape in [Shape::Quad4, Shape::Quad8, Shape::Quad9] {
            assert_eq!(area(shape, &square), 1.0, "{shape:?}");
        }
    }

    #[test]
    fn vectors_are_drawn_by_their_length_far_from_the_origin_too() {
        let far = |x: f64| [5e6 + x, 4e5, 0.0];
        let grid = Grid {
            points: vec![far(0.0), far(0.25), [5e6, 4e5 + 0.25, 0.0]],
            shapes: vec![Shape::Tri3],
            offsets: vec![0, 3],
            nodes: vec![0, 1, 2],
            point_fields: vec![Field {
                name: "slip",
                components: 3,
                values: Values::Real(vec![3.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0]),
            }],
            cell_fields: Vec::new(),
        };
        let surface = Surface::of(&grid, &["slip", "aperture"]);
        assert_eq!(surface.field("slip"), Some(&[5.0, 0.0, 1.0][..]));
        assert_eq!(surface.field("aperture"), None);
        assert_eq!((surface.points[1] - surface.points[0]).x, 0.25);
    }
}
