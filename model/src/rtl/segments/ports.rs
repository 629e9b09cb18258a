//! The ports of the command FIFO.

use crate::rtl::ports;
use crate::rtl::ports::choices;

/// What the block is doing.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum SegmentsState {
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

choices!(SegmentsState: Hold, Move, Stop, Stopped);

ports! {
    segments_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// One clock: the tick.
        tick: Bit as bool;
        /// At a tick: entries are played; low while moving: a quick stop.
        enable: Bit as bool;
        /// One clock: `data` is `word` of the entry that is being written.
        write: Bit as bool;
        /// 0 to 3; 3 commits the entry.
        word: Bits(2) as u8;
        /// The word.
        data: Bits(32) as u32;
        /// One clock: at the next tick drop all entries that wait; the one that plays goes on.
        flush: Bit as bool;
        /// One clock: at the next tick drop all entries and stop.
        quick_stop: Bit as bool;
        /// One clock: at the next tick leave the state `stopped`.
        restart: Bit as bool;
        /// One clock: at the next tick rest at `preset_position`, without entries; for an axis whose drive is off.
        preset: Bit as bool;
        /// The position of a preset, taken at that tick.
        preset_position: Signed(32) as i32, "counts";
        /// Deceleration of a quick stop; 0: at once.
        stop_deceleration: Bits(31) as u32, "counts per tick², Q7.24";
        /// `low` while at most so many entries wait.
        low_water: Bits(6) as u8, "entries";
        /// Clears the sticky flags.
        clear_flags: Bit as bool;
        /// Tied: a rotary axis, whose position wraps.
        modulo: Bit as bool;
        /// At a tick: a command that rests stays where it is, and the entry that plays keeps its ticks.
        feed_hold: Bit as bool;
        /// So many ticks may pass at the last velocity where entries are missing, before the quick stop; 0: none.
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
        /// One clock: the three are those of this tick.
        valid: Bit as bool;
        /// 0 hold, 1 move, 2 stop, 3 stopped.
        state: Bits(2) as SegmentsState;
        /// Entries that wait, 0 to 64.
        level: Bits(7) as u8, "entries";
        /// At most `low_water` entries wait.
        low: Bit as bool;
        /// None waits.
        empty: Bit as bool;
        /// One clock: an entry with this flag has ended.
        notify: Bit as bool;
        /// One clock: a move has ended at rest with no entry left, or a quick stop is at rest.
        done: Bit as bool;
        /// Sticky: no entry was there while moving, and the extrapolation, if any, was over.
        underrun: Bit as bool;
        /// Sticky: acceleration or velocity did not fit.
        overflow: Bit as bool;
        /// Sticky: a word was written while the FIFO held 64 entries, the one that plays included, or in a quick
        /// stop.
        refused: Bit as bool;
        /// Sticky: an entry was dropped: words missing, no ticks, reserved flags, a jerk of more than 40 bits, or another entry of
        /// its batch was.
        malformed: Bit as bool;
        /// Sticky: a tick came while one was being played, and was left out.
        tick_missed: Bit as bool;
        /// Sticky: the command came near an end of the position's word, and stopped.
        out_of_range: Bit as bool;
        /// Velocity and acceleration are 0, exactly, since the last `valid`.
        rests: Bit as bool;
        /// The last tick was not played: a feed hold.
        held: Bit as bool;
        /// Ticks since reset that were extrapolated, modulo 2^8.
        late_ticks: Bits(8) as u8, "ticks";
    }
}
