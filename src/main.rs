//! The command line of Kluft: arguments in, exit code out.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};
use kluft::{
    Domain, Failure, Grouping, InspectOptions, NetworkOptions, Options, StudyOptions, Verbosity,
    inspect, make_network, run, study,
};

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
  kluft network fractures.csv -o network                  a geometry and a scene from a list
  kluft run scene.toml --out results --threads 2 -v       say where and how
  kluft run scene.toml --resume                           go on after an interruption
  kluft inspect scene.toml                                look at the mesh before solving
  kluft study scene.toml --tolerance 1%                   the cheapest mesh and order for an error of 1 %
  paraview results/rock.pvd results/fractures.pvd         look at it

Exit status:
  0  solved, inspected or studied
  1  not converged: the converged steps are kept, the message says where and why;
     or no setting of a study is as accurate as wanted: the message says what to try
  2  the input is wrong; every defect is listed with its place and its remedy";

#[derive(Subcommand)]
enum Command {
    /// Mesh, enrich, solve and write a scene
    #[command(after_help = RUN_HELP)]
    Run(RunArgs),
    /// Make a geometry and a scene from a list or random sets of fractures
    #[command(after_help = NETWORK_HELP)]
    Network(NetworkArgs),
    /// Report on a scene or a mesh without solving
    #[command(after_help = INSPECT_HELP)]
    Inspect(InspectArgs),
    /// Run a scene with many meshes, orders, laws and solvers: what each yields, and what it costs
    #[command(after_help = STUDY_HELP)]
    Study(StudyArgs),
}

