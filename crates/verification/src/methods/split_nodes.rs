//! A formulation without enrichment, to compare with: nodes are split, one copy for each
//! part of the rock around them, and springs join the copies.
//!
//! Of the workspace it uses the nodes, cells, facets and boundaries of the mesh and the numbers of
//! the problem. Connected parts, element stiffness, springs, loads and supports are its own.
use std::collections::HashSet;

use faer::Side;
use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};
use glam::DVec3;
use kluft_mesh::Mesh;
use kluft_solver::{Problem, SectorNodes, Solution, Support, SurfaceLoad};

use crate::methods::voigt::tetrahedron;

/// Largest difference against the largest displacement: both solve the same equations, and the
/// condition number of the worst meshes (slivers, soft joints) is about 1e7.
pub const TOLERANCE: f64 = 1e-8;

/// Copy of its node that each cell sees, in the order of the cells' flat node list, and the number
/// of copies in all.
pub fn copies(mesh: &Mesh) -> (Vec<usize>, usize) {
    let cells = &mesh.cells;
    let facets = &mesh.facets.elements;
    let cut: HashSet<Vec<u32>> = (0..facets.len())
        .map(|f| sorted(facets.nodes_of(f)))
        .collect();
    let mut around = vec![Vec::new(); mesh.nodes.len()];
    for cell in 0..cells.len() {
        for slot in cells.range(cell) {
            around[cells.nodes[slot] as usize].push((cell, slot));
        }
    }
    let joined = |a: usize, b: usize| {
        let mut shared = sorted(cells.nodes_of(a));
        shared.retain(|node| cells.nodes_of(b).contains(node));
        shared.len() == 3 && !cut.contains(&shared)
    };
    let mut copy = vec![usize::MAX; cells.nodes.len()];
    let mut count = 0;
    for around in &around {
        for &(seed, slot) in around {
            if copy[slot] != usize::MAX {
                continue;
            }
            copy[slot] = count;
            let mut front = vec![seed];
            while let Some(cell) = front.pop() {
                for &(other, slot) in around {
                    if copy[slot] == usize::MAX && joined(cell, other) {
                        copy[slot] = count;
                        front.push(other);
                    }
                }
            }
            count += 1;
        }
    }
    (copy, count)
}

fn sorted(nodes: &[u32]) -> Vec<u32> {
    let mut nodes = nodes.to_vec();
    nodes.sort_unstable();
    nodes
}

/// The linear system over copies: three unknowns each.
struct Split<'a> {
    problem: &'a Problem,
    copy: Vec<usize>,
    triplets: Vec<(usize, usize, f64)>,
    force: Vec<f64>,
    held: Vec<Option<f64>>,
}

impl<'a> Split<'a> {
    fn of(problem: &'a Problem) -> Self {
        let (copy, count) = copies(&problem.mesh);
        let mut split = Self {
            problem,
            copy,
            triplets: Vec::new(),
            force: vec![0.0; 3 * count],
            held: vec![None; 3 * count],
        };
        (0..problem.mesh.cells.len()).for_each(|cell| split.add_cell(cell));
        (0..problem.mesh.facets.elements.len()).for_each(|facet| split.add_springs(facet));
        split.add_conditions();
        split
    }

    fn corner(&self, node: u32) -> DVec3 {
        self.problem.mesh.nodes[node as usize]
    }

    /// The copy that `cell` sees of `node`.
    fn seen(&self, cell: u32, node: u32) -> usize {
        let cells = &self.problem.mesh.cells;
        let mut range = cells.range(cell as usize);
        let slot = range.find(|&slot| cells.nodes[slot] == node);
        self.copy[slot.expect("a node of the cell")]
    }

    fn add_cell(&mut self, cell: usize) {
        let cells = &self.problem.mesh.cells;
        let corners: Vec<DVec3> = cells
            .nodes_of(cell)
            .iter()
            .map(|&n| self.corner(n))
            .collect();
        let rock = self.problem.rock(cell);
        let stiffness = tetrahedron(&corners, rock.young_modulus, rock.poisson_ratio);
        let own = &self.copy[cells.range(cell)];
        let unknown = |i: usize| 3 * own[i / 3] + i % 3;
        for (i, row) in stiffness.iter().enumerate() {
            let row = row.iter().enumerate();
            self.triplets
                .extend(row.map(|(j, value)| (unknown(i), unknown(j), *value)));
        }
    }

    /// A third of the facet at each node: `K_n n n^T + K_s (1 - n n^T)`, and the fluid.
    fn add_springs(&mut self, facet: usize) {
        let facets = &self.problem.mesh.facets;
        let fracture = &self.problem.fractures[facets.fracture[facet] as usize];
        let (minus, plus) = (facets.minus[facet], facets.plus[facet]);
        let nodes = facets.elements.nodes_of(facet);
        let area = self.area(nodes, minus);
        let (share, n) = (area.length() / 3.0, area.normalize().to_array());
        let law = &fracture.law;
        for &node in nodes {
            let walls = [(self.seen(minus, node), -1.0), (self.seen(plus, node), 1.0)];
            for i in 0..3 {
                for (wall, sign) in walls {
                    self.force[3 * wall + i] += sign * share * fracture.fluid_pressure * n[i];
                }
                for j in 0..3 {
                    let across = n[i] * n[j];
                    let along = f64::from(u8::from(i == j)) - across;
                    let spring =
                        law.closure.normal_stiffness * across + law.shear_stiffness * along;
                    for (a, s) in walls {
                        let pair =
                            walls.map(|(b, t)| (3 * a + i, 3 * b + j, s * t * share * spring));
                        self.triplets.extend(pair);
                    }
                }
            }
        }
    }

