//! Progress of long work: a bar with the remaining time on a terminal, nothing in a pipe.

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use std::fmt::Write;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

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

/// Time after which work counts as long.
const LONG: Duration = Duration::from_secs(2);

/// A bar that appears only if the work takes long.
pub(crate) struct Late {
    what: &'static str,
    length: u64,
    begun: Instant,
    bar: Option<ProgressBar>,
}

impl Late {
    /// A bar over `length` steps, labelled `what`.
    pub(crate) fn new(what: &'static str, length: u64) -> Self {
        Self {
            what,
            length,
            begun: Instant::now(),
            bar: None,
        }
    }

    /// Shows that this many steps are done.
    pub(crate) fn reach(&mut self, done: u64) {
        match &self.bar {
            Some(bar) if bar.position() == done => (),
            Some(bar) => bar.set_position(done.min(self.length)),
            None if self.begun.elapsed() < LONG => (),
            None => {
                let shown = bar(self.what, self.length);
                shown.set_position(done.min(self.length));
                self.bar = Some(shown);
            }
        }
    }

    /// Removes the bar.
    pub(crate) fn finish(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}

/// A spinner for work whose length is not known.
pub(crate) fn spinner(what: &str) -> ProgressBar {
    let style = ProgressStyle::with_template("{spinner} {msg} {elapsed}");
    let spinner = decorated(ProgressBar::with_draw_target(None, target()), what, style);
    spinner.enable_steady_tick(TICK);
    spinner
}

/// The remaining time, estimated from the pace so far; unknown before the first step.
fn left(state: &ProgressState, text: &mut dyn Write) {
    // An error of writing only leaves the time out.
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
