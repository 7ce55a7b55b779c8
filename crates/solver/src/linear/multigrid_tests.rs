//! What the multigrid promises, on structured boxes of tetrahedra.

use glam::{DMat3, DVec3};
use kluft_algebra::multigrid::{Multigrid, rigid_modes};
use kluft_algebra::{
    BlockMatrix, BlockPattern, BlockRows, ConjugateGradientOutcome, ConjugateGradientSettings,
    conjugate_gradients, dot,
};
use kluft_mesh::structured::{Patch, cells_of};
use kluft_mesh::{Mesh, Shape, SurfaceRole};
use lie_core::Rock;

use crate::assembly::rock::rock_stiffness;
use crate::problem::{Condition, FixedPoint, Problem, Support};
use crate::space::Space;
use crate::space::pattern::Pattern;
use crate::space::sector_nodes::SectorNodes;
use crate::space::supports::Supports;
use crate::system::{Discretisation, System};

/// A box and what is special about it.
struct Box {
    shape: Shape,
    counts: [usize; 3],
    sides: [f64; 3],
    poisson_ratio: f64,
    /// Stiffness of every second cell relative to the others.
    contrast: f64,
    /// Where a coordinate in [0, 1] moves to.
    stretch: fn(f64) -> f64,
    support: Support,
}

const CLAMPED: Box = Box {
    shape: Shape::Tet4,
    counts: [8; 3],
    sides: [1.0; 3],
    poisson_ratio: 0.3,
    contrast: 1.0,
    stretch: |x| x,
    support: Support::Displacement([Some(0.0); 3]),
};

struct Case {
    pattern: BlockPattern,
    matrix: BlockMatrix,
    modes: Vec<[DVec3; 6]>,
}

impl Box {
    fn problem(&self) -> Problem {
        let names = ["x", "y", "z"];
        let on = |axis: usize| move |x: [f64; 3]| x[axis] == 0.0;
        let contains = [on(0), on(1), on(2)];
        let places = std::iter::zip(names, &contains);
        let patches: Vec<Patch<'_>> = places
            .map(|(name, contains)| Patch { name, contains })
            .collect();
        let mut draft = cells_of(self.shape, self.counts, self.sides, &patches);
        for node in &mut draft.nodes {
            *node = node.map(self.stretch);
        }
        let roles = vec![SurfaceRole::Boundary; draft.groups.len()];
        let mesh = Mesh::build(draft, &roles).unwrap();
        let held = match self.support {
            Support::Symmetry => 0..3,
            Support::Displacement(_) => 2..3,
        };
        let rock = |young_modulus: f64| Rock {
            young_modulus,
            poisson_ratio: self.poisson_ratio,
            density: 0.0,
            anisotropy: None,
        };
        Problem {
            rocks: vec![rock(1.0), rock(self.contrast)],
            // Bands of cells: the cells are numbered row by row.
            rock_of_cell: (0..mesh.cells.len() as u32)
                .map(|cell| cell / 50 % 2)
                .collect(),
            conditions: held
                .map(|boundary| Condition {
                    boundary,
                    load: None,
                    support: Some(self.support),
                })
                .collect(),
            ..Problem::of_rock(mesh, rock(1.0))
        }
    }

    fn case(&self) -> Case {
        let problem = self.problem();
        let system = System::assemble(&problem, Discretisation::of(&problem).unwrap());
        let Discretisation {
            pattern, supports, ..
        } = &system.discretisation;
        let mode = |(point, &position): (usize, &DVec3)| {
            let free = supports
                .constraint(point)
                .map_or(DMat3::IDENTITY, |constraint| constraint.free);
            rigid_modes(position, DVec3::splat(0.5), free)
        };
        Case {
            modes: problem.mesh.nodes.iter().enumerate().map(mode).collect(),
            pattern: pattern.blocks.clone(),
            matrix: BlockMatrix {
                blocks: system.rock_rows().blocks.to_vec(),
            },
        }
    }
}

