//! Computes the words of an axis's supervisor, and of the quick stop, from the machine file.
//!
//! | key of `[axis.limits]` | word | unit of its LSB | rounded | absent |
//! |---|---|---|---|---|
//! | `travel` | soft limits, i32 | 2^−8 counts | inwards | 0, 0: no soft limits |
//! | `soft_limits_after_homing` | 1 bit | | | 0: they act at once |
//! | `following_error` | u32 | 2^−16 counts | down, at least 1 | 0: not checked |
//! | `deviation` | u32 | counts | down, at least 1 | 0: not checked |
//! | `deviation_s` | u16 | ticks | down, at least 1 | 0: it acts at once |
//! | `saturation_s`, `encoder_lost_s`, `watchdog_s` | u16 | ticks | down, at least 1 | 0: not checked |
//! | `encoder_lost_command` | u32 | 2^−12 command units | down | 0.5 of full scale; 0 without `encoder_lost_s` |
//! | `brake_release_s`, `brake_apply_s` | u16 | ticks | up | 0 |
//! | `line_filter_s` | 6 bits | clocks | up | 0 |
//! | `stop_deceleration` | 31 bits | 2^−24 counts per tick² | down, at least 1 | `acceleration`; without it 0: the axis stops at once |
//! | `direct_duty` | u16 | clocks of the PWM | down | 0.1 of the period |
//! | `direct_hold_s` | u16 | ticks | down, at least 1 | 0.2 s, or what fits |
//! | `excitation` | u16 | 2^−8 counts | down, at least 1 | 4 counts |
//!
//! `watches_direction` is 1 where a motion against the command for `encoder_lost_s` can only be caused by a wrong
//! sign ([`LostSign`]).
//!
//! So no limit is looser than in the file, no brake gets less time, and no filter passes shorter pulses. A value that
//! is too large or too small for its word is an error; it is never clamped. "Counts" are those of the loop,
//! [`AxisSection::loop_counts_per_unit`].

use super::reach::{TableBounds, check_travel};
use super::supervision_error::SupervisionError;
use crate::control::derive::full_scale;
use crate::control::law::COMMAND_FRACTION;
use crate::machine_file::{AxisSection, ClockSection, Drive, DriveMode, LimitsSection, PwmSection};
use posicast_blocks::segments::{ACCELERATION_FRACTION, POSITION_FRACTION};
use posicast_blocks::stage::Supervision;

/// Fraction bits of the controller's error e.
const ERROR_FRACTION: u32 = 16;
/// Largest limit that a signed word of 32 bits can exceed in both directions; the magnitudes of x and −x − 1 differ
/// by one.
const SIZE_MAX: u32 = (1 << 31) - 2;
/// Largest deceleration: 31 bits.
const DECELERATION_MAX: u32 = (1 << 31) - 1;
/// Longest filter of a line, in clocks.
const FILTER_CLOCKS_MAX: u32 = 63;
/// Default time for which a manual duty stays applied.
const DEFAULT_DIRECT_HOLD_S: f64 = 0.2;
/// Default of the largest amplitude of test signals, in counts.
const DEFAULT_EXCITATION_COUNTS: u16 = 4;
/// Relative rounding of decimals such as `0.3`, which binary fractions only approximate.
const DECIMALS: f64 = 1e-9;

/// Ticks from the shaped position to its last step: the line between two samples takes one, and begins within another.
const STEPS_LAG_TICKS: u32 = 2;

