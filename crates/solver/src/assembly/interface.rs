//! The fractures as the solver sees them: facet points, each with a jump and a law.
//!
//! The jump of a facet point is `w = sum_i J_i y_i + sum_c f_c w_c`, over the unknowns `y_i` of its
//! nodes, with `J_i = N (c(plus, i) P(plus) - c(minus, i) P(minus))`, and over the load cases `c`
//! with their factors `f_c` and the jumps `w_c` of their prescribed displacements. Facets are
//! integrated at their nodes, so with few exceptions (facets of second order, see
//! `lie_core::facet_points`) a facet point couples the unknowns of one node only. Without supports
//! the coefficient of a continuous displacement is zero and left out: the fractures act on the
//! jumps alone.

use glam::{DMat3, DVec3};
use kluft_algebra::{InterfaceBlocks, InterfacePattern, Lists, add_at};
use lie_core::{FacetQuadrature, FractureLaw, JointState};
use rayon::prelude::*;

use crate::assembly::drawing::{Drawn, draw, initial_walls};
use crate::assembly::facet_point::FacetPoint;
use crate::assembly::shared_walls;
use crate::assembly::terms::{Term, Terms};
use crate::problem::{Load, Problem};
use crate::space::sector_nodes::SectorNodes;
use crate::space::supports::Supports;

/// What the prescribed displacements of a load case do to a facet point.
#[derive(Debug, Clone, Copy)]
struct PrescribedJump {
    point: u32,
    case: u32,
    /// Jump at load factor 1 (m), `w_c`.
    jump: DVec3,
}

/// All facet points and how the unknowns move them.
#[derive(Debug, Clone)]
pub struct Interface {
    /// The facet points. With all but Gauss's rule the first ones are those of the nodes of the
    /// facets, in the order of [`kluft_mesh::Facets::elements`]' flat node list; middle points
    /// follow.
    pub(crate) points: Vec<FacetPoint>,
    /// Law of each fracture, then those of points that have their own.
    laws: Vec<FractureLaw>,
    /// Rule that each fracture is integrated by.
    rules: Vec<FacetQuadrature>,
    /// Walls carrying the initial stress; facet points that share theirs refer to the same.
    walls: Vec<JointState>,
    terms: Terms,
    /// Jumps of prescribed displacements, where there are any, points ascending.
    prescribed: Vec<PrescribedJump>,
    /// Unknowns that move facet points, ascending.
    pub(crate) unknowns: Vec<u32>,
    /// Terms of each of `unknowns`.
    terms_of_unknown: Lists,
    /// For each of `unknowns` the unknowns it shares a facet point with, ascending.
    pub(crate) columns: Lists,
}

impl Interface {
    /// Collects the facet points of a problem, and takes over its laws.
    pub fn of(problem: &Problem, points: &SectorNodes, supports: &Supports) -> Self {
        let facets: Vec<(Vec<Drawn>, Vec<Drawn>)> = (0..problem.mesh.facets.elements.len())
            .into_par_iter()
            .map(|facet| draw(problem, points, supports, facet))
            .collect();
        let (nodal, middle): (Vec<_>, Vec<_>) = facets.into_iter().unzip();
        let fractures = problem.fractures.iter();
        let all = || nodal.iter().chain(&middle).flatten();
        let mut interface = Self {
            points: Vec::with_capacity(all().count()),
            laws: fractures.map(|fracture| fracture.law).collect(),
            rules: (0..problem.fractures.len() as u32)
                .map(|fracture| problem.rule_of(fracture))
                .collect(),
            walls: Vec::new(),
            terms: Terms::of(all().map(|drawn| &drawn.terms[..])),
            prescribed: Vec::new(),
            unknowns: Vec::new(),
            terms_of_unknown: Lists::default(),
            columns: Lists::default(),
        };
        for drawn in nodal.into_iter().chain(middle).flatten() {
            let number = interface.points.len() as u32;
            let prescribed = drawn.prescribed.into_iter();
            let prescribed = prescribed.map(|(case, jump)| PrescribedJump {
                point: number,
                case,
                jump,
            });
            interface.prescribed.extend(prescribed);
            interface.points.push(drawn.point);
            interface.set_walls(number as usize, drawn.walls);
            if let Some(law) = drawn.law {
                interface.points[number as usize].law = interface.laws.len() as u32;
                interface.laws.push(law);
            }
        }
        if problem.facet_quadrature != FacetQuadrature::Gauss {
            shared_walls::share(problem, points, &mut interface.points);
        }
        interface.connect();
        interface
    }

