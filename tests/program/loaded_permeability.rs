//! The permeability of networks in rock that deforms, before and after it is compressed.

use crate::network_flow::{Made, flat, number};

/// A block under 5 MPa from above and two sides, with what else a network says.
const COMPRESSED: &str = r#"
[mesh]
h = 2.5
h_fracture = 1.5
h_intersection = 1.5
[fluid]
viscosity = 1e-3
equivalent_permeability = true
[rock.default]
young_modulus = 25e9
poisson_ratio = 0.25
[boundary.left]
symmetry = true
[boundary.front]
symmetry = true
[boundary.bottom]
symmetry = true
[boundary.right]
pressure = 5e6
[boundary.back]
pressure = 5e6
[boundary.top]
pressure = 5e6
"#;
const LAW: &str = "aperture = 1e-4\nnormal_stiffness = 1e11\nshear_stiffness = 5e10\n\
                   closure = \"logarithmic\"\n";

/// `(b / b0)^3` under 5 MPa, half of `Kn b0`: `b / b0 = 0.602262752`.
const CLOSES: f64 = 0.602_262_752 * 0.602_262_752 * 0.602_262_752;

/// Joints that go through the block carry all of the pressure.
#[test]
fn through_going_joints_conduct_by_the_cube_of_what_they_close() {
    let domain = "[domain]\nlow = [0, 0, 0]\nhigh = [10, 4, 4]\n";
    let joints: String = [1.0, 2.0, 3.0]
        .map(|z| flat(&format!("at {z}"), "flat", z))
        .concat();
    let made = Made::new(&format!(
        "{domain}{COMPRESSED}[fracture_set.flat]\n{LAW}{joints}"
    ));
    let found = &made.solve()["permeability"];
    for axis in [0, 1] {
        let [before, loaded] =
            [found, &found["loaded"]].map(|own| number(&own["components"][axis][axis]));
        assert!(
            (before / (3.0 * 1e-12 / 12.0 / 4.0) - 1.0).abs() < 1e-9,
            "{before}"
        );
        assert!(
            (loaded / before / CLOSES - 1.0).abs() < 1e-8,
            "{loaded} {before}"
        );
    }
}

/// Fractures that end in the rock close less, and all conduct less than before.
#[test]
fn a_network_is_symmetric_and_conducts_less_when_it_is_compressed() {
    let set = |name: &str, count: usize, dips: [f64; 2]| {
        let [dip, direction] = dips;
        format!(
            "[fracture_set.{name}]\ncount = {count}\n\
             orientation = {{ dip = {dip}, dip_direction = {direction}, kappa = 20 }}\n\
             size = {{ law = \"lognormal\", mean = 9.0, sd = 2.0, min = 6.0, max = 14.0 }}\n{LAW}"
        )
    };
    let domain = "seed = 3\n[domain]\nlow = [0, 0, 0]\nhigh = [10, 10, 10]\n";
    let sets = [set("steep", 8, [80.0, 90.0]), set("level", 6, [10.0, 45.0])].concat();
    let found = &Made::new(&format!("{domain}{COMPRESSED}{sets}")).solve()["permeability"];
    assert!(number(&found["asymmetry"]) < 1e-10 && number(&found["mass_error"]) < 1e-10);
    for index in 0..3 {
        let [before, loaded] =
            [found, &found["loaded"]].map(|own| number(&own["principal"][index]["value"]));
        let share = loaded / before;
        assert!(share > CLOSES && share < 0.5, "{share}");
        for other in 0..3 {
            let [upper, lower] = [[index, other], [other, index]]
                .map(|[row, column]| number(&found["loaded"]["components"][row][column]));
            assert!((upper - lower).abs() < 1e-10 * before);
        }
    }
}
