//! Blocks of rock that nothing holds.
//!
//! Every block moves rigidly in six ways. Supports and stiff fractures forbid some of them; what
//! is left over is the null space of a small matrix, and would make the stiffness singular.

use faer::{Mat, Side};
use glam::DVec3;
use kluft_mesh::{Defect, Mesh, facet_area_vector};
use lie_core::FractureLaw;

use crate::problem::{Problem, Spring};
use crate::space::sector_nodes::SectorNodes;
use crate::space::supports::Supports;
use kluft_algebra::dense_kernels::apart;
use kluft_algebra::trace;

/// Below this share of the largest eigenvalue a motion counts as unresisted; the others are far
/// above it, because all lengths are in units of the body.
const FREE: f64 = 1e-11;
/// Square of a motion, against that of the body that moves most, above which a body is pushed too.
const MOVES: f64 = 1e-3;
/// The eigenproblem is dense; with more loose blocks than this the check is left to the
/// factorisation.
const MOST_BLOCKS: usize = 400;

/// Remedy for a block that nothing holds. Whoever knows how supports are written may put it more
/// plainly.
const HOLD: &str =
    "hold the block by a support or a fixed point, or give the fractures around it stiffness";
/// Code of the defect that nothing holds a block, see [`kluft_mesh::Defect::code`].
pub const UNHELD_BLOCK: &str = "unheld-block";

const MOTIONS: [&str; 6] = [
    "translation along x",
    "translation along y",
    "translation along z",
    "rotation about x",
    "rotation about y",
    "rotation about z",
];

/// What the walls of a facet resist.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tie {
    /// Moving apart and together.
    pub(crate) across: bool,
    /// Sliding.
    pub(crate) along: bool,
}

/// Names every group of blocks that can move freely under any load. Laws with kinks may carry or
/// not, as the loads have it: what they let go is found in the solve.
pub(crate) fn find(
    problem: &Problem,
    points: &SectorNodes,
    supports: &Supports,
    laws: &[FractureLaw],
) -> Vec<Defect> {
    let tie = |facet: usize| {
        let law = &laws[problem.mesh.facets.fracture[facet] as usize];
        let kinked = !law.is_smooth();
        Tie {
            across: kinked || law.closure.normal_stiffness > 0.0,
            along: kinked || law.shear_stiffness > 0.0,
        }
    };
    let facets = 0..problem.mesh.facets.elements.len();
    let ties: Vec<Tie> = facets.map(tie).collect();
    let Some(free) = free_motions(problem, points, supports, &ties) else {
        return Vec::new();
    };
    let named = |body: usize| {
        let share = |component: usize| -> f64 {
            let squares = free.motions.iter().map(|own| own[body][component].powi(2));
            squares.sum()
        };
        let shares: [f64; 6] = std::array::from_fn(share);
        let defect = describe(&problem.mesh, &free.body_of_block, body, &shares, HOLD)?;
        Some(defect.with_code(UNHELD_BLOCK))
    };
    (0..free.body_count).filter_map(named).collect()
}

/// Rigid motions of bodies, which are blocks that fractures hold together, that nothing resists.
pub(crate) struct FreeMotions {
    body_of_block: Vec<u32>,
    body_count: usize,
    /// Orthonormal; of each the six components of every body, rotations about the middle of the
    /// mesh, lengths in units of its size.
    motions: Vec<Vec<[f64; 6]>>,
    bounds: (DVec3, DVec3),
}

/// A body that nothing holds, and the motion along which it is pushed.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeBody {
    /// Where it is, and which of its motions are free.
    pub told: Defect,
    /// Its blocks: numbers, from 0.
    pub blocks: Vec<u32>,
    /// The point about which it turns (m).
    about: DVec3,
    /// How that point moves; only the direction and the ratios to other motions mean something.
    displacement: DVec3,
    /// How it turns, in units of the displacement (1/m).
    rotation: DVec3,
}

impl FreeBody {
    /// How a point of it moves, `d + r x (x - x_0)`, at a place (m).
    pub fn motion_at(&self, place: DVec3) -> DVec3 {
        self.displacement + self.rotation.cross(place - self.about)
    }
}

