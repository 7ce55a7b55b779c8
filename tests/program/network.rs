//! `kluft network`: from a list or a description to a solved scene.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::harness::{Run, kluft, root, scratch, summary};

/// A wall that ends 0.1 m above a floor and pokes out of the domain, an ellipse that crosses both,
/// and a fracture outside.
const LIST: &str = "\
name, set, shape, x, y, z, dip, dip_direction, radius, semi_major, semi_minor, length, width, rotation, points
floor, flat, disc, 5, 5, 4, 10, 90, 3.5,,,,,,
wall, steep, rectangle, 5, 8, 6.6, 90, 90,,,, 6, 5, 0,
oval, steep, ellipse, 5, 5, 5, 60, 180,, 3, 2,,, 30,
far, steep, polygon,,,,,,,,,,,, 20 0 0; 21 0 0; 20 1 0
";

fn make(folder: &Path, input: &str, flags: &[&str]) -> Run {
    let (input, out) = (folder.join(input), folder.join("made"));
    let mut arguments = vec![
        "network".as_ref(),
        input.as_os_str(),
        "-o".as_ref(),
        out.as_os_str(),
    ];
    arguments.extend(flags.iter().map(std::ffi::OsStr::new));
    kluft(&arguments)
}

fn made(input: &str, text: &str, flags: &[&str]) -> tempfile::TempDir {
    let folder = scratch();
    fs::write(folder.path().join(input), text).expect("the input is written");
    let run = make(folder.path(), input, flags);
    assert_eq!(
        (run.code, run.err.as_str(), run.out.as_str()),
        (Some(0), "", "")
    );
    folder
}

fn refused(input: &str, text: &str) -> String {
    let folder = scratch();
    fs::write(folder.path().join(input), text).expect("the input is written");
    let run = make(folder.path(), input, &[]);
    assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{}", run.err);
    assert!(!folder.path().join("made/scene.toml").exists());
    run.err
}

/// `network.json` of a folder.
pub fn record(folder: &Path) -> Value {
    let text = fs::read_to_string(folder.join("network.json")).expect("network.json");
    serde_json::from_str(&text).expect("network.json is JSON")
}

/// Runs the scene of a folder, and holds the area of every fracture against the polygon's.
pub fn solve_and_compare(folder: &Path) -> Value {
    let scene = folder.join("scene.toml");
    let run = kluft(&["run".as_ref(), scene.as_os_str()]);
    assert_eq!(
        (run.code, run.err.as_str()),
        (Some(0), ""),
        "{}",
        folder.display()
    );
    let summary = summary(&folder.join("out"));
    let record = record(folder);
    let fractures = record["fractures"].as_array().expect("fractures");
    assert_eq!(
        summary["fractures"].as_object().expect("fractures").len(),
        fractures.len()
    );
    for fracture in fractures {
        let name = fracture["name"].as_str().expect("a name");
        let expected = fracture["area"].as_f64().expect("an area");
        let area = summary["fractures"][name]["area"]
            .as_f64()
            .expect("an area in the summary");
        assert!(
            (area / expected - 1.0).abs() < 1e-6,
            "{name}: {area} instead of {expected}"
        );
    }
    summary
}

#[test]
fn a_list_becomes_a_geometry_that_runs() {
    let folder = made(
        "list.csv",
        LIST,
        &["--domain", "0,0,0,10,10,10", "--h", "2"],
    );
    let folder = folder.path().join("made");
    let summary = solve_and_compare(&folder);
    assert_eq!(
        summary["fractures"].as_object().expect("fractures").len(),
        3
    );
    assert!(summary["mesh"]["max_sectors"].as_u64() >= Some(3));
    let record = record(&folder);
    assert_eq!(record["rejected"][0]["name"], "far");
    assert_eq!(record["rejected"][0]["reason"], "outside the domain");
    // The wall is 6 m long with 5 m inside, and its foot moves up or down onto the floor.
    let wall = &record["fractures"][1];
    assert!(
        !wall["changes"].as_array().expect("changes").is_empty(),
        "{wall}"
    );
    // Planes of 10 and 90 degrees: within its own, the foot moves to where they meet.
    let farthest = wall["farthest_move"].as_f64().expect("a move");
    let gap = record["gap"].as_f64().expect("a gap");
    assert!(farthest > 0.0 && farthest < 2.0 * gap, "{farthest}");
    let told = format!("moved by {farthest:.3e} m");
    let changes = wall["changes"].as_array().expect("changes").iter();
    assert!(
        changes
            .flat_map(|text| text.as_str())
            .any(|text| text.contains(&told))
    );
    assert_eq!(wall["area_given"].as_f64().map(f64::round), Some(30.0));
    assert_eq!(record["intersections"]["count"], 3);
}

