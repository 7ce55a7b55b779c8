//! Nothing lost: one run a folder, and nothing written over or removed that no run has written.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

use crate::harness::{KLUFT, Run, Workshop, command, edited, files, kluft, scratch, write_gmsh};

const SCENE: &str = include_str!("bad_input/base.toml");
const MESH: &str = include_str!("bad_input/base.msh");

fn run_into(scene: &Path, out: &Path) -> Run {
    kluft(&[
        "run".as_ref(),
        scene.as_os_str(),
        "--out".as_ref(),
        out.as_os_str(),
    ])
}

/// Refused without a change to the folder; returns what was said.
fn assert_refused(scene: &Path, out: &Path) -> String {
    let before = files(out);
    let run = run_into(scene, out);
    assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{}", run.err);
    assert_eq!(files(out), before);
    assert!(run.err.contains("--out"), "{}", run.err);
    run.err
}

#[test]
fn a_second_run_into_a_folder_is_refused_while_the_first_works() {
    let workshop = Workshop::new("inclined-joint", &[]);
    let gmsh = workshop.path("gmsh");
    write_gmsh(&gmsh, "sleep 2\nexec gmsh \"$@\"");
    let (scene, out) = (workshop.scene(), workshop.path("out"));
    let mut first = command(KLUFT)
        // A confined gmsh starts no other program.
        .args(["run", "--trust"])
        .arg(&scene)
        .env("KLUFT_GMSH", &gmsh)
        .stdout(Stdio::null())
        .spawn()
        .expect("the program starts");
    while !out.join(".kluft/holder").exists() {
        std::thread::sleep(Duration::from_millis(2));
    }
    let holder = format!("(process {})", first.id());
    let out_text = out.display().to_string();
    for command in ["run", "inspect"] {
        let run = kluft(&[command, &scene.display().to_string(), "--out", &out_text]);
        assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{}", run.err);
        for text in [
            "another run is writing to this folder",
            &holder,
            &out_text,
            "wait",
        ] {
            assert!(run.err.contains(text), "{text}: {}", run.err);
        }
    }
    assert_eq!(first.wait().expect("gone").code(), Some(0));
    assert!(out.join("rock.pvd").exists() && !out.join(".kluft/tmp").exists());
    assert_eq!(
        workshop.run("out", &[]).code,
        Some(0),
        "the folder is free again"
    );
}

#[test]
fn the_claim_ends_with_the_process_however_it_ends() {
    let workshop = Workshop::new("inclined-joint", &[]);
    let gmsh = workshop.path("gmsh");
    write_gmsh(&gmsh, "exec sleep 3");
    let mut first = command(KLUFT)
        .arg("run")
        .arg(workshop.scene())
        .env("KLUFT_GMSH", &gmsh)
        .spawn()
        .expect("the program starts");
    while !workshop.path("out/.kluft/holder").exists() {
        std::thread::sleep(Duration::from_millis(2));
    }
    first.kill().expect("killed");
    first.wait().expect("gone");
    workshop.solve("out", &[]);
}

#[test]
fn links_in_the_place_of_files_are_not_followed() {
    let folder = scratch();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("scene.toml"), SCENE).expect("written");
    fs::write(path("base.msh"), MESH).expect("written");
    fs::write(path("precious"), "precious").expect("written");
    fs::create_dir(path("out")).expect("a folder");
    for name in [
        ".kluft-probe",
        ".summary.json.tmp",
        ".inspect.vtu.tmp",
        ".inspect.json.tmp",
    ] {
        symlink(path("precious"), path("out").join(name)).expect("a link");
    }
    assert_eq!(run_into(&path("scene.toml"), &path("out")).code, Some(0));
    let (scene, out) = (path("scene.toml"), path("out"));
    let arguments = [
        "inspect".as_ref(),
        scene.as_os_str(),
        "--out".as_ref(),
        out.as_os_str(),
    ];
    assert_eq!(kluft(&arguments).code, Some(0));
    assert_eq!(
        fs::read_to_string(path("precious")).expect("a text"),
        "precious"
    );
}

