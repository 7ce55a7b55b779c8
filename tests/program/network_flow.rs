//! Flow in networks from `kluft network`: permeabilities beside Snow's formula, isolated fractures.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::harness::{Run, Workshop, files, kluft, scratch, summary, without_times};

/// A block of 4 m by 2 m by 2 m with three flat joints across it, 0.5 m apart.
pub const PARALLEL: &str = r#"
[domain]
low = [0, 0, 0]
high = [4, 2, 2]
[mesh]
h = 0.5
[fluid]
viscosity = 1e-3
[fracture_set.flat]
hydraulic_aperture = 1e-4
"#;

pub fn flat(name: &str, set: &str, z: f64) -> String {
    joint(name, set, [2.0, 1.0, z], (0.0, 0.0), 20.0)
}

fn joint(name: &str, set: &str, [x, y, z]: [f64; 3], (dip, to): (f64, f64), side: f64) -> String {
    format!(
        "[[fracture]]\nname = \"{name}\"\nset = \"{set}\"\nshape = \"rectangle\"\ncentre = [{x}, {y}, {z}]\n\
         dip = {dip}\ndip_direction = {to}\nlength = {side}\nwidth = {side}\n"
    )
}

/// What `kluft network` made of a description.
pub struct Made {
    folder: tempfile::TempDir,
}

impl Made {
    pub fn of(text: &str, flags: &[&str]) -> Result<Self, Run> {
        let folder = scratch();
        let (input, out) = (
            folder.path().join("network.toml"),
            folder.path().join("made"),
        );
        fs::write(&input, text).expect("the input is written");
        let mut arguments = vec![
            "network".as_ref(),
            input.as_os_str(),
            "-o".as_ref(),
            out.as_os_str(),
        ];
        arguments.extend(flags.iter().map(std::ffi::OsStr::new));
        let run = kluft(&arguments);
        match run.code {
            Some(0) => Ok(Self { folder }),
            _ => Err(run),
        }
    }

    pub fn new(text: &str) -> Self {
        Self::of(text, &[]).unwrap_or_else(|run| panic!("{}", run.err))
    }

    fn scene(&self) -> PathBuf {
        self.folder.path().join("made/scene.toml")
    }

    pub fn out(&self) -> PathBuf {
        self.folder.path().join("made/out")
    }

    pub fn run(&self) -> Run {
        kluft(&["run".as_ref(), self.scene().as_os_str()])
    }

    pub fn solve(&self) -> Value {
        let run = self.run();
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
        summary(&self.out())
    }
}

pub fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .unwrap_or_else(|| panic!("{value} is no number"))
}

/// Components of a tensor against those expected, as shares of the largest.
fn agrees(found: &Value, expected: [[f64; 3]; 3], tolerance: f64) {
    let largest = expected
        .as_flattened()
        .iter()
        .fold(0.0, |a: f64, b| a.max(b.abs()));
    for (row, expected) in expected.iter().enumerate() {
        for (column, expected) in expected.iter().enumerate() {
            let found = number(&found[row][column]);
            assert!(
                (found - expected).abs() <= tolerance * largest,
                "{found} {expected}"
            );
        }
    }
}

/// `k = b^3 / (12 spacing)` along the joints; the mesh has no cells, and nothing else was said.
#[test]
fn joints_across_a_block_have_the_permeability_of_their_spacing() {
    let joints: String = [0.5, 1.0, 1.5]
        .map(|z| flat(&format!("at {z}"), "flat", z))
        .concat();
    let made = Made::new(&(PARALLEL.to_owned() + &joints));
    let scene = fs::read_to_string(made.scene()).expect("a scene");
    for said in [
        "dimension = 2",
        "equivalent_permeability = true",
        "isolated = \"inactive\"",
    ] {
        assert!(scene.contains(said), "{said}: {scene}");
    }
    assert!(
        !scene.contains("young_modulus") && !scene.contains("pressure ="),
        "{scene}"
    );
    let said = made.solve();
    assert_eq!(said["mesh"]["cells"], 0);
    let along = 3.0 * 1e-12 / 12.0 / 2.0;
    let expected = [[along, 0.0, 0.0], [0.0, along, 0.0], [0.0; 3]];
    let found = &said["permeability"];
    agrees(&found["components"], expected, 1e-10);
    agrees(&found["through_going"]["components"], expected, 1e-12);
    let least = &found["principal"][2];
    assert!(
        (number(&least["plunge"]).abs() - 90.0).abs() < 1e-6,
        "{least}"
    );
    assert!((number(&found["volume"]) - 16.0).abs() < 1e-11);
    assert!(number(&found["asymmetry"]) < 1e-10 && number(&found["mass_error"]) < 1e-10);
}

