//! The ports of the command FIFO.

use crate::ports;
use crate::ports::choices;

/// State of the block.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum SegmentsState {
    /// 0: at rest, waiting for an entry.
    #[default]
    Hold,
    /// 1: an entry is being played.
    Move,
    /// 2: decelerating in a quick stop.
    Stop,
    /// 3: at rest after a quick stop, until `restart`; entries are refused.
    Stopped,
}

choices!(SegmentsState: Hold, Move, Stop, Stopped);

ports! {
    segments_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// One clock: the tick.
        tick: Bit as bool;
        /// At a tick: high plays entries; low while moving is a quick stop.
        enable: Bit as bool;
        /// One clock: writes `data` as `word` of an entry.
        write: Bit as bool;
        /// Index of the word, 0 to 3; word 3 commits the entry.
        word: Bits(2) as u8;
        /// The word to write.
        data: Bits(32) as u32;
        /// One clock: at the next tick all waiting entries are dropped; the one being played continues.
        flush: Bit as bool;
        /// One clock: at the next tick all entries are dropped and the command stops.
        quick_stop: Bit as bool;
        /// One clock: at the next tick the state `stopped` is left.
        restart: Bit as bool;
        /// One clock: at the next tick the command rests at `preset_position`, without entries; for an axis whose
        /// drive is off.
        preset: Bit as bool;
        /// Position of a preset, taken at that tick.
        preset_position: Signed(32) as i32, "counts";
        /// Deceleration of a quick stop; 0: the command stops at once.
        stop_deceleration: Bits(31) as u32, "counts per tick², Q7.24";
        /// `low` is high while at most this many entries wait.
        low_water: Bits(6) as u8, "entries";
        /// Clears the sticky flags.
        clear_flags: Bit as bool;
        /// Constant; high: a rotary axis, whose position wraps.
        modulo: Bit as bool;
        /// At a tick: a command at rest stays where it is, and the entry being played keeps its ticks.
        feed_hold: Bit as bool;
        /// Longest time at the last velocity if entries are missing, before the quick stop; 0: none.
        extrapolation: Bits(8) as u8, "ticks";
    }

    /// The output ports, all of them registers or comparisons of registers.
    outputs Outputs {
        /// Position of the command.
        position: Signed(32) as i32, "counts, Q24.8";
        /// Velocity of the command.
        velocity: Signed(32) as i32, "counts per tick, Q16.16";
        /// Acceleration of the command.
        acceleration: Signed(32) as i32, "counts per tick², Q8.24";
        /// One clock: position, velocity and acceleration are those of this tick.
        valid: Bit as bool;
        /// State: 0 hold, 1 move, 2 stop, 3 stopped.
        state: Bits(2) as SegmentsState;
        /// Number of waiting entries, 0 to 64.
        level: Bits(7) as u8, "entries";
        /// At most `low_water` entries wait.
        low: Bit as bool;
        /// No entry waits.
        empty: Bit as bool;
        /// One clock: an entry with this flag has ended.
        notify: Bit as bool;
        /// One clock: a move has ended at rest with no entry left, or a quick stop has come to rest.
        done: Bit as bool;
        /// Sticky: no entry was there while moving, and the extrapolation, if any, was over.
        underrun: Bit as bool;
        /// Sticky: an acceleration or velocity did not fit its word.
        overflow: Bit as bool;
        /// Sticky: a word was written while the FIFO held 64 entries, including the one being played, or in a quick
        /// stop.
        refused: Bit as bool;
        /// Sticky: an entry was dropped: words missing, no ticks, reserved flags, a jerk of more than 40 bits, or another entry of
        /// its batch was.
        malformed: Bit as bool;
        /// Sticky: a tick came while another was being processed, and was left out.
        tick_missed: Bit as bool;
        /// Sticky: the command came near an end of the position word and stopped.
        out_of_range: Bit as bool;
        /// Velocity and acceleration have been exactly 0 since the last `valid`.
        rests: Bit as bool;
        /// The last tick was not played, because of a feed hold.
        held: Bit as bool;
        /// Ticks since reset that were extrapolated, modulo 2^8.
        late_ticks: Bits(8) as u8, "ticks";
    }
}
