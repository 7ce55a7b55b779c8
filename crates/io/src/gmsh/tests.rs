//! gmsh, and scripts that play it badly.

use std::fs;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::meshing::mesh_with;
use super::*;

const BOX: &str = "SetFactory(\"OpenCASCADE\");\nDefineConstant[ h = 1 ];\nBox(1) = {0, 0, 0, 1, 1, 1};\n\
    MeshSize{:} = h;\n";

/// A folder of its own, with the geometry in it; removed in the end.
struct Scene {
    folder: PathBuf,
}

impl Scene {
    fn new(name: &str, geometry: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("kluft-gmsh-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a temporary folder");
        fs::write(folder.join("in.geo"), geometry).expect("written");
        Self { folder }
    }

    fn mesh(
        &self,
        program: &str,
        parameters: &[(String, f64)],
    ) -> Result<Vec<String>, Vec<Defect>> {
        self.mesh_as(program, parameters, &GmshOptions::default())
    }

    fn mesh_as(
        &self,
        program: &str,
        parameters: &[(String, f64)],
        options: &GmshOptions,
    ) -> Result<Vec<String>, Vec<Defect>> {
        let gmsh = Gmsh {
            program: program.into(),
            options,
        };
        let meshing = Meshing {
            geometry: &self.folder.join("in.geo"),
            parameters,
            order: 1,
            dimension: Dimension::default(),
            sizes: None,
            output: &self.folder.join("out put.msh"),
            gmsh: options,
        };
        mesh_with(&gmsh, &meshing).map(|meshed| meshed.warnings)
    }

    fn fails_with(&self, problem: &str) {
        self.fails_as("gmsh", &GmshOptions::default(), problem);
    }

    fn fails_as(&self, program: &str, options: &GmshOptions, problem: &str) -> Vec<Defect> {
        let files = || fs::read_dir(&self.folder).expect("there").count();
        let before = files();
        let defects = self.mesh_as(program, &[], options).expect_err(problem);
        let told = defects.iter().any(|d| d.to_string().contains(problem));
        assert!(told, "{problem}: {defects:?}");
        assert_eq!(files(), before, "nothing is left behind");
        defects
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.folder);
    }
}

#[test]
fn the_file_format_that_a_geometry_chooses_is_not_taken() {
    for option in ["MshFileVersion = 2.2", "Format = 39", "Binary = 0"] {
        let scene = Scene::new("format", &format!("{BOX}Mesh.{option};\n"));
        scene.mesh("gmsh", &[]).expect("a mesh");
        let made = fs::read(scene.folder.join("out put.msh")).expect("written");
        assert!(made.starts_with(b"$MeshFormat\n4.1 1 8\n"), "{option}");
    }
}

#[test]
fn a_parameter_changes_the_mesh() {
    let scene = Scene::new("parameter", BOX);
    let size = |h: f64| {
        let warnings = scene.mesh("gmsh", &[("h".to_owned(), h)]).expect("a mesh");
        assert_eq!(warnings, Vec::<String>::new());
        fs::metadata(scene.folder.join("out put.msh"))
            .expect("written")
            .len()
    };
    assert!(size(0.3) > 2 * size(1.0));
}

#[test]
fn warnings_are_handed_on() {
    let scene = Scene::new("warning", &format!("{BOX}Warning(\"look here\");\n"));
    assert_eq!(scene.mesh("gmsh", &[]), Ok(vec!["look here".to_owned()]));
}

#[test]
fn errors_name_the_line() {
    Scene::new("syntax", &format!("{BOX}Bxo(3) = {{1}};\n"))
        .fails_with("in.geo, line 5: gmsh: syntax");
    Scene::new("variable", &format!("{BOX}k = nix;\n"))
        .fails_with("line 5: gmsh: Unknown variable");
}

#[test]
fn a_run_without_volume_elements_fails() {
    Scene::new("empty", "x = 1;\n").fails_with("no volume elements");
    let surface_only = format!("{BOX}Physical Surface(1) = {{1}};\n");
    Scene::new("surface", &surface_only).fails_with("no volume elements");
    Scene::new("exit", &format!("{BOX}Exit;\n")).fails_with("wrote no mesh");
}

#[test]
fn a_missing_program_is_named_with_its_remedy() {
    let defects = Scene::new("missing", BOX)
        .mesh("no-such-gmsh", &[])
        .expect_err("not there");
    let text = defects[0].to_string();
    assert!(
        text.contains("apt-get install gmsh") && text.contains("KLUFT_GMSH"),
        "{text}"
    );
}

#[test]
fn a_program_that_fails_silently_is_noticed() {
    let defects = Scene::new("false", BOX)
        .mesh("false", &[])
        .expect_err("fails");
    assert!(
        defects[0].problem.contains("without an error message"),
        "{defects:?}"
    );
}

