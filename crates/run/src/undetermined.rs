//! What the loads do not determine, in numbers and in words.

use kluft_io::Field;
use kluft_scene::{Doubt, Scene};
use kluft_solver::{Determinacy, System};

use crate::grids::integer_field;
use crate::summary::{FractureSummary, Undetermined};

/// Sums up what is not determined of each fracture.
pub fn note_in(
    fractures: &mut [(String, FractureSummary)],
    system: &System<'_>,
    facets: &[Determinacy],
) {
    let mesh = &system.problem().mesh;
    let areas = mesh.facet_areas().into_iter().map(|area| area.length());
    let each = std::iter::zip(&mesh.facets.fracture, areas).zip(facets);
    for ((&fracture, area), determinacy) in each {
        let own = &mut fractures[fracture as usize].1.undetermined;
        match determinacy {
            Determinacy::Determined => {}
            Determinacy::Slip => own.slip_area += area,
            Determinacy::Aperture => own.aperture_area += area,
            Determinacy::Metastable => own.metastable_area += area,
        }
    }
}

/// The field of the fractures' grid.
pub fn field(facets: &[Determinacy]) -> Field {
    integer_field("undetermined", facets.iter().map(|&facet| facet as i32))
}

/// What the user should know of it: one warning a kind, with all fractures.
pub fn warnings(scene: &Scene, fractures: &[(String, FractureSummary)]) -> Vec<String> {
    type Area = fn(&Undetermined) -> f64;
    let kinds: [(Area, &str); 3] = [
        (
            |own| own.aperture_area,
            "rock beside them floats, so that their apertures and slips there are no results; \
             hold it, press it, or give a fracture around it friction or stiffness",
        ),
        (
            |own| own.slip_area,
            "nothing resists sliding, so that their slips there are no results; give them shear \
             stiffness or friction",
        ),
        (
            |own| own.metastable_area,
            "what their slip has stored exceeds what presses them together, so that they could as \
             well be open; give them friction instead of shear stiffness",
        ),
    ];
    let told = kinds.into_iter().filter_map(|(area, why)| {
        let named: Vec<String> = fractures
            .iter()
            .filter(|(_, own)| area(&own.undetermined) > 0.0)
            .map(|(name, own)| format!("`{name}` on {:.4} m2", area(&own.undetermined)))
            .collect();
        let places = named.join(", ");
        let text = format!("the state is not unique: {places}: {why}");
        scene
            .warning(Doubt::NotUnique, &text)
            .filter(|_| !named.is_empty())
    });
    told.collect()
}
