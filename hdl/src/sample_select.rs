//! Selects the source of a stand-alone shaper's samples: the host's registers, or pins. The outputs come a clock
//! late.
//!
//! The reference is `posicast_model::rtl::sample_select`.

use crate::emit::{self, EmitError, EmitOptions, Header, Module};
use crate::prelude::*;
use crate::simulation::{Pins, Simulated, SimulationError};
use posicast_model::rtl::sample_select::{PORTS, ports};
use posicast_model::rtl::{ClockedBlock, port_notes};

kernel! {
    /// Sizes: W word bits, C channels.
    struct SampleSelect<const W: usize, const C: usize>;
    ports posicast_model::sample_select_ports;

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

/// The block at the sizes that components have: those of shapers, of a duty, and five words of 32 bits for a
/// controller.
fn block(word_bits: u32, channels: usize) -> Box<dyn Pins> {
    match (word_bits, channels) {
        (17, _) => Box::new(SampleSelect::<17, 1>::default()),
        (16, _) => Box::new(SampleSelect::<16, 1>::default()),
        (24, 1) => Box::new(SampleSelect::<24, 1>::default()),
        (24, 2) => Box::new(SampleSelect::<24, 2>::default()),
        (24, _) => Box::new(SampleSelect::<24, 3>::default()),
        (_, 1) => Box::new(SampleSelect::<32, 1>::default()),
        (_, 2) => Box::new(SampleSelect::<32, 2>::default()),
        (_, 3) => Box::new(SampleSelect::<32, 3>::default()),
        _ => Box::new(SampleSelect::<32, 5>::default()),
    }
}

/// The selection in RustHDL's own simulator, for words of this many bits and this many channels.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate(word_bits: u32, channels: usize) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let ports = ports(word_bits as usize, channels);
    Ok(Box::new(Simulated::new(
        "sample_select",
        block(word_bits, channels),
        ports,
    )?))
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
    emit::emit(block(word_bits, channels).as_ref(), &options)
}
