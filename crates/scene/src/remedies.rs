//! Remedies as a scene says them, for defects that a library found.

use kluft_mesh::{
    CONDITION_INSIDE, DOUBLED_NODES, Defect, FACES_NOT_MATCHING, FRACTURE_ON_DOUBLED_NODES,
};
use kluft_solver::{NO_PRESSURE, UNHELD_BLOCK};

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
        DOUBLED_NODES => Some(
            "add `weld = true` to [mesh], take the surface as a fracture ([fracture.NAME] with \
             `between = [\"VOLUME\", \"VOLUME\"]`), or share the faces in the geometry \
             (BooleanFragments; Coherence; for a mesh, Coherence Mesh;)",
        ),
        FACES_NOT_MATCHING => Some(
            "share the faces in the geometry (BooleanFragments) and mesh it again; neither \
             `weld = true` nor `between` joins nodes at different places",
        ),
        FRACTURE_ON_DOUBLED_NODES => Some(
            "add `weld = true` to [mesh]: with nodes at one place made one the fracture lies inside",
        ),
        UNHELD_BLOCK => Some(
            "add a [boundary.NAME] with displacement or symmetry, a [[fixed_point]], or stiffness \
             on the fractures around it",
        ),
        NO_PRESSURE => Some(
            "add fluid_pressure to a [boundary.NAME] that they meet or to one of them, a [[source]] \
             with pressure, or sealed = true to them; isolated = \"inactive\" under [fluid] leaves \
             out networks that nothing drives, and \"undrained\" lets those between walls that \
             move keep the fluid that they hold",
        ),
        _ => None,
    }
}
