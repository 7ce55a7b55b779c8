//! Folders of results: the scene that fills them, what must be equal in them, and what must be
//! whole.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde_json::Value;
use tempfile::TempDir;

use super::asked::bytes_of;
use super::program::{Started, start};
use crate::root;

/// Longest time that a run of the small scene may take.
pub const LIMIT: Duration = Duration::from_secs(300);

/// Loading, unloading and loading again, so that a step depends on several before it.
const PATH: &str = "[[load.phase]]\nname = \"loading\"\nuntil = 1.0\nsteps = 3\n\n\
    [[load.phase]]\nname = \"turning\"\nuntil = 3.0\nsteps = 4\n\n[mesh]";
const TOP: [&str; 2] = [
    "traction = [0.0, 0.0, -10e6]",
    "traction = [0.0, 0.0, -10e6]\nhistory = [[0, 0], [1, 1], [2, 0.25], [3, 1.5]]",
];

/// Files by name.
pub type Files = BTreeMap<String, Vec<u8>>;

/// A folder with a scene of three crossing joints and seven load steps.
pub struct Workshop {
    folder: TempDir,
    program: PathBuf,
}

impl Workshop {
    /// For runs of this program.
    ///
    /// # Panics
    /// If there is no place for temporary files.
    pub fn new(program: &Path) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let geometry = root().join("geometries/three-planes/three-planes.geo");
        let copied = fs::copy(geometry, folder.path().join("three-planes.geo"));
        copied.expect("the geometry is copied");
        Self {
            folder,
            program: program.to_owned(),
        }
    }

    /// A path in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a scene with this cell size and linear solver.
    pub fn write_scene(&self, name: &str, size: f64, linear: &str) {
        let text = bytes_of(&root().join("geometries/three-planes/scene.toml"));
        let text = String::from_utf8_lossy(&text).into_owned();
        let solver = format!("[solver]\nlinear = \"{linear}\"\n\n{PATH}");
        let text = text.replace("h = 0.15", &format!("h = {size}"));
        let text = text.replace("[mesh]", &solver).replace(TOP[0], TOP[1]);
        fs::write(self.path(name), text).expect("the scene is written");
    }

    /// The command line of a run.
    pub fn arguments(&self, scene: &str, out: &Path, resume: bool) -> Vec<Box<OsStr>> {
        let scene = self.path(scene);
        let mut all = vec![OsStr::new("run"), scene.as_os_str(), OsStr::new("--out")];
        all.push(out.as_os_str());
        all.extend(resume.then_some(OsStr::new("--resume")));
        all.into_iter().map(Box::from).collect()
    }

    /// Starts a run of a scene into a folder.
    pub fn start(&self, scene: &str, out: &Path, resume: bool) -> Started {
        let arguments = self.arguments(scene, out, resume);
        let arguments: Vec<&OsStr> = arguments.iter().map(|text| &**text).collect();
        start(&self.program, &arguments)
    }

    /// What a run that nothing disturbs leaves, and the time that it takes.
    ///
    /// # Panics
    /// If it fails.
    pub fn undisturbed(&self, scene: &str) -> (Files, Duration) {
        let out = self.path(&format!("{scene}-undisturbed"));
        let begin = Instant::now();
        let end = self.start(scene, &out, false).end(LIMIT);
        assert_eq!(end.code, Some(0), "{}", end.said);
        (results(&out), begin.elapsed())
    }
}

/// Everything in a folder that must not depend on what disturbed a run: its files without hidden
/// ones and the checkpoint, and the summary without times and memory.
pub fn results(folder: &Path) -> Files {
    let mut files = visible(folder);
    files.remove("resume.bin");
    files.remove("report.html");
    if let Some(summary) = files.get_mut("summary.json") {
        let mut value: Value = serde_json::from_slice(summary).unwrap_or_default();
        for key in [
            "seconds",
            "peak_memory_bytes",
            "predicted_memory_bytes",
            "threads",
            "provenance",
        ] {
            value.as_object_mut().map(|object| object.remove(key));
        }
        *summary = value.to_string().into_bytes();
    }
    files
}

/// The files of a folder without hidden ones.
pub fn visible(folder: &Path) -> Files {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let named = entries.filter_map(|entry| {
        let name = entry.file_name().into_string().ok()?;
        Some((name, fs::read(entry.path()).ok()?))
    });
    named.filter(|(name, _)| !name.starts_with('.')).collect()
}

