//! The control laws in floating point, which the fixed-point controller approximates.
//!
//! Quantities are in counts and ticks, gains as [`Gains`] holds them. Only the boundary layer, the Coulomb term and
//! the command saturate here: the words of the hardware are wide enough, or it raises a flag.

use posicast_blocks::sliding_mode::{Gain, GainError, Law, SETTINGS, SettingRow, Settings};

/// Fraction bits of a command.
pub const COMMAND_FRACTION: u32 = 12;

/// The gains of all laws by [`SettingRow`], and the command limit, in counts, ticks and command units.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Gains([f64; SETTINGS]);

impl Gains {
    /// The gain of a row; for [`SettingRow::Limit`] the command limit.
    pub fn get(&self, row: SettingRow) -> f64 {
        self.0[row as usize]
    }

    /// Sets the gain of a row.
    pub fn set(&mut self, row: SettingRow, value: f64) {
        self.0[row as usize] = value;
    }

    /// Returns the gains with some rows replaced.
    pub fn with(mut self, gains: &[(SettingRow, f64)]) -> Self {
        for (row, value) in gains {
            self.set(*row, *value);
        }
        self
    }

    /// Quantises the gains to mantissas and shifts, and the limit to its own word, rounded to an LSB.
    ///
    /// # Errors
    /// [`GainError`] for a gain that does not fit its row, or a limit that is not a positive number of 31 bits.
    pub fn quantise(&self) -> Result<Settings, GainError> {
        let mut settings = Settings::default();
        for row in SettingRow::ALL {
            match row {
                SettingRow::Limit => settings.set_limit(limit_word(self.get(row))?),
                _ => settings.set_gain(row, Gain::nearest(self.get(row), row)?),
            }
        }
        Ok(settings)
    }

    /// The gains that quantised settings stand for.
    pub fn of_settings(settings: &Settings) -> Self {
        let one = f64::from(1u32 << COMMAND_FRACTION);
        Self(SettingRow::ALL.map(|row| match row {
            SettingRow::Limit => f64::from(settings.limit()) / one,
            _ => settings.gain(row).value(row),
        }))
    }
}

fn limit_word(limit: f64) -> Result<u32, GainError> {
    let one = f64::from(1u32 << COMMAND_FRACTION);
    let (row, largest) = (
        SettingRow::Limit,
        f64::from(posicast_blocks::sliding_mode::LIMIT_MAX) / one,
    );
    match limit {
        _ if !limit.is_finite() => Err(GainError::NotFinite { found: limit, row }),
        _ if !(0.0..=largest).contains(&limit) => Err(GainError::Large {
            found: limit,
            row,
            largest,
        }),
        _ => Ok((limit * one).round() as u32),
    }
}

/// Inputs of the controller in a tick, in counts and ticks.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Tracking {
    /// Position error e = r − x.
    pub error: f64,
    /// Rate of the error de = dr − v.
    pub error_rate: f64,
    /// Reference velocity dr.
    pub velocity_reference: f64,
    /// Reference acceleration ddr.
    pub acceleration_reference: f64,
    /// Measured velocity v.
    pub velocity: f64,
}

/// Outputs of the controller in a tick.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Response {
    /// Sliding variable s.
    pub sliding: f64,
    /// Command, within ±limit.
    pub command: f64,
    /// Duty in clocks of the PWM period.
    pub duty: f64,
    /// 1 where the command was clamped above, −1 below, else 0.
    pub limited: i8,
}

/// A controller with its integral term.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FloatController {
    integral: f64,
}

impl FloatController {
    /// Computes one tick.
    pub fn control(&mut self, law: Law, gains: &Gains, motion: &Tracking) -> Response {
        let gain = |row| gains.get(row);
        let Tracking { error, error_rate, .. } = *motion;
        let sliding = error_rate + gain(SettingRow::Surface) * error;
        let feedback = match law {
            Law::SlidingMode => {
                let fraction = saturation(gain(SettingRow::Boundary) * sliding);
                gain(SettingRow::Damping) * error_rate
                    + gain(SettingRow::Reaching) * sliding
                    + gain(SettingRow::Switching) * fraction
            }
            Law::Pd => gain(SettingRow::Derivative) * error_rate + gain(SettingRow::Proportional) * error,
            Law::Pid => {
                let linear = gain(SettingRow::Derivative) * error_rate + gain(SettingRow::Proportional) * error;
                linear + gain(SettingRow::Integral) * self.integral
            }
        };
        let coulomb = saturation(gain(SettingRow::Fade) * motion.velocity_reference);
        let wanted = gain(SettingRow::Feedback) * feedback
            + gain(SettingRow::Acceleration) * motion.acceleration_reference
            + gain(SettingRow::Velocity) * motion.velocity_reference
            + gain(SettingRow::Viscous) * motion.velocity
            + gain(SettingRow::Coulomb) * coulomb;
        let limit = gain(SettingRow::Limit);
        let limited = i8::from(wanted > limit) - i8::from(wanted < -limit);
        // The integral is frozen while the command is clamped in its direction.
        let opposes = (gain(SettingRow::Integral) < 0.0) != (gain(SettingRow::Feedback) < 0.0);
        let lowers = (error < 0.0) != opposes;
        let frozen = if lowers { limited < 0 } else { limited > 0 };
        if law == Law::Pid && !frozen {
            self.integral += error;
        }
        let command = wanted.clamp(-limit, limit);
        Response {
            sliding,
            command,
            duty: gain(SettingRow::Duty) * command,
            limited,
        }
    }

    /// Clears the integral.
    pub fn clear_integral(&mut self) {
        self.integral = 0.0;
    }
}

/// Clamps to −1 … 1.
fn saturation(value: f64) -> f64 {
    value.clamp(-1.0, 1.0)
}
