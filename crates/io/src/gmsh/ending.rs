//! What the end of a run of gmsh means.

use std::io;
use std::path::Path;

use kluft_mesh::Defect;

use super::log::Log;
use super::options::{NOT_MESHED, NOT_STARTED};
use super::run::{CutShort, Ended, Gmsh};

/// Lines of what gmsh said last that a message holds.
const LAST: usize = 3;

/// gmsh's warnings, or why it failed; any error that it reports is a failure.
/// `remedy` is what helps against errors in the input.
pub(super) fn judge(
    gmsh: &Gmsh,
    (input, remedy): (&Path, &str),
    ended: &Ended,
) -> Result<Vec<String>, Vec<Defect>> {
    let name = input.display().to_string();
    let is_launched = gmsh.options.launcher.is_some();
    match ended.cut_short {
        Some(CutShort::OutOfTime) => return Err(vec![out_of_time(gmsh, name)]),
        Some(CutShort::Stopped) => return Err(vec![stopped(name)]),
        None => {}
    }
    if is_launched && ended.status.code() == Some(NOT_STARTED.into()) {
        let why = ended.errors.lines().next_back().unwrap_or_default();
        return Err(vec![not_started(
            gmsh,
            format!("gmsh cannot be started: {why}"),
        )]);
    }
    let log = Log::parse(&ended.output, &ended.errors);
    let mut defects = log.defects(&name, remedy);
    if !ended.status.success() {
        match missing_library(ended) {
            Some(library) => defects = vec![without_library(gmsh, library)],
            None if defects.is_empty() => defects.push(silent(name, ended)),
            None => {}
        }
    }
    if defects.is_empty() {
        Ok(log.warnings)
    } else {
        Err(defects)
    }
}

/// Why the program could not be started.
pub(super) fn cannot_start(gmsh: &Gmsh, error: &io::Error) -> Defect {
    let problem = match error.kind() {
        io::ErrorKind::NotFound => "the program gmsh is not found".to_owned(),
        _ => format!("gmsh cannot be started: {error}"),
    };
    not_started(gmsh, problem)
}

fn not_started(gmsh: &Gmsh, problem: String) -> Defect {
    let remedy = "install it (`sudo apt-get install gmsh`), or let the environment variable \
                  KLUFT_GMSH name the program";
    Defect::new(gmsh.program.display().to_string(), problem, remedy)
}

fn stopped(name: String) -> Defect {
    let remedy = "start again: nothing was written";
    Defect::new(
        name,
        "gmsh was stopped before the mesh was finished",
        remedy,
    )
    .with_code(NOT_MESHED)
}

fn out_of_time(gmsh: &Gmsh, name: String) -> Defect {
    let limit = gmsh.options.time_limit.unwrap_or_default().as_secs_f64();
    let problem = format!("gmsh was ended after {limit} s, which is all the time it was given");
    let remedy = "ask for larger cells, or give it more time with --mesh-timeout SECONDS";
    Defect::new(name, problem, remedy).with_code(NOT_MESHED)
}

/// The library that the loader of programs, or Python in its words, did not find.
fn missing_library(ended: &Ended) -> Option<&str> {
    let streams = [&ended.output, &ended.errors];
    let mut lines = streams.iter().flat_map(|text| text.lines());
    lines.find_map(|line| {
        let (before, _) = line.split_once(": cannot open shared object file")?;
        before
            .rsplit([' ', ':'])
            .next()
            .filter(|name| name.contains(".so"))
    })
}

fn without_library(gmsh: &Gmsh, library: &str) -> Defect {
    let problem = format!("gmsh needs the library {library}, which is not installed");
    let remedy = "the gmsh of pip needs libraries of the system: on Debian and Ubuntu `sudo \
                  apt-get install libglu1-mesa libxcursor1 libxft2 libxinerama1`, on Fedora `sudo \
                  dnf install mesa-libGLU libXcursor libXft libXinerama`; or install gmsh by the \
                  package manager of the system, which brings them";
    Defect::new(gmsh.program.display().to_string(), problem, remedy)
}

fn silent(name: String, ended: &Ended) -> Defect {
    let streams = [&ended.output, &ended.errors];
    let lines = streams.iter().flat_map(|text| text.lines());
    let lines: Vec<&str> = lines.filter(|line| !line.trim().is_empty()).collect();
    let last = lines[lines.len().saturating_sub(LAST)..].join("; ");
    let said = if last.is_empty() {
        String::new()
    } else {
        format!("; it said last: {last}")
    };
    let problem = format!(
        "gmsh failed without an error message ({}){said}",
        ended.status
    );
    let remedy = "open the file in gmsh and look what it says; if KLUFT_GMSH names a script that \
                  starts gmsh, let it name gmsh itself";
    Defect::new(name, problem, remedy)
}
