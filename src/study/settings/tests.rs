//! The settings of a study.

use super::*;

const SCENE: &str = r#"
[mesh]
geometry = "a.geo"
parameters = { h = 0.1, h_far = 1, dip = 50 }
[rock.default]
young_modulus = 50e9
poisson_ratio = 0.25
[fracture.a]
aperture = 1e-4
normal_stiffness = 1e11
shear_stiffness = 1e10
closure = "logarithmic"
cutoff_aperture = 1e-6
[fracture.b]
aperture = 2e-4
normal_stiffness = 1e11
friction_angle = 30
[boundary.top]
pressure = 1e6
[boundary."far.side"]
displacement = { z = 0 }
"#;

fn read(study: &str) -> Result<StudyPlan, Vec<Defect>> {
    StudyPlan::read(Path::new("folder/scene.toml"), &format!("{SCENE}{study}"))
}

fn plan(study: &str) -> StudyPlan {
    read(study).expect("a plan")
}

/// The scene of the setting with these labels.
fn scene(plan: &StudyPlan, labels: &str) -> Table {
    let name = |setting: &&Setting| plan.name(setting, |_| true) == labels;
    let setting = plan.settings.iter().find(name);
    plan.scene_of(setting.unwrap_or_else(|| panic!("no setting {labels}")))
}

#[test]
fn without_a_study_sizes_and_orders_are_swept() {
    let plan = plan("");
    let names: Vec<String> = plan
        .settings
        .iter()
        .map(|s| plan.name(s, |_| true))
        .collect();
    assert_eq!(names[0], "h=0.2 h_far=2, order 1");
    assert_eq!(
        names.last().map(String::as_str),
        Some("h=0.1 h_far=1, order 2")
    );
    assert_eq!(names.len(), 6);
    let scene = scene(&plan, "h=0.14 h_far=1.4, order 2");
    let mesh = scene["mesh"].as_table().expect("a mesh");
    assert_eq!(mesh["order"].as_integer(), Some(2));
    assert_eq!(mesh["parameters"]["h"].as_float(), Some(0.14));
    assert_eq!(mesh["parameters"]["dip"].as_integer(), Some(50));
    assert!(Path::new(mesh["geometry"].as_str().expect("a path")).is_absolute());
}

#[test]
fn labels_tell_what_differs() {
    let plan = plan(
        "[study]\nmeshes = [{ dip = 50, h = 0.1, h_far = 3 }, { dip = 50, h = 0.05, h_far = 2 }]\n",
    );
    let mesh = &plan.dimensions[0].choices;
    assert_eq!(mesh[0].label, "h=0.1 h_far=3");
    assert_eq!((mesh[1].number, mesh[1].cost), (Some(0.05), 8.0));
    assert_eq!(mesh[1].edits.len(), 3);
}

#[test]
fn the_product_is_run_from_cheap_to_dear() {
    let plan = plan(
        "[study]\nmeshes = [{ h = 0.05 }, { h = 0.1 }]\norders = [2, 1]\nsolvers = ['direct', 'iterative']\n",
    );
    assert_eq!(plan.settings.len(), 8);
    assert!(plan.settings.is_sorted_by(|a, b| a.cost <= b.cost));
    assert!(plan.settings[0].folder.ends_with("h_0.1-order_1-direct"));
    let mut folders: Vec<&str> = plan.settings.iter().map(|s| s.folder.as_str()).collect();
    folders.sort_unstable();
    folders.dedup();
    assert_eq!(folders.len(), 8);
    let scene = scene(&plan, "h=0.05, order 2, iterative");
    assert_eq!(scene["solver"]["linear"].as_str(), Some("iterative"));
    assert!(!scene.contains_key("study"));
}

#[test]
fn quarter_points_are_swept_beside_orders() {
    let plan = plan("[study]\norders = [1, 2]\nquarter_points = [true, false]\n");
    assert_eq!(plan.settings.len(), 4);
    let flag = |labels: &str| scene(&plan, labels)["mesh"]["quarter_points"].as_bool();
    assert_eq!(flag("order 2, quarter points"), Some(true));
    assert_eq!(flag("order 2, no quarter points"), Some(false));
}

#[test]
fn tolerances_are_meshes() {
    let plan = plan("[study]\ntolerances = [0.01, 0.05]\norders = [1, 2]\n");
    assert_eq!(plan.settings.len(), 4);
    assert_eq!(plan.dimensions[0].kind, SweepKind::Mesh);
    assert!(plan.settings[0].folder.ends_with("tolerance_0.05-order_1"));
    let scene = scene(&plan, "tolerance=0.01, order 2");
    let mesh = &scene["mesh"];
    assert_eq!(mesh["adapt"]["tolerance"].as_float(), Some(0.01));
    assert_eq!(mesh["parameters"]["h"].as_float(), Some(0.1));
}

