//! The factor of safety.

use kluft_report::{Frame, Page, Surface, Table, quantity};

use crate::strength_summary::StrengthSummary;

/// Blocks that are named.
const MOST_LINES: usize = 100;
/// Rows of a table.
const MOST_ROWS: usize = 100;

/// Motion of a block, against the largest, that is shown.
const SMALL_MOTION: f64 = 1e-3;

/// What there is to show of a reduction of strength.
#[derive(Debug, Clone)]
pub struct StrengthShown {
    /// The fractures at the last stable factor, with their slip.
    pub stable: Surface,
    /// The fractures with the motion of blocks at the first failing factor, if one failed.
    pub failing: Option<Surface>,
    /// Lowest and highest coordinates of the body (m).
    pub body: [[f64; 3]; 2],
}

/// Adds how far strength could be reduced.
pub fn add(page: &mut Page, found: &StrengthSummary, shown: Option<&StrengthShown>) {
    page.heading("Factor of safety");
    let fractures = found.fractures.join(", ");
    page.text(&match found.failing {
        Some(failing) => format!(
            "With friction and cohesion of {fractures} divided by {:.4} everything holds; divided by \
             {failing:.4} it does not: {}.",
            found.stable,
            found.failure.as_deref().unwrap_or("it fails")
        ),
        None => format!(
            "With friction and cohesion of {fractures} divided by {:.4}, where the search ends, \
             everything holds.",
            found.stable
        ),
    });
    page.list(
        found
            .free_blocks
            .iter()
            .take(MOST_LINES)
            .map(String::as_str),
    );
    failing_blocks(page, found);
    if let Some(shown) = shown {
        pictures(page, shown);
    }
    trials(page, found);
    blocks(page, found);
}

/// The blocks that move at the first failing factor.
fn failing_blocks(page: &mut Page, found: &StrengthSummary) {
    let moves = |size: f64| size > SMALL_MOTION;
    let all = found.failing_motions.iter();
    let moving: Vec<_> = all
        .filter(|motion| moves(length(motion.displacement)))
        .collect();
    if moving.is_empty() {
        return;
    }
    page.text("Blocks that move there, with their motion, the largest of a point being 1:");
    let mut table = Table::new(&["block", "volume#", "x#", "y#", "z#", "rotation (1/m)#"]);
    for motion in moving.into_iter().take(MOST_ROWS) {
        let [x, y, z] = motion.displacement.map(|u| format!("{u:.4}"));
        let rotation = format!("{:.3e}", length(motion.rotation));
        let numbers = [quantity(motion.volume, "m³"), x, y, z, rotation];
        table.row(&[&motion.block.to_string()], &numbers);
    }
    page.table(&table);
}

fn length(vector: [f64; 3]) -> f64 {
    vector.map(|x| x * x).iter().sum::<f64>().sqrt()
}

fn pictures(page: &mut Page, shown: &StrengthShown) {
    let title = "Slip at the last stable factor";
    let stable = picture(&shown.stable, shown.body, ("slip", title, "m"));
    let title =
        "Motion of blocks across fractures at the first failing factor, the largest being 1";
    let failing = shown.failing.as_ref();
    let failing = failing.and_then(|own| picture(own, shown.body, ("motion", title, "")));
    let pictures: Vec<_> = stable.into_iter().chain(failing).collect();
    if !pictures.is_empty() {
        page.pictures(&pictures);
        page.remark("strength_motion.vtu shows the motion of the blocks in ParaView.");
    }
}

fn picture(
    surface: &Surface,
    body: [[f64; 3]; 2],
    (field, title, unit): (&str, &str, &str),
) -> Option<kluft_report::Picture> {
    match surface.is_empty() {
        true => None,
        false => Frame::of(surface, body).picture(field, title, unit),
    }
}

fn trials(page: &mut Page, found: &StrengthSummary) {
    let mut table = Table::new(&["factor#", "holds", "Newton#", "largest motion#"]);
    for trial in found.trials.iter().take(MOST_ROWS) {
        let motion = trial.largest_motion.map(|motion| quantity(motion, "m"));
        let numbers = [
            trial.newton_iterations.to_string(),
            motion.unwrap_or_else(|| "–".into()),
        ];
        let holds = if trial.stable { "yes" } else { "no" };
        table.row(&[&format!("{:.4}", trial.factor), holds], &numbers);
    }
    page.table(&table);
}

/// The blocks that moved most on the way to the last stable factor.
fn blocks(page: &mut Page, found: &StrengthSummary) {
    const MOST_BLOCKS: usize = 20;
    let mut moved: Vec<_> = found.motions.iter().collect();
    moved.sort_by(|a, b| length(b.displacement).total_cmp(&length(a.displacement)));
    let mut table = Table::new(&["block", "volume#", "mean x#", "y#", "z#", "rotation#"]);
    for motion in moved.iter().take(MOST_BLOCKS) {
        let [x, y, z] = motion.displacement.map(|u| quantity(u, "m"));
        let rotation = format!("{:.3e}", length(motion.rotation));
        let numbers = [quantity(motion.volume, "m³"), x, y, z, rotation];
        table.row(&[&motion.block.to_string()], &numbers);
    }
    if !moved.is_empty() {
        page.text("Motions of blocks from full strength to the last stable factor:");
        page.table(&table);
    }
    if moved.len() > MOST_BLOCKS {
        let left = moved.len() - MOST_BLOCKS;
        page.remark(&format!(
            "{left} more blocks, which moved less, are in summary.json."
        ));
    }
}
