//! What is there in each stage: a walk through the phases that remove and add volumes and
//! fractures.

use std::ops::Range;

use kluft_mesh::{Defect, Draft, Whole, nearest};

use crate::history::PhaseEntry;
use crate::roles::find_group;
use crate::scene::Scene;

/// What is there in a stage, by sets of groups, and its load steps.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Plan {
    pub(crate) steps: Range<usize>,
    pub(crate) is_there: Vec<bool>,
    /// Whether sets were added at its beginning.
    pub(crate) is_new: Vec<bool>,
    /// Rock of sets that were added as another than their volume.
    pub(crate) rock: Vec<Option<u32>>,
    /// Groups of fractures whose walls are one.
    pub(crate) welded: Vec<usize>,
    /// Share of what holds the walls at its beginning that still does at the end of its steps.
    pub(crate) held: Vec<f64>,
    /// What it changes, in words.
    pub(crate) says: String,
}

/// The plans of all stages of a scene on the mesh with all volumes.
///
/// # Errors
/// Names that are neither volumes nor fractures, what is removed or added twice, phases that leave
/// nothing.
pub(crate) fn plans(scene: &Scene, whole: &Whole) -> Result<Vec<Plan>, Vec<Defect>> {
    Planner::of(scene, whole).plan()
}

/// Walks through the phases.
struct Planner<'a> {
    scene: &'a Scene,
    draft: &'a Draft,
    /// Groups of fractures.
    fractures: Vec<usize>,
    /// Whether each group is there, as far as phases say.
    groups: Vec<Option<bool>>,
    is_there: Vec<bool>,
    is_new: Vec<bool>,
    rock: Vec<Option<u32>>,
    defects: Vec<Defect>,
}

impl<'a> Planner<'a> {
    fn of(scene: &'a Scene, whole: &'a Whole) -> Self {
        let draft = whole.draft();
        Self {
            scene,
            draft,
            fractures: whole.fractures(),
            groups: vec![None; draft.groups.len()],
            is_there: vec![true; draft.group_sets.len()],
            is_new: vec![false; draft.group_sets.len()],
            rock: vec![None; draft.group_sets.len()],
            defects: Vec::new(),
        }
    }

    fn plan(mut self) -> Result<Vec<Plan>, Vec<Defect>> {
        self.begin();
        let mut step = 0;
        let mut plans = vec![self.from(step, String::new())];
        for phase in self.scene.phases() {
            if phase.changes() {
                self.change(phase);
                self.refuse_nothing(phase);
                plans.push(self.from(step, says(phase)));
            }
            step += phase.steps;
            if let Some(plan) = plans.last_mut() {
                plan.steps.end = step;
                let start = plan.held.last().copied().unwrap_or(1.0);
                let let_go = |done: usize| phase.release * done as f64 / phase.steps as f64;
                let own = (1..=phase.steps).map(|done| start * (1.0 - let_go(done)));
                plan.held.extend(own);
            }
        }
        match self.defects.is_empty() {
            true => Ok(plans),
            false => Err(self.defects),
        }
    }

    /// What is there now, from a load step on.
    fn from(&mut self, step: usize, says: String) -> Plan {
        Plan {
            steps: step..step,
            is_there: self.is_there.clone(),
            is_new: std::mem::replace(&mut self.is_new, vec![false; self.draft.group_sets.len()]),
            rock: self.rock.clone(),
            welded: self.welded(),
            held: Vec::new(),
            says,
        }
    }

    /// What is added before it was removed is not there at first.
    fn begin(&mut self) {
        let mut seen = Vec::new();
        for phase in self.scene.phases() {
            let removed = phase.remove.iter().map(|name| (name, true));
            let added = phase.add.iter().map(|name| (name, false));
            for (name, is_there) in removed.chain(added) {
                if seen.contains(&name) {
                    continue;
                }
                seen.push(name);
                match self.group(phase, name) {
                    Ok(group) => self.set(group, is_there, None),
                    Err(defect) => self.defects.push(defect),
                }
            }
        }
    }

    fn change(&mut self, phase: &PhaseEntry) {
        let both = phase.remove.iter().filter(|name| phase.add.contains(name));
        let both: Vec<&String> = both.filter(|name| self.is_fracture(name)).collect();
        for name in both {
            let problem = format!(
                "phase \"{}\" removes the fracture `{name}` and adds it",
                phase.name
            );
            let remedy = "let one phase remove it and a later one add it";
            self.defects
                .push(Defect::new(&phase.place, problem, remedy));
        }
        self.refuse_twice(phase);
        for name in each_once(&phase.remove) {
            self.turn(phase, name, false, None);
        }
        let rock = phase.added_as.as_ref().and_then(|name| self.rock(name));
        for name in each_once(&phase.add) {
            self.turn(phase, name, true, rock);
        }
    }

