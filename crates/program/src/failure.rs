//! Why a command did not end well, and the exit code that says so.

use std::io::{IsTerminal, Write};

use kluft_io::NOT_WRITTEN;
use kluft_io::gmsh::NOT_MESHED;
use kluft_mesh::Defect;

use crate::defects::listed;
use crate::printing::lines;
use crate::report::wants_colours;

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
    /// The machine did not do what was asked of it: a file was not written, no thread was given.
    Machine(Vec<Defect>),
    /// Another program has failed and said why; its exit code.
    Told(u8),
}

impl From<Vec<Defect>> for Failure {
    fn from(defects: Vec<Defect>) -> Self {
        if defects
            .iter()
            .any(|defect| defect.code == Some(NOT_WRITTEN))
        {
            return Self::Machine(defects);
        }
        let of_machine = |defect: &&Defect| defect.code == Some(NOT_MESHED);
        match defects.iter().find(of_machine) {
            Some(defect) => Self::NotMeshed(defect.clone()),
            None => Self::BadInput(defects),
        }
    }
}

impl From<Defect> for Failure {
    fn from(defect: Defect) -> Self {
        vec![defect].into()
    }
}

impl Failure {
    /// Prints it to the standard error stream.
    pub fn print(&self) {
        let mut err = std::io::stderr().lock();
        let has_colours = err.is_terminal() && wants_colours();
        // With the error stream gone there is nobody left to tell.
        let _ = match self {
            Self::NotConverged(why) => writeln!(err, "not converged: {}", lines(why)),
            Self::NotMeshed(defect) => {
                let text = defect.to_string();
                writeln!(err, "{NOT_MESHED}: {}", lines(&text))
            }
            Self::NotReached(why) => writeln!(err, "not reached: {}", lines(why)),
            Self::Machine(defects) => {
                let text: Vec<String> = defects.iter().map(ToString::to_string).collect();
                writeln!(err, "failed: {}", lines(&text.join("\n")))
            }
            Self::BadInput(defects) => write!(err, "{}", listed(defects, has_colours)),
            Self::Told(_) => Ok(()),
        };
    }

    /// The exit code of the program.
    pub fn code(&self) -> u8 {
        match self {
            Self::NotConverged(_) | Self::NotReached(_) | Self::NotMeshed(_) | Self::Machine(_) => {
                1
            }
            Self::BadInput(_) => 2,
            Self::Told(code) => *code,
        }
    }

    /// Whether it says anything: where several processes fail together, some leave it to others.
    pub fn has_words(&self) -> bool {
        match self {
            Self::BadInput(defects) | Self::Machine(defects) => !defects.is_empty(),
            Self::NotConverged(_) | Self::NotReached(_) | Self::NotMeshed(_) => true,
            Self::Told(_) => false,
        }
    }
}
