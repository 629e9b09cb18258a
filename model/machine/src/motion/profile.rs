//! Jerk-limited point-to-point moves.
//!
//! ```text
//! jerk   +j │▇▇│  │  │  │  │  │▇▇│          t_j: jerk       t_a: constant acceleration       t_v: constant velocity
//!           │  │  │  │──│  │  │  │          seven segments: t_j t_a t_j t_v t_j t_a t_j
//!        −j │  │  │▇▇│  │▇▇│  │  │          any of t_a, t_v may be 0
//! ```
//!
//! The first half ends at half the distance; the second is its mirror image, so that the move ends exactly on target.

use thiserror::Error;

use crate::machine_file::LimitsSection;
use posicast_shaper::unit::show_seconds;

/// Largest number of samples of a move: an hour and a half at 2 kHz, and 80 MB.
pub const SAMPLES_MAX: usize = 10_000_000;

/// Default limits of a move in m/s, m/s² and m/s³.
const DEFAULT_VELOCITY: f64 = 0.25;
const DEFAULT_ACCELERATION: f64 = 8.0;
const DEFAULT_JERK: f64 = 400.0;

/// Why a move is not possible.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ProfileError {
    /// A limit is invalid.
    #[error("{limit} limit {value}: it must be positive and finite")]
    Limit {
        /// Name of the limit: `velocity`, `acceleration` or `jerk`.
        limit: &'static str,
        /// Value of the limit.
        value: f64,
    },
    /// The start or the end is not a finite number.
    #[error("a move from {start} to {end}: both must be finite numbers")]
    Ends {
        /// Start of the move.
        start: f64,
        /// End of the move.
        end: f64,
    },
    /// The move has too many samples.
    #[error(
        "a move of {} has {samples:.3e} samples at {sample_hz} Hz; at most {SAMPLES_MAX}: \
         raise the limits, shorten the move, or lower sample_hz",
        show_seconds(*.duration_s, 3)
    )]
    TooLong {
        /// Duration of the move and the settling time, in seconds.
        duration_s: f64,
        /// Number of samples.
        samples: f64,
        /// Sample rate in Hz.
        sample_hz: f64,
    },
}

/// A move from rest to rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    start: f64,
    distance: f64,
    jerk: f64,
    jerk_s: f64,
    constant_acceleration_s: f64,
    constant_velocity_s: f64,
}

