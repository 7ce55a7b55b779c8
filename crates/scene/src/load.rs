//! The load steps of a scene, and histories of its conditions.

use crate::history::{LoadHistory, PhaseEntry, StepEnd, Timetable};
use crate::reader::Section;

/// Whether the load steps of a scene have times, as histories need them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Clock {
    /// Whether they do.
    pub runs: bool,
}

/// What a history scales.
pub(crate) struct Scaled {
    /// Whether the section has it.
    pub(crate) is_there: bool,
    /// What it would be.
    pub(crate) what: &'static str,
}

/// Reads the history of a condition.
pub(crate) fn read_history(
    section: &Section<'_, '_>,
    clock: Clock,
    scaled: Scaled,
) -> Option<LoadHistory> {
    let points = section.time_factors("history")?;
    let title = &section.title;
    if points.is_empty() {
        let remedy = "write [time, factor] at least once, e.g. [[0, 0], [1, 1]]";
        section.refuse(
            "history",
            format!("the history of {title} is empty"),
            remedy,
        );
    }
    if let Some(pair) = points.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
        let problem = format!(
            "the history of {title} goes from time {} to time {}",
            pair[0][0], pair[1][0]
        );
        let remedy = "let the times ascend; for a jump, let two times lie close together";
        section.refuse("history", problem, remedy);
    }
    if !clock.runs {
        let problem = format!("{title} has a history, but the load steps have no times");
        let remedy = "give times = [1.0, 2.0] or [[load.phase]] under [load], without steps; or remove the history";
        section.refuse("history", problem, remedy);
    }
    if !scaled.is_there {
        let problem = format!("the history of {title} has nothing to scale");
        let remedy = format!("add {} to {title}, or remove the history", scaled.what);
        section.refuse("history", problem, remedy);
    }
    Some(LoadHistory { points })
}

/// Reads the load steps, and whether they have times.
pub(crate) fn read_timetable(root: &Section<'_, '_>) -> (Timetable, Clock) {
    let Some(section) = root.section("load") else {
        return (Timetable::default(), Clock { runs: false });
    };
    let given = ["steps", "times", "phase"].map(|key| (key, section.has(key)));
    let mut given = given
        .into_iter()
        .filter(|(_, has)| *has)
        .map(|(key, _)| key);
    let first = given.next();
    if let (Some(first), Some(other)) = (first, given.next()) {
        let problem = format!("both `{first}` and `{other}` are given in [load]");
        let remedy = "keep one: steps (factors on everything), times, or [[load.phase]]";
        section.refuse(other, problem, remedy);
    }
    let timetable = match first {
        Some("times") => read_times(&section),
        Some("phase") => read_phases(&section),
        _ => read_steps(&section),
    };
    let clock = Clock {
        runs: section.has("times") || section.has("phase"),
    };
    section.finish();
    (timetable.unwrap_or_default(), clock)
}

/// Most load steps of a scene, as of one phase.
const MOST_STEPS: usize = 100_000;

/// Reports a list of more load steps than that.
fn refuse_too_many(section: &Section<'_, '_>, key: &'static str, count: usize) -> Option<()> {
    if count <= MOST_STEPS {
        return Some(());
    }
    let remedy = format!("write at most {MOST_STEPS}; a step divides itself where it has to");
    section.refuse(key, format!("{count} load steps are too many"), remedy);
    None
}

fn read_steps(section: &Section<'_, '_>) -> Option<Timetable> {
    section.require("steps");
    let steps = section.numbers("steps")?;
    refuse_too_many(section, "steps", steps.len())?;
    if steps.is_empty() {
        let remedy = "write steps = [1.0]";
        section.refuse("steps", "there are no load steps".into(), remedy);
        return None;
    }
    Some(Timetable::Factors(steps))
}

fn read_times(section: &Section<'_, '_>) -> Option<Timetable> {
    let times = section.numbers("times")?;
    refuse_too_many(section, "times", times.len())?;
    if let Some(pair) = times.windows(2).find(|pair| pair[1] <= pair[0]) {
        let problem = format!("the times go from {} to {}", pair[0], pair[1]);
        section.refuse(
            "times",
            problem,
            "let them ascend: each is the end of a step",
        );
    }
    let Some(&grown) = times.first() else {
        let remedy = "write times = [1.0], the ends of the steps";
        section.refuse("times", "there are no load steps".into(), remedy);
        return None;
    };
    let ends = times.into_iter().map(|time| StepEnd { time, phase: None });
    Some(Timetable::Times {
        ends: ends.collect(),
        grown,
        phases: Vec::new(),
    })
}

