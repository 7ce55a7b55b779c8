//! The threads that a run works on.

use kluft_mesh::Defect;
use rayon::ThreadPool;

use crate::memory::address_space_left;

/// Stack of each thread (bytes): that of a main thread.
const STACK: usize = 8 << 20;
/// Address space that the allocator of the system reserves for each thread (bytes), and once more
/// while it does so.
const ARENA: usize = 64 << 20;
/// Most threads for each core: more of them only take memory and time.
const PER_CORE: usize = 4;
/// As many threads may always be had.
const ALWAYS: usize = 16;

/// A number of threads, and a word if fewer are taken than were asked for.
pub struct ThreadCount {
    /// The number.
    pub count: usize,
    /// Why it is not the one that was asked for.
    pub word: Option<String>,
}

/// The number of threads that is asked for, or that `RAYON_NUM_THREADS` says, or of cores; at most
/// four for each core.
pub fn thread_count(asked: Option<usize>) -> ThreadCount {
    let variable = std::env::var("RAYON_NUM_THREADS").ok();
    let variable = variable.and_then(|text| text.parse::<usize>().ok());
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    capped(asked.or(variable).filter(|&count| count > 0), cores)
}

fn capped(asked: Option<usize>, cores: usize) -> ThreadCount {
    let most = (PER_CORE * cores).max(ALWAYS);
    let asked = asked.unwrap_or(cores);
    let word = (asked > most).then(|| {
        format!("{most} threads are taken instead of {asked}: more do not help {cores} cores")
    });
    ThreadCount {
        count: asked.min(most),
        word,
    }
}

/// So many threads.
///
/// # Errors
/// If the system does not give them. One that gives a thread, but no room for its signals, would
/// end the process; where the address space is limited, it is therefore counted before.
pub fn pool(count: usize) -> Result<ThreadPool, Defect> {
    let need = count * (STACK + ARENA) + ARENA;
    if let Some(left) = address_space_left().filter(|&left| left < need) {
        let why = format!(
            "they need {} MB of address space, {} MB are left",
            need >> 20,
            left >> 20
        );
        return Err(not_given(count, &why));
    }
    let builder = rayon::ThreadPoolBuilder::new()
        .num_threads(count)
        .stack_size(STACK);
    let pool = builder.build();
    pool.map_err(|error| not_given(count, &error.to_string()))
}

fn not_given(count: usize, why: &str) -> Defect {
    Defect::new(
        "threads",
        format!("the system does not give {count} threads: {why}"),
        "ask for fewer, e.g. --threads 1, or raise the limit of processes or of memory (ulimit -v)",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_threads_for_each_core_are_too_many() {
        let count = |asked, cores| capped(asked, cores).count;
        assert_eq!((count(None, 3), count(Some(7), 1)), (3, 7));
        assert_eq!((count(Some(40_000), 2), count(Some(40_000), 64)), (16, 256));
        assert_eq!(capped(Some(16), 2).word, None);
        let word = capped(Some(1000), 2).word.expect("a word");
        assert!(word.contains("1000") && word.contains("16"), "{word}");
    }
}
