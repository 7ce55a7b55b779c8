//! What is possible but hardly meant, as far as only the mesh shows it.

use kluft_mesh::Mesh;
use kluft_solver::Problem;

use crate::scene::Scene;
use crate::warning::Doubt;

/// Bodies of so many apertures and fewer, and of so many and more, are hardly meant.
const PROPORTIONS: (f64, f64) = (10.0, 1e9);
/// Bodies beyond this are hardly meant (m).
const LARGEST_BODY: f64 = 1e6;

/// What the user should look at twice: values of the scene, the size of the body, and apertures
/// beside their facets.
pub(crate) fn warnings(scene: &Scene, problem: &Problem) -> Vec<String> {
    let values = scene.warnings.iter();
    let values = values.filter_map(|text| scene.warning(Doubt::Values, text));
    let size = body_size(problem);
    let size = size.and_then(|text| scene.warning(Doubt::BodySize, &text));
    let wide = wide_apertures(problem).into_iter();
    let wide = wide.filter_map(|text| scene.warning(Doubt::WideApertures, &text));
    values.chain(size).chain(wide).collect()
}

/// A body whose size is out of proportion to the widest aperture.
fn body_size(problem: &Problem) -> Option<String> {
    let (low, high) = problem.mesh.bounds();
    let longest = (high - low).max_element();
    let apertures = problem.fractures.iter();
    let apertures = apertures.map(|fracture| fracture.law.closure.aperture);
    let widest = apertures.fold(0.0, f64::max);
    let (least, most) = (PROPORTIONS.0 * widest, PROPORTIONS.1 * widest);
    let is_small = longest < least;
    let is_large = longest > LARGEST_BODY || widest > 0.0 && longest > most;
    if !is_small && !is_large {
        return None;
    }
    let (unit, scale) = match is_small {
        true => ("km", 1e3),
        false => ("mm", 1e-3),
    };
    let metres = scale * longest;
    let is_usual = metres >= least && metres < LARGEST_BODY && (widest == 0.0 || metres < most);
    let meant = match is_usual {
        true => format!(
            "; the mesh looks like {unit}: {longest:.4e} {unit} = {metres:.4e} m; coordinates are in metres \
             (`scale = {scale}` under [mesh] converts them)"
        ),
        false => String::new(),
    };
    let aperture = match widest > 0.0 {
        true => format!(" where the widest aperture is {widest:.4e} m"),
        false => String::new(),
    };
    Some(format!(
        "the body is {longest:.4e} m long{aperture}, which is out of proportion{meant}"
    ))
}

/// Fractures that are wider than their facets are long.
fn wide_apertures(problem: &Problem) -> Vec<String> {
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
    wide.collect()
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
