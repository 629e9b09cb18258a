//! A mode that was found in a log, with its uncertainty.

use posicast_model::mode::Mode;

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
