//! The sequential divider that turns counts and clocks into velocities: `quotient = steps · T · 2^16 / elapsed`.
//!
//! The datasheet is `docs/divider.md`; the hardware is compared with this reference model.
//!
//! - `steps`: counts, 18 bits, two's complement; `elapsed`: the clocks in which they came, 24 bits; `T`: clocks per
//!   tick, fixed when the divider is built; `quotient`: Q16.16 counts per tick, truncated toward zero, clamped to
//!   ±(2^31 − 1) LSB.
//! - `elapsed` = 0 stands for one tick: the quotient is then exactly `steps · 2^16`.
//! - Every division takes [`DIVISION_CLOCKS`]. One divider serves all channels of a stage in turn.
//!
//! ```text
//! clock     0   1   2            100 101 102
//! start    ‾‾‾\______________________________
//! steps    < n >-----------------------------
//! busy     ___/‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾\_______
//! done     __________________________/‾‾‾\___
//! quotient ------- as before --------< q ----
//! ```
//!
//! ```
//! use posicast_blocks::divider::{DIVISION_CLOCKS, Divider, DividerConfig, Inputs};
//!
//! // 3 counts in 7500 clocks of 5000 per tick: 2 counts per tick.
//! let config = DividerConfig::new(5000)?;
//! assert_eq!(config.divide(3, 7500), (2 << 16, false));
//!
//! let mut divider = Divider::new(&config);
//! divider.step(&Inputs { start: true, steps: 3, elapsed: 7500, ..Inputs::default() });
//! let waited = (1..200).find(|_| divider.step(&Inputs::default()).done);
//! assert_eq!((waited, divider.outputs().quotient), (Some(DIVISION_CLOCKS), 2 << 16));
//! # Ok::<(), posicast_blocks::divider::DividerConfigError>(())
//! ```

use super::shaper::wrap;
use super::{FOREVER, Moore, clocked_block, ports, show_each};

/// Width of `steps` in bits.
pub const STEP_BITS: u32 = 18;
/// Width of `elapsed` in bits.
pub const ELAPSED_BITS: u32 = 24;
/// Width of the clocks per tick in bits.
pub const TICK_BITS: u32 = 17;
/// Largest magnitude of the quotient, which has 32 bits.
pub const QUOTIENT_MAX: i64 = (1 << 31) - 1;
/// Clocks from `start` to `done`: 1 for the start, 18 to multiply, 51 to divide and 32 for the sign.
pub const DIVISION_CLOCKS: u32 = 102;

/// Build parameters of a divider.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DividerConfig {
    tick_clocks: u32,
}

/// Why a divider cannot be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum DividerConfigError {
    /// The clocks per tick are 0 or too many.
    #[error("{0} clocks per tick: the divider is built for 1 to 131071; choose a higher sample rate or a slower clock")]
    TickClocks(u64),
}

impl DividerConfig {
    /// A divider for ticks of this many clocks.
    ///
    /// # Errors
    /// [`DividerConfigError`] unless it is 1 to 2^17 − 1.
    pub fn new(tick_clocks: u64) -> Result<Self, DividerConfigError> {
        match u32::try_from(tick_clocks) {
            Ok(fits) if (1..1 << TICK_BITS).contains(&fits) => Ok(Self { tick_clocks: fits }),
            _ => Err(DividerConfigError::TickClocks(tick_clocks)),
        }
    }

    /// Clocks per tick T.
    pub fn tick_clocks(&self) -> u32 {
        self.tick_clocks
    }

    /// The quotient, and whether it was clamped, computed at once instead of clock by clock. Operands are cut to
    /// their widths.
    pub fn divide(&self, steps: i32, elapsed: u32) -> (i64, bool) {
        let steps = wrap(i64::from(steps), STEP_BITS);
        let tick = u64::from(self.tick_clocks);
        let divisor = match u64::from(elapsed) & ((1 << ELAPSED_BITS) - 1) {
            0 => tick,
            clocks => clocks,
        };
        // The product has 18 + 17 + 16 bits and does not overflow.
        let quotient = ((steps.unsigned_abs() * tick) << 16) / divisor;
        let clamped = quotient.min(QUOTIENT_MAX as u64);
        (clamped as i64 * steps.signum(), clamped != quotient)
    }
}

