//! What the program prints, whatever names, titles and files hold: nothing that commands a terminal
//! or a spreadsheet, lines that fit, and few of them.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use crate::harness::{
    KLUFT, Run, Workshop, command, edited, kluft, kluft_with, scratch, write_gmsh,
};

const SCENE: &str = include_str!("bad_input/base.toml");
const MESH: &str = include_str!("bad_input/base.msh");
/// Sets the title of a terminal.
const COMMAND: &str = "\u{1b}]0;owned\u{7}";
const COLUMNS: usize = 80;

/// A scene of two cells, with texts of scene and mesh replaced.
fn two_cells(scene: &[(&str, &str)], mesh: &[(&str, &str)]) -> (TempDir, PathBuf) {
    let folder = scratch();
    let file = folder.path().join("scene.toml");
    fs::write(&file, edited(SCENE, scene)).expect("a scene");
    fs::write(folder.path().join("base.msh"), edited(MESH, mesh)).expect("a mesh");
    (folder, file)
}

fn on(command: &str, file: &Path, flags: &[&str]) -> Run {
    let mut arguments = vec![OsStr::new(command), file.as_os_str()];
    arguments.extend(flags.iter().map(OsStr::new));
    kluft(&arguments)
}

#[track_caller]
fn assert_plain(text: &str) {
    let raw = text.chars().find(|c| c.is_control() && *c != '\n');
    assert_eq!(raw, None, "{text:?}");
}

#[track_caller]
fn assert_fits(text: &str) {
    for line in text.lines() {
        assert!(line.chars().count() <= COLUMNS, "{line}\nin\n{text}");
    }
}

#[test]
fn titles_and_names_command_no_terminal() {
    let title = (
        "Two cells with a joint between",
        "a\\u001b]0;owned\\u0007\\nfake\\u009b2J",
    );
    let joint = (
        "[fracture.joint]",
        "[fracture.\"jo\\u001b]0;owned\\u0007int\"]",
    );
    let group = format!("\"jo{COMMAND}int\"");
    let (_folder, scene) = two_cells(&[title, joint], &[("\"joint\"", &group)]);
    for (command, flags) in [
        ("run", &["-v"][..]),
        ("inspect", &[]),
        ("inspect", &["--json"]),
    ] {
        let run = on(command, &scene, flags);
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{command}");
        assert_plain(&run.out);
        assert!(!run.out.contains("\nfake"), "{}", run.out);
        // The table of a run shows the ends of a long name.
        let shown = match (command, flags) {
            (_, ["--json"]) => "jo\\u001b]0;owned\\u0007int",
            ("run", _) => "jo\\u{1b}…u{7}int",
            _ => "jo\\u{1b}]0;owned\\u{7}int",
        };
        assert!(run.out.contains(shown), "{command}: {}", run.out);
    }
}

#[test]
fn messages_command_no_terminal() {
    let folder = scratch();
    let absent = folder.path().join(format!("no{COMMAND}\nscene.toml"));
    let run = on("run", &absent, &[]);
    assert_eq!(run.code, Some(2));
    assert_plain(&run.err);
    assert!(
        run.err.contains("no\\u{1b}]0;owned\\u{7}\\nscene.toml"),
        "{}",
        run.err
    );
    let run = kluft(&["run", "scene.toml", COMMAND]);
    assert_eq!(run.code, Some(2));
    assert_plain(&run.err);
    let (_folder, scene) = two_cells(&[("[fracture.joint]", "[fracture.\"\\u001bjoint\"]")], &[]);
    let run = on("run", &scene, &[]);
    assert_eq!(run.code, Some(2));
    assert_plain(&run.err);
}

/// A program in the place of gmsh, whose words go into messages.
#[test]
#[cfg(unix)]
fn what_gmsh_says_commands_no_terminal() {
    let workshop = Workshop::new("inclined-joint", &[]);
    let gmsh = workshop.path("gmsh");
    write_gmsh(
        &gmsh,
        "printf 'Error   : no \\033]0;owned\\007 volume\\n' >&2\nexit 1",
    );
    let scene = workshop.scene();
    let run = kluft_with(
        &["run".as_ref(), scene.as_os_str()],
        &[("KLUFT_GMSH", gmsh.to_str().expect("a path"))],
    );
    assert_eq!(run.code, Some(2));
    assert_plain(&run.err);
    assert!(
        run.err.contains("no \\u{1b}]0;owned\\u{7} volume"),
        "{}",
        run.err
    );
}

