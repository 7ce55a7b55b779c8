//! The program: the command line, the terminal that follows a run, and the commands beside it.
//!
//! Arguments come in, an exit code goes out. Only here anything is printed.

mod args;
mod explain;
mod failure;
mod gmsh;
mod inspect;
mod network;
mod report;
mod run;
#[cfg(target_os = "linux")]
mod start_gmsh;
mod study;

use std::process::ExitCode;

use clap::Parser;

use args::{Cli, Command};

fn main() -> ExitCode {
    let done = match Cli::parse().command {
        Command::Run(args) => run::run(&args.scene.clone(), &args.into()),
        Command::Network(args) => network::make_network(&args.input.clone(), &args.into()),
        Command::Inspect(args) => inspect::inspect(&args.input.clone(), &args.into()),
        Command::Study(args) => study::study(&args.scene.clone(), &args.into()),
        Command::Explain { key } => explain::explain(key.as_deref()),
        Command::Schema { document } => {
            explain::print_schema(document.into());
            Ok(())
        }
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