#[test]
fn a_missing_geometry_and_a_wrong_order_are_defects() {
    let scene = Scene::new("order", BOX);
    let fails = |geometry: &Path, order| {
        let meshing = Meshing {
            geometry,
            parameters: &[],
            order,
            dimension: Dimension::default(),
            sizes: None,
            output: Path::new("out.msh"),
            gmsh: &GmshOptions::default(),
        };
        mesh_geometry(&meshing).is_err()
    };
    assert!(fails(&scene.folder.join("in.geo"), 3));
    assert!(fails(&scene.folder.join("nix.geo"), 1));
    assert!(fails(&scene.folder, 1));
}

/// A program in the folder that plays gmsh.
#[cfg(unix)]
fn player(scene: &Scene, text: &str) -> String {
    use std::os::unix::fs::PermissionsExt;
    let file = scene.folder.join("gmsh.sh");
    // Asked for its version it has none.
    let asked = "test \"$1\" != --version || exit 1";
    fs::write(&file, format!("#!/bin/sh\n{asked}\n{text}\n")).expect("written");
    fs::set_permissions(&file, fs::Permissions::from_mode(0o755)).expect("executable");
    file.display().to_string()
}

#[cfg(unix)]
#[test]
fn a_library_that_is_missing_is_named_with_its_package() {
    // As Python's ctypes says it, and as the loader of glibc does.
    let words = [
        "OSError: libGLU.so.1: cannot open shared object file: No such file or directory",
        "gmsh: error while loading shared libraries: libGLU.so.1: cannot open shared object file: \
         No such file or directory",
    ];
    for said in words {
        let scene = Scene::new("library", BOX);
        let program = player(&scene, &format!("echo '{said}' >&2; exit 1"));
        let defects = scene.mesh(&program, &[]).expect_err("it fails");
        let text = defects[0].to_string();
        for part in ["the library libGLU.so.1,", "apt-get install libglu1-mesa"] {
            assert!(text.contains(part), "{part}: {text}");
        }
    }
}

#[cfg(unix)]
#[test]
fn tools_are_found_before_the_search_path_and_by_gmsh_itself() {
    let scene = Scene::new("tools", BOX);
    let said = scene.folder.join("said");
    player(
        &scene,
        &format!("echo \"$PATH\" > '{}'; exit 1", said.display()),
    );
    let options = GmshOptions {
        tools: Some(scene.folder.clone()),
        ..GmshOptions::default()
    };
    scene
        .mesh_as("gmsh.sh", &[], &options)
        .expect_err("it fails");
    let path = fs::read_to_string(said).expect("it was started");
    assert!(
        path.starts_with(&format!("{}:", scene.folder.display())),
        "{path}"
    );
}

#[cfg(unix)]
#[test]
fn last_words_and_the_signal_are_told() {
    let scene = Scene::new("words", BOX);
    let program = player(&scene, "echo one; echo out of luck >&2; kill -SEGV $$");
    let defects = scene.fails_as(&program, &GmshOptions::default(), "out of luck");
    assert!(defects[0].problem.contains("SIGSEGV"), "{defects:?}");
}

#[cfg(unix)]
#[test]
fn a_program_that_prints_or_waits_for_ever_ends_with_its_time() {
    let options = GmshOptions {
        time_limit: Some(Duration::from_millis(300)),
        ..GmshOptions::default()
    };
    for (name, text) in [
        ("prints", "while :; do echo so much to say; done"),
        ("waits", "while :; do :; done"),
        ("child", "sleep 5 & wait"),
    ] {
        let scene = Scene::new(name, BOX);
        let program = player(&scene, text);
        let begin = std::time::Instant::now();
        let defects = scene.fails_as(&program, &options, "--mesh-timeout");
        assert!(defects[0].problem.contains("0.3 s"), "{defects:?}");
        assert_eq!(defects[0].code, Some(NOT_MESHED));
        assert!(begin.elapsed() < Duration::from_secs(4), "{name}");
    }
}

#[cfg(unix)]
#[test]
fn a_program_whose_mesh_nobody_wants_any_more_is_ended() {
    let stop = Arc::new(AtomicBool::new(false));
    let options = GmshOptions {
        stop: Some(Arc::clone(&stop)),
        ..GmshOptions::default()
    };
    let scene = Scene::new("unwanted", BOX);
    let program = player(&scene, "while :; do :; done");
    std::thread::spawn(move || {
        std::thread::sleep(Duration::from_millis(200));
        stop.store(true, Ordering::Relaxed);
    });
    let begin = std::time::Instant::now();
    let defects = scene.fails_as(&program, &options, "start again");
    assert_eq!(defects[0].code, Some(NOT_MESHED));
    assert!(begin.elapsed() < Duration::from_secs(4));
}

