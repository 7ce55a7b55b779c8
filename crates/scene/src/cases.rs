//! Conditions with the same history are one load case.

use kluft_keys::section_head;
use kluft_solver::{Cases, Load, Schedule, Step};

use crate::conditions::{BoundaryEntry, FixedPointEntry, FractureEntry, LoadEntry};
use crate::fluid::SourceEntry;
use crate::history::{LoadHistory, StepEnd, Timetable};
use crate::scene::{Named, Scene};
use crate::warning::Doubt;

/// Times that differ by less than this share of the last one are the same.
const SAME_TIME: f64 = 1e-9;

/// The entries of a scene that became parts of the problem, in its order.
pub(crate) struct Bound<'a> {
    pub(crate) boundaries: Vec<&'a Named<BoundaryEntry>>,
    pub(crate) fractures: Vec<&'a Named<FractureEntry>>,
    pub(crate) fixed_points: Vec<&'a Named<FixedPointEntry>>,
    pub(crate) sources: Vec<&'a Named<SourceEntry>>,
}

/// The schedule of a scene; what the user should know of it goes to `decisions`, histories that
/// never act to `warnings`.
pub(crate) fn schedule(
    scene: &Scene,
    bound: &Bound<'_>,
    decisions: &mut Vec<String>,
    warnings: &mut Vec<String>,
) -> Schedule {
    let (ends, grown) = match &scene.timetable {
        Timetable::Factors(factors) => return Schedule::proportional(factors.clone()),
        Timetable::Times { ends, grown, .. } => (ends, *grown),
    };
    let mut found = Found {
        grown,
        cases: Vec::new(),
    };
    let cases = found.collect(scene, bound, ends);
    found.tell(ends, decisions);
    let idle = found.idle(ends);
    warnings.extend(idle.filter_map(|text| scene.warning(Doubt::IdleHistories, &text)));
    let step = |end: &StepEnd| Step {
        load: Load {
            time: end.time,
            factors: found.factors(end.time),
        },
        phase: end.phase.clone(),
    };
    Schedule {
        cases,
        steps: ends.iter().map(step).collect(),
        is_timed: true,
        goes_on_from: None,
        sudden: found.factors(0.0),
    }
}

/// The load cases found so far.
struct Found {
    /// When a condition without a history has grown to its full size.
    grown: f64,
    /// LoadHistory of each case, and the sections that belong to it.
    cases: Vec<(LoadHistory, Vec<String>)>,
}

impl Found {
    fn collect(&mut self, scene: &Scene, bound: &Bound<'_>, ends: &[StepEnd]) -> Cases {
        let conditions = bound.boundaries.iter().map(|entry| {
            let value = &entry.value;
            let name = section_head("boundary", &entry.name);
            let is_loaded = match &value.load {
                Some(LoadEntry::Varying(load)) => !load.load.depends_on_time(),
                load => load.is_some(),
            };
            let acts = is_loaded || value.moves();
            self.case(acts, value.history.as_ref(), name)
        });
        let conditions = conditions.collect();
        let driven = bound.boundaries.iter().map(|entry| {
            let history = entry.value.history.as_ref();
            let drive = entry.value.fluid.as_ref();
            let course = drive.and_then(|drive| drive.course(history, ends));
            let name = section_head("boundary", &entry.name);
            self.case(drive.is_some(), course.as_ref(), name)
        });
        let boundary_flows = driven.collect();
        let fractures = bound.fractures.iter().map(|entry| {
            let value = &entry.value;
            let varying = value.varying_pressure.as_ref();
            let acts = value.fracture.fluid_pressure != 0.0
                || value.given_pressure.is_some()
                || varying.is_some_and(|entry| !entry.field.depends_on_time());
            let history = value.history.as_ref();
            let given = value.given_pressure.as_ref();
            let course = given.map(|drive| drive.course(history, ends));
            let course = course.unwrap_or_else(|| history.cloned());
            let name = section_head("fracture", &entry.name);
            self.case(acts, course.as_ref(), name)
        });
        let fractures = fractures.collect();
        let fixed_points = bound.fixed_points.iter().map(|entry| {
            self.case(
                entry.value.moves(),
                entry.value.history.as_ref(),
                entry.name.clone(),
            )
        });
        let fixed_points = fixed_points.collect();
        let sources = bound.sources.iter().map(|entry| {
            let SourceEntry { drive, history, .. } = &entry.value;
            let course = drive.course(history.as_ref(), ends);
            self.case(true, course.as_ref(), entry.name.clone())
        });
        Cases {
            conditions,
            boundary_flows,
            fractures,
            fixed_points,
            sources: sources.collect(),
            gravity: {
                let acts = scene.body.gravity != glam::DVec3::ZERO;
                self.case(acts, scene.body.history.as_ref(), "[body]".into())
            },
        }
    }

    /// Load case of a section; what does not act may be in any.
    fn case(&mut self, acts: bool, history: Option<&LoadHistory>, name: String) -> usize {
        if !acts {
            return 0;
        }
        let history = history
            .cloned()
            .unwrap_or_else(|| LoadHistory::ramp(self.grown));
        let known = self.cases.iter().position(|(other, _)| *other == history);
        let case = known.unwrap_or(self.cases.len());
        if known.is_none() {
            self.cases.push((history, Vec::new()));
        }
        let names = &mut self.cases[case].1;
        if !names.contains(&name) {
            names.push(name);
        }
        case
    }

    /// Factors on the cases at a time; there is always one case.
    fn factors(&self, time: f64) -> Vec<f64> {
        match self.cases.is_empty() {
            true => vec![LoadHistory::ramp(self.grown).at(time)],
            false => self
                .cases
                .iter()
                .map(|(history, _)| history.at(time))
                .collect(),
        }
    }

    /// Histories whose factor is 0 wherever a load step ends.
    fn idle(&self, ends: &[StepEnd]) -> impl Iterator<Item = String> {
        let never = |history: &LoadHistory| ends.iter().all(|end| history.at(end.time) == 0.0);
        let idle = self.cases.iter().filter(move |(history, _)| never(history));
        idle.map(|(_, names)| {
            format!(
                "the history of {} has the factor 0 at the end of every load step: what it scales never acts",
                names.join(", ")
            )
        })
    }

    fn tell(&self, ends: &[StepEnd], decisions: &mut Vec<String>) {
        if self.cases.len() > 1 {
            let names: Vec<String> = self
                .cases
                .iter()
                .map(|(_, names)| names.join(", "))
                .collect();
            decisions.push(format!(
                "{} load cases, each with its own history: {}",
                names.len(),
                names.join("; ")
            ));
        }
        let last = ends.last().map_or(0.0, |end| end.time);
        let is_end = |time: f64| {
            ends.iter()
                .any(|end| (end.time - time).abs() <= SAME_TIME * last)
        };
        for (history, names) in &self.cases {
            let times = history.points.iter().map(|[time, _]| *time);
            let mut passed = times.filter(|time| *time > 0.0 && *time < last && !is_end(*time));
            if let Some(time) = passed.next() {
                decisions.push(format!(
                    "the history of {} has a point at time {time}, where no load step ends: only factors at the ends of steps act",
                    names.join(", ")
                ));
            }
        }
    }
}