#[test]
fn refinements_are_nested_meshes() {
    let plan = plan("[study]\nrefinements = [2, 0, 1]\norders = [1, 2]\n");
    assert_eq!(plan.settings.len(), 6);
    let dimension = &plan.dimensions[0];
    assert_eq!(dimension.kind, SweepKind::Mesh);
    let of_choices: Vec<_> = dimension
        .choices
        .iter()
        .map(|choice| (choice.label.as_str(), choice.number, choice.cost))
        .collect();
    let expected = [
        ("refine=2", Some(0.025), 64.0),
        ("refine=0", Some(0.1), 1.0),
        ("refine=1", Some(0.05), 8.0),
    ];
    assert_eq!(of_choices, expected);
    let scene = scene(&plan, "refine=2, order 1");
    assert_eq!(scene["mesh"]["refine"].as_integer(), Some(2));
    assert_eq!(scene["mesh"]["parameters"]["h"].as_float(), Some(0.1));
}

#[test]
fn closures_by_name_drop_the_keys_that_they_refuse() {
    let plan = plan(
        "[study]\nclosures = ['contact', 'hyperbolic', { label = 'cut', closure = 'logarithmic', cutoff_aperture = 1e-5 }]\n",
    );
    let contact = scene(&plan, "contact");
    let keys = |scene: &Table, name: &str| -> Vec<String> {
        let keys = scene["fracture"][name]
            .as_table()
            .expect("a fracture")
            .keys();
        keys.cloned().collect()
    };
    assert_eq!(keys(&contact, "a"), ["aperture", "closure"]);
    assert_eq!(
        keys(&contact, "b"),
        ["aperture", "closure", "friction_angle"]
    );
    let cut = scene(&plan, "cut");
    assert_eq!(
        cut["fracture"]["b"]["cutoff_aperture"].as_float(),
        Some(1e-5)
    );
    assert_eq!(cut["fracture"]["a"].get("label"), None);
}

#[test]
fn a_key_that_is_false_goes_away() {
    let plan =
        plan("[study]\nclosures = ['logarithmic', { label = 'exact', cutoff_aperture = false }]\n");
    let cutoff = |label: &str| {
        scene(&plan, label)["fracture"]["a"]
            .get("cutoff_aperture")
            .cloned()
    };
    assert_eq!(cutoff("logarithmic"), Some(Value::Float(1e-6)));
    assert_eq!(cutoff("exact"), None);
}

#[test]
fn values_are_of_all_fractures_that_have_the_key_or_of_one() {
    let plan = plan(
        "[study.values]\nshear_stiffness = [1e9, 2e9]\n'b.aperture' = { from = 1e-5, to = 1e-3, count = 3 }\n",
    );
    assert_eq!(plan.settings.len(), 6);
    let scene = scene(&plan, "aperture=0.001, shear_stiffness=2e9");
    let fracture = |name: &str, key: &str| scene["fracture"][name].get(key).cloned();
    assert_eq!(fracture("a", "shear_stiffness"), Some(Value::Float(2e9)));
    assert_eq!(fracture("b", "shear_stiffness"), None);
    assert_eq!(fracture("a", "aperture"), Some(Value::Float(1e-4)));
    assert_eq!(fracture("b", "aperture"), Some(Value::Float(1e-3)));
}

#[test]
fn loads_are_values() {
    let plan = plan(
        "[study.values]\n'boundary.top.pressure' = [5e6, '10 MPa']\n'boundary.far.side.displacement.z' = [-1e-3]\n'fracture.a.fluid_pressure' = [1e6, 2e6]\n",
    );
    assert_eq!(plan.settings.len(), 4);
    let scene = scene(&plan, "top.pressure=1e7, fluid_pressure=1e6");
    let boundary = &scene["boundary"];
    assert_eq!(boundary["top"]["pressure"].as_float(), Some(1e7));
    let side = &boundary["far.side"]["displacement"];
    assert_eq!(side["z"].as_float(), Some(-1e-3));
    let pressure = |name: &str| scene["fracture"][name].get("fluid_pressure").cloned();
    assert_eq!(pressure("a"), Some(Value::Float(1e6)));
    assert_eq!(pressure("b"), None);
}

/// Of the second nothing would be seen.
#[test]
fn one_law_under_two_labels_is_refused() {
    let twice = "[study]\nclosures = ['linear', { label = 'other', closure = 'linear' }]\n";
    let defects = read(twice).expect_err("one law");
    assert!(
        defects[0].problem.contains("\"linear\" and \"other\""),
        "{defects:?}"
    );
}

