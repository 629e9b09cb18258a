//! The ports of the trace memory.

use super::config::ROW_SIGNALS;
use crate::rtl::ports;
use crate::rtl::ports::choices;

/// What the block is doing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum TraceState {
    /// Nothing: never armed, complete or halted. The only state in which words can be read; 0.
    #[default]
    Idle,
    /// Taking the rows before the trigger; 1.
    Filling,
    /// Keeping the newest of these rows until the trigger comes; 2.
    Waiting,
    /// The trigger has come, the rest is being taken; 3.
    Taking,
}

choices!(TraceState: Idle, Filling, Waiting, Taking);

impl Inputs {
    /// Which signals a row has, in its order.
    pub fn selects(&self) -> [u8; ROW_SIGNALS] {
        [self.select_0, self.select_1, self.select_2, self.select_3]
    }

    /// With other signals in a row.
    pub fn with_selects(self, [select_0, select_1, select_2, select_3]: [u8; ROW_SIGNALS]) -> Self {
        Self {
            select_0,
            select_1,
            select_2,
            select_3,
            ..self
        }
    }
}

ports! {
    trace_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// One clock per tick: the signals are those of this tick, and hold still for the 16 clocks from here.
        strobe: Bit as bool;
        /// What can be traced; tie those that are not used.
        signal[16]: Signed(32) as i32;
        /// Which signal a row has first.
        select_0: Bits(4) as u8;
        /// Which signal a row has second.
        select_1: Bits(4) as u8;
        /// Which signal a row has third.
        select_2: Bits(4) as u8;
        /// Which signal a row has fourth.
        select_3: Bits(4) as u8;
        /// Signals in a row: 0 one, 1 two, 2 and 3 four; taken at `arm`.
        signals: Bits(2) as u8;
        /// With n here, the first strobe gives a row, then every (n + 1)th.
        decimation: Bits(16) as u16, "ticks";
        /// Which signal the trigger looks at.
        trigger_select: Bits(4) as u8;
        /// 0 at once, 1 rising through `trigger_level`, 2 falling through it, 3 `trigger_event`.
        trigger_mode: Bits(2) as u8;
        /// In the unit of the signal that the trigger looks at.
        trigger_level: Signed(32) as i32;
        /// One clock or longer; kept for the next row.
        trigger_event: Bit as bool;
        /// Rows before the trigger; more than the rows of a trace − 1 is that many; taken at `arm`.
        pre_trigger: Bits(11) as u16, "rows";
        /// One clock: forget everything and begin.
        arm: Bit as bool;
        /// One clock: end with the row that is being taken.
        halt: Bit as bool;
        /// Word of the trace in order of time: 0 is the oldest.
        read_address: Bits(11) as u16;
    }

    /// The output ports, functions of registers only.
    outputs Outputs {
        /// The word at the `read_address` of the clock before; 0 where the trace has none, or was being taken.
        data: Bits(32) as u32;
        /// 0 idle, 1 filling, 2 waiting, 3 taking.
        state: Bits(2) as TraceState;
        /// Rows that are there, 0 to 2048.
        rows: Bits(12) as u16, "rows";
        /// The row of the trigger: `pre_trigger` as it was taken. It has come when `rows` is larger.
        trigger_row: Bits(11) as u16;
        /// Sticky until `arm`: a strobe came while a row was being taken, and was left out.
        missed: Bit as bool;
        /// One clock: the trace is complete.
        done: Bit as bool;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rtl::{Direction, Port};

    #[test]
    fn unit_raw_inputs_are_cut_to_the_widths_of_the_ports_and_come_back() {
        let all_ones = Inputs::from_raw(&[u64::MAX; INPUT_PORTS]).to_raw();
        let inputs: Vec<Port> = ports()
            .into_iter()
            .filter(|port| port.direction == Direction::Input)
            .collect();
        assert_eq!((inputs.len(), ports().len()), (INPUT_PORTS, INPUT_PORTS + OUTPUT_PORTS));
        for (port, ones) in inputs.iter().zip(all_ones) {
            assert_eq!(ones, (1 << port.width) - 1, "{}", port.name);
        }
        let mixed: [u64; INPUT_PORTS] =
            std::array::from_fn(|place| (place as u64 + 1) & ((1 << inputs[place].width) - 1));
        assert_eq!(Inputs::from_raw(&mixed).to_raw(), mixed);
    }
}
