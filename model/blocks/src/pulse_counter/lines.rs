//! Synchronises and filters a line from its pins.

use super::ports::Inputs;
use crate::FOREVER;

/// Takes a new level once it has lasted for more than `filter_clocks` clocks.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct GlitchFilter {
    level: bool,
    /// Clocks that the input must still differ from the level to pass; it starts from `filter_clocks` of the clock
    /// before it differed.
    left: u8,
}

impl GlitchFilter {
    pub(crate) fn level(&self) -> bool {
        self.level
    }

    /// Simulates one clock. Until `ready`, the level follows the input.
    pub(crate) fn clock(&mut self, input: bool, filter_clocks: u8, ready: bool) {
        let passes = !ready || self.left == 0;
        if input != self.level && !passes {
            self.left -= 1;
            return;
        }
        self.level = input;
        self.left = filter_clocks & 63;
    }

    /// Number of clocks with this input, if ready, in which the filter only counts.
    pub(super) fn quiet_clocks(&self, input: bool, filter_clocks: u8) -> u64 {
        match input == self.level {
            false => self.left.into(),
            true if self.left == filter_clocks & 63 => FOREVER,
            true => 0,
        }
    }

    pub(super) fn pass(&mut self, input: bool, clocks: u64) {
        if input != self.level {
            self.left -= clocks as u8;
        }
    }
}

/// One line: pin and complement with two flip-flops each, and the filter.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Line {
    pin: [bool; 2],
    complement: [bool; 2],
    filter: GlitchFilter,
}

impl Line {
    pub(super) fn level(&self) -> bool {
        self.filter.level()
    }

    /// Whether the two lines of a differential pair are equal, which is invalid.
    pub(super) fn disagrees(&self, differential: bool) -> bool {
        differential && self.pin[1] == self.complement[1]
    }

    pub(super) fn clock(&mut self, pin: bool, complement: bool, inputs: &Inputs, ready: bool) {
        let says = self.says(inputs.differential);
        self.filter.clock(says, inputs.filter_clocks, ready);
        self.pin = [pin, self.pin[0]];
        self.complement = [complement, self.complement[0]];
    }

    fn says(&self, differential: bool) -> bool {
        if self.disagrees(differential) {
            self.level()
        } else {
            self.pin[1]
        }
    }

    /// As [`GlitchFilter::quiet_clocks`].
    pub(super) fn quiet_clocks(&self, pin: bool, complement: bool, inputs: &Inputs) -> u64 {
        if (self.pin, self.complement) != ([pin; 2], [complement; 2]) {
            return 0;
        }
        self.filter
            .quiet_clocks(self.says(inputs.differential), inputs.filter_clocks)
    }

    pub(super) fn pass(&mut self, inputs: &Inputs, clocks: u64) {
        self.filter.pass(self.says(inputs.differential), clocks);
    }
}