impl Profile {
    /// The fastest symmetric move from `start` to `end` within the limits (all positive; per second, second²,
    /// second³).
    ///
    /// # Errors
    /// [`ProfileError::Limit`] and [`ProfileError::Ends`] for invalid numbers.
    pub fn new(start: f64, end: f64, velocity: f64, acceleration: f64, jerk: f64) -> Result<Self, ProfileError> {
        for (limit, value) in [("velocity", velocity), ("acceleration", acceleration), ("jerk", jerk)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(ProfileError::Limit { limit, value });
            }
        }
        let distance = (end - start).abs();
        if !distance.is_finite() {
            return Err(ProfileError::Ends { start, end });
        }
        // Which limit is reached first on the way to half the distance: the acceleration, the velocity, or none.
        let by_acceleration_s = acceleration / jerk;
        let by_velocity_s = (velocity / jerk).sqrt();
        let by_distance_s = (distance / jerk / 2.0).cbrt();
        let jerk_s = by_acceleration_s.min(by_velocity_s).min(by_distance_s);
        let peak = jerk * jerk_s;
        let constant_acceleration_s = if jerk_s < by_acceleration_s {
            0.0
        } else {
            let until_velocity_s = velocity / peak - jerk_s;
            let until_distance_s = (jerk_s * jerk_s / 4.0 + distance / peak).sqrt() - 1.5 * jerk_s;
            until_velocity_s.min(until_distance_s).max(0.0)
        };
        let ramp_s = 2.0 * jerk_s + constant_acceleration_s;
        let fastest = peak * (jerk_s + constant_acceleration_s);
        let constant_velocity_s = if fastest > 0.0 {
            (distance / fastest - ramp_s).max(0.0)
        } else {
            0.0
        };
        Ok(Self {
            start,
            distance: end - start,
            jerk,
            jerk_s,
            constant_acceleration_s,
            constant_velocity_s,
        })
    }

    /// Duration of the move in seconds.
    pub fn duration_s(&self) -> f64 {
        4.0 * self.jerk_s + 2.0 * self.constant_acceleration_s + self.constant_velocity_s
    }

    /// Durations in s of the constant jerk, the constant acceleration and the constant velocity.
    pub(super) fn stretches_s(&self) -> [f64; 3] {
        [self.jerk_s, self.constant_acceleration_s, self.constant_velocity_s]
    }

    /// The eight instants at which the jerk changes, each with its change; some coincide where a segment is empty.
    pub(super) fn jerk_changes(&self) -> [(f64, f64); 8] {
        let jerk = self.jerk.copysign(self.distance);
        let signs = [1.0, -1.0, -1.0, 1.0, -1.0, 1.0, 1.0, -1.0];
        let lengths_s = [
            0.0,
            self.jerk_s,
            self.constant_acceleration_s,
            self.jerk_s,
            self.constant_velocity_s,
            self.jerk_s,
            self.constant_acceleration_s,
            self.jerk_s,
        ];
        let mut time_s = 0.0;
        [0, 1, 2, 3, 4, 5, 6, 7].map(|k: usize| {
            time_s += lengths_s[k];
            (time_s, signs[k] * jerk)
        })
    }

    /// Position at `time_s` seconds after the start; constant before the start and after the end.
    pub fn position(&self, time_s: f64) -> f64 {
        let left_s = self.duration_s() - time_s;
        let size = self.distance.abs();
        let travelled = if time_s <= 0.0 {
            0.0
        } else if left_s <= 0.0 {
            size
        } else if time_s <= left_s {
            self.travelled(time_s).min(size)
        } else {
            (size - self.travelled(left_s)).max(0.0)
        };
        self.start + travelled.copysign(self.distance)
    }

    /// Distance covered in the first half.
    fn travelled(&self, time_s: f64) -> f64 {
        let (jerk, jerk_s, constant_s) = (self.jerk, self.jerk_s, self.constant_acceleration_s);
        let peak = jerk * jerk_s;
        // For each segment: the time in it, then position, velocity and acceleration at its start.
        let rise_s = time_s.min(jerk_s);
        let mut distance = jerk * rise_s.powi(3) / 6.0;
        let mut velocity = jerk * rise_s * rise_s / 2.0;
        let hold_s = (time_s - jerk_s).clamp(0.0, constant_s);
        distance += velocity * hold_s + peak * hold_s * hold_s / 2.0;
        velocity += peak * hold_s;
        let fall_s = (time_s - jerk_s - constant_s).clamp(0.0, jerk_s);
        distance += velocity * fall_s + peak * fall_s * fall_s / 2.0 - jerk * fall_s.powi(3) / 6.0;
        velocity += peak * fall_s - jerk * fall_s * fall_s / 2.0;
        let cruise_s = (time_s - 2.0 * jerk_s - constant_s).max(0.0);
        distance + velocity * cruise_s
    }

    /// Positions at the samples, from the start to `settle_s` seconds after the end.
    ///
    /// # Errors
    /// [`ProfileError::TooLong`] for more than [`SAMPLES_MAX`] samples.
    pub fn samples(&self, sample_hz: f64, settle_s: f64) -> Result<Vec<f64>, ProfileError> {
        let duration_s = self.duration_s() + settle_s.max(0.0);
        let samples = (duration_s * sample_hz).ceil() + 1.0;
        if samples.is_nan() || samples > SAMPLES_MAX as f64 {
            return Err(ProfileError::TooLong {
                duration_s,
                samples,
                sample_hz,
            });
        }
        let times = (0..samples as u32).map(|index| f64::from(index) / sample_hz);
        Ok(times.map(|time_s| self.position(time_s)).collect())
    }
}

