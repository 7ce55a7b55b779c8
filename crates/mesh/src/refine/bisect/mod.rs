//! Divides tetrahedra, in a mesh of the plane triangles, where they are too large, by bisection of
//! edges.
//!
//! A pass marks the longest edge of each tetrahedron that is too large, and goes on marking until
//! every triangle with a marked edge has its longest one marked (A. Plaza and G. F. Carey, "Local
//! refinement of simplicial grids based on the skeleton", Appl. Numer. Math. 32, 2000). Then each
//! tetrahedron is bisected at its marked edges, the longest first. Which of two edges is longer is
//! decided once for the whole mesh, so that both sides of a face divide it alike: the mesh fits
//! together whatever was marked, and fractures, being faces, with it. Longest edges are what keeps
//! angles from falling ever lower (M. C. Rivara 1984).

mod divide;
mod edges;
mod marks;

use glam::DVec3;
use kluft_defect::Defect;

use crate::draft::{Draft, Elements};
use crate::shape::Shape;
use edges::Edges;

/// Most passes: three halve the edges of a mesh.
const MOST_PASSES: usize = 40;
/// Size against the target above which a cell is bisected: one division more and one less miss the
/// target by the same factor, a sixth root of two.
const TOO_LARGE: f64 = 1.122_462_048_309_373;
/// The same of triangles: a fourth root of two.
const TOO_LARGE_IN_PLANE: f64 = 1.189_207_115_002_721;

impl Draft {
    /// Bisects cells until none is larger than its target, and what their neighbours need. The size
    /// of a cell is the edge of the regular tetrahedron of its volume; `targets` (m) has one for
    /// each cell, infinite where it may stay, and its parts inherit it. In a mesh of the plane, as
    /// read, facets are cells, and their sizes the edges of regular triangles.
    ///
    /// New nodes of cells of second order lie where the map of their parent has them. Nodes keep
    /// their tags, and of each cell and facet one part; the tags of others follow the highest.
    /// Nodes and cells are numbered anew, along a curve. The result does not depend on the number
    /// of threads.
    ///
    /// # Errors
    /// Cells that are no tetrahedra or, in the plane, no triangles, and more of them than have
    /// numbers of 32 bits.
    ///
    /// # Panics
    /// If `targets` has not one entry a cell.
    pub fn bisect(&mut self, targets: &[f64]) -> Result<(), Vec<Defect>> {
        let is_plane = self.is_plane();
        let (elements, too_large) = match is_plane {
            true => (&self.facets.elements, TOO_LARGE_IN_PLANE),
            false => (&self.cells.elements, TOO_LARGE),
        };
        assert_eq!(targets.len(), elements.len(), "one target a cell");
        self.check_simplices(elements, is_plane)?;
        let mut targets = targets.to_vec();
        for _ in 0..MOST_PASSES {
            let is_large = |cell: usize| {
                let size = match is_plane {
                    true => self.facet_size(cell),
                    false => self.cell_size(cell),
                };
                size > too_large * targets[cell]
            };
            let large: Vec<usize> = (0..targets.len()).filter(|&cell| is_large(cell)).collect();
            if large.is_empty() {
                break;
            }
            let edges = Edges::of(self);
            let marked = marks::closed(self, &edges, &large);
            self.check_room(&marked)?;
            targets = divide::divide(self, &edges, &marked, &targets);
        }
        self.arrange();
        Ok(())
    }

    fn check_simplices(&self, elements: &Elements, is_plane: bool) -> Result<(), Vec<Defect>> {
        let (corners, remedy) = match is_plane {
            true => (3, "mesh the plane with triangles"),
            false => (4, "mesh the volume with tetrahedra"),
        };
        let shapes = elements.distinct_shapes().into_iter();
        let others = shapes.filter(|shape| shape.corner_count() != corners);
        let defects = others.map(|shape: Shape| {
            let problem = format!("cells of the shape {shape:?} cannot be bisected");
            Defect::new(&self.source, problem, remedy)
        });
        let defects: Vec<Defect> = defects.collect();
        defects.is_empty().then_some(()).ok_or(defects)
    }

    /// Refuses a pass after which nodes of cells could not be numbered with 32 bits.
    fn check_room(&self, marked: &[bool]) -> Result<(), Vec<Defect>> {
        // At most eight parts of a cell, and four of a facet.
        let [cells, facets] = [&self.cells, &self.facets].map(|own| own.elements.nodes.len());
        let most = cells.max(facets).saturating_mul(8);
        let nodes = self.nodes.len() + marked.len();
        if most.max(nodes) < u32::MAX as usize {
            return Ok(());
        }
        let problem = "the bisected mesh may have more cells than can be numbered with 32 bits";
        let remedy = "ask for a larger tolerance or fewer unknowns";
        Err(vec![Defect::new(&self.source, problem, remedy)])
    }

    /// Edge of the regular triangle of a facet's area (m).
    fn facet_size(&self, facet: usize) -> f64 {
        let [a, b] = self.sides(&self.facets.elements, facet);
        // `A = |a x b| / 2` and, of a regular one, `s^2 sqrt(3) / 4`.
        (2.0 / 3.0_f64.sqrt() * a.cross(b).length()).sqrt()
    }

    /// The ways from the first corner of an element to the next ones (m).
    fn sides<const COUNT: usize>(&self, elements: &Elements, element: usize) -> [DVec3; COUNT] {
        let corner = |local: usize| {
            let node = elements.nodes_of(element)[local];
            DVec3::from(self.nodes[node as usize])
        };
        std::array::from_fn(|side| corner(side + 1) - corner(0))
    }

    /// Edge of the regular tetrahedron of a cell's volume (m).
    fn cell_size(&self, cell: usize) -> f64 {
        let [a, b, c] = self.sides(&self.cells.elements, cell);
        // `V = a . (b x c) / 6` and, of a regular one, `s^3 / (6 sqrt 2)`.
        (std::f64::consts::SQRT_2 * a.dot(b.cross(c)).abs()).cbrt()
    }
}
