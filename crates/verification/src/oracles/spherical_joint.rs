//! A core that floats in a spherical joint inside a shell under outer pressure `p`: a surface that
//! is curved and closed, without shear stiffness. Its closed form, its meshes and its errors.
//!
//! The core is under `-q`, `u = -q r (1 - 2 nu) / E`; the shell is Lame's, `u = C r + D / r^2`:
//!
//! ```text
//! 3 K C - 4 G D / a^3 = -q      3 K C - 4 G D / b^3 = -p      C a + D / a^2 - u_core(a) = w(q)
//! ```
//!
//! with the opening `w(q)` of the joint's law. The left side of the last equation grows with `q`
//! and the right one falls, so bisection finds `q`.

use glam::{DMat3, DVec3};
use kluft_mesh::{Mesh, SurfaceRole};
use kluft_solver::{Condition, Discretisation, Problem, SectorNodes, Solution, SurfaceLoad};
use lie_core::{ClosureKind, Rock};

use crate::oracles::closed_aperture;
use crate::scenes::{self, joint};

const RADII: (f64, f64) = (1.0, 2.0);
const PRESSURE: f64 = 10e6;

/// The closed form: `q`, `C` and `D`.
pub struct Exact {
    rock: Rock,
    /// Pressure on the core (Pa).
    pub q: f64,
    c: f64,
    d: f64,
}

impl Exact {
    fn under(rock: Rock, q: f64) -> Self {
        let (e, nu) = (rock.young_modulus, rock.poisson_ratio);
        let (bulk, shear) = (e / (3.0 - 6.0 * nu), e / (2.0 + 2.0 * nu));
        let (a, b) = RADII;
        let d = (q - PRESSURE) / (4.0 * shear * (a.powi(-3) - b.powi(-3)));
        let c = (4.0 * shear * d / b.powi(3) - PRESSURE) / (3.0 * bulk);
        Self { rock, q, c, d }
    }

    /// Opening of the joint (m).
    pub fn opening(&self) -> f64 {
        self.shell(RADII.0) - self.core(RADII.0)
    }

    /// Radial displacement in the core (m).
    pub fn core(&self, r: f64) -> f64 {
        -self.q * r * (1.0 - 2.0 * self.rock.poisson_ratio) / self.rock.young_modulus
    }

    /// Radial displacement in the shell (m).
    pub fn shell(&self, r: f64) -> f64 {
        self.c * r + self.d / (r * r)
    }

    /// The state in which the law of the joint holds.
    pub fn of(kind: ClosureKind, rock: Rock) -> Self {
        let law = |q: f64| match kind {
            ClosureKind::Linear => -q / 50e9,
            ClosureKind::Logarithmic { .. } => 1e-4 * (closed_aperture(q / 5e6) - 1.0),
            other => panic!("no closed form for {other:?}"),
        };
        let (mut low, mut high) = (0.0, 10.0 * PRESSURE);
        for _ in 0..200 {
            let q = 0.5 * (low + high);
            if Self::under(rock.clone(), q).opening() < law(q) {
                low = q;
            } else {
                high = q;
            }
        }
        Self::under(rock, low)
    }
}

/// The scene `sphere` on a mesh of cell size `h` (m).
pub fn sphere(kind: ClosureKind, rock: Rock, h: f64, order: u32) -> Problem {
    let draft = scenes::geometry_of_order("sphere", &[("h", h)], order);
    let role = |name: &str| match name {
        "outside" => SurfaceRole::Boundary,
        _ => SurfaceRole::Fracture,
    };
    let roles: Vec<SurfaceRole> = draft.groups.iter().map(|group| role(&group.name)).collect();
    let mesh = Mesh::build(draft, &roles).expect("a good mesh");
    let mut fracture = joint(kind);
    fracture.law.shear_stiffness = 0.0;
    let mut problem = scenes::problem(mesh, fracture);
    problem.rocks[0] = rock;
    problem.conditions.push(Condition {
        boundary: scenes::boundary(&problem, "outside"),
        load: Some(SurfaceLoad::Pressure(PRESSURE)),
        support: None,
    });
    scenes::fix(&mut problem, -2.0 * DVec3::Z, [Some(0.0); 3]);
    scenes::fix(&mut problem, 2.0 * DVec3::Z, [Some(0.0), Some(0.0), None]);
    let equator = problem
        .mesh
        .nodes
        .iter()
        .position(|x| x.x > 1.5 && x.y.abs() < 1e-9);
    let at = problem.mesh.nodes[equator.expect("a node of the seam")];
    scenes::fix(&mut problem, at, [None, Some(0.0), None]);
    problem
}

