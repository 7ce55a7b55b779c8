//! Meshes whose outer faces have no names, whose coordinates are not metres, and whose groups share
//! a name.

use std::collections::BTreeMap;
use std::fs;

use serde_json::Value;

use crate::harness::{Run, Workshop, edited, kluft, root, summary};

const BASE: &str = include_str!("bad_input/base.toml");
const MESH: &str = include_str!("bad_input/base.msh");

fn base(edits: &[(&str, &str)], mesh: &str) -> Workshop {
    let workshop = Workshop::of(&edited(BASE, edits));
    fs::write(workshop.path("base.msh"), mesh).expect("the mesh is written");
    workshop
}

fn refused(edits: &[(&str, &str)], mesh: &str) -> String {
    let Run { code, err, .. } = base(edits, mesh).run("out", &[]);
    assert_eq!(code, Some(2), "{err}");
    err
}

fn joint(summary: &Value, key: &str) -> f64 {
    let joint = &summary["fractures"]["joint"];
    let value = key.split(' ').fold(joint, |value, part| &value[part]);
    value.as_f64().unwrap_or_else(|| panic!("{key}: {joint}"))
}

/// The closed form in the scene: an opening of -8.012084965284744e-06 m under 7 kPa from above.
#[test]
fn faces_found_by_their_place_carry_loads_and_supports() {
    let edits = [
        ("[boundary.top]\n", "[boundary.lid]\nwhere = \"z = max\"\n"),
        (
            "[boundary.bottom]\n",
            "[boundary.floor]\nwhere = \"z = 0, x >= 0\"\n",
        ),
        ("[boundary.front]\n", "[boundary.a]\nwhere = \"y = min\"\n"),
        ("[boundary.back]\n", "[boundary.b]\nwhere = \"y = max\"\n"),
        ("h = 0.2", "h = 0.4"),
    ];
    let workshop = Workshop::new("inclined-joint", &edits);
    let run = kluft(&["inspect".as_ref(), workshop.scene().as_os_str()]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!(run.out.contains("lid"), "{}", run.out);
    let found = summary(&workshop.solve("out", &[]));
    let decisions = found["decisions"].to_string();
    assert!(
        decisions.contains("outer faces where z = max"),
        "{decisions}"
    );
    for end in ["aperture min", "aperture max"] {
        let opening = joint(&found, end) - 1e-5;
        assert!(
            (opening / -8.012_084_965_284_744e-6 - 1.0).abs() < 1e-9,
            "{end}: {opening:e}"
        );
    }
}

#[test]
fn places_without_faces_and_names_that_are_taken_are_refused() {
    let with = |line: &str| refused(&[("[boundary.top]\n", line)], MESH);
    let nothing = with("[boundary.lid]\nwhere = \"z = 7\"\n");
    for part in [
        "[boundary.lid]",
        "no outer face lies where z = 7",
        "(1.000000, 1.000000, 1.000000)",
    ] {
        assert!(nothing.contains(part), "{nothing}");
    }
    let taken = with("[boundary.top]\nwhere = \"z = max\"\n");
    assert!(
        taken.contains("has a physical surface `top` already"),
        "{taken}"
    );
    let wrong = with("[boundary.lid]\nwhere = \"z\"\n");
    assert!(wrong.contains("compares nothing"), "{wrong}");
}

/// A body twice as large with a joint half as stiff, under the same load, closes twice as far.
#[test]
fn coordinates_in_another_unit_are_converted() {
    let plain = summary(&base(&[], MESH).solve("out", &[]));
    let edits = [
        ("file = \"base.msh\"", "file = \"base.msh\"\nscale = 2"),
        ("aperture = 1e-4", "aperture = 2e-4"),
        ("normal_stiffness = 1e10", "normal_stiffness = 5e9"),
        ("shear_stiffness = 1e10", "shear_stiffness = 5e9"),
    ];
    let doubled = summary(&base(&edits, MESH).solve("out", &[]));
    let [one, other] = [&plain, &doubled].map(|summary| joint(summary, "aperture mean"));
    assert!(
        (other / (2.0 * one) - 1.0).abs() < 1e-12,
        "{one:e} {other:e}"
    );
    let [one, other] = [&plain, &doubled].map(|summary| joint(summary, "area"));
    assert!(
        (other / (4.0 * one) - 1.0).abs() < 1e-12,
        "{one:e} {other:e}"
    );
}

#[test]
fn two_groups_of_one_name_are_told_and_not_taken_for_one_of_them() {
    let mesh = MESH.replace("2 2 \"top\"", "2 2 \"bottom\"");
    let said = refused(&[("[boundary.top]\ntraction = [0, 0, -1e5]\n", "")], &mesh);
    for part in [
        "2 physical surfaces are called `bottom`",
        "2, 3",
        "a name of its own",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    let workshop = base(&[], &mesh);
    let run = kluft(&["inspect".as_ref(), workshop.path("base.msh").as_os_str()]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let told = run.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        told.contains("2 physical surfaces are called `bottom`"),
        "{told}"
    );
}

/// Under 7 kPa on one square metre the floor sinks by 7 um on a bed of 1 GPa/m, on the whole, and
/// the bed carries the load.
#[test]
fn a_bed_of_springs_gives_way_by_the_load_over_its_stiffness() {
    let edits = [
        (
            "[boundary.bottom]\ndisplacement = { z = 0.0 }",
            "[boundary.bottom]\nspring = 1e9\nshear_spring = { expression = \"1e8\" }",
        ),
        (
            "[[fixed_point]]\nat = [0.0, 0.0, 0.0]\ndisplacement = { x = 0.0 }\n",
            "",
        ),
        ("h = 0.2", "h = 0.4"),
    ];
    let workshop = Workshop::new("inclined-joint", &edits);
    let out = workshop.solve("out", &[]);
    let text = fs::read_to_string(out.join("history.csv")).expect("a history");
    let mut table = csv::Reader::from_reader(text.as_bytes());
    let rows = table.deserialize().map(|row| row.expect("a row"));
    let mut rows = rows.filter(|row: &BTreeMap<String, String>| row["name"] == "bottom");
    let floor = rows.next().expect("the floor");
    let number = |column: &str| floor[column].parse::<f64>().expect(column);
    assert!(
        (number("displacement_z") / -7e-6 - 1.0).abs() < 1e-9,
        "{floor:?}"
    );
    assert!((number("force_z") / 7e3 - 1.0).abs() < 1e-9, "{floor:?}");
    assert!(number("displacement_x").abs() < 1e-9 * 7e-6, "{floor:?}");
}

#[test]
fn springs_that_hold_nothing_or_contradict_each_other_are_refused() {
    let slides = [
        (
            "displacement = { z = 0.0 }",
            "spring = 1e9\nshear_spring = 0",
        ),
        (
            "[[fixed_point]]\nat = [0.0, 0.0, 0.0]\ndisplacement = { x = 0.0 }\n",
            "",
        ),
        ("h = 0.2", "h = 0.4"),
    ];
    let slides = Workshop::new("inclined-joint", &slides).run("out", &[]).err;
    let with = |line: &str| {
        let edit = ("displacement = { x = 0.0, y = 0.0, z = 0.0 }", line);
        refused(&[edit], MESH)
    };
    assert!(slides.contains("nothing holds it"), "{slides}");
    let both = with("spring = 1e9\nfar_field = [0, 0, 0]");
    assert!(both.contains("both spring and far_field"), "{both}");
    let alone = with("shear_spring = 1e9");
    assert!(alone.contains("without `spring`"), "{alone}");
    let beside = with("far_field = [-1, -1, -4]");
    assert!(
        beside.contains("lies on these faces or outside"),
        "{beside}"
    );
}

/// Largest opening of the disc of `small-cube` in a cube of twice its size over that of Sneddon
/// (1946), less one. Every side has one condition, or none.
fn disc_in_a_cube(side: &str) -> f64 {
    let text = fs::read_to_string(root().join("geometries/small-cube/scene.toml"));
    let text = text.expect("the scene");
    let disc = text.split("# Three corners").next().expect("a beginning");
    let geometry = root().join("geometries/penny/penny.geo");
    let edits = [
        ("../penny/penny.geo", &geometry.display().to_string()[..]),
        (
            "{ h = 0.28, h_disc = 0.28, h_far = 0.28, grow = 0, half = 3 }",
            "{ h = 0.15, h_disc = 0.3, h_far = 1.2, grow = 0.5, half = 2 }",
        ),
    ];
    let names = ["left", "right", "front", "back", "bottom", "top"];
    let sides = names.map(|name| format!("[boundary.{name}]\n{side}\n"));
    let workshop = Workshop::of(&(edited(disc, &edits) + &sides.concat()));
    let found = summary(&workshop.solve("out", &[]));
    let most = found["fractures"]["penny"]["aperture"]["max"].as_f64();
    let sneddon = 8.0 * (1.0 - 0.25 * 0.25) * 2e6 / (std::f64::consts::PI * 25e9);
    (most.expect("an aperture") - 1e-5) / sneddon - 1.0
}

/// Springs of unbounded rock leave what the mesh does, half a per cent; held sides a tenth.
#[test]
fn a_far_field_takes_the_box_off_a_disc() {
    let springs = disc_in_a_cube("far_field = [0, 0, 0]");
    assert!(springs.abs() < 0.01, "{springs}");
    let held = disc_in_a_cube("displacement = { x = 0.0, y = 0.0, z = 0.0 }");
    assert!(held < -0.08, "{held}");
}
