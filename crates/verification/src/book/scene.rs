//! Scenes of `geometries/` with another mesh, run by the program in a folder of their own.

use std::fs;
use std::path::{Path, PathBuf};

use kluft_run::Ending;
use kluft_solver::{Discretisation, Problem};
use serde_json::Value;
use tempfile::TempDir;

use crate::{root, scenes};

/// A finished run.
pub struct Outcome {
    folder: TempDir,
    /// What `summary.json` holds.
    pub summary: Value,
}

/// Runs `geometries/SCENE` with these lines in `[mesh]` (beside `geometry`).
pub fn run(scene: &str, mesh: &str) -> Outcome {
    run_edited(scene, mesh, &[])
}

/// The same with parts of its text replaced, each of which it must have.
pub fn run_edited(scene: &str, mesh: &str, edits: &[(&str, &str)]) -> Outcome {
    let own = root().join("geometries").join(scene);
    let mut text = fs::read_to_string(own.join("scene.toml")).expect("a scene");
    for (part, other) in edits {
        assert!(text.contains(part), "{scene} has no {part}");
        text = text.replace(part, other);
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("scene.toml");
    fs::write(&file, varied(&text, &own, mesh)).expect("a scene of its own");
    let ran = scenes::run_scene_file(&file, &folder.path().join("out"));
    let ran = ran.unwrap_or_else(|defects| panic!("{scene}, {mesh}: {defects:?}"));
    assert_eq!(ran.ending, Ending::Solved, "{scene}, {mesh}");
    let summary = fs::read_to_string(folder.path().join("out/summary.json")).expect("a summary");
    let summary = serde_json::from_str(&summary).expect("JSON");
    Outcome { folder, summary }
}

fn varied(text: &str, own: &Path, mesh: &str) -> String {
    let start = text.find("[mesh]").expect("a mesh");
    let end = start + text[start..].find("\n\n").expect("an end of the section");
    let named = text[start..end].lines();
    let geometry = named
        .filter_map(|line| line.strip_prefix("geometry = \""))
        .next();
    let geometry = geometry
        .and_then(|rest| rest.strip_suffix('"'))
        .expect("a geometry");
    let geometry: PathBuf = own.join(geometry);
    let section = format!("[mesh]\ngeometry = {geometry:?}\n{mesh}");
    format!("{}{section}{}", &text[..start], &text[end..])
}

impl Outcome {
    fn measure(&self, name: &str, of: &str) -> f64 {
        let all = self.summary["measures"].as_array().into_iter().flatten();
        let mut all = all.filter(|measure| measure["name"] == name);
        let found = all.next().and_then(|measure| measure[of].as_f64());
        found.unwrap_or_else(|| panic!("no {of} of {name}"))
    }

    /// The value of a measure.
    pub fn value(&self, name: &str) -> f64 {
        self.measure(name, "value")
    }

    /// Its closed form.
    pub fn exact(&self, name: &str) -> f64 {
        self.measure(name, "exact")
    }

    /// Its error.
    pub fn error(&self, name: &str) -> f64 {
        self.measure(name, "error")
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.summary["unknowns"]["total"].as_u64().expect("a count") as usize
    }

    /// A value of a probe of one point, or of a mean, after the last load step.
    pub fn probed(&self, probe: &str, column: &str) -> f64 {
        let file = self.folder.path().join("out/probes.csv");
        let text = fs::read_to_string(file).expect("probes");
        let mut rows = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let head = rows.next().unwrap_or_default();
        let place = |name: &str| head.iter().position(|own| *own == name).expect("a column");
        let of = place("probe");
        let row = rows.rfind(|row| row[of] == probe);
        let row = row.unwrap_or_else(|| panic!("no probe {probe}"));
        row[place(column)].parse().unwrap_or(f64::NAN)
    }

    /// A number of a fracture.
    pub fn of(&self, fracture: &str, path: &[&str]) -> f64 {
        let start = &self.summary["fractures"][fracture];
        let found = path.iter().fold(start, |value, key| &value[key]);
        found.as_f64().unwrap_or(f64::NAN)
    }

    /// A number of the only fracture.
    pub fn of_fracture(&self, path: &[&str]) -> Option<f64> {
        let fractures = self.summary["fractures"].as_object()?;
        let start = fractures.values().next()?;
        path.iter().fold(start, |value, key| &value[key]).as_f64()
    }

    /// The problem on the mesh of the run.
    fn problem(&self) -> Problem {
        let file = self.folder.path().join("scene.toml");
        let mesh = self.folder.path().join("out/mesh.msh");
        let draft = kluft_io::load_msh(&mesh, self.folder.path(), &Default::default());
        let draft = draft.unwrap_or_else(|defects| panic!("{defects:?}"));
        scenes::bound(&file, draft)
    }

    /// Mean magnitude of the slip (m), over the area.
    pub fn mean_slip(&self) -> f64 {
        let problem = self.problem();
        let solution = scenes::solve(&problem);
        let interface = Discretisation::of(&problem)
            .expect("supported")
            .into_interface();
        let points = || interface.points().iter().zip(&solution.facet_points);
        let slip: f64 = points()
            .map(|(point, found)| point.area * found.slip.length())
            .sum();
        slip / points().map(|(point, _)| point.area).sum::<f64>()
    }
}
