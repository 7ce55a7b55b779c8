//! Load cases of values that change with time.

use kluft_mesh::Defect;
use kluft_solver::{Problem, Schedule};

use crate::history::LoadHistory;
use crate::look::Look;

/// Most load steps of a scene with values that change with time: each is a load case of its own.
const MOST_TIMES: usize = 1000;

/// The times for which a value is taken, each with its load case. One that changes with time is
/// what it is at the end of each load step, and linear between: each end is a load case that acts
/// there alone.
pub(crate) fn cases(
    problem: &mut Problem,
    (in_time, own): (bool, usize),
    history: &Option<LoadHistory>,
    look: &mut Look<'_>,
    place: &str,
) -> Option<Vec<(f64, usize)>> {
    if !in_time {
        return Some(vec![(0.0, own)]);
    }
    let count = problem.schedule.steps.len();
    if count > MOST_TIMES {
        let problem = format!("the value changes with time over {count} load steps");
        let remedy = format!("write at most {MOST_TIMES} load steps");
        look.defects.push(Defect::new(place, problem, remedy));
        return None;
    }
    Some(add_cases(&mut problem.schedule, history.as_ref()))
}

/// A load case for the end of each load step, which acts there alone, by its factor in the history
/// then. Cases that are there already serve.
fn add_cases(schedule: &mut Schedule, history: Option<&LoadHistory>) -> Vec<(f64, usize)> {
    let times: Vec<f64> = schedule.steps.iter().map(|step| step.load.time).collect();
    let factor = |time: f64| history.map_or(1.0, |history| history.at(time));
    let row = |end: usize, step: usize| match end == step {
        true => factor(times[end]),
        false => 0.0,
    };
    let known = (0..schedule.case_count()).find(|&first| {
        (0..times.len()).all(|end| {
            let mut steps = schedule.steps.iter().enumerate();
            steps.all(|(step, own)| own.load.factors.get(first + end) == Some(&row(end, step)))
        })
    });
    let first = known.unwrap_or(schedule.case_count());
    if known.is_none() {
        for (step, own) in schedule.steps.iter_mut().enumerate() {
            own.load
                .factors
                .extend((0..times.len()).map(|end| row(end, step)));
        }
    }
    times.iter().copied().zip(first..).collect()
}
