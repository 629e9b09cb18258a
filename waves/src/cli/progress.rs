//! A bar over the bytes of both files that shows itself when the work takes long.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::diff::Progress;

const LATE: Duration = Duration::from_secs(2);

pub(super) struct LateBar {
    start: Instant,
    bar: Option<ProgressBar>,
}

impl LateBar {
    pub(super) fn new() -> Self {
        Self {
            start: Instant::now(),
            bar: None,
        }
    }

    pub(super) fn show(&mut self, progress: Progress) {
        if self.bar.is_none() && self.start.elapsed() >= LATE && std::io::stderr().is_terminal() {
            let bar = ProgressBar::with_draw_target(progress.total_bytes, ProgressDrawTarget::stderr_with_hz(5));
            let template = match progress.total_bytes {
                Some(_) => "comparing {wide_bar} {bytes}/{total_bytes} {elapsed}, {eta} left",
                None => "comparing {spinner} {bytes} {elapsed}",
            };
            // With an invalid template, the default bar stays.
            self.bar = Some(match ProgressStyle::with_template(template) {
                Ok(style) => bar.with_style(style),
                Err(_) => bar,
            });
        }
        if let Some(bar) = &self.bar {
            bar.set_position(progress.bytes);
        }
    }

    pub(super) fn clear(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
