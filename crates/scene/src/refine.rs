//! Divides the cells of a mesh as often as a scene wants.

use kluft_mesh::{Defect, Draft, Faces, Mesh, Shape, SurfaceRole};

use crate::join::JoinedDraft;
use crate::scene::Scene;

/// Divides what has been joined. The mesh as given is checked before, so that defects name its own
/// cells and not their parts.
///
/// # Errors
/// Every defect of the mesh as given, and a mesh that becomes too large to be numbered.
pub fn refine(
    scene: &Scene,
    joined: JoinedDraft,
    roles: &[SurfaceRole],
) -> Result<JoinedDraft, Vec<Defect>> {
    if scene.refine == 0 {
        return Ok(joined);
    }
    let JoinedDraft {
        mut draft,
        faces,
        mut decisions,
    } = joined;
    Mesh::build_on(draft.clone(), faces, roles)?;
    decisions.extend(faceted(&draft, roles));
    let before = draft.cells.elements.len();
    let shapes = draft.cells.elements.shapes.iter();
    let has_pyramids = shapes.clone().any(|shape| is_pyramid(*shape));
    draft.refine(scene.refine)?;
    decisions.push(divided(scene.refine, &draft, has_pyramids, before));
    Ok(JoinedDraft {
        faces: Faces::of(&draft),
        draft,
        decisions,
    })
}

fn is_pyramid(shape: Shape) -> bool {
    shape.corner_count() == 5
}

fn divided(times: u32, draft: &Draft, has_pyramids: bool, before: usize) -> String {
    let after = draft.cells.elements.len();
    let is_plane = draft.is_extruded;
    let parts = match (is_plane, has_pyramids) {
        (true, _) => "4",
        (false, true) => "8 (a pyramid into 10)",
        (false, false) => "8",
    };
    let times = match times {
        1 => "once".to_owned(),
        times => format!("{times} times"),
    };
    format!("each cell divided into {parts}, {times}: {before} -> {after} cells")
}

/// Surfaces with a role that only look curved, of which refinement makes nothing better.
fn faceted(draft: &Draft, roles: &[SurfaceRole]) -> Option<String> {
    let found = draft.faceted_surfaces().into_iter();
    let used = found.filter(|&group| roles[group] != SurfaceRole::Unused);
    let names: Vec<&str> = used
        .map(|group| draft.groups[group].name.as_str())
        .collect();
    (!names.is_empty()).then(|| {
        format!(
            "`{}`: facets meet at angles; if the surface is curved, the refined cells keep the \
             facets of the given mesh (cells of order 2 follow the curve)",
            names.join("`, `")
        )
    })
}
