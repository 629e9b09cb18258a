//! The ports of a [motion](super::ShaperMotion) shaper, which has a word per channel, and `swap_how`.

use crate::ports::ports;

ports! {
    motion_shaper_ports(C, W, T, A);

    inputs {
        /// Synchronous reset, active high.
        rst: Bit;
        /// For one clock: the next sample of the command.
        strobe: Bit;
        /// For one clock: restart; all samples before now count as the present command.
        start: Bit;
        /// Command words: position, velocity, acceleration.
        x[C]: Signed(W);
        /// Clears `saturated`, `overrun`, `refused`.
        clear_flags: Bit;
        /// For one clock: writes one tap to a loadable bank.
        tap_write: Bit;
        /// Bank of the tap: 1 or 2 for a write.
        tap_bank: Bits(2);
        /// Index of the tap: 0 begins a table, then one after the other.
        tap_index: Bits(T);
        /// Coefficient of the tap.
        tap_coefficient: Signed(18), "2^−F";
        /// Delay of the tap, 0 … 2^A − 2.
        tap_delay: Bits(A), "samples";
        /// For one clock: read back the tap at `tap_index` of `tap_bank`, which may be any bank.
        tap_read: Bit;
        /// For one clock: make `swap_bank` active.
        swap: Bit;
        /// The bank to make active, 0 to 2.
        swap_bank: Bits(2);
        /// When the swap takes effect: 0 at once, 1 by handover, 2 when settled; 3 is refused.
        swap_how: Bits(2);
    }

    outputs {
        /// Shaped commands; they hold between samples.
        y[C]: Signed(W);
        /// For one clock: the shaped command is new.
        valid: Bit;
        /// Sticky: an output was clamped.
        saturated: Bit;
        /// A pass over the table is running.
        busy: Bit;
        /// Sticky: a strobe came while a pass was running.
        overrun: Bit;
        /// A swap waits, or hands over.
        swap_pending: Bit;
        /// The active bank.
        bank: Bits(2);
        /// Sticky: a write or a swap was refused.
        refused: Bit;
        /// Coefficient of the tap that was read back last; 0 where no tap is loaded.
        loaded_coefficient: Signed(18), "2^−F";
        /// Delay of that tap.
        loaded_delay: Bits(A), "samples";
        /// A read waits to be served.
        tap_read_waits: Bit;
    }
}
