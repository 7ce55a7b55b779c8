//! What Kluft is verified with: scenes, oracles, methods to compare it with, and studies that write
//! pages.
//!
//! The tests of physics use its scenes and oracles. The program `verify` runs the studies and
//! writes `docs/verification`:
//!
//! ```text
//! cargo run --release -p kluft-verification --bin verify -- REPORT [--quick] [NAME...]
//! ```
//!
//! with `stability`, `closures`, `book` or `soak` as the report.

pub mod book;
pub mod closures;
pub mod machine;
pub mod methods;
pub mod oracles;
pub mod random;
pub mod report;
pub mod scenes;
pub mod soak;
pub mod stability;

use std::path::{Path, PathBuf};

/// The folder of the whole project.
///
/// # Panics
/// If this crate lies elsewhere than in `crates`.
pub fn root() -> PathBuf {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    own.ancestors().nth(2).expect("crates/verification").into()
}
