//! The ideal time of every step: where the straight line between two samples passes the middle between two steps.
//!
//! At a tick the steps are the position, rounded half up. On the way from one sample to the next, a step up belongs to
//! the moment at which the line comes to k − 1/2, a step down to that at which it falls below. All of it is exact.

use super::StepGeneratorConfig;

/// A step between two ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct IdealStep {
    /// Up or down.
    pub up: bool,
    /// Time since the first tick in clocks: this, divided by `divisor`.
    pub dividend: u64,
    /// See `dividend`.
    pub divisor: u64,
}

impl IdealStep {
    /// The clock, counted from the first tick, at whose end the hardware demands the step: the first in which the line has
    /// come to the middle, or, going down, has passed it.
    pub fn demanded_clocks(&self) -> u64 {
        if self.up {
            self.dividend.div_ceil(self.divisor)
        } else {
            self.dividend / self.divisor + 1
        }
    }
}

/// The position in whole steps, rounded half up.
pub fn rounded_steps(position: i64, fraction_bits: u32) -> i64 {
    match fraction_bits {
        0 => position,
        bits => (position + (1 << (bits - 1))) >> bits,
    }
}

/// The steps from a tick with position `from` to the next one with `to`, in their order.
pub fn ideal_steps(config: &StepGeneratorConfig, from: i64, to: i64) -> impl Iterator<Item = IdealStep> {
    let bits = config.fraction_bits();
    let tick_clocks = u64::from(config.tick_clocks());
    let [first, last] = [from, to].map(|position| rounded_steps(position, bits));
    let up = to >= from;
    let divisor = 2 * from.abs_diff(to);
    (0..first.abs_diff(last)).map(move |index| {
        let passed = index as i64;
        // Twice the position of the middle that is passed.
        let middle = if up {
            (2 * (first + passed) + 1) << bits
        } else {
            (2 * (first - passed) - 1) << bits
        };
        IdealStep {
            up,
            dividend: (2 * from).abs_diff(middle) * tick_clocks,
            divisor,
        }
    })
}