impl Case {
    fn rows(&self) -> BlockRows<'_> {
        self.matrix.rows(&self.pattern)
    }

    /// Solves for a pseudo-random right-hand side; solution and iterations.
    fn solve(&self) -> (Vec<DVec3>, usize) {
        let multigrid = Multigrid::new(self.rows(), &self.modes).unwrap();
        let mut workspace = multigrid.workspace();
        let right = random(self.modes.len(), 1);
        let mut solution = vec![DVec3::ZERO; right.len()];
        let report = conjugate_gradients(
            |vector, product| self.rows().multiply(vector, product),
            |residual, correction| multigrid.apply(residual, correction, &mut workspace),
            &right,
            &mut solution,
            ConjugateGradientSettings {
                tolerance: 1e-8,
                max_iterations: 300,
            },
        );
        assert_eq!(report.outcome, ConjugateGradientOutcome::Converged);
        let mut product = right.clone();
        self.rows().multiply(&solution, &mut product);
        let rest = product
            .iter()
            .zip(&right)
            .map(|(a, b)| (a - b).length_squared());
        let whole = right.iter().map(|b| b.length_squared());
        assert!(rest.sum::<f64>().sqrt() < 1.1e-8 * whole.sum::<f64>().sqrt());
        (solution, report.iterations)
    }
}

fn random(length: usize, seed: u64) -> Vec<DVec3> {
    let mut bits = seed;
    let mut number = || {
        bits = bits
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (bits >> 40) as f64 / (1 << 24) as f64 - 0.5
    };
    (0..length)
        .map(|_| DVec3::new(number(), number(), number()))
        .collect()
}

#[test]
fn levels_shrink_and_cost_less_than_the_matrix() {
    let counts = [16; 3];
    let case = Box { counts, ..CLAMPED }.case();
    let multigrid = Multigrid::new(case.rows(), &case.modes).unwrap();
    let sizes = multigrid.level_sizes();
    assert!(sizes.len() >= 2);
    assert!(
        sizes
            .windows(2)
            .all(|pair| pair[1].nodes * 5 < pair[0].nodes)
    );
    let entries: usize = sizes.iter().map(|size| size.entries).sum();
    assert!(entries < 2 * sizes[0].entries);
    let unknowns = sizes[0].unknowns;
    assert!(multigrid.memory_bytes() < 600 * unknowns);
}

#[test]
fn iterations_hardly_grow_with_the_mesh() {
    let iterations = [8, 16, 24].map(|cubes| {
        let counts = [cubes; 3];
        Box { counts, ..CLAMPED }.case().solve().1
    });
    println!("iterations at 8, 16 and 24 cubes an edge: {iterations:?}");
    assert!(iterations[2] <= 22);
    assert!(iterations[2] as f64 <= 1.3 * iterations[0] as f64);
}

#[test]
fn the_cycle_is_symmetric_and_positive() {
    let counts = [12; 3];
    let case = Box { counts, ..CLAMPED }.case();
    let multigrid = Multigrid::new(case.rows(), &case.modes).unwrap();
    let mut workspace = multigrid.workspace();
    for seed in 1..6 {
        let (x, y) = (
            random(case.modes.len(), seed),
            random(case.modes.len(), seed + 100),
        );
        let (mut mx, mut my) = (x.clone(), y.clone());
        multigrid.apply(&x, &mut mx, &mut workspace);
        multigrid.apply(&y, &mut my, &mut workspace);
        let scale = (dot(&x, &mx) * dot(&y, &my)).sqrt();
        assert!(dot(&x, &mx) > 0.0 && dot(&y, &my) > 0.0);
        // Single precision.
        assert!((dot(&x, &my) - dot(&mx, &y)).abs() < 1e-5 * scale);
    }
}

#[test]
fn hard_boxes_are_solved() {
    let counts = [12; 3];
    let base = Box { counts, ..CLAMPED };
    let cases = [
        ("plain", Box { ..base }, 25),
        (
            "nearly incompressible",
            Box {
                poisson_ratio: 0.4,
                ..base
            },
            30,
        ),
        (
            "contrast 100:1",
            Box {
                contrast: 100.0,
                ..base
            },
            40,
        ),
        (
            "contrast 10000:1",
            Box {
                contrast: 1e4,
                ..base
            },
            80,
        ),
        (
            "graded 1:30",
            Box {
                stretch: |x| 0.03 * x + 0.97 * x.powi(3),
                ..base
            },
            80,
        ),
        (
            "rollers",
            Box {
                support: Support::Symmetry,
                ..base
            },
            30,
        ),
        (
            "quadratic",
            Box {
                shape: Shape::Tet10,
                counts: [6; 3],
                ..base
            },
            50,
        ),
    ];
    for (name, case, most) in cases {
        let iterations = case.case().solve().1;
        assert!(iterations <= most, "{name}: {iterations} iterations");
    }
}

