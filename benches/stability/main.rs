//! The stability map: parameters swept over many decades beside methods that break; see README.md.
//!
//!     cargo bench --bench stability -- [--quick] [STUDY...]
//!
//! writes `docs/stability.md` and, for each study, its numbers and charts in `docs/stability`. With
//! `--quick` a few values only, into `target/stability`.
#![allow(clippy::print_stdout, reason = "progress is what one waits for")]
#![allow(dead_code, reason = "the tests use more of the shared scenes")]

#[path = "../../tests/physics/closing.rs"]
mod closing;
#[path = "../../tests/physics/crack_front.rs"]
mod crack_front;
#[path = "../../tests/physics/dice.rs"]
mod dice;
#[path = "../../tests/physics/networks.rs"]
mod networks;
#[path = "../../tests/physics/oracles.rs"]
mod oracles;
mod page;
#[path = "../../tests/physics/scenes.rs"]
mod scenes;
#[path = "../../tests/physics/spherical_joint.rs"]
mod spherical_joint;
#[path = "../../tests/physics/split_nodes.rs"]
mod split_nodes;
mod studies;
#[path = "../../tests/physics/voigt.rs"]
mod voigt;

use std::path::Path;
use std::time::Instant;

use page::Page;
use studies::{ALL, Effort, PROMISE, PROMISE_WITH_FRICTION, Study};

const HEAD: &str = "# Stability map

Written by `cargo bench --bench stability`: every parameter is swept over many decades, beside a method that breaks,
on small meshes and with default settings. Nothing here is typed in: numbers come from the run, and stand in
`docs/stability/*.csv`. Short forms of all studies are tests (`tests/physics/stability.rs`).

";

fn map() -> Page<'static> {
    Page {
        name: "stability",
        head: HEAD,
        columns: ["what breaks", "Kluft"],
        studies: &ALL,
        tables: &[],
        promise: format!(
            "Promised is: every case with a solution converges with default settings in at most {PROMISE} Newton iterations \
             a step, {PROMISE_WITH_FRICTION} with friction in each part that it divides a step into; every case without one \
             ends with exit code 1 and the name of a fracture or block; and what the studies compare agrees as they say."
        ),
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    let quick = arguments.iter().any(|argument| argument == "--quick");
    let asked: Vec<&String> = arguments.iter().filter(|a| *a != "--quick").collect();
    for name in &asked {
        let known = ALL.map(|study| study.name);
        assert!(
            known.contains(&name.as_str()),
            "no study {name}; there are {known:?}"
        );
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (effort, folder) = if quick {
        (Effort::Quick, root.join("target/stability"))
    } else {
        (Effort::Full, root.join("docs"))
    };
    for study in ALL {
        if asked.is_empty() || asked.iter().any(|name| *name == study.name) {
            run(&study, effort, &folder);
        }
    }
    page::write(&map(), &folder).expect("a page");
}

fn run(study: &Study, effort: Effort, folder: &Path) {
    let start = Instant::now();
    let finding = (study.run)(effort);
    page::keep(&map(), folder, study, &finding).expect("files of the study");
    println!(
        "{}: {:.0} s. {}",
        study.name,
        start.elapsed().as_secs_f64(),
        finding.ours
    );
    for miss in &finding.misses {
        println!("  did not hold: {miss}");
    }
}
