//! Notes what a run is made with and of when it begins.

use std::path::Path;
use std::time::SystemTime;

use kluft_scene::Scene;

use crate::checkpoint::Identity;
use crate::machine::Machine;
use crate::prepare::inputs;
use crate::provenance::{InputFile, Provenance};
use crate::request::Request;

/// The provenance of a run that begins now.
pub fn provenance(request: &Request<'_>, identity: &Identity) -> Provenance {
    let now = SystemTime::now();
    Provenance {
        commit: request.caller.commit.map(str::to_owned),
        command: request.caller.command.map(str::to_owned),
        gmsh: None,
        began: humantime::format_rfc3339_seconds(now).to_string(),
        machine: Machine::this(),
        inputs: of_identity(request, request.scene, identity),
    }
}

/// The scene, its geometry and its files of values.
fn of_identity(request: &Request<'_>, scene: &Scene, identity: &Identity) -> Vec<InputFile> {
    let origin = request.origin.map(|origin| origin.file);
    let files = inputs(origin.unwrap_or(Path::new("")), Some(scene));
    let of_scene = origin.map(|_| identity.scene);
    // Of a mesh that the scene names the sum is known when it has been read.
    let sums = [of_scene, identity.geometry].into_iter();
    let sums = sums.chain(identity.values.iter().map(|&sum| Some(sum)));
    let pairs = files.into_iter().zip(sums);
    pairs
        .filter_map(|(file, sum)| Some(InputFile::new(file, sum?)))
        .collect()
}
