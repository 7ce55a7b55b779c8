//! Linear iterations of flow that follows its walls: joints between free cracks and rigid ones,
//! time steps over ten decades, meshes.

use kluft_mesh::Mesh;
use kluft_solver::Field;
use lie_core::{Closure, ClosureKind, FractureLaw};

use crate::report::{Effort, Table};
use crate::scenes::ROCK;
use crate::scenes::flow::VISCOSITY;
use crate::scenes::flowing_cube::{APERTURE, EDGE, PRESSURE, Trial, fine_along};
use crate::scenes::soft_slabs::{as_given, path, times};

/// Most linear iterations of one solve.
const MOST: usize = 25;
/// What the pressure at one end rises by (Pa): it opens a free crack by a few percent.
const RISE: f64 = 1e4;

/// A step.
struct Solved {
    stiffness: f64,
    /// Diffusion times.
    step: f64,
    cells: usize,
    /// Newton iterations; none if it did not converge.
    newton: Option<usize>,
    /// Linear iterations of all of them, and most of one.
    linear: [usize; 2],
}

/// Steps on all meshes.
pub(super) struct Sweep(Vec<Solved>);

/// Solves all steps.
pub(super) fn sweep(effort: Effort) -> Sweep {
    let cells: &[usize] = match effort {
        Effort::Quick => &[8],
        Effort::Full => &[8, 16, 32, 64],
    };
    let mut solved = Vec::new();
    for &cells in cells {
        let mesh = fine_along(cells);
        let (stiffnesses, steps): (&[f64], &[f64]) = match (effort, cells) {
            (Effort::Quick, _) => (&[1e6, 1e14], &[1e-6, 1.0]),
            (Effort::Full, 64) => (&[1e6, 1e10, 1e14], &[1e-6, 1e-2, 1e4]),
            (Effort::Full, _) => (
                &[1e6, 1e8, 1e10, 1e12, 1e14],
                &[1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4],
            ),
        };
        for &stiffness in stiffnesses {
            let of = |&step: &f64| Solved::of(&mesh, cells, [stiffness, step]);
            solved.extend(steps.iter().map(of));
        }
    }
    Sweep(solved)
}

impl Solved {
    /// A step on a mesh with so many cells across, for a stiffness of the joint (Pa/m) and a length
    /// in diffusion times.
    fn of(mesh: &Mesh, cells: usize, [stiffness, step]: [f64; 2]) -> Self {
        let trial = Trial {
            inlet: Some(PRESSURE + RISE),
            ..Trial::of(stiffness, Some(step))
        };
        let schedule = times([(step * diffusion_time(stiffness), 1.0)]);
        let mut problem = trial.problem(mesh, schedule);
        let law = Closure::new(APERTURE, stiffness, ClosureKind::Linear);
        problem.fractures[0].law = FractureLaw::elastic(law, stiffness);
        if let Some(stress) = &mut problem.initial_stress {
            stress.components[2] = Field::constant(-PRESSURE);
        }
        let path = path(&problem, &trial.flow(mesh), as_given());
        let records = path.frames.iter().map(|frame| &frame.record);
        let record = records.chain(&path.failed).next().expect("a step");
        let own = record.iterations.iter().map(|own| own.linear_iterations);
        Self {
            stiffness,
            step,
            cells,
            newton: record.converged().then_some(record.iterations.len()),
            linear: [own.clone().sum(), own.max().unwrap_or(0)],
        }
    }

    fn miss(&self) -> Option<String> {
        let Self {
            stiffness,
            step,
            cells,
            linear: [_, most],
            ..
        } = self;
        let why = match self.newton {
            None => "refused".to_owned(),
            Some(_) if *most > MOST => format!("{most} linear iterations in one"),
            Some(_) => return None,
        };
        let of = format!("{stiffness:e} Pa/m, {step:e} diffusion times, {cells} cells");
        Some(format!("linear solves, {of}: {why}"))
    }
}

/// With the joint and the rock around it side by side (s).
fn diffusion_time(stiffness: f64) -> f64 {
    let conducts = APERTURE.powi(3) / (12.0 * VISCOSITY);
    EDGE * EDGE / ((stiffness + ROCK.young_modulus / EDGE) * conducts)
}

impl Sweep {
    pub(super) fn misses(&self) -> Vec<String> {
        self.0.iter().filter_map(Solved::miss).collect()
    }

    pub(super) fn text(&self) -> String {
        let most = |cells: usize| {
            let own = self.0.iter().filter(|solved| solved.cells == cells);
            own.map(|solved| solved.linear[1]).max()
        };
        let counts = [8, 16, 32, 64].map(|cells| (cells, most(cells)));
        let counts = counts
            .iter()
            .filter_map(|(cells, most)| most.map(|most| format!("{most} on {cells} cells across")));
        let counts: Vec<String> = counts.collect();
        format!(
            "Joints of a linear law, from free cracks of 1e6 Pa/m to rigid ones of 1e14 Pa/m, \
             feel a rise of their pressure by 10 kPa at one end, in steps of 1e-6 to 1e4 \
             diffusion times. Rock and flow together take at most so many iterations of GMRES in \
             one solve: {}.",
            counts.join(", ")
        )
    }

    pub(super) fn table(&self) -> Table {
        let mut table = Table::new(&[
            "K_n (Pa/m)",
            "diffusion times",
            "cells across",
            "Newton iterations",
            "linear iterations",
            "most of an iteration",
        ]);
        for solved in &self.0 {
            let newton = solved.newton;
            table.push([
                format!("{:e}", solved.stiffness),
                format!("{:e}", solved.step),
                solved.cells.to_string(),
                newton.map_or("failed".to_owned(), |count| count.to_string()),
                solved.linear[0].to_string(),
                solved.linear[1].to_string(),
            ]);
        }
        table
    }
}