/// The free motions with what `ties` hold, one for each facet; none if there are too many bodies to
/// tell.
pub(crate) fn free_motions(
    problem: &Problem,
    points: &SectorNodes,
    supports: &Supports,
    ties: &[Tie],
) -> Option<FreeMotions> {
    let mesh = &problem.mesh;
    let (body_of_block, body_count) = tie_blocks(mesh, ties);
    if body_count > MOST_BLOCKS {
        return None;
    }
    let body_of_point = bodies_of_points(mesh, points, &body_of_block);
    let constraints = Constraints {
        problem,
        points,
        ties,
        body_of_block: &body_of_block,
        body_of_point: &body_of_point,
        bounds: mesh.bounds(),
    };
    let resistance = constraints.resistance(supports, body_count);
    let eigen = apart(|| resistance.self_adjoint_eigen(Side::Lower)).ok()?;
    let values = eigen.S().column_vector();
    let largest = (0..values.nrows()).map(|i| values[i]).fold(0.0, f64::max);
    let free = (0..values.nrows()).filter(|&i| values[i] <= FREE * largest);
    let of_body = |i: usize, body: usize| std::array::from_fn(|m| eigen.U()[(6 * body + m, i)]);
    let motions = free.map(|i| (0..body_count).map(|body| of_body(i, body)).collect());
    Some(FreeMotions {
        motions: motions.collect(),
        bounds: constraints.bounds,
        body_count,
        body_of_block,
    })
}

impl FreeMotions {
    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.motions.len()
    }

    /// Of their combinations those that a `resistance`, the work of each along each other, leaves
    /// below `share`; none if it has no eigenvalues.
    pub(crate) fn unresisted(self, resistance: &Mat<f64>, share: f64) -> Option<Self> {
        if self.motions.is_empty() {
            return Some(self);
        }
        let eigen = apart(|| resistance.self_adjoint_eigen(Side::Lower)).ok()?;
        let values = eigen.S().column_vector();
        let left = (0..values.nrows()).filter(|&i| values[i] <= share);
        let entry = |i: usize, body: usize, component: usize| -> f64 {
            let parts = self.motions.iter().enumerate();
            parts
                .map(|(a, own)| eigen.U()[(a, i)] * own[body][component])
                .sum()
        };
        let of_body = |i, body| std::array::from_fn(|component| entry(i, body, component));
        let motions = left.map(|i| (0..self.body_count).map(|body| of_body(i, body)).collect());
        let motions = motions.collect();
        Some(Self { motions, ..self })
    }

    /// The work of forces (N, on the unknowns) along each of the motions.
    pub(crate) fn work(&self, mesh: &Mesh, points: &SectorNodes, forces: &[DVec3]) -> Vec<f64> {
        let body_of_point = bodies_of_points(mesh, points, &self.body_of_block);
        let mut of_bodies = vec![[0.0; 6]; self.body_count];
        for (point, &body) in body_of_point.iter().enumerate() {
            let force = points.point_force(forces, point);
            let at = mesh.nodes[points.node[point] as usize];
            let own = along(self.bounds, at, force);
            let sums = of_bodies[body as usize].iter_mut();
            sums.zip(own).for_each(|(sum, own)| *sum += own);
        }
        let of_motion = |motion: &Vec<[f64; 6]>| {
            let pairs = motion.iter().zip(&of_bodies);
            pairs.map(|(a, b)| dot(a, b)).sum()
        };
        self.motions.iter().map(of_motion).collect()
    }

    /// Every body that these coefficients of the motions move, named by what it does most.
    pub(crate) fn bodies(&self, mesh: &Mesh, coefficients: &[f64], remedy: &str) -> Vec<FreeBody> {
        let entry = |body: usize, component: usize| -> f64 {
            let motions = self.motions.iter().zip(coefficients);
            motions.map(|(motion, c)| c * motion[body][component]).sum()
        };
        let of_body =
            |body| -> [f64; 6] { std::array::from_fn(|component| entry(body, component)) };
        let all: Vec<[f64; 6]> = (0..self.body_count).map(of_body).collect();
        let shares: Vec<[f64; 6]> = all
            .iter()
            .map(|own| own.map(|entry| entry * entry))
            .collect();
        let most = |shares: &[f64; 6]| shares.iter().copied().fold(0.0, f64::max);
        let largest = shares.iter().map(most).fold(0.0, f64::max);
        let moving = (0..self.body_count).filter(|&body| most(&shares[body]) > MOVES * largest);
        let named = |body: usize| {
            let own = shares[body].map(|share| share / most(&shares[body]));
            let told = describe(mesh, &self.body_of_block, body, &own, remedy)?;
            Some(self.body((body, told), all[body]))
        };
        moving.filter_map(named).collect()
    }

    /// A body with the components of its motion.
    fn body(&self, (body, told): (usize, Defect), motion: [f64; 6]) -> FreeBody {
        let (low, high) = self.bounds;
        let [x, y, z, turn_x, turn_y, turn_z] = motion;
        let blocks = (0..).zip(&self.body_of_block);
        let own = blocks.filter(|(_, of)| **of as usize == body);
        FreeBody {
            told,
            blocks: own.map(|(block, _)| block).collect(),
            about: 0.5 * (low + high),
            displacement: DVec3::new(x, y, z),
            rotation: DVec3::new(turn_x, turn_y, turn_z) / (high - low).length(),
        }
    }

    /// The jump at a corner of a facet in each of the motions; lengths in units of the body.
    pub(crate) fn jumps(&self, mesh: &Mesh, facet: usize, at: DVec3) -> Vec<DVec3> {
        let [plus, minus] = blocks_at(mesh, facet).map(|block| self.body_of_block[block] as usize);
        if plus == minus {
            return Vec::new();
        }
        let (low, high) = self.bounds;
        let arm = (at - 0.5 * (low + high)) / (high - low).length();
        let moved = |[x, y, z, turn_x, turn_y, turn_z]: [f64; 6]| {
            DVec3::new(x, y, z) + DVec3::new(turn_x, turn_y, turn_z).cross(arm)
        };
        let motions = self.motions.iter();
        motions
            .map(|motion| moved(motion[plus]) - moved(motion[minus]))
            .collect()
    }
}

