//! Finds out whether and where an interrupted run goes on.

use std::path::Path;

use kluft_io::{Fingerprint, fingerprint, fingerprint_of};
use kluft_mesh::Defect;
use kluft_scene::{MeshSource, Scene};

use crate::checkpoint::{self, Identity, Progress};
use crate::output::Output;
use crate::request::Origin;

/// An interrupted run, or a finished one.
pub struct FormerRun {
    /// What is finished.
    pub progress: Progress<'static>,
    /// Sum of the mesh that it used.
    pub mesh: Fingerprint,
    /// Whether the mesh that gmsh made for it is still there.
    pub mesh_is_kept: bool,
}

impl FormerRun {
    /// Whether all its load steps are finished.
    pub fn is_finished(&self) -> bool {
        self.progress.restart.is_none() && self.progress.flow_restart.is_none()
    }
}

/// What the scene and the program are, for checkpoints; the mesh is not known yet.
pub fn identity(scene: &Scene, origin: Option<Origin<'_>>) -> Identity {
    Identity {
        version: env!("CARGO_PKG_VERSION").into(),
        scene: origin.map_or(0, |origin| fingerprint(origin.text)),
        // One that cannot be read is refused when it is meshed.
        geometry: geometry(scene).and_then(|path| fingerprint_of(path).ok()),
        values: scene
            .value_files()
            .into_iter()
            .map(|file| fingerprint_of(file).unwrap_or_default())
            .collect(),
        mesh: 0,
        ranks: 1,
    }
}

fn geometry(scene: &Scene) -> Option<&Path> {
    match &scene.mesh {
        MeshSource::Geometry { geometry, .. } => Some(geometry),
        MeshSource::File(_) => None,
    }
}

/// The former run of a scene, if its folder holds a checkpoint.
///
/// # Errors
/// A checkpoint that is damaged or belongs to another scene, geometry, mesh or program; results of
/// finished steps that are gone.
pub fn find(
    scene_file: &Path,
    scene: &Scene,
    identity: &Identity,
    output: &Output,
) -> Result<Option<FormerRun>, Vec<Defect>> {
    let path = output.path(checkpoint::NAME);
    let Some(stored) = checkpoint::read(&path).map_err(|defect| vec![defect])? else {
        return Ok(None);
    };
    let mut defects = identity.differences(&stored.identity, scene_file, geometry(scene));
    let mesh = mesh_of(scene, &stored.identity, output);
    let mesh_is_kept = mesh.unwrap_or_else(|defect| {
        defects.push(defect);
        false
    });
    if !defects.is_empty() {
        return Err(defects);
    }
    let progress = stored.progress(&path).map_err(|defect| vec![defect])?;
    if progress.files.len() != progress.flows.len() {
        return Err(vec![checkpoint::other_build(&path)]);
    }
    output.check_steps(&progress.files)?;
    Ok(Some(FormerRun {
        progress,
        mesh: stored.identity.mesh,
        mesh_is_kept,
    }))
}

/// Whether the mesh that gmsh made is still there.
fn mesh_of(scene: &Scene, former: &Identity, output: &Output) -> Result<bool, Defect> {
    match &scene.mesh {
        MeshSource::Geometry { .. } => {
            let kept = fingerprint_of(&output.path("mesh.msh"));
            Ok(kept.is_ok_and(|kept| kept == former.mesh))
        }
        MeshSource::File(file) if fingerprint_of(file)? == former.mesh => Ok(false),
        MeshSource::File(file) => Err(checkpoint::other_mesh(file, false)),
    }
}
