//! Counts of iterations, and whether they hold what the map promises.

use kluft_solver::StepRecord;

/// Most Newton iterations of a load step without friction: the promise of the map.
pub const PROMISE: usize = 12;
/// The same with friction.
pub const PROMISE_WITH_FRICTION: usize = 25;

/// Newton iterations of a step; none if it did not converge.
pub fn count(record: &StepRecord) -> Option<usize> {
    record.converged().then_some(record.iterations.len())
}

/// The largest of some counts; none if one of them is none.
pub fn most(counts: impl IntoIterator<Item = Option<usize>>) -> Option<usize> {
    let mut counts = counts.into_iter();
    counts.try_fold(0, |most, count| Some(most.max(count?)))
}

/// The step that failed, or took the most iterations.
pub fn worst_step(records: &[StepRecord]) -> &StepRecord {
    let rank = |record: &&StepRecord| (!record.converged(), record.iterations.len());
    records.iter().max_by_key(rank).expect("steps")
}

/// A count for a chart: failures become crosses.
pub fn height(count: Option<usize>) -> f64 {
    count.map_or(f64::NAN, |count| count as f64)
}

/// A count for a table.
pub fn entry(count: Option<usize>) -> String {
    count.map_or("failed".to_owned(), |count| count.to_string())
}

/// Notes a step that did not converge within the promise.
pub fn hold_promise(misses: &mut Vec<String>, case: &str, record: &StepRecord) {
    match count(record) {
        Some(count) if count <= PROMISE => {}
        Some(count) => misses.push(format!("{case}: {count} Newton iterations")),
        None => misses.push(format!("{case}: {:?}", record.outcome)),
    }
}

/// Notes a step with friction that did not converge within the promise: each of the parts that the
/// program divides it into is a step of its own.
pub fn hold_promise_with_friction(misses: &mut Vec<String>, case: &str, record: &StepRecord) {
    match record.substeps.iter().max() {
        Some(&most) if record.converged() && most > PROMISE_WITH_FRICTION => {
            misses.push(format!("{case}: {most} Newton iterations in one part"));
        }
        _ if record.converged() => {}
        _ => misses.push(format!("{case}: {:?}", record.outcome)),
    }
}
