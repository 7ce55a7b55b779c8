//! Geometries of strangers: nothing happens behind the user's back, and gmsh never runs on.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::harness::{KLUFT, Run, Workshop, command, kluft, kluft_with, scratch, write_gmsh};

/// A command that only gmsh finds out, spelled so that no reader can.
fn hidden(command: &str) -> String {
    let (first, second) = command.split_at(3);
    format!("StringToName[StrCat(\"{first}\", \"{second}\")]")
}

/// A scene on a box of rock, whose geometry ends with more commands.
fn scene(more: &str) -> Workshop {
    let workshop = Workshop::new("inclined-joint", &[]);
    let geometry = workshop.path("inclined-joint.geo");
    let text = fs::read_to_string(&geometry).expect("the geometry") + more;
    fs::write(geometry, text).expect("written");
    workshop
}

fn inspect(workshop: &Workshop, flags: &[&str]) -> Run {
    let (scene, out) = (workshop.scene(), workshop.path("out"));
    let mut arguments = vec!["inspect".as_ref(), scene.as_os_str(), "--out".as_ref()];
    arguments.push(out.as_os_str());
    arguments.extend(flags.iter().map(std::ffi::OsStr::new));
    kluft(&arguments)
}

/// Whether this kernel confines; the program finds out in the same way that it is used in.
#[expect(
    clippy::print_stdout,
    reason = "who reads the tests wants to know what they leave out"
)]
fn is_confined_here() -> bool {
    let workshop = scene(&format!("{} \"x\";\n", hidden("NoSuchCommand")));
    let run = inspect(&workshop, &[]);
    // Where gmsh cannot be confined, a name that is computed is refused before gmsh starts.
    let refused = run
        .err
        .contains("on this machine nothing keeps gmsh from it");
    if refused {
        println!("skipped: this kernel has no Landlock");
    }
    !refused
}

#[test]
fn a_geometry_that_would_run_a_program_is_refused() {
    let workshop = scene("\nSystemCall \"touch pwned\";\n");
    let target = workshop.path("pwned");
    for run in [workshop.run("out", &[]), inspect(&workshop, &[])] {
        assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{}", run.err);
        for text in [
            "inclined-joint.geo, line ",
            "`SystemCall` would run a program",
            "--trust",
        ] {
            assert!(run.err.contains(text), "{text}: {}", run.err);
        }
    }
    let study = kluft(&["study".as_ref(), workshop.scene().as_os_str()]);
    assert_eq!(study.code, Some(1), "{}", study.err);
    assert!(
        study.err.contains("`SystemCall` would run"),
        "{}",
        study.err
    );
    assert!(!target.exists() && !Path::new("pwned").exists());
}

