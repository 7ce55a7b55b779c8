//! A mesh is made once, whoever asks for it.

use crate::harness::{Run, Workshop, kluft_with};

/// Runs a command of the program on the scene of a workshop, which keeps its meshes beside it.
fn kluft(workshop: &Workshop, command: &str, flags: &[&str]) -> Run {
    let (scene, cache) = (workshop.scene(), workshop.path("cache"));
    let mut arguments = vec![command, scene.to_str().expect("a path")];
    arguments.extend(flags);
    let cache = cache.to_str().expect("a path");
    let run = kluft_with(
        &arguments,
        &[("KLUFT_CACHE", cache), ("KLUFT_GMSH", "gmsh")],
    );
    assert_eq!(run.code, Some(0), "{}", run.err);
    run
}

/// Puts a program in the place of gmsh that must not be started.
fn without_gmsh(workshop: &Workshop, command: &str, flags: &[&str]) -> Run {
    kluft(
        workshop,
        command,
        &[flags, &["--mesh-timeout", "0.001"]].concat(),
    )
}

#[test]
fn a_run_that_changes_a_load_starts_no_gmsh() {
    let workshop = Workshop::new("inclined-joint", &[]);
    let first = kluft(&workshop, "run", &["-v"]);
    assert!(!first.out.contains("mesh kept"), "{}", first.out);
    let grid = || std::fs::read(workshop.path("out/rock_0001.vtu")).expect("a grid");
    let (mesh, before) = (
        std::fs::read(workshop.path("out/mesh.msh")).expect("a mesh"),
        grid(),
    );
    let scene = std::fs::read_to_string(workshop.scene()).expect("a scene");
    std::fs::write(workshop.scene(), format!("{scene}\n# The same loads.\n")).expect("written");
    let second = without_gmsh(&workshop, "run", &["-v"]);
    assert!(second.out.contains("mesh kept"), "{}", second.out);
    assert_eq!(
        std::fs::read(workshop.path("out/mesh.msh")).expect("a mesh"),
        mesh
    );
    assert!(grid() == before, "the same results");
    without_gmsh(&workshop, "inspect", &[]);
    let again = kluft(&workshop, "run", &["-v", "--remesh"]);
    assert!(!again.out.contains("mesh kept"), "{}", again.out);
}
