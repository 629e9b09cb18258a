//! The ports of the absolute encoder.

use crate::ports;

ports! {
    absolute_encoder_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// One clock: a reading begins, whose position belongs to this tick.
        tick: Bit as bool;
        /// Line from the encoder (SSI data, BiSS SLO), asynchronous.
        data: Bit as bool;
        /// Clears all sticky flags; after `lost`, the next good reading says anew where the axis stands.
        clear_flags: Bit as bool;
    }

    /// The output ports, all of them registers but `busy`, a function of six.
    outputs Outputs {
        /// Line to the encoder (SSI clock, BiSS MA), high at rest.
        clock_out: Bit as bool;
        /// Position of the last reading, extended over the range of the encoder modulo 2^32.
        count: Signed(32) as i32, "counts";
        /// One clock: `count` is that of the last tick.
        valid: Bit as bool;
        /// A good reading has said where the axis stands, and `lost` has not come since.
        known: Bit as bool;
        /// The last `count` is not read but continued with the last change.
        extrapolated: Bit as bool;
        /// A reading lasts, or is judged: a tick is not taken.
        busy: Bit as bool;
        /// BiSS-C: from the second rising edge of `clock_out` to the answer at `data`, in the last reading with an answer.
        line_delay: Bits(16) as u16, "clocks";
        /// Sticky: more readings in a row failed than the build tolerates. `count` stands.
        lost: Bit as bool;
        /// Sticky: CRC or parity of a frame was wrong.
        check_failed: Bit as bool;
        /// Sticky: the encoder did not answer.
        silent: Bit as bool;
        /// Sticky: `data` was low at a tick, or the encoder answered without ever beginning its frame.
        stuck: Bit as bool;
        /// Sticky: a frame with a right check had its error bit set.
        error_bit: Bit as bool;
        /// Sticky: a frame with a right check had its warning bit set. The reading counts.
        warning_bit: Bit as bool;
        /// Sticky: a position was farther from the last one than the limit.
        jumped: Bit as bool;
        /// Sticky: a tick came while `busy`, and was not taken.
        overrun: Bit as bool;
    }
}