#[test]
fn who_trusts_a_geometry_lets_it_do_everything() {
    let workshop = scene("");
    let target = workshop.path("written by the geometry");
    let command = format!("\nSystemCall \"echo x > '{}'\";\n", target.display());
    let geometry = workshop.path("inclined-joint.geo");
    let text = fs::read_to_string(&geometry).expect("the geometry") + &command;
    fs::write(geometry, text).expect("written");
    let run = inspect(&workshop, &["--trust"]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    assert!(target.exists());
}

#[test]
fn what_no_reader_finds_the_confinement_stops() {
    if !is_confined_here() {
        return;
    }
    let workshop = scene("");
    let outside = workshop.path("outside");
    let secret = workshop.path("secret").join("parameters.inc");
    fs::create_dir(secret.parent().expect("a folder")).expect("made");
    fs::write(&secret, "x = 1;\n").expect("written");
    // A folder of its own, so that what lies beside it is not its own.
    let inner = workshop.path("inner");
    fs::create_dir(&inner).expect("made");
    for name in ["scene.toml", "inclined-joint.geo"] {
        fs::copy(workshop.path(name), inner.join(name)).expect("copied");
    }
    let geometry = fs::read_to_string(inner.join("inclined-joint.geo")).expect("the geometry");
    let attempts = [
        format!("{} \"touch {}\";", hidden("SystemCall"), outside.display()),
        format!(
            "{} \"{}\";",
            hidden("Save"),
            outside.with_extension("msh").display()
        ),
        format!("{} \"{}\";", hidden("CreateDir"), outside.display()),
        format!("Include Str(\"{}\");", secret.display()),
    ];
    for (number, attempt) in attempts.iter().enumerate() {
        fs::write(
            inner.join("inclined-joint.geo"),
            format!("{geometry}\n{attempt}\n"),
        )
        .expect("written");
        let run = |flags: &[&str]| {
            let scene = inner.join("scene.toml");
            let mut arguments = vec!["inspect".as_ref(), scene.as_os_str()];
            arguments.extend(flags.iter().map(std::ffi::OsStr::new));
            kluft(&arguments)
        };
        let confined = run(&[]);
        assert!(
            !outside.exists() && !outside.with_extension("msh").exists(),
            "{attempt}"
        );
        let reads = number == 3;
        if reads {
            assert_eq!(confined.code, Some(2), "{attempt}");
            assert!(confined.err.contains("parameters.inc"), "{}", confined.err);
        }
        // What the attempt is good for where nobody stops it.
        let trusted = run(&["--trust"]);
        assert_eq!(trusted.code, Some(0), "{attempt}: {}", trusted.err);
        let made = outside.exists() || outside.with_extension("msh").exists();
        assert!(made || reads, "{attempt}");
        let _ = fs::remove_file(&outside);
        let _ = fs::remove_dir(&outside);
        let _ = fs::remove_file(outside.with_extension("msh"));
    }
}

/// Fractures whose mesh depends on addresses, with those of gmsh 4.8.
const NETWORK: &str = r#"
seed = 1
[domain]
low = [0, 0, 0]
high = [10, 10, 10]
[mesh]
h = 2
h_fracture = 1
[fracture_set.a]
aperture = 1e-3
normal_stiffness = 2e10
shear_stiffness = 1e10
orientation = { dip = 70, dip_direction = 135, kappa = 1 }
size = { law = "constant", radius = 3 }
count = 14
"#;

#[test]
fn one_geometry_gives_one_mesh() {
    let folder = scratch();
    let description = folder.path().join("network.toml");
    fs::write(&description, NETWORK).expect("written");
    let made = folder.path().join("made");
    let arguments = ["network".as_ref(), description.as_os_str(), "-o".as_ref()];
    let network = kluft(&[&arguments[..], &[made.as_os_str()]].concat());
    assert_eq!(network.code, Some(0), "{}", network.err);
    let meshes: Vec<Vec<u8>> = (0..5)
        .map(|number| {
            let out = folder.path().join(format!("out-{number}"));
            let scene = made.join("scene.toml");
            let arguments = ["inspect".as_ref(), scene.as_os_str(), "--out".as_ref()];
            // Whatever is said of the scene, its mesh is there.
            let run = kluft(&[&arguments[..], &[out.as_os_str()]].concat());
            fs::read(out.join("mesh.msh")).unwrap_or_else(|_| panic!("{}", run.err))
        })
        .collect();
    assert!(meshes.iter().all(|mesh| *mesh == meshes[0]));
}

/// A script that plays gmsh, in the folder of a scene.
fn player(workshop: &Workshop, text: &str) -> String {
    let file = workshop.path("gmsh.sh");
    write_gmsh(&file, text);
    file.display().to_string()
}

#[test]
fn a_mesh_that_takes_too_long_ends_with_its_time() {
    let endless = scene("\nFor i In {1:1e12}\nEndFor\n");
    let printing = scene("");
    let program = player(&printing, "while :; do echo so much to say; done");
    for (workshop, gmsh) in [(endless, "gmsh".to_owned()), (printing, program)] {
        let scene = workshop.scene();
        for command in ["run", "inspect"] {
            let out = workshop.path(command);
            let mut arguments = vec![command.as_ref(), scene.as_os_str(), "--out".as_ref()];
            arguments.extend([out.as_os_str(), "--mesh-timeout".as_ref(), "0.8".as_ref()]);
            let begin = Instant::now();
            let run = kluft_with(&arguments, &[("KLUFT_GMSH", &*gmsh)]);
            assert_eq!((run.code, run.out.as_str()), (Some(1), ""), "{}", run.err);
            for text in [
                "not meshed: ",
                "after 0.8 s",
                "larger cells",
                "--mesh-timeout SECONDS",
            ] {
                assert!(run.err.contains(text), "{text}: {}", run.err);
            }
            assert!(begin.elapsed() < Duration::from_secs(20));
            let left = fs::read_dir(out).expect("the results");
            let left = left.map(|entry| entry.expect("an entry").file_name());
            let left: Vec<_> = left.filter(|name| name != ".kluft").collect();
            assert!(left.is_empty(), "{left:?} is left behind");
        }
    }
}

/// Processes whose arguments name a folder.
fn working_in(folder: &Path) -> Vec<String> {
    let folder = folder.display().to_string();
    let processes = fs::read_dir("/proc").expect("processes").flatten();
    let lines = processes.filter_map(|entry| fs::read(entry.path().join("cmdline")).ok());
    let lines = lines.map(|line| String::from_utf8_lossy(&line).replace('\0', " "));
    lines.filter(|line| line.contains(&folder)).collect()
}

fn wait_until(what: &str, holds: impl Fn() -> bool) {
    let begin = Instant::now();
    while !holds() {
        assert!(begin.elapsed() < Duration::from_secs(30), "{what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn gmsh_does_not_outlive_the_program() {
    let workshop = scene("\nFor i In {1:1e12}\nEndFor\n");
    let scene = workshop.scene();
    let folder = scene.parent().expect("a folder");
    let start = |name: &str| -> Child {
        let mut program = command(KLUFT);
        program
            .arg(name)
            .arg(&scene)
            .arg("--out")
            .arg(folder.join("out"));
        program.stdout(Stdio::null()).stderr(Stdio::null());
        program.spawn().expect("the program starts")
    };
    for command in ["run", "inspect"] {
        let mut child = start(command);
        let is_gmsh = |line: &String| !line.contains("start-gmsh") && line.contains("-setnumber");
        wait_until("gmsh runs", || working_in(folder).iter().any(is_gmsh));
        child.kill().expect("killed");
        child.wait().expect("it has ended");
        wait_until("gmsh ends", || working_in(folder).is_empty());
    }
}

#[test]
fn pipes_and_folders_are_refused_by_name() {
    let workshop = scene("");
    let pipe = workshop.path("pipe.msh");
    mkfifo(&pipe);
    let scene_of = |mesh: &str| {
        let text = fs::read_to_string(workshop.scene()).expect("the scene");
        let begin = text.find("[mesh]").expect("a mesh");
        let end = begin + text[begin + 1..].find("\n[").expect("more") + 1;
        let file = workshop.path(&format!("{}.toml", mesh.replace([' ', '"', '='], "")));
        fs::write(
            &file,
            format!("{}[mesh]\n{mesh}\n{}", &text[..begin], &text[end..]),
        )
        .expect("written");
        file
    };
    let folder = workshop.path("folder.msh");
    fs::create_dir(&folder).expect("made");
    for (input, name) in [
        (pipe.clone(), "pipe.msh"),
        (folder.clone(), "folder.msh"),
        (scene_of("file = \"pipe.msh\""), "pipe.msh"),
        (scene_of("geometry = \"pipe.msh\""), "pipe.msh"),
        (scene_of("geometry = \"folder.msh\""), "folder.msh"),
    ] {
        for command in ["inspect", "run"] {
            let run = kluft(&[command.as_ref(), input.as_os_str()]);
            assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{}", run.err);
            assert!(run.err.contains(name), "{}", run.err);
        }
    }
    for (command, name) in [
        ("network", "pipe.csv"),
        ("network", "network.toml"),
        ("import", "pipe.inp"),
        ("import", "pipe.prj"),
        ("import", "pipe.vtu"),
        ("import", "pipe.e"),
    ] {
        let pipe = workshop.path(name);
        mkfifo(&pipe);
        let out = workshop.path("out");
        let arguments = [command.as_ref(), pipe.as_os_str(), "-o".as_ref()];
        let run = kluft(&[&arguments[..], &[out.as_os_str()]].concat());
        assert_eq!(run.code, Some(2), "{name}: {}", run.err);
        assert!(run.err.contains("no ordinary file"), "{name}: {}", run.err);
    }
    let as_scene = workshop.path("pipe.toml");
    fs::rename(&pipe, &as_scene).expect("renamed");
    let run = kluft(&["run".as_ref(), as_scene.as_os_str()]);
    assert_eq!(run.code, Some(2), "{}", run.err);
    assert!(run.err.contains("no ordinary file"), "{}", run.err);
}

fn mkfifo(path: &Path) {
    let made = Command::new("mkfifo").arg(path).status();
    assert!(made.expect("mkfifo starts").success());
}

#[test]
fn a_mesh_of_an_older_version_is_no_way_around() {
    let workshop = scene("");
    let mesh = workshop.path("old.msh");
    let script = "\n$MeshFormat\n2.2 0 8\n$EndMeshFormat\nx;\nSystemCall \"touch pwned\";\n";
    for text in [script, &script[1..]] {
        fs::write(&mesh, text).expect("written");
        let run = kluft(&["inspect".as_ref(), mesh.as_os_str()]);
        assert_eq!(run.code, Some(2), "{}", run.err);
        assert!(run.err.contains("old.msh"), "{}", run.err);
        assert!(!Path::new("pwned").exists());
    }
    fs::write(&mesh, &script[1..]).expect("written");
    fs::write(workshop.path("old.msh.opt"), "SystemCall \"touch pwned\";").expect("written");
    let run = kluft(&["inspect".as_ref(), mesh.as_os_str()]);
    assert!(
        run.err.contains("old.msh.opt, line 1: `SystemCall`"),
        "{}",
        run.err
    );
}
