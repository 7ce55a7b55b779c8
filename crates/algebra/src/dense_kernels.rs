//! Dense kernels beside loops over sparse data.

use std::fs;
use std::sync::atomic::{AtomicUsize, Ordering};

use faer::Par;
use faer::dyn_stack::{MemBuffer, StackReq};

use crate::failure::LinearFailure;

/// Panels that a kernel packs, in units of the largest cache.
const PANELS: usize = 2;

/// Does work that calls dense kernels on a thread of its own, which ends with it.
///
/// Threads on which dense kernels of faer ran compute up to several times slower afterwards, as if
/// the upper halves of vector registers stayed in use.
pub fn apart<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
        Ok(pool) => pool.install(work),
        // No thread to be had: slower, but as right.
        Err(_) => work(),
    }
}

/// All threads at hand, for kernels that take a while.
pub(crate) fn parallelism() -> Par {
    Par::rayon(0)
}

/// Memory that a kernel asks for.
///
/// # Errors
/// If it is not given.
pub(crate) fn scratch(request: StackReq) -> Result<MemBuffer, LinearFailure> {
    let bytes = request.size_bytes();
    MemBuffer::try_new(request).map_err(|_| LinearFailure::OutOfMemory(bytes))
}

/// Makes sure that kernels get the memory in which each thread packs panels. They take it at their
/// first product, keep it, and end the process if it is not given.
///
/// # Errors
/// If it would not be given.
pub(crate) fn reserve_panels() -> Result<(), LinearFailure> {
    static THREADS_SERVED: AtomicUsize = AtomicUsize::new(0);
    let threads = rayon::current_num_threads();
    let served = THREADS_SERVED.load(Ordering::Relaxed);
    let bytes = threads.saturating_sub(served) * PANELS * largest_cache();
    let mut panels: Vec<u8> = Vec::new();
    panels
        .try_reserve_exact(bytes)
        .map_err(|_| LinearFailure::OutOfMemory(bytes))?;
    THREADS_SERVED.fetch_max(threads, Ordering::Relaxed);
    Ok(())
}

/// Size (bytes) of the largest cache of the processor; 0 where the system does not tell.
fn largest_cache() -> usize {
    let caches = fs::read_dir("/sys/devices/system/cpu/cpu0/cache");
    let caches = caches.into_iter().flatten().flatten();
    let sizes = caches.filter_map(|cache| {
        let text = fs::read_to_string(cache.path().join("size")).ok()?;
        let kilobytes: usize = text.trim().strip_suffix('K')?.parse().ok()?;
        Some(kilobytes << 10)
    });
    sizes.max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// More than any machine has addresses for.
    #[test]
    fn memory_that_is_not_given_is_named() {
        let bytes = isize::MAX as usize / 2;
        let asked = scratch(StackReq::new::<u8>(bytes));
        assert_eq!(asked.err(), Some(LinearFailure::OutOfMemory(bytes)));
    }
}
