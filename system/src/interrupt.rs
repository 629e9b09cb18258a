//! Resources that must not outlive the process, and the handling of signals.
//!
//! ```text
//!  signal ─► lock the list for good ─► kill every process group ─► remove files and folders, the youngest first ─► exit
//! ```
//!
//! - [`listen`] catches SIGINT (exit status 130), SIGTERM (143) and SIGHUP (129; not where it is ignored, as under
//!   `nohup`). A second signal ends the process at once.
//! - Everything that is made outside the process, a folder or a program, is made and put on the list under one lock.
//!   A signal takes that lock and never releases it: nothing new can be made after that, and a thread that would
//!   report an error about its vanished files waits instead.
//! - Actions that must be done completely or not at all run in [`uninterrupted`].
//! - SIGKILL cannot be caught. What it leaves is found by the next run where it would be in its way (the staging
//!   folder of an output folder, a build in the cache of simulations), and is ignored elsewhere.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

/// Number of attempts to remove a folder, and their interval: a program that was just killed may still add a file.
const REMOVAL_TRIES: u32 = 100;
const REMOVAL_PAUSE: Duration = Duration::from_millis(10);

/// A resource that a signal removes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Leftover {
    /// A file.
    File(PathBuf),
    /// A folder with its contents.
    Tree(PathBuf),
    /// A folder, if it is empty.
    EmptyFolder(PathBuf),
}

impl Leftover {
    fn remove(&self) {
        match self {
            // An error is ignored, because nobody is left to report it to.
            Self::File(path) => drop(fs::remove_file(path)),
            Self::EmptyFolder(path) => drop(fs::remove_dir(path)),
            Self::Tree(path) => remove_tree(path),
        }
    }
}

fn remove_tree(path: &Path) {
    for _ in 0..REMOVAL_TRIES {
        let _ = fs::remove_dir_all(path);
        if path.symlink_metadata().is_err() {
            return;
        }
        thread::sleep(REMOVAL_PAUSE);
    }
}

/// The list of resources.
#[derive(Debug)]
struct List {
    next: u64,
    leftovers: BTreeMap<u64, Leftover>,
    groups: BTreeSet<i32>,
}

static LIST: Mutex<List> = Mutex::new(List {
    next: 0,
    leftovers: BTreeMap::new(),
    groups: BTreeSet::new(),
});

/// Locks the list; after a signal this never returns.
fn list() -> MutexGuard<'static, List> {
    LIST.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Entries of the list. When dropped they are removed from it, because the resources are gone or shall stay.
#[derive(Debug)]
pub struct Listed(Vec<u64>);

impl Drop for Listed {
    fn drop(&mut self) {
        let mut list = list();
        for id in &self.0 {
            list.leftovers.remove(id);
        }
    }
}

/// Makes something, and lists the resources of it that a signal must remove, the outermost folder first; no signal
/// comes between the two.
///
/// # Errors
/// Those of `make`; nothing is listed then.
pub fn listed<T, E>(make: impl FnOnce() -> Result<(T, Vec<Leftover>), E>) -> Result<(T, Listed), E> {
    let mut list = list();
    let (made, leftovers) = make()?;
    let ids = leftovers.into_iter().map(|leftover| {
        let id = list.next;
        list.next += 1;
        list.leftovers.insert(id, leftover);
        id
    });
    let ids = ids.collect();
    drop(list);
    Ok((made, Listed(ids)))
}

/// Runs an action that a signal must not interrupt. `action` must not use this module, nor
/// [`scratch`](crate::scratch) or [`process`](crate::process), which use it.
pub fn uninterrupted<T>(action: impl FnOnce() -> T) -> T {
    let _list = list();
    action()
}

/// Removes entries from the list together with running an `action`; no signal comes between the two.
pub(crate) fn settled<T>(listed: &mut Listed, action: impl FnOnce() -> T) -> T {
    let mut list = list();
    let result = action();
    for id in listed.0.drain(..) {
        list.leftovers.remove(&id);
    }
    result
}

/// Declares that the work is done and only its result remains to be printed: a signal changes nothing from now on. If
/// one came before, this never returns, since the process is about to end.
pub fn done() {
    std::mem::forget(list());
}

/// Starts a program as leader of a process group, which a signal kills.
pub(crate) fn started<T>(start: impl FnOnce() -> io::Result<(T, i32)>) -> io::Result<(T, i32)> {
    let mut list = list();
    let (program, group) = start()?;
    list.groups.insert(group);
    Ok((program, group))
}

/// Removes a group that has ended from the list.
pub(crate) fn ended(group: i32) {
    list().groups.remove(&group);
}

#[cfg(unix)]
pub use unix::listen;

#[cfg(unix)]
pub use unix::give_up;
#[cfg(unix)]
pub(crate) use unix::kill_group;

#[cfg(unix)]
mod unix {
    use super::list;
    use rustix::process::{Pid, Signal, kill_process_group};
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::flag::{register, register_conditional_shutdown};
    use signal_hook::iterator::Signals;
    use std::io::{self, IsTerminal, Write};
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;
    use std::thread;

