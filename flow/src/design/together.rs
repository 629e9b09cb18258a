//! The joint design of a stage's axes.

use posicast_machine::plan::MachineDesign;
use posicast_shaper::certify::{CheckedShorter, CheckedTogether, check_together};
use posicast_shaper::design::optimal::TogetherDesign;
use schemars::JsonSchema;
use serde::Serialize;

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
            sample_hz: self.design.sample_hz,
            delay_samples: found.delay_samples,
            checked: self.checked.clone(),
        }
    }
}

/// `together` in `stage` of `design --json`.
#[derive(Serialize, JsonSchema)]
pub struct Together {
    /// Least common duration.
    pub samples: u32,
    /// The same in seconds.
    pub duration_s: f64,
    /// Delay of every axis before its coefficients are rounded.
    pub delay_s: f64,
    /// Whether no lesser common duration is possible.
    pub proven: bool,
    /// Duration up to which none is.
    pub excluded_samples: Option<u32>,
    /// The axis that decides the delay.
    pub decisive_axis: String,
    /// Proven lower bound of the delay at this duration.
    pub least_delay_s: Option<f64>,
    /// Rate of the samples.
    #[serde(skip)]
    pub sample_hz: f64,
    /// The delay in samples.
    #[serde(skip)]
    pub delay_samples: f64,
    /// The proofs, checked.
    #[serde(skip)]
    pub checked: CheckedTogether,
}