#[test]
fn domains_of_all_sizes_run() {
    for side in [1e-3, 1e-2, 1e3] {
        let disc = |name: &str, [x, y, z, radius]: [f64; 4], angles: &str| {
            let [x, y, z, radius] = [x, y, z, radius].map(|length| length * side);
            format!("{name},disc,{x},{y},{z},{angles},{radius}\n")
        };
        let list = "name,shape,x,y,z,dip,dip_direction,radius\n".to_owned()
            + &disc("a", [0.5, 0.5, 0.45, 0.35], "20,90")
            + &disc("b", [0.55, 0.5, 0.5, 0.4], "70,180")
            + &disc("c", [0.3, 0.3, 0.5, 0.3], "45,30");
        let domain = format!("0,0,0,{side},{side},{side}");
        let h = (side / 4.0).to_string();
        let folder = made("list.csv", &list, &["--domain", &domain, "--h", &h]);
        let summary = solve_and_compare(&folder.path().join("made"));
        let fractures = summary["fractures"].as_object().expect("fractures");
        assert_eq!(fractures.len(), 3, "{side} m");
    }
}

#[test]
fn sets_may_be_the_groups() {
    let folder = made(
        "list.csv",
        LIST,
        &["--domain", "0,0,0,10,10,10", "--h", "3", "--group", "set"],
    );
    let folder = folder.path().join("made");
    let scene = folder.join("scene.toml");
    let run = kluft(&["run".as_ref(), scene.as_os_str()]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    let summary = summary(&folder.join("out"));
    let names: Vec<&String> = summary["fractures"]
        .as_object()
        .expect("fractures")
        .keys()
        .collect();
    assert_eq!(names, ["flat", "steep"]);
}

const RANDOM: &str = r#"
title = "random"
seed = 7
[domain]
low = [0, 0, 0]
high = [10, 8, 6]
[mesh]
h = 2.0
h_fracture = 1.0
[fracture_set.north]
aperture = 1e-3
normal_stiffness = 2e10
shear_stiffness = 1e10
closure = "logarithmic"
orientation = { dip = 80, dip_direction = 10, kappa = 30 }
size = { law = "power", exponent = 2.5, min = 1, max = 4 }
p32 = 0.3
[fracture_set.flat]
aperture = 5e-4
normal_stiffness = 4e10
shear_stiffness = 1e10
orientation = { dip = 10, dip_direction = 100, kappa = 50 }
size = { law = "lognormal", mean = 2, sd = 0.5, min = 1, max = 4 }
shape = "rectangle"
aspect = 1.5
count = 4
[fracture_set.faults]
aperture = 2e-3
normal_stiffness = 1e10
shear_stiffness = 1e9
fluid_pressure = 1e5
history = [[0, 0], [1, 0.5]]
[[fracture]]
name = "main"
set = "faults"
shape = "rectangle"
centre = [5, 4, 3]
dip = 65
dip_direction = 270
length = 20
width = 20
[rock.rock]
young_modulus = 30e9
poisson_ratio = 0.2
[boundary.bottom]
displacement = { x = 0.0, y = 0.0, z = 0.0 }
[boundary.top]
traction = [1e6, 0, -5e6]
[[load.phase]]
name = "all at once"
until = 1.0
steps = 2
"#;

#[test]
fn random_sets_run_and_reach_what_was_asked() {
    let folder = made("network.toml", RANDOM, &[]);
    let folder = folder.path().join("made");
    let summary = solve_and_compare(&folder);
    let steps = summary["steps"].as_array().expect("steps");
    assert!(steps.len() == 2 && steps.iter().all(|step| step["phase"] == "all at once"));
    let record = record(&folder);
    let set = |name: &str| {
        let sets = record["sets"].as_array().expect("sets");
        sets.iter()
            .find(|set| set["name"] == name)
            .expect("the set")
    };
    let asked = set("north")["asked"]["p32"].as_f64().expect("asked");
    let inside = set("north")["inside"]["p32"].as_f64().expect("measured");
    // One fracture of the largest size is 0.1 m2/m3; mending moves some area.
    assert!(asked == 0.3 && inside > 0.29 && inside < 0.41, "{inside}");
    assert!(set("north")["inside"]["kappa"].as_f64() > Some(5.0));
    assert_eq!(set("flat")["inside"]["count"], 4);
    let main = &record["fractures"]
        .as_array()
        .expect("fractures")
        .last()
        .expect("the fault")["area"];
    // Through the middle, dipping 65 degrees: 8 m times 6 m over sin 65.
    assert!((main.as_f64().expect("an area") - 48.0 / 65_f64.to_radians().sin()).abs() < 1e-9);
}

/// The three forms of one geometry: whole fractures, split ones, and polygons for OpenCASCADE.
#[test]
fn every_form_of_a_geometry_has_the_same_fractures() {
    let folder = made("network.toml", RANDOM, &["--keep-small"]);
    let folder = folder.path().join("made");
    let scene = fs::read_to_string(folder.join("scene.toml")).expect("a scene");
    let sectors = [0, 1, 2].map(|form| {
        let parameters = format!("parameters = {{ form = {form}, ");
        let with_form = scene.replace("parameters = { ", &parameters);
        assert_ne!(with_form, scene);
        fs::write(folder.join("scene.toml"), with_form).expect("written");
        solve_and_compare(&folder)["mesh"]["max_sectors"].clone()
    });
    assert!(
        sectors.iter().all(|of_form| *of_form == sectors[0]),
        "{sectors:?}"
    );
}

/// gmsh looks for the end of a block that it skips in names, too.
/// A hillside with a tunnel through it, a box of 10 m before.
const HILLSIDE: &str = r#"
SetFactory("OpenCASCADE");
Point(1) = {0, 0, 0}; Point(2) = {10, 0, 0}; Point(3) = {10, 0, 6}; Point(4) = {0, 0, 10};
For i In {1 : 4}
  Line(i) = {i, (i % 4) + 1};
EndFor
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Extrude {0, 10, 0} { Surface{1}; }
Cylinder(2) = {5, -1, 3, 0, 12, 0, 1.5};
BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; }
Physical Volume("hill") = Volume{:};
"#;

