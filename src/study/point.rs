//! One setting: its scene, its run as a process of its own, and what is kept of it.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};
use std::time::Instant;

use kluft_io::{ClaimedFolder, write_atomically};
use kluft_mesh::Defect;
use serde::{Deserialize, Serialize};
use toml::Table;

use super::files::{RECORD, RESULTS, SCENE, remove_setting, unwritable};
use crate::gmsh::GmshArgs;
use kluft_io::gmsh::{NOT_MESHED, geometry_fingerprint};
use kluft_io::{Fingerprint, fingerprint, fingerprint_of};
use kluft_program::invocation::OwnProgram;
use kluft_run::Measure;
use kluft_scene::Scene;

/// Lines of a failed run's messages that are kept.
const LINES: usize = 10;

/// A setting that has been run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct PointRecord {
    /// Of everything that the run depends on but gmsh; empty if that is not known.
    pub(super) fingerprint: String,
    /// The version of gmsh that made the mesh; none if none did, or said no version.
    #[serde(default)]
    pub(super) gmsh: Option<String>,
    /// What came out of it.
    #[serde(flatten)]
    pub(super) outcome: PointOutcome,
}

/// What came out of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum PointOutcome {
    /// It solved the scene.
    Solved(Box<Numbers>),
    /// It did not, and why.
    Failed(String),
}

/// Numbers of a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Numbers {
    /// Wall-clock time of the process (s), gmsh included, also where its mesh stood there already.
    pub(super) seconds: f64,
    /// Of it, in gmsh (s).
    pub(super) meshing_seconds: f64,
    /// Largest resident memory of the process (bytes), gmsh left out.
    pub(super) peak_memory_bytes: u64,
    /// Number of cells.
    pub(super) cells: usize,
    /// Scalar unknowns.
    pub(super) unknowns: usize,
    /// Of them, components of jumps.
    pub(super) jump_unknowns: usize,
    /// Newton iterations of all load steps.
    pub(super) newton_iterations: usize,
    /// Iterations of an iterative linear solver in all load steps.
    pub(super) linear_iterations: usize,
    /// The fracture with the largest area.
    pub(super) largest_fracture: Option<String>,
    /// What was measured.
    pub(super) measures: Vec<Measure>,
}

impl PointRecord {
    /// Whether it is of a setting with this fingerprint and this gmsh. A gmsh that cannot be asked
    /// for its version speaks against no record.
    pub(super) fn is_of(&self, fingerprint: &str, gmsh: Option<&str>) -> bool {
        self.fingerprint == fingerprint && (gmsh.is_none() || self.gmsh.as_deref() == gmsh)
    }

    /// The numbers, if the run solved the scene.
    pub(super) fn numbers(&self) -> Option<&Numbers> {
        match &self.outcome {
            PointOutcome::Solved(numbers) => Some(numbers),
            PointOutcome::Failed(_) => None,
        }
    }

    /// Why the run failed, if it did.
    pub(super) fn failure(&self) -> Option<&str> {
        match &self.outcome {
            PointOutcome::Solved(_) => None,
            PointOutcome::Failed(why) => Some(why),
        }
    }
}

/// How points are run.
#[derive(Debug, Clone)]
pub(super) struct Runner {
    /// The folder of the study, which is claimed.
    pub(super) study: PathBuf,
    /// The folder `points` in it.
    pub(super) folder: PathBuf,
    /// This program.
    pub(super) program: OwnProgram,
    /// Sum of its bytes: another build of a version takes another time.
    pub(super) build: Fingerprint,
    /// Number of threads of each run.
    pub(super) threads: usize,
    /// How each run starts gmsh.
    pub(super) gmsh: GmshArgs,
    /// Its version, if it said one.
    pub(super) gmsh_version: Option<String>,
}

impl Runner {
    /// Sum over what a run of a scene depends on: its text, its mesh or its geometry with all that
    /// it includes, its files of values, this build, and the threads, which its time depends on.
    /// None if the mesh depends on more, or cannot be read.
    pub(super) fn fingerprint(&self, scene: &Table) -> Option<String> {
        let mesh = mesh_sum(scene)?;
        let scene = scene.to_string();
        let values = value_sums(&scene);
        let (build, threads) = (self.build, self.threads);
        let parts = format!("{build}\n{threads}\n{mesh:x}\n{values:?}\n{scene}");
        Some(format!("{:032x}", fingerprint(&parts)))
    }

