//! Where results come from: the program, the call, the machine, and what they were made of.

use std::path::Path;

use kluft_io::Fingerprint;
use serde::Serialize;

use crate::machine::Machine;

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
