//! Pictures of fractures in their body.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::DVec3;

use crate::colours;
use crate::raster::Raster;
use crate::scale::Scale;
use crate::surface::{Surface, bounds};
use crate::text::escaped;
use crate::view::View;

/// Of a picture (pixels).
const SIZE: [usize; 2] = [640, 480];
/// Points across and down of a pixel.
const FINE: usize = 2;
/// Free edge, as a share of the picture.
const EDGE: f64 = 0.04;
/// Of fractures that are smaller than this share of the body, the body is not shown.
const SMALL: f64 = 0.4;
/// Half the width of a line (pixels).
const HALF_WIDTH: f64 = 2.5;
/// Length of an axis in the corner (pixels).
const AXIS: f64 = 46.0;
/// Corners of a box that an edge joins: those that differ in one bit.
const EDGES: [[usize; 2]; 12] = [
    [0, 1],
    [0, 2],
    [0, 4],
    [1, 3],
    [1, 5],
    [2, 3],
    [2, 6],
    [3, 7],
    [4, 5],
    [4, 6],
    [5, 7],
    [6, 7],
];

/// Fractures as they are seen from one side, with the box of their body.
pub struct Frame<'a> {
    surface: &'a Surface,
    raster: Raster,
    /// Points of the triangles on it.
    triangles: Vec<[u32; 3]>,
    view: View,
    /// Corners of the box on the picture (pixels), and how near they are.
    corners: [DVec3; 8],
    caption: String,
}

impl<'a> Frame<'a> {
    /// Looks at a surface in the box between the lowest and the highest coordinates of a body (m).
    pub fn of(surface: &'a Surface, body: [[f64; 3]; 2]) -> Self {
        let body = bounds(&body).map(|corner| corner - surface.origin);
        let points: Vec<[f64; 3]> = surface.points.iter().map(|p| p.as_dvec3().into()).collect();
        let own = bounds(&points);
        let is_small = own[0].distance(own[1]) < SMALL * body[0].distance(body[1]);
        let shown = if is_small { own } else { body };
        let view = View::of(&surface.points, &surface.triangles);
        let corner = |i: usize| {
            let of_axis = |axis: usize| shown[(i >> axis) & 1][axis];
            view.place(DVec3::new(of_axis(0), of_axis(1), of_axis(2)))
        };
        let corners: [DVec3; 8] = std::array::from_fn(corner);
        let fit = Fit::of(&corners);
        let mut raster = Raster::new(FINE * SIZE[0], FINE * SIZE[1]);
        let places = surface.points.iter();
        let places: Vec<DVec3> = places
            .map(|point| fit.place(view.place(point.as_dvec3())) * FINE as f64)
            .collect();
        let of_points = |triangle: &[u32; 3]| triangle.map(|corner| places[corner as usize]);
        let facets = surface.triangles.iter();
        let facets = facets.map(|triangle| (*triangle, of_points(triangle)));
        let lines = surface.lines.iter().flat_map(|line| ribbon(*line, &places));
        let mut triangles = Vec::with_capacity(surface.triangles.len() + 2 * surface.lines.len());
        for (number, (corners, places)) in (0..).zip(facets.chain(lines)) {
            raster.add(number, places);
            triangles.push(corners);
        }
        Self {
            surface,
            raster,
            triangles,
            view,
            corners: corners.map(|corner| fit.place(corner)),
            caption: caption(is_small, shown[1] - shown[0], surface.triangles.is_empty()),
        }
    }

    /// What the box is, in words.
    pub fn caption(&self) -> &str {
        &self.caption
    }

    /// A picture of a field with a title; none if there is no such field with a number.
    pub fn picture(&self, field: &str, title: &str, unit: &str) -> Option<Picture> {
        let values = self.surface.field(field)?;
        let scale = Scale::of(values)?;
        let image = png(&self.pixels(|point| scale.share(values[point])))?;
        Some(Picture {
            title: title.to_owned(),
            ends: scale.words(unit),
            svg: self.svg(&STANDARD.encode(image), title),
        })
    }