const IN_A_HILLSIDE: &str = r#"
[domain]
low = [0, 0, 0]
high = [10, 10, 10]
geometry = "hillside.geo"
[mesh]
h = 1.5
h_fracture = 0.7
[fracture_set.given]
list = "given.csv"
aperture = 1e-3
normal_stiffness = 2e10
shear_stiffness = 1e10
[boundary.bottom]
symmetry = true
[boundary.left]
symmetry = true
[boundary.right]
symmetry = true
[boundary.front]
symmetry = true
[boundary.slope]
where = "z > 5.9"
pressure = 1e6
"#;

/// The level fracture loses the strip in the tunnel, the upright one what is above the slope and in
/// the tunnel's way; they cross.
#[test]
fn fractures_are_cut_to_a_geometry_with_a_cavity_and_a_slope() {
    let folder = scratch();
    let given = "name, shape, x, y, z, dip, dip_direction, length, width\n\
                 level, rectangle, 5, 5, 3.5, 0, 90, 30, 30\n\
                 upright, rectangle, 5, 7, 5, 90, 180, 30, 30\n";
    fs::create_dir(folder.path().join("made")).expect("a folder");
    for (name, text) in [
        ("given.csv", given),
        ("hillside.geo", HILLSIDE),
        ("hill.toml", IN_A_HILLSIDE),
    ] {
        fs::write(folder.path().join(name), text).expect("the input is written");
    }
    let run = make(folder.path(), "hill.toml", &["--run"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    let found = summary(&folder.path().join("made/out"));
    let area = |name: &str| found["fractures"][name]["area"].as_f64().expect("an area");
    let chord = 2.0 * (1.5_f64.powi(2) - 0.5_f64.powi(2)).sqrt();
    let tunnel = std::f64::consts::PI * 1.5_f64.powi(2);
    assert!((area("level") - 10.0 * (10.0 - chord)).abs() < 1e-6);
    // Edges along the tunnel are straight in the mesh.
    let upright = area("upright");
    assert!(
        (0.0..0.03 * tunnel).contains(&(upright - (80.0 - tunnel))),
        "{upright}"
    );
    let missing = IN_A_HILLSIDE.replace("hillside", "hill");
    fs::write(folder.path().join("hill.toml"), missing).expect("the input is written");
    let run = make(folder.path(), "hill.toml", &[]);
    assert_eq!(run.code, Some(2), "{}", run.err);
    assert!(run.err.contains("there is no file"), "{}", run.err);
}

#[test]
fn names_may_be_words_of_gmsh() {
    let list = LIST.replace("wall", "EndIf").replace("oval", "Else");
    let folder = made(
        "list.csv",
        &list,
        &["--domain", "0,0,0,10,10,10", "--h", "3"],
    );
    solve_and_compare(&folder.path().join("made"));
}

#[test]
fn a_seed_gives_the_same_bytes() {
    let bytes = |text: &str| {
        let folder = made("network.toml", text, &[]);
        ["network.geo", "scene.toml"]
            .map(|name| fs::read(folder.path().join("made").join(name)).expect("made"))
    };
    assert!(bytes(RANDOM) == bytes(RANDOM));
    assert!(bytes(RANDOM) != bytes(&RANDOM.replace("seed = 7", "seed = 8")));
}

#[test]
fn the_committed_networks_are_what_the_command_makes() {
    for name in ["network-20", "network-100", "network-flow"] {
        let source = root().join("geometries").join(name);
        let folder = scratch();
        let copy = folder.path().join("network.toml");
        fs::copy(source.join("network.toml"), &copy).expect("copied");
        let run = make(folder.path(), "network.toml", &["--name", name]);
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
        for file in [format!("{name}.geo"), "scene.toml".to_owned()] {
            let fresh = fs::read(folder.path().join("made").join(&file)).expect("made");
            assert!(
                fresh == fs::read(source.join(&file)).expect("committed"),
                "{name}/{file} is stale"
            );
        }
    }
}

#[test]
fn every_defect_of_a_description_is_told_with_its_line() {
    let text = RANDOM
        .replace("kappa = 30", "kapa = 30")
        .replace("law = \"lognormal\"", "law = \"lognorml\"")
        .replace("set = \"faults\"", "set = \"fault\"")
        .replace("young_modulus", "young_modulas")
        .replace("h_fracture = 1.0", "h_fracture = 3.0");
    let told = refused("network.toml", &text);
    for part in [
        "5 defects",
        "network.toml:9: h_fracture = 3 is coarser than 2",
        "network.toml:15: unknown key `kapa`",
        "did you mean \"lognormal\"?",
        "did you mean \"faults\"?",
        "did you mean `young_modulus`?",
    ] {
        assert!(told.contains(part), "{part}: {told}");
    }
}

#[test]
fn overlapping_fractures_are_refused_by_name() {
    let told = refused(
        "list.csv",
        &format!("{LIST}twin, flat, disc, 5.5, 5, 3.9118365, 10, 90, 1,,,,,,\n"),
    );
    assert!(
        told.contains("`twin`") && told.contains("overlaps fracture `floor`"),
        "{told}"
    );
}

#[test]
fn inputs_of_other_kinds_are_refused() {
    assert!(refused("list.txt", LIST).contains("neither in .csv or .dat nor in .toml"));
    assert!(refused("list.csv", "name,shape\n").contains("holds no fracture"));
    assert!(refused("list.csv", "").contains("no column `shape`"));
    let outside = RANDOM
        .split("[fracture_set.north]")
        .next()
        .expect("the head")
        .to_owned();
    let outside = outside
        + "[fracture_set.faults]\naperture = 1e-3\nnormal_stiffness = 1e10\nshear_stiffness = 1e9\n";
    let told = refused("network.toml", &outside);
    assert!(told.contains("no fracture is left"), "{told}");
}

#[test]
fn the_scene_of_a_user_is_not_overwritten() {
    let folder = made("list.csv", LIST, &[]);
    let scene = folder.path().join("made/scene.toml");
    let again = make(folder.path(), "list.csv", &[]);
    assert_eq!(
        again.code,
        Some(0),
        "what the command made it may make again"
    );
    fs::write(&scene, "title = \"mine\"").expect("written");
    let run = make(folder.path(), "list.csv", &[]);
    assert_eq!(run.code, Some(2));
    assert!(run.err.contains("scene.toml"), "{}", run.err);
    assert_eq!(
        fs::read_to_string(&scene).expect("a scene"),
        "title = \"mine\""
    );
}

#[test]
fn the_report_names_what_was_asked_and_what_came_of_it() {
    let folder = scratch();
    fs::write(folder.path().join("network.toml"), RANDOM).expect("written");
    let run = make(folder.path(), "network.toml", &["-v"]);
    for part in [
        "asked P32 0.3000",
        "in the domain",
        "intersections",
        "kluft run",
    ] {
        assert!(run.out.contains(part), "{part}: {}", run.out);
    }
}
