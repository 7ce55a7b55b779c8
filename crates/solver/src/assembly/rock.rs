//! Parallel assembly of the stiffness of the rock.
//!
//! Every node gathers what the cells around it contribute to its own rows, in ascending order of
//! the cells. One thread owns one row, so there are no locks and no colours, and the values do not
//! depend on the number of threads.
//!
//! Nodes in linear tetrahedra only are served by [`Tetrahedra`], the others by [`CellMatrices`].

use glam::DMat3;
use kluft_algebra::{BlockMatrix, BlockPattern, RowOwnership};
use rayon::prelude::*;

use crate::assembly::cell_matrices::{CellMatrices, RowScratch};
use crate::assembly::node_blocks::NodeBlocks;
use crate::assembly::tetrahedra::{self, Tetrahedra};
use crate::space::Space;

/// Nodes that one task assembles; small enough to balance, large enough to amortise.
const NODES_PER_TASK: usize = 512;

/// Stiffness of the rock over all unknowns, held directions included: there the diagonal keeps the
/// scale of the rock, so the matrix stays positive definite.
///
/// With `u = g + P T y` it is `T^T (P K P + s (I - P)) T`. The pattern has the rows of the nodes
/// that are `is_wanted`, the others are empty there.
pub(crate) fn rock_stiffness(
    space: Space<'_>,
    is_wanted: &[bool],
    pattern: &BlockPattern,
) -> BlockMatrix {
    assemble(space, (is_wanted, &tetrahedra::nodes(space)), pattern)
}

/// The stiffness, where [`Tetrahedra`] serves the nodes `in_tetrahedra`.
fn assemble(
    space: Space<'_>,
    (is_wanted, in_tetrahedra): (&[bool], &[bool]),
    pattern: &BlockPattern,
) -> BlockMatrix {
    let is_plain = plain(space);
    let firsts = space.points.offset.par_iter();
    let first_block: Vec<usize> = firsts
        .map(|&row| pattern.stored_offset(row as usize))
        .collect();
    // Zeros of the allocator: memory that nobody has touched, as touching it costs more than all
    // sums.
    let mut blocks: Vec<DMat3> = bytemuck::zeroed_vec(first_block[is_wanted.len()]);
    let tasks = RowOwnership::even(is_plain.len(), NODES_PER_TASK);
    let mut shares = tasks.split(&mut blocks, &first_block);
    let nodes = (is_wanted, in_tetrahedra);
    let tetrahedra = Tetrahedra::of(space, nodes, &is_plain);
    shares.par_iter_mut().for_each_init(
        || tetrahedra.scratch(),
        |scratch, (nodes, blocks)| {
            let target = NodeBlocks::of(space.points, pattern, nodes.clone(), blocks);
            tetrahedra.set_share(target, scratch);
        },
    );
    let mut matrices = CellMatrices::of(space, nodes, &is_plain);
    for cells in matrices.waves() {
        matrices.compute(cells);
        shares.par_iter_mut().for_each_init(
            || RowScratch::of(space),
            |scratch, (nodes, blocks)| {
                let target = NodeBlocks::of(space.points, pattern, nodes.clone(), blocks);
                matrices.add_to_share(target, scratch);
            },
        );
    }
    BlockMatrix { blocks }
}

