//! The bridge from SPI to the registers: a host sends requests in frames, and the bridge reads and writes words as an
//! Avalon-MM host.
//!
//! The datasheet is `docs/spi_bridge.md`, the frames are those of [`link`](crate::link); the hardware is compared with this
//! reference model. Decoder, sequencer and reply are those of
//! [`uart_bridge`](super::uart_bridge), in `link_frames`.
//!
//! ```text
//! spi_sck, spi_cs_n, spi_mosi ─► lines ─► decoder ─► request, 256 bytes ─► sequencer ─► avm_*
//!                                mode 0   COBS, CRC                            │
//!                     spi_miso ◄──┴─── reply, 256 bytes ◄──────────────────────┘ COBS, CRC
//! ```
//!
//! The host clocks every byte. A side without data to send sends 00, an empty frame, which the other side ignores.
//!
//! ```text
//! spi_cs_n   ‾\______________________________________/‾
//! spi_sck    ____/‾\_/‾\_/‾\_/‾\_/‾\_/‾\_/‾\_/‾\________
//! spi_mosi   --< 7 | 6 | 5 | 4 | 3 | 2 | 1 | 0 >-------    taken at the rising edges
//! spi_miso   ___< 7 | 6 | 5 | 4 | 3 | 2 | 1 | 0 | next>    changes up to three clocks after the falling edges
//! ```
//!
//! ```
//! use posicast_blocks::spi_bridge::{Inputs, SpiBridge, SpiBridgeConfig};
//! use posicast_blocks::link::Request;
//!
//! let idle = SpiBridgeConfig::new(50_000_000, 0.01, 512)?.inputs();
//! let mut bridge = SpiBridge::new();
//! let mut writes = Vec::new();
//! let mut lines = |spi_cs_n: bool, spi_sck: bool, spi_mosi: bool, clocks: u32| (0..clocks).for_each(|_| {
//!     let outputs = bridge.step(&Inputs { spi_cs_n, spi_sck, spi_mosi, ..idle });
//!     writes.extend(outputs.avm_write.then_some((outputs.avm_address, outputs.avm_writedata)));
//! });
//! lines(false, false, false, 8);
//! for byte in (Request::Write { address: 3, words: vec![77] }).encode(1)? {
//!     for bit in (0..8).rev() {
//!         lines(false, false, byte >> bit & 1 != 0, 4);
//!         lines(false, true, byte >> bit & 1 != 0, 4);
//!     }
//! }
//! lines(true, false, false, 100);
//! assert_eq!(writes, [(3, 77)]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod config;
mod line;
mod ports;

pub use config::{LEAST_CLOCKS_PER_BIT, SpiBridgeConfig, SpiBridgeConfigError};
pub use ports::{INPUT_PORTS, Inputs, OUTPUT_PORTS, Outputs, PORTS, SILENCE_BITS, SILENCE_CLOCKS, ports};

use self::line::{Pins, SpiLine};
use super::clocked_block;
use super::link_frames::{Frames, Heard, Registers};

/// The cycle-accurate model of the bridge.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SpiBridge {
    line: SpiLine,
    frames: Frames,
    /// Clocks of the present unit of the time-out.
    fraction: u32,
}

impl SpiBridge {
    /// A bridge after reset.
    pub fn new() -> Self {
        Self::default()
    }

    /// The outputs in a clock with these inputs.
    pub fn outputs(&self, inputs: &Inputs) -> Outputs {
        let asked = self.frames.asked(inputs.address_limit);
        Outputs {
            spi_miso: self.line.miso(),
            avm_address: asked.address,
            avm_read: asked.read,
            avm_write: asked.write,
            avm_writedata: asked.writedata,
            busy: asked.busy,
            frame_dropped: asked.frame_dropped,
        }
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let shown = self.outputs(inputs);
        if inputs.rst {
            *self = Self::default();
            return shown;
        }
        let SpiLine {
            byte, received, bad, ..
        } = self.line;
        let heard = Heard {
            byte: received.then_some(byte),
            bad,
            tick: self.fraction == SILENCE_CLOCKS - 1,
        };
        let registers = Registers {
            silence_limit: inputs.silence_limit,
            address_limit: inputs.address_limit,
            readdata: inputs.avm_readdata,
            waitrequest: inputs.avm_waitrequest,
        };
        let sent = self.frames.clock(heard, &registers, self.line.is_busy());
        let pins = Pins {
            sck: inputs.spi_sck,
            cs_n: inputs.spi_cs_n,
            mosi: inputs.spi_mosi,
        };
        self.line.clock(pins, sent);
        self.fraction = (self.fraction + 1) % SILENCE_CLOCKS;
        shown
    }
}

clocked_block!(SpiBridge, "the bridge");
