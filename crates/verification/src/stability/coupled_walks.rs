//! Paths of flow that follows its walls: many small steps, and steps that are divided for the
//! accuracy in time.

use kluft_mesh::{Mesh, Shape};
use kluft_solver::{NewtonSettings, Schedule};

use crate::report::{Effort, Table, digits, largest};
use crate::scenes::flowing_cube::{Trial, cube};
use crate::scenes::soft_slabs::{Path, as_given, equal_steps, path, times};

use super::coupled_steps::{Case, PATH};

/// Steps of a path.
const STEPS: usize = 40;
/// The accuracy in time that walks are measured against.
const FINEST: f64 = 1e-5;
/// What a walk may be off, in accuracies in time: what two halves of a part are off themselves
/// comes on top of what one increment differs from them.
const ALLOWED: f64 = 2.0;

fn trial(stiffness: f64) -> Trial {
    Trial {
        inlet: Some(15e6),
        ..Trial::of(stiffness, None)
    }
}

/// Fills the joint in time.
fn filled(mesh: &Mesh, trial: Trial, (schedule, settings): (Schedule, NewtonSettings)) -> Path {
    let problem = trial.problem(mesh, schedule);
    // A flow that takes time has no outlet.
    let flow = Trial {
        step: Some(1.0),
        ..trial
    };
    path(&problem, &flow.flow(mesh), settings)
}

/// Paths of equal steps through one diffusion time, and of steps that grow from a thousandth of it.
pub(super) fn paths(effort: Effort) -> Vec<Case> {
    let stiffnesses: &[f64] = match effort {
        Effort::Quick => &[1e11],
        Effort::Full => &[1e9, 1e10, 1e11, 1e13],
    };
    let mesh = cube(Shape::Hex8, 6);
    let cases = stiffnesses.iter().flat_map(|&stiffness| {
        let trial = trial(stiffness);
        let whole = trial.diffusion_time();
        let grown = times(growing(24).map(|time| (time * whole, 1.0)));
        let mut schedules = vec![("40 equal steps", equal_steps(STEPS, whole))];
        if effort == Effort::Full {
            schedules.push(("24 steps that grow", grown));
        }
        let mesh = &mesh;
        schedules.into_iter().map(move |(name, schedule)| {
            let path = filled(mesh, trial, (schedule, as_given()));
            let what = format!("K_n {stiffness:e}, {name}");
            Case::of(PATH, what, stiffness, (&path, trial.aperture()))
        })
    });
    cases.collect()
}

/// Ends of steps from a thousandth of a diffusion time on, each longer than the one before by a
/// third.
fn growing(count: u32) -> impl Iterator<Item = f64> {
    let factor = 4.0 / 3.0_f64;
    (1..=count).map(move |step| 1e-3 * (factor.powi(step as i32) - 1.0) / (factor - 1.0))
}

/// What is said of the paths among some cases.
pub(super) fn text_of_paths(cases: &[Case]) -> String {
    let own = || cases.iter().filter(|case| case.group == PATH);
    let mean = largest(own().map(Case::mean));
    let most = own().map(Case::most).max().unwrap_or(0);
    format!(
        "Along a path of small steps, 40 equal ones through a diffusion time or 24 that grow from \
         a thousandth of it, a step takes {} iterations on average in the worst of {} paths, and \
         {most} at most.",
        digits(mean),
        own().count()
    )
}

/// A walk with an accuracy in time.
struct Walk {
    accuracy: f64,
    parts: usize,
    mean: f64,
    most: usize,
    /// Largest difference of an aperture from the finest walk, against its largest change.
    error: f64,
    is_whole: bool,
}

/// Walks of several accuracies.
pub(super) struct Walks(Vec<Walk>);

/// Takes the same steps with several accuracies in time.
pub(super) fn walks(effort: Effort) -> Walks {
    let accuracies: &[f64] = match effort {
        Effort::Quick => &[1e-1, 1e-2],
        Effort::Full => &[1e-1, 1e-2, 1e-3, 1e-4],
    };
    let mesh = cube(Shape::Hex8, 6);
    let trial = trial(1e11);
    let walked = |accuracy: f64| {
        let settings = NewtonSettings {
            time: accuracy,
            ..NewtonSettings::default()
        };
        let ends = growing(24).map(|time| (time * trial.diffusion_time(), 1.0));
        filled(&mesh, trial, (times(ends), settings))
    };
    let finest = walked(match effort {
        Effort::Quick => 1e-3,
        Effort::Full => FINEST,
    });
    let walk = |&accuracy: &f64| Walk::of(accuracy, &walked(accuracy), (&finest, trial.aperture()));
    Walks(accuracies.iter().map(walk).collect())
}

impl Walk {
    fn of(accuracy: f64, path: &Path, (finest, first): (&Path, f64)) -> Self {
        let ends = [path, finest].map(|path| &path.frames.last().expect("steps").apertures);
        let pairs = || ends[0].iter().zip(ends[1]).filter(|(b, _)| b.is_finite());
        let apart = largest(pairs().map(|(own, other)| (own - other).abs()));
        let moved = largest(pairs().map(|(_, other)| (other - first).abs()));
        let records = path.frames.iter().map(|frame| &frame.record);
        let parts: Vec<usize> = records.flat_map(|record| record.substeps.clone()).collect();
        Self {
            accuracy,
            mean: parts.iter().sum::<usize>() as f64 / parts.len() as f64,
            most: parts.iter().copied().max().unwrap_or(0),
            parts: parts.len(),
            error: apart / moved,
            is_whole: path.failed.is_none(),
        }
    }
}

impl Walks {
    pub(super) fn misses(&self) -> Vec<String> {
        let off = |walk: &&Walk| !walk.is_whole || walk.error > ALLOWED * walk.accuracy;
        let told = |walk: &Walk| {
            let Walk {
                accuracy, error, ..
            } = walk;
            format!("time_accuracy {accuracy:e}: apertures are {error:.1e} off")
        };
        self.0.iter().filter(off).map(told).collect()
    }

    pub(super) fn text(&self) -> String {
        let last = self.0.last().expect("walks");
        format!(
            "With a time_accuracy of {:e} the steps that grow are divided into {} parts with {} \
             iterations each on average, {} at most, and apertures are {:.0e} of their change off.",
            last.accuracy,
            last.parts,
            digits(last.mean),
            last.most,
            last.error
        )
    }

    pub(super) fn table(&self) -> Table {
        let mut table = Table::new(&[
            "time_accuracy",
            "parts",
            "iterations a part",
            "most of a part",
            "error of apertures",
        ]);
        for walk in &self.0 {
            table.push([
                format!("{:e}", walk.accuracy),
                walk.parts.to_string(),
                digits(walk.mean),
                walk.most.to_string(),
                format!("{:.1e}", walk.error),
            ]);
        }
        table
    }
}