/// Velocity, acceleration and jerk limit of a move: the file's, or the defaults.
pub(crate) fn motion_limits(limits: Option<&LimitsSection>) -> [f64; 3] {
    let of = |limit: fn(&LimitsSection) -> Option<f64>, default| limits.and_then(limit).unwrap_or(default);
    [
        of(|l| l.velocity, DEFAULT_VELOCITY),
        of(|l| l.acceleration, DEFAULT_ACCELERATION),
        of(|l| l.jerk, DEFAULT_JERK),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest velocity, acceleration and jerk, from differences of a finely sampled profile.
    fn largest(profile: &Profile, steps: u32) -> [f64; 3] {
        let step_s = profile.duration_s() / f64::from(steps);
        let mut values: Vec<f64> = (0..=steps).map(|k| profile.position(f64::from(k) * step_s)).collect();
        [0; 3].map(|_: i32| {
            values = values.windows(2).map(|p| (p[1] - p[0]) / step_s).collect();
            values.iter().fold(0.0, |most: f64, v| most.max(v.abs()))
        })
    }

    #[test]
    fn every_shape_of_profile_keeps_its_limits() {
        // Each case has distance, velocity, acceleration, jerk, and which of the limits is reached.
        let cases = [
            (1.0, 0.25, 8.0, 400.0, [true, true, true]),
            (0.01, 0.25, 8.0, 400.0, [false, true, true]),
            (1.0, 0.1, 8.0, 400.0, [true, false, true]),
            (1e-5, 0.25, 8.0, 400.0, [false, false, true]),
            (-0.3, 0.25, 8.0, 400.0, [true, true, true]),
        ];
        for (distance, velocity, acceleration, jerk, reached) in cases {
            let profile = Profile::new(0.01, 0.01 + distance, velocity, acceleration, jerk).unwrap();
            let found = largest(&profile, 2000);
            for ((found, limit), reached) in found.into_iter().zip([velocity, acceleration, jerk]).zip(reached) {
                assert!(found <= limit * 1.001, "{distance}: {found} above {limit}");
                assert_eq!(found > limit * 0.99, reached, "{distance}: {found} of {limit}");
            }
            assert_eq!(profile.position(0.0), 0.01);
            assert_eq!(profile.position(profile.duration_s()), 0.01 + distance);
        }
    }

    #[test]
    fn the_two_halves_meet() {
        for distance in [1e-9, 1e-4, 0.005, 0.02, 1.0, 1e6] {
            let profile = Profile::new(0.0, distance, 0.25, 8.0, 400.0).unwrap();
            let middle_s = profile.duration_s() / 2.0;
            assert!((profile.travelled(middle_s) - distance / 2.0).abs() <= 1e-12 * distance);
        }
    }

    #[test]
    fn degenerate_moves() {
        let still = Profile::new(0.3, 0.3, 1.0, 1.0, 1.0).unwrap();
        assert_eq!((still.duration_s(), still.position(1.0)), (0.0, 0.3));
        assert_eq!(still.samples(100.0, 0.02).unwrap(), [0.3, 0.3, 0.3]);
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Profile::new(0.0, 1.0, bad, 1.0, 1.0).is_err());
            assert!(Profile::new(0.0, 1.0, 1.0, bad, 1.0).is_err());
            assert!(Profile::new(0.0, 1.0, 1.0, 1.0, bad).is_err());
        }
        assert!(Profile::new(f64::NAN, 1.0, 1.0, 1.0, 1.0).is_err());
        assert!(Profile::new(-f64::MAX, f64::MAX, 1.0, 1.0, 1.0).is_err());
        // A very slow move is refused before its samples are made.
        let creep = Profile::new(0.0, 1e6, 1e-300, 1e-300, 1e-300).unwrap();
        assert!(matches!(creep.samples(1e6, 0.0), Err(ProfileError::TooLong { .. })));
        let sudden = Profile::new(0.0, 1e-300, 1e300, 1e300, 1e300).unwrap();
        assert!(sudden.samples(1e4, 0.001).unwrap().iter().all(|p| p.is_finite()));
    }
}
