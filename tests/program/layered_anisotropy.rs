//! Rock whose constants along its axes differ from layer to layer, beside springs in series.

use std::fs;

use crate::fields::{assert_near, numbers, rows};
use crate::harness::{Workshop, kluft};

/// A column of 1 m x 1 m x 2 m whose cells meet at z = 1 m.
const COLUMN: &str = "Point(1) = {0, 0, 0, 0.5};\n\
    line[] = Extrude {1, 0, 0} { Point{1}; Layers{2}; };\n\
    base[] = Extrude {0, 1, 0} { Curve{line[1]}; Layers{2}; };\n\
    rock[] = Extrude {0, 0, 2} { Surface{base[1]}; Layers{4}; };\n\
    Physical Volume(\"rock\") = {rock[1]};\n";

/// Its sides between rollers, and a stress of 1 MPa on top, down or along x.
const SQUEEZED: &str = "[boundary.left]\nwhere = \"x = min\"\nsymmetry = true\n\
    [boundary.right]\nwhere = \"x = max\"\nsymmetry = true\n\
    [boundary.front]\nwhere = \"y = min\"\nsymmetry = true\n\
    [boundary.back]\nwhere = \"y = max\"\nsymmetry = true\n\
    [boundary.bottom]\nwhere = \"z = min\"\nsymmetry = true\n\
    [boundary.top]\nwhere = \"z = max\"\ntraction = [0, 0, -1e6]\n";
const SHEARED: &str = "[boundary.left]\nwhere = \"x = min\"\ndisplacement = { z = 0 }\n\
    [boundary.right]\nwhere = \"x = max\"\ndisplacement = { z = 0 }\n\
    [boundary.front]\nwhere = \"y = min\"\nsymmetry = true\n\
    [boundary.back]\nwhere = \"y = max\"\nsymmetry = true\n\
    [boundary.bottom]\nwhere = \"z = min\"\ndisplacement = { x = 0, y = 0, z = 0 }\n\
    [boundary.top]\nwhere = \"z = max\"\ntraction = [1e6, 0, 0]\ndisplacement = { z = 0 }\n";

fn column(rock: &str, loads: &str) -> Workshop {
    let workshop = Workshop::of(&format!(
        "[mesh]\ngeometry = \"column.geo\"\n[rock.rock]\n{rock}\n{loads}"
    ));
    fs::write(workshop.path("column.geo"), COLUMN).expect("the geometry");
    workshop
}

/// What the top moves along an axis (m).
fn moved(rock: &str, loads: &str, axis: &str) -> f64 {
    let rows = rows(&column(rock, loads).solve("out", &[]));
    numbers(&rows, ["boundary", "top"], axis)[0]
}

/// A value that is one below z = 1 m and another above.
fn layered(below: f64, above: f64) -> String {
    format!(
        "{{ expression = \"{below:?} + {:?}*step(z - 1)\" }}",
        above - below
    )
}

/// Strain across a plane of isotropy for a stress of 1 Pa across it, between walls that do not
/// move: `(1 - 2 nu'^2 E / (E' (1 - nu))) / E'`.
fn squeezed([e, nu, across, nu_across]: [f64; 4]) -> f64 {
    (1.0 - 2.0 * nu_across * nu_across * e / (across * (1.0 - nu))) / across
}

/// All constants of a level bedding vary; the second time some by a table in GPa.
#[test]
fn layers_of_bedded_rock_give_way_one_after_the_other() {
    let [below, above] = [[40e9, 0.25, 20e9, 0.2], [70e9, 0.1, 35e9, 0.15]];
    let [e, nu, across, nu_across] = [0, 1, 2, 3].map(|at: usize| layered(below[at], above[at]));
    let table =
        "{ table = [[0, 20], [0.99, 20], [1.01, 35], [2, 35]], over = \"z\", unit = \"GPa\" }";
    for across in [&across[..], table] {
        let rock = format!(
            "young_modulus = {e}\npoisson_ratio = {nu}\nnormal_young_modulus = {across}\n\
             normal_poisson_ratio = {nu_across}\nnormal_shear_modulus = {}\n",
            layered(8e9, 20e9)
        );
        let wanted = -1e6 * (squeezed(below) + squeezed(above));
        assert_near(moved(&rock, SQUEEZED, "displacement_z"), wanted, 1e-11);
        let wanted = 1e6 * (1.0 / 8e9 + 1.0 / 20e9);
        assert_near(moved(&rock, SHEARED, "displacement_x"), wanted, 1e-11);
    }
}

/// Without Poisson's effect the modulus along the vertical counts: across a level plane below, and
/// down its dip where it stands above, `dip_direction` being 90 there.
#[test]
fn layers_of_orthotropic_rock_have_moduli_and_dips_of_their_own() {
    let moduli = |dip: &str, third: &str| {
        format!(
            "young_moduli = [60e9, 45e9, {third}]\npoisson_ratios = [0, 0, 0]\n\
             shear_moduli = [20e9, 9e9, 9e9]\ndip = {dip}\n"
        )
    };
    let of = |rock: &str| moved(rock, SQUEEZED, "displacement_z");
    let wanted = -1e6 * (1.0 / 20e9 + 1.0 / 32e9);
    assert_near(of(&moduli("0", &layered(20e9, 32e9))), wanted, 1e-11);
    let wanted = -1e6 * (1.0 / 20e9 + 1.0 / 60e9);
    assert_near(of(&moduli(&layered(0.0, 90.0), "20e9")), wanted, 1e-11);
}

#[test]
fn cells_that_are_no_rock_are_refused_with_their_place() {
    let rock = |nu: &str| {
        format!(
            "young_modulus = 40e9\npoisson_ratio = 0.25\nnormal_young_modulus = 20e9\n\
             normal_poisson_ratio = {nu}\nnormal_shear_modulus = 8e9\n"
        )
    };
    let run = column(&rock(&layered(0.2, 0.44)), SQUEEZED).run("out", &[]);
    assert_eq!(run.code, Some(2), "{}", run.err);
    for text in ["cost no energy", "0.433013", "more cells"] {
        assert!(run.err.contains(text), "{text}: {}", run.err);
    }
    let far = "{ table = [[0, 0.2], [1, 0.1]], over = \"z\" }";
    let run = column(&rock(far), SQUEEZED).run("out", &[]);
    assert!(run.err.contains("there is no row"), "{}", run.err);
}

#[test]
fn an_inspection_tells_constants_that_vary() {
    let rock = format!(
        "young_moduli = [60e9, 45e9, {}]\npoisson_ratios = [0, 0, 0]\n\
         shear_moduli = [20e9, 9e9, 9e9]\n",
        layered(20e9, 32e9)
    );
    let workshop = column(&rock, SQUEEZED);
    let run = kluft(&["inspect".as_ref(), workshop.scene().as_os_str()]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(run.out.contains("2.0000e10 to 3.2000e10 Pa"), "{}", run.out);
}
