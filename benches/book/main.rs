//! The verification book: closed forms, and how far real runs are from them; see README.md.
//!
//!     cargo bench --bench book -- [PAGE...]
//!
//! writes `docs/book/README.md` and for each benchmark a page, its numbers and its charts.
#![allow(clippy::print_stdout, reason = "progress is what one waits for")]
#![allow(
    dead_code,
    unused_imports,
    reason = "the tests use more of the shared scenes"
)]

#[path = "../../tests/physics/closing.rs"]
mod closing;
#[path = "../../tests/physics/crack_front.rs"]
mod crack_front;
#[path = "../../tests/physics/dice.rs"]
mod dice;
#[path = "../../tests/physics/junctions.rs"]
mod junctions;
#[path = "../../tests/physics/networks.rs"]
mod networks;
#[path = "../../tests/physics/oracles.rs"]
mod oracles;
mod pages;
#[path = "../../tests/physics/patch.rs"]
mod patch;
mod scene;
#[path = "../../tests/physics/scenes.rs"]
mod scenes;
#[path = "../../tests/physics/spherical_joint.rs"]
mod spherical_joint;
#[path = "../../tests/physics/split_nodes.rs"]
mod split_nodes;
#[path = "../stability/page.rs"]
mod stability_page;
#[path = "../stability/studies/mod.rs"]
mod studies;
#[path = "../../tests/physics/voigt.rs"]
mod voigt;
mod writing;

use std::path::Path;
use std::time::Instant;

use pages::ALL;

fn main() {
    let asked: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| a != "--bench")
        .collect();
    for name in &asked {
        let known = ALL.map(|page| page.name);
        assert!(
            known.contains(&name.as_str()),
            "no page {name}; there are {known:?}"
        );
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/book");
    for page in ALL {
        if !asked.is_empty() && !asked.iter().any(|name| *name == page.name) {
            continue;
        }
        let is_busy = others_are_busy();
        let start = Instant::now();
        let found = (page.run)();
        let seconds = start.elapsed().as_secs_f64();
        println!("{}: {seconds:.0} s. {}", page.name, found.reached);
        writing::write_page(&folder, &page, &found, seconds, is_busy).expect("files of the page");
    }
    writing::write_index(&folder).expect("an index");
}

/// Whether more runs on this machine than this program: seen where the system says so.
fn others_are_busy() -> bool {
    let running = |text: String| {
        let field = text.split_whitespace().nth(3)?;
        field.split('/').next()?.parse::<usize>().ok()
    };
    let text = std::fs::read_to_string("/proc/loadavg").ok();
    text.and_then(running).is_some_and(|running| running > 1)
}
