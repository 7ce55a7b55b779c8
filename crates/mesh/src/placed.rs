//! Physical surfaces of outer faces that lie at a place, for meshes that do not name them.

use glam::DVec3;

use crate::doubled::OuterFaces;
use crate::draft::Draft;
use crate::roles::Faces;

/// The outer faces at a place, under a name.
pub struct PlacedSurface<'a> {
    /// Name of the physical surface that they become.
    pub name: &'a str,
    /// Whether a face with these corners (m) lies there.
    pub holds: &'a dyn Fn(&[DVec3]) -> bool,
}

impl Draft {
    /// Makes physical surfaces of outer faces; `faces` are those of this very draft. Returns the
    /// faces of the draft as it is now, and how many each surface holds.
    pub fn name_outer_faces(
        &mut self,
        faces: &Faces,
        surfaces: &[PlacedSurface<'_>],
    ) -> (Faces, Vec<usize>) {
        let nodes: Vec<DVec3> = self.nodes.iter().copied().map(DVec3::from).collect();
        let outer = OuterFaces::of(&self.cells.elements, &faces.adjacency);
        let chosen = surfaces.iter().map(|surface| {
            let own = outer.faces.iter().enumerate();
            let own = own.filter(|(index, _)| {
                let corners = outer.corners(*index, &nodes);
                // The front and the back of a mesh of the plane are no boundary.
                let is_end = self.is_extruded && corners.iter().all(|x| x.z == corners[0].z);
                !is_end && (surface.holds)(&corners)
            });
            own.map(|(_, &face)| face).collect()
        });
        let chosen: Vec<Vec<u32>> = chosen.collect();
        for (surface, own) in surfaces.iter().zip(&chosen) {
            self.add_surface(surface.name, &faces.adjacency, own);
        }
        (Faces::of(self), chosen.iter().map(Vec::len).collect())
    }

    /// Lowest and highest coordinates of the nodes of the cells (m).
    pub fn cell_bounds(&self) -> [DVec3; 2] {
        let used = self.cells.elements.nodes.iter();
        let places = used.map(|&node| DVec3::from(self.nodes[node as usize]));
        places.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], x| {
            [low.min(x), high.max(x)]
        })
    }

    /// Multiplies all coordinates by a factor, as another unit of length does.
    pub fn scale(&mut self, factor: f64) {
        for node in &mut self.nodes {
            *node = node.map(|coordinate| factor * coordinate);
        }
        let pieces = self.curves.iter_mut().flat_map(|curve| &mut curve.pieces);
        for end in pieces.flatten() {
            *end = end.map(|coordinate| factor * coordinate);
        }
    }
}
