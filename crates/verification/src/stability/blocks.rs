//! Blocks that part, meet and slide: scenes that several studies share.

use glam::DVec3;
use kluft_mesh::structured::{Patch, tetrahedra};
use kluft_solver::{Fracture, Problem, Support};
use lie_core::FractureLaw;

use crate::scenes;

/// Whether a place is on a surface.
type On = dyn Fn([f64; 3]) -> bool;

/// A fracture without fluid.
pub fn fracture(law: FractureLaw) -> Fracture {
    Fracture {
        law,
        fluid_pressure: 0.0,
    }
}

/// Prescribed displacement along z (m).
pub fn lifted(z: f64) -> Support {
    Support::Displacement([None, None, Some(z)])
}

/// Blocks of 1 m on top of each other, `h` = 1/4 m; rollers on the left and in front, the bottom
/// held along z. Nothing is said of the top.
pub fn stack(blocks: usize, fracture: Fracture) -> Problem {
    let between = |x: [f64; 3]| x[2] > 0.0 && x[2] < blocks as f64 && x[2].fract() == 0.0;
    let patches = [Patch {
        name: "joints",
        contains: &between,
    }];
    let draft = scenes::box_draft([2, 2, 4 * blocks], [1.0, 1.0, blocks as f64], &patches);
    let mut problem = scenes::problem(scenes::build(draft), fracture);
    scenes::support(&mut problem, "bottom", lifted(0.0));
    for side in ["left", "front"] {
        scenes::support(&mut problem, side, Support::Symmetry);
    }
    problem
}

/// A block on a block, pressed on one half of its top: the joint between them stays closed on the
/// near three quarters and opens on the rest. `h` = 1/8 m.
pub fn tilting(fracture: Fracture, pressure: f64) -> Problem {
    let patches: [(&str, &On); 4] = [
        ("joint", &|x| x[2] == 1.0),
        ("bottom", &|x| x[2] == 0.0),
        ("front", &|x| x[1] == 0.0),
        ("top", &|x| x[2] == 2.0 && x[0] <= 0.5),
    ];
    let patches = patches.map(|(name, contains)| Patch { name, contains });
    let draft = tetrahedra([8, 2, 16], [1.0, 0.25, 2.0], &patches);
    let mut problem = scenes::problem(scenes::build(draft), fracture);
    scenes::support(&mut problem, "bottom", lifted(0.0));
    scenes::support(&mut problem, "front", Support::Symmetry);
    scenes::load(&mut problem, "top", DVec3::new(0.0, 0.0, -pressure));
    // Sliding along x, of both blocks.
    scenes::fix(
        &mut problem,
        DVec3::new(0.5, 0.0, 1.0),
        [Some(0.0), None, None],
    );
    problem
}

/// A wedge between two blocks, its flanks at `angle` (degrees) from upright, pressed on its top.
/// The blocks are held at their outer sides and below. 1/4 m.
pub fn wedge(fracture: Fracture, angle: f64, pressure: f64) -> Problem {
    let patches: [(&str, &On); 7] = [
        ("left flank", &|x| x[0] == 1.0),
        ("right flank", &|x| x[0] == 2.0),
        ("left", &|x| x[0] == 0.0),
        ("right", &|x| x[0] == 3.0),
        ("front", &|x| x[1] == 0.0),
        ("bottom", &|x| x[2] == 0.0 && (x[0] <= 1.0 || x[0] >= 2.0)),
        ("top", &|x| x[2] == 1.0 && (1.0..=2.0).contains(&x[0])),
    ];
    let patches = patches.map(|(name, contains)| Patch { name, contains });
    let mut draft = tetrahedra([12, 2, 4], [3.0, 0.5, 1.0], &patches);
    let slope = angle.to_radians().tan();
    for x in &mut draft.nodes {
        // The flanks lean outwards; the outer sides stay upright.
        let lean = (x[0] - 1.5).clamp(-0.5, 0.5) * 2.0 * (1.5 - (x[0] - 1.5).abs()).min(1.0);
        x[0] += slope * lean * (x[2] - 0.5);
    }
    let mut problem = scenes::problem(scenes::build(draft), fracture);
    for side in ["left", "right", "front"] {
        scenes::support(&mut problem, side, Support::Symmetry);
    }
    scenes::support(&mut problem, "bottom", lifted(0.0));
    scenes::load(&mut problem, "top", DVec3::new(0.0, 0.0, -pressure));
    problem
}
