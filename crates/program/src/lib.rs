//! What the programs share, `kluft` and that for many machines: the terminal that follows a run,
//! failures and their exit codes, what may be given as a scene, and how gmsh is started.

pub mod defects;
pub mod failure;
pub mod gmsh;
pub mod input;
pub mod invocation;
#[cfg(target_os = "linux")]
pub mod limited;
pub mod printing;
pub mod report;
#[cfg(target_os = "linux")]
pub mod start_gmsh;
