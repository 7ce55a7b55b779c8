//! One run of gmsh.

use std::ffi::{OsStr, OsString};
use std::io;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use kluft_mesh::Defect;

use super::log::Log;

const VARIABLE: &str = "KLUFT_GMSH";

/// The program to run.
pub(super) struct Gmsh {
    pub(super) program: OsString,
}

impl Gmsh {
    /// What `KLUFT_GMSH` names, else `gmsh`.
    pub(super) fn from_environment() -> Self {
        let named = std::env::var_os(VARIABLE).filter(|program| !program.is_empty());
        Self {
            program: named.unwrap_or_else(|| "gmsh".into()),
        }
    }

    /// Its version, if it can be started.
    pub(super) fn version(&self) -> Option<String> {
        let output = Command::new(&self.program)
            .arg("--version")
            .stdin(Stdio::null())
            .output()
            .ok()?;
        // gmsh prints its version on the error stream.
        let said = [output.stdout, output.stderr].concat();
        let said = String::from_utf8_lossy(&said).trim().to_owned();
        (output.status.success() && !said.is_empty()).then_some(said)
    }

    /// Runs it and answers with its warnings; any error it reports is a failure.
    pub(super) fn run(&self, input: &Path, args: &[OsString]) -> Result<Vec<String>, Vec<Defect>> {
        let output = Command::new(&self.program)
            .args(args)
            .args(["-nopopup", "-v", "2"])
            .stdin(Stdio::null())
            .output()
            .map_err(|error| vec![self.cannot_start(&error)])?;
        let log = Log::parse(&output.stdout, &output.stderr);
        let defects = failures(input, &output, &log);
        if defects.is_empty() {
            Ok(log.warnings)
        } else {
            Err(defects)
        }
    }

    fn cannot_start(&self, error: &io::Error) -> Defect {
        let remedy = format!(
            "install it (`sudo apt-get install gmsh`), or let the environment variable {VARIABLE} \
             name the program"
        );
        let program = self.program.display();
        let problem = match error.kind() {
            io::ErrorKind::NotFound => "the program gmsh is not found".to_owned(),
            _ => format!("gmsh cannot be started: {error}"),
        };
        Defect::new(program.to_string(), problem, remedy)
    }
}

fn failures(input: &Path, output: &Output, log: &Log) -> Vec<Defect> {
    let name = input.display().to_string();
    let mut defects = log.defects(&name);
    if defects.is_empty() && !output.status.success() {
        let problem = format!("gmsh failed without an error message ({})", output.status);
        let remedy = "open the file in gmsh and look what it says";
        defects.push(Defect::new(name, problem, remedy));
    }
    defects
}

/// A path that gmsh cannot take for an option.
pub(super) fn path_argument(path: &Path) -> OsString {
    let bytes = path.as_os_str().as_encoded_bytes();
    if bytes.first() == Some(&b'-') {
        return Path::new(OsStr::new(".")).join(path).into_os_string();
    }
    path.as_os_str().to_owned()
}
