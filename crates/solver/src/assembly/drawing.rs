//! The facet points of one facet, drawn from the mesh, its supports and its law.

use glam::{DMat3, DVec3};
use lie_core::enrichment::coefficient;
use lie_core::{FacetQuadrature, FacetRulePoint, FractureLaw, JointState, facet_points};

use crate::assembly::facet_point::FacetPoint;
use crate::assembly::rock_spring::spring;
use crate::problem::Problem;
use crate::space::sector_nodes::SectorNodes;
use crate::space::supports::Supports;

/// Share of a facet below which the area of a point has no direction of its own.
const TURNED: f64 = 1e-9;

/// One term of the jump of a facet point.
#[derive(Debug, Clone, Copy)]
pub(super) struct DrawnTerm {
    pub(super) unknown: u32,
    /// `J_i`.
    pub(super) factor: DMat3,
}

/// A facet point with its terms, before they are numbered.
pub(super) struct Drawn {
    pub(super) point: FacetPoint,
    /// The walls carrying the initial stress.
    pub(super) walls: JointState,
    /// The law of the point, if it is not that of its fracture.
    pub(super) law: Option<FractureLaw>,
    pub(super) terms: Vec<DrawnTerm>,
    /// Load case and jump (m) of prescribed displacements.
    pub(super) prescribed: Vec<(u32, DVec3)>,
}

/// The points of one facet: those at its nodes, and the others.
pub(super) fn draw(
    problem: &Problem,
    points: &SectorNodes,
    supports: &Supports,
    facet: usize,
) -> (Vec<Drawn>, Vec<Drawn>) {
    let mesh = &problem.mesh;
    let elements = &mesh.facets.elements;
    let nodes = elements.nodes_of(facet);
    let positions: Vec<DVec3> = nodes
        .iter()
        .map(|&node| mesh.nodes[node as usize])
        .collect();
    let quadrature = problem.rule_of(mesh.facets.fracture[facet]);
    let rule = facet_points(elements.shapes[facet], &positions, quadrature);
    let mean: DVec3 = rule.iter().map(|point| point.area).sum();
    let drawing = Drawing {
        problem,
        points,
        supports,
        facet,
        spring: spring(problem, facet, mean.length()),
        mean,
    };
    let nodal = match quadrature {
        FacetQuadrature::Nodal | FacetQuadrature::Control => nodes.len(),
        FacetQuadrature::Gauss => 0,
    };
    let node = |index: usize| positions.get(index).filter(|_| index < nodal).copied();
    let numbered = rule.iter().enumerate();
    let mut drawn: Vec<Drawn> = numbered
        .map(|(index, point)| drawing.point(point, node(index)))
        .collect();
    let others = drawn.split_off(nodal);
    (drawn, others)
}

/// A facet whose points are drawn.
struct Drawing<'a> {
    problem: &'a Problem,
    points: &'a SectorNodes,
    supports: &'a Supports,
    facet: usize,
    /// Stiffness of the rock beside it (Pa/m).
    spring: f64,
    /// Sum of the areas of its points times their normals (m^2).
    mean: DVec3,
}

impl Drawing<'_> {
    fn point(&self, rule: &FacetRulePoint, node: Option<DVec3>) -> Drawn {
        let Self {
            problem,
            points,
            supports,
            facet,
            spring,
            mean,
        } = *self;
        let facets = &problem.mesh.facets;
        let slots = facets.elements.range(facet);
        let wall = |slots: &[u32], local: u8| points.of_cell_node[slots[local as usize] as usize];
        let (plus, minus) = (
            &facets.plus_slots[slots.clone()],
            &facets.minus_slots[slots],
        );
        let mut terms = Vec::new();
        let mut prescribed = vec![DVec3::ZERO; problem.schedule.case_count()];
        for &(local, value) in &rule.nodes {
            let (plus, minus) = (wall(plus, local), wall(minus, local));
            for (case, jump) in prescribed.iter_mut().enumerate() {
                let held = |point: u32| supports.prescribed(point as usize, case);
                *jump += value * (held(plus) - held(minus));
            }
            terms.extend(jump_terms(points, supports, plus, minus, value));
        }
        let fracture = facets.fracture[facet];
        // At the tip of a quarter-point facet the share of the tip is negative or nothing; nothing
        // moves there.
        let own = rule.area.length();
        let (area, normal) = match own > TURNED * mean.length() && rule.area.dot(mean) > 0.0 {
            true => (own, rule.area / own),
            false => (rule.area.dot(mean.normalize()), mean.normalize()),
        };
        let own_law = problem.varying_law(facet, rule, node);
        let law = own_law.unwrap_or(problem.fractures[fracture as usize].law);
        let point = FacetPoint {
            facet: facet as u32,
            fracture,
            law: fracture,
            position: rule.position,
            area,
            normal,
            spring,
            walls: 0,
        };
        let prescribed = (0..).zip(prescribed);
        Drawn {
            walls: initial_walls(problem, &law, &point, 0.0),
            point,
            law: own_law,
            terms,
            prescribed: prescribed
                .filter(|(_, jump)| *jump != DVec3::ZERO)
                .collect(),
        }
    }
}

/// `J_i` for all unknowns of one node that have one.
fn jump_terms(
    points: &SectorNodes,
    supports: &Supports,
    plus: u32,
    minus: u32,
    value: f64,
) -> impl Iterator<Item = DrawnTerm> {
    let (plus_sector, sectors) = points.sector(plus as usize);
    let (minus_sector, _) = points.sector(minus as usize);
    let free = |wall: u32| {
        supports
            .constraint(wall as usize)
            .map_or(DMat3::IDENTITY, |constraint| constraint.free)
    };
    let (free_plus, free_minus) = (free(plus), free(minus));
    (0..sectors)
        .map(move |k| DrawnTerm {
            unknown: plus - plus_sector + k,
            factor: value
                * (coefficient(sectors, plus_sector, k) * free_plus
                    - coefficient(sectors, minus_sector, k) * free_minus),
        })
        .filter(|term| term.factor != DMat3::ZERO)
}

/// The walls of a facet point carrying the initial stress beside a fluid of some pressure (Pa). A
/// fracture without stiffness carries none, so it relaxes what the initial stress would need of it.
pub(super) fn initial_walls(
    problem: &Problem,
    law: &FractureLaw,
    point: &FacetPoint,
    pressure: f64,
) -> JointState {
    let (at, normal) = (point.position, point.normal);
    let facets = &problem.mesh.facets;
    let sides = [
        facets.minus[point.facet as usize],
        facets.plus[point.facet as usize],
    ];
    let [one, other] = sides.map(|cell| problem.initial_stress_in(cell as usize));
    let stress = one.and(other);
    let traction = stress.map_or(DVec3::ZERO, |stress| {
        let place = problem.field_place(point.facet as usize, at);
        stress.at_place(at, &place) * normal
    });
    law.under_initial_stress(traction + pressure * normal, normal)
}