    /// Offset that a shell adds to the number of a signal for the exit status.
    const EXIT_STATUS_BASE: i32 = 128;

    /// Installs handlers for SIGINT, SIGTERM and SIGHUP, which clean up before they end the process.
    ///
    /// # Errors
    /// An error if the system refuses a handler or a thread.
    pub fn listen() -> io::Result<()> {
        let mut caught = vec![SIGINT, SIGTERM];
        if !ignored(SIGHUP) {
            caught.push(SIGHUP);
        }
        let arrived = Arc::new(AtomicBool::new(false));
        for signal in &caught {
            // The order matters: the first signal finds the flag low and raises it, the second finds it high.
            register_conditional_shutdown(*signal, EXIT_STATUS_BASE + signal, Arc::clone(&arrived))?;
            register(*signal, Arc::clone(&arrived))?;
        }
        let mut signals = Signals::new(&caught)?;
        let wait = move || {
            if let Some(signal) = signals.forever().next() {
                end(signal);
            }
        };
        thread::Builder::new().name("signals".to_owned()).spawn(wait).map(drop)
    }

    /// Ends the process with this message and exit status, where a call into foreign code never returns: the programs are
    /// ended, and files and folders removed, as after a signal.
    pub fn give_up(message: &str, status: i32) -> ! {
        let _list = remove_all();
        let _ = writeln!(io::stderr(), "{message}");
        // The exit functions of C and C++ are bypassed, because the foreign code still runs in another thread.
        signal_hook::low_level::exit(status)
    }

    /// Ends every program and removes every leftover. The list stays locked as long as the result lives.
    fn remove_all() -> std::sync::MutexGuard<'static, super::List> {
        let list = list();
        for group in &list.groups {
            kill_group(*group);
        }
        for leftover in list.leftovers.values().rev() {
            leftover.remove();
        }
        list
    }

    fn end(signal: i32) {
        let _list = remove_all();
        let name = signal_hook::low_level::signal_name(signal).unwrap_or("a signal");
        // On a terminal a progress bar may occupy the line.
        let before = if io::stderr().is_terminal() { "\n" } else { "" };
        let _ = writeln!(io::stderr(), "{before}posicast: ended by {name}");
        // The exit functions of C and C++ are bypassed, because a simulation may be running in another thread.
        signal_hook::low_level::exit(EXIT_STATUS_BASE + signal);
    }

    /// Kills every process of a group. It is not an error if the group has ended.
    pub(crate) fn kill_group(group: i32) {
        if let Some(group) = Pid::from_raw(group) {
            let _ = kill_process_group(group, Signal::KILL);
        }
    }

    /// Whether the parent process wants the signal ignored, as `nohup` does; false if that is unknown.
    fn ignored(signal: i32) -> bool {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        let mask = mask.and_then(|digits| u64::from_str_radix(digits.trim(), 16).ok());
        mask.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
    }
}

/// Does nothing: signals are those of Unix, and elsewhere the system's own rules apply.
///
/// # Errors
/// This never returns an error.
#[cfg(not(unix))]
pub fn listen() -> io::Result<()> {
    Ok(())
}

/// Ends the process with this message and exit status.
#[cfg(not(unix))]
#[allow(clippy::exit)] // a call into foreign code never returns
pub fn give_up(message: &str, status: i32) -> ! {
    let _ = io::Write::write_fmt(&mut io::stderr(), format_args!("{message}\n"));
    std::process::exit(status)
}

/// Does nothing: process groups are those of Unix.
#[cfg(not(unix))]
pub(crate) fn kill_group(_group: i32) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_struck_off_is_not_listed_any_more() {
        let paths = || list().leftovers.values().cloned().collect::<Vec<_>>();
        let leftover = Leftover::Tree(PathBuf::from("/nowhere/a folder of this test"));
        let make = || Ok::<_, io::Error>(((), vec![leftover.clone()]));
        let ((), entry) = listed(make).unwrap();
        assert!(paths().contains(&leftover));
        drop(entry);
        assert!(!paths().contains(&leftover));
        let ((), mut entry) = listed(make).unwrap();
        settled(&mut entry, || ());
        assert!(!paths().contains(&leftover));
    }

    #[test]
    fn a_leftover_is_removed_as_its_kind_says() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::create_dir_all(path("tree/inner")).unwrap();
        fs::write(path("tree/inner/file"), "").unwrap();
        fs::create_dir(path("full")).unwrap();
        fs::write(path("full/file"), "").unwrap();
        fs::create_dir(path("empty")).unwrap();
        fs::write(path("file"), "").unwrap();
        for leftover in [
            Leftover::Tree(path("tree")),
            Leftover::EmptyFolder(path("full")),
            Leftover::EmptyFolder(path("empty")),
            Leftover::File(path("file")),
            Leftover::File(path("never there")),
        ] {
            leftover.remove();
        }
        let left: Vec<_> = fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name())
            .collect();
        assert_eq!(left, ["full"]);
    }
}
