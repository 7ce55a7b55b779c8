//! Cells that fold over themselves, which corners alone do not show.

use glam::DVec3;
use kluft_mesh::{Defect, Shape, sample};
use lie_core::kernel;
use rayon::prelude::*;

use crate::problem::Problem;

/// The cells whose curved edges or warped faces turn a part of them inside out; their stiffness
/// would not be positive.
pub(crate) fn find(problem: &Problem) -> Option<Defect> {
    let mesh = &problem.mesh;
    let is_folded = |cell: &usize| {
        let nodes = mesh.cells.nodes_of(*cell).iter();
        let nodes: Vec<DVec3> = nodes.map(|&node| mesh.nodes[node as usize]).collect();
        let shape = mesh.cells.shapes[*cell];
        // The corners have told all of a linear tetrahedron.
        shape != Shape::Tet4 && kernel::is_folded(shape, &nodes)
    };
    let folded: Vec<u64> = (0..mesh.cells.len())
        .into_par_iter()
        .filter(is_folded)
        .map(|cell| mesh.cell_tags[cell])
        .collect();
    (!folded.is_empty()).then(|| {
        Defect::new(
            format!("{}, cell {}", mesh.source, sample(&folded)),
            "the cell folds over itself: a part of it is inside out",
            "set Mesh.HighOrderOptimize = 1 (curved cells) or Mesh.Optimize = 1, or mesh finer there; at crack fronts \
             cells without quarter points may help",
        )
    })
}
