//! The fractures in the report of an inspection.

use crate::printing::{in_nine, shortened};

use super::findings::{CellFinding, FractureFinding, Inspection, SectorCounts};
use super::lines::{at, head_line, line, short};

/// Fractures that have a line each.
const LINES: usize = 20;
/// So many are described whatever the form.
const FEW: usize = 3;
/// Fractures that are described.
const DESCRIBED: usize = 30;
/// Characters of a name in the table.
const NAME: usize = 24;

/// The fractures: described, or of many in the short form a line each.
pub fn of(out: &mut String, inspection: &Inspection, is_long: bool) {
    match is_long || inspection.fractures.len() <= FEW {
        true => described(out, inspection),
        false => table(out, inspection),
    }
}

fn described(out: &mut String, inspection: &Inspection) {
    for fracture in inspection.fractures.iter().take(DESCRIBED) {
        head_line(out, &format!("fracture   {}", short(&fracture.name)));
        fracture_lines(out, fracture);
    }
    let more = inspection.fractures.len().saturating_sub(DESCRIBED);
    if more > 0 {
        head_line(
            out,
            &format!("... and {more} more fractures (--json lists them)"),
        );
    }
}

/// A line for each fracture.
fn table(out: &mut String, inspection: &Inspection) {
    head_line(
        out,
        &format!(
            "{:<NAME$}  {:>9}  {:>7}  {:>5}  {:>9}  {:>9}",
            "fracture", "m2", "facets", "dip", "direction", "tips [m]"
        ),
    );
    let angle = |angle: Option<f64>| angle.map_or("-".to_owned(), |angle| format!("{angle:.1}"));
    for fracture in inspection.fractures.iter().take(LINES) {
        let row = format!(
            "{:<NAME$}  {:>9}  {:>7}  {:>5}  {:>9}  {:>9}",
            shortened(&fracture.name, NAME),
            in_nine(fracture.area),
            fracture.facets,
            angle(fracture.dip),
            angle(fracture.dip_direction),
            in_nine(fracture.tip_length)
        );
        line(out, &row);
    }
    let more = inspection.fractures.len().saturating_sub(LINES);
    let more = match more {
        0 => String::new(),
        count => format!("... and {count} more; "),
    };
    line(out, &format!("{more}-v describes them, --json has all"));
}

fn fracture_lines(out: &mut String, fracture: &FractureFinding) {
    let surface = if fracture.closed { "closed" } else { "open" };
    let components = match fracture.components {
        1 => String::new(),
        count => format!(" in {count} components"),
    };
    line(
        out,
        &format!(
            "  {:.6} m2, {} facets, {surface} surface{components}",
            fracture.area, fracture.facets
        ),
    );
    if let (Some(dip), Some(direction), Some(deviation)) =
        (fracture.dip, fracture.dip_direction, fracture.deviation)
    {
        let shape = match deviation < 1e-3 {
            true => "plane".to_owned(),
            false => format!("facets up to {deviation:.1} degrees off that plane"),
        };
        line(
            out,
            &format!("  dip {dip:.1}, dip direction {direction:.1} degrees; {shape}"),
        );
    }
    line(
        out,
        &format!(
            "  tips {:.4} m ({} edges), on the outer surface {:.4} m ({} edges)",
            fracture.tip_length, fracture.tip_edges, fracture.trace_length, fracture.trace_edges
        ),
    );
    if fracture.branching_length > 0.0 {
        line(
            out,
            &format!("  crosses itself along {:.4} m", fracture.branching_length),
        );
    }
    if fracture.junction_nodes != SectorCounts::default() {
        line(
            out,
            &format!("  junctions: {}", sectors(&fracture.junction_nodes)),
        );
    }
    if fracture.unresolved_facets > 0 {
        line(
            out,
            &format!(
                "  {} facets without a jump of their own",
                fracture.unresolved_facets
            ),
        );
    }
    if let Some(cell) = &fracture.worst_cell {
        line(out, &format!("  worst cell {}", cell_text(cell)));
    }
}

/// How many nodes of junctions have how many sectors.
pub fn sectors(counts: &SectorCounts) -> String {
    let named = [
        ("3", counts.three),
        ("4", counts.four),
        ("5", counts.five),
        ("6", counts.six),
        ("7", counts.seven),
        ("8 or more", counts.many),
    ];
    let present = named.into_iter().filter(|(_, count)| *count > 0);
    let parts = present.map(|(sectors, count)| format!("{count} nodes with {sectors} sectors"));
    parts.collect::<Vec<_>>().join(", ")
}

/// A cell with what makes it good or bad.
pub fn cell_text(cell: &CellFinding) -> String {
    let fractures = match cell.fractures.is_empty() {
        true => String::new(),
        false => {
            let names: Vec<String> = cell.fractures.iter().map(|name| short(name)).collect();
            format!(", at {}", names.join(", "))
        }
    };
    format!(
        "{}: quality {:.3}, dihedral angles {:.1} to {:.1} degrees, at {}{fractures}",
        cell.tag,
        cell.quality,
        cell.smallest_angle,
        cell.largest_angle,
        at(cell.at)
    )
}
