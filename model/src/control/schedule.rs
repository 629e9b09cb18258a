//! What the hardware does within a tick, how many clocks that takes, and how long it is from the position to the pins.
//!
//! ```text
//! tick ─► capture ─► divide ─► shape ─► control ─► new duty at the next boundary of the PWM
//! ```

use std::fmt;

use crate::machine_file::{ClockSection, PwmSection};
use crate::rtl::divider::DIVISION_CLOCKS;
use crate::rtl::sliding_mode::CONTROL_CLOCKS;

/// Clocks of a tick that belong to no pass: position and time are latched, the quotient is taken as the velocity, and
/// shaper and controller take their samples a clock late each.
pub const CAPTURE_CLOCKS: u32 = 4;

/// The passes of one axis in a tick, one after the other, in clocks. What an axis does not have takes 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ControlSchedule {
    capture: u32,
    divide: u32,
    shape: u32,
    control: u32,
}

/// A schedule that does not end before the next tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a tick takes {schedule}, a sample lasts {available} and must last longer than that")]
pub struct ScheduleError {
    /// What does not fit.
    pub schedule: ControlSchedule,
    /// Clocks from sample to sample.
    pub available: u32,
}

impl ControlSchedule {
    /// Of an axis whose position is measured, and not controlled.
    pub const fn measuring() -> Self {
        Self {
            capture: CAPTURE_CLOCKS,
            divide: DIVISION_CLOCKS,
            shape: 0,
            control: 0,
        }
    }

    /// Of an axis with a controller, whose shaper takes `shape_clocks` for its longest pass.
    pub const fn controlling(shape_clocks: u32) -> Self {
        Self {
            shape: shape_clocks,
            control: CONTROL_CLOCKS,
            ..Self::measuring()
        }
    }

    /// Clocks from the tick to the new duty.
    pub fn clocks(&self) -> u32 {
        [self.capture, self.divide, self.shape, self.control]
            .into_iter()
            .fold(0, u32::saturating_add)
    }

    /// Whether it ends before the next tick.
    ///
    /// # Errors
    /// [`ScheduleError`] where a sample of `available` clocks is not longer than the schedule.
    pub fn fits(&self, available: u32) -> Result<(), ScheduleError> {
        match self.clocks() < available {
            true => Ok(()),
            false => Err(ScheduleError {
                schedule: *self,
                available,
            }),
        }
    }

    /// The largest sample rate in Hz at which it fits: a sample is a whole number of `step_clocks`, which is the period of
    /// the PWM, or 1.
    pub fn largest_sample_hz(&self, clock_hz: f64, step_clocks: u64) -> f64 {
        let step_clocks = step_clocks.max(1);
        let steps = u64::from(self.clocks()) / step_clocks + 1;
        clock_hz / (steps as f64 * step_clocks as f64)
    }
}

impl fmt::Display for ControlSchedule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "capture {} + divide {}", self.capture, self.divide)?;
        if self.control > 0 {
            write!(f, " + shape {} + control {}", self.shape, self.control)?;
        }
        write!(f, " = {} clocks", self.clocks())
    }
}

/// Delay in s from the position that is captured at a tick to the duty that it leads to, as the loop feels it, if that takes
/// `schedule_clocks`.
///
/// | part | why |
/// |---|---|
/// | one PWM period, or as many as the schedule needs | a tick is a boundary of the PWM; what is computed after it shows at the next boundary after its end |
/// | half a tick | the duty stands for a tick, on average half of it too late |
/// | half a tick | the velocity is measured over a tick |
///
/// ```
/// use posicast_model::control::{ControlSchedule, schedule_delay_s};
/// use posicast_model::machine_file::{ClockSection, PwmSection, PwmMode};
///
/// let clock = ClockSection { frequency_hz: 50e6, sample_hz: 10e3 };
/// let pwm = PwmSection {
///     mode: PwmMode::HalfBridge,
///     frequency_hz: 20e3,
///     dead_time_s: 0.0,
///     minimum_pulse_s: 0.0,
///     active_low: false,
/// };
/// let delay_s = schedule_delay_s(&clock, &pwm, ControlSchedule::controlling(38).clocks());
/// assert!((delay_s - 150e-6).abs() < 1e-12);
/// ```
pub fn schedule_delay_s(clock: &ClockSection, pwm: &PwmSection, schedule_clocks: u32) -> f64 {
    let periods = schedule_clocks / pwm.period_clocks(clock).max(1) + 1;
    f64::from(periods) / pwm.frequency_hz + clock.sample_period_s()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine_file::PwmMode;

    #[test]
    fn unit_a_schedule_must_end_before_the_next_tick() {
        let schedule = ControlSchedule::controlling(38);
        assert_eq!(schedule.clocks(), 4 + 102 + 38 + 517);
        assert_eq!(schedule.fits(662), Ok(()));
        let error = schedule.fits(661).unwrap_err().to_string();
        let sum = "capture 4 + divide 102 + shape 38 + control 517 = 661 clocks, a sample lasts 661";
        assert!(error.contains(sum), "{error}");
        assert_eq!(ControlSchedule::measuring().clocks(), 106);
        assert!(!ControlSchedule::measuring().to_string().contains("control"));
        // No overflow, whatever a pass takes.
        assert!(ControlSchedule::controlling(u32::MAX).fits(u32::MAX).is_err());
    }

    #[test]
    fn unit_the_largest_sample_rate_fits_and_the_next_one_does_not() {
        let schedule = ControlSchedule::controlling(38);
        for step in [1, 50, 100, 661, 662, 2500] {
            let clocks = (50e6 / schedule.largest_sample_hz(50e6, step)).round() as u32;
            assert_eq!(u64::from(clocks) % step, 0);
            assert_eq!(schedule.fits(clocks), Ok(()), "{step}");
            assert!(schedule.fits(clocks - step as u32).is_err(), "{step}");
        }
        assert!(schedule.largest_sample_hz(50e6, 0) > 0.0);
    }

    #[test]
    fn unit_a_schedule_longer_than_a_period_waits_for_a_later_boundary() {
        let clock = ClockSection {
            frequency_hz: 50e6,
            sample_hz: 50e3,
        };
        let pwm = PwmSection {
            mode: PwmMode::HalfBridge,
            frequency_hz: 200e3,
            dead_time_s: 0.0,
            minimum_pulse_s: 0.0,
            active_low: false,
        };
        let delay_s = schedule_delay_s(&clock, &pwm, ControlSchedule::controlling(38).clocks());
        assert!((delay_s - 35e-6).abs() < 1e-12, "{delay_s}");
    }
}
