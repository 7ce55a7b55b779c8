//! The command line: what may be said, and what it means.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use kluft_keys::Document;
use kluft_network::{Domain, Grouping};
use kluft_program::invocation::Invocation;

use crate::gmsh::GmshArgs;
#[cfg(target_os = "linux")]
use crate::gmsh::START;
use crate::import::ImportOptions;
use crate::init::InitOptions;
use crate::inspect::{Form, InspectOptions};
use crate::network::NetworkOptions;
use crate::printing::WIDTH;
use crate::report::Verbosity;
use crate::run::RunOptions;
#[cfg(target_os = "linux")]
use crate::start_gmsh::StartArgs;
use crate::study::StudyOptions;

/// Fractured rock in 3D: from a gmsh geometry to apertures, jumps and stresses in ParaView.
///
/// The fractures are physical surfaces of the geometry. Their walls may open, slide
/// and close, and under the exact logarithmic law they never overlap. Intersections,
/// tips and cut boundaries need no help.
#[derive(Parser)]
#[command(version, term_width = WIDTH, arg_required_else_help = true, after_help = include_str!("help/examples.txt").trim_end())]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Subcommand)]
pub enum Command {
    /// Write a scene for a mesh or a geometry, with what its groups suggest
    #[command(after_help = include_str!("help/init.txt").trim_end())]
    Init(InitArgs),
    /// Mesh, enrich, solve and write a scene
    #[command(after_help = include_str!("help/run.txt").trim_end())]
    Run(RunArgs),
    /// Make a geometry and a scene from a list or random sets of fractures
    #[command(after_help = include_str!("help/network.txt").trim_end())]
    Network(NetworkArgs),
    /// Make a gmsh mesh and a scene of a mesh of another program
    Import(ImportArgs),
    /// Report on a scene or a mesh without solving
    #[command(after_help = include_str!("help/inspect.txt").trim_end())]
    Inspect(InspectArgs),
    /// Run a scene with many meshes, orders, laws and solvers: what each yields, and what it costs
    #[command(after_help = include_str!("help/study.txt").trim_end())]
    Study(StudyArgs),
    /// Say what a key of a scene, a network description or a study means
    Explain {
        /// A key, SECTION.KEY or a section; without one, all are listed
        key: Option<String>,
    },
    /// Print the JSON Schema of a document, for an editor to complete and check keys
    #[command(after_help = include_str!("help/schema.txt").trim_end())]
    Schema {
        /// The document
        #[arg(value_enum, default_value = "scene")]
        document: SchemaOf,
    },
    /// Print what lets a shell complete commands and options
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Print the manual, a page of man(1)
    Man,
    /// Become gmsh
    #[cfg(target_os = "linux")]
    #[command(name = START, hide = true)]
    StartGmsh(StartArgs),
}

/// Arguments of `kluft init`.
#[derive(Args)]
pub struct InitArgs {
    /// A mesh (.msh) or a geometry (.geo) of gmsh
    pub input: PathBuf,
    /// The scene to write [default: `scene.toml` beside the input]
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    gmsh: GmshArgs,
}

/// A document that has a schema.
#[derive(Clone, Copy, clap::ValueEnum)]
pub enum SchemaOf {
    /// A scene, with its study
    Scene,
    /// A description for `kluft network`
    Network,
    /// The study of a scene alone
    Study,
}

impl From<SchemaOf> for Document {
    fn from(document: SchemaOf) -> Self {
        match document {
            SchemaOf::Scene => Self::Scene,
            SchemaOf::Network => Self::Network,
            SchemaOf::Study => Self::Study,
        }
    }
}

/// Arguments of `kluft study`.
#[derive(Args)]
pub struct StudyArgs {
    /// The scene file (TOML), or the folder that holds it
    pub scene: PathBuf,
    /// Folder for the results [default: `study` beside the scene]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Largest error wanted, 1% or 0.01; stops at the first setting that reaches it
    #[arg(long, value_name = "SHARE", value_parser = share)]
    tolerance: Option<f64>,
    /// Number of threads of each run, at most 4 a core (or 16) [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    #[command(flatten)]
    gmsh: GmshArgs,
    /// Print nothing but errors and the answer to --tolerance
    #[arg(long, short, conflicts_with = "verbose")]
    quiet: bool,
    /// Print the report even when the output is not a terminal
    #[arg(long, short)]
    verbose: bool,
}

