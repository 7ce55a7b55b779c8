//! Which gmsh it is.

use std::time::Duration;

use super::options::GmshOptions;
use super::run::{Gmsh, Scope};

/// How long gmsh may take to say its version.
const LIMIT: Duration = Duration::from_secs(20);
/// Characters of a version; a program that says more is another one.
const LONGEST: usize = 100;

/// The version of gmsh, if it can be started.
pub fn version(options: &GmshOptions) -> Option<String> {
    version_of(&Gmsh::from_environment(options))
}

/// What a program says, in one line, when it is asked for its version.
pub(super) fn version_of(gmsh: &Gmsh<'_>) -> Option<String> {
    let options = GmshOptions {
        time_limit: Some(LIMIT),
        ..gmsh.options.clone()
    };
    let gmsh = Gmsh {
        program: gmsh.program.clone(),
        options: &options,
    };
    let ended = gmsh.run(&["--version".into()], &Scope::default()).ok()?;
    // gmsh prints its version on the error stream.
    let said = ended.output + &ended.errors;
    let said = said.trim();
    let is_version = !said.is_empty() && said.len() <= LONGEST && said.lines().count() == 1;
    (ended.status.success() && is_version).then(|| said.to_owned())
}
