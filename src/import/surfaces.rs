//! Where a project of OpenGeoSys has its boundaries: parts of a geometry (.gml), or meshes of their
//! own.

use std::collections::BTreeMap;
use std::path::Path;

use kluft_io::import::read_grid;
use kluft_mesh::Draft;

use super::extent::{Extent, NEAR};
use super::faces::add_faces;
use super::tree::Element;

/// What a boundary of a project is for a scene.
#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    /// A point (m).
    Point([f64; 3]),
    /// Comparisons that hold on its faces.
    Faces(String),
    /// Faces of the mesh, in a group of its name.
    Group,
}

impl Extent {
    /// The faces of a body in this box, if it is flat along an axis of the body.
    pub fn part(&self, body: &Self) -> Option<Part> {
        let size = (0..3).map(|axis| body.high[axis] - body.low[axis]);
        let near = NEAR * size.fold(0.0, f64::max);
        let is_flat = |axis: usize| self.high[axis] - self.low[axis] <= near;
        if (0..3).all(is_flat) {
            return Some(Part::Point(self.low));
        }
        let wide = |axis: &usize| body.high[*axis] - body.low[*axis] > near;
        let mut said = Vec::new();
        for (axis, name) in ["x", "y", "z"]
            .into_iter()
            .enumerate()
            .filter(|(axis, _)| wide(axis))
        {
            let (low, high) = (self.low[axis], self.high[axis]);
            let at_end = |a: f64, b: f64| (a - b).abs() <= near;
            let text = match is_flat(axis) {
                true if at_end(low, body.low[axis]) => Some(format!("{name} = min")),
                true if at_end(low, body.high[axis]) => Some(format!("{name} = max")),
                true => Some(format!("{name} = {low}")),
                false if at_end(low, body.low[axis]) && at_end(high, body.high[axis]) => None,
                false => Some(format!(
                    "{} < {name} < {}",
                    low - 1e3 * near,
                    high + 1e3 * near
                )),
            };
            said.extend(text);
        }
        let is_face = (0..3).filter(wide).any(is_flat);
        is_face.then(|| Part::Faces(said.join(", ")))
    }
}

/// The named parts of a geometry file.
///
/// # Errors
/// If it cannot be read.
pub fn read_geometry(path: &Path) -> Result<BTreeMap<String, Extent>, String> {
    let told = |defects: Vec<kluft_mesh::Defect>| {
        let all = defects
            .into_iter()
            .map(|d| format!("{}: {}", d.place, d.problem));
        all.collect::<Vec<_>>().join("; ")
    };
    let root = Element::read(path).map_err(told)?;
    let mut points = BTreeMap::new();
    let mut parts = BTreeMap::new();
    for point in root
        .get("points")
        .into_iter()
        .flat_map(|list| list.all("point"))
    {
        let coordinate = |axis| {
            point
                .attribute(axis)
                .and_then(|text| text.parse::<f64>().ok())
        };
        let (Some(id), [Some(x), Some(y), Some(z)]) =
            (point.attribute("id"), ["x", "y", "z"].map(coordinate))
        else {
            continue;
        };
        points.insert(id.to_owned(), [x, y, z]);
        if let Some(name) = point.attribute("name") {
            parts.extend(Extent::of([[x, y, z]].into_iter()).map(|own| (name.to_owned(), own)));
        }
    }
    let lines = root.get("polylines").into_iter();
    for line in lines.flat_map(|list| list.all("polyline")) {
        let ids = line.all("pnt").map(|point| point.text.as_str());
        let places = ids.filter_map(|id| points.get(id).copied());
        parts.extend(
            line.attribute("name")
                .map(str::to_owned)
                .zip(Extent::of(places)),
        );
    }
    let surfaces = root.get("surfaces").into_iter();
    for surface in surfaces.flat_map(|list| list.all("surface")) {
        let corners = surface.all("element").flat_map(|element| {
            ["p1", "p2", "p3"].map(|corner| element.attribute(corner).unwrap_or_default())
        });
        let places = corners.filter_map(|id| points.get(id).copied());
        parts.extend(
            surface
                .attribute("name")
                .map(str::to_owned)
                .zip(Extent::of(places)),
        );
    }
    Ok(parts)
}

/// A boundary that is a mesh of its own: by comparisons if it is flat along an axis of the body,
/// and else as a group that is added to the body.
pub fn part_of_mesh(
    path: &Path,
    name: &str,
    (body, extent): (&mut Draft, &Extent),
) -> Option<Part> {
    let boundary = read_grid(path).ok()?.draft;
    let own = Extent::of(boundary.nodes.iter().copied())?;
    let part = own.part(extent);
    part.or_else(|| add_faces(body, &boundary, name).map(|()| Part::Group))
}
