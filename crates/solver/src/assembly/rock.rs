//! Parallel assembly of the stiffness of the rock.
//!
//! Every node gathers what the cells around it contribute to its own rows, in ascending order of
//! the cells. One thread owns one row, so there are no locks and no colours, and the values do not
//! depend on the number of threads.
//!
//! Nodes in linear tetrahedra only are served by [`Tetrahedra`]. Where there are other cells,
//! matrices cost more to compute than to store and to read, so they are computed once, in waves
//! that bound the memory.

use std::ops::Range;

use glam::{DMat3, DVec3};
use kluft_algebra::{BlockMatrix, BlockPattern, RowOwnership, trace};
use kluft_mesh::Shape;
use lie_core::enrichment::coefficient;
use lie_core::kernel::{self, MAX_NODES};
use lie_core::{Elasticity, Rock};
use rayon::prelude::*;

use crate::assembly::node_blocks::NodeBlocks;
use crate::assembly::tetrahedra::{self, Tetrahedra};
use crate::space::Space;
use crate::space::cell;
use crate::space::sector_nodes::SectorNodes;

/// Nodes that one task assembles; small enough to balance, large enough to amortise.
const NODES_PER_TASK: usize = 512;
/// Blocks of cells that are kept at a time, which take little memory, unless that makes more than
/// [`MOST_WAVES`].
const BLOCKS_PER_WAVE: usize = 1 << 18;
/// Nodes of a linear tetrahedron; no other cell has as many.
const TETRAHEDRON: usize = 4;
/// Every wave looks at all nodes.
const MOST_WAVES: usize = 32;

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

/// Source of the rows of cells, for the cells of one wave; nodes in linear tetrahedra only are
/// passed over.
struct CellMatrices<'a> {
    space: Space<'a>,
    elasticity: Vec<Elasticity<'a>>,
    is_wanted: &'a [bool],
    in_tetrahedra: &'a [bool],
    is_plain: &'a [bool],
    /// Blocks of the largest matrix of a cell that is not a linear tetrahedron.
    stride: usize,
    cells: Range<usize>,
    slots: Range<usize>,
    /// Matrices of `cells`, `stride` blocks each.
    matrices: Vec<DMat3>,
}

impl<'a> CellMatrices<'a> {
    fn of(
        space: Space<'a>,
        (is_wanted, in_tetrahedra): (&'a [bool], &'a [bool]),
        is_plain: &'a [bool],
    ) -> Self {
        let shapes = space.problem.mesh.cells.shapes.par_iter();
        let stored = shapes.filter(|&&shape| shape != Shape::Tet4);
        Self {
            space,
            elasticity: space.problem.rocks.iter().map(Rock::elasticity).collect(),
            is_wanted,
            in_tetrahedra,
            is_plain,
            stride: stored.map(|s| s.node_count().pow(2)).max().unwrap_or(0),
            cells: 0..0,
            slots: 0..0,
            matrices: Vec::new(),
        }
    }

    fn waves(&self) -> Vec<Range<usize>> {
        if self.in_tetrahedra.iter().all(|&alone| alone) {
            return Vec::new();
        }
        let count = self.space.problem.mesh.cells.len();
        let by_memory = BLOCKS_PER_WAVE.checked_div(self.stride).unwrap_or(count);
        let length = by_memory.max(count.div_ceil(MOST_WAVES)).max(1);
        let waves = (0..count).step_by(length);
        waves
            .map(|start| start..(start + length).min(count))
            .collect()
    }

    /// Turns to the wave `cells`.
    fn compute(&mut self, cells: Range<usize>) {
        let Space { problem, .. } = self.space;
        let elements = &problem.mesh.cells;
        self.slots = elements.offsets[cells.start] as usize..elements.offsets[cells.end] as usize;
        self.cells = cells.clone();
        if self.stride == 0 {
            return;
        }
        let length = self.stride * cells.len();
        self.matrices.resize(length, DMat3::ZERO);
        let matrices = self.matrices.par_chunks_mut(self.stride);
        matrices.zip(cells).for_each(|(matrix, cell)| {
            let shape = elements.shapes[cell];
            if shape != Shape::Tet4 {
                let mut positions = [DVec3::ZERO; MAX_NODES];
                let positions = cell::positions(&problem.mesh, cell, &mut positions);
                let matrix = &mut matrix[..positions.len().pow(2)];
                kernel::stiffness(shape, positions, problem.rock(cell), matrix);
            }
        });
    }

    /// Row of a cell's stiffness; `tetrahedron` is room for it.
    fn row<'r>(&'r self, visit: &CellRow, tetrahedron: &'r mut [DMat3; 4]) -> &'r [DMat3] {
        let count = visit.count as usize;
        if count != TETRAHEDRON {
            let matrix = self.stride * (visit.cell as usize - self.cells.start);
            return &self.matrices[matrix + visit.local as usize * count..][..count];
        }
        let mesh = &self.space.problem.mesh;
        let positions = visit.nodes.map(|node| mesh.nodes[node as usize]);
        let elasticity = self.elasticity[visit.rock as usize];
        kernel::tetrahedron_row(&positions, elasticity, visit.local as usize, tetrahedron);
        tetrahedron
    }

    fn visit(&self, slot: u32) -> CellRow {
        let Space {
            problem, pattern, ..
        } = self.space;
        let cells = &problem.mesh.cells;
        let (cell, range) = pattern.cell_of_slot.locate(slot, cells);
        let mut nodes = [0; TETRAHEDRON];
        if range.len() == TETRAHEDRON {
            nodes.copy_from_slice(&cells.nodes[range.clone()]);
        }
        CellRow {
            cell: cell as u32,
            local: slot - range.start as u32,
            count: range.len() as u32,
            nodes,
            rock: match self.elasticity.len() {
                1 => 0,
                _ => problem.rock_of_cell[cell],
            },
        }
    }