    /// The version of gmsh that makes the mesh of a scene; none if no mesh is made, or if gmsh said
    /// none.
    pub(super) fn gmsh_of(&self, scene: &Table) -> Option<&str> {
        scene.get("mesh")?.get("geometry")?;
        self.gmsh_version.as_deref()
    }

    /// The records of former studies in the folder, each with the name of its own.
    pub(super) fn former(&self) -> Vec<(String, PointRecord)> {
        let folders = fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let read = |folder: fs::DirEntry| {
            let text = fs::read(folder.path().join(RECORD)).ok()?;
            let name = folder.file_name().into_string().ok()?;
            // A damaged record is none: the point is run again.
            Some((name, serde_json::from_slice(&text).ok()?))
        };
        let mut records: Vec<(String, PointRecord)> = folders.filter_map(read).collect();
        records.sort_by(|a, b| a.0.cmp(&b.0));
        records
    }

    /// Runs a scene in a folder of its own, whatever stood there before, and records what came of
    /// it.
    ///
    /// # Errors
    /// If files cannot be written or the program cannot be started; a run that fails is a result.
    pub(super) fn run(&self, name: &str, scene: &Table) -> Result<PointRecord, Defect> {
        let folder = self.folder.join(name);
        remove_setting(&folder)?;
        fs::create_dir_all(&folder).map_err(|error| unwritable(&folder, &error))?;
        let scene_file = folder.join(SCENE);
        // Of the files as they are before the run reads them.
        let fingerprint = self.fingerprint(scene).unwrap_or_default();
        self.write(&scene_file, |out| {
            out.write_all(scene.to_string().as_bytes())
        })?;
        let begin = Instant::now();
        let results = folder.join(RESULTS);
        let output = self.start(&scene_file, &results)?;
        let seconds = begin.elapsed().as_secs_f64();
        let record = PointRecord {
            fingerprint,
            gmsh: self.gmsh_of(scene).map(str::to_owned),
            outcome: outcome(&output, &results.join("summary.json"), seconds),
        };
        // Wrong input takes no time to find, and may be mended where no sum sees it (gmsh, memory);
        // who was killed, by hand or for want of memory, or got no mesh for want of time or space,
        // may be luckier the next time.
        let is_meshed = !output.stderr.starts_with(NOT_MESHED.as_bytes());
        if is_meshed && matches!(output.status.code(), Some(0 | 1)) {
            self.write(&folder.join(RECORD), |out| {
                serde_json::to_writer_pretty(&mut *out, &record)?;
                out.write_all(b"\n")
            })?;
        }
        Ok(record)
    }

    /// Writes a file of a setting. What a killed study leaves of it stands in the claimed folder,
    /// where the next one removes it.
    fn write(
        &self,
        path: &Path,
        fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
    ) -> Result<(), Defect> {
        let unfinished = ClaimedFolder::unfinished_in(&self.study, "setting");
        write_atomically(&unfinished, fill)?;
        fs::rename(&unfinished, path).map_err(|error| unwritable(path, &error))
    }

    /// Runs the program on a scene; if this process dies, the run ends with it.
    fn start(&self, scene: &Path, out: &Path) -> Result<Output, Defect> {
        let run = || {
            let mut child = self
                .program
                .command()
                .args([
                    "run",
                    "--quiet",
                    "--tied",
                    "--no-report",
                    "--threads",
                    &self.threads.to_string(),
                ])
                .args(self.gmsh.arguments())
                .arg(scene)
                .arg("--out")
                .arg(out)
                .stdin(Stdio::piped())
                .stdout(Stdio::null())
                .stderr(Stdio::piped())
                .spawn()?;
            // Open until the run has ended.
            let _tie = child.stdin.take();
            child.wait_with_output()
        };
        run().map_err(|error| {
            let place = self.program.file.display().to_string();
            let problem = format!("the program cannot be started: {error}");
            Defect::new(place, problem, "install it again")
        })
    }
}

/// Sum of the mesh that a scene names, or of the geometry with the files that it includes.
fn mesh_sum(scene: &Table) -> Option<Fingerprint> {
    let mesh = scene.get("mesh")?;
    match mesh.get("geometry") {
        Some(geometry) => geometry_fingerprint(Path::new(geometry.as_str()?)),
        None => fingerprint_of(Path::new(mesh.get("file")?.as_str()?)).ok(),
    }
}

/// Sums of the files that values of a scene come from. What is no scene, or cannot be read, is
/// refused by the run.
fn value_sums(scene: &str) -> Vec<Option<Fingerprint>> {
    let scene = Scene::parse(scene, "", Path::new(""));
    let files = scene.iter().flat_map(Scene::value_files);
    files.map(|file| fingerprint_of(file).ok()).collect()
}

