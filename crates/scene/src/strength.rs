//! Reads how far strength is to be reduced, and finds the fractures that are meant.

use kluft_mesh::{Defect, nearest};
use kluft_solver::Flow;
use lie_core::FractureLaw;

use crate::reader::Section;

/// Strength reduced until blocks move.
#[derive(Debug, Clone, PartialEq)]
pub struct StrengthReduction {
    /// File and line.
    pub place: String,
    /// Fractures by name; all that have friction if there are none.
    pub fractures: Vec<String>,
    /// Largest difference between the last stable and the first failing factor, as a share.
    pub accuracy: f64,
    /// Factor at which the search ends.
    pub most: f64,
}

/// Reads the section.
pub(crate) fn read_strength_reduction(section: Section<'_, '_>) -> StrengthReduction {
    let fractures = section.texts("fractures");
    if fractures.as_ref().is_some_and(Vec::is_empty) {
        let remedy = "name them, or leave it out for all that have friction";
        section.refuse("fractures", "no fracture is named".into(), remedy);
    }
    let read = StrengthReduction {
        place: section.place(),
        fractures: fractures.unwrap_or_default(),
        accuracy: section.number("accuracy").unwrap_or(0.01),
        most: section.number("most").unwrap_or(10.0),
    };
    section.finish();
    read
}

impl StrengthReduction {
    /// Whether each of these fractures, given by name and law, is weakened.
    pub fn chosen(&self, names: &[String], laws: &[FractureLaw]) -> Vec<bool> {
        let pairs = names.iter().zip(laws);
        pairs
            .map(|(name, law)| {
                let is_meant = self.fractures.is_empty() || self.fractures.contains(name);
                is_meant && law.friction.is_some()
            })
            .collect()
    }

    /// What is wrong with it beside a flow: the pressures of the last load step stay while strength
    /// is reduced, and those of a flow that follows its walls would not.
    pub(crate) fn defect_beside(&self, flow: &Flow, is_timed: bool) -> Option<Defect> {
        let flows = !flow.conditions.is_empty() || flow.is_undrained;
        (flows && flow.follows_walls(is_timed)).then(|| {
            let problem = "strength is reduced at the pressures of the last load step, and those of \
                           this fluid follow the walls";
            let remedy = "give each fracture that conducts a constant hydraulic_aperture, and load \
                          steps without times; or replace [fluid] by a fluid_pressure of fractures";
            Defect::new(&self.place, problem, remedy)
        })
    }

    /// What is wrong with it on a mesh with these fractures.
    pub(crate) fn defects(&self, names: &[String], laws: &[FractureLaw]) -> Vec<Defect> {
        let mut defects = Vec::new();
        for name in &self.fractures {
            let place = names.iter().position(|other| other == name);
            let (problem, remedy) = match place.map(|place| laws[place].friction) {
                Some(Some(_)) => continue,
                Some(None) => (
                    format!("fracture `{name}` has no strength to reduce"),
                    "give it a friction_angle, or take it out of `fractures`".to_owned(),
                ),
                None => (
                    format!("`{name}` is no fracture of the mesh"),
                    match nearest(name, names.iter().map(String::as_str)) {
                        Some(near) => format!("did you mean `{near}`?"),
                        None => format!("fractures of the mesh: {}", names.join(", ")),
                    },
                ),
            };
            defects.push(Defect::new(&self.place, problem, remedy));
        }
        if self.fractures.is_empty() && laws.iter().all(|law| law.friction.is_none()) {
            let problem = "no fracture has strength that could be reduced";
            let remedy = "give fractures a friction_angle, or remove [strength_reduction]";
            defects.push(Defect::new(&self.place, problem, remedy));
        }
        defects
    }
}
