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

use studies::{ALL, Effort, Study};

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
    page::write(&folder).expect("a page");
}

fn run(study: &Study, effort: Effort, folder: &Path) {
    let start = Instant::now();
    let finding = (study.run)(effort);
    page::keep(folder, study, &finding).expect("files of the study");
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
