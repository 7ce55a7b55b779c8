//! The program `kluft`.

use std::process::ExitCode;

fn main() -> ExitCode {
    kluft::execute(&kluft::Invocation::of_process()).into()
}