/// Computes the supervisor's words of an axis with a controller or steps, whose shaper has this table.
///
/// # Errors
/// [`SupervisionError`] names the first value that its word does not hold, with the allowed range.
pub fn supervision(
    axis: &AxisSection,
    clock: &ClockSection,
    table: TableBounds,
) -> Result<Supervision, SupervisionError> {
    let missing = |table| SupervisionError::Missing {
        axis: axis.name.clone(),
        table,
    };
    let words = Words {
        axis,
        clock,
        limits: axis.limits.unwrap_or_default(),
        output: match (&axis.steps, &axis.pwm, &axis.drive) {
            (Some(_), ..) => None,
            (None, pwm, drive) => Some((
                pwm.as_ref().ok_or_else(|| missing("pwm"))?,
                drive.as_ref().ok_or_else(|| missing("drive"))?,
            )),
        },
    };
    let lasting = match words.output {
        Some(_) => 0,
        None => STEPS_LAG_TICKS,
    };
    let limits = &words.limits;
    let [soft_limit_minus, soft_limit_plus] = words.soft_limits()?;
    check_travel(axis, &table)?;
    Ok(Supervision {
        off_causes: limits.off_causes,
        brake_release_ticks: words.ticks_up("axis.limits.brake_release_s", limits.brake_release_s)?,
        brake_apply_ticks: words.ticks_up("axis.limits.brake_apply_s", limits.brake_apply_s)?,
        settle_ticks: words.settle_ticks(table.longest_delay_samples + lasting)?,
        soft_limit_plus,
        soft_limit_minus,
        limits_after_homing: limits.soft_limits_after_homing,
        following_error_limit: words.error_limit(
            "axis.limits.following_error",
            limits.following_error,
            ERROR_FRACTION,
        )?,
        deviation_limit: words.error_limit("axis.limits.deviation", limits.deviation, 0)?,
        deviation_ticks: words.ticks_down("axis.limits.deviation_s", limits.deviation_s)?,
        saturation_ticks: words.ticks_down("axis.limits.saturation_s", limits.saturation_s)?,
        lost_command: words.lost_command()?,
        lost_ticks: words.ticks_down("axis.limits.encoder_lost_s", limits.encoder_lost_s)?,
        watches_direction: lost_sign(axis) == LostSign::Watched,
        watchdog_ticks: words.ticks_down("axis.limits.watchdog_s", limits.watchdog_s)?,
        filter_clocks: words.filter_clocks()?,
        stop_deceleration: words.stop_deceleration()?,
        direct_limit: words.direct_limit(),
        direct_hold_ticks: words.direct_hold_ticks()?,
        excitation_limit: words.excitation_limit()?,
    })
}

/// Whether the encoder monitor detects a feedback of the wrong sign.
///
/// With a wrong sign the axis moves against its command, faster and faster. The monitor may therefore count a motion
/// against the command as standstill, if no sound axis moves so for `encoder_lost_s`. An axis with a velocity drive
/// does not. A torque slows down the motion that it opposes: a command of more than `encoder_lost_command`, and so an
/// acceleration of more than `a`, stops a motion of `velocity` in less than `velocity`/`a`, however fast the command
/// itself slows down. Friction makes that shorter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LostSign {
    /// It is detected within `encoder_lost_s` of a command above `encoder_lost_command` in one direction.
    Watched,
    /// It is not detected, because a sound axis takes longer than `encoder_lost_s` to slow down.
    TooShort {
        /// Shortest `encoder_lost_s` with which it would be detected, in s.
        least_s: f64,
    },
    /// It is not detected, because without `velocity` or `encoder_lost_s`, or with a threshold of 0, it is not known
    /// how long an axis may take to slow down.
    Unknown,
}

/// Ratio of the time that a sound axis may need to slow down to that of an ideal one. It allows for weight, for
/// shaped commands that overshoot, and for the motion of a few counts by which the monitor detects a reversal.
const SLOWER: f64 = 1.2;

/// Whether the words of [`supervision`] let the encoder monitor detect a wrong sign.
pub fn lost_sign(axis: &AxisSection) -> LostSign {
    let limits = axis.limits.unwrap_or_default();
    let Some(drive) = axis.drive.as_ref().filter(|_| limits.encoder_lost_s > 0.0) else {
        return LostSign::Unknown;
    };
    let DriveMode::Torque {
        equivalent_mass,
        force_constant,
        full_scale_a,
        ..
    } = drive.mode
    else {
        return LostSign::Watched;
    };
    let acceleration = limits.encoder_lost_command * full_scale_a * force_constant / equivalent_mass;
    match limits.velocity {
        Some(velocity) if acceleration > 0.0 => {
            let least_s = SLOWER * velocity / acceleration;
            if limits.encoder_lost_s < least_s {
                return LostSign::TooShort { least_s };
            }
            LostSign::Watched
        }
        _ => LostSign::Unknown,
    }
}

/// The figures from which the words are computed.
struct Words<'a> {
    axis: &'a AxisSection,
    clock: &'a ClockSection,
    limits: LimitsSection,
    /// PWM and drive; `None` on an axis with steps.
    output: Option<(&'a PwmSection, &'a Drive)>,
}

/// A value of the file that becomes a word.
struct Value {
    key: &'static str,
    found: f64,
    unit: String,
    /// LSB of the word per unit of the value.
    scale: f64,
}

