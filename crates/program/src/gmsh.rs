//! How this program starts gmsh: by way of itself, or as it is where it does not find itself.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use kluft_io::gmsh::Launcher;
use kluft_io::{GmshOptions, MeshCache};

use crate::invocation::OwnProgram;

/// The hidden command that becomes gmsh.
#[cfg(target_os = "linux")]
pub const START: &str = "start-gmsh";

/// Names the folder for what can be made again; empty for none.
const CACHE: &str = "KLUFT_CACHE";

/// Arguments of every command that makes meshes.
#[derive(Debug, Clone, Copy, Default, Args)]
pub struct GmshArgs {
    /// Let the geometry run programs and open any file; only for geometries that you have read
    #[arg(long)]
    pub trust: bool,
    /// End gmsh after this time, s [default: no limit]
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub mesh_timeout: Option<Duration>,
    /// Mesh again, even if nothing that the mesh is made of has changed
    #[arg(long)]
    pub remesh: bool,
}

fn seconds(text: &str) -> Result<Duration, String> {
    let number = text.parse::<f64>().ok().filter(|number| *number > 0.0);
    let time = number.and_then(|number| Duration::try_from_secs_f64(number).ok());
    time.ok_or_else(|| "a time greater than 0 is wanted, in seconds".to_owned())
}

impl GmshArgs {
    /// What they ask for, of a program that calls itself so.
    pub fn options(self, own: Option<&OwnProgram>) -> GmshOptions {
        GmshOptions {
            launcher: own.and_then(launcher),
            tools: own.and_then(|own| own.tools.clone()),
            trust: self.trust,
            time_limit: self.mesh_timeout,
            stop: None,
            cache: cache(self.remesh),
        }
    }

    /// The same, to be handed on to another run of the program.
    pub fn arguments(self) -> Vec<String> {
        let trust = self.trust.then(|| "--trust".to_owned());
        let limit = self.mesh_timeout.map(|limit| limit.as_secs_f64());
        let limit = limit.map(|limit| format!("--mesh-timeout={limit}"));
        let again = self.remesh.then(|| "--remesh".to_owned());
        trust.into_iter().chain(limit).chain(again).collect()
    }
}

/// Where meshes are kept: the folder that the environment names, if it does not name none, or the
/// user's own for such files.
fn cache(remesh: bool) -> Option<MeshCache> {
    let folder = match std::env::var_os(CACHE) {
        Some(named) if named.is_empty() => return None,
        Some(named) => PathBuf::from(named),
        None => users_folder()?.join("kluft"),
    };
    let cache = MeshCache::at(folder.join("meshes"));
    Some(if remesh { cache.making_again() } else { cache })
}

/// The folder for what programs can make again, by the XDG base directory specification.
fn users_folder() -> Option<PathBuf> {
    let absolute = |name: &str| {
        let folder = PathBuf::from(std::env::var_os(name)?);
        folder.is_absolute().then_some(folder)
    };
    absolute("XDG_CACHE_HOME").or_else(|| Some(absolute("HOME")?.join(".cache")))
}

#[cfg(target_os = "linux")]
fn launcher(own: &OwnProgram) -> Option<Launcher> {
    let arguments = own.before.iter().cloned();
    Some(Launcher {
        program: own.file.clone(),
        arguments: arguments.chain([START.into()]).collect(),
        confines: crate::start_gmsh::can_confine(),
    })
}

#[cfg(not(target_os = "linux"))]
fn launcher(_: &OwnProgram) -> Option<Launcher> {
    None
}
