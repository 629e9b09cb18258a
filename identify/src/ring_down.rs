//! Finds modes in an accelerometer's log of a stop, from the free decay after it.
//!
//! ```text
//!  acceleration    ┌──┐                              rest, acceleration, motion, the stop: not looked at
//!            ──────┘  └─────────┐  ╱╲  ╱╲ ── ──
//!                               └─╱  ╲╱  ╲╱            from the last push on: the sum of decaying modes
//! ```
//!
//! The log may begin long before the stop. The latest push is at the sample from which on a sum of decaying modes explains the log, while
//! it does not explain what precedes. After the axis's acceleration jumps by `a`, a mode of participation `p` rings with the acceleration
//! `p·a`, so the amplitudes of this decay are participations.

use crate::found::FoundMode;
use crate::position::{self, FoundInPosition, LEAST_SAMPLES, PositionError, Quantity};
use crate::signal::{AccelerationLog, Between, PositionLog, within};
use thiserror::Error;

/// Modes that ring after a stop.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundInRingDown {
    /// The modes, sorted by frequency.
    pub modes: Vec<FoundMode>,
    /// Name of the sensor direction that was used.
    pub direction: String,
    /// Time in seconds from the first sample to the first sample of the decay that was fitted.
    pub begin_s: f64,
    /// Fraction of the power of the decay that the modes explain.
    pub explained: f64,
    /// Fraction of the whole log's power that is in the decay; it is small if most of the log is another motion, such as a sweep.
    pub part: f64,
    /// The decay, with the modes fitted to it.
    pub decay: FoundInPosition,
}

/// Why no decay is found in a log.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum RingDownError {
    /// Two directions ring alike.
    #[error(
        "the directions `{0}` and `{1}` ring about equally strongly: choose the one that moves with the axis, `--direction {0}` or `--direction {1}`"
    )]
    Directions(String, String),
    /// The log cannot be analysed.
    #[error(transparent)]
    Log(#[from] PositionError),
}

/// Power of the second direction relative to that of the first above which the user is asked for the direction.
const ALIKE: f64 = 0.6;
/// Ratio of the levels whose last crossings are tried as beginnings, and the largest number of levels.
const LEVELS: f64 = 0.7;
const TRIED: usize = 10;
/// The machine counts as being at rest in the last of this many parts of a log.
const REST: usize = 8;
/// Largest residual of a good fit: relative to the motion at rest, or to the fitted motion.
const AS_GOOD: f64 = 1.4;
const SMALL: f64 = 0.02;
/// Fraction of its first value down to which a decay is followed, and the largest number of samples.
const FADED: f64 = 0.02;
const MOST_SAMPLES: usize = 6000;

/// Finds the modes that ring after the last push, in the direction with the largest motion.
///
/// # Errors
/// [`RingDownError`] where the log is too short, or two directions ring alike.
pub fn identify(log: &AccelerationLog) -> Result<FoundInRingDown, RingDownError> {
    let strongest = log
        .directions
        .iter()
        .max_by(|a, b| power(&a.1).total_cmp(&power(&b.1)))
        .ok_or(PositionError::Short(0))?;
    let record = &strongest.1;
    let quiet = power(&record[record.len() - record.len().div_ceil(REST)..]).sqrt();
    let mut latest = Err(PositionError::Short(record.len()));
    for begin in beginnings(record) {
        let Ok(fit) = decay(log, record, begin) else {
            continue;
        };
        let is_explained = fit.noise <= AS_GOOD * quiet || fit.noise <= SMALL * power(&fit.response).sqrt();
        let has_modes = !fit.modes.is_empty();
        latest = Ok((begin, fit));
        if has_modes && is_explained {
            break;
        }
    }
    let (begin, decay) = latest?;
    let ringing = |record: &[f64]| power(record.get(begin..).unwrap_or_default());
    let others = log.directions.iter().filter(|(name, _)| *name != strongest.0);
    let second = others.max_by(|a, b| ringing(&a.1).total_cmp(&ringing(&b.1)));
    if let Some((name, other)) = second
        && ringing(other) > ALIKE * ringing(record)
    {
        return Err(RingDownError::Directions(strongest.0.clone(), name.clone()));
    }
    let whole = power(&decay.response);
    let energy = |record: &[f64]| power(record) * record.len() as f64;
    Ok(FoundInRingDown {
        modes: decay.modes.clone(),
        direction: strongest.0.clone(),
        begin_s: begin as f64 * log.sample_s,
        part: energy(rung(record, begin)) / energy(record).max(f64::MIN_POSITIVE),
        explained: 1.0 - decay.noise.powi(2) / whole.max(f64::MIN_POSITIVE),
        decay,
    })
}

/// Variance of a record.
fn power(record: &[f64]) -> f64 {
    let samples = record.len().max(1) as f64;
    let mean = record.iter().sum::<f64>() / samples;
    record.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / samples
}

fn decay(log: &AccelerationLog, record: &[f64], begin: usize) -> Result<FoundInPosition, PositionError> {
    let rung = rung(record, begin);
    let log = PositionLog {
        sample_s: log.sample_s,
        command: Vec::new(),
        between: Between::Held,
        response: rung.to_vec(),
        missing: within(&log.missing, begin..begin + rung.len()),
    };
    position::identify_response(&log, Quantity::Acceleration)
}

/// Mean of the last part of a record.
fn at_rest(record: &[f64]) -> f64 {
    let tail = &record[record.len() - record.len().div_ceil(REST)..];
    tail.iter().sum::<f64>() / tail.len().max(1) as f64
}