    /// Area vector of a triangle that points out of `cell`.
    fn area(&self, nodes: &[u32], cell: u32) -> DVec3 {
        let [a, b, c] = [0, 1, 2].map(|i| self.corner(nodes[i]));
        let inside = self.problem.mesh.cells.nodes_of(cell as usize).iter();
        let inside = inside.map(|&node| self.corner(node)).sum::<DVec3>() / 4.0;
        let area = 0.5 * (b - a).cross(c - a);
        if area.dot(a - inside) < 0.0 {
            -area
        } else {
            area
        }
    }

    fn add_conditions(&mut self) {
        let problem = self.problem;
        for condition in &problem.conditions {
            let boundary = &problem.mesh.boundaries[condition.boundary];
            for facet in 0..boundary.elements.len() {
                let nodes = boundary.elements.nodes_of(facet);
                let area = self.area(nodes, boundary.cell[facet]);
                for &node in nodes {
                    let copy = self.seen(boundary.cell[facet], node);
                    if let Some(SurfaceLoad::Traction(traction)) = condition.load {
                        let force = area.length() / 3.0 * traction;
                        (0..3).for_each(|i| self.force[3 * copy + i] += force[i]);
                    }
                    self.hold(copy, condition.support, area);
                }
            }
        }
    }

    fn hold(&mut self, copy: usize, support: Option<Support>, area: DVec3) {
        match support {
            Some(Support::Displacement(values)) => {
                for (i, value) in values
                    .iter()
                    .enumerate()
                    .filter(|(_, value)| value.is_some())
                {
                    self.held[3 * copy + i] = *value;
                }
            }
            // Faces lie in planes of the axes.
            Some(Support::Symmetry) => self.held[3 * copy + area.abs().max_position()] = Some(0.0),
            None => {}
        }
    }

    /// The equations of what is not held.
    fn reduced(&self) -> Reduced {
        let mut number = vec![usize::MAX; self.held.len()];
        let free: Vec<usize> = (0..self.held.len())
            .filter(|&i| self.held[i].is_none())
            .collect();
        free.iter()
            .enumerate()
            .for_each(|(new, &old)| number[old] = new);
        let mut right: Vec<f64> = free.iter().map(|&i| self.force[i]).collect();
        let mut triplets = Vec::new();
        for &(i, j, value) in self
            .triplets
            .iter()
            .filter(|(i, _, _)| self.held[*i].is_none())
        {
            match self.held[j] {
                Some(held) => right[number[i]] -= value * held,
                None => triplets.push(Triplet::new(number[i], number[j], value)),
            }
        }
        let matrix = SparseColMat::try_new_from_triplets(free.len(), free.len(), &triplets);
        Reduced {
            matrix: matrix.expect("indices in range"),
            right,
            number,
        }
    }

    /// Displacement of every copy.
    fn solve(self) -> Vec<DVec3> {
        let reduced = self.reduced();
        let right = faer::Mat::from_fn(reduced.right.len(), 1, |i, _| reduced.right[i]);
        let factor = reduced.matrix.sp_cholesky(Side::Lower);
        let found = factor.expect("a positive definite matrix").solve(&right);
        let value = |i: usize| self.held[i].unwrap_or_else(|| found[(reduced.number[i], 0)]);
        let unknowns = (0..self.held.len()).step_by(3);
        unknowns
            .map(|i| DVec3::new(value(i), value(i + 1), value(i + 2)))
            .collect()
    }
}

/// A linear system of what is not held.
pub struct Reduced {
    /// Its matrix.
    pub matrix: SparseColMat<usize, f64>,
    /// Its right-hand side.
    pub right: Vec<f64>,
    /// Number of each component of each copy in it.
    number: Vec<usize>,
}

/// The linear system of a problem on split nodes.
pub fn system(problem: &Problem) -> Reduced {
    Split::of(problem).reduced()
}

/// Largest difference between the two solutions anywhere, and of the jumps, against the largest
/// displacement; and that displacement.
pub fn compare(problem: &Problem, solution: &Solution) -> (f64, f64) {
    let split = Split::of(problem);
    let copy = split.copy.clone();
    let points = SectorNodes::of(&problem.mesh);
    assert_eq!(points.len(), split.held.len() / 3, "copies of nodes");
    let found = split.solve();
    let largest = found.iter().map(|u| u.length()).fold(0.0, f64::max);
    let slots = 0..copy.len();
    let moved = |slot: usize| solution.displacements[points.of_cell_node[slot] as usize];
    let walls = slots
        .map(|slot| moved(slot).distance(found[copy[slot]]))
        .fold(0.0, f64::max);
    let facets = &problem.mesh.facets;
    let jump = |i: usize| {
        let [plus, minus] = [facets.plus_slots[i], facets.minus_slots[i]].map(|s| copy[s as usize]);
        solution.facet_points[i]
            .jump
            .distance(found[plus] - found[minus])
    };
    let jumps = (0..facets.elements.nodes.len())
        .map(jump)
        .fold(0.0, f64::max);
    (walls.max(jumps) / largest, largest)
}
