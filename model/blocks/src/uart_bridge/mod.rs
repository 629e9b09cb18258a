//! The bridge from a serial line to the registers: a host sends requests in frames, and the bridge reads and writes words
//! as an Avalon-MM host.
//!
//! The datasheet is `docs/uart_bridge.md`, the frames are those of [`link`](crate::link); the hardware is compared with this
//! reference model.
//!
//! ```text
//! uart_rx ─► receiver ─► decoder ─► request, 256 bytes ─► sequencer ─► avm_*
//!             8N1        COBS, CRC                             │
//! uart_tx ◄─ transmitter ◄───────── reply, 256 bytes ◄────────┘ COBS, CRC
//! ```
//!
//! | part | what it does |
//! |---|---|
//! | `Eighths` | divides the clock into eighths of a bit, from a fraction: no eighth is off by more than a clock |
//! | `Receiver` | votes on three successive eighths; takes each bit in its middle |
//! | [`FrameDecoder`](crate::link::FrameDecoder) | bytes to requests; shared with the model of the frames |
//! | `Sequencer` | looks at a request, begins the reply, executes, ends the reply, sends it; with the decoder in `link_frames`, shared with [`spi_bridge`](super::spi_bridge) |
//! | `Transmitter` | bytes to bits |
//!
//! The reply stays in its memory. If the same request comes again, it is sent again.
//!
//! ```text
//! clock             0   1   2          58  59         a write of one word; clock 0: the stop bit of the 00 was seen
//! busy              ________/‾‾‾‾..‾‾‾‾‾‾‾‾‾..‾\__   until the last byte of the reply is being sent
//! avm_write         ______________/‾‾‾\___________    longer with avm_waitrequest
//! avm_address       --------------< a >-----------
//! ```
//!
//! ```
//! use posicast_blocks::uart_bridge::{Inputs, UartBridge, UartBridgeConfig};
//! use posicast_blocks::link::Request;
//!
//! // 3,000,000 baud at 50 MHz: a bit takes 16.7 clocks.
//! let idle = UartBridgeConfig::new(50_000_000, 3_000_000, 0.01, 512)?.inputs();
//! let mut bridge = UartBridge::new();
//! let mut writes = Vec::new();
//! let mut line = |uart_rx: bool, clocks: u32| (0..clocks).for_each(|_| {
//!     let outputs = bridge.step(&Inputs { uart_rx, ..idle });
//!     writes.extend(outputs.avm_write.then_some((outputs.avm_address, outputs.avm_writedata)));
//! });
//! line(true, 100);
//! for byte in (Request::Write { address: 3, words: vec![77] }).encode(1)? {
//!     let bits = 0x200 | u32::from(byte) << 1;
//!     (0..10).for_each(|bit| line(bits >> bit & 1 != 0, 17));
//! }
//! line(true, 300);
//! assert_eq!(writes, [(3, 77)]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod config;
mod line;
mod ports;

pub use config::{BAUD, MOST_BAUD_ERROR, SILENCE_BIT_TIMES, UartBridgeConfig, UartBridgeConfigError};
pub use ports::{INPUT_PORTS, Inputs, OUTPUT_PORTS, Outputs, PORTS, SILENCE_BITS, STEP_BITS, ports};

use self::line::{Eighths, Receiver, Transmitter};
use super::clocked_block;
use super::link_frames::{Frames, Heard, Registers};

/// The cycle-accurate model of the bridge.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct UartBridge {
    eighths: Eighths,
    receiver: Receiver,
    frames: Frames,
    transmitter: Transmitter,
}

impl UartBridge {
    /// A bridge after reset.
    pub fn new() -> Self {
        Self::default()
    }

    /// The outputs in a clock with these inputs.
    pub fn outputs(&self, inputs: &Inputs) -> Outputs {
        let asked = self.frames.asked(inputs.address_limit);
        Outputs {
            uart_tx: self.transmitter.line,
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
        let tick = self.eighths.tick;
        let Receiver {
            byte, received, bad, ..
        } = self.receiver;
        let heard = Heard {
            byte: received.then_some(byte),
            bad,
            tick,
        };
        let registers = Registers {
            silence_limit: inputs.silence_limit,
            address_limit: inputs.address_limit,
            readdata: inputs.avm_readdata,
            waitrequest: inputs.avm_waitrequest,
        };
        let sent = self.frames.clock(heard, &registers, self.transmitter.is_busy());
        self.transmitter.clock(tick, sent);
        self.receiver.clock(tick, inputs.uart_rx);
        self.eighths.clock(inputs.baud_step);
        shown
    }
}

clocked_block!(UartBridge, "the bridge");