    /// Red, green, blue and opacity of all pixels.
    fn pixels(&self, share: impl Fn(usize) -> f32) -> Vec<u8> {
        let shades = self.triangles.iter();
        let shades: Vec<f32> = shades.map(|triangle| self.shade(*triangle)).collect();
        let mut pixels = Vec::with_capacity(4 * SIZE[0] * SIZE[1]);
        for pixel in 0..SIZE[0] * SIZE[1] {
            let (column, row) = (FINE * (pixel % SIZE[0]), FINE * (pixel / SIZE[0]));
            let (mut sum, mut count) = ([0.0; 3], 0.0);
            for part in 0..FINE * FINE {
                let seen = self.raster.at(column + part % FINE, row + part / FINE);
                let Some((triangle, shares)) = seen else {
                    continue;
                };
                let corners = self.triangles[triangle].map(|corner| corner as usize);
                let value: f32 = (0..3).map(|i| shares[i] * share(corners[i])).sum();
                let colour = colours::colour(value).map(|part| part * shades[triangle]);
                sum = std::array::from_fn(|i| sum[i] + colour[i]);
                count += 1.0;
            }
            let opacity = 255.0 * count / (FINE * FINE) as f32;
            let mean = sum.map(|part| (part / f32::max(count, 1.0)).round() as u8);
            pixels.extend([mean[0], mean[1], mean[2], opacity.round() as u8]);
        }
        pixels
    }

    /// How bright a triangle is, by its direction to the light, which comes from upper left.
    fn shade(&self, triangle: [u32; 3]) -> f32 {
        let [a, b, c] = triangle.map(|corner| self.surface.points[corner as usize].as_dvec3());
        let normal = (b - a).cross(c - a).normalize_or_zero();
        if normal == DVec3::ZERO {
            return 1.0;
        }
        let View { towards, right, up } = self.view;
        let light = (towards + 0.5 * up - 0.4 * right).normalize();
        // Few steps keep the picture small.
        let bright = (normal.dot(light).abs() * 16.0).round() / 16.0;
        (0.72 + 0.28 * bright) as f32
    }

    fn svg(&self, image: &str, title: &str) -> String {
        let [width, height] = SIZE;
        let (title, caption) = (escaped(title), escaped(&self.caption));
        let behind = self.edges(true);
        let front = self.edges(false);
        let axes = self.axes();
        format!(
            "<svg viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{title}. {caption}\">\
             <path class=\"body behind\" d=\"{behind}\"/>\
             <image width=\"{width}\" height=\"{height}\" href=\"data:image/png;base64,{image}\"/>\
             <path class=\"body\" d=\"{front}\"/><g class=\"axes\">{axes}</g></svg>"
        )
    }

    /// The edges of the box that are behind everything, or those that are not.
    fn edges(&self, behind: bool) -> String {
        let nearest = |a: &usize, b: &usize| self.corners[*a].z.total_cmp(&self.corners[*b].z);
        let farthest = (0..8).min_by(nearest).unwrap_or(0);
        let mut path = String::new();
        for [from, to] in EDGES {
            if [from, to].contains(&farthest) == behind {
                let [from, to] = [from, to].map(|corner| self.corners[corner]);
                let _ = write!(path, "M{:.0} {:.0}L{:.0} {:.0}", from.x, from.y, to.x, to.y);
            }
        }
        path
    }

    /// East, north and up in the lower left corner.
    fn axes(&self) -> String {
        let foot = DVec3::new(58.0, SIZE[1] as f64 - 50.0, 0.0);
        let mut lines = String::new();
        for (name, axis) in [("x", DVec3::X), ("y", DVec3::Y), ("z", DVec3::Z)] {
            let along = self.view.place(axis);
            let along = DVec3::new(along.x, -along.y, 0.0);
            if along == DVec3::ZERO {
                continue;
            }
            let (end, text) = (foot + AXIS * along, foot + (AXIS + 15.0) * along);
            let _ = write!(
                lines,
                "<path d=\"M{:.0} {:.0}L{:.0} {:.0}\"/><text x=\"{:.0}\" y=\"{:.0}\">{name}</text>",
                foot.x,
                foot.y,
                end.x,
                end.y,
                text.x - 6.0,
                text.y + 7.0
            );
        }
        lines
    }
}

