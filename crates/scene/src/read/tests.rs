//! The reader of scenes and the table of keys agree.

use super::*;

const EVERY_KEY: &str = include_str!("../../../../tests/program/every_key.toml");
const TIMED: &str = include_str!("../../../../tests/program/timed.toml");
/// Keys that exclude those of the others.
const REST: &str = "
load = { times = [1.0] }
mesh = { file = 'a.msh', scale = 1e3 }
[rock.default]
[fracture.a]
aperture = { table = [[0, 1e-4]], over = 'depth', ground = 3, beyond = 'nearest', unit = 'mm' }
normal_stiffness = { expression = '1e10 + x' }
shear_stiffness = { file = 'a.csv', column = 'k', method = 'linear', reach = 1.0 }
[[source]]
fracture = 'a'
pressure = { value = 1e6, per_metre = -9810, at = 3.0 }
[[source]]
fracture = 'a'
pressure = { water_table = 3.0 }
[probe.a]
at = [0, 0, 0]
fracture = 'joint'
mean = true
[probe.b]
from = [0, 0, 0]
to = [1, 0, 0]
count = 3
across = [0, 1, 0]
rows = 2
[oracle.a]
form = 'uniform'
opening = 1e-5
slip = 1e-5
[oracle.b]
form = 'penny'
[oracle.c]
form = 'sphere'
pressure = 1e6
";

/// The scene with its edits, if it is one, its warnings, and the keys that nobody asked for.
fn read(text: &str) -> (Result<Scene, Vec<Defect>>, Vec<String>) {
    let source = Source::new("scene.toml", text, Document::Scene);
    let table = source.parse().expect("TOML");
    let root = Section::root(&source, table.get_ref());
    read_scene(&source, &root, Path::new(""));
    root.finish();
    let unasked = source.unasked();
    (Scene::parse(text, "scene.toml", Path::new("")), unasked)
}

/// A key that is asked for and not in the table stops the reader; this is the other direction.
/// Those of `[study]` are asked for by who runs studies.
#[test]
fn every_key_of_the_table_is_asked_for() {
    let of_studies = Document::Study.sections();
    let is_of_studies = |key: &String| {
        let mut patterns = of_studies.iter().map(|section| section.pattern);
        patterns.any(|pattern| key.starts_with(&format!("{pattern} ")))
    };
    let mut unasked = read(EVERY_KEY).1;
    for text in [TIMED, REST] {
        let other = read(text).1;
        unasked.retain(|key| other.contains(key));
    }
    unasked.retain(|key| !is_of_studies(key));
    assert_eq!(unasked, Vec::<String>::new());
}

