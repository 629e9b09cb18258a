//! The papers' examples, and what is shorter: the paper's shaper, the shortest closed form, and the shortest there is.
//!
//! A closed form counts where it does what is asked for: its residual, by the integer-free impulses, is within the tolerance over the band, and
//! its command within the bounds. Of several modes each gets the kind, and the axis their convolution, or the kind serves all of them.

use super::designs::axis;
use posicast_machine::machine_file::AxisSection;
use posicast_optimal::Command;
use posicast_shaper::analysis::worst_residual;
use posicast_shaper::axis::ShaperChoice;
use posicast_shaper::certify::check_shorter;
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::design::{DesignError, Findings, design_axis};
use posicast_shaper::impulse::ImpulseSequence;
use posicast_shaper::mode::Mode;
use std::f64::consts::TAU;

/// Slack of a tolerance and of a command's bounds.
const SLACK: f64 = 1e-6;

/// One example.
#[derive(Debug, Clone, PartialEq)]
pub struct BeyondRow {
    /// The modes, their uncertainty, the tolerance, the command.
    pub item: String,
    /// Duration of the paper's shaper in seconds, where there is one, and what it is.
    pub paper: Option<(f64, String)>,
    /// Duration of the shortest closed form that does it, in seconds, and its kind.
    pub closed_form: Option<(f64, String)>,
    /// Duration of the shortest on the grid in seconds.
    pub optimal_s: f64,
    /// Its taps.
    pub taps: usize,
    /// Step of the grid in seconds.
    pub sample_s: f64,
    /// Whether the proof that nothing is shorter was checked.
    pub proven: bool,
}

struct Example {
    modes: Vec<Mode>,
    tolerance: f64,
    width: f64,
    command: Command,
    sample_hz: f64,
    paper: Option<(f64, &'static str)>,
    item: String,
}

/// All examples: one mode by its insensitivity, four modes, the robot's two.
///
/// # Errors
/// [`DesignError`] if one of them cannot be designed: a fault of posicast.
pub fn beyond() -> Result<Vec<BeyondRow>, DesignError> {
    examples().iter().map(Example::row).collect()
}

fn examples() -> Vec<Example> {
    let signed = Command::PartialSums { low: -1.0, high: 1.0 };
    let mode = |frequency_hz, damping| Mode { frequency_hz, damping };
    let mut examples = Vec::new();
    for (insensitivity, paper) in [(0.2, None), (0.4, None), (0.73, None), (0.964, Some((2.0, "multi-EI")))] {
        examples.push(Example {
            modes: vec![mode(1.0, 0.0)],
            tolerance: 0.05,
            width: insensitivity / 2.0,
            command: Command::Positive,
            sample_hz: 200.0,
            paper,
            item: format!("1 Hz, insensitivity {insensitivity}, 5 %"),
        });
    }
    for (width, paper) in [
        (0.0, None),
        (0.05, None),
        (0.1, None),
        (0.2, Some((0.931, "one multi-EI for all"))),
    ] {
        examples.push(Example {
            modes: [10.0, 35.0, 68.0, 124.0].map(|omega| mode(omega / TAU, 0.0)).to_vec(),
            tolerance: 0.05,
            width,
            command: Command::Positive,
            sample_hz: 400.0,
            paper,
            item: format!("10, 35, 68, 124 rad/s, ±{} %, 5 %", 100.0 * width),
        });
    }
    for (command, tolerance, paper, bounds) in [
        (Command::Positive, 0.001, None, "positive"),
        (signed, 0.001, Some((6.81e-3, "NZV-NZVD, −3 … 5")), "−1 … 1"),
        (signed, 0.05, Some((6.81e-3, "NZV-NZVD, −3 … 5")), "−1 … 1"),
    ] {
        examples.push(Example {
            modes: vec![mode(76.6, 0.057), mode(231.2, 0.017)],
            tolerance,
            width: 0.0,
            command,
            sample_hz: 20_000.0,
            paper,
            item: format!("76.6, 231.2 Hz, {} %, {bounds}", 100.0 * tolerance),
        });
    }
    examples
}

impl Example {
    fn axis(&self, kind: ShaperKind) -> AxisSection {
        let choice = ShaperChoice {
            tolerance: Some(self.tolerance),
            command: (kind == ShaperKind::Optimal).then_some(self.command),
            ..ShaperChoice::of_kind(kind)
        };
        let mut axis = axis(choice, &self.modes);
        axis.modes
            .iter_mut()
            .for_each(|mode| mode.frequency_band = Some(self.width));
        axis
    }

    fn row(&self) -> Result<BeyondRow, DesignError> {
        let design = design_axis(self.axis(ShaperKind::Optimal).shaped(), self.sample_hz)?;
        let proven = match &design.findings {
            Findings::Optimal(found) => {
                let proof = found.shorter.as_ref();
                proof.is_some_and(|proof| check_shorter(&found.request, proof).is_ok())
            }
            _ => false,
        };
        Ok(BeyondRow {
            item: self.item.clone(),
            paper: self.paper.map(|(duration_s, name)| (duration_s, name.to_owned())),
            closed_form: self.closed_form(),
            optimal_s: design.impulses.duration_s(),
            taps: design.impulses.impulses().len(),
            sample_s: 1.0 / self.sample_hz,
            proven,
        })
    }

    /// The shortest kind that does what is asked for.
    fn closed_form(&self) -> Option<(f64, String)> {
        let kinds = ShaperKind::ALL.iter().copied();
        let kinds = kinds.filter(|kind| !matches!(kind, ShaperKind::Optimal | ShaperKind::Custom | ShaperKind::None));
        let designs = kinds.filter_map(|kind| {
            let impulses = design_axis(self.axis(kind).shaped(), self.sample_hz).ok()?.impulses;
            self.is_done_by(&impulses)
                .then(|| (impulses.duration_s(), kind.to_string()))
        });
        designs.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    fn is_done_by(&self, impulses: &ImpulseSequence) -> bool {
        let sums = impulses.partial_sums();
        let may = match self.command {
            Command::Positive => impulses.impulses().iter().all(|impulse| impulse.amplitude >= 0.0),
            Command::Amplitudes { low, high } => impulses
                .impulses()
                .iter()
                .all(|impulse| (low - SLACK..=high + SLACK).contains(&impulse.amplitude)),
            Command::PartialSums { low, high } => sums.min >= low - SLACK && sums.max <= high + SLACK,
        };
        let within =
            |mode: &Mode| worst_residual(impulses.impulses(), mode, self.width) <= self.tolerance * (1.0 + SLACK);
        may && self.modes.iter().all(within)
    }
}
