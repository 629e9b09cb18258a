//! The ports of the position capture.

use super::AXES;
use crate::ports;

ports! {
    capture_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset: empties the memory, and forgets the level of the line.
        rst: Bit as bool;
        /// Line of the probe, asynchronous.
        line: Bit as bool;
        /// The line must have a new level for so many clocks in a row; 0 is 1.
        filter_clocks: Bits(16) as u16, "clocks";
        /// High: edges are counted and captured. Low: only `level` follows the line.
        enable: Bit as bool;
        /// Rising edges are wanted.
        rises: Bit as bool;
        /// Falling edges are wanted.
        falls: Bit as bool;
        /// Positions of the axes; tie unused ones to a constant.
        count[4]: Signed(32) as i32, "counts";
        /// Time at which the positions are valid, for example a counter of clocks.
        stamp: Bits(32) as u32;
        /// High: an edge is captured only where the position of `window_axis` is in the window.
        windowed: Bit as bool;
        /// Axis of the window.
        window_axis: Bits(2) as u8;
        /// Lowest position in the window.
        window_first: Signed(32) as i32, "counts";
        /// Highest position in the window; below `window_first`, no position is in it.
        window_last: Signed(32) as i32, "counts";
        /// For one clock: drop the oldest entry. Ignored while `entry_valid` is low.
        take: Bit as bool;
        /// For one clock: drop all entries, and count edges from 0.
        clear: Bit as bool;
        /// Clears `overflowed` and `outside`; setting wins.
        clear_flags: Bit as bool;
    }

    /// The output ports: registers; the entry comes from the memory, and is 0 while `entry_valid` is low.
    outputs Outputs {
        /// Level of the line behind the filter; low until it is known.
        level: Bit as bool;
        /// The line has had a level for `filter_clocks` clocks in a row since the reset; before, it has no edge.
        level_known: Bit as bool;
        /// For one clock: an entry was written.
        captured: Bit as bool;
        /// Number of entries in the memory.
        entries: Bits(5) as u8;
        /// Number of wanted edges since `clear`, captured or not, modulo 2^32.
        edges: Bits(32) as u32;
        /// The oldest entry is shown; the first one is, a clock after `captured`.
        entry_valid: Bit as bool;
        /// Positions of the oldest entry.
        entry_count[4]: Signed(32) as i32, "counts";
        /// Time of the oldest entry.
        entry_stamp: Bits(32) as u32;
        /// Edge of the oldest entry: high is rising.
        entry_rising: Bit as bool;
        /// Sticky: an edge came while the memory was full, and was dropped.
        overflowed: Bit as bool;
        /// Sticky: an edge came outside the window, and was not captured.
        outside: Bit as bool;
    }
}

impl Inputs {
    /// Whether the window lets these positions pass.
    pub fn is_inside(&self) -> bool {
        let count = self.count[usize::from(self.window_axis) % AXES];
        !self.windowed || (self.window_first..=self.window_last).contains(&count)
    }

    /// Whether an edge in this direction is counted.
    pub fn wants(&self, rising: bool) -> bool {
        self.enable && if rising { self.rises } else { self.falls }
    }
}
