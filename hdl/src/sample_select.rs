//! Where the samples of a stand-alone shaper come from: the host's registers, or pins. One clock late.
//!
//! The reference is `posicast_model::rtl::sample_select`.

use crate::emit::{self, EmitError, EmitOptions, Header, Module};
use crate::prelude::*;
use crate::simulation::{Pins, Simulated, SimulationError};
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::sample_select::ports;

/// W word, C channels.
#[derive(LogicBlock)]
struct SampleSelect<const W: usize, const C: usize> {
    clk: Signal<In, Clock>,
    rst: Signal<In, Bit>,
    from_pins: Signal<In, Bit>,
    host_strobe: Signal<In, Bit>,
    host_start: Signal<In, Bit>,
    host_x: [Signal<In, Signed<W>>; C],
    pin_strobe: Signal<In, Bit>,
    pin_start: Signal<In, Bit>,
    pin_x: [Signal<In, Signed<W>>; C],
    strobe: Signal<Out, Bit>,
    start: Signal<Out, Bit>,
    x: [Signal<Out, Signed<W>>; C],

    strobe_q: Dff<Bit>,
    start_q: Dff<Bit>,
    x_q: [Dff<Signed<W>>; C],
}

impl<const W: usize, const C: usize> Default for SampleSelect<W, C> {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            from_pins: Signal::default(),
            host_strobe: Signal::default(),
            host_start: Signal::default(),
            host_x: std::array::from_fn(|_| Signal::default()),
            pin_strobe: Signal::default(),
            pin_start: Signal::default(),
            pin_x: std::array::from_fn(|_| Signal::default()),
            strobe: Signal::default(),
            start: Signal::default(),
            x: std::array::from_fn(|_| Signal::default()),
            strobe_q: Dff::default(),
            start_q: Dff::default(),
            x_q: std::array::from_fn(|_| Dff::default()),
        }
    }
}

impl<const W: usize, const C: usize> Logic for SampleSelect<W, C> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module sample_select");
        dff_setup!(self, clk, strobe_q, start_q);
        for i in 0..C {
            self.x_q[i].clock.next = self.clk.val();
            self.x_q[i].rst.next = self.rst.val();
            self.x_q[i].d.next = self.x_q[i].q.val();
        }

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

impl<const W: usize, const C: usize> Pins for SampleSelect<W, C> {
    fn set_clk(&mut self, level: bool) {
        self.clk.next = level.into();
    }

    fn drive(&mut self, inputs: &[u64]) {
        let mut values = inputs.iter().copied();
        let mut next = || values.next().unwrap_or_default();
        self.rst.next = next() & 1 != 0;
        self.from_pins.next = next() & 1 != 0;
        self.host_strobe.next = next() & 1 != 0;
        self.host_start.next = next() & 1 != 0;
        for x in &mut self.host_x {
            x.next = from_i64(next() as i64);
        }
        self.pin_strobe.next = next() & 1 != 0;
        self.pin_start.next = next() & 1 != 0;
        for x in &mut self.pin_x {
            x.next = from_i64(next() as i64);
        }
    }

    fn read(&self, outputs: &mut [u64]) {
        let flags = [u64::from(self.strobe.val()), u64::from(self.start.val())];
        let words = self.x.iter().map(|x| unsigned_cast(x.val()).into());
        for (output, value) in outputs.iter_mut().zip(flags.into_iter().chain(words)) {
            *output = value;
        }
    }
}

/// The sizes that components have: those of shapers, a duty, and five words of 32 bits for a controller.
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

/// The selection in RustHDL's own simulator, for words of so many bits and so many channels.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds a fault in the block.
pub fn simulate(word_bits: u32, channels: usize) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let ports = ports(word_bits, channels);
    Ok(Box::new(Simulated::new(
        "sample_select",
        block(word_bits, channels),
        ports,
    )?))
}

/// The name of the module that [`emit`] writes last.
pub fn name(word_bits: u32, channels: usize, prefix: &str) -> String {
    emit::shared_name(prefix, &base_name(word_bits, channels))
}

fn base_name(word_bits: u32, channels: usize) -> String {
    format!("sample_select_{word_bits}x{channels}")
}

/// The selection's Verilog, called as [`name`] says.
///
/// # Errors
/// [`EmitError`] where `prefix` makes no Verilog name.
pub fn emit(word_bits: u32, channels: usize, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: base_name(word_bits, channels),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Samples from the host's registers or from pins, a clock late.".to_owned(),
            parameters: Vec::new(),
        },
    };
    emit::emit(block(word_bits, channels).as_ref(), &options)
}