#[test]
fn a_study_commands_neither_terminal_nor_spreadsheet() {
    let title = ("Two cells with a joint between", "a\\u001b]0;owned\\u0007");
    let study = (
        "[rock.rock]",
        "[study]\nclosures = [\n\
         { label = \"=HYPERLINK(1)\", closure = \"linear\" },\n\
         { label = \"b\\u001b[2J\", closure = \"logarithmic\" },\n]\n\n[rock.rock]",
    );
    let (folder, scene) = two_cells(&[title, study], &[]);
    let run = on("study", &scene, &["-v"]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    assert_plain(&run.out);
    let read = |name: &str| fs::read_to_string(folder.path().join("study").join(name));
    let page = read("study.html").expect("a page");
    assert_plain(&page);
    assert!(
        page.contains("a\\u{1b}]0;owned\\u{7}"),
        "the title is shown"
    );
    let table = read("study.csv").expect("a table");
    assert_plain(&table);
    let mut rows = csv::Reader::from_reader(table.as_bytes());
    let cells: Vec<String> = rows
        .records()
        .flat_map(|row| {
            row.expect("a row")
                .iter()
                .map(str::to_owned)
                .collect::<Vec<_>>()
        })
        .collect();
    assert!(cells.contains(&"'=HYPERLINK(1)".to_owned()), "{cells:?}");
    assert!(!cells.iter().any(|cell| cell.starts_with('=')), "{cells:?}");
}

/// The two streams of a run whose output is a terminal and whose errors go to a file, and the other
/// way round; none where `script` of util-linux is not installed.
fn half_on_a_terminal(
    workshop: &Workshop,
    redirected: &str,
    flags: &str,
) -> Option<(String, String)> {
    let log = workshop.path("log");
    let line = format!(
        "'{}' run '{}' --out '{}' {flags} {redirected} '{}'",
        KLUFT,
        workshop.scene().display(),
        workshop.path("out").display(),
        log.display(),
    );
    let output = command("script")
        .args(["-qec", &line, "/dev/null"])
        .envs([("TERM", "xterm-256color"), ("NO_COLOR", "1")])
        .output()
        .ok()?;
    let shown = String::from_utf8_lossy(&output.stdout).into_owned();
    Some((shown, fs::read_to_string(log).expect("a log")))
}

#[test]
fn what_is_no_terminal_gets_a_plain_log() {
    let workshop = Workshop::new("inclined-joint", &[]);
    let run = workshop.run("out", &["-v"]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    assert_plain(&run.out);
    for kind in [
        "meshed ",
        "read ",
        "enriched ",
        "assembled ",
        "prepared ",
        "took ",
    ] {
        let lines = run.out.lines().filter(|line| line.starts_with(kind));
        assert_eq!(lines.count(), 1, "{kind}: {}", run.out);
    }
    let Some((shown, log)) = half_on_a_terminal(&workshop, "2>", "") else {
        return;
    };
    assert_eq!(log, "", "errors only");
    assert!(
        !shown.contains('\u{1b}'),
        "nothing moves on a terminal: {shown:?}"
    );
    let (shown, log) = half_on_a_terminal(&workshop, ">", "-v").expect("script");
    assert_plain(&log);
    assert!(log.contains("step 1 of 1"), "{log}");
    let coloured = shown.split("\u{1b}[").skip(1).any(|rest| {
        let end = rest.find(|c: char| c.is_ascii_alphabetic());
        end.is_some_and(|end| rest[end..].starts_with('m'))
    });
    assert!(!coloured, "{shown:?}");
}

#[test]
fn what_is_no_scene_is_told_in_one_sentence() {
    let folder = scratch();
    let file = |name: &str, content: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, content).expect("a file");
        path
    };
    let inside = folder.path().join("folder");
    fs::create_dir(&inside).expect("a folder");
    let mesh = file("mesh.msh", MESH.as_bytes());
    let others = [
        (
            file("block.geo", b"Box(1) = {0,0,0,1,1,1};"),
            "[mesh] geometry = \"block.geo\"",
        ),
        (
            file("grid.vtu", b"<?xml version=\"1.0\"?>\n<VTKFile>"),
            "a file of VTK",
        ),
        (file("scene.toml", b"\x7fELF\0\0\0\xff"), "binary data"),
        (file("list.csv", b"name,set\n"), "kluft network"),
        (file("polygons.dat", b"nPolygons: 1\n"), "kluft network"),
        (file("grid.inp", b"*NODE\n"), "kluft import"),
        (
            file("grid.mesh", b"MeshVersionFormatted 1\n"),
            "meshio convert",
        ),
        (inside, "a folder without a scene"),
    ];
    for command in ["run", "inspect", "study"] {
        for (path, named) in &others {
            let run = on(command, path, &[]);
            assert_eq!((run.code, run.out.as_str()), (Some(2), ""), "{path:?}");
            assert!(run.err.contains(named), "{command}, {named}: {}", run.err);
            assert!(run.err.contains("remedy: "), "{}", run.err);
            assert_eq!(run.err.lines().count(), 3, "{}", run.err);
        }
    }
    let run = on("run", &mesh, &[]);
    assert_eq!(run.code, Some(2));
    assert!(run.err.contains("kluft inspect "), "{}", run.err);
    let unnamed = file("mesh", MESH.as_bytes());
    let run = on("inspect", &unnamed, &[]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
}

#[test]
fn helps_and_explanations_fit_and_name_all_laws() {
    for arguments in [
        &["--help"][..],
        &["run", "--help"],
        &["network", "--help"],
        &["inspect", "--help"],
        &["study", "--help"],
        &["explain", "--help"],
        &["schema", "--help"],
        &["run", "-h"],
        &["explain"],
        &["explain", "closure"],
        &["explain", "fracture"],
        &["explain", "study"],
        &["explain", "length"],
    ] {
        let run = kluft(arguments);
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""), "{arguments:?}");
        assert_fits(&run.out);
    }
    for arguments in [
        &["run", "--help"][..],
        &["explain"],
        &["explain", "closure"],
    ] {
        let text = kluft(arguments).out;
        for law in &kluft_keys::scene::LAWS {
            assert!(
                text.contains(&format!("\n  {:<11}", law.name)),
                "{}: {text}",
                law.name
            );
        }
        assert!(text.contains("normal_stiffness, shear_stiffness"), "{text}");
    }
}

