//! Starts the controllers of a stage a fixed number of clocks after each tick.
//!
//! The reference is `posicast_blocks::schedule`.
//!
//! A free-running counter is 0 in the clock after a tick, and has as many bits as the time needs; synthesis removes the
//! bits above. `waits` is high from the tick to the start: only then the end of the count matters.

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::prelude::*;
use crate::simulation::{Simulated, SimulationError};
use posicast_blocks::schedule::{PORTS, ScheduleConfig, ports};
use posicast_blocks::{ClockedBlock, port_notes};

kernel! {
    struct Schedule(config: &ScheduleConfig);
    ports posicast_blocks::schedule_ports;

    registers { since: Bits<17>, waits: Bit, control_q: Bit }
    wires { ends: Bit }
    constants {
        none: Bits<17> = from_u64(0),
        one: Bits<17> = from_u64(1),
        last: Bits<17> = from_u64(u64::from(config.control_clocks()) - 2),
        used: Bits<17> = from_u64(((u64::from(config.control_clocks()) - 2) + 1).next_power_of_two().max(2) - 1),
    }
}

impl Logic for Schedule {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module schedule");

        self.since.d.next = (self.since.q.val() + self.one.val()) & self.used.val();
        self.ends.next = self.waits.q.val() & (self.since.q.val() == self.last.val());
        self.control_q.d.next = self.ends.val();
        if self.ends.val() {
            self.waits.d.next = false;
        }
        if self.tick.val() {
            self.since.d.next = self.none.val();
            self.waits.d.next = true;
        }

        self.control.next = self.control_q.q.val();
    }
}

/// The schedule in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate(config: &ScheduleConfig) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(Schedule::new(config));
    Ok(Box::new(Simulated::new("schedule", block, ports())?))
}

/// Name of the last module that [`emit()`] writes.
pub fn name(config: &ScheduleConfig, prefix: &str) -> String {
    emit::shared_name(prefix, &base_name(config))
}

fn base_name(config: &ScheduleConfig) -> String {
    format!("schedule_{}", config.control_clocks())
}

/// Verilog of the schedule; [`name`] gives its name.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(config: &ScheduleConfig, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: base_name(config),
        prefix: prefix.to_owned(),
        header: Header {
            about: String::new(),
            ports: port_notes(PORTS),
            parameters: vec![Parameter {
                name: "control_clocks".to_owned(),
                value: config.control_clocks().to_string(),
                meaning: "clocks from the tick to control".to_owned(),
            }],
        },
    };
    emit::emit(&Schedule::new(config), &options)
}
