//! The arithmetic of a pass: what each step multiplies, adds up, cuts to its word and keeps.
//!
//! A step is `accumulator := base + round(operand · mantissa · 2^−shift)`, then perhaps a word takes the accumulator,
//! saturated. `fetch`, `multiply`, `add` and `settle` are the clocks of a step at which something happens; `cut_command` is
//! one more, of step 11.

use super::ports::{Law, Motion, Saturation};
use super::settings::{Gain, LIMIT_MAX, Row};

/// Steps of a pass.
pub(super) const STEPS: u8 = 13;
/// The step that has a limit for its setting.
pub(super) const LIMIT_STEP: u8 = 11;
/// Bits of the boundary layer's and the Coulomb term's fraction: Q1.25, so that ±1 is its range.
const FRACTION_BITS: u32 = 26;
/// Bits of e before it is shifted to Q16.16.
const ERROR_BITS: u32 = 24;
const WORD_BITS: u32 = 32;
const DUTY_BITS: u32 = 18;

/// Everything that holds a number.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Datapath {
    pub(super) law: Law,
    /// e, Q16.8.
    error: i32,
    error_rate: i32,
    pub(super) sliding: i32,
    /// Of the boundary layer, then of the Coulomb term; Q1.25.
    fraction: i32,
    /// Q8.24.
    feedback: i32,
    /// ∫e, Q24.8.
    integral: i32,
    /// The largest command, as read.
    limit: u32,
    pub(super) command: i32,
    pub(super) duty: i32,
    pub(super) limited_high: bool,
    pub(super) limited_low: bool,
    pub(super) limited_ticks: u16,
    pub(super) saturated_high: u8,
    pub(super) saturated_low: u8,
    /// What was cut in the last clock, high and low: flags of the next.
    found: (u8, u8),
    /// The integral's gain and the feedback's have opposite signs.
    opposes: bool,
    /// What the running step multiplies.
    operand: i32,
    /// Rounded product of the running step.
    product: i64,
    accumulator: i64,
}

/// Row of the settings that a step reads.
pub(super) fn address(step: u8, law: Law) -> u8 {
    match (step, law) {
        (2..=4, Law::Pd | Law::Pid) => step - 2 + Row::Derivative as u8,
        _ => step,
    }
}

/// `value` in `bits`, and whether it was cut above or below.
fn saturate(value: i64, bits: u32) -> (i32, bool, bool) {
    let half = 1 << (bits - 1);
    (value.clamp(-half, half - 1) as i32, value >= half, value < -half)
}

impl Datapath {
    /// e of the last tick, Q16.16.
    pub(super) fn error_q16_16(&self) -> i32 {
        self.error << 8
    }

    pub(super) fn has_integral(&self) -> bool {
        self.integral != 0
    }

    pub(super) fn clear_integral(&mut self) {
        self.integral = 0;
    }

    pub(super) fn clear_flags(&mut self) {
        (self.saturated_high, self.saturated_low) = (0, 0);
    }

    /// What was cut in the clock before becomes flags.
    pub(super) fn raise_flags(&mut self) {
        let (high, low) = std::mem::take(&mut self.found);
        self.saturated_high |= high;
        self.saturated_low |= low;
    }

    /// Flags are about to rise.
    pub(super) fn has_found(&self) -> bool {
        self.found != (0, 0)
    }

    fn flag(&mut self, what: Saturation, (value, high, low): (i32, bool, bool)) -> i32 {
        self.found.0 |= u8::from(high) << what as u8;
        self.found.1 |= u8::from(low) << what as u8;
        value
    }

    /// The clock of `start`: e and de.
    #[inline]
    pub(super) fn capture(&mut self, law: Law, modulo: bool, motion: &Motion) {
        self.law = law;
        let position = i64::from(motion.position) << 8;
        let difference = i64::from(motion.position_reference) - position;
        // Positions count modulo 2^32 counts, references of a rotary axis modulo 2^24.
        let unused = if modulo { 32 } else { 24 };
        let nearest = (difference << unused) >> unused;
        self.error = self.flag(Saturation::Error, saturate(nearest, ERROR_BITS));
        let rate = i64::from(motion.velocity_reference) - i64::from(motion.velocity);
        self.error_rate = self.flag(Saturation::ErrorRate, saturate(rate, WORD_BITS));
    }

    /// The clock in which a step takes what it multiplies.
    #[inline]
    pub(super) fn fetch(&mut self, step: u8, motion: &Motion) {
        let sliding_mode = self.law == Law::SlidingMode;
        self.operand = match step {
            0 => self.error_q16_16(),
            1 => self.sliding,
            2 => self.error_rate,
            3 if sliding_mode => self.sliding,
            3 => self.error_q16_16(),
            4 if self.law == Law::Pid => self.integral,
            4 if self.law == Law::Pd => 0,
            4 | 10 => self.fraction,
            5 | 8 => motion.velocity_reference,
            6 => self.feedback,
            7 => motion.acceleration_reference,
            9 => motion.velocity,
            _ => self.command,
        };
    }

    /// The clock in which a step reads its setting.
    #[inline]
    pub(super) fn multiply(&mut self, step: u8, setting: u32) {
        let gain = Gain::from_word(setting);
        let exact = i64::from(self.operand) * i64::from(gain.mantissa());
        // Half up: the last bit shifted out is added.
        self.product = ((exact << 1 >> gain.shift()) + 1) >> 1;
        let negative = gain.mantissa() < 0;
        match step {
            4 => self.opposes = negative,
            6 => self.opposes ^= negative,
            LIMIT_STEP => self.limit = setting & LIMIT_MAX,
            _ => {}
        }
    }

    /// The clock in which the command is cut at the limit read.
    pub(super) fn cut_command(&mut self) {
        let limit = i64::from(self.limit);
        (self.limited_high, self.limited_low) = (self.accumulator > limit, self.accumulator < -limit);
        let cut = self.accumulator.clamp(-limit, limit) as i32;
        self.command = self.flag(Saturation::Command, (cut, self.limited_high, self.limited_low));
    }

    /// The clock in which a step adds.
    #[inline]
    pub(super) fn add(&mut self, step: u8) {
        let base = match step {
            0 => i64::from(self.error_rate),
            1 | 2 | 5 | 6 | 12 => 0,
            _ => self.accumulator,
        };
        self.accumulator = base + self.product;
    }

    /// The last clock of a step.
    #[inline]
    pub(super) fn settle(&mut self, step: u8) {
        match step {
            0 => self.sliding = self.flag(Saturation::Sliding, saturate(self.accumulator, WORD_BITS)),
            1 | 5 => self.fraction = saturate(self.accumulator, FRACTION_BITS).0,
            4 => self.feedback = self.flag(Saturation::Feedback, saturate(self.accumulator, WORD_BITS)),
            LIMIT_STEP => self.integrate(),
            12 => self.duty = self.flag(Saturation::Duty, saturate(self.accumulator, DUTY_BITS)),
            _ => {}
        }
    }

    /// The integral of the next tick, frozen while it would push a cut command further; and how long it has been cut.
    fn integrate(&mut self) {
        let lowers = (self.error < 0) ^ self.opposes;
        let frozen = if lowers { self.limited_low } else { self.limited_high };
        if self.law == Law::Pid && !frozen {
            let sum = i64::from(self.integral) + i64::from(self.error);
            self.integral = self.flag(Saturation::Integral, saturate(sum, WORD_BITS));
        }
        self.limited_ticks = if self.limited_high || self.limited_low {
            self.limited_ticks.saturating_add(1)
        } else {
            0
        };
    }
}
