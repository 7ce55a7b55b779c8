//! `kluft init`: a scene for a mesh or a geometry, which runs; folders with a scene.

use std::fs;
use std::path::Path;

use crate::harness::{Run, Workshop, kluft, root, scratch, summary};

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
    let text = fs::read_to_string(folder.path().join("scene.toml")).expect("a scene");
    (folder, text)
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
    fs::write(&mesh, include_str!("bad_input/base.msh")).expect("written");
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
    fs::write(&mesh, include_str!("bad_input/base.msh")).expect("written");
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
