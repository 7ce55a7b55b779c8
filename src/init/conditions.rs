//! What holds and loads the body, as far as its outer surface suggests it.

use glam::DVec3;
use kluft_keys::section_head;
use kluft_mesh::Mesh;

use super::lines::Lines;
use super::supports::{Assumed, assumed, axes};

/// Adds a section for each part of the outer surface, and what is missing beside them; whether they
/// hold the body.
pub fn conditions(out: &mut Lines, mesh: &Mesh) -> bool {
    let assumed = assumed(mesh);
    for (part, assumed) in mesh.boundaries.iter().zip(&assumed) {
        boundary(out, &part.name, *assumed);
    }
    let misses = |wanted: Assumed| !assumed.contains(&wanted);
    let axes = axes(mesh).iter().copied();
    let loose: Vec<&str> = axes.filter(|&axis| misses(Assumed::Roller(axis))).collect();
    let is_held = hold(out, mesh, &loose);
    if misses(Assumed::Pressed) {
        out.section("# No flat top was found: give a surface above a pressure, or let gravity act (`kluft explain gravity`).", "");
    }
    is_held
}

fn boundary(out: &mut Lines, name: &str, assumed: Assumed) {
    let head = section_head("boundary", name);
    match assumed {
        Assumed::Roller(axis) => {
            out.section(
                &head,
                &format!("assumed: a roller at the lower end of {axis}"),
            );
            out.add("symmetry = true", "");
        }
        Assumed::Pressed => {
            out.section(&head, "the top");
            out.add("pressure = \"10 MPa\"", "assumed");
        }
        Assumed::Free(why) => {
            out.section(&format!("# {head}"), &format!("free: {why}"));
            out.add(
                "# pressure = \"1 MPa\"",
                "or symmetry = true, displacement = { x = 0 }",
            );
        }
    }
}

/// Holds the body along the axes along which no roller does, or says that it takes more than a
/// node; whether it is held.
fn hold(out: &mut Lines, mesh: &Mesh, loose: &[&str]) -> bool {
    match *loose {
        [] => {}
        [axis] => fixed_point(out, mesh, axis),
        _ => {
            let text = "# Too little was found that holds the body: give surfaces above";
            out.section(text, "");
            out.add("# `symmetry = true`, or add [[fixed_point]] sections.", "");
        }
    }
    loose.len() < 2
}

/// Holds a node at the lowest corner of the body along an axis; rollers along the others keep it
/// from turning.
fn fixed_point(out: &mut Lines, mesh: &Mesh, axis: &str) {
    let (low, _) = mesh.bounds();
    let distance = |node: &DVec3| node.distance_squared(low);
    let nodes = mesh.nodes.iter();
    let nearest = nodes.min_by(|a, b| distance(a).total_cmp(&distance(b)));
    let Some(DVec3 { x, y, z }) = nearest else {
        return;
    };
    let why = format!("assumed: no roller holds the body along {axis}");
    out.section("[[fixed_point]]", &why);
    out.add(&format!("at = [{x:?}, {y:?}, {z:?}]"), "");
    out.add(&format!("displacement = {{ {axis} = 0.0 }}"), "");
}
