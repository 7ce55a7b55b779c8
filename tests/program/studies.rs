//! Studies of scenes: what `docs/verification/studies.md` says is of the scenes as they are.

use std::collections::BTreeSet;
use std::fs;

use toml::{Table, Value};

use crate::harness::{files, root};

/// Studies of scenes on nested meshes, as `scripts/studies.py` makes them.
const NESTED: [(&str, &str); 2] = [
    (
        "penny-nested",
        "refinements = [0, 1, 2]\nquarter_points = [true, false]",
    ),
    (
        "sphere-nested",
        "refinements = [0, 1, 2, 3]\norders = [1, 2]",
    ),
];

/// The studies on nested meshes, by name; the script has the same words.
fn nested() -> Vec<(String, Table)> {
    let script = fs::read_to_string(root().join("scripts/studies.py")).expect("the script");
    let studies = NESTED.map(|(name, study)| {
        assert!(script.contains(&study.replace('\n', "\\n")), "{name}");
        (name.to_owned(), study.parse().expect("a study"))
    });
    studies.into()
}

/// Scenes of `geometries/` with a section `[study]`, by name.
fn studies() -> Vec<(String, Table)> {
    let folders = fs::read_dir(root().join("geometries")).expect("the geometries");
    let study = |folder: fs::DirEntry| {
        let text = fs::read_to_string(folder.path().join("scene.toml")).ok()?;
        let scene: Table = text.parse().expect("a scene");
        let study = scene.get("study")?.as_table()?.clone();
        Some((folder.file_name().to_string_lossy().into_owned(), study))
    };
    folders.filter_map(|folder| study(folder.ok()?)).collect()
}

/// Number of settings, of lists only.
fn settings(study: &Table) -> usize {
    let lists = study.values().map(|value| match value {
        Value::Array(list) => list.len(),
        Value::Table(values) => settings(values),
        _ => 1,
    });
    lists.product()
}

#[test]
fn every_study_of_a_scene_is_run_and_shown() {
    let folder = root().join("docs/verification");
    let page = fs::read_to_string(folder.join("studies.md")).expect("the page");
    let mut known = BTreeSet::new();
    for (name, study) in studies().into_iter().chain(nested()) {
        let csv = format!("{name}.csv");
        let table = fs::read_to_string(folder.join("studies").join(&csv)).expect(&csv);
        let mut lines = table.lines();
        let heads: Vec<&str> = lines.next().expect("heads").split(',').collect();
        let unknowns = heads.iter().position(|head| *head == "unknowns");
        // No field before the unknowns of these studies holds a comma.
        let solved = lines.filter(|line| {
            let field = line.split(',').nth(unknowns.expect("a column"));
            field.is_some_and(|field| field.parse::<usize>().is_ok())
        });
        assert_eq!(solved.count(), settings(&study), "{csv}");
        assert!(page.contains(&format!("[{csv}](studies/{csv})")), "{csv}");
        known.insert(csv);
    }
    let charts = page.split("](studies/").skip(1);
    let charts = charts.filter_map(|part| part.split(')').next());
    known.extend(charts.map(str::to_owned));
    let committed: BTreeSet<String> = files(&folder.join("studies")).into_keys().collect();
    assert_eq!(committed, known);
}

/// Every number of unknowns in a table of the page is of a line of its CSV file.
#[test]
fn tables_are_those_of_the_numbers() {
    let folder = root().join("docs/verification");
    let page = fs::read_to_string(folder.join("studies.md")).expect("the page");
    let mut tables = 0;
    for part in page.split("<!-- table ").skip(1) {
        let (name, rest) = part.split_once(':').expect("a name");
        let csv = folder.join(format!("studies/{name}.csv"));
        let csv = fs::read_to_string(csv).expect(name);
        let mut rows = rest
            .lines()
            .skip(1)
            .take_while(|line| line.starts_with('|'));
        let cells = |line: &str| -> Vec<String> {
            let cells = line.split('|').map(|cell| cell.trim().to_owned());
            cells.collect()
        };
        let heads = cells(rows.next().expect("heads"));
        let column = heads.iter().position(|head| head == "unknowns");
        let rows: Vec<_> = rows.skip(1).map(cells).collect();
        assert_eq!(rows.len(), csv.lines().count() - 1, "{name}");
        for row in rows {
            let unknowns = format!(",{},", row[column.expect("a column")]);
            assert!(csv.contains(&unknowns), "{name}: {unknowns}");
        }
        tables += 1;
    }
    assert!(tables > 5, "{tables}");
}
