//! Long work in a thread of its own, which Ctrl-C does not have to wait for.

use std::sync::Mutex;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// Time between two looks for signals.
const TICK: Duration = Duration::from_millis(50);

/// Runs `work` without Python's lock, and returns its result.
///
/// # Errors
/// What a signal handler of Python raises, such as `KeyboardInterrupt`: nobody gets the result then, though the thread ends only with its
/// work. `RuntimeError` if the work panicked, which is a bug.
pub(crate) fn waited<T: Send + 'static>(py: Python<'_>, work: impl FnOnce() -> T + Send + 'static) -> PyResult<T> {
    let (sender, receiver) = mpsc::channel();
    // If nobody waits any more, the result is dropped.
    let thread = thread::Builder::new().spawn(move || drop(sender.send(work())));
    thread.map_err(|error| PyRuntimeError::new_err(format!("the system refuses a thread: {error}")))?;
    let receiver = Mutex::new(receiver);
    loop {
        let received = py.detach(|| match receiver.lock() {
            Ok(receiver) => receiver.recv_timeout(TICK),
            Err(_) => Err(RecvTimeoutError::Disconnected),
        });
        match received {
            Ok(result) => return Ok(result),
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err(
                    "a bug ended the work: please report it with the message above",
                ));
            }
        }
    }
}
