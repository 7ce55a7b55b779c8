//! Random networks of 3 to 12 polygons that cross, end inside and cut the boundary: the solver
//! against split nodes.

use kluft_mesh::Draft;

use kluft_verification::methods::split_nodes::{TOLERANCE, compare};
use kluft_verification::scenes;
use kluft_verification::scenes::networks;

fn seeds() -> u64 {
    let asked = std::env::var("KLUFT_SEEDS")
        .ok()
        .and_then(|text| text.parse().ok());
    asked.unwrap_or(5)
}

/// `KLUFT_SEEDS=40 cargo test --test physics random_networks -- --nocapture` for more networks.
#[test]
fn random_networks_agree_with_split_nodes() {
    let mut unmeshed = 0;
    for seed in 0..seeds() {
        let polygons = networks::polygons(seed);
        match networks::meshed(&polygons, 0.25) {
            Ok(draft) => check(seed, polygons.len(), draft),
            Err(defects) => {
                println!("seed {seed:2}: not meshed: {defects:?}");
                unmeshed += 1;
            }
        }
    }
    // gmsh itself crashes on a network in a hundred.
    assert!(
        20 * unmeshed <= seeds(),
        "{unmeshed} networks were not meshed"
    );
}

fn check(seed: u64, fractures: usize, draft: Draft) {
    let problem = networks::random_problem(draft, seed);
    let (error, largest) = compare(&problem, &scenes::solve(&problem));
    let mesh = &problem.mesh;
    println!(
        "seed {seed:2}: {fractures:2} fractures, {:5} cells, {:4} facets, at most {} sectors, \
         {:2} blocks, largest {largest:.1e} m, difference {error:.1e}",
        mesh.cells.len(),
        mesh.facets.elements.len(),
        mesh.sectors.count.iter().max().expect("nodes"),
        mesh.block_count
    );
    assert!(error < TOLERANCE, "seed {seed}: {error:e}");
}