    fn connect(&mut self) {
        let mut unknowns: Vec<u32> = self.terms.all().iter().map(|term| term.unknown).collect();
        unknowns.sort_unstable();
        unknowns.dedup();
        let row = |term: &Term| unknowns.partition_point(|other| *other < term.unknown) as u32;
        let rows: Vec<u32> = self.terms.all().iter().map(row).collect();
        self.terms_of_unknown = Lists::group(rows.into_iter(), unknowns.len());
        let columns: Vec<Vec<u32>> = (0..unknowns.len())
            .into_par_iter()
            .map(|row| {
                let terms = self.terms_of_unknown.of(row).iter();
                let points = terms.map(|&term| self.terms.point(term));
                let around = points.flat_map(|point| self.terms.of_point(point));
                let mut columns: Vec<u32> = around.map(|other| other.unknown).collect();
                columns.sort_unstable();
                columns.dedup();
                columns
            })
            .collect();
        self.columns = Lists::collect(&columns);
        self.unknowns = unknowns;
    }

    /// Gives the fractures other laws, one each, the same all over a fracture, which carry the
    /// initial stress from now on. The facet points stay.
    pub(crate) fn set_laws(&mut self, problem: &Problem, laws: Vec<FractureLaw>) {
        self.walls.clear();
        for number in 0..self.points.len() {
            let point = &mut self.points[number];
            let law = &laws[point.fracture as usize];
            point.law = point.fracture;
            let walls = initial_walls(problem, law, point, 0.0);
            self.set_walls(number, walls);
        }
        self.laws = laws;
    }

    /// Takes these laws, with friction and cohesion of some fractures divided by a factor. What
    /// carries the initial stress stays.
    pub(crate) fn weaken(
        &mut self,
        laws: &[FractureLaw],
        factor: f64,
        is_weakened: impl Fn(usize) -> bool,
    ) {
        assert_eq!(
            laws.len(),
            self.laws.len(),
            "a law for each of those before"
        );
        self.laws.copy_from_slice(laws);
        let fractures = 0..self.rules.len();
        let of_points = self.points.iter().map(|point| (point.law, point.fracture));
        let of_points = of_points.map(|(law, fracture)| (law as usize, fracture as usize));
        let mut all: Vec<(usize, usize)> = fractures.map(|f| (f, f)).chain(of_points).collect();
        all.sort_unstable();
        all.dedup();
        for (law, _) in all.into_iter().filter(|(_, f)| is_weakened(*f)) {
            self.laws[law] = laws[law].weakened(factor);
        }
    }

    /// The facet points. With all but Gauss's rule the first ones are those of the nodes of the
    /// facets, in the order of [`kluft_mesh::Facets::elements`]' flat node list; middle points
    /// follow.
    pub fn points(&self) -> &[FacetPoint] {
        &self.points
    }

    /// Unknowns that move facet points, ascending.
    pub fn unknowns(&self) -> &[u32] {
        &self.unknowns
    }

    /// For each of [`Self::unknowns`] the unknowns it shares a facet point with, ascending.
    pub fn columns(&self) -> &Lists {
        &self.columns
    }

    /// Law of each fracture, then those of points that have their own.
    pub fn laws(&self) -> &[FractureLaw] {
        &self.laws
    }

    /// Rule that a fracture is integrated by.
    pub fn rule_of(&self, fracture: u32) -> FacetQuadrature {
        self.rules[fracture as usize]
    }

