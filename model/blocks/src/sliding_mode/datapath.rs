//! The arithmetic of the controller: what each step multiplies, adds, saturates and stores.
//!
//! A step is `accumulator := base + round(operand · mantissa · 2^−shift)`; then a word may take the accumulator,
//! saturated. `multiply` and `settle` are the clocks of a step in which something happens.

use super::ports::{Law, Saturation, TickMotion};
use super::settings::{Gain, LIMIT_MAX, SettingRow};

/// Number of steps.
pub(super) const STEPS: u8 = 17;
/// The step whose setting is the limit; the sum of the integral begins with it.
pub(super) const LIMIT_STEP: u8 = 14;
/// The step that adds e to its integral.
const INTEGRAL_STEP: u8 = 15;
/// Clocks of a step that may shift by any distance: 31 bits, one per clock, and 8 more.
const STEP_CLOCKS: u8 = 39;
/// Clocks of a step that does not shift.
const SHORT_CLOCKS: u8 = 8;
/// Shift of e from Q16.16 to the integral's Q24.8.
const ERROR_SHIFT: u8 = 8;
/// Width of the fraction of the boundary layer and of the Coulomb term: Q1.25, whose range is ±1.
const FRACTION_BITS: u32 = 26;
/// Width of e before it is shifted to Q16.16.
const ERROR_BITS: u32 = 24;
const WORD_BITS: u32 = 32;
const DUTY_BITS: u32 = 18;

/// All registers that hold a number.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Datapath {
    pub(super) law: Law,
    /// Position error e, Q16.8.
    error: i32,
    error_rate: i32,
    pub(super) sliding: i32,
    /// Fraction of the boundary layer, then of the Coulomb term; Q1.25.
    fraction: i32,
    /// Sum of the feedback, Q8.24.
    feedback: i32,
    /// Integral ∫e, Q24.8.
    integral: i32,
    /// Whether the integral was cleared while its next value was being computed.
    cleared: bool,
    /// The command limit as read from the settings.
    limit: u32,
    pub(super) command: i32,
    pub(super) duty: i32,
    pub(super) limited_high: bool,
    pub(super) limited_low: bool,
    pub(super) limited_ticks: u16,
    pub(super) saturated_high: u8,
    pub(super) saturated_low: u8,
    /// Values that saturated in the last clock, high and low; they become flags in the next.
    found: (u8, u8),
    /// Whether the integral's gain and the feedback's have opposite signs.
    opposes: bool,
    /// Operand of the present step.
    operand: i32,
    /// Rounded product of the present step.
    product: i64,
    accumulator: i64,
}

/// Row of the settings that a step reads. The first three steps and that of the integral's sum read none.
pub(super) fn address(step: u8, law: Law) -> u8 {
    let linear = law != Law::SlidingMode;
    let row = match step {
        4 => SettingRow::Boundary,
        5 if linear => SettingRow::Integral,
        5 => SettingRow::Switching,
        6 if linear => SettingRow::Proportional,
        6 => SettingRow::Reaching,
        7 if linear => SettingRow::Derivative,
        7 => SettingRow::Damping,
        8 => SettingRow::Fade,
        9 => SettingRow::Coulomb,
        10 => SettingRow::Feedback,
        11 => SettingRow::Acceleration,
        12 => SettingRow::Velocity,
        13 => SettingRow::Viscous,
        LIMIT_STEP => SettingRow::Limit,
        16 => SettingRow::Duty,
        _ => SettingRow::Surface,
    };
    row as u8
}

/// Clocks of a step. A product with one is not shifted, except for e, which is shifted to its integral's format.
pub(super) fn step_clocks(step: u8) -> u8 {
    match step {
        0..=2 | LIMIT_STEP => SHORT_CLOCKS,
        INTEGRAL_STEP => SHORT_CLOCKS + ERROR_SHIFT,
        _ => STEP_CLOCKS,
    }
}

/// Clocks of a computation.
pub(super) const fn pass_clocks() -> u32 {
    (4 * SHORT_CLOCKS + SHORT_CLOCKS + ERROR_SHIFT) as u32 + (STEPS - 5) as u32 * STEP_CLOCKS as u32
}

/// Saturates `value` to `bits`, and returns whether it was above or below the range.
fn saturate(value: i64, bits: u32) -> (i32, bool, bool) {
    let half = 1 << (bits - 1);
    (value.clamp(-half, half - 1) as i32, value >= half, value < -half)
}

impl Datapath {
    /// Position error e of the last tick, Q16.16.
    pub(super) fn error_q16_16(&self) -> i32 {
        self.error << 8
    }

    /// Whether clearing the integral would change anything.
    pub(super) fn has_integral(&self) -> bool {
        self.integral != 0 || !self.cleared
    }

    /// Clears the integral. It wins over a sum in the same clock, and over one being computed.
    pub(super) fn clear_integral(&mut self) {
        self.integral = 0;
        self.cleared = true;
        self.found.0 &= !Saturation::Integral.bit();
        self.found.1 &= !Saturation::Integral.bit();
    }

    /// Begins the sum of the integral and e; a clear from now on discards it.
    pub(super) fn open_integral(&mut self) {
        self.cleared = false;
    }

