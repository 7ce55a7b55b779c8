//! Scenes in rock that is stiffer in some directions than in others.

use std::fs;

use crate::harness::{Workshop, edited, root};
use crate::plane::{compare, probes};

/// Lekhnitskii's numbers in the head of the scene. Displacements are held at 80 radii, which is
/// worth some `1/80^2`; stresses are those of cells of a twelfth of the radius.
#[test]
fn a_tunnel_in_bedded_rock_is_that_of_lekhnitskii() {
    let workshop = Workshop::new("bedded-tunnel", &[]);
    let out = workshop.solve("out", &[]);
    compare(
        &probes(&out),
        &[
            ("side", "displacement_x", -4.125_176e-4, 2e-3),
            ("side", "displacement_y", 8.113_933e-5, 5e-3),
            ("crown", "displacement_x", 5.409_289e-5, 5e-3),
            ("crown", "displacement_y", -2.527_444e-4, 2e-3),
            ("beside", "stress_yy", -7.381_229e6, 0.01),
            ("above", "stress_xx", -1.313_326e7, 0.03),
        ],
    );
}

/// A crack under pressure in an unbounded plate opens by `H_22 p sqrt(a^2 - x^2)`, with
/// `H_22 = -2 beta_22 Im(1/mu_1 + 1/mu_2)` in the axes of the crack (Z. Suo, Proc. R. Soc. A 427,
/// 1990). With roots `i s` in the axes of a bedding that is turned by `phi` against the crack,
/// `Im(1/mu) = -s / (sin^2 phi + s^2 cos^2 phi)`.
fn compliance(phi: f64) -> f64 {
    let (e, across, nu, nu_across, shear) = (40e9, 20e9, 0.25_f64, 0.2_f64, 8e9);
    let b11 = (1.0 - nu * nu) / e;
    let b22 = 1.0 / across - nu_across * nu_across * e / (across * across);
    let mixed = 1.0 / shear - 2.0 * nu_across * (1.0 + nu) / across;
    let root = (mixed * mixed - 4.0 * b11 * b22).sqrt();
    let (sin, cos) = phi.sin_cos();
    let (sin2, cos2) = (sin * sin, cos * cos);
    let turned = b11 * sin2 * sin2 + b22 * cos2 * cos2 + mixed * sin2 * cos2;
    let roots = [mixed + root, mixed - root].map(|sum| (sum / (2.0 * b11)).sqrt());
    let terms = roots.map(|s| s / (sin2 + s * s * cos2));
    2.0 * turned * (terms[0] + terms[1])
}

/// By all linear solvers. The plate is 60 half-lengths to each side, which leaves 1/60^2.
#[test]
fn a_crack_in_bedded_rock_opens_as_in_closed_form() {
    let oracle = fs::read_to_string(root().join("geometries/plates/scene.toml"));
    let oracle = oracle.expect("the scene");
    let from = oracle.find("[oracle.crack]").expect("an oracle");
    let until = oracle.find("[study]").expect("a study");
    let isotropic = "young_modulus = 25e9\npoisson_ratio = 0.25";
    for (degrees, solver) in [
        (0, "direct"),
        (30, "direct"),
        (30, "condensed"),
        (30, "iterative"),
        (90, "direct"),
    ] {
        let bedded = format!(
            "young_modulus = 40e9\npoisson_ratio = 0.25\nnormal_young_modulus = 20e9\n\
             normal_poisson_ratio = 0.2\nnormal_shear_modulus = 8e9\ndip = 90\n\
             dip_direction = {}",
            360 - degrees
        );
        let probe = format!(
            "[solver]\nlinear = \"{solver}\"\n[probe.middle]\nfracture = \"crack\"\nat = [0.0, 0.0, 0.0]\n"
        );
        let scene = Workshop::new(
            "plates",
            &[(isotropic, &bedded), (&oracle[from..until], &probe)],
        );
        let out = scene.solve("out", &[]);
        let opening = 2e6 * compliance(f64::from(degrees).to_radians());
        compare(
            &probes(&out),
            &[("middle", "aperture", opening + 1e-5, 5e-4)],
        );
    }
}

const ROCK: &str = "young_modulus = 40e9\npoisson_ratio = 0.25\nnormal_young_modulus = 20e9\n\
                    normal_poisson_ratio = 0.2\nnormal_shear_modulus = 8e9\ndip = 90\n\
                    dip_direction = 330";

/// Each with its bound.
#[test]
fn what_is_no_rock_is_refused() {
    let scene = fs::read_to_string(root().join("geometries/bedded-tunnel/scene.toml"));
    let scene = scene.expect("the scene");
    let orthotropic = "young_moduli = [1e9, 2e9, 3e9]\npoisson_ratios = [0.9, 0.2, 0.1]\n\
                       shear_moduli = [1e9, 1e9, 1e9]";
    for (edit, says) in [
        (ROCK.replace("ratio = 0.2\n", "ratio = 0.44\n"), "0.433013"),
        (ROCK.replace("dip = 90", "dip = 40"), "across the plane"),
        (
            ROCK.replace("normal_shear_modulus = 8e9\n", ""),
            "normal_shear_modulus",
        ),
        (
            ROCK.replace("dip = 90", "dip = { expression = \"40 + 0*x\" }"),
            "across the plane",
        ),
        (orthotropic.to_owned(), "sqrt(E_i/E_j)"),
        (format!("{orthotropic}\nyoung_modulus = 1e9"), "three axes"),
    ] {
        let workshop = Workshop::of(&edited(&scene, &[(ROCK, &edit)]));
        let geometry = root().join("geometries/bedded-tunnel/bedded-tunnel.geo");
        fs::copy(geometry, workshop.path("bedded-tunnel.geo")).expect("the geometry");
        let run = workshop.run("out", &[]);
        assert_eq!(run.code, Some(2), "{edit}: {}", run.err);
        assert!(run.err.contains(says), "{says}: {}", run.err);
    }
    let crack = Workshop::new(
        "line-crack",
        &[("young_modulus = 25e9\npoisson_ratio = 0.25", ROCK)],
    );
    let run = crack.run("out", &[]);
    assert!(run.err.contains("isotropic rock only"), "{}", run.err);
}
