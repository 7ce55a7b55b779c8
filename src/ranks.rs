//! `kluft run --ranks`: the same scene by the program for many ranks, started by mpiexec.

use std::path::PathBuf;
use std::process::{Command, ExitStatus};

use kluft_mesh::Defect;

use crate::failure::Failure;

/// The program for many ranks; MPI and PETSc are needed by it alone.
const PROGRAM: &str = "kluft-mpi";
/// What starts it.
const LAUNCHER: &str = "mpiexec";

/// Runs `kluft-mpi` with these arguments on so many ranks. What it says it says itself.
///
/// # Errors
/// If it, or mpiexec, cannot be started; [`Failure::Told`] if it did not end well.
pub fn run(ranks: u16, arguments: &[std::ffi::OsString]) -> Result<(), Failure> {
    let program = beside_this_program().unwrap_or_else(|| PROGRAM.into());
    let mut command = Command::new(LAUNCHER);
    command.args(["-n", &ranks.to_string()]);
    command.arg(&program).args(arguments);
    let status = command.status().map_err(|error| {
        let problem = format!("it cannot be started: {error}");
        let remedy = "install MPI (`sh scripts/setup --mpi`), or load its module";
        Failure::Machine(vec![Defect::new(LAUNCHER, problem, remedy)])
    })?;
    match status.success() {
        true => Ok(()),
        false => Err(Failure::Told(code(status))),
    }
}

/// 2 for bad input, as this program has it, and else 1.
fn code(status: ExitStatus) -> u8 {
    match status.code() {
        Some(2) => 2,
        _ => 1,
    }
}

fn beside_this_program() -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?.with_file_name(PROGRAM);
    program.is_file().then_some(program)
}