/// Two sets that lean, one crossing the other: `k = sum T A (1 - n n^T) / V`.
#[test]
fn leaning_sets_that_cross_follow_snow() {
    let text = PARALLEL.to_owned()
        + "[fracture_set.steep]\nhydraulic_aperture = 2e-4\n"
        + &joint("a", "flat", [2.0, 1.0, 1.0], (30.0, 90.0), 20.0)
        + &joint("b", "steep", [1.9, 1.0, 1.1], (70.0, 0.0), 20.0);
    let said = Made::new(&text).solve();
    // The first falls towards +x: its trace in the plane y is 4 m / cos 30; the second towards +y.
    let (sine, cosine) = (30.0_f64.to_radians().sin(), 30.0_f64.to_radians().cos());
    // z from 1 + 2 tan 30 > 2: it leaves through bottom and top.
    let first = 1e-12 / 12.0 * (2.0 / sine) * 2.0 / 16.0;
    let (steep, level) = (70.0_f64.to_radians().sin(), 70.0_f64.to_radians().cos());
    let second = 8e-12 / 12.0 * (2.0 / steep) * 4.0 / 16.0;
    let along = [[cosine, 0.0, -sine], [0.0, level, -steep]];
    let across = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
    let mut expected = [[0.0; 3]; 3];
    for (set, size) in [first, second].into_iter().enumerate() {
        for i in 0..3 {
            for j in 0..3 {
                expected[i][j] +=
                    size * (along[set][i] * along[set][j] + across[set][i] * across[set][j]);
            }
        }
    }
    agrees(&said["permeability"]["components"], expected, 1e-9);
}

/// Discs that touch nothing are left out, told by number and area; without the key they are
/// refused.
#[test]
fn isolated_fractures_are_inactive() {
    let disc = |name: &str, x: f64| {
        format!(
            "[[fracture]]\nname = \"{name}\"\nset = \"flat\"\nshape = \"rectangle\"\ncentre = [{x}, 1, 0.5]\n\
             dip = 0\ndip_direction = 0\nlength = 0.5\nwidth = 1\n"
        )
    };
    let drop = "[boundary.left]\nfluid_pressure = 1e5\n[boundary.right]\nfluid_pressure = 0.0\n";
    let text = PARALLEL.to_owned()
        + drop
        + &flat("through", "flat", 1.0)
        + &disc("p", 1.0)
        + &disc("q", 3.0);
    let made = Made::new(&text);
    let said = made.solve();
    assert!(said["permeability"].is_null());
    let decisions = said["decisions"].to_string();
    let told = "2 of 3 networks are isolated and inactive: no pressure and no rate acts on them; 1.0000e0 m2";
    assert!(decisions.contains(told), "{decisions}");
    let rate = number(&said["steps"][0]["flow"]["inflow"]);
    let expected = 1e-12 * 1e5 / (12.0 * 1e-3 * 4.0) * 2.0;
    assert!((rate / expected - 1.0).abs() < 1e-10, "{rate} {expected}");
    let history = fs::read_to_string(made.out().join("history.csv")).expect("a history");
    let kinds: Vec<&str> = history
        .lines()
        .skip(1)
        .filter_map(|line| line.split(',').nth(3))
        .collect();
    assert_eq!(kinds, ["step", "source", "source", "fracture"]);
    let row = history
        .lines()
        .find(|line| line.contains(",through,"))
        .expect("a row");
    let cells: Vec<&str> = row.split(',').collect();
    assert_eq!(
        [cells[5], cells[7], cells[8]],
        ["0e0", "1e5", "1e-4"],
        "{row}"
    );
    let mean: f64 = cells[6].parse().expect("a number");
    assert!((mean / 5e4 - 1.0).abs() < 1e-12, "{row}");

    let scene = fs::read_to_string(made.scene()).expect("a scene");
    let strict = scene.replace("isolated = \"inactive\"", "isolated = \"refuse\"");
    fs::write(made.scene(), strict).expect("written");
    let run = made.run();
    assert_eq!(run.code, Some(2));
    for said in ["fractures `p`, `q`", "isolated = \"inactive\""] {
        assert!(run.err.contains(said), "{said}: {}", run.err);
    }
}

