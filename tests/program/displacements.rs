//! Prescribed displacements that vary in space and time, against closed forms.

use std::collections::BTreeMap;
use std::fs;

use crate::fields::{assert_near, numbers, rows};
use crate::harness::{Workshop, kluft, root};
use crate::plane::probes;
use crate::resume::goes_on_to_the_same_bits;

const FACES: [&str; 6] = ["left", "right", "front", "back", "bottom", "top"];
/// Young's modulus (Pa) and Poisson's ratio of the block.
const ROCK: [f64; 2] = [30e9, 0.25];

/// A block of 1 m x 1 m x 2 m with an oblique plane in it that is welded unless `rest` names it.
fn block(mesh: &str, poisson_ratio: f64, rest: &str) -> Workshop {
    let geometry = root().join("geometries/inclined-joint/inclined-joint.geo");
    Workshop::of(&format!(
        "[mesh]\ngeometry = \"{}\"\n{mesh}\n[rock.rock]\nyoung_modulus = {:e}\n\
         poisson_ratio = {poisson_ratio}\n\
         [warnings]\nsilence = [\"unnamed_surfaces\", \"values\", \"overlapping_walls\"]\n{rest}\n",
        geometry.display(),
        ROCK[0],
    ))
}

/// The section of a face that moves by these expressions.
fn moved(face: &str, u: [&str; 3]) -> String {
    let [x, y, z] = u.map(|text| format!("{{ expression = \"{text}\" }}"));
    format!("[boundary.{face}]\ndisplacement = {{ x = {x}, y = {y}, z = {z} }}\n")
}

/// Rows of a plane of probes in a block all faces of which move by these expressions.
fn probed(mesh: &str, u: [&str; 3], rest: &str) -> Vec<BTreeMap<String, String>> {
    let faces: String = FACES.iter().map(|face| moved(face, u)).collect();
    let probe = "[probe.plane]\nfrom = [0.11, 0.13, 0.17]\nto = [0.87, 0.13, 0.17]\ncount = 9\n\
                 across = [0.0, 0.71, 1.63]\nrows = 9\n";
    probes(&block(mesh, ROCK[1], &format!("{faces}{probe}{rest}")).solve("out", &[]))
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().expect(column)
}

/// Hooke's law in the uniform strain of `u = G x`, through rock alone and through a joint that
/// gives way by less than 1e-9 of what cells do. Both walls of the cut faces have the value of
/// their place, so that the joint is shut there.
#[test]
fn a_linear_displacement_of_all_faces_has_the_stress_of_hookes_law() {
    let u = [
        "-2e-4*x + 1e-4*y + 3e-5*z",
        "5e-5*x + 1e-4*y - 7e-5*z",
        "2e-5*x + 4e-5*y - 3e-4*z",
    ];
    // lambda = mu = 12 GPa, and the trace of G is -4e-4.
    let wanted = [
        ("stress_xx", -9.6e6),
        ("stress_yy", -2.4e6),
        ("stress_zz", -12e6),
        ("stress_xy", 1.8e6),
        ("stress_yz", -3.6e5),
        ("stress_xz", 6e5),
    ];
    let joint = "[fracture.joint]\naperture = 1e-3\nnormal_stiffness = 1e20\n\
                 shear_stiffness = 1e20\n";
    for (rest, share) in [("", 1e-11), (joint, 1e-8)] {
        for mesh in ["parameters = { h = 0.4 }", "order = 2"] {
            for row in probed(mesh, u, rest) {
                for (column, stress) in wanted {
                    let error = number(&row, column) - stress;
                    assert!(error.abs() < share * 12e6, "{column} {error:e} {rest}");
                }
            }
        }
    }
}

/// Bending without forces in the rock, `u = k (x z, -nu y z, -(x^2 + nu (z^2 - y^2)) / 2)` with the
/// stress `E k z` along x alone.
const BENT: [&str; 3] = [
    "1e-4*x*z",
    "-0.25e-4*y*z",
    "-0.5e-4*(x^2 + 0.25*(z^2 - y^2))",
];

/// Largest and mean square root error of the displacement along z of that bending (m).
fn bending_errors(mesh: &str) -> [f64; 2] {
    let rows = probed(mesh, BENT, "");
    let errors = rows.iter().map(|row| {
        let [x, y, z] = ["x", "y", "z"].map(|axis| number(row, axis));
        let exact = -0.5e-4 * (x * x + 0.25 * (z * z - y * y));
        (number(row, "displacement_z") - exact).abs()
    });
    let errors: Vec<f64> = errors.collect();
    let squares = errors.iter().map(|error| error * error).sum::<f64>();
    let mean = (squares / errors.len() as f64).sqrt();
    [errors.into_iter().fold(0.0, f64::max), mean]
}

/// Cells of second order hold the quadratic field to round-off of its 1e-4 m; those of first order
/// converge to it with order 2, where each cell is divided into eight.
#[test]
fn a_quadratic_displacement_is_exact_in_second_order_and_converges_in_first() {
    let [largest, _] = bending_errors("parameters = { h = 0.4 }\norder = 2");
    assert!(largest < 1e-15, "{largest:e}");
    let meshes = [1, 2].map(|refine| format!("parameters = {{ h = 0.5 }}\nrefine = {refine}"));
    let [coarse, fine] = meshes.map(|mesh| bending_errors(&mesh)[1]);
    let order = (coarse / fine).log2();
    assert!((1.8..2.2).contains(&order), "{order} {coarse:e} {fine:e}");
}

