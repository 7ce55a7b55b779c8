//! Two scenes whose walls touch: an inclined joint in uniform stress, and a crack that bending half
//! opens.

use glam::DVec3;
use kluft_mesh::structured::{Patch, cells_of};
use kluft_mesh::{Draft, Mesh, Shape, SurfaceRole};
use kluft_solver::{Problem, Support};
use lie_core::{Closure, ClosureKind, FractureLaw};

use crate::scenes::{self, ROCK};

/// A scene that takes any closure.
pub struct Pressed {
    /// All but the law.
    pub problem: Problem,
    /// `E/h` beside the fracture (Pa/m).
    pub scale: f64,
    /// Shear stiffness of the fracture (Pa/m).
    shear: f64,
}

impl Pressed {
    /// The scene with a closure.
    pub fn with(&self, closure: Closure) -> Problem {
        let mut problem = self.problem.clone();
        for fracture in &mut problem.fractures {
            fracture.law = FractureLaw::elastic(closure, self.shear);
        }
        problem
    }
}

/// Dip of the inclined joint (degrees).
const DIP: f64 = 50.0;
/// Pressure on top of the inclined joint (Pa).
pub const PRESSURE: f64 = 10e6;

/// Normal traction of the inclined joint (Pa): the stress is uniaxial whatever the joint is.
pub fn inclined_traction() -> f64 {
    -PRESSURE * DIP.to_radians().cos().powi(2)
}

/// Slip of the inclined joint (m) in the same stress.
pub fn inclined_slip(scene: &Pressed) -> f64 {
    let (sine, cosine) = DIP.to_radians().sin_cos();
    PRESSURE * sine * cosine / scene.shear
}

/// A column with a joint that dips 50 degrees, under 10 MPa on top, free to all sides: walls may
/// slip.
pub fn inclined() -> Pressed {
    let h = 0.3;
    let draft = scenes::geometry("inclined-joint", &[("h", h), ("dip", DIP)]);
    let mut problem = scenes::problem(scenes::build(draft), scenes::joint(ClosureKind::Linear));
    for face in ["front", "bottom"] {
        scenes::support(&mut problem, face, Support::Symmetry);
    }
    scenes::fix(&mut problem, DVec3::ZERO, [Some(0.0), None, None]);
    scenes::load(&mut problem, "top", DVec3::new(0.0, 0.0, -PRESSURE));
    Pressed {
        problem,
        scale: ROCK.young_modulus / h,
        shear: 20e9,
    }
}

/// Half the side of the plate (m); half the length of the crack is 1 m.
const HALF: f64 = 4.0;
/// Bending: the stress 1 m from the middle (Pa), and the share of it that presses everywhere.
const BENDING: f64 = 10e6;
const PRESSING: f64 = 0.2;
/// Cells along half of the crack on the coarsest mesh, and how they grow beyond it.
const CELLS: usize = 8;
const GROWTH: f64 = 1.35;

/// Normal stress (Pa) that the loads would bring about in a plate without the crack.
fn remote(x: f64) -> f64 {
    BENDING * (x - PRESSING)
}

/// Lines of the grid from `start` to the edge of the plate, each interval `parts` times divided.
fn outwards(start: f64, parts: usize) -> Vec<f64> {
    let first = 1.0 / CELLS as f64;
    let mut lines = vec![start];
    let mut size = first;
    while lines[lines.len() - 1] < HALF {
        lines.push(lines[lines.len() - 1] + size);
        size *= GROWTH;
    }
    let stretch = (HALF - start) / (lines[lines.len() - 1] - start);
    let coarse: Vec<f64> = lines
        .iter()
        .map(|x| start + stretch * (x - start))
        .collect();
    divided(&coarse, parts)
}

fn divided(lines: &[f64], parts: usize) -> Vec<f64> {
    let between = |pair: &[f64]| {
        let (a, b) = (pair[0], pair[1]);
        let part = move |k: usize| a + (b - a) * k as f64 / parts as f64;
        (0..parts).map(part).collect::<Vec<f64>>()
    };
    let mut all: Vec<f64> = lines.windows(2).flat_map(between).collect();
    all.push(lines[lines.len() - 1]);
    all
}

/// Lines from `-HALF` to `HALF`, from those of the right half.
fn mirrored(right: &[f64]) -> Vec<f64> {
    let left = right.iter().rev().filter(|x| **x > 0.0).map(|x| -x);
    left.chain(right.iter().copied()).collect()
}

fn lines_along(parts: usize) -> Vec<f64> {
    let mut right = divided(&[0.0, 1.0], CELLS * parts);
    right.extend(outwards(1.0, parts).iter().skip(1));
    mirrored(&right)
}

