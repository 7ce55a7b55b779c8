//! The command line of Kluft: arguments in, exit code out.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};
use kluft::{Failure, InspectOptions, Options, Verbosity, inspect, run};

/// Fractured rock in 3D: from a gmsh geometry to apertures, jumps and stresses in ParaView.
///
/// The fractures are physical surfaces of the geometry. Their walls may open, slide and close, and
/// under the exact logarithmic law they never overlap. Intersections, tips and cut boundaries need
/// no help.
#[derive(Parser)]
#[command(version, arg_required_else_help = true, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

const EXAMPLES: &str = "\
Examples:
  kluft run geometries/inclined-joint/scene.toml          mesh, solve, write beside the scene
  kluft run scene.toml --out results --threads 2 -v       say where and how
  kluft inspect scene.toml                                look at the mesh before solving
  paraview results/rock.pvd results/fractures.pvd         look at it

Exit status:
  0  solved, or inspected
  1  not converged; the converged steps are kept, the message says where and why
  2  the input is wrong; every defect is listed with its place and its remedy";

#[derive(Subcommand)]
enum Command {
    /// Mesh, enrich, solve and write a scene
    #[command(after_help = RUN_HELP)]
    Run(RunArgs),
    /// Report on a scene or a mesh without solving
    #[command(after_help = INSPECT_HELP)]
    Inspect(InspectArgs),
}

const INSPECT_HELP: &str = "\
Says what every physical group is, how fractures lie, end and meet, which blocks they cut free,
which cells are bad and where, how many unknowns there are, what the solver will need, and whether
the loads would push the walls of a fracture through each other. A mesh without a scene is guessed
at: surfaces with rock on both sides are fractures. Writes inspect.vtu and inspect.json.";

const RUN_HELP: &str = "\
A scene names its geometry, rocks, fractures and conditions, all in SI units:

  [mesh]
  geometry = \"joint.geo\"             # or: file = \"joint.msh\"
  parameters = { h = 0.1 }           # handed to gmsh as -setnumber
  [rock.default]
  young_modulus = 50e9
  poisson_ratio = 0.25
  [fracture.joint]                   # a physical surface
  aperture = 1e-4
  normal_stiffness = 1e11
  shear_stiffness = 1e10
  closure = \"logarithmic\"            # or \"linear\"
  [boundary.top]
  traction = [0, 0, -7e6]
  [boundary.bottom]
  symmetry = true                    # a roller on any plane

The folder geometries/ holds complete scenes; README.md lists every key.";

#[derive(Args)]
struct RunArgs {
    /// The scene file (TOML)
    scene: PathBuf,
    /// Folder for the results [default: `out` beside the scene]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Number of threads; results do not depend on it [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Print nothing but errors
    #[arg(long, short, conflicts_with = "verbose")]
    quiet: bool,
    /// Print the report even when the output is not a terminal, and gmsh's warnings
    #[arg(long, short)]
    verbose: bool,
}

#[derive(Args)]
struct InspectArgs {
    /// The scene file (TOML), or a gmsh mesh (.msh)
    input: PathBuf,
    /// Print the report as JSON
    #[arg(long)]
    json: bool,
    /// Folder for inspect.vtu and inspect.json [default: `out` beside the input]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Run(args) => run_scene(args),
        Command::Inspect(InspectArgs { input, json, out }) => {
            inspect(&input, &InspectOptions { out, json })
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            kluft::print_failure(&failure);
            ExitCode::from(match failure {
                Failure::NotConverged(_) => 1,
                Failure::BadInput(_) => 2,
            })
        }
    }
}

fn run_scene(args: RunArgs) -> Result<(), Failure> {
    let verbosity = match (args.quiet, args.verbose) {
        (true, _) => Verbosity::Quiet,
        (_, true) => Verbosity::Verbose,
        _ => Verbosity::Terminal,
    };
    let options = Options {
        out: args.out,
        threads: args.threads.map(usize::from),
        verbosity,
    };
    run(&args.scene, &options)
}
