//! Stiffness of the rock beside a facet.

use kluft_mesh::cell_volume;

use crate::problem::Problem;

/// Stiffness of the cells on both sides of a facet of some area (m^2), in series (Pa/m).
pub(crate) fn spring(problem: &Problem, facet: usize, area: f64) -> f64 {
    let mesh = &problem.mesh;
    let compliance = |cell: u32| {
        let cell = cell as usize;
        let volume = cell_volume(mesh.cells.shapes[cell], &mesh.corners(&mesh.cells, cell));
        volume / area / problem.rock(cell).constrained_modulus()
    };
    1.0 / (compliance(mesh.facets.minus[facet]) + compliance(mesh.facets.plus[facet]))
}
