//! Other programs. Each leads a process group of its own, so that it ends together with all that it started: at its
//! time limit, when its value is dropped, and when a signal ends the process.

use crate::interrupt;
use std::io;
use std::process::{Child, Command, ExitStatus, Output};
use std::time::Duration;
use wait_timeout::ChildExt;

/// A running program.
#[derive(Debug)]
pub struct Running {
    /// The process; `None` after waiting for its end.
    child: Option<Child>,
    group: i32,
}

/// Starts a program.
///
/// # Errors
/// Those of [`Command::spawn`].
pub fn start(command: &mut Command) -> io::Result<Running> {
    #[cfg(unix)]
    {
        use std::os::unix::process::CommandExt;
        command.process_group(0);
    }
    let (child, group) = interrupt::started(|| {
        let child = command.spawn()?;
        let group = i32::try_from(child.id()).map_err(io::Error::other)?;
        Ok((child, group))
    })?;
    Ok(Running {
        child: Some(child),
        group,
    })
}

impl Running {
    /// The process, for its pipes; `None` after waiting for its end.
    pub fn child(&mut self) -> Option<&mut Child> {
        self.child.as_mut()
    }

    /// An action that ends the program together with all that it started, for another thread. It must not be called after this
    /// value is gone.
    pub fn killer(&self) -> impl FnOnce() + Send + 'static {
        let group = self.group;
        move || interrupt::kill_group(group)
    }

    /// Reads the program's output from its pipes, waits for its end, and returns both.
    ///
    /// # Errors
    /// Those of [`Child::wait_with_output`].
    pub fn output(mut self) -> io::Result<Output> {
        let child = self.child.take().ok_or_else(no_more)?;
        let output = child.wait_with_output();
        interrupt::ended(self.group);
        output
    }

    /// Waits for its end.
    ///
    /// # Errors
    /// Those of [`Child::wait`].
    pub fn wait(&mut self) -> io::Result<ExitStatus> {
        let mut child = self.child.take().ok_or_else(no_more)?;
        let status = child.wait();
        interrupt::ended(self.group);
        status
    }

    /// Waits for its end for at most `limit`. After that the program is ended together with all that it started, and
    /// `None` is returned.
    ///
    /// # Errors
    /// The errors of waiting.
    pub fn wait_within(mut self, limit: Duration) -> io::Result<Option<ExitStatus>> {
        let child = self.child.as_mut().ok_or_else(no_more)?;
        let status = child.wait_timeout(limit)?;
        if status.is_some() {
            self.child = None;
            interrupt::ended(self.group);
        }
        // Without a status it is ended when it is dropped.
        Ok(status)
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        if let Some(mut child) = self.child.take() {
            interrupt::kill_group(self.group);
            // The program may have ended in the meantime; both calls then do nothing.
            let _ = child.kill();
            let _ = child.wait();
            interrupt::ended(self.group);
        }
    }
}

fn no_more() -> io::Error {
    io::Error::other("the end of this program was waited for already")
}

#[cfg(unix)]
#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{BufRead, BufReader};
    use std::process::Stdio;

    /// A shell that starts another program, and the number of that program.
    fn two_programs() -> (Running, i32) {
        let mut command = Command::new("sh");
        command.args(["-c", "sleep 600 & echo $!; wait"]).stdout(Stdio::piped());
        let mut running = start(&mut command).unwrap();
        let mut line = String::new();
        let said = running.child().unwrap().stdout.take().unwrap();
        BufReader::new(said).read_line(&mut line).unwrap();
        (running, line.trim().parse().unwrap())
    }

    fn ends(process: i32) -> bool {
        let alive = || {
            let status = std::fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
            status
                .rsplit(") ")
                .next()
                .is_some_and(|rest| !rest.is_empty() && !rest.starts_with('Z'))
        };
        (0..500).any(|_| {
            std::thread::sleep(Duration::from_millis(10));
            !alive()
        })
    }

    #[test]
    fn a_program_ends_with_all_that_it_started() {
        let (running, inner) = two_programs();
        drop(running);
        assert!(ends(inner), "dropped");
        let (running, inner) = two_programs();
        assert_eq!(running.wait_within(Duration::from_millis(20)).unwrap(), None);
        assert!(ends(inner), "at its time limit");
    }

    #[test]
    fn a_program_that_ends_by_itself_says_how() {
        let mut command = Command::new("sh");
        command.args(["-c", "echo said; exit 3"]).stdout(Stdio::piped());
        let output = start(&mut command).unwrap().output().unwrap();
        assert_eq!(
            (output.status.code(), output.stdout.as_slice()),
            (Some(3), b"said\n".as_slice())
        );
        let status = start(&mut command).unwrap().wait_within(Duration::from_secs(60));
        assert_eq!(status.unwrap().and_then(|status| status.code()), Some(3));
    }
}
