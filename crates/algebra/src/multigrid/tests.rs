//! What the hierarchy promises, on a lattice of springs and on nodes that nothing couples.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::aggregation::Reach;
use super::block_jacobi::Factors;
use super::clusters::Clusters;
use super::cycle::{Prolongator, Transfer};
use super::sparse::Sparse;
use super::{aggregation, tentative, *};
use crate::block_matrix::BlockMatrix;
use crate::block_pattern::BlockPattern;
use crate::conjugate_gradients::{
    ConjugateGradientOutcome, ConjugateGradientSettings, conjugate_gradients,
};
use crate::division::Division;
use crate::small::{self, Modes};
use crate::thread_ranks::on_threads;

struct Case {
    pattern: BlockPattern,
    matrix: BlockMatrix,
    modes: Vec<[DVec3; 6]>,
}

impl Case {
    fn rows(&self) -> BlockRows<'_> {
        self.matrix.rows(&self.pattern)
    }

    /// The matrix and the modes in unknowns that scale its diagonal.
    fn scaled(&self) -> (Sparse<3, 3>, Vec<Modes<3>>) {
        let rows = SumRows::of_fixed(self.rows());
        let single = Clusters::single(rows.count());
        let factors = Factors::of(&rows, &single).unwrap();
        let mut scaled = Sparse::default();
        block_jacobi::set_matrix(&mut scaled, &rows, &single, &factors, |_| true);
        (scaled, block_jacobi::modes(&factors, &self.modes))
    }

    /// Solves for forces without a pattern; iterations.
    fn solve(&self) -> usize {
        let multigrid = Multigrid::new(self.rows(), &self.modes).expect("positive definite");
        let mut workspace = multigrid.workspace();
        let number = |at: usize| ((at * at * 7919 + at * 13) % 1009) as f64 / 1009.0 - 0.5;
        let rhs: Vec<DVec3> = (0..self.modes.len())
            .map(|at| DVec3::new(number(3 * at), number(3 * at + 1), number(3 * at + 2)))
            .collect();
        let mut solution = vec![DVec3::ZERO; rhs.len()];
        let report = conjugate_gradients(
            |vector, product| self.rows().multiply(vector, product),
            |residual, correction| multigrid.apply(residual, correction, &mut workspace),
            &rhs,
            &mut solution,
            ConjugateGradientSettings {
                tolerance: 1e-8,
                max_iterations: 300,
            },
        );
        assert_eq!(report.outcome, ConjugateGradientOutcome::Converged);
        report.iterations
    }
}

/// A cube of `edge^3` nodes joined by springs to all nodes around each; the nodes of one face are
/// tied to where they are.
fn lattice(edge: usize) -> Case {
    weighed_lattice(edge, |_| 1.0)
}

/// The same with springs of a stiffness that depends on how many coordinates they span.
fn weighed_lattice(edge: usize, stiffness: fn(usize) -> f64) -> Case {
    let place = |node: usize| [node % edge, node / edge % edge, node / edge / edge];
    let at = |node: usize| DVec3::from_array(place(node).map(|x| x as f64));
    let nodes = edge.pow(3);
    let (mut row_offset, mut columns, mut blocks) = (vec![0], Vec::new(), Vec::new());
    for node in 0..nodes {
        let is_near = |other: &usize| {
            let pairs = std::iter::zip(place(node), place(*other));
            pairs.into_iter().all(|(a, b)| a.abs_diff(b) <= 1)
        };
        let spring = |other: usize| {
            let span = at(other) - at(node);
            let arm = span.normalize_or_zero();
            let stiffness = stiffness(span.abs().element_sum() as usize);
            stiffness * DMat3::from_cols(arm.x * arm, arm.y * arm, arm.z * arm)
        };
        let around: Vec<usize> = (0..nodes).filter(is_near).collect();
        let mut own: DMat3 = around.iter().map(|&other| spring(other)).sum();
        if place(node)[2] == 0 {
            own += DMat3::IDENTITY;
        }
        for &other in &around {
            columns.push(other as u32);
            blocks.push(if other == node { own } else { -spring(other) });
        }
        row_offset.push(columns.len());
    }
    let centre = DVec3::splat(0.5 * edge as f64);
    let modes = (0..nodes).map(|node| rigid_modes(at(node), centre, DMat3::IDENTITY));
    Case {
        modes: modes.collect(),
        pattern: BlockPattern::new(row_offset, columns),
        matrix: BlockMatrix { blocks },
    }
}