fn read_phases(section: &Section<'_, '_>) -> Option<Timetable> {
    let mut phases: Vec<PhaseEntry> = Vec::new();
    let sections = section.listed_sections("phase");
    if sections.is_empty() {
        let remedy = "add [[load.phase]] with a name and `until`";
        section.refuse("phase", "there are no load steps".into(), remedy);
    }
    for section in sections {
        phases.extend(read_phase(&section, &phases));
        section.finish();
    }
    let count = phases.iter().map(|phase| phase.steps).sum();
    refuse_too_many(section, "phase", count)?;
    let grown = phases.first()?.until;
    let starts = [0.0]
        .into_iter()
        .chain(phases.iter().map(|phase| phase.until));
    let ends = starts.zip(&phases).flat_map(|(start, phase)| {
        (1..=phase.steps).map(move |step| StepEnd {
            // The last step of a phase ends exactly where the phase does.
            time: match step == phase.steps {
                true => phase.until,
                false => start + (phase.until - start) * step as f64 / phase.steps as f64,
            },
            phase: Some(phase.name.clone()),
        })
    });
    Some(Timetable::Times {
        ends: ends.collect(),
        grown,
        phases,
    })
}

/// Reads a phase that follows `former` ones.
fn read_phase(section: &Section<'_, '_>, former: &[PhaseEntry]) -> Option<PhaseEntry> {
    section.require("name");
    section.require("until");
    let name = section.text("name");
    let until = section.number("until");
    let steps = section.number("steps");
    if let Some(name) = name.filter(|name| former.iter().any(|phase| phase.name == **name)) {
        let problem = format!("two phases are called \"{name}\"");
        section.refuse("name", problem, "give each a name of its own");
    }
    let start = former.last().map_or(0.0, |phase| phase.until);
    if let Some(until) = until.filter(|until| *until <= start) {
        let problem = format!(
            "{} ends at {until}, where the one before it ends at {start}",
            section.title
        );
        section.refuse("until", problem, "let the ends of the phases ascend");
    }
    let lists = ["remove", "add"].map(|key| section.texts(key));
    let [remove, add] = lists.map(Option::unwrap_or_default);
    let added_as = section.text("added_as").filter(|_| {
        let is_used = !add.is_empty();
        if !is_used {
            let problem = format!("{} adds nothing", section.title);
            section.refuse("added_as", problem, "give `add`, or remove it");
        }
        is_used
    });
    let changes = !remove.is_empty() || !add.is_empty();
    let release = section.number("release").filter(|_| {
        let is_used = changes || former.iter().any(PhaseEntry::changes);
        if !is_used {
            let problem = format!("nothing has been removed up to {}", section.title);
            section.refuse("release", problem, "give `remove`, or remove it");
        }
        is_used
    });
    Some(PhaseEntry {
        name: name?.to_owned(),
        place: section.place(),
        until: until?,
        steps: steps.unwrap_or(1.0) as usize,
        remove,
        add,
        added_as: added_as.map(str::to_owned),
        release: release.unwrap_or(1.0),
    })
}

/// Refuses what does not know that volumes come and go.
pub(crate) fn refuse_beside_stages(root: &Section<'_, '_>) {
    for key in ["fluid", "oracle"] {
        if root.has(key) {
            let problem = format!("[{key}] knows nothing of volumes that phases remove or add");
            root.refuse(
                key,
                problem,
                format!("remove [{key}], or `remove` and `add`"),
            );
        }
    }
    let Some(mesh) = root.section("mesh") else {
        return;
    };
    if mesh.has("adapt") {
        let problem = "a mesh is adapted to one body, and phases remove or add volumes".into();
        mesh.refuse(
            "adapt",
            problem,
            "remove [mesh.adapt], and give sizes in the geometry",
        );
    }
    if mesh.flag("quarter_points") == Some(true) {
        let problem = "crack fronts move with volumes that phases remove or add".into();
        mesh.refuse("quarter_points", problem, "remove it");
    }
}
