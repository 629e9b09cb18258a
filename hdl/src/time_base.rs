//! The time base of a component that stands alone: ticks at a fixed distance, a clock counter, a tick counter.
//!
//! The reference is `posicast_model::rtl::time_base`.

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::prelude::*;
use crate::simulation::{Pins, Simulated, SimulationError};
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::divider::DividerConfig;
use posicast_model::rtl::time_base::ports;

#[derive(LogicBlock)]
struct TimeBase {
    clk: Signal<In, Clock>,
    rst: Signal<In, Bit>,
    tick: Signal<Out, Bit>,
    divide: Signal<Out, Bit>,
    time_stamp: Signal<Out, Bits<32>>,
    edge_stamp: Signal<Out, Bits<24>>,
    tick_count: Signal<Out, Bits<32>>,

    phase: Dff<Bits<17>>,
    tick_q: Dff<Bit>,
    divide_q: Dff<Bit>,
    time_stamp_q: Dff<Bits<32>>,
    tick_count_q: Dff<Bits<32>>,

    first_phase: Constant<Bits<17>>,
    one_phase: Constant<Bits<17>>,
    last_phase: Constant<Bits<17>>,
    used_phase: Constant<Bits<17>>,
    one_count: Constant<Bits<32>>,
}

impl TimeBase {
    fn new(divider: &DividerConfig) -> Self {
        let tick_clocks = u64::from(divider.tick_clocks());
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            tick: Signal::default(),
            divide: Signal::default(),
            time_stamp: Signal::default(),
            edge_stamp: Signal::default(),
            tick_count: Signal::default(),
            phase: Dff::default(),
            tick_q: Dff::default(),
            divide_q: Dff::default(),
            time_stamp_q: Dff::default(),
            tick_count_q: Dff::default(),
            first_phase: Constant::new(from_u64(0)),
            one_phase: Constant::new(from_u64(1)),
            last_phase: Constant::new(from_u64(tick_clocks - 1)),
            used_phase: Constant::new(from_u64(tick_clocks.next_power_of_two() - 1)),
            one_count: Constant::new(from_u64(1)),
        }
    }
}

impl Logic for TimeBase {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module time_base");
        dff_setup!(self, clk, phase, tick_q, divide_q, time_stamp_q, tick_count_q);

        comment!("The bits that a tick has not go at synthesis");
        self.phase.d.next = (self.phase.q.val() + self.one_phase.val()) & self.used_phase.val();
        self.tick_q.d.next = false;
        if self.phase.q.val() == self.last_phase.val() {
            self.phase.d.next = self.first_phase.val();
            self.tick_q.d.next = true;
            self.tick_count_q.d.next = self.tick_count_q.q.val() + self.one_count.val();
        }
        self.divide_q.d.next = self.tick_q.q.val();
        self.time_stamp_q.d.next = self.time_stamp_q.q.val() + self.one_count.val();

        self.tick.next = self.tick_q.q.val();
        self.divide.next = self.divide_q.q.val();
        self.time_stamp.next = self.time_stamp_q.q.val();
        self.edge_stamp.next = self.time_stamp_q.q.val().get_bits::<24>(0);
        self.tick_count.next = self.tick_count_q.q.val();
    }
}

impl Pins for TimeBase {
    fn set_clk(&mut self, level: bool) {
        self.clk.next = level.into();
    }

    fn drive(&mut self, inputs: &[u64]) {
        self.rst.next = inputs.first().is_some_and(|rst| rst & 1 != 0);
    }

    fn read(&self, outputs: &mut [u64]) {
        let shown = [
            u64::from(self.tick.val()),
            u64::from(self.divide.val()),
            self.time_stamp.val().into(),
            self.edge_stamp.val().into(),
            self.tick_count.val().into(),
        ];
        for (output, value) in outputs.iter_mut().zip(shown) {
            *output = value;
        }
    }
}

/// The time base in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds a fault in the block.
pub fn simulate(divider: &DividerConfig) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(TimeBase::new(divider));
    Ok(Box::new(Simulated::new("time_base", block, ports())?))
}

/// The name of the module that [`emit`] writes last.
pub fn name(divider: &DividerConfig, prefix: &str) -> String {
    emit::shared_name(prefix, &base_name(divider))
}

fn base_name(divider: &DividerConfig) -> String {
    format!("time_base_{}", divider.tick_clocks())
}

/// The time base's Verilog, with the ticks of `divider`, called as [`name`] says.
///
/// # Errors
/// [`EmitError`] where `prefix` makes no Verilog name.
pub fn emit(divider: &DividerConfig, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: base_name(divider),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Time base: a tick every so many clocks, a counter of clocks, a counter of ticks.\n\
                    divide is high in the clock after each tick."
                .to_owned(),
            parameters: vec![Parameter {
                name: "tick_clocks".to_owned(),
                value: divider.tick_clocks().to_string(),
                meaning: "clocks from tick to tick".to_owned(),
            }],
        },
    };
    emit::emit(&TimeBase::new(divider), &options)
}
