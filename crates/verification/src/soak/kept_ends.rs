//! Ends of the runs of a case, kept in a file so that a case of hours can be continued.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::UNIX_EPOCH;

use serde::{Deserialize, Serialize};

use super::records;
use super::solve::End;

/// The ends of runs, by their scenes.
#[derive(Debug, Default)]
pub struct KeptEnds {
    /// Where they are kept; none if they are not.
    file: Option<PathBuf>,
    ends: Vec<KeptEnd>,
    /// Held while a line is written.
    unbroken: Mutex<()>,
}

#[derive(Debug, Serialize, Deserialize)]
struct KeptEnd {
    scene: String,
    end: End,
}

impl KeptEnds {
    /// What this build of the suites has kept of a case in a folder, which is made if it is not
    /// there.
    ///
    /// # Errors
    /// If the folder or the file cannot be read or made.
    pub fn read(folder: &Path, case: &str) -> io::Result<Self> {
        fs::create_dir_all(folder)?;
        let build = std::env::current_exe()?.metadata()?.modified()?;
        let build = build.duration_since(UNIX_EPOCH).unwrap_or_default();
        let file = folder.join(format!("{case}-{}.jsonl", build.as_millis()));
        let text = records::text_of(&file)?;
        // A line that is cut short is of a process that was killed: its run is made again.
        let ends = text.lines().map(serde_json::from_str);
        let ends = ends.filter_map(Result::ok).collect();
        Ok(Self {
            file: Some(file),
            ends,
            unbroken: Mutex::default(),
        })
    }

    /// How the run of a scene ended, which is made and its end added if none is kept.
    ///
    /// # Errors
    /// If the end cannot be written.
    pub fn end_of(&self, scene: &str, run: impl FnOnce() -> End) -> io::Result<End> {
        let mut ends = self.ends.iter();
        if let Some(kept) = ends.find(|kept| kept.scene == scene) {
            return Ok(kept.end.clone());
        }
        let (scene, end) = (scene.to_owned(), run());
        let kept = KeptEnd { scene, end };
        if let Some(file) = &self.file {
            let line = format!("\n{}\n", serde_json::to_string(&kept)?);
            let unbroken = self.unbroken.lock();
            records::append(file, &line)?;
            drop(unbroken);
        }
        Ok(kept.end)
    }
}

#[cfg(test)]
mod tests {
    use super::super::solve::Fields;
    use super::*;

    #[test]
    fn ends_come_back_but_for_one_that_was_cut_short() {
        let folder = tempfile::tempdir().expect("a folder");
        let read = || KeptEnds::read(folder.path(), "7").expect("a file");
        let solved = Fields {
            jumps: vec![1.0 / 3.0, -2e-9, 0.0],
            displacement: 0.1,
            path_error: 1e-7,
            is_declared: true,
            warns_of_sums: false,
        };
        let kept = read();
        let end = || End::Solved(solved.clone());
        kept.end_of("a", end).expect("a line");
        let cut = "{\"scene\":\"b\",\"end\":{\"Fai";
        let file = kept.file.expect("a file");
        records::append(&file, cut).expect("half a line");
        let why = || End::Failed("the \"tests\"\ndo not hold".to_owned());
        let made = read().end_of("b", why).expect("a line");
        let never = || -> End { panic!("it is kept") };
        let last = read();
        let [a, b] = ["a", "b"].map(|scene| last.end_of(scene, never).expect("kept"));
        assert!(matches!(a, End::Solved(fields) if fields == solved));
        assert!(matches!([made, b], [End::Failed(x), End::Failed(y)] if x == y));
        let none = KeptEnds::default();
        none.end_of("a", end).expect("no file");
        assert!(matches!(none.end_of("a", why), Ok(End::Failed(_))));
    }
}
