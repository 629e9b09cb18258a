//! The ports of the plain shaper: words of W bits, T bits of a tap's index, A bits of a delay.

use crate::rtl::ports::ports;

ports! {
    shaper_ports(W, T, A);

    inputs {
        /// Synchronous reset, active high.
        rst: Bit;
        /// For one clock: the next sample of the command.
        strobe: Bit;
        /// For one clock: begin anew, all samples before now count as the command of now.
        start: Bit;
        /// Command word.
        x: Signed(W);
        /// Clears `saturated`, `overrun`, `refused`.
        clear_flags: Bit;
        /// For one clock: one tap for a loadable bank.
        tap_write: Bit;
        /// The bank it is for, 1 or 2.
        tap_bank: Bits(2);
        /// Its place in the table: 0 begins a table, then one after the other.
        tap_index: Bits(T);
        /// Its coefficient.
        tap_coefficient: Signed(18), "2^−F";
        /// Its delay, 0 … 2^A − 2.
        tap_delay: Bits(A), "samples";
        /// For one clock: the tap at `tap_index` of `tap_bank`, of any bank, is to be read back.
        tap_read: Bit;
        /// For one clock: make `swap_bank` active.
        swap: Bit;
        /// The bank to make active, 0 to 2.
        swap_bank: Bits(2);
    }

    outputs {
        /// Shaped command; holds between samples.
        y: Signed(W);
        /// For one clock: the shaped command is new.
        valid: Bit;
        /// Sticky: some output was clamped.
        saturated: Bit;
        /// A pass over the table runs.
        busy: Bit;
        /// Sticky: a strobe came while a pass ran.
        overrun: Bit;
        /// A swap waits, or hands over.
        swap_pending: Bit;
        /// The active bank.
        bank: Bits(2);
        /// Sticky: a write or a swap was refused.
        refused: Bit;
        /// Coefficient of the tap that was read back last; 0 where no tap is loaded.
        loaded_coefficient: Signed(18), "2^−F";
        /// Its delay.
        loaded_delay: Bits(A), "samples";
        /// A read was not served yet.
        tap_read_waits: Bit;
    }
}
