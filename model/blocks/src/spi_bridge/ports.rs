//! The ports of the bridge.

use crate::ports;

/// Width of `silence_limit` in bits.
pub const SILENCE_BITS: u32 = crate::link_frames::SILENCE_BITS;
/// Clocks of a unit of `silence_limit`.
pub const SILENCE_CLOCKS: u32 = 64;

ports! {
    spi_bridge_ports;

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset, active high.
        rst: Bit as bool;
        /// Clock of the host, asynchronous; low while nothing is sent. At most an eighth of `clk`.
        spi_sck: Bit as bool;
        /// Selection by the host, asynchronous, active low.
        spi_cs_n: Bit as bool;
        /// Line from the host, asynchronous; taken at the rising edge of `spi_sck`.
        spi_mosi: Bit as bool;
        /// Constant: a frame is dropped if its next byte takes this long.
        silence_limit: Bits(20) as u32, "64 clocks";
        /// Constant: a request with a word address of this or above is refused.
        address_limit: Bits(16) as u16;
        /// Word that is read, in the clock in which `avm_waitrequest` is low.
        avm_readdata: Bits(32) as u32;
        /// High: `avm_read` or `avm_write` stays for another clock.
        avm_waitrequest: Bit as bool;
    }

    /// The output ports.
    outputs Outputs {
        /// Line to the host; changes after the falling edge of `spi_sck`, low while not selected. A register.
        spi_miso: Bit as bool;
        /// Address of the word. A register.
        avm_address: Bits(16) as u16;
        /// Reads the word.
        avm_read: Bit as bool;
        /// Writes `avm_writedata`.
        avm_write: Bit as bool;
        /// Word that is written. A register.
        avm_writedata: Bits(32) as u32;
        /// From the end of a request until the last byte of its reply waits for the host.
        busy: Bit as bool;
        /// One clock: a damaged frame has ended. A register.
        frame_dropped: Bit as bool;
    }
}
