//! The time base of a component that stands alone: ticks at a fixed distance, a clock counter, a tick counter.
//! `divide` is high in the clock after each tick.
//!
//! The reference is `posicast_blocks::time_base`.

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::prelude::*;
use crate::simulation::{Simulated, SimulationError};
use posicast_blocks::divider::DividerConfig;
use posicast_blocks::time_base::{PORTS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

kernel! {
    struct TimeBase(divider: &DividerConfig);
    ports posicast_blocks::time_base_ports;

    registers { phase: Bits<17>, tick_q: Bit, divide_q: Bit, time_stamp_q: Bits<32>, tick_count_q: Bits<32> }
    constants {
        first_phase: Bits<17> = from_u64(0),
        one_phase: Bits<17> = from_u64(1),
        last_phase: Bits<17> = from_u64(u64::from(divider.tick_clocks()) - 1),
        used_phase: Bits<17> = from_u64(u64::from(divider.tick_clocks()).next_power_of_two() - 1),
        one_count: Bits<32> = from_u64(1),
    }
}

impl Logic for TimeBase {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module time_base");

        comment!("Synthesis removes bits that a tick does not need");
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

/// The time base in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate(divider: &DividerConfig) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(TimeBase::new(divider));
    Ok(Box::new(Simulated::new("time_base", block, ports())?))
}

/// Name of the last module that [`emit()`] writes.
pub fn name(divider: &DividerConfig, prefix: &str) -> String {
    emit::shared_name(prefix, &base_name(divider))
}

fn base_name(divider: &DividerConfig) -> String {
    format!("time_base_{}", divider.tick_clocks())
}

/// Verilog of the time base with the clocks per tick of `divider`; [`name`] gives its name.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(divider: &DividerConfig, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: base_name(divider),
        prefix: prefix.to_owned(),
        header: Header {
            about: String::new(),
            ports: port_notes(PORTS),
            parameters: vec![Parameter {
                name: "tick_clocks".to_owned(),
                value: divider.tick_clocks().to_string(),
                meaning: "clocks from tick to tick".to_owned(),
            }],
        },
    };
    emit::emit(&TimeBase::new(divider), &options)
}
