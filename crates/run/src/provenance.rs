//! Where results come from: the program, the call, the machine, and what they were made of.

use std::path::Path;
use std::time::SystemTime;

use kluft_io::Fingerprint;
use kluft_scene::Scene;
use serde::Serialize;

use crate::checkpoint::Identity;
use crate::machine::Machine;
use crate::prepare::inputs;
use crate::request::Request;

/// Where the results of a run come from.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Provenance {
    /// Commit that the program was built from, with `-dirty` behind it if files had changed since;
    /// none if nobody noted it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// How the program was called; none if the run was asked for by another program.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub command: Option<String>,
    /// Version of gmsh, if it made the mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gmsh: Option<String>,
    /// When it began, in UTC (RFC 3339).
    pub began: String,
    /// What it works on.
    pub machine: Machine,
    /// The files that it was made of.
    pub inputs: Vec<InputFile>,
}

/// A file that results were made of.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InputFile {
    /// Its path, as the scene or the call names it.
    pub file: String,
    /// The XXH3 sum of its bytes, 128 bits, in hexadecimal digits.
    pub xxh3_128: String,
}

impl InputFile {
    /// A file with its sum.
    pub fn new(file: &Path, sum: Fingerprint) -> Self {
        Self {
            file: file.display().to_string(),
            xxh3_128: format!("{sum:032x}"),
        }
    }
}

impl Provenance {
    /// That of a run that begins now.
    pub fn of(request: &Request<'_>, identity: &Identity) -> Self {
        let now = SystemTime::now();
        Self {
            commit: request.caller.commit.map(str::to_owned),
            command: request.caller.command.map(str::to_owned),
            gmsh: None,
            began: humantime::format_rfc3339_seconds(now).to_string(),
            machine: Machine::this(),
            inputs: of_identity(request, request.scene, identity),
        }
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