/// Twice the side is twice the radius: apertures go with its root.
#[test]
fn apertures_follow_the_size_of_fractures() {
    let text = PARALLEL.replace(
        "hydraulic_aperture = 1e-4",
        "hydraulic_aperture_law = { coefficient = 1e-4, exponent = 0.5 }",
    );
    let text = text
        + &joint("small", "flat", [2.0, 1.0, 0.5], (0.0, 0.0), 10.0)
        + &joint("large", "flat", [2.0, 1.0, 1.5], (0.0, 0.0), 20.0);
    let said = Made::new(&text).solve();
    let aperture = |side: f64| 1e-4 * (side / std::f64::consts::PI.sqrt()).sqrt();
    let along = (aperture(10.0).powi(3) + aperture(20.0).powi(3)) / 24.0;
    let expected = [[along, 0.0, 0.0], [0.0, along, 0.0], [0.0; 3]];
    agrees(&said["permeability"]["components"], expected, 1e-9);

    let run = Made::of(&text, &["--group", "set"]).err().expect("refused");
    assert_eq!(run.code, Some(2));
    assert!(run.err.contains("leave out --group set"), "{}", run.err);
}

/// What a network says of its fluid is checked before anything is made.
#[test]
fn wrong_words_on_a_fluid_are_refused_with_their_lines() {
    let refused = |from: &str, to: &str| {
        assert!(PARALLEL.contains(from));
        let text = PARALLEL.replace(from, to) + &flat("a", "flat", 1.0);
        let run = Made::of(&text, &[]).err().expect("refused");
        assert_eq!(run.code, Some(2));
        run.err
    };
    let said = refused("viscosity = 1e-3", "viscosity = -1");
    assert!(said.contains("network.toml:8"), "{said}");
    let said = refused("viscosity = 1e-3", "viscosity = 1e-3\nisolated = \"dry\"");
    assert!(
        said.contains("isolated") && said.contains("inactive"),
        "{said}"
    );
    let said = refused("[fluid]\nviscosity = 1e-3", "");
    assert!(said.contains("there is no [fluid]"), "{said}");
    let said = refused(
        "hydraulic_aperture = 1e-4",
        "hydraulic_aperture = 1e-4\nhydraulic_aperture_law = { coefficient = 1e-4, exponent = 1 }",
    );
    assert!(said.contains("beside hydraulic_aperture_law"), "{said}");
}

