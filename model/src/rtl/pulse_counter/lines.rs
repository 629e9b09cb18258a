//! A line from its pins to a clean level.

use super::ports::Inputs;
use crate::rtl::FOREVER;

/// Takes a new level once it has stood for more than `filter_clocks` clocks.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(in crate::rtl) struct GlitchFilter {
    level: bool,
    /// Clocks that the input must differ from the level until it passes; `filter_clocks` as of the clock before it differed.
    left: u8,
}

impl GlitchFilter {
    pub(in crate::rtl) fn level(&self) -> bool {
        self.level
    }

    /// One clock. Until `ready`, the level follows the input.
    pub(in crate::rtl) fn clock(&mut self, input: bool, filter_clocks: u8, ready: bool) {
        let passes = !ready || self.left == 0;
        if input != self.level && !passes {
            self.left -= 1;
            return;
        }
        self.level = input;
        self.left = filter_clocks & 63;
    }

    /// Clocks with this input that only count, if it is ready.
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

/// One line: pin and complement through two flip-flops each, then the filter.
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

    /// A pair whose two lines are equal says nothing.
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