/// Where a coordinate of the grid lies (m): middles of intervals stay middles.
fn place(lines: &[f64], at: f64) -> f64 {
    let low = (at.floor() as usize).min(lines.len() - 2);
    lines[low] + (lines[low + 1] - lines[low]) * (at - low as f64)
}

/// The plate: a slice with one layer of cells, its upper and lower side in strips of constant
/// traction.
fn plate(shape: Shape, parts: usize) -> (Draft, Vec<f64>) {
    let (along, up) = (lines_along(parts), mirrored(&outwards(0.0, parts)));
    let (columns, rows) = (along.len() - 1, up.len() - 1);
    let index = |lines: &[f64], at: f64| {
        let found = lines.iter().position(|x| (x - at).abs() < 1e-9);
        found.expect("a line of the grid") as f64
    };
    let (first, last, middle) = (index(&along, -1.0), index(&along, 1.0), index(&up, 0.0));
    type On = Box<dyn Fn([f64; 3]) -> bool>;
    let mut patches: Vec<(String, On)> = vec![
        ("front".into(), Box::new(|x| x[1] == 0.0)),
        ("back".into(), Box::new(|x| x[1] == 1.0)),
        (
            "crack".into(),
            Box::new(move |x| x[2] == middle && x[0] >= first && x[0] <= last),
        ),
    ];
    let strips = columns / parts;
    for strip in 0..strips {
        let (low, high) = ((strip * parts) as f64, ((strip + 1) * parts) as f64);
        for (side, level) in [("bottom", 0.0), ("top", rows as f64)] {
            let on = move |x: [f64; 3]| x[2] == level && x[0] >= low && x[0] <= high;
            patches.push((format!("{side} {strip}"), Box::new(on)));
        }
    }
    let named: Vec<Patch<'_>> = patches
        .iter()
        .map(|(name, contains)| Patch { name, contains })
        .collect();
    let size = [columns as f64, 1.0, rows as f64];
    let mut draft = cells_of(shape, [columns, 1, rows], size, &named);
    for x in &mut draft.nodes {
        *x = [place(&along, x[0]), 0.25 * x[1], place(&up, x[2])];
    }
    let coarse = along.iter().step_by(parts).copied().collect();
    (draft, coarse)
}

/// A crack 2 m long in plane strain in a plate of 8 m, bent in its plane and pressed, so that it
/// opens on one side only. Its cells are `1 / (8 parts)` m; meshes of more parts contain those of
/// fewer that divide them.
pub fn bent_crack(shape: Shape, parts: usize) -> Pressed {
    let (draft, strips) = plate(shape, parts);
    let role = |name: &str| match name {
        "crack" => SurfaceRole::Fracture,
        _ => SurfaceRole::Boundary,
    };
    let roles: Vec<_> = draft.groups.iter().map(|group| role(&group.name)).collect();
    let mesh = Mesh::build(draft, &roles).unwrap_or_else(|defects| panic!("{defects:?}"));
    let law = FractureLaw::elastic(Closure::contact(0.0), 0.0);
    let fracture = kluft_solver::Fracture {
        law,
        fluid_pressure: 0.0,
    };
    let mut problem = scenes::problem(mesh, fracture);
    for side in ["front", "back"] {
        scenes::support(&mut problem, side, Support::Symmetry);
    }
    for (strip, ends) in strips.windows(2).enumerate() {
        let pull = DVec3::new(0.0, 0.0, remote(0.5 * (ends[0] + ends[1])));
        scenes::load(&mut problem, &format!("top {strip}"), pull);
        scenes::load(&mut problem, &format!("bottom {strip}"), -pull);
    }
    let corner = |x: f64| DVec3::new(x, 0.0, -HALF);
    scenes::fix(&mut problem, corner(-HALF), [Some(0.0), None, Some(0.0)]);
    scenes::fix(&mut problem, corner(HALF), [None, None, Some(0.0)]);
    Pressed {
        problem,
        scale: ROCK.young_modulus * (CELLS * parts) as f64,
        shear: 0.0,
    }
}

/// Normal traction (Pa) between the walls of the crack in an unbounded plate: it is open where it
/// has the length `2 l` at which `K_I` vanishes at its closed end, `l = (2/3)(1 - q)` for the share
/// `q` that presses, and with the distance `t` from the middle of that
///
/// ```text
/// sigma = -s (t + l/2) sqrt((t - l) / (t + l)),   t > l
/// ```
pub fn crack_traction(x: f64) -> f64 {
    let l = 2.0 / 3.0 * (1.0 - PRESSING);
    let t = 1.0 - l - x;
    if t <= l {
        return 0.0;
    }
    -BENDING * (t + 0.5 * l) * ((t - l) / (t + l)).sqrt()
}