#[cfg(unix)]
#[test]
fn a_mesh_that_is_cut_off_is_told_from_one_without_cells() {
    let scene = Scene::new("cut", BOX);
    // The last argument is the file to write.
    let text = "for last; do :; done; printf '$MeshFormat\\n4.1 1 8\\n' > \"$last\"";
    let program = player(&scene, text);
    let defects = scene.fails_as(&program, &GmshOptions::default(), "cut off");
    assert_eq!(defects[0].code, Some(NOT_MESHED));
    assert!(defects[0].remedy.contains("space"), "{defects:?}");
}

#[test]
fn a_geometry_that_does_more_is_refused_unless_trusted() {
    let trusting = GmshOptions {
        trust: true,
        ..GmshOptions::default()
    };
    for (name, more, problem) in [
        (
            "system",
            "SystemCall \"touch in.geo.pwned\";",
            "line 5: `SystemCall` would run",
        ),
        (
            "printf",
            "Printf(\"x\") > \"in.geo.pwned\";",
            "line 5: `Printf` would write",
        ),
        (
            "save",
            "Save \"in.geo.pwned\";",
            "line 5: `Save` would write",
        ),
        (
            "computed",
            "Merge Str(\"a.geo\");",
            "what `Merge` would open",
        ),
        (
            "etc",
            "Merge \"/etc/passwd\";",
            "would read /etc/passwd, a file of the system",
        ),
    ] {
        let scene = Scene::new(name, &format!("{BOX}{more}\n"));
        let defects = scene.fails_as("gmsh", &GmshOptions::default(), problem);
        assert!(defects[0].remedy.contains("--trust"), "{defects:?}");
    }
    let scene = Scene::new("trusted", &format!("{BOX}Printf(\"x\") > \"written\";\n"));
    scene.mesh_as("gmsh", &[], &trusting).expect("a mesh");
    assert!(scene.folder.join("written").exists());
}

#[test]
fn what_a_geometry_opens_is_reviewed_too() {
    let scene = Scene::new("includes", &format!("{BOX}Include \"a.inc\";\n"));
    let write = |name: &str, text: &str| fs::write(scene.folder.join(name), text).expect("written");
    write("a.inc", "Include \"in.geo\";\nMerge 'b.step.opt';");
    write("b.step.opt", "\n\nSystemCall \"a\";");
    scene.fails_as(
        "gmsh",
        &GmshOptions::default(),
        "b.step.opt, line 3: `SystemCall`",
    );
    write("b.step.opt", "");
    write("in.geo.opt", "Save \"a\";");
    scene.fails_as(
        "gmsh",
        &GmshOptions::default(),
        "in.geo.opt, line 1: `Save`",
    );
    write("in.geo.opt", "Merge \"c.py\";");
    write("c.py", "");
    scene.fails_as(
        "gmsh",
        &GmshOptions::default(),
        "c.py: gmsh would run a program",
    );
}

/// Surfaces alone are another mesh than volumes, which is kept by itself.
#[test]
fn surfaces_are_meshed_without_volumes() {
    let scene = Scene::new("surfaces", BOX);
    let kept = tempfile::tempdir().expect("a temporary folder");
    let options = GmshOptions {
        cache: Some(MeshCache::at(kept.path().to_owned())),
        ..GmshOptions::default()
    };
    let counts = |dimension| {
        let output = scene.folder.join("out.msh");
        let meshing = Meshing {
            geometry: &scene.folder.join("in.geo"),
            parameters: &[],
            order: 1,
            dimension,
            sizes: None,
            output: &output,
            gmsh: &options,
        };
        let is_kept = mesh_geometry(&meshing).expect("a mesh").is_kept;
        let draft = crate::read_msh(&output).expect("a mesh");
        (
            draft.cells.elements.is_empty(),
            draft.facets.elements.is_empty(),
            is_kept,
        )
    };
    assert_eq!(counts(Dimension::Surfaces), (true, false, false));
    assert_eq!(counts(Dimension::Volumes), (false, false, false));
    assert_eq!(counts(Dimension::Surfaces), (true, false, true));
}

/// What a mesh is made into, and whether it was there.
fn meshed(scene: &Scene, h: f64, options: &GmshOptions) -> (bool, Vec<u8>) {
    let output = scene.folder.join("out put.msh");
    let meshing = Meshing {
        geometry: &scene.folder.join("in.geo"),
        parameters: &[("h".to_owned(), h)],
        order: 1,
        dimension: Dimension::default(),
        sizes: None,
        output: &output,
        gmsh: options,
    };
    let meshed = mesh_geometry(&meshing).expect("a mesh");
    (meshed.is_kept, fs::read(&output).expect("written"))
}

