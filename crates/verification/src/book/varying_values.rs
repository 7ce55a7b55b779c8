//! Values that vary within a scene: samples, expressions, tables.

use crate::report::{Effort, Finding, Study, Table, largest, percent};
use crate::root;

use super::refinement::{Refinement, Shown};
use super::scene::{self, Outcome};

pub const PAGE: Study = Study {
    name: "varying-values",
    title: "Values from files, expressions and tables",
    subject: "equilibrium, and the laws of rock and joint integrated by hand",
    run,
};

const PROBLEM: &str = "Scenes in which values vary. `geometries/scanned-joint`: a joint whose normal \
    stiffness is linear between 25 samples of a file, under a load in proportion to it by an \
    expression. `geometries/water-by-depth`: water in an upright joint by a table over depth, and \
    outside by an expression. `geometries/scanned-fault`: a fault whose stiffness comes from a file, \
    across a block. At last the column of `geometries/scanned-joint` with rock whose Young's modulus \
    doubles from foot to top by an expression, and an even joint.";

const CLOSED_FORM: &str = "
    scanned joint    both halves bend alike, the joint closes by 1e-5 m everywhere: aperture 9e-5 m, mean traction -3e5 Pa
    water by depth   the joint carries 2 MPa alone: aperture 4e-4 m; the face moves by 2 m of the mean strain, and by 1e-4 m
    scanned fault    equilibrium: mean normal traction -4e6 cos^2 30 Pa
    growing modulus  E = E_0 (1 + z/2) over 2 m under p: shortened by 2 p/E_0 ln 2 + p/K_n

Each cell of rock has the modulus of its middle, an error of the second order in the size of cells; the others are exact in
cells of second order, or whatever the mesh.";

/// `E_0` (Pa), `p` (Pa) and `K_n` (Pa/m) of the column.
const COLUMN: [f64; 3] = [25e9, 1e6, 20e9];

/// The samples of a scene by their path.
fn samples(scene: &str) -> String {
    let file = root().join("geometries").join(scene).join("scan.csv");
    format!("file = {file:?}")
}

fn column(size: f64) -> Outcome {
    let joint = "{ file = \"scan.csv\", column = \"kn\", unit = \"GPa/m\", method = \"linear\" }";
    let load = "{ expression = \"1e-5 * (20e9 + 20e9*x)\" }";
    let edits = [
        (joint, "20e9"),
        (
            "young_modulus = 25e9",
            "young_modulus = { expression = \"25e9*(1 + z/2)\" }",
        ),
        ("poisson_ratio = 0.25", "poisson_ratio = 0"),
        (load, "1e6"),
        (
            "# Three corners",
            "[probe.top]\nboundary = \"top\"\n[probe.bottom]\nboundary = \"bottom\"\n# Three corners",
        ),
    ];
    let mesh = format!("parameters = {{ h = {size}, dip = 0 }}\norder = 2");
    scene::run_edited("scanned-joint", &mesh, &edits)
}

fn error_of_column(outcome: &Outcome) -> f64 {
    let [modulus, pressure, stiffness] = COLUMN;
    let exact = -pressure * (2.0 / modulus * 2_f64.ln() + 1.0 / stiffness);
    let moved = |face| outcome.probed(face, "displacement_z");
    ((moved("top") - moved("bottom")) / exact - 1.0).abs()
}

/// Quantities of the scenes with their closed forms, and the most unknowns.
fn exact() -> (Vec<(String, f64, f64)>, usize) {
    let run = |name: &str, mesh: &str| {
        let own = samples(name);
        scene::run_edited(name, mesh, &[("file = \"scan.csv\"", &own)])
    };
    let joint = run(
        "scanned-joint",
        "parameters = { h = 0.4, dip = 0 }\norder = 2",
    );
    let fault = run("scanned-fault", "");
    let water = scene::run("water-by-depth", "order = 2");
    let strain = (1.0 - 0.25 * 0.25) / 25e9 * -(2e6 + 9810.0 * 5.0);
    let cos = 30_f64.to_radians().cos();
    let mut found = Vec::new();
    for (scene, own, aperture) in [
        ("scanned joint", &joint, 9e-5),
        ("water by depth", &water, 4e-4),
    ] {
        for (which, key) in [("smallest", "min"), ("largest", "max")] {
            let name = format!("{scene}, {which} aperture, m");
            found.push((name, aperture, own.of("joint", &["aperture", key])));
        }
    }
    let traction = |own: &Outcome, name: &str| own.of(name, &["normal_traction", "mean"]);
    let face = water.probed("face", "displacement_x");
    for (name, wanted, own) in [
        (
            "scanned joint, mean normal traction, Pa",
            -3e5,
            traction(&joint, "joint"),
        ),
        (
            "water by depth, displacement of the face, m",
            2.0 * strain - 1e-4,
            face,
        ),
        (
            "scanned fault, mean normal traction, Pa",
            -4e6 * cos * cos,
            traction(&fault, "fault"),
        ),
    ] {
        found.push((name.to_owned(), wanted, own));
    }
    let unknowns = [joint, fault, water].iter().map(Outcome::unknowns).max();
    (found, unknowns.unwrap_or(0))
}

const SHOWN: Shown = Shown {
    file: "varying-values",
    title: "A column whose modulus grows with elevation: error over the size of cells",
    size: "size of cells (m)",
    rate: Some(2.0),
};

fn run(effort: Effort) -> Finding {
    let sizes: &[f64] = match effort {
        Effort::Quick => &[0.8, 0.4],
        Effort::Full => &[0.8, 0.4, 0.2, 0.1],
    };
    let columns: Vec<(f64, Outcome)> = sizes.iter().map(|&size| (size, column(size))).collect();
    let errors = columns
        .iter()
        .map(|(size, outcome)| (*size, error_of_column(outcome)));
    let refinement = Refinement::of("shortening", errors.collect::<Vec<_>>());
    let (exact, unknowns) = exact();
    let mut table = Table::new(&["quantity", "closed form", "found", "error"]);
    let mut worst = Vec::new();
    for (name, wanted, found) in exact {
        let error = (found / wanted - 1.0).abs();
        worst.push(error);
        table.push([
            name,
            format!("{wanted:.6e}"),
            format!("{found:.6e}"),
            format!("{error:.0e}"),
        ]);
    }
    let (worst, left) = (largest(worst), percent(refinement.finest()));
    let unknowns = columns
        .iter()
        .map(|(_, own)| own.unknowns())
        .fold(unknowns, usize::max);
    let page = Finding::new([
        format!("exact ones {worst:.0e}, column {left}"),
        unknowns.to_string(),
    ])
    .text(PROBLEM)
    .closed_form(CLOSED_FORM, PAGE.subject)
    .table_in("varying-values-exact", table);
    SHOWN.on(page, &[refinement]).shows(format!(
        "Joints whose stiffness, water and loads vary have their closed forms to {worst:.0e}. Rock that \
         varies from cell to cell is within {left} on the finest mesh."
    ))
}
