//! The time base of a component that stands alone: ticks at a fixed distance, a clock counter, a tick counter.
//!
//! ```text
//! clock        0   1         T−1  T  T+1 T+2      after a reset
//! tick        ____________________/‾‾‾\_____
//! divide      ________________________/‾‾‾\_     one clock after each tick: when a divider may start
//! time_stamp  < 0>< 1>-------<T−1>< T><T+1>-     modulo 2^32
//! tick_count  ------- 0 ---------< 1 -------     modulo 2^32
//! ```
//!
//! `edge_stamp` is the lowest 24 bits of `time_stamp`, as the pulse counter wants them. All outputs are registers.

use super::divider::{DividerConfig, ELAPSED_BITS};
use super::{ClockedBlock, Direction, Moore, OutputKind, Port, StepError};

/// The ports in the order of the Verilog's port list, without `clk`.
pub fn ports() -> Vec<Port> {
    let port = |name: &str, direction, width| Port {
        name: name.to_owned(),
        direction,
        width,
        signed: false,
    };
    vec![
        port("rst", Direction::Input, 1),
        port("tick", Direction::Output, 1),
        port("divide", Direction::Output, 1),
        port("time_stamp", Direction::Output, 32),
        port("edge_stamp", Direction::Output, ELAPSED_BITS),
        port("tick_count", Direction::Output, 32),
    ]
}

/// The time base, cycle accurate at its ports.
#[derive(Debug, Clone)]
pub struct TimeBase {
    ports: Vec<Port>,
    tick_clocks: u32,
    phase: u32,
    tick: bool,
    divide: bool,
    time_stamp: u32,
    tick_count: u32,
}

impl TimeBase {
    /// A time base after reset, with the ticks of `divider`.
    pub fn new(divider: &DividerConfig) -> Self {
        Self {
            ports: ports(),
            tick_clocks: divider.tick_clocks(),
            phase: 0,
            tick: false,
            divide: false,
            time_stamp: 0,
            tick_count: 0,
        }
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
        let shown = [
            self.tick.into(),
            self.divide.into(),
            self.time_stamp.into(),
            u64::from(self.time_stamp) & ((1 << ELAPSED_BITS) - 1),
            self.tick_count.into(),
        ];
        for (output, value) in outputs.iter_mut().zip(shown) {
            *output = value;
        }
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

impl ClockedBlock for TimeBase {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        let ([reset], 5) = (inputs, outputs.len()) else {
            return Err(StepError(format!(
                "{} inputs and {} outputs: the time base has 1 and 5",
                inputs.len(),
                outputs.len()
            )));
        };
        self.show(outputs);
        self.clock(reset & 1 != 0);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_ticks_come_at_their_distance_and_count() {
        let mut time_base = TimeBase::new(&DividerConfig::new(7).unwrap());
        for clock in 0..100u64 {
            let mut outputs = [0; 5];
            time_base.step(&[0], &mut outputs).unwrap();
            let after = |clocks: u64| u64::from(clock >= clocks && (clock - clocks).is_multiple_of(7));
            assert_eq!(outputs, [after(7), after(8), clock, clock, clock / 7]);
        }
    }
}
