//! The program: the command line, the terminal that follows a run, and the commands beside it.
//!
//! Arguments come in, an exit code goes out. Only here anything is printed.

mod args;
mod explain;
mod import;
mod init;
mod inspect;
mod network;
mod ranks;
mod run;
mod shell;
mod stdout;
mod study;

use std::process::ExitCode;

use clap::Parser;
use kluft_program::{defects, failure, gmsh, input, printing, report};
#[cfg(target_os = "linux")]
use kluft_program::{limited, start_gmsh};

use args::{Cli, Command};

fn main() -> ExitCode {
    #[cfg(target_os = "linux")]
    if let Some(code) = limited::delegate() {
        return code;
    }
    let done = match arguments().command {
        Command::Init(args) => init::init(&args.input.clone(), &args.into()),
        Command::Run(args) => run::run(&args.scene.clone(), &args.into()),
        Command::Network(args) => network::make_network(&args.input.clone(), &args.into()),
        Command::Import(args) => import::import(&args.input.clone(), &args.into()),
        Command::Inspect(args) => inspect::inspect(&args.input.clone(), &args.into()),
        Command::Study(args) => study::study(&args.scene.clone(), &args.into()),
        Command::Explain { key } => explain::explain(key.as_deref()),
        Command::Schema { document } => explain::print_schema(document.into()),
        Command::Completions { shell } => shell::print_completions(shell),
        Command::Man => shell::print_manual(),
        #[cfg(target_os = "linux")]
        Command::StartGmsh(args) => return start_gmsh::start(&args),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.print();
            failure.exit_code()
        }
    }
}

/// The arguments; what is wrong with them ends the program, after the usage.
fn arguments() -> Cli {
    Cli::try_parse().unwrap_or_else(|error| {
        // The message repeats what was given, which may hold what commands a terminal.
        let given = std::env::args_os();
        let shown = given.map(|one| printing::one_line(&one.to_string_lossy()).into_owned());
        Cli::try_parse_from(shown).err().unwrap_or(error).exit()
    })
}