/// Surfaces alone give the rates of the whole mesh, and say what they cannot do.
#[test]
fn the_star_needs_no_cells() {
    let alone = (
        "parameters = { h = 0.2 }",
        "parameters = { h = 0.2 }\ndimension = 2",
    );
    let workshop = Workshop::new("flow-star", &[alone]);
    let (one, two) = (
        workshop.solve("one", &["--threads", "1"]),
        workshop.solve("two", &["--threads", "2"]),
    );
    let (mut ones, mut twos) = (files(&one), files(&two));
    without_times(&mut ones);
    without_times(&mut twos);
    // Checkpoints say how long the run took.
    assert!(ones.remove("resume.bin").is_some() && twos.remove("resume.bin").is_some());
    assert_eq!(ones, twos);
    crate::flow::check_star(&one);
    assert_eq!(summary(&one)["mesh"]["cells"], 0);
    let outer = crate::read_back::read_back(&one.join("rock_0001.vtu"));
    assert!(outer["cell_data"]["boundary"].is_object(), "{outer}");
    let scene = workshop.scene();
    let run = kluft(&["inspect".as_ref(), scene.as_os_str()]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    let flat = run.out.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(flat.contains("unknown pressures, 1 network"), "{}", run.out);

    let refused = |edits: &[(&str, &str)]| {
        let run = Workshop::new("flow-star", edits).run("out", &[]);
        assert_eq!(run.code, Some(2));
        run.err
    };
    let said = refused(&[("parameters = { h = 0.2 }", "dimension = 2\nweld = true")]);
    assert!(said.contains("`weld` of [mesh] needs cells"), "{said}");
    let finer = (
        "parameters = { h = 0.2 }",
        "parameters = { h = 0.4 }\ndimension = 2\nrefine = 2",
    );
    let workshop = Workshop::new("flow-star", &[finer]);
    let out = workshop.solve("finer", &[]);
    crate::flow::check_star(&out);
    assert!(
        summary(&out)["decisions"]
            .to_string()
            .contains("each facet divided into 4, 2 times")
    );
    let said = refused(&[
        alone,
        (
            "[fluid]",
            "[rock.default]\nyoung_modulus = 1e10\npoisson_ratio = 0.2\n[fluid]",
        ),
    ]);
    assert!(said.contains("`normal_stiffness` is missing"), "{said}");
    let said = refused(&[
        alone,
        ("[fluid]", "[fluid]\nequivalent_permeability = true"),
    ]);
    assert!(said.contains("do not close"), "{said}");
}

/// A flow that is finished has nothing left to do, and its files stay as they are.
#[test]
fn a_finished_flow_has_nothing_left_to_do() {
    let steps = ("[mesh]", "[load]\nsteps = [0.5, 1.0]\n\n[mesh]");
    let workshop = Workshop::new("flow-star", &[steps]);
    let mut before = files(&workshop.solve("out", &[]));
    without_times(&mut before);
    let run = workshop.run("out", &["--resume", "--verbose"]);
    assert_eq!(run.code, Some(0), "{}", run.err);
    assert!((run.out + &run.err).contains("nothing is left to do"));
    let mut after = files(&workshop.path("out"));
    for (name, bytes) in before {
        assert_eq!(after.remove(&name), Some(bytes), "{name}");
    }
    let history = fs::read_to_string(workshop.path("out").join("history.csv")).expect("a history");
    assert_eq!(
        history
            .lines()
            .filter(|line| line.contains(",step,"))
            .count(),
        2
    );
    assert!(
        Path::new(&workshop.path("out"))
            .join("sources.csv")
            .exists()
    );
}

/// One command from a list of polygons to the tensor of the box.
#[test]
fn a_list_has_its_permeability_in_one_command() {
    let folder = scratch();
    let list = "name,shape,points\n\
        a,polygon,-1 -1 0.5; 9 -1 0.5; 9 9 0.5; -1 9 0.5\n\
        b,polygon,-1 -1 1.5; 9 -1 1.5; 9 9 1.5; -1 9 1.5\n";
    let (input, out) = (folder.path().join("list.csv"), folder.path().join("made"));
    fs::write(&input, list).expect("written");
    let mut arguments = vec![
        "network".as_ref(),
        input.as_os_str(),
        "-o".as_ref(),
        out.as_os_str(),
    ];
    let flags = [
        "--domain",
        "0,0,0,4,2,2",
        "--h",
        "0.5",
        "--hydraulic-aperture",
        "1e-4",
        "--run",
    ];
    arguments.extend(flags.map(std::ffi::OsStr::new));
    let run = kluft(&arguments);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    let said = summary(&out.join("out"));
    let along = 2.0 * 1e-12 / 12.0 / 2.0;
    let expected = [[along, 0.0, 0.0], [0.0, along, 0.0], [0.0; 3]];
    agrees(&said["permeability"]["components"], expected, 1e-10);
}

/// `geometries/network-flow` on coarse facets: nothing is lost, and the permeability is symmetric,
/// positive and in no direction above that of fractures which all go through the block.
#[test]
fn a_network_conducts_less_than_through_going_fractures() {
    let sizes = (
        "parameters = { h = 1.0, h_fracture = 0.4, h_intersection = 0.3 }",
        "parameters = { h = 3.0, h_fracture = 1.5, h_intersection = 1.0 }",
    );
    let workshop = Workshop::new("network-flow", &[sizes]);
    let said = summary(&workshop.solve("out", &[]));
    let flow = &said["steps"][0]["flow"];
    assert!(
        number(&flow["inflow"]) > 0.0 && number(&flow["mass_error"]) < 1e-10,
        "{flow}"
    );
    assert!((number(&flow["inflow"]) / number(&flow["outflow"]) - 1.0).abs() < 1e-10);
    let found = &said["permeability"];
    assert!(number(&found["asymmetry"]) < 1e-9 && number(&found["mass_error"]) < 1e-9);
    let quadratic = |tensor: &Value, along: [f64; 3]| -> f64 {
        let terms = (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
        terms
            .map(|(i, j)| along[i] * along[j] * number(&tensor["components"][i][j]))
            .sum()
    };
    for along in [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 1.0, 0.0],
        [1.0, -1.0, 1.0],
        [0.0, 1.0, -2.0],
    ] {
        let (own, most) = (
            quadratic(found, along),
            quadratic(&found["through_going"], along),
        );
        assert!(own > 0.0 && own < most, "{along:?}: {own} {most}");
    }
}
