//! Why a command did not end well, and the exit code that says so.

use std::io::Write;
use std::process::ExitCode;

use kluft_io::gmsh::NOT_MESHED;
use kluft_mesh::Defect;

/// Why a command did not end well.
#[derive(Debug, Clone, PartialEq)]
pub enum Failure {
    /// A load step did not converge: where and why.
    NotConverged(String),
    /// gmsh got no further for want of time or space.
    NotMeshed(Defect),
    /// The input is wrong.
    BadInput(Vec<Defect>),
    /// A study did not yield what was wanted of it: why, and what to try.
    NotReached(String),
}

impl From<Vec<Defect>> for Failure {
    fn from(defects: Vec<Defect>) -> Self {
        let of_machine = |defect: &&Defect| defect.code == Some(NOT_MESHED);
        match defects.iter().find(of_machine) {
            Some(defect) => Self::NotMeshed(defect.clone()),
            None => Self::BadInput(defects),
        }
    }
}

impl From<Defect> for Failure {
    fn from(defect: Defect) -> Self {
        Self::BadInput(vec![defect])
    }
}

impl Failure {
    /// Prints it to the standard error stream.
    pub fn print(&self) {
        let mut err = std::io::stderr().lock();
        // With the error stream gone there is nobody left to tell.
        let _ = match self {
            Self::NotConverged(why) => writeln!(err, "not converged: {why}"),
            Self::NotMeshed(defect) => writeln!(err, "{NOT_MESHED}: {defect}"),
            Self::NotReached(why) => writeln!(err, "not reached: {why}"),
            Self::BadInput(defects) => {
                let count = defects.len();
                let noun = if count == 1 { "defect" } else { "defects" };
                let lines: Vec<String> = defects.iter().map(ToString::to_string).collect();
                writeln!(err, "{count} {noun} in the input\n{}", lines.join("\n"))
            }
        };
    }

    /// The exit code of the program.
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::NotConverged(_) | Self::NotReached(_) | Self::NotMeshed(_) => ExitCode::from(1),
            Self::BadInput(_) => ExitCode::from(2),
        }
    }
}