/// Returns a record from a sample on until the decay has faded, and a little longer.
fn rung(record: &[f64], begin: usize) -> &[f64] {
    let (rest, first) = (at_rest(record), record.get(begin).copied().unwrap_or_default());
    let faded = record
        .iter()
        .rposition(|x| (x - rest).abs() >= FADED * (first - rest).abs());
    let rings = faded.map_or(0, |last| (last + 1).saturating_sub(begin));
    let samples = (rings + rings / 4).clamp(4 * LEAST_SAMPLES, MOST_SAMPLES);
    &record[begin..record.len().min(begin + samples)]
}

/// Returns the samples at which the last decay may begin, the earliest first: for each of several decreasing levels, the last sample that
/// is as far from rest as this level.
fn beginnings(record: &[f64]) -> Vec<usize> {
    let rest = at_rest(record);
    let largest = record.iter().map(|x| (x - rest).abs()).fold(0.0, f64::max);
    let mut found: Vec<usize> = Vec::new();
    for step in 0..TRIED {
        let level = largest * LEVELS.powi(step as i32);
        let Some(last) = record.iter().rposition(|x| (x - rest).abs() >= level) else {
            break;
        };
        if record.len() - last < 2 * LEAST_SAMPLES {
            break;
        }
        if found.last() != Some(&last) {
            found.push(last);
        }
    }
    if found.is_empty() { vec![0] } else { found }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::Noise;

    const SAMPLE_S: f64 = 1e-3;

    /// The acceleration of a mode (frequency in Hz, damping ratio) at an axis that accelerates, moves and stops, in m/s².
    fn stop(modes: &[(f64, f64, f64)], seed: u64) -> Vec<f64> {
        const PUSHES: [(f64, f64); 4] = [(0.2, 5.0), (0.25, -5.0), (0.6, -5.0), (0.65, 5.0)];
        let mut noise = Noise::new(seed);
        (0..1800)
            .map(|n| {
                let t = f64::from(n) * SAMPLE_S;
                let moved: f64 = PUSHES
                    .iter()
                    .filter(|(at, _)| t >= *at)
                    .map(|(at, jump)| {
                        let rung = modes.iter().map(|(hz, damping, part)| {
                            let omega = std::f64::consts::TAU * hz;
                            part * (-damping * omega * (t - at)).exp()
                                * (omega * (1.0 - damping * damping).sqrt() * (t - at)).cos()
                        });
                        jump * (1.0 - rung.sum::<f64>())
                    })
                    .sum();
                moved + 0.02 * noise.draw()
            })
            .collect()
    }

    #[test]
    fn long_the_ring_after_a_move_begins_at_its_last_push() {
        for (seed, modes) in [vec![(18.1, 0.05, 1.0)], vec![(24.0, 0.04, 0.6), (61.0, 0.03, 0.4)]]
            .iter()
            .enumerate()
        {
            let record = stop(modes, seed as u64);
            let log = AccelerationLog {
                sample_s: SAMPLE_S,
                directions: vec![
                    ("x".into(), record),
                    ("z".into(), stop(&[], 9).iter().map(|x| 0.1 * x).collect()),
                ],
                missing: Vec::new(),
            };
            let found = identify(&log).unwrap();
            assert!(found.begin_s > 0.6, "{}", found.begin_s);
            assert_eq!(
                (found.direction.as_str(), found.modes.len()),
                ("x", modes.len()),
                "{:#?}",
                found.modes
            );
            for (found, (hz, damping, _)) in found.modes.iter().zip(modes) {
                assert!((found.mode.frequency_hz / hz - 1.0).abs() < 0.01, "{found:?}");
                assert!((found.mode.damping / damping - 1.0).abs() < 0.15, "{found:?}");
            }
        }
    }

    #[test]
    fn a_decay_gives_participations_for_accelerations_and_positions() {
        let modes = [(24.0f64, 0.04f64, 0.6), (61.0, 0.03, 0.4)];
        let rung = |amplitude: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
            let at = |t: f64| {
                let decays = modes.iter().map(|(hz, damping, part)| {
                    let omega = std::f64::consts::TAU * hz;
                    amplitude(*part, omega)
                        * (-damping * omega * t).exp()
                        * (omega * (1.0 - damping * damping).sqrt() * t).cos()
                });
                decays.sum::<f64>()
            };
            (0..800).map(|n| at(f64::from(n) * SAMPLE_S)).collect()
        };
        let log = AccelerationLog {
            sample_s: SAMPLE_S,
            directions: vec![("x".into(), rung(&|part, _| 5.0 * part))],
            missing: Vec::new(),
        };
        let accelerations = identify(&log).unwrap().modes;
        let positions = position::identify(&PositionLog {
            sample_s: SAMPLE_S,
            command: Vec::new(),
            between: Between::Held,
            response: rung(&|part, omega| 5.0 * part / (omega * omega)),
            missing: Vec::new(),
        });
        for found in [accelerations, positions.unwrap().modes] {
            assert_eq!(found.len(), 2, "{found:#?}");
            for (found, (_, _, part)) in found.iter().zip(modes) {
                assert!((found.participation - part).abs() < 0.01, "{found:?}");
            }
        }
    }

    #[test]
    fn two_directions_that_ring_alike_are_refused_with_a_question() {
        let record = stop(&[(18.1, 0.05, 1.0)], 1);
        let log = AccelerationLog {
            sample_s: SAMPLE_S,
            directions: vec![
                ("x".into(), record.clone()),
                ("y".into(), record.iter().map(|x| 0.95 * x).collect()),
            ],
            missing: Vec::new(),
        };
        assert_eq!(identify(&log), Err(RingDownError::Directions("x".into(), "y".into())));
    }
}