impl Words<'_> {
    /// Returns `word` as an integer if it lies in the range; the error gives the range in the file's unit.
    fn fitting(&self, value: Value, word: f64, range: [u32; 2], reason: &'static str) -> Result<u32, SupervisionError> {
        let [smallest, largest] = range.map(f64::from);
        // NaN and infinity are outside every range.
        if (smallest..=largest).contains(&word) {
            return Ok(word as u32);
        }
        Err(SupervisionError::Range {
            axis: self.axis.name.clone(),
            key: value.key,
            found: value.found,
            unit: value.unit,
            smallest: readable(smallest / value.scale, f64::ceil),
            largest: readable(largest / value.scale, f64::floor),
            reason,
        })
    }

    fn ticks(&self, value: Value, ticks: f64, smallest: u32) -> Result<u16, SupervisionError> {
        let reason = "which are ticks of 16 bits";
        self.fitting(value, ticks, [smallest, u32::from(u16::MAX)], reason)
            .map(|ticks| ticks as u16)
    }

    fn seconds(&self, key: &'static str, found: f64) -> Value {
        Value {
            key,
            found,
            unit: "s".to_owned(),
            scale: self.clock.sample_hz,
        }
    }

    /// A figure in m (or rad), or in that per s², which messages show in the file's unit.
    fn quantity(&self, key: &'static str, found: f64, per: &str, scale: f64) -> Value {
        let unit = self.axis.unit;
        Value {
            key,
            found: unit.in_file(found),
            unit: format!("{unit}{per}"),
            scale: unit.to_si(scale),
        }
    }

    /// The smallest number of ticks that lasts at least this long.
    fn ticks_up(&self, key: &'static str, seconds: f64) -> Result<u16, SupervisionError> {
        let value = self.seconds(key, seconds);
        let ticks = up(seconds * value.scale);
        self.ticks(value, ticks, 0)
    }

    /// The largest number of ticks that lasts at most this long, but at least one; 0 for 0.
    fn ticks_down(&self, key: &'static str, seconds: f64) -> Result<u16, SupervisionError> {
        if seconds == 0.0 {
            return Ok(0);
        }
        let value = self.seconds(key, seconds);
        let ticks = down(seconds * value.scale);
        self.ticks(value, ticks, 1)
    }

    fn settle_ticks(&self, longest_delay_samples: u32) -> Result<u16, SupervisionError> {
        let value = Value {
            key: "axis.shaper",
            found: f64::from(longest_delay_samples),
            unit: "samples of delay".to_owned(),
            scale: 1.0,
        };
        self.ticks(value, f64::from(longest_delay_samples), 0)
    }

    /// Upper and lower soft limit, rounded inwards.
    fn soft_limits(&self) -> Result<[i32; 2], SupervisionError> {
        let Some([low, high]) = self.limits.travel.filter(|_| !self.axis.modulo) else {
            return Ok([0, 0]);
        };
        let scale = self.axis.loop_counts_per_unit() * f64::from(1u32 << POSITION_FRACTION);
        let (unit, largest) = (self.axis.unit, f64::from(SIZE_MAX));
        let words = [up(low * scale), down(high * scale)];
        for (found, word) in [low, high].into_iter().zip(words) {
            if word.abs() > largest || !word.is_finite() {
                return Err(SupervisionError::Range {
                    axis: self.axis.name.clone(),
                    key: "axis.limits.travel",
                    found: unit.in_file(found),
                    unit: unit.to_string(),
                    smallest: readable(unit.from_si(-largest / scale), f64::ceil),
                    largest: readable(unit.from_si(largest / scale), f64::floor),
                    reason: "the command's positions of 24 bits of counts",
                });
            }
        }
        let [minus, plus] = words.map(|word| word as i32);
        if minus > plus || (minus, plus) == (0, 0) {
            return Err(SupervisionError::Travel {
                axis: self.axis.name.clone(),
                unit,
                low,
                high,
                count: 1.0 / self.axis.loop_counts_per_unit(),
            });
        }
        Ok([minus, plus])
    }

    /// A limit in counts with `fraction` fraction bits; 0 where the file has none.
    fn error_limit(&self, key: &'static str, found: Option<f64>, fraction: u32) -> Result<u32, SupervisionError> {
        let reason = "which are counts in a word of 32 bits";
        found.map_or(Ok(0), |found| self.distance(key, found, fraction, SIZE_MAX, reason))
    }

    /// A distance in counts with `fraction` fraction bits, at least one LSB.
    fn distance(
        &self,
        key: &'static str,
        found: f64,
        fraction: u32,
        largest: u32,
        reason: &'static str,
    ) -> Result<u32, SupervisionError> {
        let scale = self.axis.loop_counts_per_unit() * f64::from(1u32 << fraction);
        let value = self.quantity(key, found, "", scale);
        self.fitting(value, down(found * scale), [1, largest], reason)
    }

    fn lost_command(&self) -> Result<u32, SupervisionError> {
        let Some((_, drive)) = self.output.filter(|_| self.limits.encoder_lost_s != 0.0) else {
            return Ok(0);
        };
        let part_that_is_commanded = match drive.mode {
            DriveMode::Torque {
                current_limit_a,
                full_scale_a,
                ..
            } => current_limit_a / full_scale_a,
            DriveMode::Velocity { .. } => 1.0,
        };
        let scale = full_scale(&drive.mode) * f64::from(1u32 << COMMAND_FRACTION);
        let largest = (part_that_is_commanded * scale - 2.0).clamp(0.0, f64::from(SIZE_MAX));
        let value = Value {
            key: "axis.limits.encoder_lost_command",
            found: self.limits.encoder_lost_command,
            unit: "of full scale".to_owned(),
            scale,
        };
        let reason = "the largest command of the controller";
        self.fitting(
            value,
            down(self.limits.encoder_lost_command * scale),
            [0, largest as u32],
            reason,
        )
    }

    fn filter_clocks(&self) -> Result<u8, SupervisionError> {
        let value = Value {
            key: "axis.limits.line_filter_s",
            found: self.limits.line_filter_s,
            unit: "s".to_owned(),
            scale: self.clock.frequency_hz,
        };
        let reason = "which are up to 63 clocks";
        let clocks = up(value.found * value.scale);
        self.fitting(value, clocks, [0, FILTER_CLOCKS_MAX], reason)
            .map(|clocks| clocks as u8)
    }

    fn stop_deceleration(&self) -> Result<u32, SupervisionError> {
        let (key, found) = match (self.limits.stop_deceleration, self.limits.acceleration) {
            (Some(found), _) => ("axis.limits.stop_deceleration", found),
            (None, Some(found)) => ("axis.limits.acceleration", found),
            (None, None) => return Ok(0),
        };
        let per_tick = self.axis.loop_counts_per_unit() / self.clock.sample_hz.powi(2);
        let scale = per_tick * f64::from(1u32 << ACCELERATION_FRACTION);
        let value = self.quantity(key, found, "/s²", scale);
        let reason = "with which a quick stop can slow down, in counts per tick²";
        self.fitting(value, down(found * scale), [1, DECELERATION_MAX], reason)
    }

    fn direct_limit(&self) -> u16 {
        let Some((pwm, _)) = self.output else {
            return 0;
        };
        let period = f64::from(pwm.period_clocks(self.clock));
        // The largest period has 65536 clocks, one more than the word holds.
        down(self.limits.direct_duty * period).clamp(0.0, f64::from(u16::MAX)) as u16
    }

    fn direct_hold_ticks(&self) -> Result<u16, SupervisionError> {
        match self.limits.direct_hold_s {
            Some(seconds) => self.ticks_down("axis.limits.direct_hold_s", seconds),
            None => Ok(down(DEFAULT_DIRECT_HOLD_S * self.clock.sample_hz).clamp(1.0, f64::from(u16::MAX)) as u16),
        }
    }

    fn excitation_limit(&self) -> Result<u16, SupervisionError> {
        let Some(found) = self.limits.excitation else {
            return Ok(DEFAULT_EXCITATION_COUNTS << POSITION_FRACTION);
        };
        let (key, reason) = ("axis.limits.excitation", "which are less than 256 counts");
        self.distance(key, found, POSITION_FRACTION, u16::MAX.into(), reason)
            .map(|word| word as u16)
    }
}

/// The largest whole number up to `value`, with allowance for the rounding of decimals.
fn down(value: f64) -> f64 {
    (value + DECIMALS * value.abs()).floor()
}

/// The smallest whole number from `value` on, with allowance for the rounding of decimals.
fn up(value: f64) -> f64 {
    (value - DECIMALS * value.abs()).ceil()
}

/// An end of a range with six digits, rounded into the range by `whole`, with allowance for the last digits of a
/// binary fraction.
fn readable(end: f64, whole: fn(f64) -> f64) -> f64 {
    let digits = 10f64.powf(5.0 - end.abs().log10().floor());
    let (scaled, nearest) = (end * digits, (end * digits).round());
    let is_decimal = (scaled - nearest).abs() <= 1e-12 * scaled.abs();
    let short = if is_decimal { nearest } else { whole(scaled) } / digits;
    if short.is_finite() { short } else { end }
}
