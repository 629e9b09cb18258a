//! Notices a simulation that no longer answers.
//!
//! A simulation of Verilog with an endless loop never returns from a clock. Reading the time in every clock would slow a fast
//! simulation down, so the simulation only increments a counter, which is odd during a call and even between two calls. A
//! thread looks at the counter now and then.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::{self, Thread};
use std::time::{Duration, Instant};

/// Fewest and most time between two looks.
const LOOK: [Duration; 2] = [Duration::from_millis(5), Duration::from_secs(1)];

#[derive(Debug, Default)]
struct Shared {
    /// Number of beginnings and ends of calls.
    calls: AtomicU64,
    gone: AtomicBool,
    expired: AtomicBool,
}

/// Watches the calls of one simulation. Dropping it ends the watch.
#[derive(Debug)]
pub(crate) struct Patience {
    shared: Arc<Shared>,
    /// The thread that looks; `None` where the system has no thread left, and then nobody looks.
    looker: Option<Thread>,
}

impl Patience {
    /// Runs `at_limit` in another thread if a call takes longer than `limit`.
    pub(crate) fn new(limit: Duration, at_limit: impl FnOnce() + Send + 'static) -> Self {
        let shared = Arc::new(Shared::default());
        let looked = Arc::clone(&shared);
        let look = move || {
            let pause = (limit / 20).clamp(LOOK[0], LOOK[1]);
            let (mut calls, mut since) = (0, Instant::now());
            loop {
                thread::park_timeout(pause);
                if looked.gone.load(Ordering::Acquire) {
                    return;
                }
                let now = looked.calls.load(Ordering::Relaxed);
                if now != calls || now.is_multiple_of(2) {
                    (calls, since) = (now, Instant::now());
                } else if since.elapsed() >= limit {
                    looked.expired.store(true, Ordering::Release);
                    at_limit();
                    return;
                }
            }
        };
        let thread = thread::Builder::new().name("patience".to_owned()).spawn(look);
        Self {
            shared,
            looker: thread.ok().map(|handle| handle.thread().clone()),
        }
    }

    /// Does a call of the simulation.
    pub(crate) fn during<T>(&self, call: impl FnOnce() -> T) -> T {
        // Nobody else writes the number, so that it need not be added atomically.
        let calls = self.shared.calls.load(Ordering::Relaxed);
        self.shared.calls.store(calls.wrapping_add(1), Ordering::Relaxed);
        let result = call();
        self.shared.calls.store(calls.wrapping_add(2), Ordering::Relaxed);
        result
    }

    /// Whether a call took longer than the limit.
    pub(crate) fn expired(&self) -> bool {
        self.shared.expired.load(Ordering::Acquire)
    }
}

impl Drop for Patience {
    fn drop(&mut self) {
        self.shared.gone.store(true, Ordering::Release);
        if let Some(looker) = &self.looker {
            looker.unpark();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc;

    #[test]
    fn only_a_call_that_takes_too_long_expires() {
        let (said, heard) = mpsc::channel();
        let limit = Duration::from_millis(60);
        let patience = Patience::new(limit, move || said.send(()).unwrap());
        // Many short calls together, and a long pause between two calls, are no long call.
        for _ in 0..20 {
            patience.during(|| thread::sleep(Duration::from_millis(5)));
        }
        thread::sleep(3 * limit);
        assert!(!patience.expired() && heard.try_recv().is_err());
        patience.during(|| heard.recv_timeout(Duration::from_secs(60)).unwrap());
        assert!(patience.expired());
    }
}
