//! Steady flow to the middle of a disc: a hole cut out of it, and a borehole at a node.

use std::f64::consts::PI;

use glam::DVec3;
use kluft_mesh::structured::Patch;
use kluft_mesh::{Mesh, Shape};
use kluft_solver::FlowDrive;

use crate::report::{Effort, Finding, Study, largest, percent};
use crate::scenes::flow::{VISCOSITY, apertures, block, on_side, solved, water, well};
use crate::scenes::soft_slabs::{SECTOR, sector};

use super::refinement::{Refinement, Shown, largest_left, lowest_order};

pub const PAGE: Study = Study {
    name: "radial-flow",
    title: "Radial flow",
    subject: "the cubic law integrated by hand",
    run,
};

const CLOSED_FORM: &str = "
A disc of radius R = 10 m, aperture b = 1e-4 m, mu = 1e-3 Pa s, between a hole of radius r_w and its rim:

    hole       r_w = 0.1 m, dp = 1e6 Pa     Q = pi b^3 dp/(6 mu ln(R/r_w))            1.136980e-4 m3/s
                                            p = dp ln(R/r)/ln(R/r_w)
    borehole   Q = 1e-6 m3/s                p = 6 mu Q ln(R/r)/(pi b^3)               4397.614 Pa at 1 m, 1323.814 Pa at 5 m
               r_w = 1e-3 m                 at its wall                               17590.46 Pa";

const RADII: [f64; 2] = [0.1, 10.0];
const APERTURE: f64 = 1e-4;
const DROP: f64 = 1e6;
const RATE: f64 = 1e-6;
const BOREHOLE: f64 = 1e-3;

fn transmissivity() -> f64 {
    APERTURE.powi(3) / (12.0 * VISCOSITY)
}

/// Errors of the rate and of the pressures between hole and rim, and the number of pressures.
fn hole(shape: Shape, n: usize) -> ([f64; 2], usize) {
    let radius = |share: f64| RADII[0] + (RADII[1] - RADII[0]) * share.powi(4);
    let mesh = sector(shape, n, radius);
    let ends = vec![
        on_side(&mesh, "side left", DROP),
        on_side(&mesh, "side right", 0.0),
    ];
    let flow = water(&mesh, ends);
    let solved = solved(&mesh, &flow, &apertures(&mesh, |_, _| APERTURE));
    let whole = (RADII[1] / RADII[0]).ln();
    let rate = SECTOR * transmissivity() * DROP / whole;
    let pressure = |x: DVec3| DROP * (RADII[1] / x.truncate().length()).ln() / whole;
    let errors = [
        (solved.state.conditions[0].rate / rate - 1.0).abs(),
        solved.pressure_error(&mesh, pressure) / DROP,
    ];
    (errors, solved.system.unknown_count())
}

/// A quarter of a disc: squares in the middle, arcs at the rim.
fn quarter(n: usize) -> Mesh {
    let surfaces = [
        Patch::new("joint", &|x| x[2] == 0.5),
        Patch::new("side rim", &|x| x[0] == 1.0 || x[1] == 1.0),
    ];
    let bend = |[x, y, z]: [f64; 3]| {
        let outer = f64::max(x, y);
        let round = if outer > 0.0 { outer / x.hypot(y) } else { 1.0 };
        let scale = RADII[1] * (1.0 + outer * (round - 1.0));
        [scale * x, scale * y, z]
    };
    block(Shape::Hex8, ([n, n, 2], [1.0; 3]), &surfaces, bend)
}

