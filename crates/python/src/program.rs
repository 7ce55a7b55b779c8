//! The program, which the package brings with it.

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use kluft::{Invocation, OwnProgram};
use kluft_io::GmshOptions;
use kluft_program::gmsh::GmshArgs;
use pyo3::prelude::*;

/// How the program calls itself: an interpreter, the script that it is given, the file of the
/// extension, and the folder of the interpreter as the environment has it.
pub type Own = (PathBuf, OsString, PathBuf, PathBuf);

/// Does what the words of a command line say, the name of the program first, and returns the exit
/// code.
#[pyfunction]
pub fn main(py: Python<'_>, words: Vec<OsString>, own: Own) -> u8 {
    let invocation = Invocation {
        words,
        own: Some(own_program(own)),
    };
    py.detach(|| kluft::execute(&invocation))
}

/// How runs in memory start gmsh: as the program does, and until `stop` is true.
pub fn gmsh_options(own: Own, stop: Arc<AtomicBool>) -> GmshOptions {
    GmshOptions {
        stop: Some(stop),
        ..GmshArgs::default().options(Some(&own_program(own)))
    }
}

fn own_program((file, script, code, tools): Own) -> OwnProgram {
    OwnProgram {
        file,
        before: vec![script],
        code,
        tools: Some(tools),
    }
}
