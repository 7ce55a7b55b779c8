//! Meshes a scene until the estimated error meets a tolerance.

use std::path::Path;
use std::time::Instant;

use kluft_io::{write_msh, write_size_field};
use kluft_mesh::Mesh;
use kluft_scene::{Adapt, AdaptBy, MeshSource};
use kluft_solver::target_sizes;

use crate::accuracy::Accuracy;
use crate::prepare::{MESH, read_mesh};
use crate::stages::{Interruption, Run};
use crate::summary::MeshTrial;

/// File of the sizes that the last mesh was made with.
pub const SIZES: &str = "sizes.pos";

/// Leaves a mesh on which the estimated error meets the tolerance of the scene, or the budget is
/// spent. A run that goes on from no other removes what a former one has written once a mesh is
/// there.
///
/// # Errors
/// As a run on any of the meshes.
pub fn search(run: &mut Run<'_>) -> Result<(), Interruption> {
    let MeshSource::Geometry {
        adapt: Some(adapt), ..
    } = run.request.scene.mesh
    else {
        return Ok(());
    };
    if run.has_own_mesh {
        return Ok(());
    }
    let mut aim = adapt.tolerance;
    for number in 1..=adapt.max_rounds {
        let start = Instant::now();
        let binding = run.prepare(None)?;
        if number == 1 {
            run.remove_former()?;
        }
        let (unknowns, accuracy) = run.trial(&binding)?;
        let problem = &binding.problem;
        let error = accuracy.to_meet();
        let seconds = start.elapsed().as_secs_f64();
        run.observer.note(
            "adapted",
            &format!(
                "mesh {number}: {unknowns} unknowns, off by at most {:.2} % ({seconds:.1} s)",
                100.0 * error
            ),
        );
        run.summary.meshes.push(MeshTrial {
            unknowns,
            error,
            seconds,
        });
        run.keep_mesh();
        let is_met = error <= adapt.tolerance;
        if is_met || number == adapt.max_rounds || unknowns as f64 >= FULL * adapt.max_unknowns {
            // The others are taken again with the mesh that stays.
            run.summary.decisions = vec![stopped(&adapt, is_met, error)];
            break;
        }
        if number > 1 && error < NEAR * adapt.tolerance {
            // The last mesh fell short of its prediction, and so will the next.
            aim *= adapt.tolerance / error;
        }
        let budget = adapt.max_unknowns / unknowns as f64;
        let sizes = next_sizes(&problem.mesh, &accuracy, aim);
        let sizes = scaled(&problem.mesh, sizes, adapt.by, budget);
        match adapt.by {
            AdaptBy::Meshing => {
                let write = |path: &Path| write_size_field(path, &problem.mesh, &sizes);
                run.output.write(SIZES, write)?;
                run.mesh_again_with(run.output.path(SIZES));
            }
            AdaptBy::Bisection => run.bisect(&problem.mesh, &sizes)?,
        }
    }
    Ok(())
}

/// Multiple of the tolerance from which on predictions are trusted to compare.
const NEAR: f64 = 4.0;
/// Part of the largest number of unknowns that counts as having used it: gmsh does not hit numbers.
const FULL: f64 = 0.7;

/// Least growth of the number of cells that a mesh is asked for after one that is not good enough
/// (gmsh makes fewer where they are large): on ever coarser meshes estimates mean nothing.
const LEAST_GROWTH: f64 = 1.6;
/// The same of bisection, which divides just the cells that are too large.
const LEAST_GROWTH_BY_BISECTION: f64 = 1.1;
/// Factor on sizes by which those of bisection are sought.
const SCALE_STEP: f64 = 1.05;

fn stopped(adapt: &Adapt, is_met: bool, error: f64) -> String {
    let (error, tolerance) = (100.0 * error, 100.0 * adapt.tolerance);
    if is_met {
        return format!("adaptive mesh: off by at most {error:.2} %, {tolerance} % was asked for");
    }
    format!(
        "adaptive mesh: the budget is spent at {error:.2} %, {tolerance} % was asked for \
         (max_unknowns or max_rounds under [mesh] adapt allow more, order = 2 needs less)"
    )
}

