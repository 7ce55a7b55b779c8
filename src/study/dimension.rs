//! Dimensions of a sweep, and the choices of each.

use super::edits::Edit;

/// What a dimension changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SweepKind {
    /// Parameters of the mesh.
    Mesh,
    /// Order of the elements.
    Order,
    /// Whether cells at crack fronts are quarter-point elements.
    Fronts,
    /// The closure law, with keys of it.
    Closure,
    /// A number of the fractures, or a load.
    Value,
    /// How facets are integrated.
    Facets,
    /// The linear solver.
    Solver,
}

impl SweepKind {
    /// Whether the solution that finer and finer meshes approach depends on it.
    pub(super) fn is_physics(self) -> bool {
        matches!(self, Self::Closure | Self::Value)
    }
}

/// One choice of a dimension.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Choice {
    /// What tables and charts call it.
    pub(super) label: String,
    /// What it changes in the scene.
    pub(super) edits: Vec<Edit>,
    /// The number it stands for, if it stands for one.
    pub(super) number: Option<f64>,
    /// Cost against that of the scene's own choice, roughly.
    pub(super) cost: f64,
}

impl Choice {
    /// A choice that stands for no number, and costs what the scene's own does.
    pub(super) fn new(label: &str, edits: Vec<Edit>) -> Self {
        Self {
            label: label.to_owned(),
            edits,
            number: None,
            cost: 1.0,
        }
    }
}

/// A dimension of the sweep.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SweepDimension {
    /// Its name, also that of its column.
    pub(super) name: String,
    /// What it changes.
    pub(super) kind: SweepKind,
    /// Its choices, at least one.
    pub(super) choices: Vec<Choice>,
}