fn edited(edits: &[(&str, &str)]) -> Result<Scene, Vec<Defect>> {
    let mut text = EVERY_KEY.to_owned();
    for (from, to) in edits {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    read(&text).0
}

#[test]
fn refinement_is_a_small_number_and_no_friend_of_adaptive_meshes() {
    let plain = ("weld = true\nrefine = 0", "refine = 2");
    let fixed = (
        "adapt = { tolerance = 0.05, max_unknowns = 1e5, max_rounds = 3 }",
        "",
    );
    assert_eq!(edited(&[plain, fixed]).expect("a scene").refine, 2);
    let said = |edits: &[(&str, &str)]| {
        let defects = edited(edits).expect_err("refused");
        assert_eq!(defects.len(), 1, "{defects:?}");
        defects[0].to_string()
    };
    let both = said(&[plain]);
    for part in ["`refine` and `adapt`", "divide them again", "keep one"] {
        assert!(both.contains(part), "{both}");
    }
    for (value, part) in [
        ("6", "from 0 to 5"),
        ("0.5", "whole number"),
        ("-1", "from 0"),
    ] {
        let wrong = format!("refine = {value}");
        let said = said(&[("refine = 0", &wrong), fixed]);
        assert!(said.contains(part), "{said}");
    }
}

#[test]
fn a_scene_with_units_is_the_scene_in_si_units() {
    let with_units = edited(&[
        ("young_modulus = 50e9", "young_modulus = \"50 GPa\""),
        ("density = 2700", "density = '2.7 g/cm3'"),
        ("aperture = 1e-4", "aperture = \"0.1 mm\""),
        ("cutoff_aperture = 1e-7", "cutoff_aperture = \"0.1 um\""),
        (
            "normal_stiffness = 1e11",
            "normal_stiffness = \"100 GPa/m\"",
        ),
        ("fluid_pressure = 2e6", "fluid_pressure = \"20 bar\""),
        (
            "traction = [0, 0, -7e6]",
            "traction = [0, \"0 Pa\", \"-7 MPa\"]",
        ),
        ("z = -1e-3", "z = \"-1 mm\""),
        ("at = [1, 0.5, 0]", "at = [\"100 cm\", \"5e2 mm\", 0]"),
        (
            "gravity = [0, 0, -9.81]",
            "gravity = [0, 0, \"-9.81 m/s2\"]",
        ),
        ("xx = -10e6", "xx = \"-10 MPa\""),
        ("per_metre = 27e3", "per_metre = \"27 MPa/km\""),
        ("memory_limit = 4e9", "memory_limit = \"4 GB\""),
        ("tolerance = 0.05", "tolerance = \"5 %\""),
        ("half_length = 1.0", "half_length = \"1 m\""),
    ]);
    let debug = |mut scene: Scene| {
        // They show the text as it is.
        let in_plane = scene.in_plane.iter_mut();
        in_plane.for_each(|defect| defect.excerpt = None);
        format!("{scene:?}")
    };
    assert_eq!(
        debug(with_units.expect("a scene")),
        debug(read(EVERY_KEY).0.expect("a scene"))
    );
}

#[test]
fn wrong_units_are_named_with_those_that_fit() {
    for (from, to, says) in [
        (
            "50e9",
            "\"50 m\"",
            [
                "`m` is the unit of a length",
                "a stress in Pa, kPa, MPa, GPa",
            ],
        ),
        (
            "50e9",
            "\"50 GPA\"",
            ["unknown unit `GPA`", "did you mean `GPa`?"],
        ),
        ("50e9", "\"50\"", ["names no unit", "a number (in Pa)"]),
        (
            "50e9",
            "\"much\"",
            ["begins with no number", "a number (in Pa)"],
        ),
        (
            "50e9",
            "\"-50 GPa\"",
            ["`young_modulus` = -50000000000", "from 1 to 1e15"],
        ),
        (
            "-7e6]",
            "\"7 MN\"]",
            ["`MN` is not the unit of a stress", "a stress in Pa"],
        ),
        (
            "h = 0.1",
            "h = \"10 cm\"",
            ["is of type string", "write a number"],
        ),
    ] {
        let defects = edited(&[(from, to)]).expect_err(to);
        let text = defects[0].to_string();
        for part in says {
            assert!(text.contains(part), "{part}: {text}");
        }
    }
}

#[test]
fn values_that_are_hardly_meant_are_doubted_with_their_place() {
    let scene = edited(&[
        ("young_modulus = 50e9", "young_modulus = 50"),
        ("density = 2700", "density = 2.7"),
        ("aperture = 1e-4", "aperture = 0.2"),
        ("gravity = [0, 0, -9.81]", "gravity = [0, 0, -981]"),
    ]);
    let warnings = scene.expect("a scene").warnings;
    for (warning, says) in warnings.iter().zip([
        [
            "scene.toml:15: `young_modulus` = 50 in [rock.default]",
            "50 GPa = 5e10 Pa",
        ],
        ["scene.toml:17: `density` = 2.7", "2.7 g/cm3 = 2700 kg/m3"],
        [
            "scene.toml:25: `aperture` = 0.2 in [fracture.default]",
            "0.2 mm",
        ],
        [
            "scene.toml:31: `aperture` = 0.2 in [fracture.joint]",
            "0.2 mm",
        ],
        [
            "scene.toml:71: `gravity` = 981 in [body]",
            "981 cm/s2 = 9.81 m/s2",
        ],
    ]) {
        assert!(says.iter().all(|part| warning.contains(part)), "{warning}");
    }
    assert_eq!(warnings.len(), 5, "{warnings:#?}");
    let sound = read(EVERY_KEY).0.expect("a scene");
    assert_eq!(sound.warnings, Vec::<String>::new());
}

#[test]
fn a_key_that_others_leave_without_effect_is_told_apart_from_an_unknown_one() {
    let defects = edited(&[("form = \"line\"", "form = \"uniform\"")]).expect_err("no effect");
    let text: Vec<String> = defects.iter().map(ToString::to_string).collect();
    assert!(text[0].contains("`centre` has no effect"), "{text:#?}");
}

#[test]
fn slips_in_closed_forms_of_joints_are_named() {
    for (keys, named) in [
        ("form = 'column'", "pressure = 2e6"),
        ("form = 'column'\npressure = -1e6", "positive"),
        ("form = 'column'\npressure = 1e6\nopening = 1e-5", "opening"),
        (
            "form = 'sphere'\npressure = 1e6\nradius = 1",
            "outer_radius",
        ),
        (
            "form = 'sphere'\npressure = 1e6\nradius = 2\nouter_radius = 1",
            "above that of the joint",
        ),
    ] {
        let text = EVERY_KEY.replace(
            "[oracle.joint]",
            &format!("[oracle.other]\n{keys}\n[oracle.joint]"),
        );
        let defects = read(&text).0.expect_err(keys);
        let text: Vec<String> = defects.iter().map(ToString::to_string).collect();
        assert!(text.join("\n").contains(named), "{keys}: {text:?}");
    }
}

#[test]
fn load_steps_beyond_any_use_are_refused_with_their_number() {
    let many = vec!["1"; 100_001].join(", ");
    let times: Vec<String> = (1..=100_001).map(|time| time.to_string()).collect();
    let phase =
        |name, until| format!("[[load.phase]]\nname = '{name}'\nuntil = {until}\nsteps = 60000\n");
    for load in [
        format!("[load]\nsteps = [{many}]\n"),
        format!("[load]\ntimes = [{}]\n", times.join(", ")),
        phase("a", 1) + &phase("b", 2),
    ] {
        let text = format!(
            "{load}[mesh]\nfile = 'a.msh'\n[rock.default]\nyoung_modulus = 1e9\npoisson_ratio = 0.2\n"
        );
        let defects = Scene::parse(&text, "scene.toml", Path::new("")).expect_err("too many");
        assert_eq!(defects.len(), 1, "{}", &load[..40]);
        let defect = defects[0].to_string();
        assert!(defect.contains("load steps are too many"), "{defect}");
        assert!(defect.contains("at most 100000"), "{defect}");
    }
}

/// The table of closure laws says of each what the reader needs: nothing less, and every key that
/// it may have.
#[test]
fn the_closure_laws_need_what_the_table_says() {
    let scene = |law: &str, keys: &[&str]| {
        let keys: String = keys
            .iter()
            .map(|key| {
                let known = kluft_keys::scene::FRACTURE.key(key).expect(key);
                format!("{}\n", known.shown())
            })
            .collect();
        let text = format!(
            "mesh = {{ file = 'a.msh' }}\n[rock.default]\nyoung_modulus = 5e10\n\
             poisson_ratio = 0.2\n[fracture.f]\nclosure = '{law}'\n{keys}"
        );
        Scene::parse(&text, "scene.toml", Path::new(""))
    };
    for law in &kluft_keys::scene::LAWS {
        let all = [law.needs, law.may].concat();
        assert_eq!(scene(law.name, law.needs).err(), None, "{}", law.name);
        assert_eq!(scene(law.name, &all).err(), None, "{}", law.name);
        for left_out in law.needs {
            let others = law.needs.iter().copied().filter(|key| key != left_out);
            let others: Vec<&str> = others.collect();
            assert!(
                scene(law.name, &others).is_err(),
                "{}, {left_out}",
                law.name
            );
        }
    }
    let named = kluft_keys::scene::LAWS.map(|law| law.name);
    assert_eq!(named, kluft_keys::scene::CLOSURES);
}
