//! Random rock, fractures, supports and loads, as far as a scene may say them.

use std::fmt::Write as _;

use super::random_stream::{RandomStream, rounded};

/// The sections of a scene beside its mesh, solver and load steps.
pub fn random(fractures: &[&str], random: &mut RandomStream) -> String {
    let mut text = rock(random);
    for name in fractures {
        let _ = write!(text, "[fracture.{name}]\n{}", fracture(random));
    }
    text + &boundaries(random)
}

fn rock(random: &mut RandomStream) -> String {
    let young_modulus = if random.chance(0.15) {
        random.decades(5.0, 13.0)
    } else {
        random.decades(9.0, 11.0)
    };
    let hostile = [0.0, -0.5, 0.45, 0.49, 0.499, 0.4999];
    let poisson_ratio = if random.chance(0.4) {
        random.pick(&hostile)
    } else {
        rounded(random.between(0.05, 0.4))
    };
    let mut text = format!(
        "[rock.default]\nyoung_modulus = {young_modulus:e}\npoisson_ratio = {poisson_ratio}\n"
    );
    if random.chance(0.1) {
        text += "density = 2700\n[body]\ngravity = [0, 0, -9.81]\n";
    }
    if random.chance(0.15) {
        let [x, y, z] = [0; 3].map(|_| -random.decades(5.0, 7.5));
        let _ = write!(
            text,
            "[initial_stress]\nxx = {x:e}\nyy = {y:e}\nzz = {z:e}\n"
        );
    }
    text
}

fn fracture(random: &mut RandomStream) -> String {
    let closure = random.pick(&["linear", "logarithmic", "hyperbolic", "contact"]);
    let aperture = random.decades(-6.0, -2.5);
    let mut text = format!("aperture = {aperture:e}\nclosure = \"{closure}\"\n");
    let stiffness = if random.chance(0.1) {
        random.decades(4.0, 18.0)
    } else {
        random.decades(8.0, 14.0)
    };
    if closure != "contact" {
        let _ = writeln!(text, "normal_stiffness = {stiffness:e}");
        text += &tension(stiffness, random);
    }
    if closure == "logarithmic" && random.chance(0.3) {
        let cutoff = rounded(aperture * random.decades(-6.0, -0.01));
        let _ = writeln!(text, "cutoff_aperture = {cutoff:e}");
    }
    if closure == "hyperbolic" && random.chance(0.3) {
        let closes = rounded(aperture * random.between(0.3, 0.99));
        let _ = writeln!(text, "max_closure = {closes:e}");
    }
    let has_friction = random.chance(0.5);
    if has_friction {
        text += &friction(random);
    }
    // Walls that friction holds need no stiffness, and those in contact without it have none.
    let is_rigid = has_friction && random.chance(0.5);
    if !is_rigid && (has_friction || closure != "contact") {
        let shear = rounded(stiffness * random.decades(-3.0, 1.0));
        let _ = writeln!(text, "shear_stiffness = {shear:e}");
    }
    if random.chance(0.2) {
        let pressure = random.pick(&[1.0, 1.0, -1.0]) * random.decades(4.0, 7.0);
        let _ = writeln!(text, "fluid_pressure = {pressure:e}");
    }
    text
}

/// Nothing, a cutoff, or at times a bond that breaks.
fn tension(stiffness: f64, random: &mut RandomStream) -> String {
    if random.chance(0.05) {
        let strength = random.decades(4.0, 7.0);
        let energy = rounded(strength * strength / stiffness * random.decades(0.0, 3.0));
        return format!("tensile_strength = {strength:e}\nfracture_energy = {energy:e}\n");
    }
    format!("tension_cutoff = {}\n", random.chance(0.5))
}

fn friction(random: &mut RandomStream) -> String {
    let angle = random.pick(&[0.0, 5.0, 15.0, 30.0, 30.0, 30.0, 45.0, 60.0, 80.0]);
    let mut text = format!("friction_angle = {angle}\n");
    if angle == 0.0 || random.chance(0.3) {
        let _ = writeln!(text, "cohesion = {:e}", random.decades(3.0, 7.0));
    }
    if random.chance(0.4) {
        let dilation = angle * random.pick(&[0.1, 0.2, 0.5, 1.0]);
        let _ = writeln!(text, "dilation_angle = {dilation}");
    }
    text
}

/// Supports that hold the cube as a whole, and loads of either sign.
fn boundaries(random: &mut RandomStream) -> String {
    let push = random.pick(&[1.0, -1.0]) * random.decades(-6.0, -3.0);
    let drag = push * random.pick(&[0.0, 0.0, 1.0, -3.0]);
    let moved = format!(
        "[boundary.bottom]\ndisplacement = {{ x = 0.0, y = 0.0, z = 0.0 \
         }}\n[boundary.top]\ndisplacement = {{ x = {drag:e}, z = {push:e} }}\n"
    );
    let supports = [
        "[boundary.bottom]\ndisplacement = { z = 0.0 }\n[boundary.left]\ndisplacement = { x = 0.0 \
         }\n[boundary.front]\ndisplacement = { y = 0.0 }\n",
        "[boundary.bottom]\ndisplacement = { x = 0.0, y = 0.0, z = 0.0 }\n",
        "[boundary.bottom]\nsymmetry = true\n[boundary.left]\nsymmetry = \
         true\n[boundary.front]\nsymmetry = true\n",
        &moved,
    ];
    let chosen = random.below(supports.len());
    let mut text = supports[chosen].to_owned();
    let size = random.decades(4.0, 7.7);
    if supports[chosen] != moved {
        let sign = random.pick(&[-1.0, -1.0, -1.0, 1.0]);
        let shear = random.pick(&[0.0, 0.0, 0.1, 0.3, 1.0]);
        let [x, y] = [0; 2].map(|_| rounded(shear * size * random.between(-1.0, 1.0)));
        let z = sign * size;
        let _ = write!(text, "[boundary.top]\ntraction = [{x:e}, {y:e}, {z:e}]\n");
    }
    for face in ["right", "back"] {
        if random.chance(0.4) {
            let pressure =
                rounded(random.pick(&[1.0, 1.0, -1.0]) * size * random.between(0.0, 1.0));
            let _ = write!(text, "[boundary.{face}]\npressure = {pressure:e}\n");
        }
    }
    text
}