    /// Area of each fracture (m^2).
    pub(crate) fn areas(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.rules.len()];
        for point in &self.points {
            areas[point.fracture as usize] += point.area;
        }
        areas
    }

    /// Lets the walls carry the initial stress, which is total, beside a fluid whose pressure at
    /// each facet point is given (Pa).
    pub(crate) fn set_initial_pressures(&mut self, problem: &Problem, pressures: &[f64]) {
        for (number, pressure) in pressures.iter().enumerate() {
            if *pressure != 0.0 {
                let point = &self.points[number];
                let law = &self.laws[point.law as usize];
                let walls = initial_walls(problem, law, point, *pressure);
                self.set_walls(number, walls);
            }
        }
    }

    /// The walls of a facet point carrying the initial stress. The law always sees the jump beyond
    /// that.
    pub fn initial_walls(&self, point: &FacetPoint) -> &JointState {
        &self.walls[point.walls as usize]
    }

    /// Those of all facet points.
    pub(crate) fn all_initial_walls(&self) -> impl Iterator<Item = JointState> + '_ {
        self.points.iter().map(|point| *self.initial_walls(point))
    }

    /// Jump (m) at which the law of a facet point carries the initial stress.
    pub fn initial_jump(&self, point: &FacetPoint) -> DVec3 {
        let walls = self.initial_walls(point);
        walls.separation.opening * point.normal + walls.slip
    }

    fn set_walls(&mut self, point: usize, walls: JointState) {
        if self.walls.last() != Some(&walls) {
            self.walls.push(walls);
        }
        self.points[point].walls = self.walls.len() as u32 - 1;
    }

    /// Where the fractures add to the stiffness of the rock.
    pub fn pattern(&self) -> InterfacePattern<'_> {
        InterfacePattern {
            rows: &self.unknowns,
            columns: &self.columns,
        }
    }

    /// Jumps `u(plus) - u(minus)` (m) under a load.
    pub fn jumps(&self, unknowns: &[DVec3], load: &Load) -> Vec<DVec3> {
        let mut jumps: Vec<DVec3> = (0..self.points.len())
            .into_par_iter()
            .map(|point| self.jump(point, unknowns))
            .collect();
        for entry in &self.prescribed {
            jumps[entry.point as usize] += load.factor(entry.case as usize) * entry.jump;
        }
        jumps
    }

    /// Openings of the facet points (m) by a change of the unknowns (m).
    pub(crate) fn openings(&self, unknowns: &[DVec3]) -> Vec<f64> {
        let points = self.points.par_iter().enumerate();
        let opening =
            |(number, point): (usize, &FacetPoint)| self.jump(number, unknowns).dot(point.normal);
        points.map(opening).collect()
    }

    /// What the unknowns make of the jump at a facet point.
    fn jump(&self, point: usize, unknowns: &[DVec3]) -> DVec3 {
        let terms = self.terms.of_point(point).iter();
        let moved = |term: &Term| *self.terms.factor(term) * unknowns[term.unknown as usize];
        terms.map(moved).sum()
    }

    /// By how much the prescribed displacements change the jumps from one load to another (m).
    pub(crate) fn prescribed_change(&self, from: &Load, to: &Load) -> Vec<DVec3> {
        let mut changes = vec![DVec3::ZERO; self.points.len()];
        for entry in &self.prescribed {
            let case = entry.case as usize;
            changes[entry.point as usize] += (to.factor(case) - from.factor(case)) * entry.jump;
        }
        changes
    }

    /// Adds `sign` times the forces (N) by which `tractions` (Pa) resist to the forces on all
    /// unknowns: `sum A J_i^T t`.
    pub fn add_forces(&self, tractions: &[DVec3], sign: f64, forces: &mut [DVec3]) {
        let sum = |row: usize| {
            let terms = self.terms_of_unknown.of(row).iter();
            let force = |&term: &u32| {
                let point = self.terms.point(term);
                self.points[point].area * (self.terms.transposed(term) * tractions[point])
            };
            sign * terms.map(force).sum::<DVec3>()
        };
        add_at(&self.unknowns, sum, forces);
    }

    /// Adds the forces (N) of a fluid with these pressures (Pa), one for each facet point, to those
    /// on all unknowns. It pushes the walls apart: it resists closing like a traction of `-p n`.
    pub fn add_pressures(&self, pressures: &[f64], forces: &mut [DVec3]) {
        let push = self.points.iter().zip(pressures);
        let push: Vec<DVec3> = push.map(|(point, p)| *p * point.normal).collect();
        self.add_forces(&push, 1.0, forces);
    }

    /// Forces (N/Pa) of a unit pressure at each facet point that moves with one of
    /// [`Self::unknowns`]: `A J_i^T n`.
    pub(crate) fn pushes(&self, row: usize) -> impl Iterator<Item = (usize, DVec3)> + '_ {
        let terms = self.terms_of_unknown.of(row).iter();
        terms.map(|&term| {
            let number = self.terms.point(term);
            let point = &self.points[number];
            (
                number,
                point.area * (self.terms.transposed(term) * point.normal),
            )
        })
    }

    /// [`Self::stiffness`] of fractures as stiff as the rock beside them.
    pub fn springs(&self) -> Vec<DMat3> {
        let points = self.points.iter();
        let springs: Vec<DMat3> = points.map(|point| point.spring * DMat3::IDENTITY).collect();
        self.stiffness(&springs)
    }

    /// Stiffness of the fractures, one block for each of [`Self::columns`]: `K_ij = sum A J_i^T D
    /// J_j`.
    pub fn stiffness(&self, tangents: &[DMat3]) -> Vec<DMat3> {
        let rows: Vec<Vec<DMat3>> = (0..self.unknowns.len())
            .into_par_iter()
            .map(|row| self.stiffness_row(row, tangents))
            .collect();
        rows.concat()
    }

    /// Forces of the fractures with [`Self::stiffness`] on each of [`Self::unknowns`]: `K_ij v_j`.
    pub(crate) fn resistance(&self, stiffness: &[DMat3], vector: &[DVec3]) -> Vec<DVec3> {
        let pattern = self.pattern();
        let blocks = stiffness;
        InterfaceBlocks { pattern, blocks }.products(vector)
    }

    fn stiffness_row(&self, row: usize, tangents: &[DMat3]) -> Vec<DMat3> {
        let columns = self.columns.of(row);
        let mut blocks = vec![DMat3::ZERO; columns.len()];
        for &term in self.terms_of_unknown.of(row) {
            let point = self.terms.point(term);
            let left = self.terms.transposed(term) * tangents[point];
            for other in self.terms.of_point(point) {
                let place = columns.partition_point(|column| *column < other.unknown);
                blocks[place] += self.points[point].area * (left * *self.terms.factor(other));
            }
        }
        blocks
    }
}
