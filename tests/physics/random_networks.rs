//! Random networks of 3 to 12 polygons that cross, end inside and cut the boundary: the solver against
//! split nodes.

use crate::networks;
use crate::scenes;
use crate::split_nodes::{TOLERANCE, compare};

fn seeds() -> u64 {
    let asked = std::env::var("KLUFT_SEEDS")
        .ok()
        .and_then(|text| text.parse().ok());
    asked.unwrap_or(5)
}

/// `KLUFT_SEEDS=40 cargo test --test physics random_networks -- --nocapture` for more networks.
#[test]
fn random_networks_agree_with_split_nodes() {
    for seed in 0..seeds() {
        let polygons = networks::polygons(seed);
        let draft =
            networks::meshed(&polygons, 0.25).unwrap_or_else(|d| panic!("seed {seed}: {d:?}"));
        let problem = networks::random_problem(draft, seed);
        let (error, largest) = compare(&problem, &scenes::solve(&problem));
        let mesh = &problem.mesh;
        println!(
            "seed {seed:2}: {:2} fractures, {:5} cells, {:4} facets, at most {} sectors, {} blocks, largest {largest:.1e} m, difference {error:.1e}",
            polygons.len(),
            mesh.cells.len(),
            mesh.facets.elements.len(),
            mesh.sectors.count.iter().max().expect("nodes"),
            mesh.block_count
        );
        assert!(error < TOLERANCE, "seed {seed}: {error:e}");
    }
}