/// Whether a node has one sector and no constraint: its point is its unknown.
fn plain(space: Space<'_>) -> Vec<bool> {
    let nodes = (0..space.problem.mesh.nodes.len()).into_par_iter();
    nodes
        .map(|node| {
            let mut own = space.points.of_node(node);
            own.len() == 1 && own.all(|point| space.supports.constraint(point).is_none())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use kluft_mesh::structured::{Cut, Patch, mixed};
    use kluft_mesh::{Mesh, SurfaceRole};
    use lie_core::{Closure, ClosureKind, FractureLaw, Orthotropy, Rock as Material};

    use super::*;
    use crate::problem::{Condition, FixedPoint, Fracture, Problem, Support};
    use crate::system::Discretisation;

    const CUBES: usize = 6;

    /// A box of two rocks in layers that cross the cells' rows, on rollers at one side, clamped
    /// below and held at a corner; a fracture that ends in the rock crosses another that cuts
    /// through, and the nodes off the planes are moved.
    fn problem(cut: impl Fn([usize; 3]) -> Cut) -> Problem {
        type Plane = fn([f64; 3]) -> bool;
        let planes: [Plane; 4] = [
            |x| x[0] == 0.5,
            |x| x[1] == 0.5 && x[2] <= 0.5,
            |x| x[0] == 0.0,
            |x| x[2] == 0.0,
        ];
        let names = ["through", "ending", "side", "bottom"];
        let patches: Vec<Patch<'_>> = std::iter::zip(names, &planes)
            .map(|(name, contains)| Patch { name, contains })
            .collect();
        let mut draft = mixed([CUBES; 3], [1.0; 3], &patches, cut);
        for (index, node) in draft.nodes.iter_mut().enumerate() {
            let is_off = |x: &f64| *x != 0.0 && *x != 0.5 && *x != 1.0;
            if node.iter().all(is_off) {
                let moved = |axis: usize| 0.03 * (7.3 * (index * (axis + 2)) as f64).sin();
                *node = std::array::from_fn(|axis| node[axis] + moved(axis));
            }
        }
        let (fracture, boundary) = (SurfaceRole::Fracture, SurfaceRole::Boundary);
        let roles = [boundary, fracture, fracture, boundary, boundary];
        let mesh = Mesh::build(draft, &roles).expect("a box");
        let rock = |young_modulus, poisson_ratio| Material {
            young_modulus,
            poisson_ratio,
            density: 0.0,
            anisotropy: None,
        };
        let condition = |boundary, support| Condition {
            boundary,
            load: None,
            support: Some(support),
        };
        let closure = Closure::new(1e-4, 1e10, ClosureKind::Linear);
        let fracture = Fracture {
            law: FractureLaw::elastic(closure, 1e10),
            fluid_pressure: 0.0,
        };
        Problem {
            rocks: vec![rock(2.0, 0.1), rock(1.0, 0.4)],
            rock_of_cell: (0..mesh.cells.len() as u32)
                .map(|cell| cell / 100 % 2)
                .collect(),
            fractures: vec![fracture; 2],
            conditions: vec![
                condition(0, Support::Symmetry),
                condition(1, Support::Displacement([Some(0.0); 3])),
            ],
            fixed_points: vec![FixedPoint {
                node: mesh.nodes.len() as u32 - 1,
                displacement: [None, Some(0.0), None],
                name: "corner".into(),
            }],
            ..Problem::of_rock(mesh, rock(2.0, 0.1))
        }
    }

    fn with_space<T>(problem: &Problem, of: impl FnOnce(Space<'_>) -> T) -> T {
        let discretisation = Discretisation::of(problem).expect("supported");
        of(discretisation.space(problem))
    }

    /// Largest entry of the matrix, and of its difference from the one without [`Tetrahedra`],
    /// which integrates, projects and scatters cell by cell.
    fn compare(problem: &Problem) -> (f64, f64) {
        let largest = |block: DMat3| block.to_cols_array().map(f64::abs).into_iter();
        with_space(problem, |space| {
            let all = vec![true; problem.mesh.nodes.len()];
            let pattern = &space.pattern.blocks;
            let fast = rock_stiffness(space, &all, pattern).blocks;
            let general = assemble(space, (&all, &vec![false; all.len()]), pattern).blocks;
            let pairs = std::iter::zip(&fast, &general);
            let apart = pairs.flat_map(|(fast, general)| largest(*fast - *general));
            let all = general.iter().flat_map(|block| largest(*block));
            (all.fold(0.0, f64::max), apart.fold(0.0, f64::max))
        })
    }

    #[test]
    fn rows_of_tetrahedra_are_those_of_all_cells_one_by_one() {
        let with_prisms = |cube: [usize; 3]| match cube[2] {
            0 => Cut::Prisms,
            _ => Cut::Tetrahedra,
        };
        let bedding =
            Orthotropy::transverse([2.0, 0.5], [0.3, 0.2], 0.2, DMat3::from_rotation_x(0.5));
        let mut bedded = problem(|_| Cut::Tetrahedra);
        bedded.rocks[1] = Material::orthotropic(&bedding, 0.0);
        for problem in [problem(|_| Cut::Tetrahedra), problem(with_prisms), bedded] {
            let (scale, apart) = compare(&problem);
            // Some 24 cells meet at a node; each adds roundings of a few units in the last place.
            assert!(apart < 1e-14 * scale, "{apart:e} of {scale}");
            with_space(&problem, |space| {
                let fast = tetrahedra::nodes(space);
                let served = fast.iter().filter(|&&fast| fast).count();
                assert!(served > fast.len() / 2);
            });
        }
    }

    #[test]
    fn what_is_not_stored_is_the_transpose_of_what_is() {
        let with_prisms = |cube: [usize; 3]| match cube[2] {
            0 => Cut::Prisms,
            _ => Cut::Tetrahedra,
        };
        for problem in [problem(with_prisms), problem(|_| Cut::Hexahedron)] {
            compare_halves(&problem);
        }
    }

    fn compare_halves(problem: &Problem) {
        let all = vec![true; problem.mesh.nodes.len()];
        with_space(problem, |space| {
            let half = &space.pattern.blocks;
            let whole = BlockPattern::new(half.row_offset.clone(), half.columns.clone());
            let rows = rock_stiffness(space, &all, half);
            let expected = rock_stiffness(space, &all, &whole).blocks;
            assert!(rows.blocks.len() < 2 * expected.len() / 3);
            let rows = rows.rows(half);
            let found = (0..half.rows()).flat_map(|row| rows.row(row));
            let size = |block: DMat3| block.to_cols_array().map(f64::abs);
            let largest = |block: DMat3| size(block).into_iter().fold(0.0, f64::max);
            let scale = expected.iter().map(|block| largest(*block));
            let scale = scale.fold(0.0, f64::max);
            for ((_, block), expected) in found.zip(&expected) {
                assert!(largest(block - *expected) < 1e-14 * scale);
            }
        });
    }

    #[test]
    fn threads_do_not_change_a_bit() {
        let problem = problem(|_| Cut::Tetrahedra);
        let all = vec![true; problem.mesh.nodes.len()];
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let blocks = || {
                with_space(&problem, |space| {
                    rock_stiffness(space, &all, &space.pattern.blocks).blocks
                })
            };
            pool.expect("threads").install(blocks)
        };
        let one = with(1);
        for threads in [2, 3] {
            assert!(one == with(threads), "{threads} threads");
        }
    }
}