#[test]
fn slips_are_found_before_anything_is_run() {
    for (study, named) in [
        ("[study]\nmesh = [1]", "did you mean `meshes`"),
        ("[study]\nmeshes = [0.1]", "braces"),
        ("[study]\nmeshes = []", "empty"),
        ("[study]\norders = [3]", "from 1 to 2"),
        ("[study]\norders = [1.5]", "order 1 or 2"),
        ("[study]\ntolerances = [2]", "more than 0 and less than 1"),
        ("[study]\ntolerances = []", "empty"),
        (
            "[study]\nmeshes = [{ h = 1 }]\ntolerances = [0.1]",
            "keep one",
        ),
        ("[study]\nrefinements = [6]", "from 0 to 5"),
        ("[study]\nrefinements = [0.5]", "whole number"),
        ("[study]\nrefinements = []", "empty"),
        (
            "[study]\nmeshes = [{ h = 1 }]\nrefinements = [1]",
            "keep one",
        ),
        ("[study]\nquarter_points = [true]", "orders = [2]"),
        ("[study]\norders = [2]\nquarter_points = [1]", "true"),
        ("[study]\norders = [2]\nquarter_points = []", "empty"),
        ("[study]\nclosures = ['logaritmic']", "logarithmic"),
        ("[study]\nclosures = [{ apertur = 1e-4 }]", "aperture"),
        ("[study]\nfacets = ['nodes']", "nodal"),
        ("[study]\nsolvers = 'direct'", "brackets"),
        ("[study]\nreference = 'exact'", "no entry of `closures`"),
        ("[study.values]\nnormal_stifness = [1]", "normal_stiffness"),
        (
            "[study.values]\nnormal_stiffness = { from = 1, to = 2 }",
            "count",
        ),
        ("[study.values]\nnormal_stiffness = 3", "brackets"),
        (
            "[study.values]\n'c.aperture' = [1]",
            "fracture.a, fracture.b",
        ),
        (
            "[study.values]\n'boundary.a.pressure' = [1]",
            "boundary.top",
        ),
        (
            "[study.values]\n'boundary.top.traction' = [1]",
            "boundary.top.pressure",
        ),
        (
            "[study.values]\n'boundary.top.pressure' = ['1 mm']",
            "a stress",
        ),
    ] {
        let defects = read(study).expect_err(study);
        let text: Vec<String> = defects.iter().map(ToString::to_string).collect();
        let text = text.join("\n");
        assert!(text.contains(named), "{study}: {text}");
        assert!(text.contains("scene.toml"), "{study}: {text}");
    }
}

#[test]
fn a_choice_that_needs_another_one_is_no_slip() {
    let study = "[study]\nclosures = ['hyperbolic']\n[study.values]\nmax_closure = [1e-5, 1e-4]\n";
    assert_eq!(plan(study).settings.len(), 2);
    let study =
        "[study]\nclosures = ['hyperbolic', 'linear']\n[study.values]\nmax_closure = [1e-5]\n";
    let defects = read(study).expect_err("a linear law has no largest closure");
    assert!(defects[0].problem.contains("max_closure"), "{defects:?}");
}

#[test]
fn a_scene_of_a_mesh_file_has_no_meshes_to_sweep() {
    let text = SCENE.replace("geometry = \"a.geo\"", "file = \"a.msh\"");
    let text = text.replace("parameters = { h = 0.1, h_far = 1, dip = 50 }", "");
    let read = |study: &str| StudyPlan::read(Path::new("scene.toml"), &format!("{text}{study}"));
    assert!(read("").expect_err("nothing")[0].remedy.contains("[study]"));
    for study in ["orders = [1, 2]", "tolerances = [0.1]"] {
        let defects = read(&format!("[study]\n{study}\n")).expect_err(study);
        assert!(defects[0].problem.contains("mesh file"), "{defects:?}");
    }
    let refined = read("[study]\nrefinements = [0, 1]\n").expect("a plan");
    assert_eq!(refined.dimensions[0].choices[1].number, Some(0.5));
    assert_eq!(
        read("[study]\nclosures = ['linear', 'contact']\n")
            .expect("a plan")
            .settings
            .len(),
        2
    );
}

