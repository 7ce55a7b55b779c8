//! Writes the scene that runs the network.

use std::fmt::Write;

use kluft_keys::{quoted, section_head};
use kluft_network::{Grouping, Network};

use kluft_scene::FluidUse;

use super::input::Input;
use super::passages::Passage;

/// First line of a scene that may be written again.
pub(super) const MADE: &str = "# Made by `kluft network`; remove this line to protect the file.";

const ROCK: &str = "
[rock.rock]                       # assumed: granite
young_modulus = 50e9
poisson_ratio = 0.25
";

const SURFACES: &str = "dimension = 2                     # the rock is rigid\n";

const ISOLATED: &str = "isolated = \"inactive\"             # assumed\n";

const PERMEABILITY: &str =
    "equivalent_permeability = true    # assumed: nothing else drives the fluid\n";

const MATERIAL: [(&str, &str); 4] = [
    ("aperture", "1e-3"),
    ("normal_stiffness", "2e10"),
    ("shear_stiffness", "1e10"),
    ("closure", "\"logarithmic\""),
];

const BOUNDARIES: &str = "
[boundary.top]                    # assumed: 10 MPa on top, rollers on three faces
pressure = 10e6

[boundary.bottom]
symmetry = true

[boundary.left]
symmetry = true

[boundary.front]
symmetry = true
";

/// The scene of a network whose geometry is the file `geometry`.
pub(super) fn text(input: &Input, network: &Network, grouping: Grouping, geometry: &str) -> String {
    let mut out = format!("{MADE}\ntitle = {}\n", quoted(&input.title));
    let sizes = &network.sizes;
    let _ = write!(
        out,
        "\n[mesh]\ngeometry = {}\nparameters = {{ h = {:?}, h_fracture = {:?}, h_intersection = {:?} }}\n",
        quoted(geometry),
        sizes.h,
        sizes.h_fracture,
        sizes.h_intersection
    );
    let is_rigid = input.fluid == FluidUse::InRigidRock;
    if is_rigid && input.body.is_none() {
        out.push_str(SURFACES);
    } else if !is_rigid && !input.passages.has("rock") {
        out.push_str(ROCK);
    }
    for (head, passage) in &input.passages.0 {
        section(&mut out, head, passage);
        if head == "[fluid]" {
            assumptions(&mut out, input, is_rigid);
        }
    }
    if !is_rigid && !input.passages.has("boundary") {
        out.push_str(BOUNDARIES);
    }
    fractures(&mut out, input, network, grouping);
    out
}

/// What is assumed of a fluid.
fn assumptions(out: &mut String, input: &Input, is_rigid: bool) {
    let passages = &input.passages;
    if !passages.says("fluid", "isolated") {
        out.push_str(ISOLATED);
    }
    let drives = ["fluid_pressure", "fluid_inflow"];
    let of_boundaries = drives.iter().any(|key| passages.says("boundary", key));
    let materials = || input.sets.iter().filter_map(|set| set.material.as_ref());
    let of_sets = materials()
        .flatten()
        .any(|(key, _)| key == "fluid_pressure");
    let is_driven = of_boundaries || of_sets || passages.has("source");
    if is_rigid && !is_driven && !passages.says("fluid", "equivalent_permeability") {
        out.push_str(PERMEABILITY);
    }
}

fn section(out: &mut String, head: &str, passage: &Passage) {
    let _ = writeln!(out, "\n{head}");
    for (key, value) in passage {
        let _ = writeln!(out, "{key} = {value}");
    }
}

/// One section a physical surface; a single set is the default of all.
fn fractures(out: &mut String, input: &Input, network: &Network, grouping: Grouping) {
    let has_law = input.sets.iter().any(|set| set.aperture_law.is_some());
    if let ([only], false) = (&input.sets[..], has_law) {
        material(out, "[fracture.default]", input, &only.name);
        return;
    }
    match grouping {
        Grouping::Set => {
            for set in &input.sets {
                if network
                    .fractures
                    .iter()
                    .any(|fracture| fracture.set == set.name)
                {
                    material(out, &section_head("fracture", &set.name), input, &set.name);
                }
            }
        }
        Grouping::Fracture => {
            for fracture in &network.fractures {
                let head = section_head("fracture", &fracture.name);
                material(out, &head, input, &fracture.set);
                let set = input.sets.iter().find(|set| set.name == fracture.set);
                if let Some(law) = set.and_then(|set| set.aperture_law) {
                    let _ = writeln!(
                        out,
                        "hydraulic_aperture = {:?}",
                        law.of_area(fracture.area_given)
                    );
                }
            }
        }
    }
}

fn material(out: &mut String, head: &str, input: &Input, set: &str) {
    let known = input.sets.iter().find(|other| other.name == set);
    match known.and_then(|set| set.material.as_ref()) {
        Some(passage) => section(out, head, passage),
        None => {
            let assumed = MATERIAL.map(|(key, value)| (key.to_owned(), value.to_owned()));
            section(
                out,
                &format!("{head:<33} # assumed: a stiff joint"),
                &assumed.to_vec(),
            );
        }
    }
}
