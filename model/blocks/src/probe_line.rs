//! The line of a probe: polarity, synchroniser and filter, in front of the pulse counter's index.
//!
//! `touched` follows the line after `filter_clocks` + [`PROBE_CLOCKS`] clocks, once it has had its new level for more than
//! `filter_clocks` clocks. In the first clocks after a reset it follows without the filter.
//!
//! ```text
//! filter_clocks = 2
//! probe    ___/‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾
//! touched  ______________________/‾‾‾      5 clocks later
//! ```

use super::pulse_counter::GlitchFilter;
use super::{Moore, clocked_block, ports, quiet_at_rest};

/// Clocks from the line to `touched` without a filter: two for the synchroniser, one for the filter.
pub const PROBE_CLOCKS: u32 = 3;
/// Clocks after a reset without the filter.
const PRIMING_CLOCKS: u8 = 4;

ports! {
    probe_line_ports;

    /// The input ports.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// Asynchronous line of the probe.
        probe: Bit as bool;
        /// Constant; high: the line is low while the probe touches.
        active_low: Bit as bool;
        /// Constant: longest pulse that is ignored.
        filter_clocks: Bits(6) as u8, "clocks";
    }

    /// The output ports, all of them registers.
    outputs Outputs {
        /// The probe touches.
        touched: Bit as bool;
    }
}

/// The cycle-accurate model of the line.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ProbeLine {
    synchroniser: [bool; 2],
    filter: GlitchFilter,
    primed: u8,
}

impl ProbeLine {
    /// The line after reset.
    pub fn new() -> Self {
        Self::default()
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let shown = Outputs {
            touched: self.filter.level(),
        };
        if inputs.rst {
            *self = Self::default();
            return shown;
        }
        let filters = self.primed == PRIMING_CLOCKS && inputs.filter_clocks != 0;
        self.filter.clock(self.synchroniser[1], inputs.filter_clocks, filters);
        self.synchroniser = [inputs.probe != inputs.active_low, self.synchroniser[0]];
        self.primed = (self.primed + 1).min(PRIMING_CLOCKS);
        shown
    }
}

impl Moore for ProbeLine {
    fn show(&self, outputs: &mut [u64]) {
        if let [touched] = outputs {
            *touched = self.filter.level().into();
        }
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        quiet_at_rest(self, inputs, |next, raw| {
            next.step(&Inputs::from_raw(raw));
        })
    }
}

clocked_block!(ProbeLine, "the probe's line");

#[cfg(test)]
mod tests {
    use super::*;

    /// Clocks from a change of the line until `touched` follows, within 80.
    fn delay(active_low: bool, filter_clocks: u8, lasts: usize) -> Option<usize> {
        let mut line = ProbeLine::new();
        let inputs = |touches: bool| Inputs {
            probe: touches != active_low,
            active_low,
            filter_clocks,
            ..Inputs::default()
        };
        for _ in 0..10 {
            assert!(!line.step(&inputs(false)).touched);
        }
        (0..80).find(|clock| line.step(&inputs(*clock < lasts)).touched)
    }

    #[test]
    fn a_contact_that_lasts_is_seen_in_either_polarity() {
        for active_low in [false, true] {
            assert_eq!(delay(active_low, 0, 1), Some(3));
            assert_eq!(delay(active_low, 8, 40), Some(11));
            assert_eq!(delay(active_low, 8, 9), Some(11));
            assert_eq!(delay(active_low, 8, 8), None);
            assert_eq!(delay(active_low, 63, 70), Some(66));
        }
    }

    #[test]
    fn a_line_that_stays_through_a_reset_is_known_without_the_filter() {
        let mut line = ProbeLine::new();
        let touches = Inputs {
            probe: true,
            filter_clocks: 63,
            ..Inputs::default()
        };
        for rst in [false, false, false, true] {
            line.step(&Inputs { rst, ..touches });
        }
        let shown = [0; 5].map(|_| line.step(&touches).touched);
        assert_eq!(shown, [false, false, false, true, true]);
    }
}
