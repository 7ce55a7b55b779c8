//! `history.csv` of a run in rigid rock: what flows where, load step by load step.

use kluft_io::printable::cell;
use kluft_solver::Step;

use crate::flow_summary::{ConduitSummary, StepFlow};
use crate::spread::Spread;

/// The columns; what a row does not have is empty.
const COLUMNS: [&str; 17] = [
    "step",
    "time",
    "phase",
    "kind",
    "name",
    "pressure_min",
    "pressure_mean",
    "pressure_max",
    "hydraulic_aperture_min",
    "hydraulic_aperture_mean",
    "hydraulic_aperture_max",
    "flux_max",
    "rate",
    "pressure",
    "inflow",
    "outflow",
    "mass_error",
];

/// A table that grows by load steps.
#[derive(Debug, Default)]
pub struct FlowHistory {
    text: String,
}

impl FlowHistory {
    /// The table so far.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Adds the rows of a load step, counted from 1: the step, what drives the fluid, fractures.
    pub fn add(
        &mut self,
        number: usize,
        step: &Step,
        flow: &StepFlow,
        conduits: &[ConduitSummary],
    ) {
        let mut table = csv::Writer::from_writer(Vec::new());
        // Writing to memory cannot fail.
        if self.text.is_empty() {
            let _ = table.write_record(COLUMNS);
        }
        let phase = step.phase.as_deref().unwrap_or_default();
        let head = [
            number.to_string(),
            format!("{:e}", step.load.time),
            cell(phase),
        ];
        let mut write = |kind: &str, name: &str, values: [Option<f64>; 12]| {
            let values = values.map(|value| value.map_or_else(String::new, |v| format!("{v:e}")));
            let row = head.iter().cloned().chain([kind.to_owned(), cell(name)]);
            let _ = table.write_record(row.chain(values));
        };
        let balance = [flow.inflow, flow.outflow, flow.mass_error].map(Some);
        write("step", "", behind([None; 9], balance));
        for source in &flow.sources {
            let mut values = [None; 12];
            (values[7], values[8]) = (Some(source.rate), Some(source.pressure));
            write("source", &source.name, values);
        }
        for conduit in conduits {
            let [a, b, c] = parts(conduit.pressure);
            let [d, e, f] = parts(conduit.hydraulic_aperture);
            let flux = Some(conduit.flux_max);
            write(
                "fracture",
                &conduit.name,
                behind([a, b, c, d, e, f, flux, None, None], [None; 3]),
            );
        }
        let bytes = table.into_inner().unwrap_or_default();
        self.text.push_str(&String::from_utf8_lossy(&bytes));
    }
}

/// The values of a row: those of fractures and sources, then those of the step.
fn behind(first: [Option<f64>; 9], last: [Option<f64>; 3]) -> [Option<f64>; 12] {
    std::array::from_fn(|place| match place {
        0..9 => first[place],
        _ => last[place - 9],
    })
}

fn parts(spread: Spread) -> [Option<f64>; 3] {
    [spread.min, spread.mean, spread.max].map(Some)
}
