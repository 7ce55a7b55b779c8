//! Parts of a load path, and of a flow in time, that no division resolves, in words.

use kluft_scene::{Doubt, Scene};
use kluft_solver::{StepRecord, System, UnresolvedCause};

use crate::failures::facet_place;
use crate::stages::newton_settings;
use crate::summary::StepMeasures;

/// What of the path of a load step is not resolved, and where.
pub fn of_step(system: &System<'_>, record: &StepRecord) -> Option<String> {
    let path = record.unresolved?;
    let place = path.facet_point;
    let place = place.map(|point| facet_place(system.problem(), system, point));
    let what = match path.cause {
        UnresolvedCause::Differs(difference) => format!(
            "however short it is divided, its increments leave jumps uncertain by {:.1} % of the \
             largest",
            100.0 * difference
        ),
        UnresolvedCause::HalvesDoNotEnd => {
            "however short it is divided, one increment leads to an equilibrium, and two shorter \
             ones to none"
                .to_owned()
        }
        UnresolvedCause::Snaps => {
            "no increment, however short, leads to an equilibrium: walls snap to another place, \
             which they were relaxed to"
                .to_owned()
        }
        UnresolvedCause::Falls => "blocks fall through open gaps, and only friction on the walls \
                                   that stop them tells where they come to rest"
            .to_owned(),
    };
    Some(match place {
        Some(place) => format!("{what}, most at {place}"),
        None => what,
    })
}

/// What the user should know of it: the first load step, and how many there are.
pub fn warning(scene: &Scene, steps: &[StepMeasures]) -> Option<String> {
    let told = || {
        (1..)
            .zip(steps)
            .filter(|(_, step)| step.unresolved.is_some())
    };
    let (number, first) = told().next()?;
    let others = others(told().count() - 1);
    let text = format!(
        "the path of the loads is not resolved: in step {number}, {}{others}: walls jump or fall \
         to another place there, and other load steps may lead to another equilibrium; compare a \
         run with more of them",
        first.unresolved.as_deref().unwrap_or_default()
    );
    scene.warning(Doubt::UnresolvedPath, &text)
}

/// What the user should know of load steps whose increments each keep the accuracy asked for, but
/// not all together, against the `largest` jump (m) that they have led to: the worst, and how many
/// there are.
pub fn warning_of_sums(scene: &Scene, steps: &[StepMeasures], largest: f64) -> Option<String> {
    let accuracy = newton_settings(&scene.solver).path;
    let resolved = (1..)
        .zip(steps)
        .filter(|(_, step)| step.unresolved.is_none());
    let errors = resolved.map(|(number, step)| (number, step.path_error_at_one_place));
    let found: Vec<(usize, f64)> = errors
        .filter(|(_, error)| *error > accuracy * largest)
        .collect();
    let (number, error) = *found.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let text = format!(
        "the errors of the increments of step {number} add up to {:.2} % of the largest jump{}: \
         each keeps path_accuracy, their sum does not; ask for a smaller one",
        100.0 * error / largest,
        others(found.len() - 1)
    );
    scene.warning(Doubt::UnresolvedPath, &text)
}

fn others(count: usize) -> String {
    match count {
        0 => String::new(),
        1 => "; so in one step more".to_owned(),
        more => format!("; so in {more} steps more"),
    }
}

/// What the user should know of time steps that are too long: the worst, and how many there are.
pub fn warning_of_time(scene: &Scene, steps: &[StepMeasures]) -> Option<String> {
    let found = (1..).zip(steps);
    let found = found.filter_map(|(number, step)| Some((number, step.time_error?)));
    let found: Vec<(usize, f64)> = found.collect();
    let worst = *found.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    long_time_step(scene, worst, found.len() - 1)
}

/// The same of a step and its error, and so many others.
pub fn long_time_step(
    scene: &Scene,
    (number, error): (usize, f64),
    count: usize,
) -> Option<String> {
    let text = format!(
        "the flow is not resolved in time: in step {number}, divided as far as it is, one time \
         step and two differ by {:.2} % in what the fluid fills or in its pressures{}; name more \
         times there, or allow more by time_accuracy",
        100.0 * error,
        others(count)
    );
    scene.warning(Doubt::LongTimeSteps, &text)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    const SCENE: &str = "[mesh]\nfile = \"m.msh\"\n[rock.default]\nyoung_modulus = \
                         1e10\npoisson_ratio = 0.2\n[boundary.bottom]\ndisplacement = { x = 0.0, y \
                         = 0.0, z = 0.0 }\n";

    fn step(path_error_at_one_place: f64, unresolved: Option<&str>) -> StepMeasures {
        StepMeasures {
            newton_iterations: 1,
            substeps: vec![1],
            linear_iterations: 0,
            force_residual: 0.0,
            increment: 0.0,
            closure_error: 0.0,
            converged: true,
            unresolved: unresolved.map(str::to_owned),
            path_error: path_error_at_one_place,
            path_error_at_one_place,
            time_error: None,
        }
    }

    /// Errors of 1 and 3 um beside a jump of 1 mm: the usual accuracy is 1 um. A step that is told
    /// of anyway is not told of twice.
    #[test]
    fn errors_that_add_up_to_more_than_the_accuracy_are_told() {
        let scene = Scene::parse(SCENE, "s", Path::new(".")).expect("a scene");
        let warning = |steps: &[StepMeasures]| warning_of_sums(&scene, steps, 1e-3);
        let [small, large] = [0.9e-6, 3e-6].map(|error| step(error, None));
        assert_eq!(warning(&[small.clone(), step(3e-6, Some("torn"))]), None);
        let told = warning(&[small, large.clone(), large]).expect("a warning");
        assert!(
            told.contains("of step 3 add up to 0.30 % of the largest"),
            "{told}"
        );
        assert!(told.contains("so in one step more") && told.contains("unresolved_path"));
    }
}