#[test]
fn a_mesh_is_made_once_until_something_of_it_changes() {
    let scene = Scene::new("cache", &format!("{BOX}Include \"a.inc\";\n"));
    let include = |text: &str| fs::write(scene.folder.join("a.inc"), text).expect("written");
    let options = GmshOptions {
        cache: Some(MeshCache::at(scene.folder.join("meshes"))),
        ..GmshOptions::default()
    };
    include("x = 1;");
    let (was_there, first) = meshed(&scene, 0.5, &options);
    assert!(!was_there);
    assert_eq!(meshed(&scene, 0.5, &options), (true, first.clone()));
    assert!(!meshed(&scene, 0.4, &options).0, "another parameter");
    include("x = 2;");
    assert!(!meshed(&scene, 0.5, &options).0, "another include");
    include("x = 1;");
    assert_eq!(meshed(&scene, 0.5, &options), (true, first));
    include("x = GetEnv(\"HOME\");");
    assert!(!meshed(&scene, 0.5, &options).0, "what else it depends on");
    assert!(!meshed(&scene, 0.5, &options).0, "is not known");
}

#[cfg(unix)]
#[test]
fn where_the_usual_way_fails_another_is_tried() {
    let scene = Scene::new("ways", BOX);
    let text = "case \"$*\" in *'Mesh.Algorithm3D 1e1 '*) ;; *) echo 'Error : no luck'; exit 1;; esac\n\
                exec gmsh \"$@\"";
    let program = player(&scene, text);
    let warnings = scene.mesh(&program, &[]).expect("a mesh");
    assert_eq!(
        warnings,
        [
            "gmsh's usual way failed: gmsh: no luck",
            "meshed in another way: HXT"
        ]
    );
    let chosen = [("Mesh.Algorithm3D".to_owned(), 1.0)];
    let defects = scene.mesh(&program, &chosen).expect_err("no other way");
    assert!(defects[0].problem.contains("no luck"), "{defects:?}");
    let chooses = format!("{BOX}Mesh.Algorithm3D = 1;\n");
    fs::write(scene.folder.join("in.geo"), chooses).expect("written");
    scene.mesh(&program, &[]).expect_err("no other way");
}

#[cfg(unix)]
#[test]
fn a_mesh_with_flat_or_overlapping_cells_is_made_in_another_way() {
    let flat = "1 4 1 4\\n3 1 0 4\\n1\\n2\\n3\\n4\\n0 0 0\\n1 0 0\\n0 1 0\\n1 1 0\\n\
                $EndNodes\\n$Elements\\n1 1 1 1\\n3 1 4 1\\n1 1 2 3 4\\n";
    let overlapping = "1 5 1 5\\n3 1 0 5\\n1\\n2\\n3\\n4\\n5\\n\
                       0 0 0\\n1 0 0\\n0 1 0\\n0 0 1\\n0.2 0.2 2\\n\
                       $EndNodes\\n$Elements\\n1 2 1 2\\n3 1 4 2\\n1 1 2 3 4\\n2 1 2 3 5\\n";
    for (name, mesh, problem) in [
        ("flat", flat, "the cell has no volume"),
        (
            "overlapping",
            overlapping,
            "the cell overlaps its neighbour",
        ),
    ] {
        let scene = Scene::new(name, BOX);
        let text = format!(
            "for last; do :; done; case \"$*\" in *'Mesh.Algorithm3D 1e1 '*) exec gmsh \"$@\";; esac\n\
             printf '$MeshFormat\\n4.1 0 8\\n$EndMeshFormat\\n$Nodes\\n{mesh}$EndElements\\n' \
             > \"$last\""
        );
        let warnings = scene.mesh(&player(&scene, &text), &[]).expect("a mesh");
        assert!(warnings[0].contains(problem), "{warnings:?}");
    }
}

#[cfg(unix)]
#[test]
fn the_forms_of_a_network_are_tried_in_turn() {
    let network = format!(
        "// made by `kluft network` from a.csv\nDefineConstant[ form = {{0, Name \"form\"}} ];\n{BOX}"
    );
    let scene = Scene::new("forms", &network);
    let text = "case \"$*\" in *'form 1e0 '*) exec gmsh \"$@\";; esac\nkill -SEGV $$";
    let warnings = scene.mesh(&player(&scene, text), &[]).expect("a mesh");
    assert!(
        warnings[0].starts_with("whole fractures failed"),
        "{warnings:?}"
    );
    assert_eq!(warnings[1], "meshed in another way: split fractures");
    let text = "kill -SEGV $$";
    let defects = scene.mesh(&player(&scene, text), &[]).expect_err("none");
    for way in ["whole fractures", "split fractures, surfaces by Delaunay"] {
        let failed = format!("{way} failed");
        assert!(defects[0].problem.contains(&failed), "{defects:?}");
    }
    let form = [("form".to_owned(), 0.0)];
    scene
        .mesh(&player(&scene, text), &form)
        .expect_err("no other form");
}
