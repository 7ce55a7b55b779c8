//! What gmsh takes a file for: by its name first, then by how it begins.

use std::fs::File;
use std::io::Read;
use std::path::Path;

/// What gmsh does with a file that it is told to open.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// It obeys it, command by command.
    Script,
    /// It reads a body, a mesh or values from it.
    Data,
    /// It runs a program on it, or the file itself.
    Program,
}

/// Formats that every gmsh knows by the name of the file. Others, and other spellings, it may take
/// for scripts.
const DATA: [&str; 31] = [
    "stl", "STL", "brep", "rle", "brp", "iges", "IGES", "igs", "IGS", "step", "STEP", "stp", "STP",
    "sat", "x_t", "xmt_txt", "x_b", "xmt_bin", "unv", "vtk", "mesh", "diff", "med", "mmed", "rmed",
    "bdf", "nas", "dat", "p3d", "ply2", "ply",
];
/// What `gunzip` or a solver is started for.
const PROGRAMS: [&str; 8] = ["gz", "py", "m", "exe", "pro", "jl", "ol", "rb"];
/// How meshes and views begin.
const HEADS: [&[u8]; 8] = [
    b"$PTS",
    b"$NO",
    b"$PARA",
    b"$ELM",
    b"$MeshFormat",
    b"$Comments",
    b"$PostFormat",
    b"$View",
];

/// What `Merge`, or gmsh itself, does with a file.
pub(super) fn kind(path: &Path) -> Kind {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    if PROGRAMS
        .iter()
        .any(|name| extension.eq_ignore_ascii_case(name))
    {
        Kind::Program
    } else if DATA.contains(&&*extension) || begins_as_data(path) {
        Kind::Data
    } else {
        Kind::Script
    }
}

fn begins_as_data(path: &Path) -> bool {
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| file.take(16).read_to_end(&mut head));
    read.is_ok() && HEADS.iter().any(|begin| head.starts_with(begin))
}
