//! Phases that remove and add volumes and fractures: which cells are there when, of what rock,
//! which walls are welded, and what holds those that were cut.

use std::ops::Range;

use kluft_mesh::{Defect, Draft, Faces, Part, SurfaceRole, Whole};
use kluft_solver::{Discretisation, Load, Problem, StageEnd};

use crate::bind::{Binding, bind_with};
use crate::bind_probes::probe_defects;
use crate::join::{JoinedDraft, join};
use crate::placed::name_places;
use crate::refine::refine;
use crate::remedies::in_terms_of_scene;
use crate::roles::{Roles, roles};
use crate::scene::Scene;
use crate::stage_plans::{Plan, plans};
use crate::words::counted;

/// A scene with stages on a mesh that has the volumes of all of them.
pub struct Staged<'a> {
    scene: &'a Scene,
    whole: Whole,
    plans: Vec<Plan>,
    /// What was decided on the way, one line each.
    pub decisions: Vec<String>,
    /// What is hardly meant, one line each.
    pub warnings: Vec<String>,
}

/// The problem of a stage.
pub struct StageBinding {
    /// The problem and what was decided on the way to it.
    pub binding: Binding,
    /// Numbers of its cells in the mesh with all volumes, ascending.
    pub cells: Vec<u32>,
}

impl Scene {
    /// The stages of this scene on a mesh as [`Self::taken`].
    ///
    /// # Errors
    /// Every defect of the mesh with all its volumes, names that are neither volumes nor fractures,
    /// what is removed or added twice, and surfaces with conditions that are inside the rock in all
    /// stages.
    pub fn staged(&self, draft: Draft) -> Result<Staged<'_>, Vec<Defect>> {
        let faces = Faces::of(&draft);
        let joined = name_places(self, join(self, draft, faces)?)?;
        let inner = joined.faces.inner_surfaces(&joined.draft);
        let Roles {
            of_group,
            decisions,
            warnings,
            ..
        } = roles(self, &joined.draft, &inner)?;
        let mut staged = self.staged_on(joined, of_group)?;
        staged.decisions.extend(decisions);
        staged.warnings = warnings;
        Ok(staged)
    }

    /// The stages on a mesh that has been joined and whose groups have their roles.
    ///
    /// # Errors
    /// As [`Self::staged`].
    pub fn staged_on(
        &self,
        joined: JoinedDraft,
        roles: Vec<SurfaceRole>,
    ) -> Result<Staged<'_>, Vec<Defect>> {
        let inner = joined.faces.inner_surfaces(&joined.draft);
        let of_whole = roles.iter().zip(inner).map(|(role, inner)| match role {
            SurfaceRole::Boundary if inner => SurfaceRole::Unused,
            role => *role,
        });
        let of_whole: Vec<SurfaceRole> = of_whole.collect();
        let refined = refine(self, joined, &of_whole).map_err(in_terms_of_scene)?;
        let (whole, mesh) =
            Whole::of(refined.draft, refined.faces, roles).map_err(in_terms_of_scene)?;
        let plans = plans(self, &whole)?;
        let mut defects = never_outside(self, &whole, &plans);
        defects.extend(probe_defects(self, &mesh));
        if !defects.is_empty() {
            return Err(defects);
        }
        Ok(Staged {
            scene: self,
            whole,
            plans,
            decisions: refined.decisions,
            warnings: Vec::new(),
        })
    }
}

