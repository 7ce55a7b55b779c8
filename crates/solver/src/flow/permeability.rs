//! The equivalent permeability of a body of fractures in rock that conducts nothing.
//!
//! Under a pressure `phi = x_j` on all of the outer surface, the mean flux through the body is
//! `-(k_ij / mu)`, with the rates `Q_b` that enter at the nodes `b` of the outer surface
//!
//! ```text
//! k_ij = mu / V sum_b x_i(b) Q_b(phi = x_j)
//! ```
//!
//! by the theorem of Gauss, as nothing is lost inside (linear pressures on the sides: Long et al.
//! 1982). `Q` is a symmetric operator on pressures of the outer surface, so that `k` is symmetric
//! but for rounding, and it is never negative. Where each fracture goes through the body, pressure
//! is linear in it and `k` is the tensor of Snow (1969),
//!
//! ```text
//! k = mu / V sum_f T_f A_f (1 - n n^T),
//! ```
//!
//! which no network of the same fractures exceeds.

use faer::{Mat, Side};
use glam::{DMat3, DVec3};
use kluft_algebra::dense_kernels::apart;
use kluft_algebra::{LinearFailure, Lists, ScalarCholesky, ScalarMatrix};
use kluft_mesh::{Defect, DisjointSets, FractureEdges, FracturesAtNodes, Mesh};

use super::conductance::{Conductance, stencils, transmissivities};
use super::numbering::FlowNodes;
use crate::problem::Flow;

/// Marks a row whose pressure is not solved for.
const FIXED: u32 = u32::MAX;
/// Corrections of a solution by what it leaves over.
const CORRECTIONS: usize = 2;

/// A symmetric tensor of permeability (m^2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PermeabilityTensor {
    /// Its components.
    pub components: [[f64; 3]; 3],
    /// Its eigenvalues, the largest first.
    pub principal: [f64; 3],
    /// Unit vectors along which they are, each with its largest component positive.
    pub directions: [DVec3; 3],
}

/// How a body of fractures conducts as a whole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EquivalentPermeability {
    /// The tensor.
    pub tensor: PermeabilityTensor,
    /// Snow's tensor: that of the same fractures if each went through the body.
    pub through_going: PermeabilityTensor,
    /// Largest difference between `k_ij` and `k_ji`, as a share of the largest component.
    pub asymmetry: f64,
    /// What nodes inside lose or gain, as a share of what flows.
    pub mass_error: f64,
    /// Volume of the body (m^3).
    pub volume: f64,
    /// Area of fractures that conduct (m^2), and of those that reach the outer surface.
    pub areas: [f64; 2],
}

/// Why there is no equivalent permeability.
#[derive(Debug)]
pub enum NoPermeability {
    /// What is wrong with the mesh or its fractures.
    Defects(Vec<Defect>),
    /// The equations could not be solved.
    Unsolved(LinearFailure),
}

impl From<LinearFailure> for NoPermeability {
    fn from(failure: LinearFailure) -> Self {
        Self::Unsolved(failure)
    }
}

impl EquivalentPermeability {
    /// The volume that a permeability is that of (m^3).
    ///
    /// # Errors
    /// If it is not known, because the outer surface of a mesh without cells does not close.
    pub fn volume_of(mesh: &Mesh) -> Result<f64, Defect> {
        mesh.volume().ok_or_else(|| not_closed(mesh))
    }

    /// That of the fractures of a mesh at these apertures (m), one for each entry of the flat node
    /// list of its facets. Conditions of the flow do not count.
    ///
    /// # Errors
    /// Fractures that conduct nothing, a body whose volume is not known, a matrix that does not fit
    /// in memory, numbers that are not finite.
    pub fn of(mesh: &Mesh, flow: &Flow, apertures: &[f64]) -> Result<Self, NoPermeability> {
        let flow = Flow {
            conditions: Vec::new(),
            inactive: Vec::new(),
            ..flow.clone()
        };
        let volume =
            Self::volume_of(mesh).map_err(|defect| NoPermeability::Defects(vec![defect]))?;
        let nodes = FlowNodes::of(mesh, &flow);
        let transmissivity = transmissivities(mesh, &flow, &nodes, apertures);
        let conductance = Conductance::of(&nodes, &stencils(mesh, &nodes), transmissivity);
        let shut = conductance.shut(mesh, &nodes);
        if !shut.is_empty() {
            return Err(NoPermeability::Defects(shut));
        }
        let body = Body::of(mesh, &nodes, &conductance);
        let found = body.solve()?;
        let scale = flow.fluid.viscosity / volume;
        let whole = scale * found.tensor;
        let largest = whole
            .to_cols_array()
            .iter()
            .fold(0.0, |most, &c| f64::max(most, c.abs()));
        let skew = (whole - whole.transpose()).to_cols_array();
        let skew = skew.iter().fold(0.0, |most, &c| f64::max(most, c.abs()));
        Ok(Self {
            tensor: PermeabilityTensor::of(0.5 * (whole + whole.transpose()))?,
            through_going: PermeabilityTensor::of(scale * body.through_going(mesh))?,
            asymmetry: if largest > 0.0 { skew / largest } else { 0.0 },
            mass_error: found.mass_error,
            volume,
            areas: body.areas(mesh),
        })
    }
}

