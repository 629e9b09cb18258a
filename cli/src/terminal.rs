//! The front of the steps on a terminal: messages on standard error, and for long work a bar with the remaining time, which is not written
//! to a pipe.

use crate::output;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use posicast_flow::{Observer, WorkProgress};
use std::fmt::Write;
use std::io::IsTerminal;
use std::time::Duration;

/// The front on a terminal.
pub(crate) struct Terminal;

impl Observer for Terminal {
    fn say(&self, message: &str) {
        output::say(message);
    }

    fn begin(&self, what: &str, steps: Option<u64>) -> Box<dyn WorkProgress> {
        Box::new(Shown(match steps {
            Some(steps) => bar(what, steps),
            None => spinner(what),
        }))
    }
}

/// A bar or spinner that is removed at the end.
struct Shown(ProgressBar);

impl WorkProgress for Shown {
    fn advance(&self, steps: u64) {
        self.0.inc(steps);
    }

    fn reach(&self, done: u64) {
        self.0.set_position(done);
    }

    fn rename(&self, what: &str) {
        self.0.set_message(what.to_owned());
    }
}

impl Drop for Shown {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// Interval at which the times are redrawn.
const TICK: Duration = Duration::from_millis(200);

/// A bar over `length` steps, labelled `what`; it appears on standard error only if that is a terminal.
pub(crate) fn bar(what: &str, length: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} {wide_bar} {human_pos}/{human_len} {elapsed}, {left}");
    let style = style.map(|style| style.with_key("left", left));
    let bar = decorated(ProgressBar::with_draw_target(Some(length), target()), what, style);
    // The elapsed time is redrawn also while a step takes long.
    bar.enable_steady_tick(TICK);
    bar
}

/// A spinner for work whose length is not known.
fn spinner(what: &str) -> ProgressBar {
    let style = ProgressStyle::with_template("{spinner} {msg} {elapsed}");
    let spinner = decorated(ProgressBar::with_draw_target(None, target()), what, style);
    spinner.enable_steady_tick(TICK);
    spinner
}

/// Writes the remaining time, estimated from the pace so far; unknown before the first step.
fn left(state: &ProgressState, text: &mut dyn Write) {
    // A write error only leaves the time out.
    let _ = match state.pos() {
        0 => text.write_str("time left unknown yet"),
        _ => write!(text, "about {:#} left", HumanDuration(state.eta())),
    };
}

fn target() -> ProgressDrawTarget {
    if std::io::stderr().is_terminal() {
        ProgressDrawTarget::stderr_with_hz(5)
    } else {
        ProgressDrawTarget::hidden()
    }
}

fn decorated(
    bar: ProgressBar,
    what: &str,
    style: Result<ProgressStyle, indicatif::style::TemplateError>,
) -> ProgressBar {
    let bar = bar.with_message(what.to_owned());
    match style {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