    /// Refuses names that stand twice in a list of a phase.
    fn refuse_twice(&mut self, phase: &PhaseEntry) {
        for (key, names) in [("remove", &phase.remove), ("add", &phase.add)] {
            if each_once(names).count() < names.len() {
                let problem = format!("phase \"{}\" names a volume twice in `{key}`", phase.name);
                let defect = Defect::new(&phase.place, problem, "remove one of them");
                self.defects.push(defect);
            }
        }
    }

    /// Refuses a phase after which no cell is there.
    fn refuse_nothing(&mut self, phase: &PhaseEntry) {
        let mut sets = self.draft.cells.group_set.iter();
        if self.defects.is_empty() && !sets.any(|&set| self.is_there[set as usize]) {
            let problem = format!(
                "phase \"{}\" leaves nothing: no volume of the mesh is there any more",
                phase.name
            );
            let remedy = "let a volume stay, or add one in the same phase";
            self.defects
                .push(Defect::new(&phase.place, problem, remedy));
        }
    }

    /// The rock of a name; what a phase adds has one, see [`roles`].
    fn rock(&self, name: &str) -> Option<u32> {
        let mut rocks = self.scene.rocks.iter();
        let found = rocks.position(|entry| entry.name == name);
        found.map(|rock| rock as u32)
    }

    fn turn(&mut self, phase: &PhaseEntry, name: &str, is_there: bool, rock: Option<u32>) {
        // Names that are neither volumes nor fractures have been reported.
        let Ok(group) = self.group(phase, name) else {
            return;
        };
        if self.groups[group] == Some(is_there) {
            let (problem, remedy) = match is_there {
                true => (
                    format!(
                        "phase \"{}\" adds `{name}`, which is there already",
                        phase.name
                    ),
                    "let an earlier phase remove it, or remove it from `add`",
                ),
                false => (
                    format!(
                        "phase \"{}\" removes `{name}`, which is not there",
                        phase.name
                    ),
                    "let an earlier phase add it, or remove it from `remove`",
                ),
            };
            self.defects
                .push(Defect::new(&phase.place, problem, remedy));
        }
        self.set(group, is_there, rock);
    }

    /// The volume or the fracture of a name.
    fn group(&self, phase: &PhaseEntry, name: &str) -> Result<usize, Defect> {
        let groups = &self.draft.groups;
        let is_fracture = self.is_fracture(name);
        if is_fracture
            && groups
                .iter()
                .any(|group| group.dimension == 3 && group.name == name)
        {
            let problem = format!("`{name}` is the name of a fracture and of a volume");
            let remedy = "give one of them another name in the mesh";
            return Err(Defect::new(&phase.place, problem, remedy));
        }
        let found = find_group(groups, name, if is_fracture { 2 } else { 3 }, &phase.place);
        let is_known = groups.iter().any(|group| group.name == name);
        found.map_err(|defect| match is_known {
            true => defect,
            false => self.unknown(phase, name),
        })
    }

    /// A name that is neither that of a volume nor that of a fracture.
    fn unknown(&self, phase: &PhaseEntry, name: &str) -> Defect {
        let groups = &self.draft.groups;
        let volumes = groups.iter().filter(|group| group.dimension == 3);
        let fractures = self.fractures.iter().map(|&group| &groups[group]);
        let known: Vec<&str> = volumes.chain(fractures).map(|g| g.name.as_str()).collect();
        let remedy = match nearest(name, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("volumes and fractures of the mesh: {}", known.join(", ")),
        };
        let problem = format!("the mesh has no physical volume `{name}`, and no fracture");
        Defect::new(&phase.place, problem, remedy)
    }

    fn is_fracture(&self, name: &str) -> bool {
        let mut fractures = self.fractures.iter();
        fractures.any(|&group| self.draft.groups[group].name == name)
    }

    /// The fractures that are not there now.
    fn welded(&self) -> Vec<usize> {
        let fractures = self.fractures.iter().copied();
        fractures
            .filter(|&group| self.groups[group] == Some(false))
            .collect()
    }

    fn set(&mut self, group: usize, is_there: bool, rock: Option<u32>) {
        self.groups[group] = Some(is_there);
        if self.fractures.contains(&group) {
            return;
        }
        for (index, set) in self.draft.group_sets.iter().enumerate() {
            if set.contains(&group) {
                self.is_there[index] = is_there;
                self.is_new[index] = is_there;
                self.rock[index] = rock;
            }
        }
    }
}

/// What a phase changes, in words.
fn says(phase: &PhaseEntry) -> String {
    let lists = [("removes", &phase.remove), ("adds", &phase.add)].into_iter();
    let lists = lists.filter(|(_, names)| !names.is_empty());
    let what = lists.map(|(verb, names)| format!("{verb} {}", names.join(", ")));
    let what: Vec<String> = what.collect();
    format!("phase \"{}\" {}", phase.name, what.join(" and "))
}

/// The names of a list, each once.
fn each_once(names: &[String]) -> impl Iterator<Item = &String> {
    let names_so_far = |index: usize| &names[..index];
    let each = names.iter().enumerate();
    each.filter(move |(index, name)| !names_so_far(*index).contains(name))
        .map(|(_, name)| name)
}
