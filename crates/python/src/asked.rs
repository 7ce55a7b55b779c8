//! What every run is asked for: threads.

use kluft_mesh::Defect;
use kluft_run::{pool, thread_count};
use rayon::ThreadPool;

/// So many threads of their own, or one for each core.
///
/// # Errors
/// If the system does not give them.
pub fn threads(count: Option<usize>) -> Result<ThreadPool, Defect> {
    pool(thread_count(count).count)
}
