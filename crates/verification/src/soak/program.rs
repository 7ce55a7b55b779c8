//! The real program: started, timed, killed, and what it leaves behind.

use std::ffi::OsStr;
use std::fs;
use std::io::{Read, Seek};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// How the program ended.
#[derive(Debug, Clone)]
pub struct End {
    /// Its exit code; none if a signal ended it.
    pub code: Option<i32>,
    /// Whether it was killed after its time.
    pub is_out_of_time: bool,
    /// What it said on its standard error.
    pub said: String,
}

impl End {
    /// What no run may do; none if it ended with 0, 1 or 2.
    pub fn fault(&self) -> Option<String> {
        let fault = match self.code {
            _ if self.is_out_of_time => "out of time".to_owned(),
            Some(0..=2) => return None,
            Some(101) => "panic".to_owned(),
            Some(code) => format!("exit code {code}"),
            None => "ended by a signal".to_owned(),
        };
        Some(fault)
    }

    /// The first line that it said.
    pub fn first_line(&self) -> &str {
        self.said.lines().next().unwrap_or("nothing")
    }
}

/// A run under way.
pub struct Started {
    child: Child,
    said: fs::File,
}

/// Starts a program.
///
/// # Panics
/// If it is not there.
pub fn start(program: &Path, arguments: &[&OsStr]) -> Started {
    let said = tempfile::tempfile().expect("a temporary file");
    let stderr = said.try_clone().expect("a temporary file");
    let mut command = Command::new(program);
    command
        .args(arguments)
        // A mesh of an earlier case would hide what comes of making one.
        .env("KLUFT_CACHE", "")
        .stdin(Stdio::null())
        .stdout(Stdio::null());
    let child = command.stderr(stderr).spawn();
    let child = child.unwrap_or_else(|error| panic!("{}: {error}", program.display()));
    Started { child, said }
}

impl Started {
    /// Waits for its end, at most so long.
    pub fn end(mut self, limit: Duration) -> End {
        let begin = Instant::now();
        let mut is_out_of_time = false;
        while self.child.try_wait().expect("a child").is_none() {
            if begin.elapsed() > limit && !is_out_of_time {
                is_out_of_time = true;
                self.child.kill().expect("killed");
            }
            thread::sleep(Duration::from_millis(2));
        }
        let status = self.child.wait().expect("an end");
        let mut said = Vec::new();
        self.said.rewind().expect("a temporary file");
        self.said.read_to_end(&mut said).expect("a temporary file");
        End {
            code: status.code(),
            is_out_of_time,
            said: String::from_utf8_lossy(&said).into_owned(),
        }
    }

    /// Kills it without warning; whether it still ran.
    pub fn kill(mut self) -> bool {
        let runs = self.child.try_wait().expect("a child").is_none();
        self.child.kill().expect("killed");
        self.child.wait().expect("an end");
        runs
    }
}

/// Runs a program for at most so long.
pub fn run(program: &Path, arguments: &[&OsStr], limit: Duration) -> End {
    start(program, arguments).end(limit)
}

/// Processes that work on files of a folder, by their command lines; waits a moment for the system
/// to end them with their parent, then ends them. Linux only.
pub fn left_behind(folder: &Path) -> Vec<String> {
    const PATIENCE: Duration = Duration::from_millis(100);
    let begin = Instant::now();
    loop {
        let found = working_on(folder);
        if found.is_empty() {
            return Vec::new();
        }
        if begin.elapsed() > PATIENCE {
            for (id, _) in &found {
                let _ = Command::new("kill").args(["-9", id]).status();
            }
            return found.into_iter().map(|(_, command)| command).collect();
        }
        thread::sleep(Duration::from_millis(5));
    }
}

/// Number and command line of each.
fn working_on(folder: &Path) -> Vec<(String, String)> {
    let folder = folder.to_string_lossy();
    let entries = fs::read_dir("/proc").into_iter().flatten().flatten();
    let lines = entries.filter_map(|entry| {
        let id = entry.file_name().into_string().ok()?;
        id.parse::<u32>().ok()?;
        let line = fs::read(entry.path().join("cmdline")).ok()?;
        Some((id, String::from_utf8_lossy(&line).replace('\0', " ")))
    });
    lines.filter(|(_, line)| line.contains(&*folder)).collect()
}
