//! Shares one divider among all pulse counters of a stage: their divisions run one after the other, in a fixed order.
//!
//! The reference is `posicast_blocks::divider_share`.

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::prelude::*;
use crate::simulation::{Pins, Simulated, SimulationError};
use posicast_blocks::divider_share::{MOST_CHANNELS, PORTS, SHARE_CLOCKS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

kernel! {
    /// Sizes: C channels.
    struct DividerShare<const C: usize>;
    ports posicast_blocks::divider_share_ports;

    registers {
        turn: Bits<4> = from_u64(MOST_CHANNELS as u64),
        start_q: Bit, steps_q: Signed<18>, elapsed_q: Bits<24>, valid_q[C]: Bit,
    }
    wires { is_idle: Bit, begins: Bit, next_turn: Bits<4> }
    constants {
        channel[C]: Bits<4> = |channel| from_u64(channel as u64),
        first_channel: Bits<4> = from_u64(0),
        last_channel: Bits<4> = from_u64(C as u64 - 1),
        idle: Bits<4> = from_u64(MOST_CHANNELS as u64),
        one: Bits<4> = from_u64(1),
    }
}

impl<const C: usize> Logic for DividerShare<C> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module divider_share");
        for i in 0..C {
            self.valid_q[i].d.next = self.done.val() & (self.turn.q.val() == self.channel[i].val());
        }

        comment!("Starts a tick's first division, or the next one");
        self.is_idle.next = self.turn.q.val() == self.idle.val();
        self.next_turn.next = self.turn.q.val() + self.one.val();
        self.begins.next = self.done.val() & (self.turn.q.val() != self.last_channel.val());
        if self.is_idle.val() {
            self.next_turn.next = self.first_channel.val();
            self.begins.next = self.divide.val();
        }
        if self.done.val() {
            self.turn.d.next = self.idle.val();
        }
        if self.begins.val() {
            self.turn.d.next = self.next_turn.val();
        }

        comment!("Operands of the channel");
        self.start_q.d.next = self.begins.val();
        for i in 0..C {
            if self.begins.val() & (self.next_turn.val() == self.channel[i].val()) {
                self.steps_q.d.next = self.steps_of[i].val();
                self.elapsed_q.d.next = self.elapsed_of[i].val();
            }
        }

        self.start.next = self.start_q.q.val();
        self.steps.next = self.steps_q.q.val();
        self.elapsed.next = self.elapsed_q.q.val();
        for i in 0..C {
            self.quotient_valid[i].next = self.valid_q[i].q.val();
        }
    }
}

fn block(channels: usize) -> Box<dyn Pins> {
    match channels {
        0 | 1 => Box::new(DividerShare::<1>::default()),
        2 => Box::new(DividerShare::<2>::default()),
        3 => Box::new(DividerShare::<3>::default()),
        4 => Box::new(DividerShare::<4>::default()),
        5 => Box::new(DividerShare::<5>::default()),
        6 => Box::new(DividerShare::<6>::default()),
        7 => Box::new(DividerShare::<7>::default()),
        _ => Box::new(DividerShare::<8>::default()),
    }
}

/// The divider share for this many channels, 1 to [`MOST_CHANNELS`], in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate(channels: usize) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    Ok(Box::new(Simulated::new(
        "divider_share",
        block(channels),
        ports(channels),
    )?))
}

/// Name of the last module that [`emit()`] writes.
pub fn name(channels: usize, prefix: &str) -> String {
    emit::shared_name(prefix, &base_name(channels))
}

fn base_name(channels: usize) -> String {
    format!("divider_share_{channels}")
}

/// Verilog of the divider share for this many channels; [`name`] gives its name.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(channels: usize, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: base_name(channels),
        prefix: prefix.to_owned(),
        header: Header {
            about: String::new(),
            ports: port_notes(PORTS),
            parameters: vec![
                Parameter::new("channels", channels, "pulse counters"),
                Parameter::new("share_clocks", SHARE_CLOCKS, "clocks per channel"),
            ],
        },
    };
    emit::emit(block(channels).as_ref(), &options)
}
