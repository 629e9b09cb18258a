//! Independent pieces of work, as many at a time as the processor has cores.

use std::panic::resume_unwind;
use std::sync::{Mutex, PoisonError};
use std::thread;

/// Results that are there, in the order of their items, and what sees them.
struct Results<R, S> {
    found: Vec<Option<R>>,
    /// Number of results that `seen` got: all before the first one that is missing.
    shown: usize,
    seen: S,
}

impl<R, S: FnMut(&R)> Results<R, S> {
    fn add(&mut self, at: usize, result: R) {
        self.found[at] = Some(result);
        while let Some(Some(next)) = self.found.get(self.shown) {
            (self.seen)(next);
            self.shown += 1;
        }
    }
}

/// Does `work` with each item and returns the results in the order of the items. Each core takes the next item when it is done with one.
/// `seen` gets each result once, in that order, as soon as all before it are there.
///
/// # Errors
/// The first error of the items in their order, among those that were begun: after an error nothing more is begun.
///
/// # Panics
/// If `work` or `seen` panics, when the items that were begun are done.
pub fn each<'a, T: Sync, R: Send, E: Send>(
    items: &'a [T],
    work: impl Fn(&'a T) -> Result<R, E> + Sync,
    seen: impl FnMut(&R) + Send,
) -> Result<Vec<R>, E> {
    let waiting = Mutex::new(items.iter().enumerate());
    let next = || waiting.lock().unwrap_or_else(PoisonError::into_inner).next();
    let results = Mutex::new(Results {
        found: items.iter().map(|_| None).collect(),
        shown: 0,
        seen,
    });
    let worker = || -> Result<(), (usize, E)> {
        while let Some((at, item)) = next() {
            match work(item) {
                Ok(result) => results.lock().unwrap_or_else(PoisonError::into_inner).add(at, result),
                Err(error) => {
                    while next().is_some() {}
                    return Err((at, error));
                }
            }
        }
        Ok(())
    };
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let ends: Vec<_> = thread::scope(|scope| {
        let others: Vec<_> = (1..cores.min(items.len())).map(|_| scope.spawn(worker)).collect();
        let own = worker();
        let others = others
            .into_iter()
            .map(|other| other.join().unwrap_or_else(|panic| resume_unwind(panic)));
        others.chain([own]).collect()
    });
    match ends.into_iter().filter_map(Result::err).min_by_key(|(at, _)| *at) {
        Some((_, error)) => Err(error),
        None => {
            let results = results.into_inner().unwrap_or_else(PoisonError::into_inner);
            Ok(results.found.into_iter().flatten().collect())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Barrier;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::time::Duration;

    #[test]
    fn results_come_in_the_order_of_the_items() {
        let mut seen = Vec::new();
        let late_first = |item: &u64| {
            thread::sleep(Duration::from_millis(20 - 2 * item));
            Ok::<_, ()>(item * item)
        };
        let squares = each(&[0, 1, 2, 3, 4, 5], late_first, |square| seen.push(*square)).unwrap();
        assert_eq!(squares, [0, 1, 4, 9, 16, 25]);
        assert_eq!(seen, squares);
        assert_eq!(
            each(&[] as &[u64], late_first, |_| panic!("nothing is there")),
            Ok(vec![])
        );
    }

    #[test]
    fn every_core_has_an_item() {
        let cores = thread::available_parallelism().map_or(1, usize::from);
        // Nobody passes before all have come.
        let (all, items) = (Barrier::new(cores), vec![(); cores]);
        let met = each(&items, |()| Ok::<_, ()>(all.wait().is_leader()), |_| ());
        assert_eq!(met.unwrap().iter().filter(|leader| **leader).count(), 1);
    }

    #[test]
    fn nothing_is_begun_after_an_error() {
        let (items, begun) = ((0..1000).collect::<Vec<usize>>(), AtomicUsize::new(0));
        let fails = |item: &usize| {
            begun.fetch_add(1, Ordering::Relaxed);
            // The others take longer than the one that fails.
            if *item == 0 {
                return Err(*item);
            }
            thread::sleep(Duration::from_millis(20));
            Ok(())
        };
        assert_eq!(each(&items, fails, |()| ()), Err(0));
        assert!(begun.into_inner() < items.len() / 2);
    }
}