fn outcome(output: &Output, summary: &Path, seconds: f64) -> PointOutcome {
    if !output.status.success() {
        return PointOutcome::Failed(reason(output));
    }
    let read = fs::read(summary).map_err(|error| error.to_string());
    let read = read.and_then(|text| numbers(&text, seconds).map_err(|error| error.to_string()));
    match read {
        Ok(numbers) => PointOutcome::Solved(Box::new(numbers)),
        Err(error) => PointOutcome::Failed(format!("summary.json: {error}")),
    }
}

/// The last lines of what a run said, and how it ended.
fn reason(output: &Output) -> String {
    let said = String::from_utf8_lossy(&output.stderr);
    let lines: Vec<&str> = said
        .lines()
        .filter(|line| !line.trim().is_empty())
        .collect();
    let last = &lines[lines.len().saturating_sub(LINES)..];
    match last {
        [] => output.status.to_string(),
        last => format!("{}: {}", output.status, last.join("\n")),
    }
}

#[derive(Deserialize)]
struct SummaryNumbers {
    mesh: MeshNumbers,
    unknowns: UnknownNumbers,
    fractures: serde_json::Map<String, serde_json::Value>,
    #[serde(default)]
    measures: Vec<Measure>,
    steps: Vec<StepNumbers>,
    seconds: SecondsNumbers,
    peak_memory_bytes: u64,
}

#[derive(Deserialize)]
struct MeshNumbers {
    cells: usize,
}

#[derive(Deserialize)]
struct UnknownNumbers {
    total: usize,
    jump: usize,
}

/// Flow in rigid rock takes no iterations, and tells none.
#[derive(Deserialize)]
struct StepNumbers {
    #[serde(default)]
    newton_iterations: usize,
    #[serde(default)]
    linear_iterations: usize,
}

#[derive(Deserialize)]
struct SecondsNumbers {
    mesh: f64,
    mesh_spared: f64,
}

