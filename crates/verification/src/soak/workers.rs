//! Items of work shared out among threads.

use std::iter;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// As many threads as the machine has cores.
pub fn cores() -> usize {
    thread::available_parallelism().map_or(1, NonZeroUsize::get)
}

/// Works on items on so many threads, each on the next that is left, until `work` returns nothing;
/// what it returned, in the order of the items.
///
/// # Panics
/// If `work` does.
pub fn each_by<I: Sync, T: Send>(
    threads: usize,
    items: &[I],
    work: impl Fn(&I) -> Option<T> + Sync,
) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let own = || {
        let places = iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed));
        let done = places.map_while(|place| Some((place, work(items.get(place)?)?)));
        done.collect::<Vec<_>>()
    };
    let mut done: Vec<(usize, T)> = thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(own)).collect();
        let done = workers.into_iter();
        done.flat_map(|worker| worker.join().expect("work without a panic"))
            .collect()
    });
    done.sort_by_key(|(place, _)| *place);
    done.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_item_is_worked_on_once_and_comes_back_in_its_place() {
        let items: Vec<usize> = (0..100).collect();
        let squares: Vec<usize> = items.iter().map(|item| item * item).collect();
        let square = |item: &usize| (*item < 60).then_some(item * item);
        for threads in [1, 2, 7] {
            assert_eq!(each_by(threads, &items, |item| Some(item * item)), squares);
            assert_eq!(each_by(threads, &items, square), squares[..60]);
        }
        assert!(each_by(2, &[], square).is_empty());
    }
}
