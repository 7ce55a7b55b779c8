//! Ranks that are threads of one process, for tests of what ranks divide.

use std::sync::{Arc, Barrier, Mutex, PoisonError};

use crate::division::Communicator;

/// What each of `size` ranks makes of its communicator, rank by rank.
///
/// # Panics
/// If one of them does. The others may wait for it, as ranks that are processes do.
pub fn on_threads<T: Send>(size: usize, of: impl Fn(&Communicator) -> T + Sync) -> Vec<T> {
    let shared = Arc::new((Mutex::new(Vec::new()), Barrier::new(size)));
    let communicator = |rank: usize| {
        let shared = Arc::clone(&shared);
        let gather = move |record: usize, own: &[u8], counts: &[usize], all: &mut [u8]| {
            let (records, barrier) = &*shared;
            let records = || records.lock().unwrap_or_else(PoisonError::into_inner);
            let start = record * counts[..rank].iter().sum::<usize>();
            barrier.wait();
            records().resize(all.len(), 0);
            barrier.wait();
            records()[start..start + record * counts[rank]].copy_from_slice(own);
            barrier.wait();
            all.copy_from_slice(&records());
        };
        Communicator::new(rank, size, Arc::new(gather))
    };
    std::thread::scope(|scope| {
        let (ranks, of) = ((0..size).map(communicator), &of);
        let ranks = ranks.map(|communicator| scope.spawn(move || of(&communicator)));
        let ranks: Vec<_> = ranks.collect();
        let made = ranks.into_iter().map(|rank| rank.join());
        made.map(|made| made.unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            .collect()
    })
}
