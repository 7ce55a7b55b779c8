//! What studies found becomes pages, and the committed ones are those of the writer.

use std::fs;

use kluft_verification::report::{Effort, Finding, Layout, Report, Study, Table};
use kluft_verification::{book, closures, root, soak, stability};
use tempfile::tempdir;

const STUDY: Study = Study {
    name: "levers",
    title: "Levers, long and short",
    subject: "lengths from 1 to 2 m",
    run,
};

fn run(effort: Effort) -> Finding {
    let mut table = Table::new(&["length (m)", "what it lifts"]);
    table.push(["1".to_owned(), "a stone, and its moss".to_owned()]);
    let words = "word ".repeat(30);
    Finding::new(["short ones".to_owned(), format!("{effort:?}")])
        .text(format!("{words}`two words` and 5 %."))
        .table(table)
        .missing(vec!["1 m: broke".to_owned()])
}

fn report(layout: Layout) -> Report {
    Report {
        name: "physics",
        head: "# Physics",
        columns: &["study", "sweep", "what breaks", "ours"],
        studies: vec![STUDY],
        layout,
    }
}

#[test]
fn studies_of_one_page_stand_below_their_overview() {
    let folder = tempdir().expect("a folder");
    let promise = "All hold.".to_owned();
    let report = report(Layout::OnePage { promise });
    report
        .run(&STUDY, Effort::Quick, folder.path())
        .expect("files");
    report.write_overview(folder.path()).expect("a page");
    let page = fs::read_to_string(folder.path().join("physics.md")).expect("a page");
    let row = "| [Levers, long and short](#levers-long-and-short) | lengths from 1 to 2 m | short ones | Quick |";
    for part in [
        row,
        "\n## Levers, long and short\n",
        "- *Levers, long and short*: 1 m: broke\n",
    ] {
        assert!(page.contains(part), "{part}: {page}");
    }
    assert!(
        page.contains("Numbers: [levers.csv](physics/levers.csv)"),
        "{page}"
    );
    let csv = fs::read_to_string(folder.path().join("physics/levers.csv")).expect("numbers");
    assert_eq!(
        csv,
        "length (m),what it lifts\n1,\"a stone, and its moss\"\n"
    );
    let prose = page.lines().filter(|line| !line.starts_with('|'));
    assert!(prose.clone().all(|line| line.len() <= 100), "{page}");
    assert!(
        prose.clone().any(|line| line.contains("`two words`")),
        "{page}"
    );
}

#[test]
fn studies_with_a_page_each_say_how_to_make_it_again() {
    let folder = tempdir().expect("a folder");
    let report = report(Layout::PageEach);
    report
        .run(&STUDY, Effort::Full, folder.path())
        .expect("files");
    report.write_overview(folder.path()).expect("an overview");
    let own = folder.path().join("physics");
    let page = fs::read_to_string(own.join("levers.md")).expect("a page");
    assert!(
        page.starts_with("# Levers, long and short\n\nword"),
        "{page}"
    );
    assert!(
        page.contains("| 1 | a stone, and its moss |\n\nNumbers: [levers.csv](levers.csv)"),
        "{page}"
    );
    assert!(page.ends_with("--bin verify -- physics levers\n"), "{page}");
    let overview = fs::read_to_string(own.join("README.md")).expect("an overview");
    assert!(
        overview.contains("(levers.md) | lengths from 1 to 2 m | short ones | Full | 0 s |"),
        "{overview}"
    );
}

#[test]
fn a_study_that_is_not_there_is_named() {
    let report = report(Layout::PageEach);
    let problem = report
        .chosen(&["pulleys".to_owned()])
        .expect_err("no such study");
    assert!(
        problem.contains("pulleys") && problem.contains("levers"),
        "{problem}"
    );
}

/// Of all that was found, pages say what the sources say of it today.
#[test]
fn committed_overviews_are_those_of_the_writer() {
    let docs = root().join("docs/verification");
    for (report, kept, page) in [
        (
            stability::report(),
            "stability/findings.json",
            "stability.md",
        ),
        (closures::report(), "closures/findings.json", "closures.md"),
        (book::report(), "book/index.json", "book/README.md"),
        (soak::report(), "soak/findings.json", "soak.md"),
    ] {
        let folder = tempdir().expect("a folder");
        fs::create_dir(folder.path().join(report.name)).expect("a folder");
        fs::copy(docs.join(kept), folder.path().join(kept)).expect("what was found");
        report.write_overview(folder.path()).expect("a page");
        let written = fs::read_to_string(folder.path().join(page)).expect("a page");
        let committed = fs::read_to_string(docs.join(page)).expect("a page");
        assert!(
            written == committed,
            "{page} is not what `verify {} --rewrite` writes",
            report.name
        );
    }
}