#[test]
fn reports_with_long_names_fit() {
    let long = "FRACTURE_".repeat(8);
    let title = "A title of many words ".repeat(8);
    let joint = format!("[fracture.{long}]");
    let group = format!("\"{long}\"");
    let (_folder, scene) = two_cells(
        &[
            ("Two cells with a joint between", &title),
            ("[fracture.joint]", &joint),
        ],
        &[("\"joint\"", &group)],
    );
    let run = on("inspect", &scene, &[]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    assert_fits(&run.out);
    let run = on("run", &scene, &["-v"]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    let from = run.out.find("\nstep 1 of 1").expect("a step");
    let to = run.out.find("\ntook ").expect("an end");
    assert_fits(&run.out[from..to]);
    assert!(run.out.contains("\nFRACTURE…ACTURE_  "), "{}", run.out);
}

#[test]
fn many_defects_are_counted() {
    let keys: String = (0..50).map(|i| format!("qqq{i} = 1\n")).collect();
    let (_folder, scene) = two_cells(&[("[rock.rock]\n", &format!("[rock.rock]\n{keys}"))], &[]);
    let run = on("run", &scene, &[]);
    assert_eq!(run.code, Some(2));
    assert!(
        run.err.starts_with("50 defects in the input\n"),
        "{}",
        run.err
    );
    assert_eq!(run.err.matches("remedy: ").count(), 20);
    assert!(
        run.err.contains("\n... and 30 more\n    30 such as "),
        "{}",
        run.err
    );
}

#[test]
fn a_mesh_without_groups_is_told_how_to_get_them() {
    let names = "5\n1 5 \"seam\"\n2 1 \"joint\"\n2 2 \"top\"\n2 3 \"bottom\"\n3 4 \"rock\"\n";
    let bare = [
        (names, "0\n"),
        ("1 0 0 0 1 0 0 1 5 0\n", "1 0 0 0 1 0 0 0 0\n"),
        ("1 0 0 0 1 1 0 1 1 0\n", "1 0 0 0 1 1 0 0 0\n"),
        ("2 0 0 0 1 1 1 1 2 0\n", "2 0 0 0 1 1 1 0 0\n"),
        ("3 0 0 -1 1 1 0 1 3 0\n", "3 0 0 -1 1 1 0 0 0\n"),
        ("1 0 0 -1 1 1 1 1 4 0\n", "1 0 0 -1 1 1 1 0 0\n"),
    ];
    let folder = scratch();
    let mesh = folder.path().join("bare.msh");
    fs::write(&mesh, edited(MESH, &bare)).expect("a mesh");
    let run = on("inspect", &mesh, &[]);
    assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
    for part in [
        "no physical groups",
        "Physical Surface(\"NAME\")",
        "Physical Volume(",
        "by their place only (`where`)",
    ] {
        let words: Vec<&str> = run.out.split_whitespace().collect();
        assert!(words.join(" ").contains(part), "{part}: {}", run.out);
    }
}

/// A line that is wrapped by the terminal breaks in the middle of an example.
#[test]
fn texts_of_help_are_written_for_eighty_columns() {
    let files = fs::read_dir(crate::harness::root().join("src/help")).expect("a folder");
    for file in files {
        assert_fits(&fs::read_to_string(file.expect("a file").path()).expect("a text"));
    }
}