fn not_closed(mesh: &Mesh) -> Defect {
    Defect::new(
        &mesh.source,
        "the parts of the outer surface do not close around the fractures, so that the volume for an \
         equivalent permeability is not known",
        "give all of the outer surface Physical Surfaces, or mesh the volume as well",
    )
}

impl PermeabilityTensor {
    /// That of a symmetric matrix (m^2).
    ///
    /// # Errors
    /// If a number is not finite.
    pub fn of(tensor: DMat3) -> Result<Self, LinearFailure> {
        let columns = tensor.to_cols_array_2d();
        let scale = columns
            .as_flattened()
            .iter()
            .fold(0.0, |most: f64, c| most.max(c.abs()));
        if !scale.is_finite() {
            return Err(LinearFailure::NotFinite);
        }
        let scale = if scale > 0.0 { scale } else { 1.0 };
        let matrix = Mat::from_fn(3, 3, |row, column| columns[column][row] / scale);
        let eigen = apart(|| matrix.self_adjoint_eigen(Side::Lower));
        let eigen = eigen.map_err(|_| LinearFailure::NotFinite)?;
        let vector = |k: usize| DVec3::from_array([0, 1, 2].map(|i| eigen.U()[(i, k)]));
        // Ascending there.
        let order = [2, 1, 0];
        Ok(Self {
            components: columns,
            principal: order.map(|k| scale * eigen.S()[k]),
            directions: order.map(|k| forward(vector(k))),
        })
    }
}

/// A vector or its opposite, whichever has its largest component positive.
fn forward(vector: DVec3) -> DVec3 {
    let components = vector.to_array();
    let largest = components.iter().fold(
        0.0,
        |most: f64, c| if c.abs() > most.abs() { *c } else { most },
    );
    // No component is -0.
    vector * largest.signum() + DVec3::ZERO
}

/// The discrete body.
struct Body<'a> {
    nodes: &'a FlowNodes,
    conductance: &'a Conductance,
    /// Places of the pressures, counted from their mean (m).
    places: Vec<DVec3>,
    /// Rows on the outer surface.
    outer: Vec<bool>,
    /// Index of each row among those to solve for, or [`FIXED`].
    number: Vec<u32>,
    /// Whether what a row hangs together with reaches the outer surface.
    connected: Vec<bool>,
}

/// What a body conducts.
struct Solved {
    /// `sum_b x_i Q_b(x_j)` (m^5/(Pa s)): row `i`, column `j`.
    tensor: DMat3,
    mass_error: f64,
}

impl<'a> Body<'a> {
    fn of(mesh: &Mesh, nodes: &'a FlowNodes, conductance: &'a Conductance) -> Self {
        let place = |node: &u32| mesh.nodes[*node as usize];
        let centre = nodes.node.iter().map(place).sum::<DVec3>() / nodes.len().max(1) as f64;
        let outer = outer_rows(mesh, nodes);
        let connected = connected(nodes, &outer);
        let mut free = 0;
        let rows = outer.iter().zip(&connected);
        let number = rows.map(|(is_outer, is_connected)| {
            if *is_outer || !*is_connected {
                return FIXED;
            }
            free += 1;
            free - 1
        });
        Self {
            number: number.collect(),
            places: nodes.node.iter().map(|node| place(node) - centre).collect(),
            nodes,
            conductance,
            outer,
            connected,
        }
    }

    /// The matrix of the rows to solve for.
    fn matrix(&self) -> ScalarMatrix {
        let (mut lists, mut values) = (Vec::new(), Vec::new());
        let rows = (0..self.number.len()).filter(|&row| self.number[row] != FIXED);
        for row in rows {
            let entries = self.conductance.matrix.row(row);
            let kept = entries.filter(|(column, _)| self.number[*column] != FIXED);
            let (columns, own): (Vec<u32>, Vec<f64>) = kept
                .map(|(column, value)| (self.number[column], value))
                .unzip();
            lists.push(columns);
            values.extend(own);
        }
        ScalarMatrix {
            pattern: Lists::collect(&lists),
            values,
        }
    }