ports! {
    divider_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset, active high.
        rst: Bit as bool;
        /// One clock: starts the division of `steps` by `elapsed`.
        start: Bit as bool;
        /// Dividend: the change of the count.
        steps: Signed(18) as i32, "counts";
        /// Divisor: the time in which the count changed by this; 0 stands for one tick.
        elapsed: Bits(24) as u32, "clocks";
        /// Clears `overrun`.
        clear_flags: Bit as bool;
    }

    /// The output ports, all of them registers.
    outputs Outputs {
        /// Counts per tick, Q16.16; holds its value until the next `done`.
        quotient: Signed(32) as i64, "counts per tick, Q16.16";
        /// One clock: `quotient` is new.
        done: Bit as bool;
        /// A division is running.
        busy: Bit as bool;
        /// `quotient` was clamped; changes with it.
        saturated: Bit as bool;
        /// Sticky: a `start` came while `busy` and was ignored. Setting wins over `clear_flags` in the same clock.
        overrun: Bit as bool;
    }
}

/// The cycle-accurate model of the divider.
pub struct Divider {
    config: DividerConfig,
    /// Clocks until the division has its result; 0 while none is running.
    clocks_left: u32,
    result: (i64, bool),
    shown: Outputs,
}

impl Divider {
    /// A divider after reset.
    pub fn new(config: &DividerConfig) -> Self {
        Self {
            config: *config,
            clocks_left: 0,
            result: (0, false),
            shown: Outputs::default(),
        }
    }

    /// The outputs in this clock.
    pub fn outputs(&self) -> Outputs {
        self.shown
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    #[inline]
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let shown = self.shown;
        if inputs.rst {
            self.clocks_left = 0;
            self.shown = Outputs::default();
            return shown;
        }
        if inputs.clear_flags {
            self.shown.overrun = false;
        }
        self.shown.done = self.clocks_left == 1;
        if self.shown.done {
            (self.shown.quotient, self.shown.saturated) = self.result;
        }
        self.clocks_left = self.clocks_left.saturating_sub(1);
        if inputs.start && !shown.busy {
            self.result = self.config.divide(inputs.steps, inputs.elapsed);
            self.clocks_left = DIVISION_CLOCKS - 1;
        }
        self.shown.overrun |= inputs.start && shown.busy;
        self.shown.busy = self.clocks_left > 0;
        shown
    }
}

clocked_block!(Divider, "the divider");

impl Moore for Divider {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.outputs().to_raw());
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        let &[rst, start, _, _, clear_flags] = inputs else {
            return 0;
        };
        let clears = clear_flags & 1 != 0 && self.shown.overrun;
        if rst & 1 != 0 || start & 1 != 0 || clears || self.shown.done {
            return 0;
        }
        match self.clocks_left {
            0 => FOREVER,
            left => u64::from(left - 1),
        }
    }

    fn pass(&mut self, _inputs: &[u64], clocks: u64) {
        if self.clocks_left > 0 {
            self.clocks_left -= clocks as u32;
        }
    }

    fn ignores(&self, input: &str) -> bool {
        matches!(input, "steps" | "elapsed")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn truncation_is_toward_zero_on_both_sides() {
        let config = DividerConfig::new(3).unwrap();
        // 3 · 2^16 / 7 = 28086.857…
        assert_eq!(config.divide(1, 7), (28086, false));
        assert_eq!(config.divide(-1, 7), (-28086, false));
        assert_eq!(config.divide(0, 7), (0, false));
    }

    #[test]
    fn no_time_is_one_tick() {
        for tick in [1, 5000, 131_071] {
            let config = DividerConfig::new(tick).unwrap();
            assert_eq!(config.divide(-7, 0), (-7 << 16, false));
            assert_eq!(config.divide(32767, 0), (32767 << 16, false));
            assert_eq!(config.divide(-32768, 0), (-QUOTIENT_MAX, true));
        }
    }

    #[test]
    fn the_ends_saturate() {
        let config = DividerConfig::new(131_071).unwrap();
        assert_eq!(config.divide(-131_072, 1), (-QUOTIENT_MAX, true));
        assert_eq!(config.divide(131_071, 1), (QUOTIENT_MAX, true));
        assert_eq!(config.divide(1, 0xff_ffff), (511, false));
    }

    #[test]
    fn ticks_that_do_not_fit_are_named() {
        for found in [0, 131_072, u64::MAX] {
            assert_eq!(DividerConfig::new(found), Err(DividerConfigError::TickClocks(found)));
        }
    }
}