/// A key that is asked for and not in the table stops the reader; this is the other direction.
#[test]
fn every_key_of_a_study_in_the_table_is_asked_for() {
    let text = format!(
        "{SCENE}[study]\nclosures = [{{ label = 'a', closure = 'linear' }}]\nvalues = {{ aperture = {{ from = 1e-4, to = 1, count = 2 }} }}\n"
    );
    let source = Source::new("scene.toml", &text, Document::Scene);
    let table = source.parse().expect("TOML");
    let root = Section::root(&source, table.get_ref());
    let scene: Table = text.parse().expect("TOML");
    let study = scene["study"].as_table().expect("a study");
    let section = root.section("study").expect("a study");
    read_study(&source, section, study, &scene);
    let mut unasked = source.unasked();
    let sections = Document::Study.sections();
    // Keys of fractures are read in the scene of each setting.
    let own = sections
        .iter()
        .filter(|section| section.pattern != "[fracture.NAME]");
    let own: Vec<String> = own.map(|section| format!("{} ", section.pattern)).collect();
    unasked.retain(|key| own.iter().any(|pattern| key.starts_with(pattern)));
    assert_eq!(unasked, Vec::<String>::new());
}

#[test]
fn swept_values_may_have_units() {
    let text = "[study]\nclosures = [{ label = 'cut', closure = 'logarithmic', cutoff_aperture = '1 um' }]\n[study.values]\n'a.aperture' = ['0.1 mm', 2e-4]\nshear_stiffness = { from = '1 GPa/m', to = '4 GPa/m', count = 2 }\n";
    let plan = plan(text);
    assert_eq!(plan.settings.len(), 4);
    let scene = scene(&plan, "aperture=1e-4, shear_stiffness=1e9");
    let fracture = &scene["fracture"]["a"];
    assert_eq!(fracture["aperture"].as_float(), Some(1e-4));
    assert_eq!(fracture["cutoff_aperture"].as_str(), Some("1 um"));
    let defects = read("[study.values]\naperture = ['1 GPa']\n").expect_err("no length");
    assert!(defects[0].remedy.contains("a length in m"), "{defects:?}");
}

#[test]
fn files_of_all_sections_are_named_by_their_whole_paths() {
    let text = "[mesh]\ngeometry = 'a.geo'\n[rock.a]\nyoung_modulus = { file = 'b.csv' }\n\
        [boundary.file]\npressure = { file = '/c.csv' }\n[fluid]\n\
        initial_pressure = { file = 'd.csv' }\n[[source]]\nrate = { file = 'e.csv' }\n\
        [[fixed_point]]\ndisplacement = { x = { file = 'f/g.csv' } }\n\
        [study]\nclosures = [{ normal_stiffness = { file = 'h.csv' } }]\n";
    let mut scene: Table = text.parse().expect("TOML");
    make_paths_absolute(&mut scene, Path::new("/data")).expect("UTF-8");
    let [source, point] = ["source", "fixed_point"].map(|list| &scene[list][0]);
    let closure = &scene["study"]["closures"][0]["normal_stiffness"];
    for (path, name) in [
        (&scene["mesh"]["geometry"], "/data/a.geo"),
        (&scene["rock"]["a"]["young_modulus"]["file"], "/data/b.csv"),
        (&scene["boundary"]["file"]["pressure"]["file"], "/c.csv"),
        (&scene["fluid"]["initial_pressure"]["file"], "/data/d.csv"),
        (&source["rate"]["file"], "/data/e.csv"),
        (&point["displacement"]["x"]["file"], "/data/f/g.csv"),
        (&closure["file"], "/data/h.csv"),
    ] {
        assert_eq!(path.as_str(), Some(name));
    }
}

#[cfg(unix)]
#[test]
fn a_folder_whose_name_is_not_utf_8_is_refused() {
    use std::os::unix::ffi::OsStrExt;
    let folder = std::ffi::OsStr::from_bytes(b"/a\xff");
    let mut scene: Table = SCENE.parse().expect("TOML");
    let refused = make_paths_absolute(&mut scene, Path::new(folder));
    let problem = refused.expect_err("no text").problem;
    assert!(problem.contains("whose name is UTF-8"), "{problem}");
}

#[test]
fn a_fracture_is_one_of_the_scene_unless_the_mesh_may_have_others() {
    let study = "[study]\nmeasure = 'max_slip'\nfracture = 'aa'\n";
    let defects = read(study).expect_err("no such fracture");
    let line = SCENE.lines().count() + 3;
    assert_eq!(defects[0].place, format!("folder/scene.toml:{line}"));
    for part in ["did you mean \"a\"?", "the scene has: a, b"] {
        assert!(defects[0].remedy.contains(part), "{defects:?}");
    }
    let text = SCENE.replace("[fracture.b]", "[fracture.default]") + study;
    let plan = StudyPlan::read(Path::new("scene.toml"), &text).expect("a plan");
    assert_eq!(plan.request.place, format!("scene.toml:{}", line - 1));
}