    pub(super) fn clear_flags(&mut self) {
        (self.saturated_high, self.saturated_low) = (0, 0);
    }

    /// Turns the saturations of the clock before into flags.
    pub(super) fn raise_flags(&mut self) {
        let (high, low) = std::mem::take(&mut self.found);
        self.saturated_high |= high;
        self.saturated_low |= low;
    }

    /// Whether flags are about to be set.
    pub(super) fn has_found(&self) -> bool {
        self.found != (0, 0)
    }

    fn flag(&mut self, what: Saturation, (value, high, low): (i32, bool, bool)) -> i32 {
        self.found.0 |= u8::from(high) << what as u8;
        self.found.1 |= u8::from(low) << what as u8;
        value
    }

    /// Captures e in the clock of `start`.
    #[inline]
    pub(super) fn capture(&mut self, law: Law, modulo: bool, motion: &TickMotion) {
        self.law = law;
        let position = i64::from(motion.position) << 8;
        let difference = i64::from(motion.position_reference) - position;
        // Positions count modulo 2^32 counts, the references of a rotary axis modulo 2^24.
        let unused = if modulo { 32 } else { 24 };
        let nearest = (difference << unused) >> unused;
        self.error = self.flag(Saturation::Error, saturate(nearest, ERROR_BITS));
    }

    /// The operand of a step.
    fn operand(&self, step: u8, motion: &TickMotion) -> i32 {
        let sliding_mode = self.law == Law::SlidingMode;
        match step {
            0 | 8 | 12 => motion.velocity_reference,
            1 | 13 => motion.velocity,
            2 | 7 => self.error_rate,
            3 | INTEGRAL_STEP => self.error_q16_16(),
            4 => self.sliding,
            5 if self.law == Law::Pid => self.integral,
            5 if self.law == Law::Pd => 0,
            5 | 9 => self.fraction,
            6 if sliding_mode => self.sliding,
            6 => self.error_q16_16(),
            10 => self.feedback,
            11 => motion.acceleration_reference,
            LIMIT_STEP => self.integral,
            _ => self.command,
        }
    }

    /// The clock in which a step takes its operand and reads its setting.
    #[inline]
    pub(super) fn multiply(&mut self, step: u8, motion: &TickMotion, setting: u32) {
        let operand = i64::from(self.operand(step, motion));
        let gain = Gain::from_word(setting);
        let (mantissa, shift) = match step {
            0 | 2 | LIMIT_STEP => (1, 0),
            1 => (-1, 0),
            INTEGRAL_STEP => (1, u32::from(ERROR_SHIFT)),
            _ => (gain.mantissa(), gain.shift()),
        };
        // Half up: the last bit shifted out is added.
        self.product = (((operand * i64::from(mantissa)) << 1 >> shift) + 1) >> 1;
        let negative = gain.mantissa() < 0;
        match step {
            5 => self.opposes = negative,
            10 => self.opposes ^= negative,
            LIMIT_STEP => self.limit = setting & LIMIT_MAX,
            _ => {}
        }
    }

    /// The clock in which the step's sum is taken.
    #[inline]
    pub(super) fn settle(&mut self, step: u8) {
        if step == LIMIT_STEP {
            self.cut_command();
        }
        let base = match step {
            0 | 2 | 4 | 5 | 8 | 9 | LIMIT_STEP | 16 => 0,
            _ => self.accumulator,
        };
        self.accumulator = base + self.product;
        match step {
            1 => self.error_rate = self.flag(Saturation::ErrorRate, saturate(self.accumulator, WORD_BITS)),
            3 => self.sliding = self.flag(Saturation::Sliding, saturate(self.accumulator, WORD_BITS)),
            4 | 8 => self.fraction = saturate(self.accumulator, FRACTION_BITS).0,
            7 => self.feedback = self.flag(Saturation::Feedback, saturate(self.accumulator, WORD_BITS)),
            INTEGRAL_STEP => self.integrate(),
            16 => self.duty = self.flag(Saturation::Duty, saturate(self.accumulator, DUTY_BITS)),
            _ => {}
        }
    }

    /// Clamps the sum at the limit that was read.
    fn cut_command(&mut self) {
        let limit = i64::from(self.limit);
        (self.limited_high, self.limited_low) = (self.accumulator > limit, self.accumulator < -limit);
        let cut = self.accumulator.clamp(-limit, limit) as i32;
        self.command = self.flag(Saturation::Command, (cut, self.limited_high, self.limited_low));
    }

    /// Computes the integral for the next tick, frozen while it would push a clamped command further, and counts the
    /// ticks with a clamped command.
    fn integrate(&mut self) {
        let lowers = (self.error < 0) ^ self.opposes;
        let frozen = if lowers { self.limited_low } else { self.limited_high };
        if self.law == Law::Pid && !frozen && !self.cleared {
            self.integral = self.flag(Saturation::Integral, saturate(self.accumulator, WORD_BITS));
        }
        self.limited_ticks = if self.limited_high || self.limited_low {
            self.limited_ticks.saturating_add(1)
        } else {
            0
        };
    }
}