/// A column without Poisson's ratio between a face at rest and one that moves with the time, on a
/// node that carries it along x: `F = E A u / L`. Times need no load to have grown before.
const PUSHED: &str = "[load]\ntimes = [0.5, 2.0, 3.0]\n\
    [boundary.bottom]\ndisplacement = { z = 0.0 }\n\
    [boundary.front]\ndisplacement = { y = 0.0 }\n\
    [boundary.back]\ndisplacement = { y = 0.0 }\n\
    [boundary.top]\ndisplacement = { z = { expression = \"-0.1*time^2\", unit = \"mm\" } }\n\
    [[fixed_point]]\nat = [0.0, 0.0, 0.0]\n\
    displacement = { x = { table = [[0, 0], [60, 6e-2]], over = \"time\" } }\n";

#[test]
fn a_face_moves_with_the_time_and_by_its_history() {
    let history = "unit = \"mm\" } }\nhistory = [[0, 1], [2, 1], [3, 0.5]]\n";
    let scaled = PUSHED.replace("unit = \"mm\" } }\n", history);
    for (rest, factors) in [(PUSHED, [1.0; 3]), (&scaled, [1.0, 1.0, 0.5])] {
        let rows = rows(&block("parameters = { h = 0.5 }", 0.0, rest).solve("out", &[]));
        let force = numbers(&rows, ["boundary", "top"], "force_z");
        let carried = numbers(&rows, ["boundary", "bottom"], "displacement_x");
        for (step, time) in [0.5_f64, 2.0, 3.0].into_iter().enumerate() {
            let moved = -1e-4 * time * time * factors[step];
            assert_near(force[step], 0.5 * ROCK[0] * moved, 1e-11);
            assert_near(carried[step], 1e-3 * time, 1e-11);
        }
    }
}

#[test]
fn a_face_that_moves_with_the_time_is_resumed_to_the_same_bits() {
    let times: Vec<String> = (1..=60).map(|step| format!("{step}.0")).collect();
    let joint = "[fracture.joint]\naperture = 1e-3\nnormal_stiffness = 1e11\n\
                 shear_stiffness = 1e10\nclosure = \"logarithmic\"\n";
    let scene = PUSHED
        .replace("0.5, 2.0, 3.0", &times.join(", "))
        .replace("-0.1*time^2", "-0.01*time*(1 + x)");
    let workshop = block("parameters = { h = 0.3 }", 0.25, &format!("{joint}{scene}"));
    goes_on_to_the_same_bits(&workshop);
}

/// A support elsewhere along the same edge may say the same in other words, and differ by rounding.
#[test]
fn values_that_differ_by_rounding_hold_one_edge() {
    let scene = "[boundary.bottom]\ndisplacement = { x = 0, y = 0, z = 0 }\n\
        [boundary.top]\ndisplacement = { z = { expression = \"1e-4*sin(PI*x)\" } }\n\
        [boundary.right]\ndisplacement = { z = 0 }\n";
    block("parameters = { h = 0.5 }", 0.25, scene).solve("out", &[]);
}

/// Samples of a file serve, and a resumed run knows them.
#[test]
fn samples_move_a_face() {
    let scene = PUSHED
        .replace("times = [0.5, 2.0, 3.0]", "steps = [1.0]")
        .replace(
            "table = [[0, 0], [60, 6e-2]], over = \"time\"",
            "expression = \"0\"",
        )
        .replace(
            "expression = \"-0.1*time^2\", unit = \"mm\"",
            "file = \"subsidence.csv\", column = \"w\", unit = \"mm\", method = \"linear\"",
        );
    let workshop = block("parameters = { h = 0.5 }", 0.0, &scene);
    fs::write(workshop.path("subsidence.csv"), "x,w\n0,-0.1\n1,-0.3\n").expect("written");
    let rows = rows(&workshop.solve("out", &[]));
    let moved = numbers(&rows, ["boundary", "top"], "displacement_z")[0];
    assert_near(moved, -2e-4, 1e-9);
}

#[test]
fn an_inspection_tells_displacements_that_vary() {
    let workshop = block("parameters = { h = 0.5 }", 0.25, PUSHED);
    let run = kluft(&["inspect".as_ref(), workshop.scene().as_os_str()]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    for text in ["z by `-0.1*time^2`", "-9.0000e-4 to -2.5000e-5 m"] {
        assert!(run.out.contains(text), "{text:?} is not in\n{}", run.out);
    }
}

#[test]
fn displacements_that_say_nothing_are_refused() {
    let whole = "{ expression = \"-0.1*time^2\", unit = \"mm\" }";
    for (value, says) in [
        (
            "{ table = [[0, 0], [0.5, 1e-4]], over = \"x\" }",
            &["no row", "displacement.z]"][..],
        ),
        (
            "{ expression = \"1e-3*x\", unit = \"MPa\" }",
            &["\"MPa\"", "length"],
        ),
        ("{ expression = \"1e-3/(x - x)\" }", &["finite"]),
        ("{ expression = \"1e-3*x\", reach = 1 }", &["reach"]),
    ] {
        let run = block("", 0.25, &PUSHED.replace(whole, value)).run("out", &[]);
        assert_eq!(run.code, Some(2), "{value}: {}", run.err);
        for text in says {
            assert!(run.err.contains(text), "{text}: {}", run.err);
        }
    }
    let stepped = PUSHED.replace("times = [0.5, 2.0, 3.0]", "steps = [1.0]");
    let run = block("", 0.25, &stepped).run("out", &[]);
    assert!(run.err.contains("no times"), "{}", run.err);
    let apart = [
        moved("left", ["1e-4*z", "0", "0"]),
        moved("top", ["2e-4*z", "0", "0"]),
    ];
    let run = block("", 0.25, &apart.concat()).run("out", &[]);
    for text in ["`left` and `top`", "different displacements"] {
        assert!(run.err.contains(text), "{text}: {}", run.err);
    }
}
