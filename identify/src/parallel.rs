//! Work on two cores.

use std::panic::resume_unwind;
use std::thread;

/// Returns the results of a function for all items, in their order; each thread computes one half.
pub(crate) fn mapped<T: Sync, R: Send>(items: &[T], result: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let (some, others) = items.split_at(items.len() / 2);
    let all = |items: &[T]| -> Vec<R> { items.iter().map(&result).collect() };
    let (mut found, rest) = both(|| all(some), || all(others));
    found.extend(rest);
    found
}

/// Returns the results of two functions; the first runs on a second thread if the system has one for it.
pub(crate) fn both<A: Send, B>(first: impl Fn() -> A + Sync, second: impl FnOnce() -> B) -> (A, B) {
    thread::scope(|scope| {
        let beside = thread::Builder::new().spawn_scoped(scope, &first);
        let second = second();
        let first = match beside {
            Ok(beside) => beside.join().unwrap_or_else(|panic| resume_unwind(panic)),
            Err(_) => first(),
        };
        (first, second)
    })
}
