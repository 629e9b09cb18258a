//! A mode that was found in a log, with its uncertainty.

use posicast_shaper::mode::Mode;

/// Half width of a 95 % interval in standard deviations of a normal distribution.
pub const DEVIATIONS_OF_95_PERCENT: f64 = 1.959_963_984_540_054;

/// A range of values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// The 95 % interval of a normally distributed estimate.
    pub fn of_95_percent(estimate: f64, deviation: f64) -> Self {
        let half = DEVIATIONS_OF_95_PERCENT * deviation;
        Self {
            low: estimate - half,
            high: estimate + half,
        }
    }

    /// Whether the value is within the interval.
    pub fn holds(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

/// A mode as found in a log, with its uncertainty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoundMode {
    /// Frequency and damping ratio.
    pub mode: Mode,
    /// Absolute value of the mode's share in the static displacement of the response: the shares of all modes found
    /// sum to one.
    pub participation: f64,
    /// Standard deviation of the undamped frequency in Hz.
    pub frequency_sd_hz: f64,
    /// Standard deviation of the damping ratio.
    pub damping_sd: f64,
}

impl FoundMode {
    /// Amplitude in m (rad) with which the mode rings after the axis's acceleration jumps by `acceleration`, in m/s² (rad/s²): `p·a/ω²`.
    /// The weight of a mode is this amplitude.
    pub fn ringing(&self, acceleration: f64) -> f64 {
        self.participation * acceleration / self.mode.omega().powi(2)
    }

    /// 95 % interval of the undamped frequency in Hz.
    pub fn frequency_interval_hz(&self) -> Interval {
        Interval::of_95_percent(self.mode.frequency_hz, self.frequency_sd_hz)
    }

    /// 95 % interval of the damping ratio, which is not below 0.
    pub fn damping_interval(&self) -> Interval {
        let interval = Interval::of_95_percent(self.mode.damping, self.damping_sd);
        Interval {
            low: interval.low.max(0.0),
            ..interval
        }
    }
}

/// Smallest share of all ringing with which a mode is reported.
pub const LEAST_RINGING: f64 = 0.05;
/// The same for a mode with at least [`LEAST_PARTICIPATION`] of all participation: its peak is plain to see, although it rings little.
pub const LEAST_RINGING_OF_SEEN: f64 = 0.005;
/// See [`LEAST_RINGING_OF_SEEN`].
pub const LEAST_PARTICIPATION: f64 = 0.05;

/// The modes that ring enough to be reported, in order of frequency, with participations that sum to one.
pub(crate) fn that_ring(mut modes: Vec<FoundMode>) -> Vec<FoundMode> {
    let rung: f64 = modes.iter().map(|found| found.ringing(1.0)).sum();
    let whole: f64 = modes.iter().map(|found| found.participation).sum();
    modes.retain(|found| {
        let least = if found.participation >= LEAST_PARTICIPATION * whole {
            LEAST_RINGING_OF_SEEN
        } else {
            LEAST_RINGING
        };
        found.ringing(1.0) >= least * rung
    });
    let sum: f64 = modes.iter().map(|found| found.participation).sum();
    for found in &mut modes {
        found.participation /= sum;
    }
    modes.sort_by(|a, b| a.mode.frequency_hz.total_cmp(&b.mode.frequency_hz));
    modes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modes_are_weighted_by_their_ringing() {
        let found = |frequency_hz: f64, participation: f64| FoundMode {
            mode: Mode {
                frequency_hz,
                damping: 0.03,
            },
            participation,
            frequency_sd_hz: 0.01,
            damping_sd: 0.001,
        };
        // 0.04·5/(2π·12)² is 35.2 µm.
        assert!((found(12.0, 0.04).ringing(5.0) - 35.2e-6).abs() < 0.05e-6);
        let frequencies = |modes: &[FoundMode]| -> Vec<f64> {
            let kept = that_ring(modes.to_vec());
            assert!((kept.iter().map(|found| found.participation).sum::<f64>() - 1.0).abs() < 1e-12);
            kept.iter().map(|found| found.mode.frequency_hz).collect()
        };
        // 12 Hz is kept although its share is only 4 %; 4 % that ring with 0.4 % are left out; 1 % is kept as a plain peak; 6 % that ring
        // with 0.1 % are left out.
        assert_eq!(frequencies(&[found(90.0, 0.96), found(12.0, 0.04)]), [12.0, 90.0]);
        assert_eq!(frequencies(&[found(40.0, 0.96), found(130.0, 0.04)]), [40.0]);
        assert_eq!(frequencies(&[found(40.0, 0.9), found(120.0, 0.1)]), [40.0, 120.0]);
        assert_eq!(frequencies(&[found(20.0, 0.94), found(150.0, 0.06)]), [20.0]);
    }
}
