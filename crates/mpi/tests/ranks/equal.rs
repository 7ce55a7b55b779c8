//! Scenes on several ranks give what the serial run gives.

use std::path::Path;

use kluft_run::{Outcome, StepResult};

use kluft_solver::LinearMethod;

use crate::harness::{geometry, serial, serial_by, solved};
use crate::pieces::{Cells, field, field_of, field_of_one};

/// Largest difference against the largest value; what the iterations leave is smaller.
pub const EQUAL: f64 = 1e-9;
/// Factor within which two differences have the same size.
const SAME_SIZE: f64 = 4.0;
/// Fields that are compared, of rock and of fractures.
const ROCK: [&str; 2] = ["displacement", "stress"];
const FRACTURES: [&str; 4] = ["aperture", "jump", "slip", "traction"];

/// Runs a scene on some ranks and compares all fields of all steps with the serial run, which is
/// made if there is none; the largest difference.
pub fn compared(scene: &Path, ranks: usize, reference: &mut Option<Outcome>) -> f64 {
    let folder = tempfile::tempdir().expect("a folder");
    solved(ranks, scene, folder.path(), &[]);
    let reference = reference.get_or_insert_with(|| serial(scene, folder.path()));
    let mut largest = 0.0_f64;
    for (index, step) in reference.steps.iter().enumerate() {
        let end = if ranks > 1 { "pvtu" } else { "vtu" };
        let file = |kind: &str| folder.path().join(format!("{kind}_{:04}.{end}", index + 1));
        for name in ROCK {
            largest = largest.max(difference(&file("rock"), step, name));
        }
        if !step.fracture_grid.shapes.is_empty() {
            for name in FRACTURES {
                largest = largest.max(difference(&file("fractures"), step, name));
            }
        }
    }
    check_newton(&folder.path().join("summary.json"), ranks, reference);
    largest
}

/// Difference of one field, against its largest value.
fn difference(file: &Path, step: &StepResult, name: &str) -> f64 {
    let found = match file.extension().is_some_and(|end| end == "pvtu") {
        true => field(file, name),
        false => field_of_one(file, name),
    };
    share(&found, step, name)
}

/// Difference from a field of a step, against its largest value there. Apertures and jumps of
/// scenes that have next to none of them count against the largest displacement, tractions against
/// the largest stress.
fn share(found: &Cells, step: &StepResult, name: &str) -> f64 {
    let grid = match ROCK.contains(&name) {
        true => &step.rock,
        false => &step.fracture_grid,
    };
    let expected = field_of(grid, name);
    assert_eq!(found.len(), expected.len(), "cells with {name}");
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let size = |cells: &Cells| largest(&mut cells.values().flatten().map(|value| value.abs()));
    let scale = match name {
        "aperture" | "jump" | "slip" => size(&expected).max(size(&field_of(&step.rock, ROCK[0]))),
        "traction" => size(&expected).max(size(&field_of(&step.rock, ROCK[1]))),
        _ => size(&expected),
    };
    let mut differences = expected.iter().flat_map(|(cell, values)| {
        let other = found.get(cell).expect("the same cells");
        values.iter().zip(other).map(|(a, b)| (a - b).abs())
    });
    largest(&mut differences) / scale.max(f64::MIN_POSITIVE)
}

/// Largest difference between two serial runs.
fn between(one: &Outcome, other: &Outcome) -> f64 {
    let steps = one.steps.iter().zip(&other.steps);
    let of_step = |(one, other): (&StepResult, &StepResult)| {
        let rock = ROCK.map(|name| share(&field_of(&other.rock, name), one, name));
        let fractures =
            FRACTURES.map(|name| share(&field_of(&other.fracture_grid, name), one, name));
        rock.into_iter().chain(fractures).fold(0.0, f64::max)
    };
    steps.map(of_step).fold(0.0, f64::max)
}

/// Newton takes as many iterations, one more or fewer in a substep.
fn check_newton(summary: &Path, ranks: usize, reference: &Outcome) {
    let text = std::fs::read_to_string(summary).expect("a summary");
    let summary: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(summary["ranks"]["count"].as_u64(), Some(ranks as u64));
    let steps = summary["steps"].as_array().expect("steps");
    assert_eq!(steps.len(), reference.summary.steps.len());
    for (step, expected) in steps.iter().zip(&reference.summary.steps) {
        let expected = expected.measures.as_ref().expect("measures");
        let found = step["newton_iterations"].as_u64().expect("a number");
        let allowed = expected.substeps.len().max(1);
        assert!(
            found.abs_diff(expected.newton_iterations as u64) <= allowed as u64,
            "{found} Newton iterations instead of {}",
            expected.newton_iterations
        );
    }
}

/// A scene on one to four ranks.
fn is_equal(name: &str) {
    let scene = geometry(name);
    let mut reference = None;
    for ranks in 1..=4 {
        let difference = compared(&scene, ranks, &mut reference);
        assert!(
            difference < EQUAL,
            "{name} on {ranks} ranks: {difference:e}"
        );
    }
}

/// A scene whose walls slide or whose joint fills, where the end of the iterations leaves more
/// than in others. The direct solver, which leaves nothing of a linear system, is compared with
/// ranks and with the serial iterative solver: what both leave has the same cause, so the same
/// size.
fn is_as_equal_as_solvers(name: &str) {
    let scene = geometry(name);
    let folder = tempfile::tempdir().expect("a folder");
    let mut reference = None;
    let [direct, iterative] = [LinearMethod::Direct, LinearMethod::Iterative]
        .map(|method| serial_by(&scene, folder.path(), Some(method)));
    let left = between(&direct, &iterative);
    for ranks in 1..=4 {
        let difference = compared(&scene, ranks, &mut reference);
        assert!(left < 1e-5, "{name}: solvers differ by {left:e}");
        assert!(
            difference < EQUAL.max(SAME_SIZE * left),
            "{name} on {ranks} ranks: {difference:e}, solvers {left:e}"
        );
    }
}

macro_rules! as_equal_as_solvers {
    ($($test:ident: $name:literal,)*) => {
        $(#[test]
        fn $test() {
            is_as_equal_as_solvers($name);
        })*
    };
}

as_equal_as_solvers! {
    filling_joint: "filling-joint",
    inclined_crack: "inclined-crack",
    inclined_penny: "inclined-penny",
    pressurised_fault: "pressurised-fault",
}

macro_rules! scenes {
    ($($test:ident: $name:literal,)*) => {
        $(#[test]
        fn $test() {
            is_equal($name);
        })*
    };
}

scenes! {
    closing_blocks: "closing-blocks",
    collinear_cracks: "collinear-cracks",
    curved_fault: "curved-fault",
    hexahedra: "hexahedra",
    inclined_joint: "inclined-joint",
    line_crack: "line-crack",
    network_20: "network-20",
    penny: "penny",
    plates: "plates",
    pressed_joint: "pressed-joint",
    scanned_fault: "scanned-fault",
    scanned_joint: "scanned-joint",
    small_cube: "small-cube",
    sphere: "sphere",
    t_crack: "t-crack",
    t_junction: "t-junction",
    three_planes: "three-planes",
    water_by_depth: "water-by-depth",
    x_junction: "x-junction",
    y_junction: "y-junction",
}