/// Sizes with which the error should fall to `aim`.
fn next_sizes(mesh: &Mesh, accuracy: &Accuracy, aim: f64) -> Vec<f64> {
    match &accuracy.jumps {
        Some(jumps) => target_sizes(mesh, &jumps.of_cell, &jumps.nearest_fracture, aim),
        None => {
            // The energy of the error is the square of what the tolerance speaks of.
            let groups = vec![0; mesh.cells.len()];
            target_sizes(mesh, &accuracy.energy_shares, &groups, aim * aim)
        }
    }
}

/// Sizes scaled so that the number of cells grows enough for the error to fall, and at most by
/// `budget`.
fn scaled(mesh: &Mesh, mut sizes: Vec<f64>, by: AdaptBy, budget: f64) -> Vec<f64> {
    let parts = parts(mesh, &sizes);
    let scale = match by {
        AdaptBy::Meshing => {
            let growth = parts.iter().sum::<f64>() / parts.len() as f64;
            let excess = growth / growth.max(LEAST_GROWTH).min(budget);
            match dimension(mesh) {
                2 => excess.sqrt(),
                _ => excess.cbrt(),
            }
        }
        AdaptBy::Bisection => bisection_scale(&parts, budget, dimension(mesh)),
    };
    sizes.iter_mut().for_each(|size| *size *= scale);
    sizes
}

/// In how many directions cells are divided.
fn dimension(mesh: &Mesh) -> i32 {
    if mesh.is_plane() { 2 } else { 3 }
}

/// Factor on sizes with which bisection divides at least a few of the cells and no more than the
/// budget allows.
fn bisection_scale(parts: &[f64], budget: f64, dimension: i32) -> f64 {
    // A cell stays whole or is divided into a power of two.
    let count = |parts: f64| parts.log2().round().max(0.0).exp2();
    let growth = |scale: f64| {
        let counts = parts
            .iter()
            .map(|parts| count(parts / scale.powi(dimension)));
        counts.sum::<f64>() / parts.len() as f64
    };
    let mut scale = 1.0;
    while growth(scale) < LEAST_GROWTH_BY_BISECTION {
        scale /= SCALE_STEP;
    }
    while growth(scale) > budget.max(LEAST_GROWTH_BY_BISECTION) {
        scale *= SCALE_STEP;
    }
    scale
}

impl Run<'_> {
    /// Bisects the cells of the mesh that was solved on where they are larger than these sizes of
    /// its nodes (m).
    fn bisect(&mut self, mesh: &Mesh, sizes: &[f64]) -> Result<(), Interruption> {
        let start = Instant::now();
        let scale = self.request.scene.scale;
        let cells = 0..mesh.cells.len();
        let targets: Vec<f64> = cells.map(|cell| size(mesh, sizes, cell) / scale).collect();
        let scratch = self.output.unfinished("");
        let mut draft = read_mesh(&self.output.path(MESH), 0, &scratch, &self.request.gmsh)?;
        draft.bisect(&targets)?;
        let count = draft.cells.elements.len();
        self.output.write(MESH, |path| write_msh(path, &draft))?;
        self.observer.note(
            "bisected",
            &format!(
                "{} -> {count} cells ({:.2} s)",
                mesh.cells.len(),
                start.elapsed().as_secs_f64()
            ),
        );
        self.summary.decisions.clear();
        Ok(())
    }
}

/// Geometric mean of sizes at the corners of a cell.
fn size(mesh: &Mesh, sizes: &[f64], cell: usize) -> f64 {
    let corners = &mesh.cells.nodes_of(cell)[..mesh.cells.shapes[cell].corner_count()];
    let logarithms = corners.iter().map(|&node| sizes[node as usize].ln());
    (logarithms.sum::<f64>() / corners.len() as f64).exp()
}

/// Number of cells with these sizes in the place of each cell, going by regular tetrahedra, in a
/// mesh of the plane by regular triangles; its cells are one metre thick.
fn parts(mesh: &Mesh, sizes: &[f64]) -> Vec<f64> {
    let of_cell = |cell: usize| {
        let size = size(mesh, sizes, cell);
        let volume =
            kluft_mesh::cell_volume(mesh.cells.shapes[cell], &mesh.corners(&mesh.cells, cell));
        match mesh.is_plane() {
            true => 4.0 / 3.0_f64.sqrt() * volume / (size * size),
            false => 72.0_f64.sqrt() * volume / (size * size * size),
        }
    };
    (0..mesh.cells.len()).map(of_cell).collect()
}
