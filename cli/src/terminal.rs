//! The front of the steps on a terminal: messages on standard error, and for long work a bar with the remaining time, which is not written
//! to a pipe.

use crate::output;
use indicatif::{HumanDuration, MultiProgress, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use posicast_flow::{ExpectedTime, Observer, WorkProgress};
use std::fmt::Write;
use std::io::IsTerminal;
use std::sync::LazyLock;
use std::time::Duration;

/// All bars, for two can be there at once.
static BARS: LazyLock<MultiProgress> = LazyLock::new(|| MultiProgress::with_draw_target(target()));

/// The front on a terminal.
pub(crate) struct Terminal;

impl Observer for Terminal {
    fn say(&self, message: &str) {
        BARS.suspend(|| output::say(message));
    }

    fn begin(&self, what: &str, steps: Option<u64>) -> Box<dyn WorkProgress> {
        Box::new(Shown(match steps {
            Some(steps) => bar(what, steps),
            None => spinner(what, None),
        }))
    }

    fn begin_timed(&self, what: &str, expected: Option<ExpectedTime>) -> Box<dyn WorkProgress> {
        Box::new(Shown(spinner(what, expected)))
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
        BARS.remove(&self.0);
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

/// A spinner for work whose steps are not counted, with the time left if an earlier run tells it.
fn spinner(what: &str, expected: Option<ExpectedTime>) -> ProgressBar {
    let style = ProgressStyle::with_template("{spinner} {msg} {elapsed}{left}");
    let left = move |state: &ProgressState, text: &mut dyn Write| {
        // A write error only leaves the time out.
        let _ = expected.map(|expected| write!(text, ", {}", left_in_all(expected, state.elapsed())));
    };
    let style = style.map(|style| style.with_key("left", left));
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

/// The time to the end of all work, after an earlier run.
fn left_in_all(expected: ExpectedTime, elapsed: Duration) -> String {
    match expected.left(elapsed) {
        Some(left) => format!(
            "about {:#} left in all, as in the last run of this kind",
            HumanDuration(left)
        ),
        None => format!(
            "longer than in the last run of this kind; then {:#}",
            HumanDuration(expected.after)
        ),
    }
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
    let bar = BARS.add(bar).with_message(what.to_owned());
    match style {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_is_said_until_it_is_not_known() {
        let expected = ExpectedTime {
            part: Duration::from_secs(120),
            after: Duration::from_secs(240),
        };
        let of = |seconds| left_in_all(expected, Duration::from_secs(seconds));
        assert_eq!(of(60), "about 5m left in all, as in the last run of this kind");
        assert_eq!(of(121), "longer than in the last run of this kind; then 4m");
    }
}
