//! Remedies as a scene says them, for defects that a library found.

use kluft_mesh::{CONDITION_INSIDE, Defect};
use kluft_solver::HOLD;

/// The same defects, each with the remedy as it is written in a scene where there is one.
pub fn in_terms_of_scene(mut defects: Vec<Defect>) -> Vec<Defect> {
    for defect in &mut defects {
        if let Some(words) = words(defect) {
            words.clone_into(&mut defect.remedy);
        }
    }
    defects
}

fn words(defect: &Defect) -> Option<&'static str> {
    if defect.code == Some(CONDITION_INSIDE) {
        return Some(
            "conditions act on the outer surface; give a fracture a [fracture] entry instead",
        );
    }
    (defect.remedy == HOLD).then_some(
        "add a [boundary.NAME] with displacement or symmetry, a [[fixed_point]], or stiffness on \
         the fractures around it",
    )
}
