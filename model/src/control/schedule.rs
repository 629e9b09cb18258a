//! How long the hardware takes from the position to the pins.

use crate::spec::{Clock, Pwm};

/// Delay in s from the position that is captured at a tick to the duty that it leads to, as the loop feels it.
///
/// | part | why |
/// |---|---|
/// | one PWM period | a tick is a boundary of the PWM; what is computed in the period after it shows at the next boundary |
/// | half a tick | the duty stands for a tick, on average half of it too late |
/// | half a tick | the velocity is measured over a tick |
///
/// ```
/// use posicast_model::control::schedule_delay_s;
/// use posicast_model::spec::{Clock, Pwm, PwmMode};
///
/// let clock = Clock { frequency_hz: 50e6, sample_hz: 10e3 };
/// let pwm = Pwm {
///     mode: PwmMode::HalfBridge,
///     frequency_hz: 20e3,
///     dead_time_s: 0.0,
///     minimum_pulse_s: 0.0,
///     active_low: false,
/// };
/// assert!((schedule_delay_s(&clock, &pwm) - 150e-6).abs() < 1e-12);
/// ```
pub fn schedule_delay_s(clock: &Clock, pwm: &Pwm) -> f64 {
    1.0 / pwm.frequency_hz + clock.sample_period_s()
}