/// Number of bodies that `ties` leave, one for each facet.
pub(crate) fn body_count(mesh: &Mesh, ties: &[Tie]) -> usize {
    tie_blocks(mesh, ties).1
}

/// Blocks joined by fractures stiff in normal and shear move as one body.
fn tie_blocks(mesh: &Mesh, ties: &[Tie]) -> (Vec<u32>, usize) {
    let mut body: Vec<u32> = (0..mesh.block_count as u32).collect();
    loop {
        let mut changed = false;
        for (facet, tie) in ties.iter().enumerate() {
            let stiff = tie.across && tie.along;
            let [a, b] = blocks_at(mesh, facet);
            if stiff && body[a] != body[b] {
                let low = body[a].min(body[b]);
                (body[a], body[b]) = (low, low);
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
    let mut names = body.clone();
    names.sort_unstable();
    names.dedup();
    for body in &mut body {
        *body = names.partition_point(|name| name < body) as u32;
    }
    (body, names.len())
}

/// Blocks on the plus and the minus side of a facet.
fn blocks_at(mesh: &Mesh, facet: usize) -> [usize; 2] {
    let cells = [mesh.facets.plus[facet], mesh.facets.minus[facet]];
    cells.map(|cell| mesh.block[cell as usize] as usize)
}

fn bodies_of_points(mesh: &Mesh, points: &SectorNodes, body_of_block: &[u32]) -> Vec<u32> {
    let mut body = vec![0; points.len()];
    for cell in 0..mesh.cells.len() {
        for &point in &points.of_cell_node[mesh.cells.range(cell)] {
            body[point as usize] = body_of_block[mesh.block[cell] as usize];
        }
    }
    body
}

struct Constraints<'a> {
    problem: &'a Problem,
    points: &'a SectorNodes,
    ties: &'a [Tie],
    body_of_block: &'a [u32],
    body_of_point: &'a [u32],
    bounds: (DVec3, DVec3),
}

impl Constraints<'_> {
    /// Sum over all constraints of `v v^T`, `v` being what each rigid motion does against one.
    fn resistance(&self, supports: &Supports, bodies: usize) -> Mat<f64> {
        let mut sum = Mat::zeros(6 * bodies, 6 * bodies);
        for point in 0..self.points.len() {
            if let Some(constraint) = supports.constraint(point) {
                let at = self.problem.mesh.nodes[self.points.node[point] as usize];
                let body = self.body_of_point[point] as usize;
                for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                    add(
                        &mut sum,
                        &[(body, self.motion(at, axis - constraint.free * axis))],
                    );
                }
            }
        }
        for spring in &self.problem.springs {
            self.add_spring(spring, &mut sum);
        }
        for facet in 0..self.problem.mesh.facets.elements.len() {
            self.add_facet(facet, &mut sum);
        }
        sum
    }

    /// Springs resist as a facet does on whose other side nothing moves.
    fn add_spring(&self, spring: &Spring, sum: &mut Mat<f64>) {
        let boundary = &self.problem.mesh.boundaries[spring.boundary];
        for facet in 0..boundary.elements.len() {
            let corners = self.problem.mesh.corners(&boundary.elements, facet);
            let normal = facet_area_vector(&corners).normalize();
            let block = self.problem.mesh.block[boundary.cell[facet] as usize];
            let body = self.body_of_block[block as usize] as usize;
            for at in corners {
                let stiffness = spring.stiffness.at(at, normal, 1.0);
                let size = trace(stiffness);
                for axis in [DVec3::X, DVec3::Y, DVec3::Z]
                    .into_iter()
                    .filter(|_| size > 0.0)
                {
                    let resisted = stiffness * axis / size;
                    add(sum, &[(body, self.motion(at, resisted))]);
                }
            }
        }
    }

    /// A facet resists relative motion of the bodies on its sides at each of its corners.
    fn add_facet(&self, facet: usize, sum: &mut Mat<f64>) {
        let mesh = &self.problem.mesh;
        let [plus, minus] = blocks_at(mesh, facet).map(|block| self.body_of_block[block] as usize);
        if plus == minus {
            return;
        }
        let tie = self.ties[facet];
        let corners = mesh.corners(&mesh.facets.elements, facet);
        let normal = facet_area_vector(&corners).normalize();
        for at in corners {
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                let across = axis.dot(normal) * normal;
                let mut resisted = DVec3::ZERO;
                if tie.across {
                    resisted += across;
                }
                if tie.along {
                    resisted += axis - across;
                }
                let motion = |body: usize, direction: DVec3| (body, self.motion(at, direction));
                add(sum, &[motion(plus, resisted), motion(minus, -resisted)]);
            }
        }
    }

    /// What the six rigid motions do along `direction` at a position; rotations about the middle of
    /// the mesh, lengths in units of its size.
    fn motion(&self, at: DVec3, direction: DVec3) -> [f64; 6] {
        along(self.bounds, at, direction)
    }
}

