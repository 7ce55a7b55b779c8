//! Conditions that act on nothing of the mesh on which they are.

use kluft_mesh::{Boundary, Defect, Mesh, facet_area_vector};
use kluft_solver::{Condition, Field, LoadField, SpringStiffness, SurfaceLoad};

use crate::conditions::{BoundaryEntry, LoadEntry};
use crate::scene::Named;

/// Cosine of the angle between a face and the way to it from the centre of a far field that is
/// rounding.
const GRAZING: f64 = 1e-9;

/// Loads that leave the plane of a mesh, and far fields with a centre from which no face of their
/// boundary is seen from within.
pub(crate) fn wrong_boundaries(
    mesh: &Mesh,
    entries: &[&Named<BoundaryEntry>],
    conditions: &[Condition],
) -> Vec<Defect> {
    let pairs = entries.iter().zip(conditions);
    let wrong = pairs.filter_map(|(entry, condition)| {
        let leaves = mesh.is_plane() && leaves_plane(&entry.value);
        if leaves {
            return Some(Defect::new(
                &entry.place,
                "the traction has a part along z, out of the plane of the mesh",
                "write 0 for its third component: in plane strain nothing moves along z",
            ));
        }
        let springs = entry.value.springs.as_ref()?;
        let SpringStiffness::Outside { centre, .. } = &springs.stiffness else {
            return None;
        };
        let boundary = &mesh.boundaries[condition.boundary];
        let seen = |facet| is_seen(mesh, boundary, facet, *centre);
        let mut facets = 0..boundary.elements.len();
        (!facets.is_empty() && !facets.any(seen)).then(|| {
            Defect::new(
                &entry.place,
                "the centre of `far_field` lies on these faces or outside of them: nothing would \
                 resist",
                "give the centre of what happens inside, such as that of the fractures",
            )
        })
    });
    wrong.collect()
}

fn leaves_plane(boundary: &BoundaryEntry) -> bool {
    match &boundary.load {
        Some(LoadEntry::Uniform(SurfaceLoad::Traction(traction))) => traction.z != 0.0,
        Some(LoadEntry::Varying(load)) => match &load.load {
            LoadField::Traction(components) => components[2] != Field::constant(0.0),
            LoadField::Pressure(_) => false,
        },
        Some(LoadEntry::Uniform(SurfaceLoad::Pressure(_))) | None => false,
    }
}

/// Whether the outer side of a face is turned away from a point.
fn is_seen(mesh: &Mesh, boundary: &Boundary, facet: usize, from: glam::DVec3) -> bool {
    let corners = mesh.corners(&boundary.elements, facet);
    let way = corners.iter().sum::<glam::DVec3>() / corners.len() as f64 - from;
    let area = facet_area_vector(&corners);
    way.dot(area) > GRAZING * way.length() * area.length()
}
