//! Something with registers at a pseudo-terminal, for `posicast host`.

use super::support::posicast;
use serialport::{SerialPort, TTYPort};
use std::path::Path;
use std::process::Output;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// A port with a thread that answers, until it is dropped.
pub(super) struct Served<T> {
    pub(super) port: String,
    ends: Arc<AtomicBool>,
    thread: Option<JoinHandle<T>>,
}

impl<T: Send + 'static> Served<T> {
    /// Opens a port. `serve` runs in a thread of its own, which makes models and plants, until the flag is set.
    pub(super) fn new(serve: impl FnOnce(TTYPort, &AtomicBool) -> T + Send + 'static) -> Self {
        let (mut far, near) = TTYPort::pair().unwrap();
        let port = near.name().unwrap();
        // One program holds a port: the command opens it again.
        drop(near);
        far.set_timeout(Duration::from_millis(2)).unwrap();
        let ends = Arc::new(AtomicBool::new(false));
        let until = Arc::clone(&ends);
        Self {
            port,
            ends,
            thread: Some(std::thread::spawn(move || serve(far, &until))),
        }
    }

    /// Ends it, and returns what its thread does.
    pub(super) fn end(mut self) -> T {
        self.ends.store(true, Ordering::Relaxed);
        self.thread.take().unwrap().join().unwrap()
    }
}

impl<T> Drop for Served<T> {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
        let ended = self.thread.take().map(JoinHandle::join);
        assert!(ended.is_none_or(|ended| ended.is_ok()) || std::thread::panicking());
    }
}

/// Runs `posicast host` at a port: exit status, standard output, standard error.
pub(super) fn host(port: &str, machine: &Path, words: &[&str]) -> (Option<i32>, String, String) {
    let mut command = posicast();
    command.args(["host", port]).args(words);
    // The simulation is slower than the hardware.
    command.arg("--machine").arg(machine).args(["--timeout", "4000"]);
    let Output { status, stdout, stderr } = command.output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (status.code(), text(stdout), text(stderr))
}
