//! Wrong ways to call the program, and the help that it gives.

use crate::harness::{Run, kluft, root};

fn refused(arguments: &[&str]) -> Run {
    let run = kluft(arguments);
    assert_eq!(run.code, Some(2), "{arguments:?}: {}", run.err);
    assert_eq!(run.out, "", "{arguments:?}");
    assert!(!run.err.contains("panicked"), "{}", run.err);
    run
}

#[test]
fn the_bare_program_shows_its_help() {
    let run = refused(&[]);
    for part in ["Usage: kluft", "run", "Examples:", "Exit status:"] {
        assert!(run.err.contains(part), "{part}: {}", run.err);
    }
}

#[test]
fn wrong_arguments_are_named_with_the_usage() {
    for (arguments, named) in [
        (&["run"][..], "SCENE"),
        (&["walk"], "walk"),
        (&["inspect"], "INPUT"),
        (&["inspect", "scene.toml", "--jsn"], "--json"),
        (&["run", "scene.toml", "--thread", "2"], "--threads"),
        (&["run", "scene.toml", "--threads", "0"], "--threads"),
        (&["run", "scene.toml", "--threads", "many"], "many"),
        (&["run", "scene.toml", "--out"], "--out"),
        (&["run", "scene.toml", "-q", "-v"], "cannot be used with"),
        (&["study"], "SCENE"),
        (&["study", "scene.toml", "--tolerance", "0"], "1% or 0.01"),
        (
            &["study", "scene.toml", "--tolerance", "100%"],
            "1% or 0.01",
        ),
        (&["network", "list.csv"], "--out"),
        (
            &["network", "list.csv", "-o", "x", "--domain", "0,0,0,1,1"],
            "six numbers",
        ),
        (
            &["network", "list.csv", "-o", "x", "--domain", "0,0,0,1,-1,1"],
            "above the first",
        ),
        (&["network", "list.csv", "-o", "x", "--h", "-1"], "--h"),
        (&["schema", "mesh"], "scene, network, study"),
        (
            &["network", "list.csv", "-o", "x", "--name", "a/b"],
            "without folders",
        ),
    ] {
        let run = refused(arguments);
        assert!(run.err.contains(named), "{arguments:?}: {}", run.err);
        assert!(run.err.contains("--help"), "{arguments:?}: {}", run.err);
    }
}

#[test]
fn help_and_version_are_answers() {
    for (arguments, named) in [
        (&["--help"][..], "Exit status:"),
        (&["run", "--help"], "[fracture.joint]"),
        (&["network", "--help"], "dip_direction"),
        (&["inspect", "--help"], "inspect.vtu"),
        (&["study", "--help"], "orders = [1, 2]"),
        (&["explain", "rock.young_modulus"], "[rock.NAME]"),
        (&["explain", "[load]"], "phase"),
        (&["explain"], "[[fixed_point]]"),
        (&["schema"], "\"young_modulus\""),
        (&["schema", "network"], "\"fracture_set\""),
        (&["--version"], env!("CARGO_PKG_VERSION")),
    ] {
        let run = kluft(arguments);
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
        assert!(run.out.contains(named), "{arguments:?}: {}", run.out);
    }
}

#[test]
fn an_unknown_key_is_explained_by_the_nearest() {
    let run = refused(&["explain", "yung_modulus"]);
    assert!(
        run.err.contains("did you mean young_modulus"),
        "{}",
        run.err
    );
    let run = refused(&["explain", "qqqqqq"]);
    assert!(run.err.contains("lists all keys"), "{}", run.err);
}

/// The help of the program and of each of its commands, as a page.
fn help_as_a_page() -> String {
    let whole = kluft(&["--help"]).out;
    let commands = whole.split("Commands:\n").nth(1).expect("a list");
    let commands = commands.split("\n\n").next().expect("its end");
    // Names stand two columns in, what goes on from the line before further.
    let named = commands.lines().filter(|line| !line.starts_with("   "));
    let names = named.filter_map(|line| line.split_whitespace().next());
    let mut page = "# Commands and options\n\nWhat `kluft --help` and `kluft COMMAND --help` say; \
                    see also the [command line](command-line.md).\n\n```text\n"
        .to_owned();
    page += &(whole.trim_end().to_owned() + "\n```\n");
    for name in names.filter(|name| *name != "help") {
        let help = kluft(&[name, "--help"]).out;
        page += &format!("\n## {name}\n\n```text\n{}\n```\n", help.trim_end());
    }
    let lines = page.lines().map(str::trim_end);
    lines.map(|line| line.to_owned() + "\n").collect()
}

/// With `KLUFT_BLESS=1` the page is written again.
#[test]
fn the_page_of_the_command_line_is_what_the_help_says() {
    let file = root().join("docs/reference/options.md");
    let made = help_as_a_page();
    for command in ["## run", "## inspect", "## study", "--resume", "## man"] {
        assert!(made.contains(command), "{made}");
    }
    if std::env::var_os("KLUFT_BLESS").is_some_and(|value| value == "1") {
        std::fs::write(&file, &made).expect("written");
    }
    let committed = std::fs::read_to_string(&file).unwrap_or_default();
    let remedy = "docs/reference/options.md is stale: run this test with KLUFT_BLESS=1";
    assert!(committed == made, "{remedy}");
}
