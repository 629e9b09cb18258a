//! Ports of the position compare.

use crate::ports;

ports! {
    compare_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset. The list stays in memory, but counts as empty.
        rst: Bit as bool;
        /// Position; it changes by at most one count per clock, or is another one at once, as at a reference.
        count: Signed(32) as i32, "counts";
        /// For one clock: take the settings, begin again before the first position, and look for those beside the count.
        arm: Bit as bool;
        /// For one clock: no position is passed after this clock; a pulse that has begun goes on. It wins over `arm`.
        disarm: Bit as bool;
        /// Taken by `arm`. High: the positions are those of the list. Low: they are `first` and those at `spacing` after it.
        use_list: Bit as bool;
        /// Taken by `arm`: the lowest position.
        first: Signed(32) as i32, "counts";
        /// Taken by `arm`: distance of two positions; 0 is 1.
        spacing: Bits(32) as u32, "counts";
        /// Taken by `arm`: number of positions; those beyond the largest count do not exist.
        positions: Bits(32) as u32;
        /// Taken by `arm`: a position that is passed upward gives a pulse.
        rises: Bit as bool;
        /// Taken by `arm`: a position that is passed downward gives a pulse.
        falls: Bit as bool;
        /// Taken by `arm`: after a pulse, the same position gives the next one only if the count was so far from its edge, on
        /// either side, or has passed another position with a pulse.
        hysteresis: Bits(16) as u16, "counts";
        /// Taken by `arm`: width of a pulse; 0 is 1.
        pulse_clocks: Bits(24) as u32, "clocks";
        /// Position that `entry_write` appends to the list.
        entry: Signed(32) as i32, "counts";
        /// For one clock: append `entry`, unless the block is armed or `arm` is high, the list is full, or the entry is less
        /// than 4 counts above the one before it; then it is refused.
        entry_write: Bit as bool;
        /// For one clock: empty the list, unless the block is armed or `arm` is high. It wins over `entry_write`.
        entries_clear: Bit as bool;
        /// Clears `merged`, `jumped` and `refused`; setting wins.
        clear_flags: Bit as bool;
    }

    /// The output ports, all of them registers.
    outputs Outputs {
        /// The pulse.
        pulse: Bit as bool;
        /// For one clock: a position was passed and gives a pulse.
        passed: Bit as bool;
        /// Direction of the last of them: high is upward.
        passed_upward: Bit as bool;
        /// Number of pulses since `arm`, modulo 2^32; those that were merged count, too.
        passes: Bits(32) as u32;
        /// Between `arm` and `disarm`.
        armed: Bit as bool;
        /// The positions on both sides of the count are known.
        ready: Bit as bool;
        /// Number of positions in the list.
        entries: Bits(9) as u16;
        /// Sticky: a position was passed during a pulse, which became longer instead of ending.
        merged: Bit as bool;
        /// Sticky: the count changed by more than one while the block was ready; positions between were not passed.
        jumped: Bit as bool;
        /// Sticky: an entry or an `entries_clear` was refused.
        refused: Bit as bool;
    }
}
