//! The discrete flow: its matrix, what acts on it, and its factor.

use kluft_algebra::{LinearFailure, Lists, ScalarCholesky, ScalarMatrix};
use kluft_mesh::{Defect, Mesh};

use super::conductance::Conductance;
use super::networks::{self, FlowNetwork};
use super::nodal::{self, Nodal, NodalCondition};
use super::numbering::FlowNodes;
use crate::problem::Flow;

/// Marks a row whose pressure is given.
const GIVEN: u32 = u32::MAX;

/// Flow in the fractures of a mesh at fixed apertures, ready to be solved under any load.
pub struct FlowSystem<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) flow: &'a Flow,
    pub(super) nodes: FlowNodes,
    pub(super) conductance: Conductance,
    pub(super) conditions: Vec<NodalCondition>,
    pub(super) networks: Vec<FlowNetwork>,
    pub(super) network_of_row: Vec<u32>,
    /// Rows whose pressure is not given, ascending.
    pub(super) free: Vec<u32>,
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
        let conductance = Conductance::of(mesh, flow, &nodes, apertures);
        let shut = conductance.shut(mesh, &nodes);
        if !shut.is_empty() {
            return Err(shut);
        }
        let conditions = nodal::conditions(mesh, flow, &nodes, &conductance)?;
        let (networks, network_of_row) = networks::find(mesh, &nodes, &conditions);
        let mut is_given = vec![false; nodes.len()];
        for entry in &conditions {
            if let Nodal::Given(rows) = &entry.nodal {
                rows.iter().for_each(|&row| is_given[row] = true);
            }
        }
        let free = (0..nodes.len() as u32).filter(|&row| !is_given[row as usize]);
        Ok(Self {
            free: free.collect(),
            mesh,
            flow,
            nodes,
            conductance,
            conditions,
            networks,
            network_of_row,
            factor: None,
        })
    }

    /// Networks whose pressure nothing determines, each with its fractures.
    pub fn undriven(&self) -> Vec<Defect> {
        networks::without_pressure(
            self.mesh,
            self.flow,
            &self.networks,
            &self.conditions,
            &self.network_of_row,
        )
    }

    /// Factorises the matrix, once for all loads.
    ///
    /// # Errors
    /// If it does not fit in memory, or a number is not finite.
    pub fn factorise(&mut self) -> Result<(), LinearFailure> {
        if self.free.is_empty() {
            return Ok(());
        }
        let matrix = self.free_matrix();
        if matrix.values.iter().any(|value| !value.is_finite()) {
            return Err(LinearFailure::NotFinite);
        }
        let mut factor = ScalarCholesky::of(&matrix.pattern)?;
        factor.factorise(&matrix).map_err(|failure| match failure {
            LinearFailure::Indefinite(row) => LinearFailure::Indefinite(self.free[row] as usize),
            other => other,
        })?;
        self.factor = Some(factor);
        Ok(())
    }

    /// Number of pressures.
    pub fn unknown_count(&self) -> usize {
        self.free.len()
    }

    /// What hangs together hydraulically.
    pub fn networks(&self) -> &[FlowNetwork] {
        &self.networks
    }

    /// The node of each pressure, ascending.
    pub fn nodes(&self) -> &[u32] {
        &self.nodes.node
    }

    /// Obtuse corners of facets can drive fluid against the pressure: the pairs of nodes between
    /// which the sum over their facets does.
    pub fn backward_edges(&self) -> usize {
        let rows = 0..self.nodes.len();
        let upper = rows.flat_map(|row| {
            let entries = self.conductance.matrix.row(row);
            entries.filter(move |(column, value)| *column > row && *value > 0.0)
        });
        upper.count()
    }

    /// The rows and columns of the free pressures.
    fn free_matrix(&self) -> ScalarMatrix {
        let mut number = vec![GIVEN; self.nodes.len()];
        for (index, &row) in self.free.iter().enumerate() {
            number[row as usize] = index as u32;
        }
        let mut walls = vec![0.0; self.nodes.len()];
        for entry in &self.conditions {
            if let Nodal::WellPressure(well) = entry.nodal {
                walls[well.row] += well.conductance;
            }
        }
        let mut lists = Vec::with_capacity(self.free.len());
        let mut values = Vec::new();
        for &row in &self.free {
            let row = row as usize;
            let entries = self.conductance.matrix.row(row);
            let kept = entries.filter(|(column, _)| number[*column] != GIVEN);
            let mut columns = Vec::new();
            for (column, value) in kept {
                columns.push(number[column]);
                values.push(if column == row {
                    value + walls[row]
                } else {
                    value
                });
            }
            lists.push(columns);
        }
        ScalarMatrix {
            pattern: Lists::collect(&lists),
            values,
        }
    }
}
