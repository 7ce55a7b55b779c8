//! Treatments of closing walls compared on equal terms.

mod crack;
mod equal_terms;
mod inclined;
mod measured;
mod memory;
mod meshes;
mod own_parameters;
mod words;

use crate::report::{Layout, Report, Study};
use crate::stability::front;

pub use memory::measure as measure_memory;

const HEAD: &str = "# Treatments of closing walls

Written by `cargo run --release -p kluft-verification --bin verify -- closures`: how walls can be kept from \
passing each other, on equal terms: the same meshes, facets integrated at their nodes, the same linear solver and \
tolerances, one load step from nothing. Nothing here is typed in: numbers come from the run, and stand in \
`docs/verification/closures/*.csv`. Stiffnesses are in units of E/h, with the size h of the cells beside the \
fracture. Every law begins to resist where contact and the augmented Lagrangian touch, carries no tension, and has \
an aperture b0 of 0.1 mm: walls that close by more than b0 pass each other. Memory is measured: each case runs \
again in a process of its own, and the page has the peak of its resident memory (VmHWM of Linux) and by how much \
that grew from the assembled system to the end of the solve, beside what the program predicts for its linear \
solver. Times are rough unless nothing else ran: the least of three solves over parameters, else of one.";

const PROMISE: &str = "Expected is: every law of Kluft converges at every stiffness; the \
    logarithmic law without cutoff and the hyperbolic one leave apertures above 0; contact agrees \
    with closed forms and with the settled augmented Lagrangian.";

/// All studies, in the order of the page.
pub fn report() -> Report {
    Report {
        name: "closures",
        head: HEAD,
        columns: &["study", "sweep", "what breaks", "what holds"],
        studies: vec![
            inclined::STUDY,
            crack::STUDY,
            own_parameters::CUTOFF,
            own_parameters::LARGEST,
            Study {
                name: "facets",
                title: "Gauss points or nodes on the facets",
                ..front::STUDY
            },
            meshes::CELLS,
            meshes::SOLVERS,
        ],
        layout: Layout::OnePage {
            promise: PROMISE.to_owned(),
        },
    }
}
