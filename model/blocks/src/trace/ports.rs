//! The ports of the trace memory.

use super::config::ROW_SIGNALS;
use crate::ports;
use crate::ports::choices;

/// State of the trace memory.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum TraceState {
    /// 0: never armed, complete or halted. Words can be read in this state only.
    #[default]
    Idle,
    /// 1: records the rows before the trigger.
    Filling,
    /// 2: keeps the newest of these rows until the trigger comes.
    Waiting,
    /// 3: the trigger has come, and the remaining rows are recorded.
    Taking,
}

choices!(TraceState: Idle, Filling, Waiting, Taking);

impl Inputs {
    /// The signals of a row, in order.
    pub fn selects(&self) -> [u8; ROW_SIGNALS] {
        [self.select_0, self.select_1, self.select_2, self.select_3]
    }

    /// The inputs with other signals in a row.
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
        /// One clock per tick: the signals are those of this tick, and stay stable for 16 clocks from here.
        strobe: Bit as bool;
        /// Signals that can be recorded; tie unused ones to a constant.
        signal[16]: Signed(32) as i32;
        /// First signal of a row.
        select_0: Bits(4) as u8;
        /// Second signal of a row.
        select_1: Bits(4) as u8;
        /// Third signal of a row.
        select_2: Bits(4) as u8;
        /// Fourth signal of a row.
        select_3: Bits(4) as u8;
        /// Signals in a row: 0 one, 1 two, 2 and 3 four; taken at `arm`.
        signals: Bits(2) as u8;
        /// With n here, the first strobe gives a row, then every (n + 1)th.
        decimation: Bits(16) as u16, "ticks";
        /// Signal that the trigger compares.
        trigger_select: Bits(4) as u8;
        /// 0 at once, 1 rising through `trigger_level`, 2 falling through it, 3 `trigger_event`.
        trigger_mode: Bits(2) as u8;
        /// Level of the trigger, in the unit of its signal.
        trigger_level: Signed(32) as i32;
        /// External trigger, one clock or longer; remembered until the next row.
        trigger_event: Bit as bool;
        /// Number of rows before the trigger, at most the rows of a trace − 1; taken at `arm`.
        pre_trigger: Bits(11) as u16, "rows";
        /// One clock: discards everything and begins.
        arm: Bit as bool;
        /// One clock: ends with the row that is being recorded.
        halt: Bit as bool;
        /// Index of the word to read, in order of time: 0 is the oldest.
        read_address: Bits(11) as u16;
    }

    /// The output ports, functions of registers only.
    outputs Outputs {
        /// The word at the `read_address` of the clock before; 0 where the trace has none, or was still being
        /// recorded.
        data: Bits(32) as u32;
        /// State: 0 idle, 1 filling, 2 waiting, 3 taking.
        state: Bits(2) as TraceState;
        /// Number of rows recorded.
        rows: Bits(12) as u16, "rows";
        /// Row of the trigger, the `pre_trigger` that was taken. The trigger has come when `rows` is larger.
        trigger_row: Bits(11) as u16;
        /// Sticky until `arm`: a strobe came while a row was being recorded, and was left out.
        missed: Bit as bool;
        /// One clock: the trace is complete.
        done: Bit as bool;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Direction, Port};

    #[test]
    fn raw_inputs_are_cut_to_the_widths_of_the_ports_and_come_back() {
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
