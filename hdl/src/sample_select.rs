//! Selects the source of a stand-alone shaper's samples: the host's registers, or pins. The outputs come a clock
//! late.
//!
//! The reference is `posicast_blocks::sample_select`.

use crate::compiled::{self, Compiled};
use crate::emit::{self, EmitError, EmitOptions, Header, Module};
use crate::prelude::*;
use crate::simulation::{Simulated, SimulationError};
use posicast_blocks::sample_select::{PORTS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

kernel! {
    /// Sizes: W word bits, C channels.
    struct SampleSelect<const W: usize, const C: usize>;
    ports posicast_blocks::sample_select_ports;

    registers { strobe_q: Bit, start_q: Bit, x_q[C]: Signed<W> }
}

impl<const W: usize, const C: usize> Logic for SampleSelect<W, C> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module sample_select");
        self.strobe_q.d.next = self.host_strobe.val();
        self.start_q.d.next = self.host_start.val();
        if self.from_pins.val() {
            self.strobe_q.d.next = self.pin_strobe.val();
            self.start_q.d.next = self.pin_start.val();
        }
        for i in 0..C {
            self.x_q[i].d.next = self.host_x[i].val();
            if self.from_pins.val() {
                self.x_q[i].d.next = self.pin_x[i].val();
            }
        }

        self.strobe.next = self.strobe_q.q.val();
        self.start.next = self.start_q.q.val();
        for i in 0..C {
            self.x[i].next = self.x_q[i].q.val();
        }
    }
}

/// The block with words of W bits, and C channels.
macro_rules! sample_select {
    ($w:literal, $c:literal) => {
        Compiled {
            sizes: &[$w],
            build: |()| Box::new(SampleSelect::<$w, $c>::default()),
        }
    };
}

const OF_ONE: [Compiled<()>; 3] = [sample_select!(32, 1), sample_select!(24, 1), sample_select!(17, 1)];
const OF_TWO: [Compiled<()>; 3] = [sample_select!(32, 2), sample_select!(24, 2), sample_select!(17, 2)];
const OF_THREE: [Compiled<()>; 3] = [sample_select!(32, 3), sample_select!(24, 3), sample_select!(17, 3)];
const OF_FIVE: [Compiled<()>; 3] = [sample_select!(32, 5), sample_select!(24, 5), sample_select!(17, 5)];

/// The block at the compiled widths of a word, from which the emitter derives all others. A duty has one channel, a
/// shaper one to three, a controller five.
fn block(channels: usize) -> &'static [Compiled<()>] {
    match channels {
        1 => &OF_ONE,
        2 => &OF_TWO,
        3 => &OF_THREE,
        _ => &OF_FIVE,
    }
}

/// The selection in RustHDL's own simulator, for words of this many bits (up to 32) and this many channels.
///
/// It runs at a compiled size with words that are wide enough; the outputs are the same.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block, or where the words have more than 32 bits.
pub fn simulate(word_bits: u32, channels: usize) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = compiled::holding(block(channels), &[word_bits], false).ok_or(SimulationError::Size {
        block: "sample_select",
        word_bits,
    })?;
    let ports = ports(word_bits as usize, channels);
    Ok(Box::new(Simulated::new("sample_select", (block.build)(&()), ports)?))
}

/// Name of the last module that [`emit()`] writes.
pub fn name(word_bits: u32, channels: usize, prefix: &str) -> String {
    emit::shared_name(prefix, &base_name(word_bits, channels))
}

fn base_name(word_bits: u32, channels: usize) -> String {
    format!("sample_select_{word_bits}x{channels}")
}

/// Verilog of the selection; [`name`] gives its name.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(word_bits: u32, channels: usize, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: base_name(word_bits, channels),
        prefix: prefix.to_owned(),
        header: Header {
            about: String::new(),
            ports: port_notes(PORTS),
            parameters: Vec::new(),
        },
    };
    compiled::emit(block(channels), &(), &[word_bits], &options)
}
