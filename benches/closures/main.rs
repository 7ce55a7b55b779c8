//! Treatments of closing walls compared on equal terms; see README.md.
//!
//!     cargo bench --bench closures -- [--quick] [STUDY...]
//!
//! writes `docs/closures.md` and, for each study, its numbers and charts in `docs/closures`. With
//! `--quick` a few values only, into `target/closures`.
#![allow(clippy::print_stdout, reason = "progress is what one waits for")]
#![allow(
    dead_code,
    reason = "the stability map and the tests use more of the shared scenes"
)]

mod augmented;
#[path = "../../tests/physics/closing.rs"]
mod closing;
mod crack;
#[path = "../../tests/physics/crack_front.rs"]
mod crack_front;
#[path = "../../tests/physics/dice.rs"]
mod dice;
mod equal_terms;
mod inclined;
mod measured;
mod memory;
mod meshes;
#[path = "../../tests/physics/networks.rs"]
mod networks;
#[path = "../../tests/physics/oracles.rs"]
mod oracles;
mod own_parameters;
#[path = "../stability/page.rs"]
mod page;
mod pressed;
use kluft_run::memory as resident;
#[path = "../../tests/physics/scenes.rs"]
mod scenes;
#[path = "../../tests/physics/spherical_joint.rs"]
mod spherical_joint;
#[path = "../../tests/physics/split_nodes.rs"]
mod split_nodes;
#[path = "../stability/studies/mod.rs"]
mod studies;
mod treatments;
#[path = "../../tests/physics/voigt.rs"]
mod voigt;
mod words;

use page::Page;
use studies::{Study, front};

const HEAD: &str = "# Treatments of closing walls

Written by `cargo bench --bench closures`: how walls can be kept from passing each other, on equal terms: the same meshes,
facets integrated at their nodes, the same linear solver and tolerances, one load step from nothing. Nothing here is typed
in: numbers come from the run, and stand in `docs/closures/*.csv`. Stiffnesses are in units of E/h, with the size h of the
cells beside the fracture. Every law begins to resist where contact and the augmented Lagrangian touch, carries no tension, and has
an aperture b0 of 0.1 mm: walls that close by more than b0 pass each other. Memory is measured: each case runs again in a
process of its own, and the page has the peak of its resident memory (VmHWM of Linux) and by how much that grew from the
assembled system to the end of the solve, beside what the program predicts for its linear solver. Times are rough unless
nothing else ran: the least of three solves over parameters, else of one.

";

/// All studies, in the order of the page.
const ALL: [Study; 7] = [
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
];

fn page() -> Page<'static> {
    Page {
        name: "closures",
        head: HEAD,
        columns: ["what breaks", "what holds"],
        studies: &ALL,
        tables: &["cells", "solvers"],
        promise: "Expected is: every law of Kluft converges at every stiffness; the logarithmic law without cutoff and the \
                  hyperbolic one leave apertures above 0; contact agrees with closed forms and with the settled \
                  augmented Lagrangian."
            .into(),
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [first, rest @ ..] = arguments.as_slice()
        && first == memory::MEASURE
    {
        println!("{}", memory::measure(rest).expect("memory of a run"));
        return;
    }
    page::run(&page());
}