/// `count` nodes that nothing couples.
fn loose(count: usize) -> Case {
    Case {
        pattern: BlockPattern::new((0..=count).collect(), (0..count as u32).collect()),
        matrix: BlockMatrix {
            blocks: vec![DMat3::from_diagonal(DVec3::new(1.0, 2.0, 3.0)); count],
        },
        modes: vec![[DVec3::ZERO; 6]; count],
    }
}

#[test]
fn iterations_hardly_grow_with_a_lattice() {
    let [small, large] = [8, 16].map(|edge| lattice(edge).solve());
    assert!(small <= 20 && large <= 24, "{small}, {large}");
}

#[test]
fn rigid_motions_are_prolonged_exactly() {
    let case = lattice(8);
    let (scaled, modes) = case.scaled();
    let strong = aggregation::strong_neighbours(&scaled, &modes);
    let aggregates = aggregation::aggregate(&strong, Reach::Beyond);
    let tentative = tentative::tentative(&aggregates, &modes);
    for (node, &aggregate) in aggregates.of_node.iter().enumerate() {
        if aggregate == aggregation::ALONE {
            continue;
        }
        let triangle = &tentative.modes[aggregate as usize];
        let prolonged = small::product(&small::widen(&tentative.blocks[node]), triangle);
        for (row, expected) in prolonged.iter().zip(&modes[node]) {
            for (entry, expected) in row.iter().zip(expected) {
                // `T` is stored in single precision.
                assert!((entry - expected).abs() < 1e-6);
            }
        }
    }
}

/// Fewer aggregates are what reaching beyond neighbours is for; nodes along edges, diagonals of
/// faces and of cubes have neighbours in common by the face.
#[test]
fn aggregates_that_reach_beyond_neighbours_are_fewer() {
    let (scaled, modes) = lattice(12).scaled();
    let strong = aggregation::strong_neighbours(&scaled, &modes);
    let [near, beyond] =
        [Reach::Neighbours, Reach::Beyond].map(|reach| aggregation::aggregate(&strong, reach));
    assert!(
        3 * beyond.count < 2 * near.count,
        "{} of {}",
        beyond.count,
        near.count
    );
    assert!(
        beyond
            .of_node
            .iter()
            .all(|&at| (at as usize) < beyond.count)
    );
}

/// `(I - omega A) B`, row by row.
fn smoothed_modes(
    scaled: &Sparse<3, 3>,
    modes: &[[[f64; 6]; 3]],
    omega: f64,
) -> Vec<[[f64; 6]; 3]> {
    let row = |row: usize| {
        let mut sum = modes[row];
        small::add(&mut sum, -omega, &modes[row]);
        for (column, block) in scaled.row(row) {
            let image = small::transpose(&small::widen(block));
            small::add(&mut sum, -omega, &small::product(&image, &modes[column]));
        }
        sum
    };
    (0..modes.len()).map(row).collect()
}

/// Neighbours along space diagonals hardly resist: `P R = (I - omega A) B` holds all the same, and
/// fewer aggregates move a node than it has around it.
#[test]
fn weak_neighbours_cost_no_rigid_motion() {
    let case = weighed_lattice(9, |span| [1.0, 1.0, 1.0, 0.02][span]);
    let (scaled, modes) = case.scaled();
    let strong = aggregation::strong_neighbours(&scaled, &modes);
    let aggregates = aggregation::aggregate(&strong, Reach::Beyond);
    let tentative = tentative::tentative(&aggregates, &modes);
    let unsmoothed = prolongation::Unsmoothed {
        aggregates: &aggregates,
        tentative: &tentative,
        modes: &modes,
    };
    let bound = spectrum::largest_eigenvalue(&scaled);
    let prolongator = unsmoothed.smoothed(&scaled, bound, |_| true);
    let expected = smoothed_modes(&scaled, &modes, 4.0 / 3.0 / bound);
    let mut around = 0;
    for (row, expected) in expected.iter().enumerate() {
        let mut sum = [[0.0; 6]; 3];
        for (column, block) in prolongator.row(row) {
            let part = small::product(&small::widen(block), &tentative.modes[column]);
            small::add(&mut sum, 1.0, &part);
        }
        for (entry, expected) in sum.as_flattened().iter().zip(expected.as_flattened()) {
            // `P` is stored in single precision.
            assert!((entry - expected).abs() < 1e-5, "{entry} and {expected}");
        }
        let neighbours = scaled.row(row).map(|(at, _)| at).chain([row]);
        let mut of_nodes: Vec<u32> = neighbours.map(|at| aggregates.of_node[at]).collect();
        of_nodes.sort_unstable();
        of_nodes.dedup();
        around += of_nodes.len();
    }
    let moving = prolongator.blocks.len();
    assert!(moving < around, "{moving} of {around}");
}

