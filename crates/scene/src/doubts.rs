//! What is possible but hardly meant, as far as only the mesh shows it.

use kluft_mesh::Mesh;
use kluft_solver::Problem;

use crate::scene::Scene;

/// What the user should look at twice: values of the scene, and apertures beside their cells.
pub fn warnings(scene: &Scene, problem: &Problem) -> Vec<String> {
    let sizes = facet_sizes(&problem.mesh);
    let fractures = problem.mesh.fractures.iter().zip(&problem.fractures);
    let wide = fractures.zip(sizes).filter_map(|((name, fracture), size)| {
        let aperture = fracture.law.closure.aperture;
        (aperture > size).then(|| {
            format!(
                "the aperture of `{name}`, {aperture} m, is larger than its facets ({size:.3e} m on average): the method takes walls for close"
            )
        })
    });
    scene.warnings.iter().cloned().chain(wide).collect()
}

/// Mean length of the edges of the facets of each fracture (m).
fn facet_sizes(mesh: &Mesh) -> Vec<f64> {
    let facets = &mesh.facets;
    let mut sums = vec![(0.0, 0_usize); mesh.fractures.len()];
    for facet in 0..facets.elements.len() {
        let corners = mesh.corners(&facets.elements, facet);
        let ends = corners.iter().cycle().skip(1);
        let (sum, count) = &mut sums[facets.fracture[facet] as usize];
        for (a, b) in corners.iter().zip(ends) {
            *sum += a.distance(*b);
            *count += 1;
        }
    }
    let mean = |(sum, count): (f64, usize)| match count {
        0 => f64::INFINITY,
        count => sum / count as f64,
    };
    sums.into_iter().map(mean).collect()
}