/// What the box is, and how it is looked at.
fn caption(is_small: bool, size: DVec3, is_plane: bool) -> String {
    let what = if is_small { "fractures" } else { "body" };
    let lengths = size.to_array();
    let lengths = if is_plane { &lengths[..2] } else { &lengths };
    let lengths = lengths.iter().map(|length| {
        let text = format!("{length:.4}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    });
    let lengths: Vec<String> = lengths.collect();
    let up = if is_plane { "y is up" } else { "z is up" };
    format!("Box of the {what}: {} m; {up}", lengths.join(" × "))
}

/// A line between two points as two triangles: their points, and their places on the picture.
fn ribbon([from, to]: [u32; 2], places: &[DVec3]) -> [([u32; 3], [DVec3; 3]); 2] {
    let [a, b] = [from, to].map(|end| places[end as usize]);
    let along = (b - a).normalize_or_zero();
    let aside = HALF_WIDTH * FINE as f64 * DVec3::new(-along.y, along.x, 0.0);
    [
        ([from, to, to], [a - aside, b - aside, b + aside]),
        ([from, to, from], [a - aside, b + aside, a + aside]),
    ]
}

/// From right, up and near to pixels.
struct Fit {
    scale: f64,
    middle: DVec3,
}

impl Fit {
    /// Fits places into the picture.
    fn of(places: &[DVec3]) -> Self {
        let places: Vec<[f64; 3]> = places.iter().map(|place| place.to_array()).collect();
        let [low, high] = bounds(&places);
        let size = high - low;
        let room = |axis: usize| (1.0 - 2.0 * EDGE) * SIZE[axis] as f64;
        let scale = (room(0) / size.x).min(room(1) / size.y);
        Self {
            scale: if scale.is_finite() { scale } else { 1.0 },
            middle: 0.5 * (low + high),
        }
    }

    /// Across and down (pixels), and towards the viewer.
    fn place(&self, at: DVec3) -> DVec3 {
        let from_middle = self.scale * (at - self.middle);
        let [x, y] = SIZE.map(|size| 0.5 * size as f64);
        DVec3::new(x + from_middle.x, y - from_middle.y, from_middle.z)
    }
}

/// A picture with its title and the ends of its scale.
#[derive(Debug, Clone)]
pub struct Picture {
    title: String,
    ends: Vec<String>,
    svg: String,
}

impl Picture {
    /// As part of a page.
    pub(crate) fn html(&self) -> String {
        let bar = format!("<i style=\"background:{}\"></i>", colours::css());
        let ends: Vec<String> = self.ends.iter().map(|end| escaped(end)).collect();
        let scale = match &ends[..] {
            [low, high] => format!("<span>{low}</span>{bar}<span>{high}</span>"),
            ends => format!("<span>{} everywhere</span>", ends.concat()),
        };
        format!(
            "<figure class=\"picture\">\n<figcaption>{}</figcaption>\n{}\n\
             <div class=\"bar\">{scale}</div>\n</figure>\n",
            escaped(&self.title),
            self.svg
        )
    }
}

/// Pixels as a PNG.
fn png(pixels: &[u8]) -> Option<Vec<u8>> {
    let mut image = Vec::new();
    let mut encoder = png::Encoder::new(&mut image, SIZE[0] as u32, SIZE[1] as u32);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().ok()?;
    writer.write_image_data(pixels).ok()?;
    writer.finish().ok()?;
    Some(image)
}

#[cfg(test)]
mod tests;
