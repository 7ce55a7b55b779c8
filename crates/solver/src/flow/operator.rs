//! The flow at some transmissivities: its matrix, and conditions as they act on nodes.

use kluft_algebra::{Lists, ScalarMatrix};

use super::conductance::Conductance;
use super::nodal::{self, Nodal, NodalCondition};
use super::topology::{GIVEN, Topology};

/// What facets conduct, and what conditions make of it.
#[derive(Debug, Clone)]
pub(super) struct FlowOperator {
    pub(super) conductance: Conductance,
    /// One for each of [`crate::Flow::conditions`].
    pub(super) conditions: Vec<NodalCondition>,
}

impl FlowOperator {
    /// That of facets which conduct like this.
    pub(super) fn of(topology: &Topology<'_>, conductance: Conductance) -> Self {
        Self {
            conditions: nodal::conditions(
                &topology.places,
                &topology.flow.conditions,
                &conductance,
            ),
            conductance,
        }
    }

    /// The rows and columns of the free pressures, with `extra` (m^3/(Pa s)) on the diagonal of
    /// each row.
    pub(super) fn free_matrix(
        &self,
        topology: &Topology<'_>,
        extra: impl Fn(usize) -> f64,
    ) -> ScalarMatrix {
        let Topology { free, number, .. } = topology;
        let mut walls = vec![0.0; number.len()];
        for entry in &self.conditions {
            if let Nodal::WellPressure(well) = entry.nodal {
                walls[well.row] += well.conductance;
            }
        }
        let mut lists = Vec::with_capacity(free.len());
        let mut values = Vec::new();
        for row in free.iter().map(|&row| row as usize) {
            let entries = self.conductance.matrix.row(row);
            let kept = entries.filter(|(column, _)| number[*column] != GIVEN);
            let mut columns = Vec::new();
            for (column, value) in kept {
                columns.push(number[column]);
                values.push(if column == row {
                    value + walls[row] + extra(row)
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