fn share(text: &str) -> Result<f64, String> {
    let (number, unit) = match text.strip_suffix('%') {
        Some(percent) => (percent.trim_end(), 0.01),
        None => (text, 1.0),
    };
    let share = number.parse::<f64>().ok().map(|number| number * unit);
    let sensible = share.filter(|share| *share > 0.0 && *share < 1.0);
    sensible.ok_or_else(|| "a share between 0 and 1 is wanted, e.g. 1% or 0.01".to_owned())
}

/// Arguments of `kluft run`.
#[derive(Args)]
pub struct RunArgs {
    /// The scene file (TOML), or the folder that holds it
    pub scene: PathBuf,
    /// Folder for the results [default: `out` beside the scene]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Number of threads, at most 4 a core (or 16); results do not depend on it
    /// [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Run on N processes that share the work, by way of mpiexec and kluft-mpi
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    ranks: Option<u16>,
    /// Go on after the last load step that an interrupted run of the same scene finished
    #[arg(long)]
    resume: bool,
    /// Write no report.html
    #[arg(long)]
    no_report: bool,
    #[command(flatten)]
    gmsh: GmshArgs,
    /// End when the standard input is closed, as it is when a study dies that runs this
    #[arg(long, hide = true)]
    tied: bool,
    /// Print nothing but errors
    #[arg(long, short, conflicts_with = "verbose")]
    quiet: bool,
    /// Print the report even when the output is not a terminal, with iterations and gmsh's warnings
    #[arg(long, short)]
    verbose: bool,
}

