//! `kluft init`: a scene for a mesh or a geometry, which runs; folders with a scene.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::harness::{KLUFT, Run, Workshop, command, edited, kluft, root, scratch, summary};
use crate::import::GRID;

const MESH: &str = include_str!("bad_input/base.msh");

fn on(command: &str, path: &Path) -> Run {
    kluft(&[command.as_ref(), path.as_os_str()])
}

/// A folder with a geometry of the gallery, and what is made of it.
fn made(geometry: &str) -> (tempfile::TempDir, String) {
    let folder = scratch();
    let name = format!("{geometry}.geo");
    let from = root().join("geometries").join(geometry).join(&name);
    fs::copy(from, folder.path().join(&name)).expect("copied");
    let run = on("init", &folder.path().join(&name));
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    assert!(
        run.out.contains("scene.toml") && run.out.contains("kluft run"),
        "{}",
        run.out
    );
    assert!(!run.out.contains("too little"), "{}", run.out);
    let text = fs::read_to_string(folder.path().join("scene.toml")).expect("a scene");
    (folder, text)
}

/// `init` with another place for the scene.
fn init_at(input: &Path, scene: &Path) -> Run {
    let [input, scene] = [input, scene].map(Path::as_os_str);
    kluft(&["init".as_ref(), input, "--out".as_ref(), scene])
}

/// A folder with a mesh of two cells.
fn two_cells() -> (tempfile::TempDir, PathBuf) {
    let folder = scratch();
    let mesh = folder.path().join("base.msh");
    fs::write(&mesh, MESH).expect("written");
    (folder, mesh)
}

/// Runs the scene of a crack in the plane; the load on top closes the crack.
fn crack_closes(folder: &Path) {
    let run = on("run", folder);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    let said = summary(&folder.join("out"));
    let aperture = said["fractures"]["crack"]["aperture"]["mean"].as_f64();
    assert!(aperture.expect("a mean") < 1e-4, "it closes");
}

#[test]
fn the_scene_of_a_geometry_runs() {
    let (folder, text) = made("inclined-joint");
    for part in [
        "geometry = \"inclined-joint.geo\"",
        "[rock.rock]",
        "[fracture.joint]",
        "dip 50°",
        "# assumed",
    ] {
        assert!(text.contains(part), "{part}:\n{text}");
    }
    let section = |head: &str| -> String {
        let rest = text.split_once(&format!("{head} ")).expect(head).1;
        rest.split("\n\n").next().expect("a section").to_owned()
    };
    assert!(section("[boundary.top]").contains("pressure = "));
    for lower in ["[boundary.bottom]", "[boundary.front]"] {
        assert!(section(lower).contains("\nsymmetry = true"), "{text}");
    }
    let run = on("run", folder.path());
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{text}");
    let said = summary(&folder.path().join("out"));
    let aperture = said["fractures"]["joint"]["aperture"]["mean"].as_f64();
    assert!(aperture.expect("a mean") < 1e-4, "it closes");
}

#[test]
fn the_scene_of_a_mesh_runs_too() {
    let folder = scratch();
    let geometry = root().join("geometries/x-junction/x-junction.geo");
    let mesh = folder.path().join("cross.msh");
    let made = std::process::Command::new("gmsh")
        .args(["-3", "-format", "msh41", "-v", "1", "-o"])
        .args([&mesh, &geometry])
        .status();
    assert!(made.expect("gmsh").success());
    assert_eq!(on("init", &mesh).code, Some(0));
    let text = fs::read_to_string(folder.path().join("scene.toml")).expect("a scene");
    assert!(text.contains("file = \"cross.msh\""), "{text}");
    assert_eq!(text.matches("\n[fracture.").count(), 2, "{text}");
    let run = on("run", folder.path());
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{text}");
}

#[test]
fn what_cannot_be_assumed_is_said() {
    let folder = scratch();
    let mesh = folder.path().join("base.msh");
    fs::write(&mesh, MESH).expect("written");
    assert_eq!(on("init", &mesh).code, Some(0));
    let text = fs::read_to_string(folder.path().join("scene.toml")).expect("a scene");
    for part in [
        "# [boundary.top]",
        "not flat",
        "[[fixed_point]]",
        "pressure",
    ] {
        assert!(text.contains(part), "{part}:\n{text}");
    }
}

