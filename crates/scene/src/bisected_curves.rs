//! Curves of meshes that bisection adapts.

use crate::reader::Section;
use crate::scene::{AdaptBy, MeshSource};

/// Refuses sources on curves of a mesh that bisection adapts: it divides no curves, so that they
/// would be lost in the second mesh.
pub(crate) fn refuse_bisected_curves(root: &Section<'_, '_>, mesh: Option<&MeshSource>) {
    let Some(MeshSource::Geometry { adapt, .. }) = mesh else {
        return;
    };
    if adapt.is_none_or(|adapt| adapt.by != AdaptBy::Bisection) {
        return;
    }
    for source in root.listed_sections("source") {
        if source.has("curve") {
            let problem = "a mesh that is adapted by bisection loses its curves".into();
            source.refuse(
                "curve",
                problem,
                "remove `by` from adapt: gmsh meshes again",
            );
        }
    }
}