#[test]
fn inputs_are_not_written_over() {
    for (scene, mesh) in [("resume.bin", "base.msh"), ("scene.toml", "summary.json")] {
        let folder = scratch();
        let path = |name: &str| folder.path().join(name);
        let text = edited(SCENE, &[("base.msh", mesh)]);
        fs::write(path(scene), text).expect("written");
        fs::write(path(mesh), MESH).expect("written");
        let said = assert_refused(&path(scene), folder.path());
        assert!(said.contains("which they are made from"), "{said}");
    }
}

#[test]
fn a_geometry_called_as_the_mesh_is_not_written_over() {
    let geometry = [(
        "geometry = \"inclined-joint.geo\"",
        "geometry = \"mesh.msh\"",
    )];
    let workshop = Workshop::new("inclined-joint", &geometry);
    fs::rename(
        workshop.path("inclined-joint.geo"),
        workshop.path("mesh.msh"),
    )
    .expect("renamed");
    let said = assert_refused(&workshop.scene(), &workshop.path(""));
    assert!(said.contains("mesh.msh: the results would be"), "{said}");
}

#[test]
fn what_looks_like_a_result_survives_if_no_run_has_written_it() {
    let folder = scratch();
    let path = |name: &str| folder.path().join(name);
    fs::write(
        path("scene.toml"),
        edited(SCENE, &[("base.msh", ".a.tmp.msh")]),
    )
    .expect("written");
    fs::write(path(".a.tmp.msh"), MESH).expect("written");
    fs::write(path("rock_2024.vtu"), "mine").expect("written");
    for _ in 0..2 {
        let run = run_into(&path("scene.toml"), folder.path());
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    }
    assert_eq!(
        fs::read_to_string(path("rock_2024.vtu")).expect("a text"),
        "mine"
    );
    assert_eq!(
        fs::read_to_string(path(".a.tmp.msh")).expect("a text"),
        MESH
    );
    fs::remove_dir_all(path(".kluft")).expect("removed");
    fs::write(path("fractures_0001.vtu"), "mine").expect("written");
    fs::remove_file(path("fractures.pvd")).expect("removed");
    let said = assert_refused(&path("scene.toml"), folder.path());
    assert!(
        said.contains("fractures_0001.vtu: the results would be"),
        "{said}"
    );
}

#[test]
fn a_folder_without_a_list_is_known_by_what_it_names() {
    let folder = scratch();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("scene.toml"), SCENE).expect("written");
    fs::write(path("base.msh"), MESH).expect("written");
    assert_eq!(run_into(&path("scene.toml"), &path("out")).code, Some(0));
    fs::remove_dir_all(path("out/.kluft")).expect("removed");
    assert_eq!(run_into(&path("scene.toml"), &path("out")).code, Some(0));
}

#[test]
fn a_network_is_not_written_over_what_it_is_made_from_nor_over_a_geometry_of_the_user() {
    let folder = scratch();
    let list = "name,set,shape,x,y,z,dip,dip_direction,radius\nf1,s,disc,5,5,5,70,135,3\n";
    fs::write(folder.path().join("list.csv"), list).expect("written");
    fs::write(folder.path().join("network.geo"), "// mine\n").expect("written");
    let (input, out) = (folder.path().join("list.csv"), folder.path());
    let arguments = [
        "network".as_ref(),
        input.as_os_str(),
        "-o".as_ref(),
        out.as_os_str(),
    ];
    let run = kluft(&arguments);
    assert_eq!(run.code, Some(2), "{}", run.err);
    assert!(
        run.err.contains("network.geo: the results would be"),
        "{}",
        run.err
    );
    let kept = fs::read_to_string(folder.path().join("network.geo")).expect("a text");
    assert_eq!(kept, "// mine\n");
    fs::remove_file(folder.path().join("network.geo")).expect("removed");
    for _ in 0..2 {
        let run = kluft(&arguments);
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
        // Without a list its files are known by their heads.
        fs::remove_dir_all(folder.path().join(".kluft")).expect("removed");
    }
}