#[test]
fn a_scene_that_is_there_stays() {
    let folder = scratch();
    let mesh = folder.path().join("base.msh");
    fs::write(&mesh, MESH).expect("written");
    let scene = folder.path().join("scene.toml");
    fs::write(&scene, "mine").expect("written");
    let run = on("init", &mesh);
    assert_eq!((run.code, run.out.as_str()), (Some(2), ""));
    assert!(
        run.err.contains("already") && run.err.contains("--out"),
        "{}",
        run.err
    );
    assert_eq!(fs::read_to_string(&scene).expect("a text"), "mine");
    let run = on("init", &folder.path().join("nothing.msh"));
    assert_eq!(run.code, Some(2), "{}", run.err);
    let run = on("init", &scene);
    assert!(
        run.code == Some(2) && run.err.contains("(.geo)"),
        "{}",
        run.err
    );
    let run = on("init", folder.path());
    assert!(
        run.code == Some(2) && run.err.contains("run it: kluft run"),
        "{}",
        run.err
    );
}

#[test]
fn a_folder_means_the_scene_in_it() {
    let workshop = Workshop::new("inclined-joint", &[]);
    let folder = workshop.scene().parent().expect("a folder").to_owned();
    assert_eq!(on("inspect", &folder).code, Some(0));
    fs::rename(workshop.scene(), workshop.path("joint.toml")).expect("renamed");
    fs::write(workshop.path("network.toml"), "[mesh]\nh = 1\n").expect("written");
    assert_eq!(on("inspect", &folder).code, Some(0), "the only scene");
    fs::copy(workshop.path("joint.toml"), workshop.path("other.toml")).expect("copied");
    let run = on("run", &folder);
    assert_eq!(run.code, Some(2));
    for name in ["joint.toml", "other.toml", "several scenes"] {
        assert!(run.err.contains(name), "{name}: {}", run.err);
    }
}

