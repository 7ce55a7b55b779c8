//! Orthogonal joint sets as an equivalent continuum.

use glam::DMat3;
use kluft_chart::{Axis, Chart, Series};
use kluft_solver::{Discretisation, Fracture};
use lie_core::ClosureKind;

use crate::oracles::jointed_moduli;
use crate::report::{Effort, Finding, Study, Table, largest};
use crate::scenes::joint;
use crate::scenes::joint_sets::{SPACING, jointed_cube, strain_of_the_diagonal};

pub const PAGE: Study = Study {
    name: "joint-sets",
    title: "Orthogonal joint sets",
    subject: "B. Amadei, R. E. Goodman, Int. Symp. Mech. Behav. Struct. Media, 1981",
    run,
};

const CLOSED_FORM: &str = "
Rock (E = 25 GPa, nu = 0.25) with sets of joints of spacing S = 0.5 m, K_n = 50 GPa/m and K_s = 20
GPa/m, across some axes i, j:

    1/E_i' = 1/E + 1/(K_n S)        1/G_ij' = 1/G + 1/(K_s S) + 1/(K_s S)        nu' = nu E_i'/E

where a set that is not there has no term: E' = 12.5 GPa, G' = 5 GPa (one set of the two) or 3.3333
GPa (both), nu' = 0.125.";

const STRESS: f64 = 1e6;
const AXES: [&str; 3] = ["x", "y", "z"];

fn linear_joint(stiffness: f64) -> Fracture {
    let mut joint = joint(ClosureKind::Linear);
    joint.law.closure.normal_stiffness = stiffness;
    joint
}

/// A modulus in closed form and as found.
struct Modulus {
    sets: usize,
    name: String,
    exact: f64,
    found: f64,
}

impl Modulus {
    fn error(&self) -> f64 {
        (self.found / self.exact - 1.0).abs()
    }
}

/// Strain of the cube under one component of the stress and its mirror.
fn strain(sets: usize, a: usize, b: usize, fracture: Fracture) -> glam::DVec3 {
    let mut stress = [[0.0; 3]; 3];
    stress[a][b] = STRESS;
    stress[b][a] = STRESS;
    strain_of_the_diagonal(&jointed_cube(
        sets,
        DMat3::from_cols_array_2d(&stress),
        fracture,
    ))
}

fn moduli_of(sets: usize) -> Vec<Modulus> {
    let joint = linear_joint(50e9);
    let cut = |axis: usize| axis < sets;
    let (young, _, _) = jointed_moduli(25e9, 0.25, 50e9, 20e9, SPACING, 2.0);
    let mut moduli = Vec::new();
    for (axis, name) in AXES.iter().enumerate() {
        moduli.push(Modulus {
            sets,
            name: format!("E_{name}"),
            exact: if cut(axis) { young } else { 25e9 },
            found: STRESS / strain(sets, axis, axis, joint)[axis],
        });
    }
    for (a, b) in [(0, 1), (1, 2), (0, 2)] {
        let present = f64::from(u8::from(cut(a)) + u8::from(cut(b)));
        let strain = strain(sets, a, b, joint);
        moduli.push(Modulus {
            sets,
            name: format!("G_{}{}", AXES[a], AXES[b]),
            exact: jointed_moduli(25e9, 0.25, 50e9, 20e9, SPACING, present).1,
            found: STRESS / (strain[a] + strain[b]),
        });
    }
    moduli
}

/// `E'/E` of three sets over `K_n S / E`: closed form and found.
fn over_stiffness() -> Vec<(f64, f64, f64)> {
    let ratios = (-8..=8).map(|exponent| 10.0_f64.powf(f64::from(exponent) / 2.0));
    let at = |ratio: f64| {
        let stiffness = ratio * 25e9 / SPACING;
        let found = STRESS / strain(3, 2, 2, linear_joint(stiffness)).z;
        let exact = jointed_moduli(25e9, 0.25, stiffness, 20e9, SPACING, 2.0).0;
        (ratio, exact / 25e9, found / 25e9)
    };
    ratios.map(at).collect()
}

const PROBLEM: &str = "A cube of side 0.5 m, cut through its middle by one, two and three \
    orthogonal joints, under one component of the stress after the other; 4 cubes of six \
    tetrahedra along an edge.";

fn table(moduli: &[Modulus]) -> Table {
    let mut table = Table::new(&["sets", "modulus", "closed form (Pa)", "Kluft (Pa)", "error"]);
    for modulus in moduli {
        table.push([
            modulus.sets.to_string(),
            modulus.name.clone(),
            format!("{:.9e}", modulus.exact),
            format!("{:.9e}", modulus.found),
            format!("{:.0e}", modulus.error()),
        ]);
    }
    table
}

fn chart(sweep: &[(f64, f64, f64)]) -> Chart {
    let closed_form = sweep.iter().map(|(x, exact, _)| (*x, *exact));
    let found = sweep.iter().map(|(x, _, found)| (*x, *found));
    Chart {
        series: vec![
            Series::line("closed form", closed_form.collect()),
            Series::scatter("Kluft", found.collect()),
        ],
        ..Chart::new(
            "Three joint sets: Young's modulus over the stiffness of the joints",
            Axis::logarithmic("K_n S / E"),
            Axis::logarithmic("E' / E"),
        )
    }
}

fn run(_: Effort) -> Finding {
    let moduli: Vec<Modulus> = (1..=3).flat_map(moduli_of).collect();
    let sweep = over_stiffness();
    let worst = largest(moduli.iter().map(Modulus::error));
    let errors = sweep.iter().map(|(_, exact, found)| found / exact - 1.0);
    let swept = largest(errors.map(f64::abs));
    let cube = jointed_cube(3, DMat3::IDENTITY, linear_joint(50e9));
    let sectors = cube.mesh.sectors.count.iter().max().copied().unwrap_or(0);
    let unknowns = Discretisation::of(&cube)
        .expect("supported")
        .unknown_count();
    let reached = format!("moduli {:.0e}", worst.max(swept));
    Finding::new([reached, unknowns.to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject)
        .chart("joint-sets", chart(&sweep))
        .table(table(&moduli))
        .shows(format!(
            "All {} moduli of one, two and three sets are those of the equivalent continuum to \
             {worst:.0e}, also where three joints cross and {sectors} blocks meet in a point; and \
             over eight decades of stiffness Young's modulus is, to {swept:.0e}.",
            moduli.len()
        ))
}