    /// Adds what the cells of the wave contribute to the rows of consecutive nodes.
    fn add_to_share(&self, mut target: NodeBlocks<'_>, scratch: &mut RowScratch) {
        let Space {
            points, pattern, ..
        } = self.space;
        let RowScratch {
            place,
            visits,
            rows,
        } = scratch;
        // Apart from the sums, because the cells lie anywhere in memory: here nothing waits for
        // them.
        visits.clear();
        let is_served = |node: &usize| self.is_wanted[*node] && !self.in_tetrahedra[*node];
        for node in target.nodes().filter(is_served) {
            let slots = self.space.slots(node, &self.slots).iter();
            visits.extend(slots.map(|&slot| self.visit(slot)));
        }
        let mut visits = visits.as_slice();
        for node in target.nodes().filter(is_served) {
            let slots = self.space.slots(node, &self.slots);
            if slots.is_empty() {
                continue;
            }
            let (own, others) = visits.split_at(slots.len());
            visits = others;
            let neighbours = pattern.neighbours.of(node);
            let mut length = 0;
            for &other in neighbours {
                place[other as usize] = length;
                length += points.of_node(other as usize).len() as u32;
            }
            rows.clear();
            rows.resize(points.of_node(node).len() * length as usize, DMat3::ZERO);
            let is_plain = |&other: &u32| self.is_plain[other as usize];
            if neighbours.iter().all(is_plain) {
                self.add_plain(slots, own, rows, place);
            } else {
                self.add_general(node, slots, own, rows, place);
            }
            target.add(node, rows);
        }
    }

    /// The row of a node whose neighbours, like itself, have one sector and no constraint.
    fn add_plain(&self, slots: &[u32], visits: &[CellRow], row: &mut [DMat3], place: &[u32]) {
        let mut tetrahedron = [DMat3::ZERO; 4];
        for (&slot, visit) in slots.iter().zip(visits) {
            let blocks = self.row(visit, &mut tetrahedron);
            let first = (slot - visit.local) as usize;
            let nodes = match visit.count as usize {
                TETRAHEDRON => &visit.nodes,
                count => &self.space.problem.mesh.cells.nodes[first..first + count],
            };
            for (block, &other) in blocks.iter().zip(nodes) {
                row[place[other as usize] as usize] += *block;
            }
        }
    }

    /// The rows of any node, row after row of equal length.
    fn add_general(
        &self,
        node: usize,
        slots: &[u32],
        visits: &[CellRow],
        rows: &mut [DMat3],
        place: &[u32],
    ) {
        let Space {
            points, supports, ..
        } = self.space;
        let mut tetrahedron = [DMat3::ZERO; 4];
        for (&slot, visit) in slots.iter().zip(visits) {
            let blocks = self.row(visit, &mut tetrahedron);
            let point = points.of_cell_node[slot as usize] as usize;
            let target = TargetRows {
                points,
                point,
                own: points.of_node(node),
            };
            for (block, other_slot) in blocks.iter().zip((slot - visit.local) as usize..) {
                let other = points.of_cell_node[other_slot] as usize;
                let start = place[points.node[other] as usize] as usize;
                let block = supports.project_block(point, other, *block);
                target.scatter(other, block, start, rows);
            }
            if let Some(constraint) = supports.constraint(point) {
                let scale = trace(blocks[visit.local as usize]) / 3.0;
                let block = scale * (DMat3::IDENTITY - constraint.free);
                target.scatter(point, block, place[node] as usize, rows);
            }
        }
    }
}

/// One occurrence of a node in a cell.
struct CellRow {
    cell: u32,
    /// Number of the node within the cell.
    local: u32,
    /// Number of the cell's nodes.
    count: u32,
    /// Nodes of a linear tetrahedron.
    nodes: [u32; TETRAHEDRON],
    rock: u32,
}

/// Room that a thread uses again and again.
struct RowScratch {
    /// For the neighbours of a node, where their blocks start in its rows.
    place: Vec<u32>,
    visits: Vec<CellRow>,
    /// Rows of a node, those blocks included that are not stored.
    rows: Vec<DMat3>,
}

impl RowScratch {
    fn of(space: Space<'_>) -> Self {
        Self {
            place: vec![0; space.problem.mesh.nodes.len()],
            visits: Vec::new(),
            rows: Vec::new(),
        }
    }
}

/// A point whose block row is spread over the rows of its node's unknowns `own`.
struct TargetRows<'a> {
    points: &'a SectorNodes,
    point: usize,
    own: Range<usize>,
}

impl TargetRows<'_> {
    /// Adds a block between two points to the unknowns of their nodes, `K_kl += c_ik c_jl K_ij`;
    /// those of `other` stand at `start` in every row.
    fn scatter(&self, other: usize, block: DMat3, start: usize, rows: &mut [DMat3]) {
        let (sector, sectors) = self.points.sector(self.point);
        let (other_sector, other_sectors) = self.points.sector(other);
        let length = rows.len() / self.own.len();
        for k in 0..sectors {
            let row = &mut rows[k as usize * length..][start..];
            let weight = coefficient(sectors, sector, k);
            for l in 0..other_sectors {
                row[l as usize] += weight * coefficient(other_sectors, other_sector, l) * block;
            }
        }
    }
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
