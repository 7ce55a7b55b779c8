//! `study.csv`: one line a setting.

use std::path::Path;

use kluft_io::write_atomically;
use kluft_mesh::Defect;

use super::assess::Assessment;
use super::point::{Numbers, PointOutcome, PointRecord};
use super::under_way::Study;
use crate::printing::cell;

/// Writes the table.
///
/// # Errors
/// If the file cannot be written.
pub(super) fn write(path: &Path, study: &Study, found: &Assessment) -> Result<(), Defect> {
    let rows = rows(study, found);
    write_atomically(path, |out| {
        let mut table = csv::Writer::from_writer(out);
        for row in rows {
            table.write_record(row.iter().map(|text| cell(text)))?;
        }
        table.flush()
    })
}

/// Heads, and one line a setting; what is not known is empty.
fn rows(study: &Study, found: &Assessment) -> Vec<Vec<String>> {
    let measures = measures(&study.records);
    let dimensions = study.plan.dimensions.iter();
    let mut head = vec!["folder".to_owned()];
    head.extend(dimensions.map(|dimension| dimension.name.clone()));
    let fixed = "cells,unknowns,jump_unknowns,newton_iterations,linear_iterations,seconds,\
        meshing_seconds,peak_memory_bytes,value,reference,reference_uncertainty,error,front,failed";
    head.extend(fixed.split(',').map(str::to_owned));
    for measure in &measures {
        head.extend(["", ".exact", ".error"].map(|part| format!("{measure}{part}")));
    }
    let front = study.front(found);
    let row = |i: usize| row(study, found, &measures, i, front.contains(&i));
    let rows = (0..study.plan.settings.len()).map(row);
    [head].into_iter().chain(rows).collect()
}

fn row(
    study: &Study,
    found: &Assessment,
    measures: &[String],
    index: usize,
    is_front: bool,
) -> Vec<String> {
    let setting = &study.plan.settings[index];
    let mut row = vec![study.folders[index].clone()];
    let labels = (0..setting.choices.len()).map(|i| study.plan.label(setting, i).to_owned());
    row.extend(labels);
    let record = study.records[index].as_ref();
    let numbers = record.and_then(PointRecord::numbers);
    row.extend(numbers.map_or_else(|| vec![String::new(); 8], counts));
    let verdict = found.verdicts[index];
    let text =
        |number: Option<f64>| number.map_or_else(String::new, |number| format!("{number:e}"));
    let has_reference = verdict
        .reference
        .or(verdict.error)
        .map(|_| verdict.uncertainty);
    let judged = [
        verdict.value,
        verdict.reference,
        has_reference,
        verdict.error,
    ];
    row.extend(judged.map(text));
    row.push(if is_front { "yes" } else { "" }.into());
    row.push(match record.map(|record| &record.outcome) {
        Some(PointOutcome::Failed(why)) => why.clone(),
        Some(PointOutcome::Solved(_)) => String::new(),
        None => "not run".into(),
    });
    for name in measures {
        let own = numbers.and_then(|numbers| {
            let mut all = numbers.measures.iter();
            all.find(|measure| name_of(measure) == *name)
        });
        let parts = own.map_or([None; 3], |own| [own.value, own.exact, own.error]);
        row.extend(parts.map(text));
    }
    row
}

fn counts(numbers: &Numbers) -> Vec<String> {
    vec![
        numbers.cells.to_string(),
        numbers.unknowns.to_string(),
        numbers.jump_unknowns.to_string(),
        numbers.newton_iterations.to_string(),
        numbers.linear_iterations.to_string(),
        format!("{:.4}", numbers.seconds),
        format!("{:.4}", numbers.meshing_seconds),
        numbers.peak_memory_bytes.to_string(),
    ]
}

fn name_of(measure: &kluft_run::Measure) -> String {
    match &measure.fracture {
        Some(fracture) => format!("{fracture}.{}", measure.name),
        None => measure.name.clone(),
    }
}

/// The names of all measures of all runs, in their order.
fn measures(records: &[Option<PointRecord>]) -> Vec<String> {
    let mut names = Vec::new();
    let solved = records.iter().flatten().filter_map(PointRecord::numbers);
    for measure in solved.flat_map(|numbers| &numbers.measures) {
        let name = name_of(measure);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}
