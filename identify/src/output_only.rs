//! Finds modes in an accelerometer log whose excitation is not known.
//!
//! If the excitation has an even spectrum and lasts long, the autocorrelation of a response decays like the machine
//! after a release (James, Carne and Lauffer 1995): the modes are those of this decay. Tones in the excitation, such as
//! a fan's, look like modes, and the shares are rough. If the sweep is known, [`crate::sweep`] determines more.

use crate::found::{FoundMode, that_ring};
use crate::position::{self, FoundInPosition, PositionError, Quantity};
use crate::signal::{AccelerationLog, Between, PositionLog};
use crate::spectrum::{Transform, fast_length};

/// Modes found from the correlation of an accelerometer log.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundInOutput {
    /// The modes, sorted by frequency.
    pub modes: Vec<FoundMode>,
    /// Name of the sensor direction that was used.
    pub direction: String,
    /// The decay of the correlation, with the modes fitted to it.
    pub decay: FoundInPosition,
}

/// Longest lag in seconds, and as a fraction of the log.
const LONGEST_LAG_S: f64 = 2.0;
const LONGEST_PART: usize = 10;

/// Finds the modes in the direction with the largest motion.
///
/// # Errors
/// [`PositionError`] where the log is too short.
pub fn identify(log: &AccelerationLog) -> Result<FoundInOutput, PositionError> {
    let variance = |record: &[f64]| {
        let mean = record.iter().sum::<f64>() / record.len().max(1) as f64;
        record.iter().map(|x| (x - mean).powi(2)).sum::<f64>()
    };
    let strongest = log
        .directions
        .iter()
        .max_by(|a, b| variance(&a.1).total_cmp(&variance(&b.1)));
    let (direction, record) = strongest.ok_or(PositionError::Short(0))?;
    let lags = ((LONGEST_LAG_S / log.sample_s) as usize).min(record.len() / LONGEST_PART);
    let correlation = correlation(record, lags);
    let log = PositionLog {
        sample_s: log.sample_s,
        command: Vec::new(),
        between: Between::Held,
        // The noise of the sensor is only in the first value.
        response: correlation.get(1..).unwrap_or_default().to_vec(),
        missing: Vec::new(),
    };
    let decay = position::identify_response(&log, Quantity::Acceleration)?;
    // If an acceleration with an even spectrum drives a mode, the square of its share is to its power as ζ is to ω.
    let share = |found: &FoundMode| (found.participation * found.mode.damping / found.mode.omega()).sqrt();
    let modes = decay.modes.iter().map(|found| FoundMode {
        participation: share(found),
        ..*found
    });
    Ok(FoundInOutput {
        modes: that_ring(modes.collect()),
        direction: direction.clone(),
        decay,
    })
}

/// Mean products of a record, with its mean removed, with itself 0 to `lags` samples later.
fn correlation(record: &[f64], lags: usize) -> Vec<f64> {
    let mean = record.iter().sum::<f64>() / record.len().max(1) as f64;
    let centred: Vec<f64> = record.iter().map(|x| x - mean).collect();
    // Zeros after the record keep its end from being correlated with its beginning.
    let length = fast_length(record.len() + lags + 1);
    let transform = Transform::new(length);
    let mut lines = transform.forward(centred);
    for line in &mut lines {
        *line = (*line * line.conj()) / length as f64;
    }
    let products = transform.inverse(lines);
    (0..=lags)
        .map(|lag| products[lag] / (record.len() - lag) as f64)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::Noise;
    use nalgebra::Vector2;
    use posicast_machine::plant::free_motion;
    use posicast_shaper::mode::Mode;

    /// Acceleration of modes that are driven by white noise.
    fn shaken(modes: &[Mode], samples: usize, sample_s: f64) -> Vec<f64> {
        let mut noise = Noise::new(3);
        let mut states = vec![Vector2::zeros(); modes.len()];
        let motions: Vec<_> = modes.iter().map(|mode| free_motion(mode, sample_s)).collect();
        (0..samples)
            .map(|_| {
                let push = noise.draw();
                let mut sum = 0.0;
                for ((mode, motion), state) in modes.iter().zip(&motions).zip(&mut states) {
                    state.y += push;
                    *state = motion * *state;
                    sum += mode.omega().powi(2) * state.x + 2.0 * mode.decay() * state.y;
                }
                sum + 20.0 * noise.draw()
            })
            .collect()
    }

    #[test]
    fn modes_that_noise_shakes_are_found() {
        let truths = [(31.0, 0.03), (72.0, 0.02)].map(|(frequency_hz, damping)| Mode { frequency_hz, damping });
        let log = AccelerationLog {
            sample_s: 1e-3,
            directions: vec![
                ("accel_x".into(), shaken(&truths, 200_000, 1e-3)),
                ("accel_y".into(), vec![0.1; 200_000]),
            ],
            missing: Vec::new(),
        };
        let found = identify(&log).unwrap();
        assert_eq!(
            (found.direction.as_str(), found.modes.len()),
            ("accel_x", 2),
            "{:#?}",
            found.modes
        );
        for (found, truth) in found.modes.iter().zip(truths) {
            assert!(
                (found.mode.frequency_hz / truth.frequency_hz - 1.0).abs() < 0.01,
                "{found:?}"
            );
            assert!((found.mode.damping / truth.damping - 1.0).abs() < 0.2, "{found:?}");
            assert!((found.participation - 0.5).abs() < 0.15, "{found:?}");
        }
    }

    #[test]
    fn the_correlation_of_a_sine_is_its_cosine() {
        let sine: Vec<f64> = (0..10_000).map(|n| (0.1 * f64::from(n)).sin()).collect();
        for (lag, value) in correlation(&sine, 100).iter().enumerate() {
            assert!((value - 0.5 * (0.1 * lag as f64).cos()).abs() < 1e-3);
        }
    }
}
