//! Divides every cell into eight, and facets into four, with their groups; or bisects those that
//! are too large (`bisect`).
//!
//! Tetrahedra are divided by red refinement: four at the corners, and the octahedron between them
//! along its shortest diagonal, so that the inner four keep at least three quarters of the mean
//! ratio of the tetrahedron (docs/design/refinement.md). Hexahedra and prisms become eight of their
//! kind, pyramids six pyramids and four tetrahedra. Every triangle and every quadrangle is divided
//! into four, the same from both sides. Cells of a mesh of the plane become four: they stay one
//! cell thick.

mod bisect;
mod curved;
mod divide;
mod division;
mod layer;
mod map;
mod numbering;
mod size;

use kluft_defect::Defect;

use crate::draft::Draft;
use divide::{CHILDREN, divide};
use size::Counts;

impl Draft {
    /// Divides every cell into eight (a pyramid into six pyramids and four tetrahedra) and every
    /// facet into four, so many times; in a mesh of the plane every cell into four and every facet
    /// into two. New nodes of elements of second order lie where the map of their parent has them:
    /// curved edges stay curved, and straight ones straight.
    ///
    /// Nodes keep their tags, and those of new ones follow the highest. The tag of a child is that
    /// of its parent with its number, from 0 to 9, as another digit. Children stand in the same
    /// groups. Nodes and cells are numbered anew, along a curve; the order of facets is that of
    /// their parents. The result does not depend on the number of threads.
    ///
    /// # Errors
    /// More cells or nodes than have numbers of 32 bits, tags of more digits than have 64 bits.
    pub fn refine(&mut self, times: u32) -> Result<(), Vec<Defect>> {
        if times == 0 {
            return Ok(());
        }
        self.check_size(times)?;
        for _ in 0..times {
            divide(self).map_err(|nodes| vec![self.too_many(nodes, "nodes")])?;
            if self.is_extruded {
                self.keep_lower_layer();
            }
        }
        self.arrange();
        Ok(())
    }

    /// How many cells there are after so many divisions.
    pub fn refined_cells(&self, times: u32) -> u64 {
        let counted = self.counts(times)[0].elements();
        match self.is_extruded {
            true => counted >> times,
            false => counted,
        }
    }

    /// Counts of cells and facets after so many divisions.
    fn counts(&self, times: u32) -> [Counts; 2] {
        [&self.cells, &self.facets].map(|parents| {
            let counts = Counts::of(&parents.elements);
            (0..times).fold(counts, |counts, _| counts.divided())
        })
    }

    fn check_size(&self, times: u32) -> Result<(), Vec<Defect>> {
        let [cells, facets] = self.counts(times);
        // Faces of cells are numbered with facets behind them.
        let faces = cells.face_numbers().saturating_add(facets.elements());
        let entries = faces.max(cells.nodes()).max(facets.nodes());
        if entries >= u64::from(u32::MAX) {
            return Err(vec![self.too_many(cells.elements(), "cells")]);
        }
        self.check_tags(times)
    }

    fn check_tags(&self, times: u32) -> Result<(), Vec<Defect>> {
        let elements = self.cells.tags.iter().chain(&self.facets.tags);
        let element = elements.max().copied().unwrap_or(0);
        let grown = (0..times).try_fold(element, |tag, _| {
            tag.checked_mul(CHILDREN)?.checked_add(CHILDREN - 1)
        });
        let node = self.node_tags.iter().max().copied().unwrap_or(0);
        let last = node.checked_add(u64::from(u32::MAX));
        let found = [("element", element, grown), ("node", node, last)];
        let short = found.into_iter().filter(|(_, _, end)| end.is_none());
        let defects = short.map(|(what, tag, _)| {
            let problem =
                format!("the {what} {tag} leaves no numbers of 64 bits for those of a finer mesh");
            let remedy = "number nodes and elements from 1 on (gmsh: RenumberMeshNodes; \
                          RenumberMeshElements;)";
            Defect::new(&self.source, problem, remedy)
        });
        let defects: Vec<Defect> = defects.collect();
        defects.is_empty().then_some(()).ok_or(defects)
    }

    fn too_many(&self, count: u64, what: &str) -> Defect {
        let problem = format!(
            "the refined mesh would have {count} {what}, more than can be numbered with 32 bits"
        );
        Defect::new(&self.source, problem, "refine less often")
    }
}
