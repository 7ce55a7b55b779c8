//! Memory that a run takes, measured: in a process of its own, which does nothing else.

use std::fmt;
use std::fs;
use std::process::Command;

use kluft_mesh::Shape;
use kluft_solver::{Discretisation, LinearMethod, System};

use crate::methods::treatments::{Treatment, solve_assembled};
use crate::scenes::pressed::{Pressed, bent_crack, inclined};
use kluft_run::memory::{peak_bytes, used_bytes};

/// What the program `verify` is started with to measure itself.
const MEASURE: &str = "memory";

/// A scene that can be made again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// The inclined joint.
    Inclined,
    /// The crack that bending half opens, with the shape of its cells and their parts.
    Crack(Shape, usize),
}

/// Shapes of cells that the studies take.
pub const SHAPES: [Shape; 4] = [Shape::Tet4, Shape::Hex8, Shape::Tet10, Shape::Hex20];

impl Place {
    /// Makes the scene.
    pub fn build(self) -> Pressed {
        match self {
            Self::Inclined => inclined(),
            Self::Crack(shape, parts) => bent_crack(shape, parts),
        }
    }

    fn parse(text: &str) -> Option<Self> {
        let Some((name, parts)) = text.split_once('/') else {
            return Some(Self::Inclined);
        };
        let shape = SHAPES
            .into_iter()
            .find(|shape| format!("{shape:?}") == name)?;
        Some(Self::Crack(shape, parts.parse().ok()?))
    }
}

impl fmt::Display for Place {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Inclined => formatter.write_str("inclined"),
            Self::Crack(shape, parts) => write!(formatter, "{shape:?}/{parts}"),
        }
    }
}

/// A run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Run {
    /// Its scene.
    pub place: Place,
    /// How walls are kept apart.
    pub treatment: Treatment,
    /// Stiffness of the treatment (Pa/m).
    pub stiffness: f64,
    /// The linear solver.
    pub linear: LinearMethod,
}

impl Run {
    fn arguments(&self) -> [String; 5] {
        let (name, share) = match self.treatment {
            Treatment::Linear => ("linear", None),
            Treatment::Logarithmic(cutoff) => ("logarithmic", cutoff),
            Treatment::Hyperbolic(largest) => ("hyperbolic", Some(largest)),
            Treatment::Contact => ("contact", None),
            Treatment::Augmented => ("augmented", None),
        };
        [
            self.place.to_string(),
            name.to_owned(),
            share.map_or("none".to_owned(), |share| share.to_string()),
            self.stiffness.to_string(),
            self.linear.to_string(),
        ]
    }

    fn parse(arguments: &[String]) -> Option<Self> {
        let [place, name, share, stiffness, linear] = arguments else {
            return None;
        };
        let share: Option<f64> = share.parse().ok();
        let treatment = match name.as_str() {
            "linear" => Treatment::Linear,
            "logarithmic" => Treatment::Logarithmic(share),
            "hyperbolic" => Treatment::Hyperbolic(share?),
            "contact" => Treatment::Contact,
            "augmented" => Treatment::Augmented,
            _ => return None,
        };
        Some(Self {
            place: Place::parse(place)?,
            treatment,
            stiffness: stiffness.parse().ok()?,
            linear: linear.parse().ok()?,
        })
    }
}

/// Resident memory of a process that made the scene, assembled and solved it (bytes).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Peak {
    /// The most that it had.
    pub process: usize,
    /// By how much it grew during the solve, from analysis to the last iteration, at most.
    pub solve: usize,
}

/// Measures a run in a child process; nothing if that or the system fails.
pub fn measured(run: &Run) -> Option<Peak> {
    let program = std::env::current_exe().ok()?;
    let mut child = Command::new(program);
    let output = child.arg(MEASURE).args(run.arguments()).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    let (process, solve) = text.trim().split_once(' ')?;
    Some(Peak {
        process: process.parse().ok()?,
        solve: solve.parse().ok()?,
    })
}

/// What the child process does: runs what its arguments say, and what it takes, as two numbers in
/// bytes.
pub fn measure(arguments: &[String]) -> Option<String> {
    let run = Run::parse(arguments)?;
    let scene = run.place.build();
    let problem = scene.with(run.treatment.closure(run.stiffness));
    let discretisation = Discretisation::of(&problem).ok()?;
    let system = System::assemble(&problem, discretisation);
    let (before, start) = (peak_bytes(), used_bytes());
    // Linux takes this as: forget the peak (proc_pid_clear_refs(5)).
    fs::write("/proc/self/clear_refs", "5").ok()?;
    solve_assembled(&system, run.treatment, run.stiffness, run.linear)?;
    let after = peak_bytes();
    let solve = after.saturating_sub(start);
    Some(format!("{} {solve}", before.max(after)))
}
