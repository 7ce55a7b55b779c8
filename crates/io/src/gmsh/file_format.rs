//! The format of the file that gmsh writes, where a geometry chooses another.

use std::io::Write;
use std::path::Path;

use kluft_mesh::Defect;

use super::script::{Token, Tokens};
use crate::atomic::write_atomically;

/// Options of gmsh that choose a format, and what they are for binary MSH 4.1.
const OPTIONS: [(&str, f64); 3] = [("Format", 1.0), ("MshFileVersion", 4.1), ("Binary", 1.0)];

/// Whether a script names one of the options: they count more than those of the command line.
pub(super) fn is_chosen(scripts: &[Vec<u8>]) -> bool {
    scripts.iter().any(|script| {
        let mut words = Tokens::of(script).map(|(_, token)| token);
        words.any(|word| OPTIONS.iter().any(|(name, _)| word == Token::Word(name)))
    })
}

/// Writes a script that chooses the format again; gmsh reads it after the geometry.
pub(super) fn write_script(path: &Path) -> Result<(), Defect> {
    write_atomically(path, |out| {
        OPTIONS
            .iter()
            .try_for_each(|(name, value)| writeln!(out, "Mesh.{name} = {value};"))
    })
}
