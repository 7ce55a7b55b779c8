//! Random networks: each runs, or is refused with its fractures named; none loses a fracture.
//! `KLUFT_SEEDS` sets how many, by default 30.

use std::fs;

use crate::harness::{kluft, scratch};
use crate::network::{record, solve_and_compare};

/// Three to twelve fractures in all directions.
fn description(seed: u64) -> String {
    let shape = match seed % 3 {
        0 => "shape = \"disc\"\nsides = 7",
        1 => "shape = \"rectangle\"\naspect = 1.7",
        _ => "shape = \"disc\"\nsides = 4",
    };
    format!(
        "seed = {seed}\n[domain]\nlow = [0, 0, 0]\nhigh = [10, 9, 8]\n\
         [mesh]\nh = 3\nh_fracture = 2\n\
         [fracture_set.f]\naperture = 1e-3\nnormal_stiffness = 2e10\nshear_stiffness = 1e10\n{shape}\n\
         count = {}\norientation = {{ dip = 50, dip_direction = 40, kappa = {} }}\n\
         size = {{ law = \"power\", exponent = 1.5, min = 1.5, max = 6 }}\n",
        3 + seed % 10,
        seed % 4
    )
}

/// Whether the network of a seed runs.
fn runs(seed: u64) -> bool {
    let folder = scratch();
    let (input, out) = (
        folder.path().join("network.toml"),
        folder.path().join("made"),
    );
    fs::write(&input, description(seed)).expect("the input is written");
    let mut arguments = vec![
        "network".as_ref(),
        input.as_os_str(),
        "-o".as_ref(),
        out.as_os_str(),
    ];
    if seed % 2 == 1 {
        arguments.push("--keep-small".as_ref());
    }
    let run = kluft(&arguments);
    if run.code != Some(0) {
        assert_eq!(run.code, Some(2), "seed {seed}: {}", run.err);
        assert!(
            run.err.contains("`f-"),
            "seed {seed} names no fracture: {}",
            run.err
        );
        return false;
    }
    let record = record(&out);
    let count = |key: &str| record[key].as_array().map_or(0, Vec::len) as u64;
    assert_eq!(
        count("fractures") + count("rejected"),
        3 + seed % 10,
        "seed {seed}"
    );
    solve_and_compare(&out);
    true
}

#[test]
fn random_networks_run_or_are_refused_by_name() {
    let seeds = std::env::var("KLUFT_SEEDS")
        .ok()
        .and_then(|seeds| seeds.parse().ok())
        .unwrap_or(30);
    let count = (0..seeds).filter(|&seed| runs(seed)).count();
    assert!(
        count as u64 * 10 >= seeds * 9,
        "only {count} of {seeds} run"
    );
}
