//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use kluft_program::gmsh::GmshArgs;
#[cfg(target_os = "linux")]
use kluft_program::gmsh::START;
use kluft_program::printing::WIDTH;
#[cfg(target_os = "linux")]
use kluft_program::start_gmsh::StartArgs;

/// Kluft on many ranks: mpiexec -n N kluft-mpi run SCENE.toml
#[derive(Parser)]
#[command(version, term_width = WIDTH, arg_required_else_help = true)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Subcommand)]
pub enum Command {
    /// Mesh, enrich, solve and write a scene, its linear systems divided among all ranks
    Run(RunArgs),
    /// Become gmsh
    #[cfg(target_os = "linux")]
    #[command(name = START, hide = true)]
    StartGmsh(StartArgs),
}

/// Arguments of `kluft-mpi run`.
#[derive(Args)]
pub struct RunArgs {
    /// The scene file (TOML), which all ranks can read
    pub scene: PathBuf,
    /// Folder for the results, which all ranks can write to [default: `out` beside the scene]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Number of threads of each rank; results do not depend on it
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: u16,
    /// Go on after the last load step that an interrupted run on as many ranks finished
    #[arg(long)]
    pub resume: bool,
    /// Write no report.html
    #[arg(long)]
    pub no_report: bool,
    /// How gmsh is started.
    #[command(flatten)]
    pub gmsh: GmshArgs,
    /// Print nothing but errors
    #[arg(long, short, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Print the report even when the output is not a terminal, and what the ranks exchanged
    #[arg(long, short)]
    pub verbose: bool,
}
