//! How a program was called, and how it calls itself: to become gmsh, for the points of a study.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::Command;

/// How the program was called.
#[derive(Debug, Clone)]
pub struct Invocation {
    /// The words of the command line; the first is the program.
    pub words: Vec<OsString>,
    /// How it calls itself; none if the system does not tell.
    pub own: Option<OwnProgram>,
}

/// How a program calls itself.
#[derive(Debug, Clone)]
pub struct OwnProgram {
    /// The file that is executed.
    pub file: PathBuf,
    /// What stands before the arguments: a script, where the file is its interpreter.
    pub before: Vec<OsString>,
    /// The file that holds the machine code.
    pub code: PathBuf,
    /// Where gmsh is sought before the search path, if anywhere.
    pub tools: Option<PathBuf>,
}

impl Invocation {
    /// That of this process, which executes the program itself.
    pub fn of_process() -> Self {
        Self {
            words: std::env::args_os().collect(),
            own: OwnProgram::of_process(),
        }
    }

    /// The command line, such that a shell takes it.
    pub fn command_line(&self) -> String {
        let words = self
            .words
            .iter()
            .map(|word| quoted(&word.to_string_lossy()));
        words.collect::<Vec<_>>().join(" ")
    }
}

impl OwnProgram {
    /// The file that this process executes.
    pub fn of_process() -> Option<Self> {
        let file = std::env::current_exe().ok()?;
        Some(Self {
            code: file.clone(),
            file,
            before: Vec::new(),
            tools: None,
        })
    }

    /// The program without its arguments.
    pub fn command(&self) -> Command {
        let mut command = Command::new(&self.file);
        command.args(&self.before);
        command
    }
}

/// A word as a shell takes it.
pub(crate) fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_=./,:+@%".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shell_reads_the_words_back() {
        let words = ["kluft", "run", "my scene's.toml", "", "--out=a/b-1.5", "$x"];
        let invocation = Invocation {
            words: words.map(OsString::from).to_vec(),
            own: None,
        };
        let script = format!("printf '%s\\n' {}", invocation.command_line());
        let said = Command::new("sh").arg("-c").arg(script).output();
        let said = said.expect("a shell").stdout;
        let lines: Vec<_> = said.split(|&byte| byte == b'\n').collect();
        assert_eq!(lines[..words.len()], words.map(str::as_bytes));
    }
}
