//! The ports of the command FIFO.

use crate::rtl::{PlainRow, Port, ports_of};

/// The input ports. Bits above a port's width are ignored.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Inputs {
    /// Synchronous reset.
    pub rst: bool,
    /// One clock: the tick.
    pub tick: bool,
    /// At a tick: entries are played; low while moving: a quick stop.
    pub enable: bool,
    /// One clock: `data` is `word` of the entry that is being written.
    pub write: bool,
    /// 0 to 3; 3 commits the entry.
    pub word: u8,
    /// The word.
    pub data: u32,
    /// One clock: at the next tick drop all entries that wait; the one that plays goes on.
    pub flush: bool,
    /// One clock: at the next tick drop all entries and stop.
    pub quick_stop: bool,
    /// One clock: at the next tick leave the state `stopped`.
    pub restart: bool,
    /// One clock: at the next tick rest at `preset_position`, with no entries. For an axis whose drive is off.
    pub preset: bool,
    /// Counts, taken at that tick.
    pub preset_position: i32,
    /// Deceleration of a quick stop, Q7.24 counts per tick², 31 bits; 0: at once.
    pub stop_deceleration: u32,
    /// `low` while at most so many entries wait, 6 bits.
    pub low_water: u8,
    /// Clears the sticky flags.
    pub clear_flags: bool,
    /// A rotary axis: the position wraps, and no end of its word stops it.
    pub modulo: bool,
    /// Feed hold, at a tick: a command that is at rest stays there, and the entry that plays keeps its ticks.
    pub feed_hold: bool,
}

/// Input ports in port order, with their widths.
const INPUTS: [PlainRow; 16] = [
    ("rst", 1, false),
    ("tick", 1, false),
    ("enable", 1, false),
    ("write", 1, false),
    ("word", 2, false),
    ("data", 32, false),
    ("flush", 1, false),
    ("quick_stop", 1, false),
    ("restart", 1, false),
    ("preset", 1, false),
    ("preset_position", 32, true),
    ("stop_deceleration", 31, false),
    ("low_water", 6, false),
    ("clear_flags", 1, false),
    ("modulo", 1, false),
    ("feed_hold", 1, false),
];

/// Output ports in port order, with their widths.
const OUTPUTS: [PlainRow; 18] = [
    ("position", 32, true),
    ("velocity", 32, true),
    ("acceleration", 32, true),
    ("valid", 1, false),
    ("state", 2, false),
    ("level", 7, false),
    ("low", 1, false),
    ("empty", 1, false),
    ("notify", 1, false),
    ("done", 1, false),
    ("underrun", 1, false),
    ("overflow", 1, false),
    ("refused", 1, false),
    ("malformed", 1, false),
    ("tick_missed", 1, false),
    ("out_of_range", 1, false),
    ("rests", 1, false),
    ("held", 1, false),
];

/// Number of input ports, without `clk`.
pub const INPUT_PORTS: usize = INPUTS.len();
/// Number of output ports.
pub const OUTPUT_PORTS: usize = OUTPUTS.len();

/// What the block is doing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum State {
    /// At rest, waiting for an entry; 0.
    #[default]
    Hold,
    /// An entry plays; 1.
    Move,
    /// A quick stop: decelerating; 2.
    Stop,
    /// At rest after a quick stop, until `restart`; entries are refused; 3.
    Stopped,
}

/// The output ports, all of them registers or comparisons of registers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Outputs {
    /// Q24.8 counts.
    pub position: i32,
    /// Q16.16 counts per tick.
    pub velocity: i32,
    /// Q8.24 counts per tick².
    pub acceleration: i32,
    /// One clock: the three are those of this tick.
    pub valid: bool,
    /// What the block is doing.
    pub state: State,
    /// Entries that wait, 0 to 64.
    pub level: u8,
    /// At most `low_water` entries wait.
    pub low: bool,
    /// None waits.
    pub empty: bool,
    /// One clock: an entry with this flag has ended.
    pub notify: bool,
    /// One clock: a move has ended at rest with no entry left, or a quick stop is at rest.
    pub done: bool,
    /// Sticky: no entry was there while moving.
    pub underrun: bool,
    /// Sticky: acceleration or velocity did not fit.
    pub overflow: bool,
    /// Sticky: a word was written while the FIFO held 64 entries, the one that plays included, or in a quick stop.
    pub refused: bool,
    /// Sticky: an entry was dropped: words missing, no ticks, reserved flags, or a jerk of more than 40 bits.
    pub malformed: bool,
    /// Sticky: a tick came while one was being played, and was left out.
    pub tick_missed: bool,
    /// Sticky: the command came near an end of the position's word, and stopped.
    pub out_of_range: bool,
    /// Velocity and acceleration are 0 since the last `valid`: exactly, and not only as rounded.
    pub rests: bool,
    /// The last tick was not played: a feed hold keeps the command where it rests.
    pub held: bool,
}

impl Inputs {
    /// From raw bit patterns, one per input port in port order.
    pub fn from_raw(raw: &[u64; INPUT_PORTS]) -> Self {
        let bit = |value: u64| value & 1 != 0;
        let [
            rst,
            tick,
            enable,
            write,
            word,
            data,
            flush,
            quick_stop,
            restart,
            preset,
            preset_position,
            stop_deceleration,
            low_water,
            clear_flags,
            modulo,
            feed_hold,
        ] = *raw;
        Self {
            rst: bit(rst),
            tick: bit(tick),
            enable: bit(enable),
            write: bit(write),
            word: (word & 3) as u8,
            data: data as u32,
            flush: bit(flush),
            quick_stop: bit(quick_stop),
            restart: bit(restart),
            preset: bit(preset),
            preset_position: preset_position as i32,
            stop_deceleration: stop_deceleration as u32 & (u32::MAX >> 1),
            low_water: (low_water & 63) as u8,
            clear_flags: bit(clear_flags),
            modulo: bit(modulo),
            feed_hold: bit(feed_hold),
        }
    }
}

impl Outputs {
    /// As raw bit patterns, one per output port in port order.
    pub fn to_raw(&self) -> [u64; OUTPUT_PORTS] {
        [
            u64::from(self.position as u32),
            u64::from(self.velocity as u32),
            u64::from(self.acceleration as u32),
            u64::from(self.valid),
            self.state as u64,
            u64::from(self.level),
            u64::from(self.low),
            u64::from(self.empty),
            u64::from(self.notify),
            u64::from(self.done),
            u64::from(self.underrun),
            u64::from(self.overflow),
            u64::from(self.refused),
            u64::from(self.malformed),
            u64::from(self.tick_missed),
            u64::from(self.out_of_range),
            u64::from(self.rests),
            u64::from(self.held),
        ]
    }
}

/// The ports in the order of the Verilog's port list, without `clk`.
pub fn ports() -> Vec<Port> {
    ports_of(&INPUTS, &OUTPUTS)
}
