//! The table of the fractures.

use kluft_report::{Page, Table, quantity};

use crate::flow_summary::FlowSummary;
use crate::spread::Spread;
use crate::summary::Summary;

/// Rows of a table.
const MOST_ROWS: usize = 300;

/// Adds the fractures after the last load step, and the flow in them.
pub fn add(page: &mut Page, summary: &Summary) {
    if !summary.fractures.is_empty() {
        page.heading("Numbers of the fractures");
        mechanics(page, summary);
    }
    if let Some(flow) = summary
        .flow
        .as_ref()
        .filter(|flow| !flow.fractures.is_empty())
    {
        page.heading("Flow in the fractures");
        conduits(page, flow);
    }
}

fn mechanics(page: &mut Page, summary: &Summary) {
    let mut table = Table::new(&[
        "fracture",
        "facets#",
        "area#",
        "aperture, least#",
        "mean#",
        "largest#",
        "mean off by up to#",
        "mean normal traction#",
        "mean shear traction#",
        "largest slip#",
        "open area#",
    ]);
    for (name, own) in summary.fractures.iter().take(MOST_ROWS) {
        let unsure = own.aperture_uncertainty.map(|off| quantity(off, "m"));
        let numbers = [
            own.facets.to_string(),
            quantity(own.area, "m²"),
            quantity(own.aperture.min, "m"),
            quantity(own.aperture.mean, "m"),
            quantity(own.aperture.max, "m"),
            unsure.unwrap_or_else(|| "–".into()),
            quantity(own.normal_traction.mean, "Pa"),
            quantity(own.shear_traction.mean, "Pa"),
            quantity(own.slip_max, "m"),
            quantity(own.open_area, "m²"),
        ];
        table.row(&[name], &numbers);
    }
    page.table(&table);
    say_more(page, summary.fractures.len());
}

fn conduits(page: &mut Page, flow: &FlowSummary) {
    let mut table = Table::new(&[
        "fracture",
        "pressure, least#",
        "mean#",
        "largest#",
        "mean hydraulic aperture#",
        "largest flux#",
    ]);
    for conduit in flow.fractures.iter().take(MOST_ROWS) {
        let Spread { min, mean, max } = conduit.pressure;
        let pressures = [min, mean, max].map(|pressure| quantity(pressure, "Pa"));
        let rest = [
            quantity(conduit.hydraulic_aperture.mean, "m"),
            quantity(conduit.flux_max, "m²/s"),
        ];
        table.row(&[&conduit.name], &[&pressures[..], &rest].concat());
    }
    page.table(&table);
    say_more(page, flow.fractures.len());
}

fn say_more(page: &mut Page, count: usize) {
    if count > MOST_ROWS {
        let left = count - MOST_ROWS;
        page.remark(&format!("{left} more fractures are in summary.json."));
    }
}