    fn solve(&self) -> Result<Solved, LinearFailure> {
        let matrix = self.matrix();
        let factor = match matrix.pattern.count() {
            0 => None,
            _ => {
                let mut factor = ScalarCholesky::of(&matrix.pattern)?;
                factor.factorise(&matrix)?;
                Some(factor)
            }
        };
        let mut columns = [DVec3::ZERO; 3];
        let (mut missed, mut moved) = (0.0, 0.0);
        for (axis, column) in columns.iter_mut().enumerate() {
            let rates = self.rates(axis, factor.as_ref());
            for (row, rate) in rates.into_iter().enumerate() {
                if self.outer[row] {
                    *column += rate * self.places[row];
                    moved += 0.5 * rate.abs();
                } else if self.connected[row] {
                    missed += rate.abs();
                }
            }
        }
        Ok(Solved {
            tensor: DMat3::from_cols(columns[0], columns[1], columns[2]),
            mass_error: if moved > 0.0 { missed / moved } else { 0.0 },
        })
    }

    /// What enters at all rows (m^4/(Pa s)) where the pressure on the outer surface is the
    /// coordinate along an axis.
    fn rates(&self, axis: usize, factor: Option<&ScalarCholesky>) -> Vec<f64> {
        let places = self.places.iter().zip(&self.connected);
        // Elsewhere nothing flows at any pressure that is the same all over.
        let guess = places.map(|(place, connected)| if *connected { place[axis] } else { 0.0 });
        let mut potentials: Vec<f64> = guess.collect();
        for _ in 0..CORRECTIONS {
            let rates = self.conductance.rates(&potentials);
            let free = || (0..rates.len()).filter(|&row| self.number[row] != FIXED);
            let Some(factor) = factor else {
                return rates;
            };
            let rhs: Vec<f64> = free().map(|row| -rates[row]).collect();
            for (row, change) in free().zip(factor.solve(&rhs)) {
                potentials[row] += change;
            }
        }
        self.conductance.rates(&potentials)
    }

    /// Snow's sum over the fractures (m^5/(Pa s)).
    fn through_going(&self, mesh: &Mesh) -> DMat3 {
        let areas = mesh.facet_areas();
        let facets = self
            .nodes
            .facets
            .iter()
            .zip(&self.conductance.transmissivity);
        let terms = facets.map(|(&facet, transmissivity)| {
            let area = areas[facet as usize];
            let normal = area.normalize();
            let across = DMat3::from_cols(normal.x * normal, normal.y * normal, normal.z * normal);
            transmissivity * area.length() * (DMat3::IDENTITY - across)
        });
        terms.fold(DMat3::ZERO, |sum, term| sum + term)
    }

    /// Area of all facets, and of those that hang together with the outer surface (m^2).
    fn areas(&self, mesh: &Mesh) -> [f64; 2] {
        let areas = mesh.facet_areas();
        let mut sums = [0.0; 2];
        for (index, &facet) in self.nodes.facets.iter().enumerate() {
            let area = areas[facet as usize].length();
            let row = self.nodes.corners.of(index)[0] as usize;
            sums[0] += area;
            sums[1] += if self.connected[row] { area } else { 0.0 };
        }
        sums
    }
}

/// The rows on edges along which conducting facets meet the outer surface.
fn outer_rows(mesh: &Mesh, nodes: &FlowNodes) -> Vec<bool> {
    let at_nodes = FracturesAtNodes::of_mesh(mesh);
    let edges = FractureEdges::of(mesh, &at_nodes);
    let mut outer = vec![false; nodes.len()];
    for run in edges.meetings().filter(|run| edges.is_outer(run[0].nodes)) {
        let conducts =
            |edge: &kluft_mesh::FacetEdge| nodes.facets.binary_search(&edge.facet).is_ok();
        if run.iter().any(conducts) {
            let rows = run[0].nodes.iter().filter_map(|&node| nodes.of_node(node));
            rows.for_each(|row| outer[row] = true);
        }
    }
    outer
}

/// Whether what each row hangs together with has a row on the outer surface.
fn connected(nodes: &FlowNodes, outer: &[bool]) -> Vec<bool> {
    let mut sets = DisjointSets::new(nodes.len());
    for facet in 0..nodes.facets.len() {
        let corners = nodes.corners.of(facet);
        for &corner in &corners[1..] {
            sets.join(corners[0], corner);
        }
    }
    let roots: Vec<usize> = (0..outer.len() as u32)
        .map(|row| sets.root(row) as usize)
        .collect();
    let mut reaches = vec![false; outer.len()];
    for (&root, _) in roots.iter().zip(outer).filter(|(_, outer)| **outer) {
        reaches[root] = true;
    }
    roots.into_iter().map(|root| reaches[root]).collect()
}
