//! Computes the pattern and the edges of a half period from a duty, with one adder.
//!
//! The accumulator holds four times the number of clocks from the edge and counts them, so that its sign is the
//! level. In the 16 clocks before a boundary it computes the values of the next half instead. The table of steps is
//! in `posicast_hdl::pwm`'s `command`.

use super::ports::{BridgeMode, Inputs};

/// The step in which a valley's command is read; a peak's is read in step 0.
const READ_STEP: u8 = 16;
/// The last step: the boundary is in the next clock.
const LAST_STEP: u8 = 31;
/// Step in which a peak without a command takes the dead time from the count, and makes up for the clocks that are
/// missing.
const RESUME_STEP: u8 = 27;

/// Bits of the accumulator.
const BITS: u32 = 19;
/// Increment per clock.
const COUNT: i32 = 4;

/// Settings in use, and position of the carrier.
#[derive(Debug, Clone, Copy)]
pub(super) struct Surroundings {
    pub(super) period: i32,
    pub(super) dead_time: u16,
    pub(super) minimum_pulse: u16,
    pub(super) valley_lead: bool,
    pub(super) peak_lead: bool,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Command {
    /// Clocks since the lead, plus 16 at a peak; 0 between the boundaries.
    pub(super) step: u8,
    /// Whether the accumulator is computing, or counts what remains of its result.
    pub(super) works: bool,
    /// Number of the computation, 1 to 15; 0 between computations.
    slot: u8,
    /// Whether the half that is computed, and then counted, has the rising edge.
    pub(super) rises: bool,
    takes: bool,
    pub(super) mode: BridgeMode,
    duty: i32,
    /// The accumulator, of 19 bits.
    pub(super) accumulator: i32,
    early: u8,
    pub(super) level: bool,
    limited: bool,
    pub(super) too_short: bool,
    pub(super) too_long: bool,
}

/// Use of the sum of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Fate {
    Kept,
    /// Only the sign of the sum is used.
    Seen,
}

impl Command {
    /// Whether a boundary comes with this clock.
    pub(super) fn ends(&self) -> bool {
        self.step == LAST_STEP
    }

    pub(super) fn updates(&self) -> bool {
        self.ends() && self.takes
    }

    pub(super) fn negative(&self) -> bool {
        self.duty < 0
    }

    pub(super) fn saturated(&self) -> bool {
        self.limited
    }

    #[inline]
    pub(super) fn clock(&mut self, inputs: &Inputs, around: &Surroundings) {
        let begins_valley = self.step == READ_STEP;
        let begins = begins_valley || (around.peak_lead && !around.valley_lead);
        let taking = begins && (begins_valley || inputs.update_at_peak);
        let resumes = self.step == RESUME_STEP && !self.takes;
        let ends = self.ends();

        let (addend, fate) = self.addend(inputs, around, resumes);
        let sum = (self.accumulator + addend) << (32 - BITS) >> (32 - BITS);
        let under = sum < 0;

        let slot = self.slot;
        match slot {
            2 => self.limited = !under,
            3 => self.limited |= !under,
            4 => self.limited |= self.one_sided(),
            _ => {}
        }
        if slot == if self.rises { 7 } else { 14 } && self.takes {
            self.too_short = under;
        }
        if slot == if self.rises { 12 } else { 9 } {
            self.too_long = !under;
        }
        if !self.works || ends {
            self.level = !under;
        } else if self.early == self.step & 15 {
            self.level = !self.rises;
        }
        if begins {
            let mirror = if self.rises { 15 } else { 0 };
            self.early = (self.accumulator >> 2 & 15) as u8 ^ mirror;
        }
        if taking || slot == 3 {
            self.accumulator = 0;
        } else if fate == Fate::Kept {
            self.accumulator = sum;
        }

        self.works = begins || (self.works && !ends && (self.rises || slot != 15));
        self.slot = match (taking, resumes, slot) {
            (true, ..) => 1,
            (_, true, _) => 12,
            (.., 0 | 15) => 0,
            _ => slot + 1,
        };
        if begins {
            (self.rises, self.takes) = (begins_valley, taking);
        }
        if taking {
            (self.mode, self.duty) = (BridgeMode::from_register(inputs.mode), inputs.duty);
        }
        self.step = match (around.valley_lead, around.peak_lead, self.step) {
            (true, ..) => 1,
            (_, true, _) => READ_STEP + 1,
            (.., 0 | LAST_STEP) => 0,
            (.., step) => step + 1,
        };
    }

    /// Advances by this many clocks in which it only counts.
    #[inline]
    pub(super) fn count(&mut self, clocks: u16) {
        let steps = i32::from(clocks) * COUNT;
        self.accumulator += if self.rises { steps } else { -steps };
    }

    /// Number of clocks that only count and in which the level stays.
    pub(super) fn same_level(&self) -> u16 {
        let from_least = self.accumulator + (1 << (BITS - 1));
        let left = match (self.rises, self.accumulator < 0) {
            (true, true) => -1 - self.accumulator,
            (true, false) => (1 << (BITS - 1)) - 1 - self.accumulator,
            (false, true) => from_least,
            (false, false) => self.accumulator,
        };
        u16::try_from(left / COUNT).unwrap_or(u16::MAX)
    }

    fn one_sided(&self) -> bool {
        self.mode == BridgeMode::HalfBridge && self.duty < 0
    }

    /// The limited duty; its magnitude where the mode does not use the sign.
    fn limited_duty(&self, inputs: &Inputs) -> i32 {
        let size = if self.limited {
            i32::from(inputs.max_duty)
        } else {
            self.duty.abs()
        };
        match self.mode {
            BridgeMode::Locked => size * self.duty.signum(),
            _ => size,
        }
    }

    #[inline]
    fn addend(&self, inputs: &Inputs, around: &Surroundings, resumes: bool) -> (i32, Fate) {
        let counts = !self.works || (!self.takes && self.slot < 12);
        if counts {
            return match (self.works || self.rises, resumes) {
                (true, true) => (5 * COUNT, Fate::Kept),
                (true, false) => (COUNT, Fate::Kept),
                (false, _) => (-COUNT, Fate::Kept),
            };
        }
        let (period, dead, pulse) = (
            around.period,
            2 * i32::from(around.dead_time),
            2 * i32::from(around.minimum_pulse),
        );
        let load = if self.one_sided() {
            (0, Fate::Seen)
        } else {
            (self.limited_duty(inputs), Fate::Kept)
        };
        match (self.slot, self.rises) {
            (1, _) => (self.duty.abs(), Fate::Kept),
            (2, _) => (-i32::from(inputs.max_duty) - 1, Fate::Seen),
            (3, _) => (-period - 1, Fate::Seen),
            (4, _) => load,
            (5, _) => match self.mode {
                BridgeMode::Locked => (period, Fate::Kept),
                _ => load,
            },
            (6, true) | (12 | 13, false) => (-dead, Fate::Kept),
            (7, true) | (14, false) => (-pulse, Fate::Seen),
            (8 | 11, true) | (8, false) => (dead, Fate::Kept),
            (9 | 10, true) | (6 | 7, false) => (-period - 1, Fate::Kept),
            (12, true) | (9, false) => (pulse, Fate::Seen),
            (13, true) => (2 + 2 * (period & 1), Fate::Kept),
            (10 | 11, false) => (period + 1, Fate::Kept),
            (15, false) => (-2, Fate::Kept),
            _ => (0, Fate::Seen),
        }
    }
}