/// Arguments of `kluft network`.
#[derive(Args)]
pub struct NetworkArgs {
    /// List (.csv) or description (.toml) of the fractures
    pub input: PathBuf,
    /// Folder for geometry, scene and statistics
    #[arg(short, long, value_name = "DIR")]
    out: PathBuf,
    /// Name of the geometry, without .geo
    #[arg(long, value_name = "NAME", default_value = "network", value_parser = file_name)]
    name: String,
    /// What gets a physical surface of its own
    #[arg(long, value_enum, default_value = "fracture")]
    group: GroupBy,
    /// The box of rock: two opposite corners [default: of the description, or around the list]
    #[arg(long, value_name = "X,Y,Z,X,Y,Z", value_parser = domain, allow_hyphen_values = true)]
    domain: Option<Domain>,
    /// Cell size away from fractures, m [default: of the description]
    #[arg(long, value_name = "M", value_parser = length)]
    h: Option<f64>,
    /// Leave features that are too small for the mesh as they are
    #[arg(long)]
    keep_small: bool,
    /// Let water flow in the fractures of a list, all so wide for it, in rigid rock, m; without
    /// more the scene asks for the permeability of the box
    #[arg(long, value_name = "M", value_parser = length)]
    hydraulic_aperture: Option<f64>,
    /// Run the scene that is made
    #[arg(long)]
    run: bool,
    #[command(flatten)]
    gmsh: GmshArgs,
    /// Print nothing but errors
    #[arg(long, short, conflicts_with = "verbose")]
    quiet: bool,
    /// Print the report even when the output is not a terminal
    #[arg(long, short)]
    verbose: bool,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum GroupBy {
    /// Each fracture
    Fracture,
    /// Each set
    Set,
}

fn file_name(text: &str) -> Result<String, String> {
    let is_plain = !text.is_empty() && !text.contains(['/', '\\', '\0']);
    is_plain
        .then(|| text.to_owned())
        .ok_or_else(|| "a name without folders is wanted".to_owned())
}

fn length(text: &str) -> Result<f64, String> {
    let number = text
        .parse::<f64>()
        .ok()
        .filter(|number| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "a length greater than 0 is wanted".to_owned())
}

fn domain(text: &str) -> Result<Domain, String> {
    let numbers: Result<Vec<f64>, _> = text
        .split(',')
        .map(|word| word.trim().parse::<f64>())
        .collect();
    let numbers = numbers
        .ok()
        .and_then(|numbers| <[f64; 6]>::try_from(numbers).ok());
    let corners = numbers.filter(|numbers| numbers.iter().all(|number| number.is_finite()));
    let [a, b, c, d, e, f] =
        corners.ok_or_else(|| "six numbers are wanted, e.g. 0,0,0,10,10,10".to_owned())?;
    if a >= d || b >= e || c >= f {
        return Err("the second corner must be above the first in every coordinate".to_owned());
    }
    Ok(Domain::between([a, b, c], [d, e, f]))
}

fn verbosity(quiet: bool, verbose: bool) -> Verbosity {
    match (quiet, verbose) {
        (true, _) => Verbosity::Quiet,
        (_, true) => Verbosity::Verbose,
        _ => Verbosity::Terminal,
    }
}

/// Arguments of `kluft import`.
#[derive(Args)]
pub struct ImportArgs {
    /// The mesh: an Abaqus input file (.inp), a grid of VTK with numbers of materials (.vtu), an
    /// Exodus mesh (.e; read by a Python with VTK), or a project of OpenGeoSys with its mesh (.prj)
    pub input: PathBuf,
    /// Folder for mesh and scene
    #[arg(short, long, value_name = "DIR")]
    out: PathBuf,
    /// Print nothing but errors
    #[arg(long, short, conflicts_with = "verbose")]
    quiet: bool,
    /// Print the report even when the output is not a terminal
    #[arg(long, short)]
    verbose: bool,
}

/// Arguments of `kluft inspect`.
#[derive(Args)]
pub struct InspectArgs {
    /// The scene file (TOML), the folder that holds it, or a gmsh mesh (.msh)
    pub input: PathBuf,
    /// Print the report as JSON
    #[arg(long)]
    json: bool,
    /// Describe each of many fractures, which have a line each without it
    #[arg(long, short, conflicts_with = "json")]
    verbose: bool,
    /// Folder for inspect.vtu and inspect.json [default: `out` beside the input]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    gmsh: GmshArgs,
}

impl InitArgs {
    /// What they ask for.
    pub fn options(self, called: &Invocation) -> InitOptions {
        InitOptions {
            out: self.out,
            gmsh: self.gmsh.options(called.own.as_ref()),
        }
    }
}

impl RunArgs {
    /// What they ask for.
    pub fn options(self, called: &Invocation) -> RunOptions {
        RunOptions {
            out: self.out,
            threads: self.threads.map(usize::from),
            ranks: self.ranks,
            verbosity: verbosity(self.quiet, self.verbose),
            resume: self.resume,
            report: !self.no_report,
            is_tied: self.tied,
            command: called.command_line(),
            gmsh_arguments: self.gmsh.arguments(),
            gmsh: self.gmsh.options(called.own.as_ref()),
        }
    }
}

impl NetworkArgs {
    /// What they ask for.
    pub fn options(self, called: &Invocation) -> NetworkOptions {
        NetworkOptions {
            out: self.out,
            name: self.name,
            grouping: match self.group {
                GroupBy::Fracture => Grouping::Fracture,
                GroupBy::Set => Grouping::Set,
            },
            domain: self.domain,
            h: self.h,
            keep_small: self.keep_small,
            hydraulic_aperture: self.hydraulic_aperture,
            run: self.run,
            command: called.command_line(),
            gmsh: self.gmsh.options(called.own.as_ref()),
            verbosity: verbosity(self.quiet, self.verbose),
        }
    }
}

impl StudyArgs {
    /// What they ask for.
    pub fn options(self, called: &Invocation) -> StudyOptions {
        StudyOptions {
            out: self.out,
            tolerance: self.tolerance,
            threads: self.threads.map(usize::from),
            verbosity: verbosity(self.quiet, self.verbose),
            gmsh: self.gmsh,
            own: called.own.clone(),
        }
    }
}

impl From<ImportArgs> for ImportOptions {
    fn from(args: ImportArgs) -> Self {
        Self {
            out: args.out,
            verbosity: verbosity(args.quiet, args.verbose),
        }
    }
}

impl InspectArgs {
    /// What they ask for.
    pub fn options(self, called: &Invocation) -> InspectOptions {
        InspectOptions {
            out: self.out,
            form: match (self.json, self.verbose) {
                (true, _) => Form::Json,
                (_, true) => Form::Long,
                _ => Form::Short,
            },
            gmsh: self.gmsh.options(called.own.as_ref()),
        }
    }
}
