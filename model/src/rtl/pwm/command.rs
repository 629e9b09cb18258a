//! From a duty to a width, in two clocks: what the pipeline before the boundary does.

use super::ports::{Inputs, Mode};

/// After the first clock: the duty, limited.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Limited {
    mode: Mode,
    negative: bool,
    magnitude: u16,
    limited: bool,
}

/// After the second clock: the width of the high side's pulse.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Width {
    pub(super) mode: Mode,
    pub(super) negative: bool,
    /// Duty of the leg less the dead time, clocks; any sign, 18 bits.
    pub(super) clocks: i32,
    pub(super) saturated: bool,
}

impl Limited {
    #[inline]
    pub(super) fn new(inputs: &Inputs) -> Self {
        let mode = Mode::from_register(inputs.mode);
        let negative = inputs.duty < 0;
        let over = inputs.duty.unsigned_abs() > u32::from(inputs.max_duty);
        let one_sided = mode == Mode::HalfBridge && negative;
        Self {
            mode,
            negative,
            magnitude: match (one_sided, over) {
                (true, _) => 0,
                (false, true) => inputs.max_duty,
                (false, false) => inputs.duty.unsigned_abs() as u16,
            },
            limited: over || one_sided,
        }
    }
}

impl Width {
    /// In locked antiphase, leg A has the duty (period + duty) / 2.
    #[inline]
    pub(super) fn new(from: &Limited, period: u16, dead_time: u16) -> Self {
        let (magnitude, dead) = (i32::from(from.magnitude), i32::from(dead_time));
        Self {
            mode: from.mode,
            negative: from.negative,
            clocks: match (from.mode, from.negative) {
                (Mode::Locked, false) => (i32::from(period) - 2 * dead + magnitude) >> 1,
                (Mode::Locked, true) => (i32::from(period) - 2 * dead - magnitude) >> 1,
                _ => magnitude - dead,
            },
            saturated: from.limited || from.magnitude > period,
        }
    }
}
