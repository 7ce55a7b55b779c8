//! What flows where, load step by load step: all of `history.csv` in rigid rock, and rows and
//! columns of it in rock that deforms.

use kluft_solver::Step;

use crate::flow_summary::{ConduitSummary, StepFlow};
use crate::rows::{self, HEAD, Row};

/// The columns of a flow.
pub const OF_FLOW: [&str; 15] = [
    "pressure_min",
    "pressure_mean",
    "pressure_max",
    "hydraulic_aperture_min",
    "hydraulic_aperture_mean",
    "hydraulic_aperture_max",
    "flux_max",
    "rate",
    "pressure",
    "volume",
    "inflow",
    "outflow",
    "stored",
    "mass_error",
    "flux_error",
];

/// The columns in rigid rock.
pub fn columns() -> Vec<&'static str> {
    [&HEAD[..], &OF_FLOW].concat()
}

/// The flow at the end of a load step.
pub struct FlowEntry<'a> {
    /// What flows in all.
    pub flow: &'a StepFlow,
    /// What flows in each fracture that conducts.
    pub conduits: &'a [ConduitSummary],
}

impl FlowEntry<'_> {
    /// Adds the balance to the row of the step.
    pub fn add_balance(&self, row: &mut Row) {
        row.number("inflow", self.flow.inflow);
        row.number("outflow", self.flow.outflow);
        row.number("stored", self.flow.stored);
        row.number("mass_error", self.flow.mass_error);
        row.number("flux_error", self.flow.flux_error);
    }

    /// Adds the flow in a fracture to its row, if it conducts.
    pub fn add_conduit(&self, row: &mut Row, fracture: &str) {
        let mut own = self.conduits.iter();
        if let Some(conduit) = own.find(|conduit| conduit.name == fracture) {
            row.spread("pressure", conduit.pressure);
            row.spread("hydraulic_aperture", conduit.hydraulic_aperture);
            row.number("flux_max", conduit.flux_max);
        }
    }

    /// The rows of what drives the fluid in a load step, counted from 1.
    pub fn sources(&self, step: (usize, &Step)) -> impl Iterator<Item = Row> {
        self.flow.sources.iter().map(move |source| {
            let mut row = Row::of(step, "source", &source.name);
            row.number("rate", source.rate);
            row.number("pressure", source.pressure);
            row.number("volume", source.volume);
            row
        })
    }

    /// The rows of a load step in rigid rock: the step, what drives the fluid, fractures.
    fn rows(&self, step: (usize, &Step)) -> Vec<Row> {
        let mut whole = Row::of(step, "step", "");
        self.add_balance(&mut whole);
        let fractures = self.conduits.iter().map(|conduit| {
            let mut row = Row::of(step, "fracture", &conduit.name);
            self.add_conduit(&mut row, &conduit.name);
            row
        });
        [whole]
            .into_iter()
            .chain(self.sources(step))
            .chain(fractures)
            .collect()
    }
}

/// A table that grows by load steps.
#[derive(Debug, Default)]
pub struct FlowHistory {
    text: String,
}

impl FlowHistory {
    /// A table that a former run began.
    pub fn from_text(text: String) -> Self {
        Self { text }
    }

    /// The table so far.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Adds the rows of a load step, counted from 1.
    pub fn add(&mut self, step: (usize, &Step), entry: &FlowEntry<'_>) {
        rows::add_to(&mut self.text, &columns(), &entry.rows(step));
    }
}
