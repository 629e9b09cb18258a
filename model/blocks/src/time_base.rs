//! The time base of a component that stands alone: ticks at a fixed interval, a clock counter and a tick counter.
//!
//! ```text
//! clock        0   1         T−1  T  T+1 T+2      after a reset
//! tick        ____________________/‾‾‾\_____
//! divide      ________________________/‾‾‾\_     one clock after each tick: when a divider may start
//! time_stamp  < 0>< 1>-------<T−1>< T><T+1>-     modulo 2^32
//! tick_count  ------- 0 ---------< 1 -------     modulo 2^32
//! ```
//!
//! `edge_stamp` is the lowest 24 bits of `time_stamp`, the width of the pulse counter's input. All outputs are
//! registers.

use super::divider::DividerConfig;
use super::{Moore, OutputKind, clocked_block, ports, show_each};

ports! {
    time_base_ports;

    /// The input ports.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
    }

    /// The output ports, all of them registers.
    outputs Outputs {
        /// One clock: the tick.
        tick: Bit as bool;
        /// One clock, after each tick: a divider may start.
        divide: Bit as bool;
        /// Clocks since the reset, modulo 2^32.
        time_stamp: Bits(32) as u32, "clocks";
        /// The lowest 24 bits of `time_stamp`.
        edge_stamp: Bits(24) as u32, "clocks";
        /// Ticks since the reset, modulo 2^32.
        tick_count: Bits(32) as u32, "ticks";
    }
}

/// The cycle-accurate model of the time base.
#[derive(Debug, Clone)]
pub struct TimeBase {
    tick_clocks: u32,
    phase: u32,
    tick: bool,
    divide: bool,
    time_stamp: u32,
    tick_count: u32,
}

impl TimeBase {
    /// A time base after reset, with the clocks per tick of `divider`.
    pub fn new(divider: &DividerConfig) -> Self {
        Self {
            tick_clocks: divider.tick_clocks(),
            phase: 0,
            tick: false,
            divide: false,
            time_stamp: 0,
            tick_count: 0,
        }
    }

    fn outputs(&self) -> Outputs {
        Outputs {
            tick: self.tick,
            divide: self.divide,
            time_stamp: self.time_stamp,
            edge_stamp: self.time_stamp,
            tick_count: self.tick_count,
        }
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let shown = self.outputs();
        self.clock(inputs.rst);
        shown
    }

    fn clock(&mut self, reset: bool) {
        if reset {
            (self.phase, self.time_stamp, self.tick_count) = (0, 0, 0);
            (self.tick, self.divide) = (false, false);
            return;
        }
        self.divide = self.tick;
        self.tick = self.phase + 1 == self.tick_clocks;
        self.phase = if self.tick { 0 } else { self.phase + 1 };
        self.tick_count = self.tick_count.wrapping_add(self.tick.into());
        self.time_stamp = self.time_stamp.wrapping_add(1);
    }
}

impl Moore for TimeBase {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.outputs().to_raw());
    }

    fn output_kind(&self, output: &str) -> OutputKind {
        match output {
            "time_stamp" | "edge_stamp" => OutputKind::Counter,
            _ => OutputKind::Register,
        }
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        if inputs[0] & 1 != 0 || self.tick || self.divide {
            return 0;
        }
        u64::from(self.tick_clocks - 1 - self.phase)
    }

    fn pass(&mut self, _inputs: &[u64], clocks: u64) {
        self.phase += clocks as u32;
        self.time_stamp = self.time_stamp.wrapping_add(clocks as u32);
    }
}

clocked_block!(TimeBase, "the time base");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ClockedBlock;

    #[test]
    fn ticks_come_at_their_distance_and_count() {
        let mut time_base = TimeBase::new(&DividerConfig::new(7).unwrap());
        for clock in 0..100u64 {
            let mut outputs = [0; 5];
            ClockedBlock::step(&mut time_base, &[0], &mut outputs).unwrap();
            let after = |clocks: u64| u64::from(clock >= clocks && (clock - clocks).is_multiple_of(7));
            assert_eq!(outputs, [after(7), after(8), clock, clock, clock / 7]);
        }
    }
}
