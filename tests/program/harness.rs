//! Runs the binary in folders of its own.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

/// What a run of the program left on its streams.
pub struct Run {
    /// Exit status; none if a signal ended it.
    pub code: Option<i32>,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        Self {
            code: output.status.code(),
            out: text(&output.stdout),
            err: text(&output.stderr),
        }
    }
}

/// The program.
pub const KLUFT: &str = env!("CARGO_BIN_EXE_kluft");

/// A command under which the program neither finds nor keeps meshes of other tests.
pub fn command(program: &str) -> Command {
    let mut command = Command::new(program);
    command.env("KLUFT_CACHE", "");
    command
}

/// Writes a script that plays gmsh.
pub fn write_gmsh(file: &Path, script: &str) {
    use std::os::unix::fs::PermissionsExt;
    fs::write(file, format!("#!/bin/sh\n{script}\n")).expect("written");
    fs::set_permissions(file, fs::Permissions::from_mode(0o755)).expect("a program");
}

/// Runs the program; `environment` is added to that of the test.
pub fn kluft_with<S: AsRef<OsStr>>(arguments: &[S], environment: &[(&str, &str)]) -> Run {
    let mut command = command(KLUFT);
    command.args(arguments).envs(environment.iter().copied());
    command.output().expect("the program starts").into()
}

/// Runs the program.
pub fn kluft<S: AsRef<OsStr>>(arguments: &[S]) -> Run {
    kluft_with(arguments, &[])
}

/// The workspace.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A folder that goes away with its owner.
pub fn scratch() -> TempDir {
    tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("a scratch folder")
}

/// A copy of `geometries/NAME` in a folder of its own, where results go too.
pub struct Workshop {
    folder: TempDir,
}

impl Workshop {
    /// Copies a geometry and replaces texts of its scene.
    pub fn new(geometry: &str, edits: &[(&str, &str)]) -> Self {
        let folder = scratch();
        let from = root().join("geometries").join(geometry);
        let scene = fs::read_to_string(from.join("scene.toml")).expect("the scene");
        let after = scene.split("geometry = \"").nth(1).expect("a geometry");
        let geo = after.split('"').next().expect("its path").to_owned();
        let name = Path::new(&geo).file_name().expect("a file");
        fs::copy(from.join(&geo), folder.path().join(name)).expect("the geometry is copied");
        let scene = scene.replace(&geo, &name.to_string_lossy());
        let workshop = Self { folder };
        fs::write(workshop.scene(), edited(&scene, edits)).expect("the scene is written");
        workshop
    }

    /// A scene by itself.
    pub fn of(scene: &str) -> Self {
        let workshop = Self { folder: scratch() };
        fs::write(workshop.scene(), scene).expect("the scene is written");
        workshop
    }

    /// The scene file.
    pub fn scene(&self) -> PathBuf {
        self.path("scene.toml")
    }

    /// A path in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Runs the scene into the folder `out` of the workshop.
    pub fn run(&self, out: &str, flags: &[&str]) -> Run {
        let (scene, out) = (self.scene(), self.path(out));
        let mut arguments = vec![
            "run".as_ref(),
            scene.as_os_str(),
            "--out".as_ref(),
            out.as_os_str(),
        ];
        arguments.extend(flags.iter().map(OsStr::new));
        kluft(&arguments)
    }

    /// Runs the scene, which must succeed without a word.
    pub fn solve(&self, out: &str, flags: &[&str]) -> PathBuf {
        let run = self.run(out, flags);
        assert_eq!((run.code, run.err.as_str()), (Some(0), ""));
        assert_eq!(run.out, "", "the output is no terminal");
        self.path(out)
    }
}

/// `text` with every edit made; what an edit replaces must be there exactly once.
pub fn edited(text: &str, edits: &[(&str, &str)]) -> String {
    edits.iter().fold(text.to_owned(), |text, (from, to)| {
        assert_eq!(
            text.matches(from).count(),
            1,
            "occurrences of {from:?} in\n{text}"
        );
        text.replacen(from, to, 1)
    })
}

/// Names and contents of the files in a folder, folders in it left out.
pub fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).expect("the folder");
    let entries = entries.map(|entry| entry.expect("an entry"));
    entries
        .filter(|entry| entry.file_type().expect("a type").is_file())
        .map(|entry| {
            let name = entry.file_name().to_string_lossy().into_owned();
            (name, fs::read(entry.path()).expect("a file"))
        })
        .collect()
}

/// Takes the files that hold times off those of a folder.
pub fn without_times(files: &mut BTreeMap<String, Vec<u8>>) {
    for name in ["summary.json", "report.html"] {
        assert!(files.remove(name).is_some(), "{name}");
    }
}

/// `summary.json` of a folder of results.
pub fn summary(folder: &Path) -> Value {
    let text = fs::read_to_string(folder.join("summary.json")).expect("summary.json");
    serde_json::from_str(&text).expect("summary.json is JSON")
}
