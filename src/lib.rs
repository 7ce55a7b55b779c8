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

use std::io::Write;

use clap::Parser;
use kluft_program::{defects, failure, gmsh, input, printing, report};
#[cfg(target_os = "linux")]
use kluft_program::{limited, start_gmsh};

pub use kluft_program::invocation::{Invocation, OwnProgram};

use args::{Cli, Command};

/// Does what the command line says and returns the exit code.
pub fn execute(invocation: &Invocation) -> u8 {
    #[cfg(target_os = "linux")]
    if let Some(code) = limited::delegate(invocation) {
        return code;
    }
    let code = match arguments(invocation) {
        Ok(cli) => command(cli.command, invocation),
        Err(error) => {
            // With the stream gone there is nobody left to tell.
            let _ = error.print();
            error.exit_code() as u8
        }
    };
    // Who called may end the process without the runtime of this language.
    let _ = std::io::stdout().flush();
    code
}

fn command(command: Command, called: &Invocation) -> u8 {
    let done = match command {
        Command::Init(args) => init::init(&args.input.clone(), &args.options(called)),
        Command::Run(args) => run::run(&args.scene.clone(), &args.options(called)),
        Command::Network(args) => network::make_network(&args.input.clone(), &args.options(called)),
        Command::Import(args) => import::import(&args.input.clone(), &args.into()),
        Command::Inspect(args) => inspect::inspect(&args.input.clone(), &args.options(called)),
        Command::Study(args) => study::study(&args.scene.clone(), &args.options(called)),
        Command::Explain { key } => explain::explain(key.as_deref()),
        Command::Schema { document } => explain::print_schema(document.into()),
        Command::Completions { shell } => shell::print_completions(shell),
        Command::Man => shell::print_manual(),
        #[cfg(target_os = "linux")]
        Command::StartGmsh(args) => return start_gmsh::start(&args),
    };
    match done {
        Ok(()) => 0,
        Err(failure) => {
            failure.print();
            failure.code()
        }
    }
}

/// The arguments, or what is wrong with them.
fn arguments(invocation: &Invocation) -> Result<Cli, clap::Error> {
    let given = &invocation.words;
    Cli::try_parse_from(given).map_err(|error| {
        // The message repeats what was given, which may hold what commands a terminal.
        let shown = given
            .iter()
            .map(|one| printing::one_line(&one.to_string_lossy()).into_owned());
        Cli::try_parse_from(shown).err().unwrap_or(error)
    })
}
