//! One run of gmsh: how it is started, waited for and ended.

use std::ffi::{OsStr, OsString};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::Ordering;
use std::sync::mpsc::{self, Receiver};
use std::time::{Duration, Instant};

use super::capture::Capture;
use super::options::GmshOptions;

const VARIABLE: &str = "KLUFT_GMSH";
/// Between two looks whether gmsh has ended.
const FIRST_PAUSE: Duration = Duration::from_micros(500);
const LONGEST_PAUSE: Duration = Duration::from_millis(20);
/// How long to wait for the last words of a program that has ended; others may hold its streams.
const LAST_WORDS: Duration = Duration::from_secs(1);

/// The program to run.
pub(super) struct Gmsh<'a> {
    pub(super) program: OsString,
    pub(super) options: &'a GmshOptions,
}

/// What a run may use.
#[derive(Debug, Default)]
pub(super) struct Scope {
    /// The folder that it may write to.
    pub(super) folder: Option<PathBuf>,
    /// What it may read besides: files, and folders with all that is in them.
    pub(super) reads: Vec<PathBuf>,
}

/// How a run ended, and what it printed.
pub(super) struct Ended {
    pub(super) status: ExitStatus,
    pub(super) output: String,
    pub(super) errors: String,
    /// Why it was ended, if it did not end by itself.
    pub(super) cut_short: Option<CutShort>,
}

/// Why a run is ended before it ends by itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CutShort {
    /// Its time is over.
    OutOfTime,
    /// Nobody wants its mesh any more.
    Stopped,
}

impl<'a> Gmsh<'a> {
    /// What `KLUFT_GMSH` names, else `gmsh`.
    pub(super) fn from_environment(options: &'a GmshOptions) -> Self {
        let named = std::env::var_os(VARIABLE).filter(|program| !program.is_empty());
        Self {
            program: named.unwrap_or_else(|| "gmsh".into()),
            options,
        }
    }

    /// Runs it to its end, or to that of the time that it may take.
    pub(super) fn run(&self, arguments: &[OsString], scope: &Scope) -> io::Result<Ended> {
        let mut command = self.command(scope)?;
        command.args(arguments);
        // Options of the user must not change a mesh, and gmsh has no other switch for that.
        let home = scope.folder.as_deref().unwrap_or(Path::new("/dev/null"));
        let home = std::path::absolute(home)?;
        command.env("GMSH_HOME", &home);
        // A script finds its interpreter among the tools. No path can hold some names of folders.
        if self.options.tools.is_some()
            && let Ok(path) = std::env::join_paths(self.folders())
        {
            command.env("PATH", path);
        }
        // What it does on several threads depends on their number.
        command.env("OMP_NUM_THREADS", "1");
        if scope.folder.is_some() {
            command.env("TMPDIR", &home);
        }
        let child = command
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()?;
        watch(child, self.options)
    }

    /// The program without its arguments, as the launcher wants it if there is one.
    fn command(&self, scope: &Scope) -> io::Result<Command> {
        let program = self.find()?;
        let Some(launcher) = &self.options.launcher else {
            return Ok(Command::new(program));
        };
        let mut command = Command::new(&launcher.program);
        command.args(&launcher.arguments);
        command.arg("--parent").arg(std::process::id().to_string());
        if self.options.confines() {
            command.arg("--confine");
            if let Some(folder) = &scope.folder {
                command.arg("--folder").arg(folder);
            }
            for path in &scope.reads {
                command.arg("--read").arg(path);
            }
        }
        command.arg("--").arg(program);
        Ok(command)
    }

    /// Where programs are sought: in the folder of tools, then in those of the search path.
    fn folders(&self) -> Vec<PathBuf> {
        let path = std::env::var_os("PATH").unwrap_or_default();
        let tools = self.options.tools.iter().cloned();
        tools.chain(std::env::split_paths(&path)).collect()
    }

    /// The file of the program.
    pub(super) fn find(&self) -> io::Result<PathBuf> {
        let named = Path::new(&self.program);
        let there = |file: &Path| file.exists().then(|| file.to_owned());
        let found = if named.components().count() > 1 {
            there(named)
        } else {
            self.folders().into_iter().find_map(|folder| {
                let file = folder.join(named);
                there(&file).filter(|file| file.is_file())
            })
        };
        found.ok_or_else(|| io::ErrorKind::NotFound.into())
    }
}

fn watch(mut child: Child, options: &GmshOptions) -> io::Result<Ended> {
    let limit = options.time_limit;
    let deadline = limit.and_then(|limit| Instant::now().checked_add(limit));
    let (ended, all) = mpsc::channel();
    let output = child.stdout.take().map(|stream| read(stream, &ended));
    let errors = child.stderr.take().map(|stream| read(stream, &ended));
    drop(ended);
    let mut pause = FIRST_PAUSE;
    let mut cut_short = None;
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        cut_short = reason_to_end(options, deadline);
        if cut_short.is_some() {
            child.kill()?;
            break child.wait()?;
        }
        std::thread::sleep(pause);
        pause = LONGEST_PAUSE.min(2 * pause);
    };
    wait_for_streams(&all);
    let text = |capture: Option<Capture>| capture.map_or_else(String::new, |kept| kept.text());
    Ok(Ended {
        status,
        output: text(output),
        errors: text(errors),
        cut_short,
    })
}

fn reason_to_end(options: &GmshOptions, deadline: Option<Instant>) -> Option<CutShort> {
    let stop = options.stop.as_ref();
    if stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) {
        return Some(CutShort::Stopped);
    }
    let is_over = deadline.is_some_and(|deadline| Instant::now() >= deadline);
    is_over.then_some(CutShort::OutOfTime)
}

fn read(stream: impl io::Read + Send + 'static, ended: &mpsc::Sender<()>) -> Capture {
    let ended = ended.clone();
    // Nobody may wait for it any more.
    Capture::begin(stream, move || {
        let _ = ended.send(());
    })
}

fn wait_for_streams(all: &Receiver<()>) {
    let end = Instant::now() + LAST_WORDS;
    let left = || end.saturating_duration_since(Instant::now());
    while all.recv_timeout(left()).is_ok() {}
}

/// A path that gmsh cannot take for an option.
pub(super) fn path_argument(path: &Path) -> OsString {
    let bytes = path.as_os_str().as_encoded_bytes();
    if bytes.first() == Some(&b'-') {
        return Path::new(OsStr::new(".")).join(path).into_os_string();
    }
    path.as_os_str().to_owned()
}