/// The numbers in a `summary.json`.
pub(super) fn numbers(text: &[u8], seconds: f64) -> serde_json::Result<Numbers> {
    let summary: SummaryNumbers = serde_json::from_slice(text)?;
    // A mesh that stood there already costs what it took to make, or settings would not compare.
    let spared = summary.seconds.mesh_spared;
    let area = |fracture: &serde_json::Value| fracture["area"].as_f64().unwrap_or(0.0);
    let fractures = summary.fractures.iter();
    let largest = fractures.max_by(|a, b| area(a.1).total_cmp(&area(b.1)));
    Ok(Numbers {
        seconds: seconds + spared,
        meshing_seconds: summary.seconds.mesh + spared,
        peak_memory_bytes: summary.peak_memory_bytes,
        cells: summary.mesh.cells,
        unknowns: summary.unknowns.total,
        jump_unknowns: summary.unknowns.jump,
        newton_iterations: summary
            .steps
            .iter()
            .map(|step| step.newton_iterations)
            .sum(),
        linear_iterations: summary
            .steps
            .iter()
            .map(|step| step.linear_iterations)
            .sum(),
        largest_fracture: largest.map(|(name, _)| name.clone()),
        measures: summary.measures,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SUMMARY: &str = r#"{
      "mesh": { "nodes": 10, "cells": 24, "fracture_facets": 3, "max_sectors": 2 },
      "unknowns": { "total": 120, "jump": 12 },
      "fractures": { "a": { "area": 0.5 }, "b": { "area": 2.0 }, "c": { "area": 1.0 } },
      "measures": [
        { "name": "opening_l2", "fracture": "b", "value": null, "exact": null, "error": 0.0123 },
        { "name": "volume", "fracture": "b", "value": 4.1e-4, "exact": 4e-4, "error": 0.025 },
        { "name": "energy", "value": 3.5, "exact": null, "error": null }
      ],
      "steps": [
        { "newton_iterations": 3, "linear_iterations": 20 },
        { "newton_iterations": 2, "linear_iterations": 7 }
      ],
      "seconds": { "mesh": 0.5, "mesh_spared": 0.25, "total": 2.0 },
      "peak_memory_bytes": 1000000,
      "new": "keys are no obstacle"
    }"#;

    #[test]
    fn a_summary_gives_its_numbers() {
        let numbers = numbers(SUMMARY.as_bytes(), 2.5).expect("a summary");
        assert_eq!((numbers.seconds, numbers.meshing_seconds), (2.75, 0.75));
        assert_eq!(
            (numbers.cells, numbers.unknowns, numbers.jump_unknowns),
            (24, 120, 12)
        );
        assert_eq!(
            (numbers.newton_iterations, numbers.linear_iterations),
            (5, 27)
        );
        assert_eq!(numbers.largest_fracture.as_deref(), Some("b"));
        assert_eq!(numbers.measures.len(), 3);
        assert_eq!(numbers.measures[2].fracture, None);
    }

    #[test]
    fn records_come_back_as_they_were() {
        let solved = numbers(SUMMARY.as_bytes(), 2.5).expect("a summary");
        for outcome in [
            PointOutcome::Solved(Box::new(solved)),
            PointOutcome::Failed("why".into()),
        ] {
            let record = PointRecord {
                fingerprint: "f".into(),
                gmsh: Some("4.8.4".into()),
                outcome,
            };
            let text = serde_json::to_string(&record).expect("JSON");
            assert_eq!(record, serde_json::from_str(&text).expect("a record"));
        }
    }

    fn runner(folder: &Path) -> Runner {
        Runner {
            study: folder.into(),
            folder: folder.into(),
            program: OwnProgram {
                file: "kluft".into(),
                before: Vec::new(),
                code: "kluft".into(),
                tools: None,
            },
            build: 7,
            threads: 1,
            gmsh: GmshArgs::default(),
            gmsh_version: Some("4.8.4".into()),
        }
    }

    fn scene(text: &str) -> Table {
        text.parse().expect("TOML")
    }

    #[test]
    fn fingerprints_follow_scene_files_and_threads() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        let write = |name: &str, text: &str| fs::write(path(name), text).expect("written");
        write("a.geo", "Include \"b.inc\";");
        write("b.inc", "Box(1) = 1;");
        let geometry = path("a.geo").display().to_string();
        let of_order = |order| scene(&format!("[mesh]\ngeometry = '{geometry}'\norder = {order}"));
        let mut runner = runner(folder.path());
        let first = runner.fingerprint(&of_order(1));
        assert!(first.is_some());
        assert_eq!(first, runner.fingerprint(&of_order(1)));
        assert_ne!(first, runner.fingerprint(&of_order(2)));
        write("b.inc", "Box(1) = 2;");
        let included = runner.fingerprint(&of_order(1));
        assert_ne!(first, included);
        write("a.geo", "Include \"b.inc\"; Box(2) = 2;");
        let other = runner.fingerprint(&of_order(1));
        assert_ne!(included, other);
        runner.threads = 2;
        assert_ne!(other, runner.fingerprint(&of_order(1)));
        write("b.inc", "x = GetEnv(\"HOME\");");
        assert_eq!(runner.fingerprint(&of_order(1)), None, "it is not known");
    }

    #[test]
    fn fingerprints_follow_files_of_values() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        let write = |name: &str, text: &str| fs::write(path(name), text).expect("written");
        write("a.msh", "a mesh");
        write("E.csv", "z,E\n0,1e10\n1,2e10\n");
        let (mesh, values) = (path("a.msh"), path("E.csv"));
        let (mesh, values) = (mesh.display(), values.display());
        let scene = scene(&format!(
            "title = 'a'\n[mesh]\nfile = '{mesh}'\n[rock.default]\npoisson_ratio = 0.25\n\
             young_modulus = {{ file = '{values}', column = 'E' }}\n\
             [boundary.a]\npressure = 1e6\n"
        ));
        let runner = runner(folder.path());
        let first = runner.fingerprint(&scene);
        assert!(first.is_some());
        write("E.csv", "z,E\n0,1e10\n1,3e10\n");
        let other = runner.fingerprint(&scene);
        assert_ne!(first, other);
        write("a.msh", "another");
        assert_ne!(other, runner.fingerprint(&scene));
    }

    #[test]
    fn records_are_of_one_gmsh_where_it_makes_the_mesh() {
        let runner = runner(Path::new("a"));
        let made = scene("[mesh]\ngeometry = 'a.geo'");
        assert_eq!(runner.gmsh_of(&made), Some("4.8.4"));
        assert_eq!(runner.gmsh_of(&scene("[mesh]\nfile = 'a.msh'")), None);
        let record = PointRecord {
            fingerprint: "f".into(),
            gmsh: Some("4.8.4".into()),
            outcome: PointOutcome::Failed("why".into()),
        };
        assert!(record.is_of("f", Some("4.8.4")) && record.is_of("f", None));
        assert!(!record.is_of("f", Some("4.13.1")) && !record.is_of("g", None));
    }
}
