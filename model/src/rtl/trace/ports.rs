//! The ports of the trace memory.

use super::config::{ROW_SIGNALS, SIGNALS};
use crate::rtl::{Direction, Port};

/// The input ports. Bits above a port's width are ignored.
// Lengths as numbers: rustc 1.95 fails with an internal error where a closure captures an array of a named length by field.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Inputs {
    /// Synchronous reset.
    pub rst: bool,
    /// One clock per tick: the signals are those of this tick, and hold still for the 16 clocks from here.
    pub strobe: bool,
    /// What can be traced.
    pub signal: [i32; 16],
    /// Which signals a row has, in its order, 4 bits each.
    pub select: [u8; 4],
    /// Signals in a row: 0 one, 1 two, 2 and 3 four. Taken at `arm`.
    pub signals: u8,
    /// A row is taken of the first strobe and then of every (n + 1)th.
    pub decimation: u16,
    /// Which signal the trigger looks at, 4 bits.
    pub trigger_select: u8,
    /// 0 at once, 1 rising through `trigger_level`, 2 falling through it, 3 `trigger_event`.
    pub trigger_mode: u8,
    /// In the unit of the signal that the trigger looks at.
    pub trigger_level: i32,
    /// One clock or longer; kept for the next row.
    pub trigger_event: bool,
    /// Rows before the trigger, 11 bits; more than the rows of a trace − 1 is that many. Taken at `arm`.
    pub pre_trigger: u16,
    /// One clock: forget everything and begin.
    pub arm: bool,
    /// One clock: end with the row that is being taken.
    pub halt: bool,
    /// Word of the trace in order of time, 11 bits: 0 is the oldest.
    pub read_address: u16,
}

/// Input ports before the signals, with their widths.
const FIRST_INPUTS: [(&str, u32, bool); 2] = [("rst", 1, false), ("strobe", 1, false)];

/// Input ports behind the selects, with their widths.
const LAST_INPUTS: [(&str, u32, bool); 10] = [
    ("signals", 2, false),
    ("decimation", 16, false),
    ("trigger_select", 4, false),
    ("trigger_mode", 2, false),
    ("trigger_level", 32, true),
    ("trigger_event", 1, false),
    ("pre_trigger", 11, false),
    ("arm", 1, false),
    ("halt", 1, false),
    ("read_address", 11, false),
];

/// Output ports in port order, with their widths.
const OUTPUTS: [(&str, u32, bool); OUTPUT_PORTS] = [
    ("data", 32, false),
    ("state", 2, false),
    ("rows", 12, false),
    ("trigger_row", 11, false),
    ("missed", 1, false),
    ("done", 1, false),
];

/// Number of input ports, without `clk`.
pub const INPUT_PORTS: usize = FIRST_INPUTS.len() + SIGNALS + ROW_SIGNALS + LAST_INPUTS.len();
/// Number of output ports.
pub const OUTPUT_PORTS: usize = 6;

/// What the block is doing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum State {
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

/// The output ports, functions of registers only.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Outputs {
    /// The word at the `read_address` of the clock before; 0 where the trace has none, or was being taken.
    pub data: u32,
    /// What the block is doing.
    pub state: State,
    /// Rows that are there, 0 to 2048.
    pub rows: u16,
    /// The row of the trigger, and the rows before it. It has come when `rows` is larger.
    pub trigger_row: u16,
    /// Sticky until `arm`: a strobe came while a row was being taken, and was left out.
    pub missed: bool,
    /// One clock: the trace is complete.
    pub done: bool,
}

impl Inputs {
    /// From raw bit patterns, one per input port in port order.
    pub fn from_raw(raw: &[u64; INPUT_PORTS]) -> Self {
        const FIRST_SELECT: usize = FIRST_INPUTS.len() + SIGNALS;
        const FIRST_SETTING: usize = FIRST_SELECT + ROW_SIGNALS;
        let bit = |place: usize| raw[place] & 1 != 0;
        let setting = |place: usize| raw[FIRST_SETTING + place];
        Self {
            rst: bit(0),
            strobe: bit(1),
            signal: std::array::from_fn(|place| raw[FIRST_INPUTS.len() + place] as i32),
            select: std::array::from_fn(|place| raw[FIRST_SELECT + place] as u8 & 15),
            signals: setting(0) as u8 & 3,
            decimation: setting(1) as u16,
            trigger_select: setting(2) as u8 & 15,
            trigger_mode: setting(3) as u8 & 3,
            trigger_level: setting(4) as i32,
            trigger_event: bit(FIRST_SETTING + 5),
            pre_trigger: setting(6) as u16 & 0x7ff,
            arm: bit(FIRST_SETTING + 7),
            halt: bit(FIRST_SETTING + 8),
            read_address: setting(9) as u16 & 0x7ff,
        }
    }

    /// As raw bit patterns, one per input port in port order, each cut to its port's width.
    pub fn to_raw(&self) -> [u64; INPUT_PORTS] {
        let word = |value: i32| u64::from(value as u32);
        let first = [u64::from(self.rst), u64::from(self.strobe)];
        let last = [
            u64::from(self.signals & 3),
            u64::from(self.decimation),
            u64::from(self.trigger_select & 15),
            u64::from(self.trigger_mode & 3),
            word(self.trigger_level),
            u64::from(self.trigger_event),
            u64::from(self.pre_trigger & 0x7ff),
            u64::from(self.arm),
            u64::from(self.halt),
            u64::from(self.read_address & 0x7ff),
        ];
        let selects = self.select.map(|select| u64::from(select & 15));
        let all = first
            .into_iter()
            .chain(self.signal.map(word))
            .chain(selects)
            .chain(last);
        let mut raw = [0; INPUT_PORTS];
        raw.iter_mut().zip(all).for_each(|(place, value)| *place = value);
        raw
    }
}

impl Outputs {
    /// As raw bit patterns, one per output port in port order.
    pub fn to_raw(&self) -> [u64; OUTPUT_PORTS] {
        [
            u64::from(self.data),
            self.state as u64,
            u64::from(self.rows),
            u64::from(self.trigger_row),
            u64::from(self.missed),
            u64::from(self.done),
        ]
    }
}

/// The ports in the order of the Verilog's port list, without `clk`.
pub fn ports() -> Vec<Port> {
    let port = |name: String, direction, width, signed| Port {
        name,
        direction,
        width,
        signed,
    };
    let of =
        |direction| move |&(name, width, signed): &(&str, u32, bool)| port(name.to_owned(), direction, width, signed);
    let signals = (0..SIGNALS).map(|place| port(format!("signal_{place}"), Direction::Input, 32, true));
    let selects = (0..ROW_SIGNALS).map(|place| port(format!("select_{place}"), Direction::Input, 4, false));
    let first = FIRST_INPUTS.iter().map(of(Direction::Input));
    let last = LAST_INPUTS.iter().map(of(Direction::Input));
    let outputs = OUTPUTS.iter().map(of(Direction::Output));
    first.chain(signals).chain(selects).chain(last).chain(outputs).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

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