#[test]
fn shells_and_man_know_every_command() {
    let commands = [
        "run", "init", "inspect", "network", "study", "explain", "schema",
    ];
    for arguments in [
        ["completions", "bash"],
        ["completions", "zsh"],
        ["completions", "fish"],
    ] {
        let run = kluft(&arguments);
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
        for command in commands {
            assert!(run.out.contains(command), "{arguments:?} {command}");
        }
        assert!(run.out.contains("no-report"));
    }
    let run = kluft(&["man"]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    for command in commands {
        assert!(
            run.out.contains(&format!("kluft {command}"))
                || run.out.contains(&format!("kluft\\-{command}")),
            "{command}"
        );
    }
    assert!(!run.out.contains("start-gmsh") && run.out.contains("\\-\\-no\\-report"));
}

#[test]
fn a_geometry_of_the_plane_becomes_a_scene_in_plane_strain() {
    let (folder, text) = made("line-crack");
    for part in [
        "geometry = \"line-crack.geo\"",
        "\ndimension = 2 ",
        "# parameters = { h = 0.02, grow = 0.15, h_far = 4.0 } #",
        "a physical surface of",
        "[fracture.crack]",
        "2.0000 m long",
        "[boundary.top]",
    ] {
        assert!(text.contains(part), "{part}:\n{text}");
    }
    for absent in ["[[fixed_point]]", "# [boundary.left]", "end of z"] {
        assert!(!text.contains(absent), "{absent}:\n{text}");
    }
    let coarse = "\nparameters = { h = 0.3, half = 4 }\ndimension = 2 ";
    let text = edited(&text, &[("\ndimension = 2 ", coarse)]);
    fs::write(folder.path().join("scene.toml"), text).expect("written");
    crack_closes(folder.path());
}

#[test]
fn a_mesh_of_the_plane_becomes_a_scene_too() {
    let folder = scratch();
    let geometry = root().join("geometries/line-crack/line-crack.geo");
    let mesh = folder.path().join("crack.msh");
    let made = Command::new("gmsh")
        .args(["-2", "-setnumber", "h", "0.3", "-setnumber", "half", "4"])
        .args(["-format", "msh41", "-v", "1", "-o"])
        .args([&mesh, &geometry])
        .status();
    assert!(made.expect("gmsh").success());
    let run = on("init", &mesh);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    let text = fs::read_to_string(folder.path().join("scene.toml")).expect("a scene");
    assert!(text.contains("file = \"crack.msh\""), "{text}");
    assert!(!text.contains("dimension = "), "{text}");
    crack_closes(folder.path());
}

/// Surfaces alone that lie in no plane are no rock.
#[test]
fn a_geometry_without_rock_is_told_what_it_lacks() {
    let folder = scratch();
    let file = folder.path().join("box.geo");
    let script = "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 1, 1};\n";
    let surfaces = format!("{script}Physical Surface(\"s\") = {{1, 3}};");
    fs::write(&file, surfaces).expect("written");
    let run = on("init", &file);
    assert_eq!((run.code, run.out.as_str()), (Some(2), ""));
    assert!(run.err.contains("Physical Volume"), "{}", run.err);
    let volume = format!("{script}Physical Volume(\"r\") = {{1}};");
    fs::write(&file, volume).expect("written");
    let run = on("init", &file);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    let text = fs::read_to_string(folder.path().join("scene.toml")).expect("a scene");
    assert!(!text.contains("parameters"), "it has none:\n{text}");
}

#[test]
fn a_scene_that_a_run_would_refuse_is_no_promise() {
    let (folder, mesh) = two_cells();
    let run = on("init", &mesh);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    for part in ["too little", "holds the body", "[[fixed_point]]"] {
        assert!(run.out.contains(part), "{part}: {}", run.out);
    }
    let run = on("run", folder.path());
    assert_eq!(run.code, Some(2), "{}", run.err);
    assert!(run.err.contains("nothing holds it"), "{}", run.err);
}

/// A limit on the size of files stands for a disk that is full.
#[test]
fn a_full_disk_leaves_no_scene_that_is_cut_off() {
    let (folder, mesh) = two_cells();
    let script = "trap '' XFSZ; ulimit -f 0; exec \"$0\" \"$@\"";
    let run = command("bash")
        .args(["-c", script, KLUFT, "init"])
        .arg(&mesh)
        .output();
    let run: Run = run.expect("it starts").into();
    assert_eq!((run.code, run.out.as_str()), (Some(1), ""), "{}", run.err);
    assert!(run.err.contains("scene.toml: cannot be"), "{}", run.err);
    let left: Vec<String> = crate::harness::files(folder.path()).into_keys().collect();
    assert_eq!(left, ["base.msh"]);
    assert_eq!(on("init", &mesh).code, Some(0));
}

#[test]
fn a_place_that_no_scene_can_have_is_wrong_input() {
    let (folder, mesh) = two_cells();
    let place = |name: &str| folder.path().join(name);
    for (name, cure) in [
        ("x.msh", "x.toml"),
        ("x.geo", "x.toml"),
        ("x.VTU", "x.toml"),
        ("no/such/scene.toml", "create the folder"),
        ("base.msh/scene.toml", "create the folder"),
        ("", "name a file in it"),
    ] {
        let run = init_at(&mesh, &place(name));
        assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{name}");
        assert!(run.err.contains(cure), "{name}: {}", run.err);
        assert!(!place(name).is_file(), "{name}");
    }
    assert_eq!(init_at(&mesh, &place("other.TOML")).code, Some(0));
}

/// The words that a shell makes of the command in a text.
fn words_of_shell(text: &str, command: &str) -> Vec<String> {
    let mut lines = text.lines().rev();
    let line = lines.find_map(|line| line.find(command).map(|at| &line[at..]));
    let line = line.expect("a command");
    let script = format!("printf '%s\\n' {line}");
    let said = Command::new("sh").args(["-c", &script]).output();
    let said = String::from_utf8(said.expect("a shell").stdout).expect("text");
    said.lines().map(str::to_owned).collect()
}

#[test]
fn commands_that_come_next_are_for_a_shell() {
    let folder = scratch();
    let inside = folder.path().join("two words's");
    fs::create_dir(&inside).expect("a folder");
    let list = "name,shape,x,y,z,dip,dip_direction,radius\nfloor,disc,5,5,4,10,90,3.5\n";
    for (name, text, subcommand, next) in [
        ("base.msh", MESH, "init", "run"),
        ("list.csv", list, "network", "run"),
        ("grid.vtu", GRID, "import", "inspect"),
    ] {
        fs::write(inside.join(name), text).expect("written");
        let (input, made) = (inside.join(name), inside.join(subcommand));
        let (run, scene) = match subcommand {
            "init" => (on(subcommand, &input), inside.join("scene.toml")),
            _ => {
                let [input, out] = [&input, &made].map(|path| path.as_os_str());
                let run = kluft(&[subcommand.as_ref(), input, "-vo".as_ref(), out]);
                (run, made.join("scene.toml"))
            }
        };
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{subcommand}");
        let words = words_of_shell(&run.out, &format!("kluft {next}"));
        assert_eq!(words, ["kluft", next, &*scene.to_string_lossy()]);
    }
    let run = on("run", &inside.join("base.msh"));
    let mesh = inside.join("base.msh").display().to_string();
    let quoted = format!("kluft inspect '{}'", mesh.replace('\'', r"'\''"));
    assert!(run.err.contains(&quoted), "{}", run.err);
}
