//! The timing of the hardware within a tick: its steps, their clocks, and the delay from the position to the pins.
//!
//! ```text
//! tick ─► capture ─► divide ─► shape ─► control ─► new duty at the next boundary of the PWM
//! ```

use std::fmt;

use crate::machine_file::{ClockSection, PwmSection};
use posicast_blocks::divider::DIVISION_CLOCKS;
use posicast_blocks::sliding_mode::CONTROL_CLOCKS;

/// Clocks of a tick outside of the steps: position and time are latched, the quotient becomes the velocity, and shaper
/// and controller each take their samples a clock late.
pub const CAPTURE_CLOCKS: u32 = 4;

/// The steps of one axis in a tick, one after the other, in clocks. A step that an axis does not have takes 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ControlSchedule {
    capture: u32,
    divide: u32,
    shape: u32,
    control: u32,
}

/// The schedule takes longer than a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("a tick takes {schedule}, but a sample lasts only {available}; it must last longer than a tick")]
pub struct ScheduleError {
    /// The schedule.
    pub schedule: ControlSchedule,
    /// Clocks from sample to sample.
    pub available: u32,
}

impl ControlSchedule {
    /// Schedule of an axis whose position is measured but not controlled.
    pub const fn measuring() -> Self {
        Self {
            capture: CAPTURE_CLOCKS,
            divide: DIVISION_CLOCKS,
            shape: 0,
            control: 0,
        }
    }

    /// Schedule of an axis with a controller. `shape_clocks` is the longest time that its shaper takes for a sample.
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

    /// Checks that the schedule ends before the next tick.
    ///
    /// # Errors
    /// [`ScheduleError`] where a sample of `available` clocks is not longer than the schedule.
    pub fn fits(&self, available: u32) -> Result<(), ScheduleError> {
        if self.clocks() < available {
            Ok(())
        } else {
            Err(ScheduleError {
                schedule: *self,
                available,
            })
        }
    }

    /// The largest sample rate in Hz at which the schedule fits. A sample is a whole number of `step_clocks`, the
    /// period of the PWM or 1.
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

/// Delay in s, as it counts in the loop, from the position that is captured at a tick to the duty computed from it,
/// for a schedule of `schedule_clocks`.
///
/// | part | why |
/// |---|---|
/// | one PWM period, or as many as the schedule needs | a tick is a boundary of the PWM; a new duty takes effect at the next boundary after it is computed |
/// | half a tick | the duty is held for a tick, and so is late by half of it on average |
/// | half a tick | the velocity is measured over a tick |
///
/// ```
/// use posicast_machine::control::{ControlSchedule, schedule_delay_s};
/// use posicast_machine::machine_file::{ClockSection, PwmSection, PwmMode};
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
    fn a_schedule_must_end_before_the_next_tick() {
        let schedule = ControlSchedule::controlling(38);
        assert_eq!(schedule.clocks(), 4 + 102 + 38 + 517);
        assert_eq!(schedule.fits(662), Ok(()));
        let error = schedule.fits(661).unwrap_err().to_string();
        let sum = "capture 4 + divide 102 + shape 38 + control 517 = 661 clocks, but a sample lasts only 661";
        assert!(error.contains(sum), "{error}");
        assert_eq!(ControlSchedule::measuring().clocks(), 106);
        assert!(!ControlSchedule::measuring().to_string().contains("control"));
        // There is no overflow, however long a step is.
        assert!(ControlSchedule::controlling(u32::MAX).fits(u32::MAX).is_err());
    }

    #[test]
    fn the_largest_sample_rate_fits_and_the_next_one_does_not() {
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
    fn a_schedule_longer_than_a_period_waits_for_a_later_boundary() {
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
