//! Kluft on many ranks: `mpiexec -n 8 kluft-mpi run SCENE.toml`.

use std::io::Write;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

use clap::Parser;
use kluft_program::failure::Failure;

use kluft_mpi::answers::machine;
use kluft_mpi::args::{Cli, Command};
use kluft_mpi::petsc::World;
use kluft_mpi::run;

/// How long a rank that fails waits for the others to end as well, before it ends them.
const PATIENCE: Duration = Duration::from_secs(4);
/// A run may take its time.
const FOR_EVER: Duration = Duration::from_secs(1 << 40);

fn main() -> ExitCode {
    let parsed = Cli::try_parse();
    #[cfg(target_os = "linux")]
    if let Ok(Cli {
        command: Command::StartGmsh(args),
    }) = &parsed
    {
        return ExitCode::from(kluft_program::start_gmsh::start(args));
    }
    let world = match World::start() {
        Ok(world) => world,
        Err(failure) => {
            machine(failure).print();
            return ExitCode::FAILURE;
        }
    };
    end_all_upon_panic(world.rank());
    let done = match parsed {
        Ok(Cli {
            command: Command::Run(args),
        }) => run::run(&world, &args),
        #[cfg(target_os = "linux")]
        Ok(_) => Ok(()),
        Err(error) => {
            if world.rank() == 0 {
                let _ = error.print();
            }
            return ExitCode::from(error.exit_code() as u8);
        }
    };
    ended(&world, done)
}

fn say(text: &str) {
    // With the error stream gone there is nobody left to tell.
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// A rank that panics would leave the others waiting.
fn end_all_upon_panic(rank: usize) {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        say(&format!("rank {rank} failed:"));
        usual(info);
        World::abort(1);
    }));
}

/// Ends together with the other ranks: one of those that failed says why. If some are still at
/// work, where they may wait for this one, they are ended.
fn ended(world: &Arc<World>, done: Result<(), Failure>) -> ExitCode {
    let patience = match done {
        Ok(()) => FOR_EVER,
        Err(_) => PATIENCE,
    };
    let arrived = world.all_arrive(patience).unwrap_or(false);
    let failure = done.err();
    let code = failure.as_ref().map_or(0, Failure::code);
    let has_words = failure.as_ref().is_some_and(Failure::has_words);
    if !arrived {
        say(&format!(
            "rank {} fails, and ends the others:",
            world.rank()
        ));
        failure.iter().for_each(Failure::print);
        World::abort(code.max(1));
    }
    let all = world.gather(&[u64::from(code), u64::from(has_words)]);
    let all = all.unwrap_or_default();
    let speaker = all.chunks_exact(2).position(|pair| pair[1] == 1);
    if speaker == Some(world.rank()) {
        failure.iter().for_each(Failure::print);
    }
    let code = all.chunks_exact(2).map(|pair| pair[0]).max();
    ExitCode::from(code.unwrap_or(1) as u8)
}