/// The first difference between two folders.
pub fn difference(found: &Files, expected: &Files) -> Option<String> {
    let missing = expected.keys().find(|name| !found.contains_key(*name));
    if let Some(name) = missing {
        return Some(format!("{name} is missing"));
    }
    let differs = |(name, bytes): (&String, &Vec<u8>)| match expected.get(name) {
        None => Some(format!("{name} is too much")),
        Some(other) if other == bytes => None,
        Some(other) => Some(format!("{name} differs{}", differing_keys(bytes, other))),
    };
    found.iter().find_map(differs)
}

/// The keys of two JSON objects that differ, with what they say; empty for files of another kind.
fn differing_keys(found: &[u8], expected: &[u8]) -> String {
    let objects = [found, expected].map(serde_json::from_slice::<serde_json::Map<String, Value>>);
    let [Ok(found), Ok(expected)] = objects else {
        return String::new();
    };
    let keys: BTreeSet<&String> = found.keys().chain(expected.keys()).collect();
    let differ = keys
        .into_iter()
        .filter(|key| found.get(*key) != expected.get(*key));
    let said = |value: Option<&Value>| value.map_or("nothing".to_owned(), Value::to_string);
    differ
        .map(|key| {
            format!(
                "; {key}: {} instead of {}",
                said(found.get(key)),
                said(expected.get(key))
            )
        })
        .collect()
}

/// What is not whole in a folder: grids and collections that end early, collections that list what
/// is not there, and a summary that is no JSON or has other load steps than there are grids.
pub fn broken(folder: &Path) -> Option<String> {
    let files = visible(folder);
    for (name, bytes) in &files {
        let is_vtk = name.ends_with(".vtu") || name.ends_with(".pvd");
        if is_vtk && !bytes.trim_ascii_end().ends_with(b"</VTKFile>") {
            return Some(format!("{name} ends early"));
        }
        let text = String::from_utf8_lossy(bytes);
        let listed = text
            .split("file=\"")
            .skip(1)
            .filter(|_| name.ends_with(".pvd"));
        let mut listed = listed.filter_map(|rest| rest.split('"').next());
        if let Some(lost) = listed.find(|grid| !files.contains_key(*grid)) {
            return Some(format!("{name} lists {lost}, which is not there"));
        }
    }
    let summary = files.get("summary.json")?;
    let Ok(summary) = serde_json::from_slice::<Value>(summary) else {
        return Some("summary.json is no JSON".to_owned());
    };
    let steps = summary["steps"].as_array().map_or(0, Vec::len);
    let grids = files
        .keys()
        .filter(|name| name.starts_with("rock_"))
        .count();
    let fits = steps == grids || steps + 1 == grids;
    (!fits).then(|| format!("summary.json has {steps} load steps, and there are {grids} grids"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_lost_cut_short_or_mixed_is_seen() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text);
        write("rock_0001.vtu", "<VTKFile></VTKFile>\n").expect("written");
        write("rock.pvd", "<VTKFile file=\"rock_0001.vtu\"/></VTKFile>").expect("written");
        write("summary.json", "{\"steps\": [1], \"seconds\": 7}").expect("written");
        write(".lock", "hidden").expect("written");
        assert_eq!(broken(folder.path()), None);
        let whole = results(folder.path());
        assert_eq!(whole.len(), 3);
        write("summary.json", "{\"seconds\": 8, \"steps\": [1]}").expect("written");
        assert_eq!(difference(&results(folder.path()), &whole), None);
        write("summary.json", "{\"steps\": [2]}").expect("written");
        let said = difference(&results(folder.path()), &whole);
        assert_eq!(
            said.as_deref(),
            Some("summary.json differs; steps: [2] instead of [1]")
        );
        write("summary.json", "{\"steps\": [1]}").expect("written");
        write("rock_0002.vtu", "<VTKFile>").expect("written");
        assert!(broken(folder.path()).is_some_and(|what| what.contains("ends early")));
        assert!(difference(&results(folder.path()), &whole).is_some());
        for name in ["rock_0001.vtu", "rock_0002.vtu"] {
            fs::remove_file(folder.path().join(name)).expect("removed");
        }
        assert!(broken(folder.path()).is_some_and(|what| what.contains("not there")));
        assert!(difference(&results(folder.path()), &whole).is_some());
    }
}
