//! Single steps of a flow that follows the walls of the joint of a cube, over decades of what they
//! depend on.

use kluft_mesh::Shape;

use crate::report::{Effort, digits};
use crate::scenes::flowing_cube::{APERTURE, PRESSURE, STRESS, Trial, cube};

use super::coupled_steps::Case;

/// All groups.
pub(super) fn sweeps(effort: Effort) -> Vec<Case> {
    let groups = [steps, contrasts, openings, drawdowns, closings];
    groups.iter().flat_map(|group| group(effort)).collect()
}

/// One step of a trial on the cube.
fn tried(group: &'static str, (what, value): (String, f64), trial: Trial) -> Case {
    let path = trial.taken(&cube(Shape::Hex8, 6));
    Case::of(group, what, value, (&path, trial.aperture()))
}

fn steps(effort: Effort) -> Vec<Case> {
    let (stiffnesses, decades): (&[f64], &[i32]) = match effort {
        Effort::Quick => (&[1e11], &[-9, 0, 9]),
        Effort::Full => (
            &[1e9, 1e10, 1e11, 1e13],
            &[-9, -7, -5, -3, -1, 0, 1, 3, 5, 7, 9],
        ),
    };
    let mut cases = Vec::new();
    for &stiffness in stiffnesses {
        for (compressibility, fluid) in [(0.0, "incompressible"), (4.5e-10, "water")] {
            for &decade in decades {
                let step = 10_f64.powi(decade);
                let trial = Trial {
                    inlet: Some(15e6),
                    compressibility,
                    ..Trial::of(stiffness, Some(step))
                };
                let what = format!("K_n {stiffness:e}, {fluid}, {step:e} diffusion times");
                cases.push(tried("time steps", (what, step), trial));
            }
        }
    }
    cases
}

/// Joints that pressures open, one of them closed to less than a millionth.
fn openings(effort: Effort) -> Vec<Case> {
    let (stiffnesses, shares): (&[f64], &[f64]) = match effort {
        Effort::Quick => (&[1e9], &[0.8, 1.2]),
        Effort::Full => (&[5.2e8, 1e9, 1e10, 1e11], &[0.6, 0.8, 0.95, 1.0, 1.2]),
    };
    let steps = [1e-6, 1e-3, 1.0, 1e4];
    let cases = stiffnesses.iter().flat_map(|&stiffness| {
        let pairs = shares.iter();
        pairs.flat_map(move |&share| steps.map(|step| (stiffness, share, step)))
    });
    let cases = cases.map(|(stiffness, share, step)| {
        let trial = Trial {
            inlet: Some(share * STRESS),
            ..Trial::of(stiffness, Some(step))
        };
        let closed = trial.aperture() / APERTURE;
        let what = format!(
            "from {} of the aperture, {share} of the stress, {step:e} diffusion times",
            digits(closed)
        );
        tried("opening", (what, share), trial)
    });
    cases.collect()
}

/// Loads on a joint whose fluid leaves slowly through one end.
fn closings(effort: Effort) -> Vec<Case> {
    let pairs = match effort {
        Effort::Quick => vec![(1.0, 1e-6), (1.0, 1.0), (100.0, 1e-6), (1.0, 1e6)],
        Effort::Full => [0.1, 1.0, 10.0, 100.0]
            .into_iter()
            .flat_map(|load| [1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6].map(|step| (load, step)))
            .collect(),
    };
    let pairs = pairs.into_iter();
    let cases = pairs.map(|(load, step)| {
        let trial = Trial {
            inlet: Some(PRESSURE),
            load: Some(load * 1e11 * APERTURE),
            ..Trial::of(1e11, Some(step))
        };
        let what = format!("{load} K_n b0 in {step:e} diffusion times");
        tried("closing", (what, load), trial)
    });
    cases.collect()
}

/// Joints from which a pressure of 1 MPa draws the water.
fn drawdowns(effort: Effort) -> Vec<Case> {
    let (stiffnesses, steps): (&[f64], &[f64]) = match effort {
        Effort::Quick => (&[1e10], &[1.0]),
        Effort::Full => (&[1e9, 1e10, 1e11, 1e13], &[1e-6, 1e-3, 1.0, 1e4]),
    };
    let pairs = stiffnesses.iter();
    let pairs = pairs.flat_map(|&stiffness| steps.iter().map(move |&step| (stiffness, step)));
    let cases = pairs.map(|(stiffness, step)| {
        let trial = Trial {
            inlet: Some(1e6),
            ..Trial::of(stiffness, Some(step))
        };
        let what = format!("K_n {stiffness:e}, {step:e} diffusion times");
        tried("drawdown", (what, step), trial)
    });
    cases.collect()
}

/// Rock that is soft or stiff beside the joint.
fn contrasts(effort: Effort) -> Vec<Case> {
    let (moduli, stiffnesses): (&[f64], &[f64]) = match effort {
        Effort::Quick => (&[1e7, 1e13], &[1e10]),
        Effort::Full => (
            &[1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13],
            &[1e9, 1e10, 1e11, 1e12, 1e14],
        ),
    };
    let pairs = moduli.iter();
    let pairs = pairs.flat_map(|&modulus| stiffnesses.iter().map(move |&own| (modulus, own)));
    let cases = pairs.map(|(modulus, stiffness)| {
        let trial = Trial {
            inlet: Some(15e6),
            young_modulus: modulus,
            ..Trial::of(stiffness, Some(1.0))
        };
        let what = format!("E {modulus:e}, K_n {stiffness:e}, 1 diffusion time");
        tried("contrast", (what, modulus), trial)
    });
    cases.collect()
}
