//! The equivalent permeability of a body, computed and told.

use kluft_scene::in_terms_of_scene;
use kluft_solver::{EquivalentPermeability, Flow, NoPermeability, Problem};

use crate::fluid_step::failed;
use crate::observer::Stage;
use crate::permeability_summary::PermeabilitySummary;
use crate::stages::{Interruption, Run};

impl Run<'_> {
    /// Computes and tells the equivalent permeability, if the scene asks for it.
    ///
    /// # Errors
    /// Fractures that conduct nothing, a body whose volume is not known, numbers that are not
    /// finite.
    pub fn permeability(&mut self, problem: &Problem, flow: &Flow) -> Result<(), Interruption> {
        if !self.request.scene.equivalent_permeability {
            return Ok(());
        }
        let apertures = problem.initial_apertures();
        let found = self.stage(Stage::PrepareSolver, |_| {
            EquivalentPermeability::of(&problem.mesh, flow, &apertures)
        });
        let found = found.map_err(|why| match why {
            NoPermeability::Defects(defects) => in_terms_of_scene(defects).into(),
            NoPermeability::Unsolved(failure) => failed(failure),
        })?;
        let summary = PermeabilitySummary::of(&found);
        let largest = summary.through_going.principal[0].value;
        let share = summary.tensor.principal[0].value / largest;
        self.note_timed(
            "permeability",
            &format!(
                "{} (trend/plunge); {:.1} % of what through-going fractures would conduct, {:.1} % of \
                 the area connected",
                summary.tensor.words(),
                100.0 * share,
                100.0 * summary.connected_area / summary.area
            ),
        );
        self.summary.permeability = Some(summary);
        Ok(())
    }
}