#[test]
fn loose_and_held_nodes_are_solved_at_once() {
    for count in [1, 2, 150, 1000] {
        assert!(loose(count).solve() <= 2, "{count} loose nodes");
    }
}

#[test]
fn no_rows_make_no_trouble() {
    let case = loose(0);
    let multigrid = Multigrid::new(case.rows(), &case.modes).unwrap();
    multigrid.apply(&[], &mut [], &mut multigrid.workspace());
}

#[test]
fn a_block_that_is_not_positive_is_named() {
    let mut case = loose(5);
    case.matrix.blocks[3].z_axis.z = -1.0;
    let failure = Multigrid::new(case.rows(), &case.modes).map(|_| ());
    assert_eq!(failure, Err(MultigridFailure::NotPositive(3)));
    case.matrix.blocks[3].z_axis.z = f64::NAN;
    let failure = Multigrid::new(case.rows(), &case.modes).map(|_| ());
    assert_eq!(failure, Err(MultigridFailure::NotPositive(3)));
}

#[test]
fn parts_of_the_rows_make_the_levels_of_the_whole() {
    let case = lattice(12);
    let rows = case.modes.len() as u32;
    let offset: Vec<u32> = (0..=rows).collect();
    let whole = (case.rows(), &Division::whole(rows as usize));
    let (mut coarsening, means) = FirstCoarsening::of(whole, &offset, &case.modes).unwrap();
    coarsening.set_basis(means.into_basis());
    let nothing = crate::Lists::default();
    let interface = InterfaceBlocks {
        pattern: crate::InterfacePattern {
            rows: &[],
            columns: &nothing,
        },
        blocks: &[],
    };
    let levels_of = |cuts: &[u32]| {
        let of_ranks = on_threads(cuts.len() - 1, |communicator| {
            let mut coarsening = coarsening.clone();
            let rank = communicator.rank();
            let own: Vec<u32> = (cuts[rank]..cuts[rank + 1]).collect();
            let rows = coarsening.factorised(case.rows(), interface, &own).unwrap();
            let part = coarsening.part(&rows, |_| {}).next;
            coarsening.levels_below(part, communicator).unwrap()
        });
        of_ranks.into_iter().next_back().unwrap()
    };
    let (mut whole, mut of_three) = (levels_of(&[0, rows]), levels_of(&[0, 300, 301, rows]));
    let multigrid = Multigrid::new(case.rows(), &case.modes).unwrap();
    let sizes: Vec<usize> = multigrid.level_sizes()[1..]
        .iter()
        .map(|size| size.nodes)
        .collect();
    for (level, &nodes) in sizes.iter().enumerate() {
        assert_eq!([whole.nodes(level), of_three.nodes(level)], [nodes; 2]);
        let all: Vec<u32> = (0..nodes as u32).collect();
        let [one, other] = [&mut whole, &mut of_three].map(|levels| levels.take_rows(level, &all));
        for node in 0..nodes {
            for ((column, one), (at, other)) in one.row(node).zip(other.row(node)) {
                assert_eq!(column, at);
                let entries = std::iter::zip(one.as_flattened(), other.as_flattened());
                for (one, other) in entries {
                    // Single precision.
                    assert!((one - other).abs() < 1e-4, "{one} and {other}");
                }
            }
        }
    }
    assert_eq!(whole.count(), sizes.len());
    assert_eq!(whole.coarsest_solve(), CoarsestSolve::Inverse);
}

