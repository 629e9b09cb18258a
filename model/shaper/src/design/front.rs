//! What the duration of an `optimal` shaper buys: the front of duration, taps and residual.

use super::optimal::Optimal;
use super::{DesignError, JointError};
use posicast_optimal::{FrontPoint, front};

/// Durations that are looked at, as parts of the least one: its last tenth closely, and beyond it what a longer one would buy.
const DURATIONS: [f64; 10] = [1.0, 1.02, 1.04, 1.06, 1.08, 1.11, 1.18, 1.25, 1.35, 1.5];

/// A duration, and what it buys.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrontFigures {
    /// Duration in seconds.
    pub duration_s: f64,
    /// Fewest taps found within this duration that hold the tolerances over the bands.
    pub taps: usize,
    /// Largest magnitude of a partial sum of these: what a step asks of the drive.
    pub peak_command: f64,
    /// Mean delay of these in seconds.
    pub delay_s: f64,
    /// Least residual over the bands that any shaper of this duration reaches, as a part of the tolerance.
    pub least_ratio: f64,
}

/// The front of an `optimal` design, shortest first.
///
/// # Errors
/// [`DesignError::Joint`] where a program does not converge.
pub fn design_front(found: &Optimal) -> Result<Vec<FrontFigures>, DesignError> {
    let least = f64::from(found.least_samples);
    let mut durations: Vec<u32> = DURATIONS
        .iter()
        .map(|part| (part * least).round() as u32)
        .filter(|samples| *samples <= found.request.longest_samples)
        .collect();
    durations.dedup();
    let points = front(&found.request, &durations).map_err(JointError::from)?;
    Ok(points
        .iter()
        .map(|point| figures(point, found.request.sample_hz))
        .collect())
}

fn figures(point: &FrontPoint, sample_hz: f64) -> FrontFigures {
    let (mut sum, mut peak, mut delay) = (0.0, 0.0f64, 0.0);
    for (sample, amplitude) in &point.taps {
        sum += amplitude;
        peak = peak.max(sum.abs());
        delay += amplitude * f64::from(*sample);
    }
    FrontFigures {
        duration_s: f64::from(point.samples) / sample_hz,
        taps: point.taps.len(),
        peak_command: peak,
        delay_s: delay / sample_hz,
        least_ratio: point.least_ratio,
    }
}
