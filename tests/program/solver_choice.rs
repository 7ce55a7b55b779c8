//! The linear solver that the program chooses, and chooses again when it knows what load steps
//! take.

use std::path::Path;

use serde_json::Value;

use crate::harness::{Workshop, summary};
use crate::resume::{ends_in_the_same_bits, kill_at};

/// Blocks of distorted hexahedra in a rock that hardly resists across its beds: the multigrid takes
/// several times the iterations that are predicted. In the uniform stress the rock changes nothing
/// of the fractures.
fn beds(solver: &str) -> Workshop {
    let factors: Vec<String> = (1..=12)
        .map(|step| (f64::from(step) / 12.0).to_string())
        .collect();
    let load = format!(
        "{solver}[load]\nsteps = [{}]\n\n[boundary.left]",
        factors.join(", ")
    );
    let bedded = "poisson_ratio = 0.25\nnormal_young_modulus = 25e5\nnormal_poisson_ratio = 0.0\n\
                  normal_shear_modulus = 1e4\ndip = 30\ndip_direction = 40";
    let friction = "closure = \"logarithmic\"\nfriction_angle = 40";
    let edits = [
        ("poisson_ratio = 0.25", bedded),
        ("closure = \"logarithmic\"", friction),
        ("[boundary.left]", &load[..]),
    ];
    Workshop::new("hexahedra", &edits)
}

/// What a run decided on linear solvers.
fn solvers(out: &Path) -> Vec<String> {
    let said = summary(out);
    let decisions = said["decisions"].as_array().expect("decisions").iter();
    let decisions = decisions.filter_map(Value::as_str);
    let of_solvers = decisions.filter_map(|text| text.strip_prefix("linear solver: "));
    of_solvers.map(str::to_owned).collect()
}

/// By the oracle of the scene: the apertures of a uniform stress.
fn assert_closed_form(out: &Path) {
    let said = summary(out);
    for (fracture, aperture) in [
        ("east", 4.240128e-5),
        ("north", 3.180587e-5),
        ("bed", 6.022628e-5),
    ] {
        for which in ["min", "max"] {
            let found = &said["fractures"][fracture]["aperture"][which];
            let apart = found.as_f64().expect("a number") - aperture;
            assert!(
                apart.abs() < 1e-10,
                "{fracture}: {which} is {apart:e} m off"
            );
        }
    }
}

#[test]
fn a_solver_that_load_steps_turn_out_to_be_dear_for_is_exchanged() {
    let workshop = beds("");
    let out = workshop.solve("out", &[]);
    let said = solvers(&out);
    assert_eq!(said.len(), 2, "{said:?}");
    assert!(
        said[0].starts_with("the cheapest, predicted iterative"),
        "{said:?}"
    );
    assert!(said[1].starts_with("condensed from step 3 on"), "{said:?}");
    assert_closed_form(&out);
}

#[test]
fn a_solver_that_the_scene_asks_for_stays() {
    let workshop = beds("[solver]\nlinear = \"iterative\"\n\n");
    let out = workshop.solve("out", &[]);
    assert_eq!(solvers(&out).len(), 1);
    assert_closed_form(&out);
}

/// Killed before the solver is exchanged and after it.
#[test]
fn an_exchanged_solver_is_resumed_to_the_same_bits() {
    for file in ["resume.bin", "rock_0006.vtu"] {
        let workshop = beds("");
        kill_at(&workshop, file);
        ends_in_the_same_bits(&workshop);
    }
}