/// Errors of the pressure at the wall of a borehole, at its node, and from 1 m on, as a share of
/// that at the wall.
fn borehole(n: usize) -> [f64; 3] {
    let mesh = quarter(n);
    let drive = FlowDrive::Rate(0.25 * RATE);
    let conditions = vec![
        on_side(&mesh, "side rim", 0.0),
        well(&mesh, DVec3::new(0.0, 0.0, 0.5), BOREHOLE, drive),
    ];
    let flow = water(&mesh, conditions);
    let solved = solved(&mesh, &flow, &apertures(&mesh, |_, _| APERTURE));
    let scale = RATE / (2.0 * PI * transmissivity());
    let wall = scale * (RADII[1] / BOREHOLE).ln();
    let far = solved.system.nodes().iter().zip(&solved.state.pressures);
    let far = far.filter_map(|(&node, found)| {
        let r = mesh.nodes[node as usize].truncate().length();
        (r >= 1.0).then(|| (found - scale * (RADII[1] / r).ln()).abs() / wall)
    });
    let node = largest(solved.state.pressures.iter().copied());
    [
        (solved.state.conditions[1].pressure / wall - 1.0).abs(),
        (node / wall - 1.0).abs(),
        largest(far),
    ]
}

const PROBLEM: &str = "A thin sector of the disc with a hole, and a quarter of the disc with a \
    borehole at the corner, whose node has no hole in it. The rock is rigid.";

const HOLE: Shown = Shown {
    file: "radial-flow",
    title: "Flow to a hole: errors over the size of cells",
    size: "1 / cells along",
    rate: Some(2.0),
};

const NODE: Shown = Shown {
    file: "radial-flow-borehole",
    title: "Flow from a borehole: errors of pressures",
    size: "1 / facets along the side",
    rate: None,
};

/// Rates and pressures of the hole, and the largest number of pressures.
fn holes(shapes: &[Shape], sizes: &[usize]) -> (Vec<Refinement>, usize) {
    let mut all = Vec::new();
    let mut most = 0;
    for &shape in shapes {
        let found = sizes.iter().map(|&n| (1.0 / n as f64, hole(shape, n)));
        let found: Vec<_> = found.collect();
        for (which, name) in ["rate", "pressures"].into_iter().enumerate() {
            let errors = found
                .iter()
                .map(|(size, (errors, _))| (*size, errors[which]));
            all.push(Refinement::of(format!("{name}, {shape:?}"), errors));
        }
        most = found
            .iter()
            .map(|(_, (_, count))| *count)
            .fold(most, usize::max);
    }
    (all, most)
}

fn boreholes(sizes: &[usize]) -> [Refinement; 3] {
    let found = sizes.iter().map(|&n| (1.0 / n as f64, borehole(n)));
    let found: Vec<_> = found.collect();
    let names = ["at the wall", "at the node", "from 1 m on"];
    [0, 1, 2].map(|which| {
        let errors = found.iter().map(|(size, errors)| (*size, errors[which]));
        Refinement::of(names[which], errors)
    })
}

fn run(effort: Effort) -> Finding {
    let (shapes, sizes): (&[Shape], &[usize]) = match effort {
        Effort::Quick => (&[Shape::Tet4], &[16, 32]),
        Effort::Full => (
            &[Shape::Tet4, Shape::Hex8, Shape::Prism6],
            &[8, 16, 32, 64, 128],
        ),
    };
    let (holes, most) = holes(shapes, sizes);
    let wells = boreholes(sizes);
    let most = most.max((sizes[sizes.len() - 1] + 1).pow(2));
    let cut = largest_left(&holes);
    let page = Finding::new([
        format!(
            "hole {}; wall of a borehole {}",
            percent(cut),
            percent(wells[0].finest())
        ),
        most.to_string(),
    ])
    .text(PROBLEM)
    .closed_form(CLOSED_FORM, PAGE.subject)
    .text("A hole cut out of the disc, cells growing away from it:");
    let page = HOLE.on(page, &holes).text("A borehole at a node:");
    NODE.on(page, &wells).shows(format!(
        "With a hole that is meshed rate and pressures are of order {:.2} at least, and {} off at \
         the finest mesh. A borehole at a node needs its radius: the pressure of its node changes \
         with the mesh and is still {} off at the finest. That at the wall, by the radius that belongs \
         to a node, is {} off. From 1 m on pressures are {} off.",
        lowest_order(&holes),
        percent(cut),
        percent(wells[1].finest()),
        percent(wells[0].finest()),
        percent(wells[2].finest()),
    ))
}