#[test]
fn flat_cells_take_no_more_iterations() {
    for ratio in [10.0, 30.0, 100.0] {
        let case = Box {
            counts: [12; 3],
            sides: [1.0, 1.0, 1.0 / ratio],
            ..CLAMPED
        };
        let iterations = case.case().solve().1;
        assert!(iterations <= 30, "1:{ratio}: {iterations} iterations");
    }
}

#[test]
fn slender_cells_take_hardly_more_iterations() {
    for shape in [Shape::Tet4, Shape::Hex8, Shape::Prism6] {
        for ratio in [4.0, 10.0] {
            let case = Box {
                shape,
                counts: [12; 3],
                sides: [1.0, 1.0, ratio],
                ..CLAMPED
            };
            let iterations = case.case().solve().1;
            assert!(
                iterations <= 25,
                "{shape:?}, {ratio}:1: {iterations} iterations"
            );
        }
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let counts = [14; 3];
    let case = Box { counts, ..CLAMPED }.case();
    let with = |threads: usize| {
        let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
        builder.build().unwrap().install(|| case.solve().0)
    };
    assert_eq!(with(1), with(2));
    assert_eq!(with(1), with(3));
}

#[test]
fn units_do_not_matter() {
    let case = CLAMPED.case();
    let plain = case.solve().1;
    let mut scaled = case;
    for block in &mut scaled.matrix.blocks {
        *block *= 1e25;
    }
    assert_eq!(plain, scaled.solve().1);
}

/// Copies of a case, not coupled with each other.
fn copies(case: &Case, count: usize) -> Case {
    let mut all = Case {
        pattern: BlockPattern::new(vec![0], Vec::new()),
        matrix: BlockMatrix { blocks: Vec::new() },
        modes: Vec::new(),
    };
    let blocks = |row: usize| case.rows().row(row).map(|(_, block)| block);
    let blocks: Vec<DMat3> = (0..case.modes.len()).flat_map(blocks).collect();
    for copy in 0..count {
        let first = (copy * case.modes.len()) as u32;
        let start = all.pattern.columns.len();
        let offsets = case.pattern.row_offset[1..].iter();
        let columns = case.pattern.columns.iter();
        let pattern = &mut all.pattern;
        pattern
            .row_offset
            .extend(offsets.map(|offset| start + offset));
        pattern.columns.extend(columns.map(|column| first + column));
        all.matrix.blocks.extend(&blocks);
        all.modes.extend(&case.modes);
    }
    all
}

#[test]
fn bodies_apart_converge_as_one_does() {
    let counts = [2; 3];
    let small = Box { counts, ..CLAMPED }.case();
    assert!(copies(&small, 400).solve().1 <= 25);
    let counts = [8; 3];
    let large = Box { counts, ..CLAMPED }.case();
    assert!(copies(&large, 3).solve().1 <= 25);
}

#[test]
fn a_free_body_yields_finite_numbers() {
    let counts = [8; 3];
    let problem = Box { counts, ..CLAMPED }.problem();
    let mut free = Box { counts, ..CLAMPED }.case();
    // The same elements without a support: three nodes held only as much as to be positive.
    let floating = Problem {
        conditions: Vec::new(),
        fixed_points: vec![FixedPoint {
            node: 0,
            displacement: [Some(0.0); 3],
            name: "corner".into(),
        }],
        ..problem
    };
    let points = SectorNodes::of(&floating.mesh);
    let supports = Supports::of(&floating, &points).unwrap();
    let pattern = Pattern::of(&floating.mesh, &points);
    let space = Space {
        problem: &floating,
        points: &points,
        supports: &supports,
        pattern: &pattern,
    };
    let all = vec![true; space.problem.mesh.nodes.len()];
    free.matrix.blocks = rock_stiffness(space, &all, &pattern.blocks).blocks;
    let multigrid = Multigrid::new(free.rows(), &free.modes).unwrap();
    let right = random(free.modes.len(), 3);
    let mut correction = right.clone();
    multigrid.apply(&right, &mut correction, &mut multigrid.workspace());
    assert!(correction.iter().all(|v| v.is_finite()));
}
