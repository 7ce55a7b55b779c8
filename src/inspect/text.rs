//! The report of an inspection as text.

use std::fmt::Write;

use kluft_run::memory;

use crate::defects::SHOWN as SHOWN_DEFECTS;
use crate::printing::{one_line, shortened, wrapped};

use super::findings::{BlockFinding, GroupFinding, Inspection, SolverFinding};
use super::fractures::{self, cell_text, sectors};
use super::hydraulics;
use super::lines::{at, head_line, line, list, short};

/// Groups that are listed, and in the long form.
const GROUPS: [usize; 2] = [20, 60];
/// Worst cells that are listed, and in the long form.
const WORST: [usize; 2] = [1, 3];
/// Characters of a name in the table of groups.
const NAME: usize = 24;

/// The report, in the short or in the long form.
pub fn of(inspection: &Inspection, is_long: bool) -> String {
    let mut text = String::new();
    let out = &mut text;
    head(out, inspection);
    groups(out, inspection, GROUPS[usize::from(is_long)]);
    doubled(out, inspection);
    fractures::of(out, inspection, is_long);
    contacts(out, inspection);
    patches(out, inspection);
    blocks(out, inspection);
    if let Some(found) = &inspection.hydraulics {
        head_line(out, &hydraulics::head(found));
        list(out, &hydraulics::networks(found), String::clone);
    }
    cells(out, inspection, is_long);
    unknowns(out, inspection);
    for solver in &inspection.solvers {
        cost(out, solver);
    }
    walls(out, inspection);
    if !inspection.decisions.is_empty() {
        head_line(out, "decided");
        list(out, &inspection.decisions, |decision| {
            format!("  {decision}")
        });
    }
    let defects = inspection.defects.len();
    if defects > SHOWN_DEFECTS {
        head_line(
            out,
            &format!("defects    {defects}, all of them in inspect.json"),
        );
    }
    if !inspection.warnings.is_empty() {
        head_line(out, "warnings");
        list(out, &inspection.warnings, |warning| format!("  {warning}"));
    }
    text
}

fn head(out: &mut String, inspection: &Inspection) {
    let title = inspection
        .title
        .as_deref()
        .unwrap_or("a mesh without a scene");
    line(out, &format!("kluft      {}  {title}", inspection.kluft));
    let mesh = &inspection.mesh;
    let size = format!(
        "{} nodes, {} cells, {} surface elements",
        mesh.nodes, mesh.cells, mesh.facets
    );
    let place = mesh
        .bounds
        .map(|[low, high]| format!(", from {} to {} m", at(low), at(high)));
    line(
        out,
        &format!("mesh       {size}{}", place.unwrap_or_default()),
    );
}

fn groups(out: &mut String, inspection: &Inspection, most: usize) {
    if inspection.groups.is_empty() {
        return head_line(out, "no physical groups");
    }
    let name = |group: &GroupFinding| shortened(&group.name, NAME);
    let widths = inspection
        .groups
        .iter()
        .map(|group| name(group).chars().count());
    let width = widths.max().unwrap_or(0).max(5);
    head_line(
        out,
        &format!("{:<width$}  dimension  elements  role", "group"),
    );
    for group in inspection.groups.iter().take(most) {
        let elements = group
            .elements
            .map_or("-".to_owned(), |count| count.to_string());
        let start = format!(
            "{:<width$}  {:>9}  {elements:>8}  {:<8}  ",
            name(group),
            group.dimension,
            group.role
        );
        let indent = start.chars().count();
        let row = wrapped(&one_line(&(start + &group.detail)), indent);
        let _ = writeln!(out, "{row}");
    }
    let more = inspection.groups.len().saturating_sub(most);
    if more > 0 {
        line(out, &format!("... and {more} more (--json lists them)"));
    }
}

fn doubled(out: &mut String, inspection: &Inspection) {
    if inspection.doubled_surfaces.is_empty() {
        return;
    }
    head_line(out, "outer faces that lie on one another");
    list(out, &inspection.doubled_surfaces, |surface| {
        let kind = match surface.kind {
            "doubled nodes" => "nodes are doubled",
            "not matching" => "nodes do not match",
            _ => "rock on the same side",
        };
        format!(
            "  {}: {} faces, {:.6} m2, one of the largest at {}, {kind}",
            surface.between(),
            surface.faces,
            surface.area,
            at(surface.at)
        )
    });
}

fn contacts(out: &mut String, inspection: &Inspection) {
    if inspection.contacts.is_empty() {
        return;
    }
    head_line(out, "fractures that meet");
    list(out, &inspection.contacts, |contact| {
        let [first, second] = contact.fractures.each_ref().map(|name| short(name));
        let kind = match contact.kind {
            "first ends on second" => format!("{first} ends on {second}"),
            "second ends on first" => format!("{second} ends on {first}"),
            "rim to rim" => format!("{first} and {second} share a rim"),
            "touches" => format!("{first} touches {second}"),
            _ => format!("{first} crosses {second}"),
        };
        let length = contact.crossing_length
            + contact.first_ends_length
            + contact.second_ends_length
            + contact.rim_length;
        let angle = contact.smallest_angle.map_or(String::new(), |angle| {
            format!(
                ", at {angle:.1} degrees or more, least at {}",
                at(contact.at)
            )
        });
        format!(
            "  {kind} along {length:.4} m ({} nodes){angle}",
            contact.nodes
        )
    });
}

