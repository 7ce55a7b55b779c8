//! The discrete flow at fixed apertures: its matrix, what acts on it, and its factor.

use std::sync::Arc;

use kluft_algebra::{LinearFailure, ScalarCholesky};
use kluft_mesh::{Defect, Mesh};

use super::conductance::{self, Conductance};
use super::networks::FlowNetwork;
use super::numbering::FlowNodes;
use super::operator::FlowOperator;
use super::steady_state;
use super::topology::Topology;
use crate::problem::Flow;

/// Flow in the fractures of a mesh at fixed apertures, ready to be solved under any load.
pub struct FlowSystem<'a> {
    pub(super) topology: Arc<Topology<'a>>,
    pub(super) operator: FlowOperator,
    /// Of the free rows; none if all pressures are given.
    pub(super) factor: Option<ScalarCholesky>,
}

impl<'a> FlowSystem<'a> {
    /// The flow in fractures of these apertures (m), one for each entry of the flat node list of
    /// the facets of the mesh. It has a solution if [`Self::undriven`] names nothing.
    ///
    /// # Errors
    /// Fractures that conduct nothing, and conditions that meet no fracture or contradict each
    /// other.
    pub fn of(mesh: &'a Mesh, flow: &'a Flow, apertures: &[f64]) -> Result<Self, Vec<Defect>> {
        let nodes = FlowNodes::of(mesh, flow);
        let transmissivity = conductance::transmissivities(mesh, flow, &nodes, apertures);
        let (topology, conductance) = Topology::of((mesh, flow), nodes, transmissivity)?;
        Ok(Self::with(Arc::new(topology), conductance))
    }

    /// The flow in facets that conduct like this.
    pub(super) fn with(topology: Arc<Topology<'a>>, conductance: Conductance) -> Self {
        Self {
            operator: FlowOperator::of(&topology, conductance),
            topology,
            factor: None,
        }
    }

    /// Networks whose pressure nothing determines, each with its fractures.
    pub fn undriven(&self) -> Vec<Defect> {
        steady_state::without_pressure(&self.topology, &self.operator.conditions)
    }

    /// Networks that could not keep what they hold in steady flow: no pressure is given to them,
    /// and what rates drive into them does not leave again.
    pub fn unbalanced(&self) -> Vec<Defect> {
        steady_state::unbalanced(&self.topology, &self.operator.conditions)
    }

    /// Analyses the matrix without factorising it; none if all pressures are given.
    ///
    /// # Errors
    /// If the pattern cannot be analysed.
    pub fn analysis(&self) -> Result<Option<ScalarCholesky>, LinearFailure> {
        if self.topology.free.is_empty() {
            return Ok(None);
        }
        let matrix = self.operator.free_matrix(&self.topology, |_| 0.0);
        ScalarCholesky::of(&matrix.pattern).map(Some)
    }

    /// Factorises the matrix, once for all loads.
    ///
    /// # Errors
    /// If it does not fit in memory, or a number is not finite.
    pub fn factorise(&mut self) -> Result<(), LinearFailure> {
        self.factorise_with(|_| 0.0)
    }

    /// The same with `extra` (m^3/(Pa s)) on the diagonal of each row.
    pub(super) fn factorise_with(
        &mut self,
        extra: impl Fn(usize) -> f64,
    ) -> Result<(), LinearFailure> {
        if self.topology.free.is_empty() {
            return Ok(());
        }
        let matrix = self.operator.free_matrix(&self.topology, extra);
        if matrix.values.iter().any(|value| !value.is_finite()) {
            return Err(LinearFailure::NotFinite);
        }
        let mut factor = ScalarCholesky::of(&matrix.pattern)?;
        factor.factorise(&matrix).map_err(|failure| match failure {
            LinearFailure::Indefinite(row) => {
                LinearFailure::Indefinite(self.topology.free[row] as usize)
            }
            other => other,
        })?;
        self.factor = Some(factor);
        Ok(())
    }

    /// Number of pressures.
    pub fn unknown_count(&self) -> usize {
        self.topology.free.len()
    }

    /// What hangs together hydraulically.
    pub fn networks(&self) -> &[FlowNetwork] {
        &self.topology.networks
    }

    /// The node of each pressure, ascending.
    pub fn nodes(&self) -> &[u32] {
        &self.topology.nodes.node
    }

    /// Obtuse corners of facets can drive fluid against the pressure: the pairs of nodes between
    /// which the sum over their facets does.
    pub fn backward_edges(&self) -> usize {
        let rows = 0..self.topology.nodes.len();
        let upper = rows.flat_map(|row| {
            let entries = self.operator.conductance.matrix.row(row);
            entries.filter(move |(column, value)| *column > row && *value > 0.0)
        });
        upper.count()
    }
}
