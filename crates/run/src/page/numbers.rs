//! Load steps, accuracy and provenance.

use kluft_report::{Page, Table};

use crate::memory;
use crate::permeability_summary::PermeabilitySummary;
use crate::summary::{StepSummary, Summary};

/// Rows of a table.
const MOST_ROWS: usize = 300;

/// Adds the load steps.
pub fn add_steps(page: &mut Page, steps: &[StepSummary]) {
    if steps.is_empty() {
        return;
    }
    page.heading("Load steps");
    match steps.iter().any(|step| step.measures.is_some()) {
        true => solved_steps(page, steps),
        false => flow_steps(page, steps),
    }
    if steps.len() > MOST_ROWS {
        let left = steps.len() - MOST_ROWS;
        page.remark(&format!("{left} more are in summary.json."));
    }
}

fn solved_steps(page: &mut Page, steps: &[StepSummary]) {
    let mut table = Table::new(&[
        "step",
        "phase",
        "ended",
        "time#",
        "solved#",
        "Newton#",
        "substeps#",
        "linear#",
        "force out of balance#",
        "increment#",
        "error of closure#",
    ]);
    for (number, step) in (1..).zip(steps).take(MOST_ROWS) {
        let Some(measures) = &step.measures else {
            continue;
        };
        let ended = if measures.converged {
            "converged"
        } else {
            "not converged"
        };
        let texts = [
            &number.to_string(),
            step.phase.as_deref().unwrap_or(""),
            ended,
        ];
        let share = |value: f64| format!("{value:.1e}");
        let numbers = [
            step.time.to_string(),
            format!("{:.0} %", 100.0 * step.completed),
            measures.newton_iterations.to_string(),
            measures.substeps.len().to_string(),
            measures.linear_iterations.to_string(),
            share(measures.force_residual),
            share(measures.increment),
            share(measures.closure_error),
        ];
        table.row(&texts, &numbers);
    }
    page.table(&table);
}

fn flow_steps(page: &mut Page, steps: &[StepSummary]) {
    let mut table = Table::new(&[
        "step",
        "phase",
        "time#",
        "inflow (m³/s)#",
        "outflow (m³/s)#",
        "mass error#",
    ]);
    for (number, step) in (1..).zip(steps).take(MOST_ROWS) {
        let Some(flow) = &step.flow else {
            continue;
        };
        let texts = [&number.to_string(), step.phase.as_deref().unwrap_or("")];
        let rates = [flow.inflow, flow.outflow].map(|rate| format!("{rate:.4e}"));
        let [inflow, outflow] = rates;
        let error = format!("{:.1e}", flow.mass_error);
        table.row(&texts, &[step.time.to_string(), inflow, outflow, error]);
    }
    page.table(&table);
}

/// Adds how accurate the results are.
pub fn add_accuracy(page: &mut Page, summary: &Summary) {
    let compared = summary.measures.iter();
    let compared: Vec<_> = compared.filter(|measure| measure.error.is_some()).collect();
    let is_estimated = summary.steps.iter().any(|step| step.measures.is_some());
    let last_flow = summary
        .steps
        .iter()
        .rev()
        .find_map(|step| step.flow.as_ref());
    if !is_estimated && compared.is_empty() && last_flow.is_none() {
        return;
    }
    page.heading("Accuracy");
    if is_estimated {
        page.text(&format!(
            "Estimated error of the stress in the rock: {:.2} % of it in the energy norm, for the sake of the mesh.",
            100.0 * summary.stress_error
        ));
        add_path_error(page, &summary.steps);
    }
    if let Some(flow) = last_flow {
        page.text(&format!(
            "Estimated error of the flux in the fractures: {:.2} % of it in the energy norm, for the sake of the mesh.",
            100.0 * flow.flux_error
        ));
    }
    if compared.is_empty() {
        return;
    }
    page.text("Against the closed forms that the scene names:");
    let mut table = Table::new(&["measure", "fracture", "computed#", "exact#", "error#"]);
    for measure in compared.into_iter().take(MOST_ROWS) {
        let name = measure.name.replace('_', " ");
        let number = |value: Option<f64>| value.map_or_else(|| "–".into(), |v| format!("{v:.6e}"));
        let error = measure
            .error
            .map_or_else(String::new, |e| format!("{:.3} %", 100.0 * e));
        let numbers = [number(measure.value), number(measure.exact), error];
        table.row(
            &[&name, measure.fracture.as_deref().unwrap_or("")],
            &numbers,
        );
    }
    page.table(&table);
}

/// Adds how closely the increments follow the path of the loads, where it matters.
fn add_path_error(page: &mut Page, steps: &[StepSummary]) {
    let measures = steps.iter().filter_map(|step| step.measures.as_ref());
    let error: f64 = measures.map(|measures| measures.path_error).sum();
    if error > 0.0 {
        page.text(&format!(
            "Estimated error of the jumps for the sake of finite load increments, all steps added: {error:.2e} m."
        ));
    }
}

/// Adds the equivalent permeability of the body.
pub fn add_permeability(page: &mut Page, found: &PermeabilitySummary) {
    page.heading("Equivalent permeability");
    let mut table = Table::new(&["", "k#", "trend#", "plunge#"]);
    for (name, one) in ["largest", "middle", "least"]
        .iter()
        .zip(&found.tensor.principal)
    {
        let angles = [one.trend, one.plunge].map(|angle| format!("{angle:.1}°"));
        let [trend, plunge] = angles;
        table.row(&[name], &[format!("{:.4e} m²", one.value), trend, plunge]);
    }
    page.table(&table);
}

/// Adds what the results were made with and of, and where the time went.
pub fn add_provenance(page: &mut Page, summary: &Summary) {
    let made = &summary.provenance;
    page.heading("Made with");
    let commit = made.commit.as_ref().map(|commit| format!(" ({commit})"));
    let mut terms = vec![(
        "Kluft",
        summary.kluft.to_owned() + &commit.unwrap_or_default(),
    )];
    terms.extend(made.gmsh.clone().map(|version| ("gmsh", version)));
    terms.extend(made.command.clone().map(|command| ("called as", command)));
    terms.push(("began", made.began.clone()));
    let machine = &made.machine;
    let memory = machine
        .memory_bytes
        .map(|bytes| format!(", {}", memory::in_words(bytes)));
    terms.push((
        "machine",
        format!(
            "{}, {} cores{}, {}",
            machine.processor,
            machine.cores,
            memory.unwrap_or_default(),
            machine.system
        ),
    ));
    terms.push((
        "memory",
        format!(
            "{} at most",
            memory::in_words(summary.peak_memory_bytes as usize)
        ),
    ));
    let seconds = &summary.seconds;
    terms.push((
        "time",
        format!(
            "meshing {:.2} s, reading {:.2} s, assembling {:.2} s, factorising {:.2} s, solving {:.2} s, \
             estimating {:.2} s, writing {:.2} s; {:.2} s in all",
            seconds.mesh,
            seconds.read,
            seconds.enrich + seconds.assemble,
            seconds.factorise,
            seconds.solve,
            seconds.estimate,
            seconds.write,
            seconds.total
        ),
    ));
    for input in &made.inputs {
        terms.push((
            "made of",
            format!("{} (XXH3 {})", input.file, input.xxh3_128),
        ));
    }
    page.terms(&terms);
}
