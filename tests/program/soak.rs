//! Short forms of the suites of the soak that run the real program: every case must hold.

use std::path::PathBuf;

use kluft_verification::report::{Effort, Finding};
use kluft_verification::soak::{Asked, disks, kills, networks, races};

fn hold(run: fn(&Asked) -> Finding) {
    let asked = Asked {
        program: PathBuf::from(env!("CARGO_BIN_EXE_kluft")),
        ..Asked::of(Effort::Quick)
    };
    let finding = run(&asked);
    assert!(finding.misses.is_empty(), "{:#?}", finding.misses);
}

#[test]
fn killed_runs_resume_to_the_same_bytes() {
    hold(kills::run);
}

#[test]
fn two_runs_for_one_folder_are_not_mixed() {
    hold(races::run);
}

#[test]
fn a_full_disk_is_named_and_former_results_are_not_lost() {
    hold(disks::run);
}

#[test]
fn random_networks_with_friction_do_not_stall() {
    hold(networks::run);
}