/// What the six rigid motions of a body of these bounds do along `direction` at a position.
fn along((low, high): (DVec3, DVec3), at: DVec3, direction: DVec3) -> [f64; 6] {
    let arm = (at - 0.5 * (low + high)) / (high - low).length();
    let (d, turn) = (direction, arm.cross(direction));
    [d.x, d.y, d.z, turn.x, turn.y, turn.z]
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn add(sum: &mut Mat<f64>, parts: &[(usize, [f64; 6])]) {
    for (body, row) in parts {
        for (other, column) in parts {
            for (i, a) in row.iter().enumerate() {
                for (j, b) in column.iter().enumerate() {
                    sum[(6 * body + i, 6 * other + j)] += a * b;
                }
            }
        }
    }
}

/// A motion is named if half of it or more is free; if none is, the block turns about some other
/// axis.
fn describe(
    mesh: &Mesh,
    body_of_block: &[u32],
    body: usize,
    shares: &[f64],
    remedy: &str,
) -> Option<Defect> {
    if shares.iter().all(|share| *share < 1e-6) {
        return None;
    }
    let named: Vec<&str> = std::iter::zip(MOTIONS, shares)
        .filter(|(_, share)| **share > 0.5)
        .map(|(name, _)| name)
        .collect();
    let motions = if named.is_empty() {
        "rotation about an axis through its supports".to_owned()
    } else {
        named.join(", ")
    };
    let cells = (0..mesh.cells.len())
        .filter(|&cell| body_of_block[mesh.block[cell] as usize] as usize == body);
    let nodes = cells.flat_map(|cell| mesh.cells.nodes_of(cell).iter());
    let (low, high) = nodes.fold(
        (DVec3::INFINITY, DVec3::NEG_INFINITY),
        |(low, high), &node| {
            let x = mesh.nodes[node as usize];
            (low.min(x), high.max(x))
        },
    );
    Some(Defect::new(
        format!(
            "the rock between ({:.4}, {:.4}, {:.4}) and ({:.4}, {:.4}, {:.4})",
            low.x, low.y, low.z, high.x, high.y, high.z
        ),
        format!("nothing holds it: {motions} is free"),
        remedy,
    ))
}
