//! The ports of the bridge.

use crate::ports;

/// Width of `baud_step` in bits, all of them behind the point.
pub const STEP_BITS: u32 = 16;
/// Width of `silence_limit` in bits.
pub const SILENCE_BITS: u32 = crate::link_frames::SILENCE_BITS;

ports! {
    uart_bridge_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset, active high.
        rst: Bit as bool;
        /// Serial line from the host, asynchronous; high while nothing is sent.
        uart_rx: Bit as bool;
        /// Constant from the machine file: eighths of a bit per clock, in 65,536ths.
        baud_step: Bits(16) as u32, "eighths of a bit per clock, Q0.16";
        /// Constant: a frame is dropped if its next byte takes this long.
        silence_limit: Bits(20) as u32, "eighths of a bit";
        /// Constant: a request with a word address of this or above is refused.
        address_limit: Bits(16) as u16;
        /// Word that is read, in the clock in which `avm_waitrequest` is low.
        avm_readdata: Bits(32) as u32;
        /// High: `avm_read` or `avm_write` stays for another clock.
        avm_waitrequest: Bit as bool;
    }

    /// The output ports.
    outputs Outputs {
        /// Serial line to the host; high while nothing is sent. A register.
        uart_tx: Bit as bool;
        /// Address of the word. A register.
        avm_address: Bits(16) as u16;
        /// Reads the word.
        avm_read: Bit as bool;
        /// Writes `avm_writedata`.
        avm_write: Bit as bool;
        /// Word that is written. A register.
        avm_writedata: Bits(32) as u32;
        /// From the end of a request to the last byte of its reply.
        busy: Bit as bool;
        /// One clock: a damaged frame has ended. A register.
        frame_dropped: Bit as bool;
    }
}
