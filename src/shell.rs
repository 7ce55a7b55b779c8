//! What shells and man(1) know of the program.

use clap::{Command, CommandFactory};
use clap_complete::Shell;

use crate::args::Cli;
use crate::failure::Failure;
use crate::stdout::print;

/// Prints what lets a shell complete commands and options.
///
/// # Errors
/// If it cannot be printed.
pub fn print_completions(shell: Shell) -> Result<(), Failure> {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "kluft", &mut text);
    print(&String::from_utf8_lossy(&text))
}

/// Prints the manual: the program, then each command.
///
/// # Errors
/// If it cannot be printed.
pub fn print_manual() -> Result<(), Failure> {
    let mut program = Cli::command();
    // Gives each command the name of the program before its own.
    program.build();
    let mut text = page(program.clone());
    let is_shown = |command: &&Command| !command.is_hide_set() && command.get_name() != "help";
    for command in program.get_subcommands().filter(is_shown) {
        text.push_str(&page(command.clone()));
    }
    print(&text)
}

/// A page; writing to memory cannot fail.
fn page(command: Command) -> String {
    let mut text = Vec::new();
    let _ = clap_mangen::Man::new(command).render(&mut text);
    String::from_utf8_lossy(&text).into_owned()
}
