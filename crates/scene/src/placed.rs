//! Parts of the outer surface that a scene names by their place.

use glam::DVec3;
use kluft_mesh::{Defect, PlacedSurface};

use crate::conditions::BoundaryEntry;
use crate::join::JoinedDraft;
use crate::place::SurfacePlace;
use crate::scene::{Named, Scene};

/// Gives the outer faces at the places of boundaries their names.
///
/// # Errors
/// Names that the mesh has already, and places where no outer face lies.
pub fn name_places(scene: &Scene, mut joined: JoinedDraft) -> Result<JoinedDraft, Vec<Defect>> {
    let entries = scene.boundaries.iter();
    let placed = entries.filter_map(|entry| Some((entry, entry.value.place.as_ref()?)));
    let placed: Vec<(&Named<BoundaryEntry>, &SurfacePlace)> = placed.collect();
    if placed.is_empty() {
        return Ok(joined);
    }
    let taken = placed.iter().filter_map(|(entry, _)| taken(entry, &joined));
    let defects: Vec<Defect> = taken.collect();
    if !defects.is_empty() {
        return Err(defects);
    }
    let bounds = joined.draft.cell_bounds();
    let tests = placed.iter().map(|(_, place)| {
        let place = *place;
        move |corners: &[DVec3]| place.holds(corners, bounds)
    });
    let tests: Vec<_> = tests.collect();
    let surfaces = placed.iter().zip(&tests);
    let surfaces = surfaces.map(|((entry, _), holds)| PlacedSurface {
        name: &entry.name,
        holds,
    });
    let surfaces: Vec<PlacedSurface<'_>> = surfaces.collect();
    let (faces, counts) = joined.draft.name_outer_faces(&joined.faces, &surfaces);
    joined.faces = faces;
    let mut defects = Vec::new();
    for ((entry, place), count) in placed.into_iter().zip(counts) {
        match count {
            0 => defects.push(nothing(entry, place, bounds)),
            _ => joined.decisions.push(format!(
                "{}: {count} outer faces where {}",
                entry.name,
                place.text()
            )),
        }
    }
    match defects.is_empty() {
        true => Ok(joined),
        false => Err(defects),
    }
}

fn taken(entry: &Named<BoundaryEntry>, joined: &JoinedDraft) -> Option<Defect> {
    let mut groups = joined.draft.groups.iter();
    let is_taken = groups.any(|group| group.dimension == 2 && group.name == entry.name);
    is_taken.then(|| {
        Defect::new(
            &entry.place,
            format!("the mesh has a physical surface `{}` already", entry.name),
            "remove `where` to take that surface, or give the faces at the place another name",
        )
    })
}

fn nothing(entry: &Named<BoundaryEntry>, place: &SurfacePlace, [low, high]: [DVec3; 2]) -> Defect {
    let remedy = match low.is_finite() {
        true => format!(
            "the body reaches from ({:.6}, {:.6}, {:.6}) to ({:.6}, {:.6}, {:.6}); a face lies where \
             all its corners do",
            low.x, low.y, low.z, high.x, high.y, high.z
        ),
        false => {
            "the mesh has no cells, so no outer faces: mesh volumes, or name surfaces".to_owned()
        }
    };
    let problem = format!("no outer face lies where {}", place.text());
    Defect::new(&entry.place, problem, remedy)
}
