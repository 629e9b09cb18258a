//! What the axes of the inline shaper share in hardware: enable, emergency stop, bypass and the clearing of faults.
//!
//! The reference is `posicast_blocks::inline_group`.

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::prelude::*;
use crate::simulation::{Pins, Simulated, SimulationError};
use posicast_blocks::inline_group::{InlineGroupConfig, PORTS};
use posicast_blocks::{ClockedBlock, port_notes};

kernel! {
    /// Sizes: N axes, R requests of registers, 0 or 1.
    struct InlineGroup<const N: usize, const R: usize>;
    ports posicast_blocks::inline_group_ports;

    parts {
        enable_line: Synchroniser,
        emergency_line: Synchroniser,
        bypass_line: Synchroniser,
        clear_line: Synchroniser,
    }
    registers {
        clear_before: Bit, awake: Bit, emergency: Bit, run_q: Bit, clear_q: Bit, bypassed_q: Bit, settled_q: Bit,
        fault_q: Bit,
    }
    wires { all_settled: Bit, any_fault: Bit }
}

impl<const N: usize, const R: usize> Logic for InlineGroup<N, R> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module inline_group");

        self.enable_line.pin.next = self.enable.val();
        self.emergency_line.pin.next = !self.emergency_stop_n.val();
        self.bypass_line.pin.next = self.bypass.val();
        self.clear_line.pin.next = self.clear_faults.val();

        self.all_settled.next = true;
        self.any_fault.next = false;
        for i in 0..N {
            if !self.axis_settled[i].val() {
                self.all_settled.next = false;
            }
            if self.axis_fault[i].val() {
                self.any_fault.next = true;
            }
        }

        comment!("An emergency stop is kept; setting wins");
        self.clear_before.d.next = self.clear_line.level.val();
        self.clear_q.d.next = self.clear_line.level.val() & !self.clear_before.q.val();
        if self.clear_q.q.val() {
            self.emergency.d.next = false;
        }
        if self.emergency_line.level.val() {
            self.emergency.d.next = true;
        }
        self.run_q.d.next = self.enable_line.level.val()
            & !self.emergency_line.level.val()
            & !self.emergency.q.val()
            & !self.any_fault.val();
        self.fault_q.d.next = self.emergency.q.val() | self.any_fault.val();
        self.settled_q.d.next = self.all_settled.val();

        comment!("Shaped and unshaped positions are equal here");
        if self.tick.val() & (self.all_settled.val() | !self.run_q.q.val()) {
            self.bypassed_q.d.next = self.bypass_line.level.val();
            for i in 0..R {
                if self.bypass_request[i].val() {
                    self.bypassed_q.d.next = true;
                }
            }
        }

        comment!("The drives, without a clock");
        self.awake.d.next = true;
        self.drive_enable.next =
            self.enable.val() & self.emergency_stop_n.val() & self.awake.q.val() & !self.emergency.q.val();

        self.run.next = self.run_q.q.val();
        self.clear.next = self.clear_q.q.val();
        self.bypassed.next = self.bypassed_q.q.val();
        self.settled.next = self.settled_q.q.val();
        self.fault.next = self.fault_q.q.val();
    }
}

fn block(config: InlineGroupConfig) -> Box<dyn Pins> {
    match (config.axes, config.with_registers) {
        (0 | 1, false) => Box::new(InlineGroup::<1, 0>::default()),
        (2, false) => Box::new(InlineGroup::<2, 0>::default()),
        (3, false) => Box::new(InlineGroup::<3, 0>::default()),
        (_, false) => Box::new(InlineGroup::<4, 0>::default()),
        (0 | 1, true) => Box::new(InlineGroup::<1, 1>::default()),
        (2, true) => Box::new(InlineGroup::<2, 1>::default()),
        (3, true) => Box::new(InlineGroup::<3, 1>::default()),
        (_, true) => Box::new(InlineGroup::<4, 1>::default()),
    }
}

/// The group in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate(config: InlineGroupConfig) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    Ok(Box::new(Simulated::new("inline_group", block(config), config.ports())?))
}

/// Name of the last module that [`emit()`] writes.
pub fn name(config: InlineGroupConfig, prefix: &str) -> String {
    emit::shared_name(prefix, &base_name(config))
}

fn base_name(config: InlineGroupConfig) -> String {
    let registers = if config.with_registers { "_registers" } else { "" };
    format!("inline_group_{}{registers}", config.axes)
}

/// Verilog of the group; [`name`] gives its name.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(config: InlineGroupConfig, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: base_name(config),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Enable, emergency stop, bypass and the clearing of faults, for all axes of the inline shaper."
                .to_owned(),
            ports: port_notes(PORTS),
            parameters: vec![Parameter {
                name: "axes".to_owned(),
                value: config.axes.to_string(),
                meaning: "axes of the inline shaper".to_owned(),
            }],
        },
    };
    emit::emit(block(config).as_ref(), &options)
}
