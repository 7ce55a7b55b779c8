//! Scenes of `geometries/` with another mesh, run by the program in a folder of their own.

use std::fs;
use std::path::{Path, PathBuf};

use glam::DVec3;
use kluft_run::Ending;
use kluft_solver::{Discretisation, FacetResult, Problem};
use serde_json::Value;
use tempfile::TempDir;

use crate::{root, scenes};

/// A finished run.
pub struct Outcome {
    folder: TempDir,
    /// What `summary.json` holds.
    pub summary: Value,
}

/// Runs `geometries/SCENE` with these lines in `[mesh]` (beside `geometry`) and these parts of its
/// text replaced.
pub fn run(scene: &str, mesh: &str, replaced: &[(&str, &str)]) -> Outcome {
    let own = root().join("geometries").join(scene);
    let text = fs::read_to_string(own.join("scene.toml")).expect("a scene");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("scene.toml");
    fs::write(&file, varied(&text, &own, mesh, replaced)).expect("a scene of its own");
    let ran = scenes::run_scene_file(&file, &folder.path().join("out"));
    let ran = ran.unwrap_or_else(|defects| panic!("{scene}, {mesh}: {defects:?}"));
    assert_eq!(ran.ending, Ending::Solved, "{scene}, {mesh}");
    let summary = fs::read_to_string(folder.path().join("out/summary.json")).expect("a summary");
    let summary = serde_json::from_str(&summary).expect("JSON");
    Outcome { folder, summary }
}

fn varied(text: &str, own: &Path, mesh: &str, replaced: &[(&str, &str)]) -> String {
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
    let text = format!("{}{section}{}", &text[..start], &text[end..]);
    replaced.iter().fold(text, |text, (from, to)| {
        assert!(text.contains(from), "{from} is not in the scene");
        text.replace(from, to)
    })
}

impl Outcome {
    fn measure(&self, name: &str, of: &str) -> f64 {
        let all = self.summary["measures"].as_array().into_iter().flatten();
        let mut all = all.filter(|measure| measure["name"] == name);
        let found = all.next().and_then(|measure| measure[of].as_f64());
        found.unwrap_or_else(|| panic!("no {of} of {name}"))
    }

    /// A measure against its closed form.
    pub fn error(&self, name: &str) -> f64 {
        self.measure(name, "error")
    }

    /// The value of a measure.
    pub fn value(&self, name: &str) -> f64 {
        self.measure(name, "value")
    }

    /// Its closed form.
    pub fn exact(&self, name: &str) -> f64 {
        self.measure(name, "exact")
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.summary["unknowns"]["total"].as_u64().expect("a count") as usize
    }

    /// A number of the only fracture.
    pub fn of_fracture(&self, path: &[&str]) -> Option<f64> {
        let fractures = self.summary["fractures"].as_object()?;
        let start = fractures.values().next()?;
        path.iter().fold(start, |value, key| &value[key]).as_f64()
    }

    /// The problem on the mesh of the run.
    pub fn problem(&self) -> Problem {
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

    /// Nodes of the facets and the results there.
    pub fn facet_nodes(&self) -> Vec<(DVec3, FacetResult)> {
        let problem = self.problem();
        let solution = scenes::solve(&problem);
        let interface = Discretisation::of(&problem)
            .expect("supported")
            .into_interface();
        let results = solution.facet_nodes(&problem, &interface);
        let nodes = problem.mesh.facets.elements.nodes.iter();
        let places = nodes.map(|&node| problem.mesh.nodes[node as usize]);
        places.zip(results).collect()
    }
}

/// Of many points those nearest to evenly spaced places from 0 to `end`, from left to right.
pub fn thinned(mut points: Vec<(f64, f64)>, end: f64, count: usize) -> Vec<(f64, f64)> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let nearest = |i: usize| {
        let place = end * i as f64 / (count - 1) as f64;
        let by = |point: &&(f64, f64)| (point.0 - place).abs();
        *points
            .iter()
            .min_by(|a, b| by(a).total_cmp(&by(b)))
            .expect("points")
    };
    let mut chosen: Vec<(f64, f64)> = (0..count).map(nearest).collect();
    chosen.dedup_by(|a, b| a.0 == b.0);
    chosen
}
