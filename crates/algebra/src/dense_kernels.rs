//! Dense kernels beside loops over sparse data.

use faer::Par;

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
