//! Remedies as a scene says them, for defects that a library found.

use kluft_mesh::{CONDITION_INSIDE, Defect};
use kluft_solver::UNHELD_BLOCK;

/// The same defects, each with the remedy as it is written in a scene where there is one.
pub fn in_terms_of_scene(mut defects: Vec<Defect>) -> Vec<Defect> {
    for defect in &mut defects {
        if let Some(words) = defect.code.and_then(words) {
            words.clone_into(&mut defect.remedy);
        }
    }
    defects
}

fn words(code: &str) -> Option<&'static str> {
    match code {
        CONDITION_INSIDE => {
            Some("conditions act on the outer surface; give a fracture a [fracture] entry instead")
        }
        UNHELD_BLOCK => Some(
            "add a [boundary.NAME] with displacement or symmetry, a [[fixed_point]], or stiffness \
             on the fractures around it",
        ),
        _ => None,
    }
}
