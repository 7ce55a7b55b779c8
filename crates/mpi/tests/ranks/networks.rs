//! Random networks on two to four ranks; `KLUFT_SEEDS` sets how many.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use kluft_network::{CellSizes, Domain, Grouping, Network, Stream, read_list, write_geo};

use crate::equal::{is_as_equal_as_solvers, is_equal};
use crate::harness::number;

/// Discs in all directions, some of which cross, end in each other or cut off a corner.
fn list(seed: u64) -> String {
    let mut random = Stream::new(seed, "fractures");
    let mut between = |low: f64, high: f64| random.between(low, high);
    let mut text = String::from("name,shape,x,y,z,dip,dip_direction,radius\n");
    for number in 0..3 + seed % 7 {
        let centre = [between(1.0, 9.0), between(1.0, 8.0), between(1.0, 7.0)];
        let [x, y, z] = centre;
        let (dip, direction) = (between(0.0, 90.0), between(0.0, 360.0));
        let radius = between(1.5, 5.0);
        let _ = writeln!(
            text,
            "f-{number},disc,{x},{y},{z},{dip},{direction},{radius}"
        );
    }
    text
}

/// The closure law of its fractures; those in contact slide.
fn law(seed: u64) -> &'static str {
    ["logarithmic", "hyperbolic", "contact"][seed as usize % 3]
}

/// Writes geometry and scene; whether the fractures are ones that can be meshed.
fn made(seed: u64, folder: &Path) -> bool {
    let given = read_list(&list(seed), "list.csv", "f", false).expect("a list");
    let sizes = CellSizes {
        h: 2.5,
        h_fracture: 1.6,
        h_intersection: 1.4,
        growth: 0.5,
        small: 0.3,
        small_angle: 12.0,
        snap: true,
    };
    let domain = Domain::between([0.0; 3], [10.0, 9.0, 8.0]);
    let Ok(network) = Network::build(domain, sizes, given) else {
        return false;
    };
    let geometry = write_geo(&network, Grouping::Fracture, "a random network", None);
    fs::write(folder.join("network.geo"), geometry).expect("written");
    let mut scene = String::from(
        "[mesh]\ngeometry = \"network.geo\"\n[rock.rock]\nyoung_modulus = 5e10\n\
         poisson_ratio = 0.25\n[boundary.bottom]\nsymmetry = true\n[boundary.left]\n\
         symmetry = true\n[boundary.front]\nsymmetry = true\n[boundary.top]\npressure = 8e6\n",
    );
    for fracture in &network.fractures {
        let name = &fracture.name;
        let _ = match law(seed) {
            "contact" => writeln!(
                scene,
                "[fracture.\"{name}\"]\naperture = 1e-4\nclosure = \"contact\"\n\
                 friction_angle = 30"
            ),
            law => writeln!(
                scene,
                "[fracture.\"{name}\"]\naperture = 5e-4\nclosure = \"{law}\"\n\
                 normal_stiffness = 4e10\nshear_stiffness = 1e10{}",
                if law == "hyperbolic" {
                    "\nmax_closure = 4e-4"
                } else {
                    ""
                }
            ),
        };
    }
    fs::write(folder.join("scene.toml"), scene).expect("written");
    true
}

#[test]
fn random_networks_are_equal_to_serial_runs() {
    let seeds = number("KLUFT_SEEDS", 6);
    let mut compared_with = 0;
    for seed in 0..seeds {
        let folder = tempfile::tempdir().expect("a folder");
        if !made(seed, folder.path()) {
            continue;
        }
        let scene = folder.path().join("scene.toml");
        let ranks = 2 + (seed % 3) as usize;
        match law(seed) {
            "contact" => is_as_equal_as_solvers(&scene, ranks..=ranks),
            _ => is_equal(&scene, ranks..=ranks),
        }
        println!("network {seed} on {ranks} ranks holds");
        compared_with += 1;
    }
    assert!(
        2 * compared_with >= seeds,
        "only {compared_with} of {seeds} can be meshed"
    );
}