/// Numbers without a pattern.
fn numbers<const N: usize>(count: usize) -> Vec<[f64; N]> {
    let number = |at: usize| ((at * at * 7919 + at * 13) % 1009) as f64 / 1009.0 - 0.5;
    let entry = |row: usize| std::array::from_fn(|i| 1e-50 * number(N * row + i));
    (0..count).map(entry).collect()
}

/// A symmetric matrix of four nodes and the identity, each with blocks of its own beside it.
fn ring() -> Sparse<6, 6> {
    Sparse::build(
        4,
        1,
        || (),
        |(), _| 2,
        |(), row, columns, blocks| {
            for (place, neighbour) in [(row + 1) % 4, (row + 3) % 4].into_iter().enumerate() {
                columns[place] = neighbour as u32;
                let (low, high) = (row.min(neighbour), row.max(neighbour));
                let entry = |i: usize, j: usize| (1 + i + 2 * j + 3 * high + 5 * low) as f32 / 64.0;
                blocks[place] = std::array::from_fn(|i| {
                    std::array::from_fn(|j| match row < neighbour {
                        true => entry(i, j),
                        false => entry(j, i),
                    })
                });
            }
        },
    )
}

#[test]
fn rows_of_a_level_need_their_own_entries_and_those_of_their_ghosts() {
    let x = numbers::<6>(4);
    let product = |own: &[u32]| {
        let rows = LevelRows::of(ring(), own);
        let [own, ghosts] = [own, rows.ghosts()].map(|nodes| {
            let entries = nodes.iter().map(|&node| x[node as usize]);
            entries.collect::<Vec<_>>()
        });
        let mut product = vec![[0.0; 6]; own.len()];
        rows.multiply([&own, &ghosts], &mut product, &mut Vec::new());
        (product, rows.ghosts().to_vec())
    };
    let (whole, none) = product(&[0, 1, 2, 3]);
    let ((first, beside), (second, _)) = (product(&[0, 1]), product(&[2, 3]));
    assert_eq!((none, beside), (vec![], vec![2, 3]));
    // Sums in another order.
    let largest = whole
        .as_flattened()
        .iter()
        .fold(0.0_f64, |a, b| a.max(b.abs()));
    let pairs = std::iter::zip([first, second].concat(), &whole);
    let apart =
        pairs.flat_map(|(one, other)| std::array::from_fn::<_, 6, _>(|i| one[i] - other[i]));
    assert!(apart.fold(0.0_f64, |a, b| a.max(b.abs())) < 1e-6 * largest);
    assert!(whole.as_flattened().iter().all(|entry| *entry != 0.0));
}

/// A lower triangle without a pattern, as rows.
fn lower_triangle(node: usize) -> [[f32; 6]; 6] {
    let entry = |i: usize, j: usize| match i >= j {
        true => (1 + i + 3 * j + 2 * node) as f32 / 8.0,
        false => 0.0,
    };
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

#[test]
fn what_is_restricted_is_the_transpose_of_what_is_prolonged() {
    let transfer = Transfer {
        prolongator: Arc::new(Prolongator::of(ring(), 4)),
        scaling: (0..4).map(lower_triangle).collect(),
    };
    // Rows 0, 2 and 3 have blocks in columns 1 and 3, and 0 and 2.
    let rows = ProlongatorRows::of(transfer, vec![0, 2, 3], &[1, 3]);
    assert_eq!((rows.size(), rows.ghosts()), ([3, 2], &[0_u32, 2][..]));
    let (coarse, fine) = (numbers::<6>(4), numbers::<6>(3));
    let (mut up, mut down) = (vec![[0.0; 6]; 3], vec![[0.0; 6]; 4]);
    rows.prolong([&coarse[..2], &coarse[2..]], &mut up);
    rows.restrict(&fine, &mut down);
    let dot = |a: &[[f64; 6]], b: &[[f64; 6]]| {
        let pairs = a.as_flattened().iter().zip(b.as_flattened());
        pairs.map(|(a, b)| a * b).sum::<f64>()
    };
    let (one, other) = (dot(&up, &fine), dot(&coarse, &down));
    assert!(one != 0.0 && (one - other).abs() < 1e-12 * one.abs());
}
