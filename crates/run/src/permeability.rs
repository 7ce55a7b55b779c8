//! The equivalent permeability of a body, computed and told: that of its fractures before the
//! loads, and in rock that deforms after each load step.

use kluft_scene::in_terms_of_scene;
use kluft_solver::{EquivalentPermeability, FacetResult, Flow, NoPermeability, Problem};

use crate::fluid_step::failed;
use crate::observer::Stage;
use crate::permeability_summary::{PermeabilitySummary, TensorSummary};
use crate::stages::{Interruption, Run};

impl Run<'_> {
    /// Computes and tells the equivalent permeability before the loads, if the scene asks for it.
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
        self.note_timed(
            "permeability",
            &format!(
                "{} (trend/plunge); {}, {:.1} % of the area connected",
                summary.tensor.words(),
                beside(&summary.tensor, &summary.through_going),
                100.0 * summary.connected_area / summary.area
            ),
        );
        self.summary.permeability = Some(summary);
        Ok(())
    }

    /// Computes and tells the same after a load step, from the results at the nodes of the facets.
    /// Where all has closed there is none.
    ///
    /// # Errors
    /// Numbers that are not finite.
    pub fn permeability_after_step(
        &mut self,
        problem: &Problem,
        flow: Option<&Flow>,
        nodes: &[FacetResult],
    ) -> Result<(), Interruption> {
        let Some(flow) = flow.filter(|_| self.summary.permeability.is_some()) else {
            return Ok(());
        };
        let apertures: Vec<f64> = nodes.iter().map(|node| node.aperture.max(0.0)).collect();
        let found = self.stage(Stage::PrepareSolver, |_| {
            EquivalentPermeability::of(&problem.mesh, flow, &apertures)
        });
        let loaded = match found {
            Ok(found) => Some(TensorSummary::of(&found.tensor)),
            Err(NoPermeability::Defects(_)) => None,
            Err(NoPermeability::Unsolved(failure)) => return Err(failed(failure)),
        };
        let words = match &loaded {
            Some(tensor) => format!("{} (trend/plunge)", tensor.words()),
            None => "none: a fracture has closed, and conducts nothing".to_owned(),
        };
        self.observer.note("permeability", &words);
        if let Some(summary) = &mut self.summary.permeability {
            summary.loaded = loaded;
        }
        Ok(())
    }
}

fn beside(tensor: &TensorSummary, through_going: &TensorSummary) -> String {
    let share = tensor.principal[0].value / through_going.principal[0].value;
    format!(
        "{:.1} % of what through-going fractures would conduct",
        100.0 * share
    )
}
