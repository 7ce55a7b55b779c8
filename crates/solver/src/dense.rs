//! Dense kernels beside loops over sparse data.

/// Does work that calls dense kernels on a thread of its own, which ends with it.
///
/// Threads on which dense kernels of faer ran compute up to several times slower afterwards, as if the
/// upper halves of vector registers stayed in use; a level's set-up took 0.73 instead of 0.30 s.
pub(crate) fn apart<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
        Ok(pool) => pool.install(work),
        // No thread to be had: slower, but as right.
        Err(_) => work(),
    }
}
