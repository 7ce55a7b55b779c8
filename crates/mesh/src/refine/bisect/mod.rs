//! Divides tetrahedra where they are too large, by bisection of edges.
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

use kluft_defect::Defect;

use crate::draft::Draft;
use crate::shape::Shape;
use edges::Edges;

/// Most passes: three halve the edges of a mesh.
const MOST_PASSES: usize = 40;
/// Size against the target above which a cell is bisected: one division more and one less miss the
/// target by the same factor, a sixth root of two.
const TOO_LARGE: f64 = 1.122_462_048_309_373;

impl Draft {
    /// Bisects cells until none is larger than its target, and what their neighbours need. The size
    /// of a cell is the edge of the regular tetrahedron of its volume; `targets` (m) has one for
    /// each cell, infinite where it may stay, and its parts inherit it.
    ///
    /// New nodes of cells of second order lie where the map of their parent has them. Nodes keep
    /// their tags, and of each cell and facet one part; the tags of others follow the highest.
    /// Nodes and cells are numbered anew, along a curve. The result does not depend on the number
    /// of threads.
    ///
    /// # Errors
    /// Cells that are no tetrahedra, and more of them than have numbers of 32 bits.
    ///
    /// # Panics
    /// If `targets` has not one entry a cell.
    pub fn bisect(&mut self, targets: &[f64]) -> Result<(), Vec<Defect>> {
        assert_eq!(
            targets.len(),
            self.cells.elements.len(),
            "one target a cell"
        );
        self.check_tetrahedra()?;
        let mut targets = targets.to_vec();
        for _ in 0..MOST_PASSES {
            let is_large = |cell: usize| self.cell_size(cell) > TOO_LARGE * targets[cell];
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

    fn check_tetrahedra(&self) -> Result<(), Vec<Defect>> {
        let shapes = self.cells.elements.distinct_shapes();
        let others = shapes.into_iter().filter(|shape| shape.corner_count() != 4);
        let defects = others.map(|shape: Shape| {
            let problem = format!("cells of the shape {shape:?} cannot be bisected");
            let remedy = "mesh the volume with tetrahedra";
            Defect::new(&self.source, problem, remedy)
        });
        let defects: Vec<Defect> = defects.collect();
        defects.is_empty().then_some(()).ok_or(defects)
    }

    /// Refuses a pass after which nodes of cells could not be numbered with 32 bits.
    fn check_room(&self, marked: &[bool]) -> Result<(), Vec<Defect>> {
        // At most eight parts of a cell.
        let most = self.cells.elements.nodes.len().saturating_mul(8);
        let nodes = self.nodes.len() + marked.len();
        if most.max(nodes) < u32::MAX as usize {
            return Ok(());
        }
        let problem = "the bisected mesh may have more cells than can be numbered with 32 bits";
        let remedy = "ask for a larger tolerance or fewer unknowns";
        Err(vec![Defect::new(&self.source, problem, remedy)])
    }

    /// Edge of the regular tetrahedron of a cell's volume (m).
    fn cell_size(&self, cell: usize) -> f64 {
        let corner = |local: usize| {
            let node = self.cells.elements.nodes_of(cell)[local];
            glam::DVec3::from(self.nodes[node as usize])
        };
        let [a, b, c] = [1, 2, 3].map(|local| corner(local) - corner(0));
        // `V = a . (b x c) / 6` and, of a regular one, `s^3 / (6 sqrt 2)`.
        (std::f64::consts::SQRT_2 * a.dot(b.cross(c)).abs()).cbrt()
    }
}