impl Staged<'_> {
    /// Number of stages.
    pub fn count(&self) -> usize {
        self.plans.len()
    }

    /// The load steps of a stage.
    pub fn steps(&self, stage: usize) -> Range<usize> {
        self.plans[stage].steps.clone()
    }

    /// What a stage changes, in words.
    pub fn says(&self, stage: usize) -> &str {
        &self.plans[stage].says
    }

    /// The mesh as read, with all volumes.
    pub fn draft(&self) -> &Draft {
        self.whole.draft()
    }

    /// Checks the bodies that phases make; returns what each is like, one line each.
    ///
    /// # Errors
    /// Every defect of their meshes, what does not fit them, and blocks that nothing holds.
    pub fn check(&self) -> Result<Vec<String>, Vec<Defect>> {
        let mut defects = Vec::new();
        let mut lines = Vec::new();
        for stage in 1..self.count() {
            match self.line(stage) {
                Ok(line) => lines.push(line),
                Err(found) => defects.extend(found),
            }
        }
        match defects.is_empty() {
            true => Ok(lines),
            false => Err(defects),
        }
    }

    fn line(&self, stage: usize) -> Result<String, Vec<Defect>> {
        let problem = self.bind(stage, None)?.binding.problem;
        let held = Discretisation::of(&problem).map_err(in_terms_of_scene);
        held.map_err(|found| self.in_stage(stage, found))?;
        let mesh = problem.mesh;
        Ok(format!(
            "{}: {}, {}, {}",
            self.says(stage),
            counted(mesh.cells.len(), "cell"),
            counted(mesh.facets.elements.len(), "fracture facet"),
            counted(mesh.block_count, "block")
        ))
    }

    /// Defects that show in a stage, with what it changes.
    pub fn in_stage(&self, stage: usize, mut defects: Vec<Defect>) -> Vec<Defect> {
        if stage > 0 {
            for defect in &mut defects {
                defect.place = format!("{}, {}", self.says(stage), defect.place);
            }
        }
        defects
    }

    /// Lets the end of the stage before forget what this one has anew, though it was there: a
    /// phase may remove a volume and add it again.
    pub fn renew(&self, stage: usize, before: &mut StageEnd) {
        let sets = &self.whole.draft().cells.group_set;
        let is_new = &self.plans[stage].is_new;
        before.forget(|cell| is_new[sets[cell as usize] as usize]);
    }

    /// The problem of a stage, which goes on from the end of the one before.
    ///
    /// # Errors
    /// Defects of its mesh, and everything in the scene that does not fit it.
    pub fn bind(
        &self,
        stage: usize,
        before: Option<&StageEnd>,
    ) -> Result<StageBinding, Vec<Defect>> {
        let plan = &self.plans[stage];
        let sets = &self.whole.draft().cells.group_set;
        let is_there: Vec<bool> = sets.iter().map(|&s| plan.is_there[s as usize]).collect();
        let named = |defects| self.in_stage(stage, defects);
        let part = self
            .whole
            .part(&is_there, &plan.welded)
            .map_err(in_terms_of_scene);
        let Part { mesh, cells } = part.map_err(named)?;
        let rock_of = |cell: usize| plan.rock[sets[cells[cell] as usize] as usize];
        let mut binding = bind_with(self.scene, mesh, rock_of).map_err(named)?;
        if let Some(end) = before {
            binding.problem.added = end.added(&cells);
        }
        if stage > 0 {
            plan.hold(&mut binding.problem);
        }
        Ok(StageBinding { binding, cells })
    }
}

impl Plan {
    /// Adds the load case of what holds the walls, and where the stage goes on from.
    fn hold(&self, problem: &mut Problem) {
        let schedule = &mut problem.schedule;
        let mut start = match self.steps.start.checked_sub(1) {
            Some(last) => schedule.steps[last].load.clone(),
            None => schedule.start(),
        };
        start.factors.push(1.0);
        schedule.goes_on_from = Some(start);
        for (index, step) in schedule.steps.iter_mut().enumerate() {
            let own = index.checked_sub(self.steps.start);
            let held = own.and_then(|own| self.held.get(own).copied());
            let Load { factors, .. } = &mut step.load;
            factors.push(held.unwrap_or(1.0));
        }
    }
}

/// Conditions on surfaces that have rock on both sides, or on none, in all stages.
fn never_outside(scene: &Scene, whole: &Whole, plans: &[Plan]) -> Vec<Defect> {
    let ever = |pair: &[u32; 2]| {
        plans.iter().any(|plan| {
            let [one, other] = pair.map(|set| plan.is_there[set as usize]);
            one != other
        })
    };
    let hidden = whole.inner_boundaries().into_iter();
    let hidden = hidden.filter(|(_, pairs)| !pairs.iter().any(ever));
    hidden
        .filter_map(|(group, _)| {
            let name = &whole.draft().groups[group].name;
            let mut conditions = scene.boundaries.iter();
            let mut probes = scene.probes.iter();
            let condition = conditions.find(|entry| entry.name == *name);
            let probe = probes.find(|entry| entry.value.boundary() == Some(name));
            let place = condition.map(|entry| &entry.place);
            Some(Defect::new(
                place.or(probe.map(|entry| &entry.place))?,
                format!("`{name}` lies inside the rock in all phases"),
                "conditions and probes of boundaries are on the outer surface; let a phase remove the volume on one side of it",
            ))
        })
        .collect()
}
