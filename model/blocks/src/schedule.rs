//! The schedule starts the controllers of a stage a fixed number of clocks after each tick.
//!
//! ```text
//! clock    0   1   2         C   C+1
//! tick    ‾‾‾\__________________________
//! control ___________________/‾‾‾\______
//! ```
//!
//! Shapers and divider take different times from tick to tick, depending on their tables. The controllers start when
//! the longest of these times is over, always in the same clock after the tick. A tick that comes earlier begins
//! anew.

use super::{FOREVER, Moore, clocked_block, ports};

/// Width of the counter in bits.
pub const SCHEDULE_BITS: u32 = 17;

/// Build parameter of a schedule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ScheduleConfig {
    control_clocks: u32,
}

/// Why a schedule cannot be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "the controllers start {0} clocks after the tick: 2 to 131070 are possible; shorten the tables, or slow the clock"
)]
pub struct ScheduleConfigError(pub u32);

impl ScheduleConfig {
    /// A schedule whose `control` comes this many clocks after each tick.
    ///
    /// # Errors
    /// [`ScheduleConfigError`] unless it is 2 to 2^17 − 2.
    pub fn new(control_clocks: u32) -> Result<Self, ScheduleConfigError> {
        match control_clocks {
            2..=131_070 => Ok(Self { control_clocks }),
            _ => Err(ScheduleConfigError(control_clocks)),
        }
    }

    /// Clocks from the tick to `control`.
    pub fn control_clocks(&self) -> u32 {
        self.control_clocks
    }
}

ports! {
    schedule_ports;

    /// The input ports.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// One clock: the tick.
        tick: Bit as bool;
    }

    /// The output ports, all of them registers.
    outputs Outputs {
        /// One clock: the controllers start.
        control: Bit as bool;
    }
}

/// The cycle-accurate model of the schedule.
#[derive(Debug, Clone)]
pub struct Schedule {
    control_clocks: u32,
    /// Clocks since the tick; 0 before the first tick, and after `control`.
    since: u32,
    control: bool,
}

impl Schedule {
    /// The state after reset.
    pub fn new(config: &ScheduleConfig) -> Self {
        Self {
            control_clocks: config.control_clocks,
            since: 0,
            control: false,
        }
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let control = self.control;
        self.clock(inputs.rst, inputs.tick);
        Outputs { control }
    }

    fn clock(&mut self, reset: bool, tick: bool) {
        let last = self.since + 1 == self.control_clocks;
        self.control = !reset && last;
        self.since = match (reset, tick) {
            (true, _) => 0,
            (false, true) => 1,
            (false, false) if self.since == 0 || last => 0,
            (false, false) => self.since + 1,
        };
    }
}

impl Moore for Schedule {
    fn show(&self, outputs: &mut [u64]) {
        if let [control] = outputs {
            *control = self.control.into();
        }
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        let called = inputs.iter().any(|input| input & 1 != 0);
        match self.since {
            _ if called || self.control => 0,
            0 => FOREVER,
            since => u64::from(self.control_clocks - since - 1),
        }
    }

    fn pass(&mut self, _inputs: &[u64], clocks: u64) {
        if self.since != 0 {
            self.since += clocks as u32;
        }
    }
}

clocked_block!(Schedule, "the schedule");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ClockedBlock;

    #[test]
    fn control_comes_so_many_clocks_after_each_tick_and_not_without() {
        for clocks in [2, 3, 50] {
            let mut schedule = Schedule::new(&ScheduleConfig::new(clocks).unwrap());
            for clock in 0..500 {
                let tick = clock >= 100 && clock % 100 == 0;
                let mut outputs = [0];
                ClockedBlock::step(&mut schedule, &[0, tick.into()], &mut outputs).unwrap();
                let wanted = clock >= 100 && clock % 100 == u64::from(clocks);
                assert_eq!(outputs[0], u64::from(wanted), "{clocks} {clock}");
            }
        }
        assert!(ScheduleConfig::new(1).is_err());
    }
}
