//! A tunnel in bedded rock.

use kluft_chart::{Axis, Chart, Series};

use crate::oracles::bedding::{Bedded, Hole};
use crate::report::{Effort, Finding, Study, largest, percent};

use super::refinement::{Refinement, Shown};
use super::scene::{self, Outcome};

pub const PAGE: Study = Study {
    name: "bedded-tunnel",
    title: "A tunnel in bedded rock",
    subject: "S. G. Lekhnitskii, Anisotropic Plates, 1968",
    run,
};

const PROBLEM: &str = "The scene `geometries/bedded-tunnel`: a circular tunnel of 1 m radius in shale \
    whose bedding rises by 30 degrees (E = 40 GPa and nu = 0.25 along it, E' = 20 GPa, nu' = 0.2, \
    G' = 8 GPa across), under 7.5 MPa from the sides and 5 MPa from above, in plane strain; second-order \
    triangles, the plate held at 240 radii. Probes stand around the tunnel at every 15 degrees: \
    displacements at 1.02 radii, stresses at 1.25. Errors are against the largest displacement or stress \
    there.";

const CLOSED_FORM: &str = "
With the compliances of plane strain in the axes of the bedding

    b_11 = (1 - nu^2)/E   b_22 = 1/E' - nu'^2 E/E'^2   b_12 = -nu' (1 + nu)/E'   b_66 = 1/G'

and the roots mu_k of b_11 mu^4 + (2 b_12 + b_66) mu^2 + b_22 = 0 in the upper half-plane, displacements and stresses follow
from two potentials C_k / zeta_k, where

    zeta_k = (z_k + sqrt(z_k^2 - 1 - mu_k^2)) / (1 - i mu_k)   z_k = x + mu_k y

and C_1 + C_2 and mu_1 C_1 + mu_2 C_2 leave the wall without traction.";

/// Where displacements and stresses are probed (m).
const RADII: [f64; 2] = [1.02, 1.25];
/// Degrees between probes.
const APART: usize = 15;

fn hole() -> Hole {
    let shale = Bedded {
        young_moduli: [40e9, 20e9],
        poisson_ratios: [0.25, 0.2],
        shear_modulus: 8e9,
    };
    Hole::of(shale, 30_f64.to_radians(), [-7.5e6, -5e6])
}

fn degrees() -> impl Iterator<Item = usize> {
    (0..360).step_by(APART)
}

fn place(degrees: usize, radius: f64) -> [f64; 2] {
    let (sin, cos) = (degrees as f64).to_radians().sin_cos();
    [radius * cos, radius * sin]
}

fn tunnel(size: f64) -> Outcome {
    let probe = |(number, degrees): (usize, usize)| {
        let [x, y] = place(degrees, RADII[number]);
        format!("[probe.at-{number}-{degrees}]\nat = [{x}, {y}, 0.0]\n")
    };
    let both = degrees().flat_map(|degrees| [0, 1].map(|number| probe((number, degrees))));
    let probes = both.collect::<String>() + "[probe.side]";
    let mesh =
        format!("parameters = {{ h = {size}, half = 240, h_far = 40 }}\norder = 2\ndimension = 2");
    scene::run_edited("bedded-tunnel", &mesh, &[("[probe.side]", &probes)])
}

fn displacement(outcome: &Outcome, degrees: usize) -> [f64; 2] {
    let probe = format!("at-0-{degrees}");
    ["displacement_x", "displacement_y"].map(|column| outcome.probed(&probe, column))
}

fn stress(outcome: &Outcome, degrees: usize) -> [f64; 3] {
    let probe = format!("at-1-{degrees}");
    ["stress_xx", "stress_yy", "stress_xy"].map(|column| outcome.probed(&probe, column))
}

/// Largest differences over all probes, as a share of the largest value.
fn error<const COUNT: usize>(pairs: impl Iterator<Item = ([f64; COUNT], [f64; COUNT])>) -> f64 {
    let length = |values: [f64; COUNT]| values.iter().map(|x| x * x).sum::<f64>().sqrt();
    let (mut most, mut size) = (Vec::new(), Vec::new());
    for (found, wanted) in pairs {
        most.push(length(std::array::from_fn(|part| {
            found[part] - wanted[part]
        })));
        size.push(length(wanted));
    }
    largest(most) / largest(size)
}

/// A displacement outwards and along the wall.
fn polar([x, y]: [f64; 2], degrees: f64) -> [f64; 2] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    [x * cos + y * sin, y * cos - x * sin]
}

fn chart(finest: &Outcome) -> Chart {
    let hole = hole();
    let series = ["outwards", "along the wall"].into_iter().enumerate();
    let series = series.flat_map(|(axis, name)| {
        let exact = (0..=360).map(|at| {
            let own = polar(hole.displacement(place(at, RADII[0])), at as f64);
            (at as f64, 1e3 * own[axis])
        });
        let found = degrees().map(|at| {
            let own = polar(displacement(finest, at), at as f64);
            (at as f64, 1e3 * own[axis])
        });
        [
            Series::line(format!("{name}, closed form"), exact.collect()),
            Series::scatter(format!("{name}, Kluft"), found.collect()),
        ]
    });
    Chart {
        series: series.collect(),
        ..Chart::new(
            "Displacement around the tunnel in bedded rock",
            Axis::linear("angle from x, degrees"),
            Axis::linear("displacement, mm"),
        )
    }
}

const SHOWN: Shown = Shown {
    file: "bedded-tunnel",
    title: "A tunnel in bedded rock: error over the size of cells",
    size: "size of cells at the wall (m)",
    rate: None,
};

fn run(effort: Effort) -> Finding {
    let sizes: &[f64] = match effort {
        Effort::Quick => &[0.24, 0.12],
        Effort::Full => &[0.24, 0.12, 0.06, 0.03],
    };
    let hole = hole();
    let runs: Vec<(f64, Outcome)> = sizes.iter().map(|&size| (size, tunnel(size))).collect();
    let moved = runs.iter().map(|(size, outcome)| {
        let pair = |at| {
            (
                displacement(outcome, at),
                hole.displacement(place(at, RADII[0])),
            )
        };
        (*size, error(degrees().map(pair)))
    });
    let stressed = runs.iter().map(|(size, outcome)| {
        let pair = |at| (stress(outcome, at), hole.stress(place(at, RADII[1])));
        (*size, error(degrees().map(pair)))
    });
    let refinements = [
        Refinement::of("displacement", moved.collect::<Vec<_>>()),
        Refinement::of("stress of cells", stressed.collect::<Vec<_>>()),
    ];
    let [moved, stressed] = [0, 1].map(|number: usize| percent(refinements[number].finest()));
    let finest = runs.last().map(|(_, outcome)| outcome);
    let unknowns = finest.map_or(0, Outcome::unknowns);
    let reached = format!("displacement {moved}, stress {stressed}");
    let page = Finding::new([reached, unknowns.to_string()])
        .text(PROBLEM)
        .closed_form(CLOSED_FORM, PAGE.subject)
        .charts(finest.map(|outcome| ("bedded-tunnel-wall", chart(outcome))));
    SHOWN.on(page, &refinements).shows(format!(
        "Displacements around the tunnel are within {moved} of the closed form on the finest mesh. \
         They stop to fall where the plate, which ends at 240 radii, differs from one without end. \
         Stresses are means of the cell that holds a probe, so they scatter with where it lies in \
         its cell: they are within {stressed}."
    ))
}