/// A place, how far the displacement there is from the exact one, and the volume it stands for.
type Sample = (DVec3, DVec3, f64);

/// Samples of the core or the shell at the four points of degree 2 in each tetrahedron.
fn samples(problem: &Problem, solution: &Solution, part: &str, exact: &Exact) -> Vec<Sample> {
    let mesh = &problem.mesh;
    let points = SectorNodes::of(mesh);
    let mut samples = Vec::new();
    for cell in 0..mesh.cells.len() {
        let set = &mesh.group_sets[mesh.cell_group_set[cell] as usize];
        if !set.iter().any(|&group| mesh.groups[group].name == part) {
            continue;
        }
        let volume =
            kluft_mesh::cell_volume(mesh.cells.shapes[cell], &mesh.corners(&mesh.cells, cell));
        for corner in 0..4 {
            let mut l = [0.138_196_601_125_010_5; 4];
            l[corner] = 0.585_410_196_624_968_5;
            let (mut x, mut u) = (DVec3::ZERO, DVec3::ZERO);
            for (slot, n) in mesh
                .cells
                .range(cell)
                .zip(shape_functions(l, mesh.cells.range(cell).len()))
            {
                x += n * mesh.nodes[mesh.cells.nodes[slot] as usize];
                u += n * solution.displacements[points.of_cell_node[slot] as usize];
            }
            let r = x.length();
            let radial = if part == "core" {
                exact.core(r)
            } else {
                exact.shell(r)
            };
            samples.push((x, u - radial * x / r, volume / 4.0));
        }
    }
    samples
}

/// Of the tetrahedron of four or ten nodes, in gmsh's order, at barycentric coordinates.
fn shape_functions(l: [f64; 4], count: usize) -> Vec<f64> {
    const EDGES: [(usize, usize); 6] = [(0, 1), (1, 2), (2, 0), (3, 0), (2, 3), (1, 3)];
    if count == 4 {
        return l.to_vec();
    }
    let corners = l.map(|l| l * (2.0 * l - 1.0));
    let edges = EDGES.map(|(a, b)| 4.0 * l[a] * l[b]);
    [&corners[..], &edges[..]].concat()
}

/// Root of the mean square error once the best rigid motion is taken away, and its rotation: the
/// oracle says nothing of where a floating core turns to.
fn error(samples: &[Sample]) -> (f64, f64) {
    let whole: f64 = samples.iter().map(|(_, _, w)| w).sum();
    let centre = samples.iter().map(|(x, _, w)| *w * *x).sum::<DVec3>() / whole;
    let shift = samples.iter().map(|(_, d, w)| *w * *d).sum::<DVec3>() / whole;
    let (mut inertia, mut moment) = (DMat3::ZERO, DVec3::ZERO);
    for (x, d, w) in samples {
        let arm = *x - centre;
        let outer = DMat3::from_cols(arm * arm.x, arm * arm.y, arm * arm.z);
        inertia += *w * (DMat3::from_diagonal(DVec3::splat(arm.length_squared())) - outer);
        moment += *w * arm.cross(*d - shift);
    }
    let turn = inertia.inverse() * moment;
    let rest = |(x, d, w): &Sample| w * (*d - shift - turn.cross(*x - centre)).length_squared();
    (
        (samples.iter().map(rest).sum::<f64>() / whole).sqrt(),
        turn.length(),
    )
}

/// Relative errors: mean normal traction, mean opening, displacement of the core, of the shell; and
/// by how much the core has turned.
pub fn errors(problem: &Problem, solution: &Solution, exact: &Exact) -> ([f64; 4], f64) {
    let interface = Discretisation::of(problem)
        .expect("supported")
        .into_interface();
    let points = || interface.points().iter().zip(&solution.facet_points);
    let area: f64 = points().map(|(point, _)| point.area).sum();
    let traction: f64 = points()
        .map(|(point, r)| point.area * r.normal_traction)
        .sum();
    let opening: f64 = points().map(|(point, r)| point.area * r.opening).sum();
    let (core, turn) = error(&samples(problem, solution, "core", exact));
    let (shell, _) = error(&samples(problem, solution, "shell", exact));
    let errors = [
        (traction / area / -exact.q - 1.0).abs(),
        (opening / area / exact.opening() - 1.0).abs(),
        core / exact.core(RADII.0).abs(),
        shell / exact.shell(RADII.1).abs(),
    ];
    (errors, turn)
}
