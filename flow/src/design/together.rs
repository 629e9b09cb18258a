//! The joint design of a stage's axes, for people and for programs.

use posicast_machine::plan::MachineDesign;
use posicast_shaper::certify::{CheckedShorter, CheckedTogether, check_together};
use posicast_shaper::design::optimal::TogetherDesign;
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt::Write;

/// A joint design with its proofs, which are checked here.
pub(super) struct TogetherReport<'a> {
    design: &'a MachineDesign,
    together: &'a TogetherDesign,
    checked: CheckedTogether,
}

impl<'a> TogetherReport<'a> {
    /// Returns `None` if the axes are not designed together.
    pub(super) fn new(design: &'a MachineDesign) -> Option<Self> {
        let together = design.together.as_ref()?;
        Some(Self {
            design,
            together,
            checked: check_together(&together.partners, &together.found),
        })
    }

    fn axis(&self, index: usize) -> &str {
        self.design.axes.get(index).map_or("", |axis| &axis.design.name)
    }

    fn milliseconds(&self, samples: f64) -> f64 {
        1e3 * samples / self.design.sample_hz
    }

    pub(super) fn text(&self) -> String {
        let found = &self.together.found;
        let mut text = format!(
            "\ndesigned together: least common duration {} samples, {:.4} ms; delay of every axis {:.6} ms\n",
            found.samples,
            self.milliseconds(f64::from(found.samples)),
            self.milliseconds(found.delay_samples),
        );
        let _ = match &self.checked.shorter {
            Some(Ok(CheckedShorter::Alone { axis, bound })) => writeln!(
                text,
                "  proof, checked: axis {} has no shaper of at most {} samples, whatever its delay",
                self.axis(*axis),
                bound.samples
            ),
            Some(Ok(CheckedShorter::Apart {
                samples,
                late_axis,
                early_axis,
                gap_samples,
            })) => writeln!(
                text,
                "  proof, checked: with at most {samples} samples, the earliest that axis {} can be is {gap_samples:.4} samples later than \
                 the latest that axis {} can be",
                self.axis(*late_axis),
                self.axis(*early_axis)
            ),
            Some(Err(error)) => writeln!(text, "  not proven to be the least duration: {error}"),
            None => writeln!(text, "  not proven to be the least duration"),
        };
        let decisive = self.axis(found.latest_axis);
        let _ = match &self.checked.least_delay_samples {
            Some(Ok(least)) => writeln!(
                text,
                "  proof, checked: every shaper of axis {decisive} of this duration is at least {:.6} ms late; the design keeps a part of the \
                 tolerance for rounding",
                self.milliseconds(*least)
            ),
            Some(Err(error)) => writeln!(
                text,
                "  axis {decisive} decides the delay; not proven to be the least: {error}"
            ),
            None => writeln!(text, "  axis {decisive} decides the delay; not proven to be the least"),
        };
        text
    }

    pub(super) fn json(&self) -> Together {
        let found = &self.together.found;
        let shorter = self.checked.shorter.as_ref().and_then(|checked| checked.as_ref().ok());
        let least = self.checked.least_delay_samples.as_ref();
        let least = least.and_then(|checked| checked.as_ref().ok());
        Together {
            samples: found.samples,
            duration_s: f64::from(found.samples) / self.design.sample_hz,
            delay_s: found.delay_samples / self.design.sample_hz,
            proven: shorter.is_some(),
            excluded_samples: shorter.map(|checked| match checked {
                CheckedShorter::Alone { bound, .. } => bound.samples,
                CheckedShorter::Apart { samples, .. } => *samples,
            }),
            decisive_axis: self.axis(found.latest_axis).to_owned(),
            least_delay_s: least.map(|samples| samples / self.design.sample_hz),
        }
    }
}

/// `together` in `stage` of `design --json`.
#[derive(Serialize, JsonSchema)]
pub(super) struct Together {
    /// Least common duration.
    samples: u32,
    duration_s: f64,
    /// Delay of every axis before its coefficients are rounded.
    delay_s: f64,
    /// Whether no lesser common duration is possible.
    proven: bool,
    excluded_samples: Option<u32>,
    /// The axis that decides the delay.
    decisive_axis: String,
    /// Proven lower bound of the delay at this duration.
    least_delay_s: Option<f64>,
}
