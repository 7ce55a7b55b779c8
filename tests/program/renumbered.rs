//! A mesh file lists its nodes in any order and numbers them as it likes.

use std::fs;
use std::process::Command;

use serde_json::Value;

use crate::harness::{Workshop, summary};

/// The sections of a text mesh that gmsh makes of the geometry.
fn text_mesh(workshop: &Workshop) -> String {
    let mesh = workshop.path("original.msh");
    let gmsh = std::env::var("KLUFT_GMSH").unwrap_or_else(|_| "gmsh".into());
    let output = Command::new(gmsh)
        .arg(workshop.path("inclined-joint.geo"))
        .args(["-3", "-format", "msh41", "-o"])
        .arg(&mesh)
        .output();
    assert!(output.expect("gmsh starts").status.success());
    fs::read_to_string(mesh).expect("a text mesh")
}

/// The lines of a section without its markers, and what stands before and behind.
fn section<'t>(text: &'t str, name: &str) -> (&'t str, Vec<&'t str>, &'t str) {
    let begin = text.find(&format!("${name}\n")).expect("the section") + name.len() + 2;
    let end = text.find(&format!("$End{name}\n")).expect("its end");
    (
        &text[..begin],
        text[begin..end].lines().collect(),
        &text[end..],
    )
}

/// The nodes of every block the other way round: other lines, the same tags.
fn reversed_nodes(text: &str) -> String {
    let (before, lines, behind) = section(text, "Nodes");
    let mut kept: Vec<&str> = vec![lines[0]];
    let mut at = 1;
    while at < lines.len() {
        let count: usize = lines[at]
            .split(' ')
            .nth(3)
            .expect("a count")
            .parse()
            .expect("a number");
        kept.push(lines[at]);
        kept.extend(lines[at + 1..][..count].iter().rev());
        kept.extend(lines[at + 1 + count..][..count].iter().rev());
        at += 1 + 2 * count;
    }
    format!("{before}{}\n{behind}", kept.join("\n"))
}

/// Other tags on the same nodes: `largest + 1 - tag`.
fn renumbered_nodes(text: &str) -> String {
    let (before, lines, behind) = section(text, "Nodes");
    let largest: u64 = lines[0]
        .split(' ')
        .nth(3)
        .expect("a tag")
        .parse()
        .expect("a number");
    let other = |tag: &str| (largest + 1 - tag.parse::<u64>().expect("a tag")).to_string();
    let is_tag = |line: &&str| !line.contains(' ');
    let nodes: Vec<String> = lines
        .iter()
        .map(|line| {
            if is_tag(line) {
                other(line)
            } else {
                (*line).to_owned()
            }
        })
        .collect();
    let text = format!("{before}{}\n{behind}", nodes.join("\n"));
    let (before, lines, behind) = section(&text, "Elements");
    let mut elements = vec![lines[0].to_owned()];
    let mut at = 1;
    while at < lines.len() {
        let count: usize = lines[at]
            .split(' ')
            .nth(3)
            .expect("a count")
            .parse()
            .expect("a number");
        elements.push(lines[at].to_owned());
        elements.extend(lines[at + 1..][..count].iter().map(|line| {
            let mut words = line.split_whitespace();
            let tag = words.next().expect("an element tag").to_owned();
            words.fold(tag, |line, node| format!("{line} {}", other(node)))
        }));
        at += 1 + count;
    }
    format!("{before}{}\n{behind}", elements.join("\n"))
}

fn fractures(workshop: &Workshop, name: &str, mesh: &str) -> Value {
    fs::write(workshop.path("joint.msh"), mesh).expect("the mesh is written");
    summary(&workshop.solve(name, &[]))["fractures"].clone()
}

#[test]
fn the_order_of_nodes_and_their_numbers_do_not_matter() {
    let from_file = "geometry = \"inclined-joint.geo\"\nparameters = { h = 0.2, dip = 50 }";
    let workshop = Workshop::new("inclined-joint", &[(from_file, "file = \"joint.msh\"")]);
    let original = text_mesh(&workshop);
    let expected = fractures(&workshop, "original", &original);
    let renumbered = renumbered_nodes(&original);
    assert_ne!(renumbered, original);
    assert_eq!(fractures(&workshop, "renumbered", &renumbered), expected);
    // Another order of the unknowns rounds differently, and nothing else.
    let reversed = reversed_nodes(&original);
    assert_ne!(reversed, original);
    assert_close(&fractures(&workshop, "reversed", &reversed), &expected);
    let both = renumbered_nodes(&reversed);
    assert_close(&fractures(&workshop, "both", &both), &expected);
}

fn assert_close(found: &Value, expected: &Value) {
    for key in ["aperture", "normal_traction"] {
        for bound in ["min", "mean", "max"] {
            let [found, expected] = [found, expected].map(|value| &value["joint"][key][bound]);
            let values = found.as_f64().zip(expected.as_f64());
            let (found, expected) = values.expect("two numbers");
            let error = (found / expected - 1.0).abs();
            assert!(error < 1e-11, "{bound} {key}: {found} and {expected}");
        }
    }
}
