//! Systems that refuse memory: by a limit of the address space (`ulimit -v`), or because they
//! promise no more than they have (`vm.overcommit_memory = 2`).
//!
//! An allocation that the system refuses ends a process at once. On such a system a process of its
//! own therefore does the work, and this one says what has become of it. Other systems refuse
//! nothing but what is larger than all their memory; there the process ends as a failure does, with
//! the words of the allocator.

use std::os::unix::process::ExitStatusExt;
use std::process::ExitStatus;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use kluft_mesh::Defect;
use kluft_run::memory;
use nix::sys::prctl;
use nix::sys::resource::{RLIM_INFINITY, Resource, getrlimit};
use nix::sys::signal::Signal;
use nix::unistd::getppid;
use signal_hook::consts::SIGABRT;
use signal_hook::flag;

use crate::failure::Failure;
use crate::invocation::Invocation;

/// Names the process that the work is done for, to the worker and to those that it starts.
const WORKS_FOR: &str = "KLUFT_WORKS_FOR";

/// Lets a process of its own do the work of this one if the system may refuse it memory, and
/// returns its exit code; none if this one shall do it.
pub fn delegate(called: &Invocation) -> Option<u8> {
    if let Some(master) = std::env::var_os(WORKS_FOR) {
        let parent = getppid().to_string();
        // A worker does not outlive who waits for it. That no signal is to be had is no reason to
        // do no work.
        let _ = (master == *parent).then(|| prctl::set_pdeathsig(Signal::SIGKILL));
        return None;
    }
    let Some(refusing) = refusing() else {
        end_as_failure();
        return None;
    };
    let mut command = called.own.as_ref()?.command();
    command.args(called.words.iter().skip(1));
    command.env(WORKS_FOR, std::process::id().to_string());
    Some(of_status(command.status().ok()?, refusing))
}

/// Makes the end of this process by an allocation that is refused (SIGABRT) one with the exit code
/// of a failure.
fn end_as_failure() {
    let always = Arc::new(AtomicBool::new(true));
    // Where there is no such handler, the process ends by the signal.
    let _ = flag::register_conditional_shutdown(SIGABRT, 1, always);
}

/// What may refuse memory to this process, and its key.
fn refusing() -> Option<(&'static str, &'static str)> {
    let (limit, _) = getrlimit(Resource::RLIMIT_AS).ok()?;
    if limit != RLIM_INFINITY {
        return Some(("the limit of its address space", "ulimit -v"));
    }
    let strict = "the system, which promises no more memory than it has,";
    memory::is_promised_strictly().then_some((strict, "vm.overcommit_memory"))
}

fn of_status(status: ExitStatus, refusing: (&str, &str)) -> u8 {
    match (status.code(), status.signal()) {
        (Some(code), _) => u8::try_from(code).unwrap_or(1),
        (None, Some(signal)) if signal == Signal::SIGABRT as i32 => {
            let failure = Failure::Machine(vec![refused(refusing)]);
            failure.print();
            failure.code()
        }
        // As a shell tells it.
        (None, signal) => u8::try_from(128 + signal.unwrap_or(0)).unwrap_or(1),
    }
}

fn refused((by, key): (&str, &str)) -> Defect {
    Defect::new(
        "memory of this process",
        format!("{by} refused the memory that is named above"),
        format!("mesh coarser (a larger h), run on fewer threads, or raise the limit ({key})"),
    )
}

#[cfg(test)]
mod tests {
    use std::process::Command;

    use super::*;

    /// Tells this test that it is the process that asks for too much.
    const ASKS: &str = "KLUFT_TEST_ASKS_FOR_TOO_MUCH";

    #[test]
    fn memory_that_no_system_has_is_a_failure_with_the_size_asked_for() {
        const MOST: usize = isize::MAX as usize;
        if std::env::var_os(ASKS).is_some() {
            end_as_failure();
            std::hint::black_box(Vec::<u8>::with_capacity(MOST));
            return;
        }
        let own = std::env::current_exe().expect("this test");
        let asked = Command::new(own)
            .args(["limited::tests::memory_that", "--nocapture"])
            .env(ASKS, "")
            .output()
            .expect("it starts");
        let words = String::from_utf8_lossy(&asked.stderr);
        assert_eq!(asked.status.code(), Some(1), "{words}");
        let told = format!("memory allocation of {MOST} bytes failed");
        assert!(words.contains(&told), "{words}");
    }
}
