//! Passes the deviation from a scale on to the supervisor once it has lasted: a short excursion does not stop the axis.
//!
//! The deviation exceeds its limit as for the supervisor ([`crate::axis`]): its magnitude is larger, that of a negative x being taken
//! as −x − 1. At a tick, `lasting` is the deviation if it exceeds the limit now and did so at each of the `ticks` ticks before, and 0
//! otherwise. So it has lasted for `ticks` periods of the tick; with `ticks` = 0 it is passed on at once.
//!
//! ```text
//! ticks = 2
//! tick       ‾\_____/‾\_____/‾\_____/‾\_____/‾\__
//! deviation  ---|  beyond its limit
//! lasting    0000000000000000000000000| deviation     read at the fourth tick
//! ```
//!
//! `deviation` must be stable for two clocks before the tick, as that of [`crate::linear_scale`] is. More than 65,535 ticks count as
//! that many.

use super::{Moore, clocked_block, ports, quiet_at_rest};

ports! {
    lasting_deviation_ports;

    /// The input ports.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// One clock: the tick.
        tick: Bit as bool;
        /// Difference between motor and scale.
        deviation: Signed(32) as i32;
        /// Constant: largest deviation that may last, in its unit.
        limit: Bits(32) as u32;
        /// Constant: how long a larger one may last.
        ticks: Bits(16) as u16, "ticks";
    }

    /// The output ports, all of them registers.
    outputs Outputs {
        /// The deviation once it has lasted; before, 0. Read it at the tick.
        lasting: Signed(32) as i32;
    }
}

/// The cycle-accurate model of the block.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LastingDeviation {
    /// Whether the deviation exceeded its limit one clock ago.
    beyond: bool,
    /// Consecutive ticks at which it did.
    count: u16,
    lasting: i32,
}

impl LastingDeviation {
    /// The block after reset.
    pub fn new() -> Self {
        Self::default()
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let shown = Outputs { lasting: self.lasting };
        if inputs.rst {
            *self = Self::default();
            return shown;
        }
        let size = (inputs.deviation ^ (inputs.deviation >> 31)) as u32;
        let lasts = self.beyond && self.count >= inputs.ticks;
        self.lasting = if lasts { inputs.deviation } else { 0 };
        if inputs.tick {
            self.count = if self.beyond { self.count.saturating_add(1) } else { 0 };
        }
        self.beyond = size > inputs.limit;
        shown
    }
}

impl Moore for LastingDeviation {
    fn show(&self, outputs: &mut [u64]) {
        if let [lasting] = outputs {
            *lasting = u64::from(self.lasting as u32);
        }
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        quiet_at_rest(self, inputs, |next, raw| {
            next.step(&Inputs::from_raw(raw));
        })
    }
}

clocked_block!(LastingDeviation, "the lasting deviation");

#[cfg(test)]
mod tests {
    use super::*;

    /// Plays a deviation per tick, four clocks long, and returns the ticks at which it is passed on, with its value.
    fn passed(ticks: u16, deviations: &[i32]) -> Vec<(usize, i32)> {
        let mut block = LastingDeviation::new();
        let mut found = Vec::new();
        for (at, &deviation) in deviations.iter().enumerate() {
            for clock in 0..4 {
                let shown = block.step(&Inputs {
                    tick: clock == 3,
                    deviation,
                    limit: 10,
                    ticks,
                    ..Inputs::default()
                });
                if clock == 3 && shown.lasting != 0 {
                    found.push((at, shown.lasting));
                }
            }
        }
        found
    }

    #[test]
    fn a_deviation_is_passed_on_after_exactly_its_ticks() {
        let short = [0, 11, 11, 11, 10, 11, -12, 11, 12, 13, 0];
        assert_eq!(passed(3, &short), [(8, 12), (9, 13)]);
        assert_eq!(passed(2, &short), [(3, 11), (7, 11), (8, 12), (9, 13)]);
        assert_eq!(passed(9, &short), []);
    }

    #[test]
    fn without_a_time_it_is_passed_on_at_once() {
        // The magnitude of a negative number is taken without its carry, as the supervisor does.
        assert_eq!(
            passed(0, &[10, 11, -11, -12, i32::MIN, 0]),
            [(1, 11), (3, -12), (4, i32::MIN)]
        );
    }

    #[test]
    fn the_longest_time_does_not_wrap() {
        let long = vec![20; 65_540];
        assert_eq!(passed(u16::MAX, &long).first(), Some(&(65_535, 20)));
    }
}
