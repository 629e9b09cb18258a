//! Figures of a move, in m or rad.

use posicast_machine::plant::axis::{ErrorFigures, residual_vibration, tracking_error};

use crate::stage_bench::AxisSample;

/// The load's rest position is its mean over the last part of the time at standstill; this is the divisor.
const REST_PART: usize = 2;

/// Tracking error of an axis, and its residual vibration, in m or rad.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AxisFigures {
    /// Difference between count and shaped command over the whole move, as the controller sees it.
    pub tracking: ErrorFigures,
    /// Vibration of the load about its rest position, from the end of the shaped command on.
    pub residual: ErrorFigures,
    /// Distance of the load's rest position from its target.
    pub offset: f64,
}

/// Index of the first sample from which on the shaped command stands still.
pub(super) fn arrival(samples: &[AxisSample]) -> usize {
    let target = samples.last().map_or(0.0, |sample| sample.shaped);
    let moving = samples.iter().rposition(|sample| sample.shaped != target);
    moving.map_or(0, |last| last + 1)
}

/// Vibration of the load about its rest position, from the end of the shaped command on, and that position.
pub(crate) fn ringing(samples: &[AxisSample]) -> (Vec<f64>, f64) {
    let load: Vec<f64> = samples[arrival(samples)..].iter().map(|sample| sample.load).collect();
    let resting = &load[load.len() - load.len() / REST_PART..];
    let rest = resting.iter().sum::<f64>() / resting.len().max(1) as f64;
    (load.iter().map(|position| position - rest).collect(), rest)
}

/// The figures of an axis with this many counts per unit.
pub(crate) fn of_move(samples: &[AxisSample], counts_per_unit: f64) -> AxisFigures {
    let of = |value: fn(&AxisSample) -> f64| samples.iter().map(value).collect::<Vec<f64>>();
    let tracking = tracking_error(&of(|sample| sample.error), &vec![0.0; samples.len()]);
    let (ringing, rest) = ringing(samples);
    let target = samples.last().map_or(0.0, |sample| sample.shaped / counts_per_unit);
    AxisFigures {
        tracking: ErrorFigures {
            peak: tracking.peak / counts_per_unit,
            rms: tracking.rms / counts_per_unit,
        },
        residual: residual_vibration(&ringing, 0.0),
        offset: rest - target,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(shaped: f64, error: f64, load: f64) -> AxisSample {
        AxisSample {
            command: 0.0,
            shaped,
            count: 0.0,
            error,
            motor: 0.0,
            load,
        }
    }

    #[test]
    fn ringing_counts_from_the_end_of_the_command_and_about_the_place_of_rest() {
        let mut samples = vec![sample(1.0, 4.0, 0.5), sample(2.0, 0.0, 1.9), sample(4.0, 0.0, 2.3)];
        samples.extend([1.8, 2.1, 2.1].map(|load| sample(4.0, 0.0, load)));
        let figures = of_move(&samples, 2.0);
        assert_eq!(arrival(&samples), 2);
        assert_eq!(figures.tracking.peak, 2.0);
        assert!((figures.residual.peak - 0.3).abs() < 1e-12, "{figures:?}");
        assert!((figures.offset - 0.1).abs() < 1e-12, "{figures:?}");
        assert_eq!(of_move(&[], 1.0), AxisFigures::default());
    }
}