fn patches(out: &mut String, inspection: &Inspection) {
    if inspection.unresolved_patches.is_empty() {
        return;
    }
    head_line(out, "patches with no jump of their own");
    list(out, &inspection.unresolved_patches, |patch| {
        let what = if patch.whole {
            "a whole component"
        } else {
            "part of a component"
        };
        format!(
            "  {}: {} facets, {:.4e} m2 at {}, {what}",
            short(&patch.fracture),
            patch.facets,
            patch.area,
            at(patch.at)
        )
    });
}

fn blocks(out: &mut String, inspection: &Inspection) {
    let blocks = &inspection.blocks;
    if blocks.len() < 2 {
        return;
    }
    let loose = blocks
        .iter()
        .filter(|block| block.held_by_fractures_only == Some(true));
    let loose = match inspection.unknowns.is_some() && blocks[0].supported.is_some() {
        true => format!(", {} of them held by fractures only", loose.count()),
        false => String::new(),
    };
    let what = match inspection.fractures.is_empty() {
        true => "parts of rock that share no faces",
        false => "blocks that fractures cut free",
    };
    head_line(out, &format!("{} {what}{loose}", blocks.len()));
    list(out, blocks, block_text);
}

fn block_text(block: &BlockFinding) -> String {
    let [low, high] = block.bounds;
    let held = match (block.supported, block.held_by_fractures_only) {
        (Some(true), _) => ", supported",
        (_, Some(true)) => ", held by fractures only",
        (Some(false), _) => ", not supported",
        _ => "",
    };
    let loaded = if block.loaded == Some(true) {
        ", loaded"
    } else {
        ""
    };
    format!(
        "  {:.6} m3, {} cells, from {} to {}{held}{loaded}",
        block.volume,
        block.cells,
        at(low),
        at(high)
    )
}

fn cells(out: &mut String, inspection: &Inspection, is_long: bool) {
    let Some(cells) = &inspection.cells else {
        return;
    };
    head_line(
        out,
        &format!(
            "cells      mean quality {:.3} (1 is regular, 0 is flat)",
            cells.mean_quality
        ),
    );
    line(
        out,
        &format!("  in tenths from 0 to 1: {:?}", cells.histogram),
    );
    let count = WORST[usize::from(is_long)];
    for cell in cells.worst.iter().take(count) {
        line(out, &format!("  worst {}", cell_text(cell)));
    }
    for cell in cells.worst_at_fractures.iter().take(count) {
        line(out, &format!("  worst at fractures {}", cell_text(cell)));
    }
}

fn unknowns(out: &mut String, inspection: &Inspection) {
    let Some(unknowns) = &inspection.unknowns else {
        return;
    };
    let held = match unknowns.without_held {
        true => "held ones left out",
        false => "without any supports",
    };
    head_line(
        out,
        &format!(
            "unknowns   {} ({held}), {} of them jumps",
            unknowns.total, unknowns.jumps
        ),
    );
    let junctions = sectors(&unknowns.junction_nodes);
    let junctions = if junctions.is_empty() {
        junctions
    } else {
        format!(", {junctions}")
    };
    line(
        out,
        &format!(
            "  {} nodes with one sector, {} inside a fracture{junctions}",
            unknowns.plain_nodes, unknowns.fracture_nodes
        ),
    );
}

fn cost(out: &mut String, solver: &SolverFinding) {
    let choice = if solver.is_chosen { ", chosen" } else { "" };
    line(
        out,
        &format!(
            "solver     {}{choice}, predicted: {}, {:.2} s for the run on an ordinary machine",
            solver.name,
            memory::in_words(solver.memory_bytes),
            solver.seconds
        ),
    );
    if solver.factor_entries > 0 {
        line(
            out,
            &format!(
                "  {:.3e} entries in the factor, {:.3e} operations",
                solver.factor_entries as f64, solver.operations
            ),
        );
    }
}

fn walls(out: &mut String, inspection: &Inspection) {
    if inspection.walls.is_empty() {
        return;
    }
    head_line(
        out,
        "walls      do they pass through each other? (an estimate from the loads)",
    );
    list(out, &inspection.walls, |wall| {
        let limit = wall.limit.map_or("they never meet".to_owned(), |limit| {
            format!("they meet at {limit:.3e} Pa")
        });
        let expected = wall
            .expected
            .map_or("unknown: displacements are prescribed".into(), |load| {
                format!("the loads suggest {load:.3e} Pa")
            });
        let verdict = wall.overlap;
        format!(
            "  {}: {verdict} ({}; {limit}, {expected})",
            short(&wall.fracture),
            wall.law
        )
    });
}