const STUDY_HELP: &str = "\
A section [study] of the scene says what to sweep; every combination is run. What is left out stays as
the scene has it:

  [study]
  meshes = [{ h = 0.2 }, { h = 0.14 }, { h = 0.1 }]   # in the place of [mesh] parameters
  orders = [1, 2]
  closures = [                                        # names, or keys of all fractures
    \"logarithmic\",
    { label = \"cut at 1 um\", closure = \"logarithmic\", cutoff_aperture = 1e-6 },
    { label = \"exact\", closure = \"logarithmic\", cutoff_aperture = false },   # without that key
  ]
  facets = [\"nodal\", \"gauss\"]
  solvers = [\"direct\", \"iterative\", \"condensed\"]
  [study.values]                                      # numbers of all fractures, or of one
  normal_stiffness = { from = 1e9, to = 1e12, count = 7 }
  \"joint.shear_stiffness\" = [1e9, 1e10]

Without [study], the cell sizes `h` and `h_...` of [mesh] parameters are scaled by 2, 1.4 and 1, with
orders 1 and 2.

Errors are those against the closed form, if the scene names one ([oracle.NAME]). Without one they are
against what finer and finer meshes approach: that takes three meshes, and has an uncertainty, which
the charts show as a grey band. More keys of [study]:

  measure = \"opening_l2\"     what is charted, a name among the measures of summary.json
  fracture = \"joint\"         on which fracture
  reference = \"logarithmic\"  the label of the closure whose limit serves all (closures that approximate it)

Writes study.html (everything on one page), study.csv, the charts as SVG, and each setting with its
results in points/. A study that was interrupted goes on where it was: settings that have been run are
not run again, unless scene, geometry, program or threads have changed. Settings that fail are reported,
and the others go on.

With --tolerance the study ends when a setting is accurate enough, and prints it as keys for the scene.";

#[derive(Args)]
struct StudyArgs {
    /// The scene file (TOML)
    scene: PathBuf,
    /// Folder for the results [default: `study` beside the scene]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Largest error wanted, 1% or 0.01; stops at the first setting that reaches it
    #[arg(long, value_name = "SHARE", value_parser = share)]
    tolerance: Option<f64>,
    /// Number of threads of each run [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
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

After each load step the results are complete on disk, and a run that was killed goes on with --resume:
the same bits as without the interruption.

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
    /// Go on after the last load step that an interrupted run of the same scene finished
    #[arg(long)]
    resume: bool,
    /// End when the standard input is closed, as it is when a study dies that runs this
    #[arg(long, hide = true)]
    tied: bool,
    /// Print nothing but errors
    #[arg(long, short, conflicts_with = "verbose")]
    quiet: bool,
    /// Print the report even when the output is not a terminal, and gmsh's warnings
    #[arg(long, short)]
    verbose: bool,
}

const NETWORK_HELP: &str = "\
Writes NAME.geo, scene.toml (ready for `kluft run`) and network.json (statistics, and what became
of every fracture). Lengths in metres, angles in degrees; dip directions count clockwise from north;
x is east, y is north, z is up.

A list (CSV) has one line for each fracture; `#` begins a comment:

  name, set, shape, x, y, z, dip, dip_direction, radius, length, width, rotation, points
  f1, steep, disc, 5, 5, 5, 70, 135, 3,,,,
  f2, steep, rectangle, 4, 5, 6, 80, 140,, 6, 3, 0,
  f3, flat, polygon,,,,,,,,,, 0 0 5; 4 0 5; 4 4 5.5; 0 4 5.5

Shapes: disc (radius), ellipse (semi_major, semi_minor, rotation), rectangle (length, width,
rotation), polygon (points; convex). The first side runs along the strike, turned by `rotation`
towards the dip.

A description (TOML) adds the rock, materials and random sets:

  seed = 1
  [domain]
  low = [0, 0, 0]
  high = [10, 10, 10]
  [mesh]
  h = 1.0                            # away from fractures
  h_fracture = 0.5
  h_intersection = 0.3
  [fracture_set.steep]               # keys of [fracture.NAME] in a scene, and one of
  aperture = 1e-3                    #   list = \"steep.csv\"
  normal_stiffness = 2e10            #   [[fracture]] sections with set = \"steep\"
  shear_stiffness = 1e10             #   orientation, size, and p32 or count
  orientation = { dip = 70, dip_direction = 135, kappa = 20 }
  size = { law = \"power\", exponent = 2.5, min = 1, max = 5 }
  p32 = 0.3                          # area per volume, m2/m3

Laws: constant (radius), power (exponent, min, max), lognormal (mean, sd, min, max). Sections of a
scene, such as [rock.rock] or [boundary.top], go into the scene.

Fractures are cut to the domain. Ends closer to another fracture or a face than a fifth of
h_fracture are moved onto it; what else is too small for the mesh is listed with its fractures.";

#[derive(Args)]
struct NetworkArgs {
    /// List (.csv) or description (.toml) of the fractures
    input: PathBuf,
    /// Folder for geometry, scene and statistics
    #[arg(short, long, value_name = "DIR")]
    out: PathBuf,
    /// Name of the geometry, without .geo
    #[arg(long, value_name = "NAME", default_value = "network", value_parser = file_name)]
    name: String,
    /// What gets a physical surface of its own
    #[arg(long, value_enum, default_value = "fracture")]
    group: Group,
    /// The box of rock: two opposite corners [default: of the description, or around the list]
    #[arg(long, value_name = "X,Y,Z,X,Y,Z", value_parser = domain, allow_hyphen_values = true)]
    domain: Option<Domain>,
    /// Cell size away from fractures, m [default: of the description]
    #[arg(long, value_name = "M", value_parser = length)]
    h: Option<f64>,
    /// Leave features that are too small for the mesh as they are
    #[arg(long)]
    keep_small: bool,
    /// Print nothing but errors
    #[arg(long, short, conflicts_with = "verbose")]
    quiet: bool,
    /// Print the report even when the output is not a terminal
    #[arg(long, short)]
    verbose: bool,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Group {
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

fn solve(args: RunArgs) -> Result<(), Failure> {
    if args.tied {
        std::thread::spawn(|| {
            // Whether it ends or breaks, nobody is there any more.
            let _ = std::io::copy(&mut std::io::stdin(), &mut std::io::sink());
            std::process::exit(1);
        });
    }
    let options = Options {
        out: args.out,
        threads: args.threads.map(usize::from),
        verbosity: verbosity(args.quiet, args.verbose),
        resume: args.resume,
    };
    run(&args.scene, &options)
}

fn network(args: NetworkArgs) -> Result<(), Failure> {
    let options = NetworkOptions {
        out: args.out,
        name: args.name,
        grouping: match args.group {
            Group::Fracture => Grouping::Fracture,
            Group::Set => Grouping::Set,
        },
        domain: args.domain,
        h: args.h,
        keep_small: args.keep_small,
        verbosity: verbosity(args.quiet, args.verbose),
    };
    make_network(&args.input, &options)
}

fn sweep(args: StudyArgs) -> Result<(), Failure> {
    let options = StudyOptions {
        out: args.out,
        tolerance: args.tolerance,
        threads: args.threads.map(usize::from),
        verbosity: verbosity(args.quiet, args.verbose),
    };
    study(&args.scene, &options)
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
    let done = match Cli::parse().command {
        Command::Run(args) => solve(args),
        Command::Network(args) => network(args),
        Command::Inspect(InspectArgs { input, json, out }) => {
            inspect(&input, &InspectOptions { out, json })
        }
        Command::Study(args) => sweep(args),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            kluft::print_failure(&failure);
            ExitCode::from(match failure {
                Failure::NotConverged(_) | Failure::NotReached(_) => 1,
                Failure::BadInput(_) => 2,
            })
        }
    }
}
