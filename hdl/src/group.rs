//! Couples the axes of a stage: common start, group stop, emergency stop, feed hold. Requested axes start in the same
//! clock; an axis that stops because of a fault stops all others.
//!
//! The reference is `posicast_blocks::group`.

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::prelude::*;
use crate::simulation::{Pins, Simulated, SimulationError};
use posicast_blocks::group::{PORTS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

kernel! {
    /// Sizes: N axes.
    struct Group<const N: usize>;
    ports posicast_blocks::group_ports;

    registers { start_q[N]: Bit, stop_q[N]: Bit, hold_q[N]: Bit, emergency_q: Bit, refused_q: Bit }
    wires { blocked: Bit, moving: Bit }
    constants {
        axis[N]: Bits<4> = |axis| from_u64(1 << axis),
        strangers: Bits<4> = from_u64((0xf << N) & 0xf),
        nobody: Bits<4> = from_u64(0),
    }
}

impl<const N: usize> Logic for Group<N> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module group");

        comment!("All requested axes start, or none");
        self.blocked.next = (self.start_axes.val() == self.nobody.val())
            | ((self.start_axes.val() & self.strangers.val()) != self.nobody.val());
        for i in 0..N {
            if ((self.start_axes.val() & self.axis[i].val()) != self.nobody.val()) & !self.can_start[i].val() {
                self.blocked.next = true;
            }
        }
        self.refused_q.d.next = self.start.val() & self.blocked.val();
        for i in 0..N {
            self.start_q[i].d.next = self.start.val()
                & !self.blocked.val()
                & ((self.start_axes.val() & self.axis[i].val()) != self.nobody.val());
        }

        comment!("An axis that stops also stops the others");
        self.emergency_q.d.next = false;
        for i in 0..N {
            self.stop_q[i].d.next = false;
            for j in 0..N {
                if self.wants_group_stop[j].val() & (self.axis[i].val() != self.axis[j].val()) {
                    self.stop_q[i].d.next = true;
                }
            }
            if self.emergency_stop[i].val() {
                self.emergency_q.d.next = true;
            }
        }

        comment!("The feed hold begins once all its axes rest");
        self.moving.next = false;
        for i in 0..N {
            if self.feed_hold[i].val() & !self.rests[i].val() {
                self.moving.next = true;
            }
        }
        for i in 0..N {
            self.hold_q[i].d.next = self.feed_hold[i].val() & !self.moving.val();
        }

        for i in 0..N {
            self.axis_start[i].next = self.start_q[i].q.val();
            self.group_stop[i].next = self.stop_q[i].q.val();
            self.hold_feed[i].next = self.hold_q[i].q.val();
        }
        self.group_emergency_stop.next = self.emergency_q.q.val();
        self.start_refused.next = self.refused_q.q.val();
    }
}

fn block(axes: usize) -> Box<dyn Pins> {
    match axes {
        0 | 1 => Box::new(Group::<1>::default()),
        2 => Box::new(Group::<2>::default()),
        3 => Box::new(Group::<3>::default()),
        _ => Box::new(Group::<4>::default()),
    }
}

/// The group of this many axes, 1 to 4, in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate(axes: usize) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    Ok(Box::new(Simulated::new("group", block(axes), ports(axes))?))
}

/// Name of the last module that [`emit()`] writes.
pub fn name(axes: usize, prefix: &str) -> String {
    emit::shared_name(prefix, &base_name(axes))
}

fn base_name(axes: usize) -> String {
    format!("group_{axes}")
}

/// Verilog of the group of this many axes; [`name`] gives its name.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(axes: usize, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: base_name(axes),
        prefix: prefix.to_owned(),
        header: Header {
            about: String::new(),
            ports: port_notes(PORTS),
            parameters: vec![Parameter {
                name: "axes".to_owned(),
                value: axes.to_string(),
                meaning: "axes of the stage".to_owned(),
            }],
        },
    };
    emit::emit(block(axes).as_ref(), &options)
}
