//! Scenes on several ranks give what the serial run gives.

use std::ops::RangeInclusive;
use std::path::Path;

use kluft_run::{Outcome, StepMeasures, StepResult};

use kluft_solver::LinearMethod;

use crate::harness::{geometry, serial, serial_by, solved};
use crate::pieces::{Cells, field, field_of, field_of_one};

/// Largest difference against the largest value; what the iterations leave is smaller.
const EQUAL: f64 = 1e-9;
/// Factor within which two differences have the same size: an order of magnitude.
const SAME_SIZE: f64 = 10.0;
/// What solvers may leave.
const LEFT: f64 = 1e-6;
/// Fields that are compared, of rock and of fractures.
const ROCK: [&str; 2] = ["displacement", "stress"];
const FRACTURES: [&str; 4] = ["aperture", "jump", "slip", "traction"];

/// Runs a scene on some ranks and compares all fields of all steps with the serial run, which is
/// made if there is none; the largest difference.
fn compared(scene: &Path, ranks: usize, reference: &mut Option<Outcome>) -> f64 {
    let folder = tempfile::tempdir().expect("a folder");
    solved(ranks, scene, folder.path(), &[]);
    let reference = reference.get_or_insert_with(|| serial(scene, folder.path()));
    let least = least_stress(scene);
    let mut largest = 0.0_f64;
    for (index, step) in reference.steps.iter().enumerate() {
        let end = if ranks > 1 { "pvtu" } else { "vtu" };
        let file = |kind: &str| folder.path().join(format!("{kind}_{:04}.{end}", index + 1));
        for name in ROCK {
            largest = largest.max(difference(&file("rock"), (step, least), name));
        }
        if !step.fracture_grid.shapes.is_empty() {
            for name in FRACTURES {
                largest = largest.max(difference(&file("fractures"), (step, least), name));
            }
        }
    }
    check_newton(&folder.path().join("summary.json"), ranks, reference);
    largest
}

/// Stress (Pa) against which those of a scene count at least: where blocks are moved as a whole and
/// strain nothing, that of such a displacement over a length of 1 m; where walls carry the pressure
/// of a fluid and the rock next to nothing, that pressure.
fn least_stress(scene: &Path) -> f64 {
    let least = [("curved-fault", 25e9 * 1e-2), ("filling-joint", 0.9e6)];
    let named = least.iter().find(|(name, _)| scene == geometry(name));
    named.map_or(0.0, |&(_, stress)| stress)
}

/// Difference of one field, against its largest value.
fn difference(file: &Path, step: (&StepResult, f64), name: &str) -> f64 {
    let found = match file.extension().is_some_and(|end| end == "pvtu") {
        true => field(file, name),
        false => field_of_one(file, name),
    };
    share(&found, step, name)
}

/// Difference from a field of a step, against its largest value there. Apertures and jumps of
/// scenes that have next to none of them count against the largest displacement, tractions against
/// the largest stress, stresses at least against `least` (Pa).
fn share(found: &Cells, (step, least): (&StepResult, f64), name: &str) -> f64 {
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
        "stress" => size(&expected).max(least),
        _ => size(&expected),
    };
    let mut differences = expected.iter().flat_map(|(cell, values)| {
        let other = found.get(cell).expect("the same cells");
        values.iter().zip(other).map(|(a, b)| (a - b).abs())
    });
    largest(&mut differences) / scale.max(f64::MIN_POSITIVE)
}

/// Largest difference between two serial runs of a scene, stresses against at least `least` (Pa).
fn between(one: &Outcome, other: &Outcome, least: f64) -> f64 {
    let steps = one.steps.iter().zip(&other.steps);
    let of_step = |(one, other): (&StepResult, &StepResult)| {
        let rock = ROCK.map(|name| share(&field_of(&other.rock, name), (one, least), name));
        let fractures =
            FRACTURES.map(|name| share(&field_of(&other.fracture_grid, name), (one, least), name));
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

/// A scene on some ranks.
pub fn is_equal(scene: &Path, ranks: RangeInclusive<usize>) {
    let mut reference = None;
    for ranks in ranks {
        let difference = compared(scene, ranks, &mut reference);
        let name = scene.display();
        assert!(
            difference < EQUAL,
            "{name} on {ranks} ranks: {difference:e}"
        );
    }
}

/// A scene whose walls slide or whose joint fills, where the end of the iterations leaves more
/// than in others. The direct solver, which leaves nothing of a linear system, is compared with
/// ranks and with the serial iterative solver: what both leave has the same cause, so the same
/// size. Where the path of the loads is lost, it must be so on ranks too.
pub fn is_as_equal_as_solvers(scene: &Path, ranks: RangeInclusive<usize>) {
    let folder = tempfile::tempdir().expect("a folder");
    let (name, mut reference) = (scene.display(), None);
    let [direct, iterative] = [LinearMethod::Direct, LinearMethod::Iterative]
        .map(|method| serial_by(scene, folder.path(), Some(method)));
    if is_lost(&direct) {
        return ranks.for_each(|ranks| is_lost_on(scene, ranks));
    }
    let left = between(&direct, &iterative, least_stress(scene));
    assert!(left < LEFT, "{name}: solvers differ by {left:e}");
    for ranks in ranks {
        let difference = compared(scene, ranks, &mut reference);
        assert!(
            difference < LEFT.min(EQUAL.max(SAME_SIZE * left)),
            "{name} on {ranks} ranks: {difference:e}, solvers {left:e}"
        );
    }
}

/// Whether a load step says that its path is not resolved.
fn is_lost(outcome: &Outcome) -> bool {
    let mut steps = outcome.summary.steps.iter();
    let is_lost = |step: &StepMeasures| step.unresolved.is_some();
    steps.any(|step| step.measures.as_ref().is_some_and(is_lost))
}

fn is_lost_on(scene: &Path, ranks: usize) {
    let folder = tempfile::tempdir().expect("a folder");
    solved(ranks, scene, folder.path(), &[]);
    let text = std::fs::read_to_string(folder.path().join("summary.json")).expect("a summary");
    let summary: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let mut steps = summary["steps"].as_array().expect("steps").iter();
    assert!(
        steps.any(|step| !step["unresolved"].is_null()),
        "{} on {ranks} ranks is resolved",
        scene.display()
    );
}

macro_rules! as_equal_as_solvers {
    ($($test:ident: $name:literal,)*) => {
        $(#[test]
        fn $test() {
            is_as_equal_as_solvers(&geometry($name), 1..=4);
        })*
    };
}

as_equal_as_solvers! {
    filling_joint: "filling-joint",
    inclined_crack: "inclined-crack",
    inclined_penny: "inclined-penny",
    pressurised_fault: "pressurised-fault",
    t_crack: "t-crack",
}

macro_rules! scenes {
    ($($test:ident: $name:literal,)*) => {
        $(#[test]
        fn $test() {
            is_equal(&geometry($name), 1..=4);
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
    t_junction: "t-junction",
    three_planes: "three-planes",
    water_by_depth: "water-by-depth",
    x_junction: "x-junction",
    y_junction: "y-junction",
}
