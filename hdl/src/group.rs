//! What the axes of a stage have to do with each other: common start, group stop, emergency stop.
//!
//! The reference is `posicast_model::rtl::group`.

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::prelude::*;
use crate::simulation::{Pins, Simulated, SimulationError};
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::group::ports;

/// N axes.
#[derive(LogicBlock)]
struct Group<const N: usize> {
    clk: Signal<In, Clock>,
    rst: Signal<In, Bit>,
    start: Signal<In, Bit>,
    start_axes: Signal<In, Bits<4>>,
    can_start: [Signal<In, Bit>; N],
    wants_group_stop: [Signal<In, Bit>; N],
    emergency_stop: [Signal<In, Bit>; N],
    feed_hold: [Signal<In, Bit>; N],
    rests: [Signal<In, Bit>; N],
    axis_start: [Signal<Out, Bit>; N],
    group_stop: [Signal<Out, Bit>; N],
    hold_feed: [Signal<Out, Bit>; N],
    group_emergency_stop: Signal<Out, Bit>,
    start_refused: Signal<Out, Bit>,

    start_q: [Dff<Bit>; N],
    stop_q: [Dff<Bit>; N],
    hold_q: [Dff<Bit>; N],
    emergency_q: Dff<Bit>,
    refused_q: Dff<Bit>,

    blocked: Signal<Local, Bit>,
    moving: Signal<Local, Bit>,

    axis: [Constant<Bits<4>>; N],
    strangers: Constant<Bits<4>>,
    nobody: Constant<Bits<4>>,
}

impl<const N: usize> Default for Group<N> {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            start: Signal::default(),
            start_axes: Signal::default(),
            can_start: std::array::from_fn(|_| Signal::default()),
            wants_group_stop: std::array::from_fn(|_| Signal::default()),
            emergency_stop: std::array::from_fn(|_| Signal::default()),
            feed_hold: std::array::from_fn(|_| Signal::default()),
            rests: std::array::from_fn(|_| Signal::default()),
            axis_start: std::array::from_fn(|_| Signal::default()),
            group_stop: std::array::from_fn(|_| Signal::default()),
            hold_feed: std::array::from_fn(|_| Signal::default()),
            group_emergency_stop: Signal::default(),
            start_refused: Signal::default(),
            start_q: std::array::from_fn(|_| Dff::default()),
            stop_q: std::array::from_fn(|_| Dff::default()),
            hold_q: std::array::from_fn(|_| Dff::default()),
            emergency_q: Dff::default(),
            refused_q: Dff::default(),
            blocked: Signal::default(),
            moving: Signal::default(),
            axis: std::array::from_fn(|axis| Constant::new(from_u64(1 << axis))),
            strangers: Constant::new(from_u64((0xf << N) & 0xf)),
            nobody: Constant::new(from_u64(0)),
        }
    }
}

impl<const N: usize> Logic for Group<N> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module group");
        dff_setup!(self, clk, emergency_q, refused_q);
        for i in 0..N {
            self.start_q[i].clock.next = self.clk.val();
            self.start_q[i].rst.next = self.rst.val();
            self.stop_q[i].clock.next = self.clk.val();
            self.stop_q[i].rst.next = self.rst.val();
            self.hold_q[i].clock.next = self.clk.val();
            self.hold_q[i].rst.next = self.rst.val();
        }

        comment!("All start, or none");
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

        comment!("One that stops stops the others");
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

        comment!("All that are to hold rest, or none holds");
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

impl<const N: usize> Pins for Group<N> {
    fn set_clk(&mut self, level: bool) {
        self.clk.next = level.into();
    }

    fn drive(&mut self, inputs: &[u64]) {
        let mut values = inputs.iter().copied();
        let mut next = || values.next().unwrap_or_default();
        self.rst.next = next() & 1 != 0;
        self.start.next = next() & 1 != 0;
        self.start_axes.next = from_u64(next());
        for lines in [
            &mut self.can_start,
            &mut self.wants_group_stop,
            &mut self.emergency_stop,
            &mut self.feed_hold,
            &mut self.rests,
        ] {
            for line in lines {
                line.next = next() & 1 != 0;
            }
        }
    }

    fn read(&self, outputs: &mut [u64]) {
        let axes = self.axis_start.iter().chain(&self.group_stop).chain(&self.hold_feed);
        let shared = [&self.group_emergency_stop, &self.start_refused];
        for (output, line) in outputs.iter_mut().zip(axes.chain(shared)) {
            *output = line.val().into();
        }
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

/// The group of so many axes, 1 to 4, in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds a fault in the block.
pub fn simulate(axes: usize) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    Ok(Box::new(Simulated::new("group", block(axes), ports(axes))?))
}

/// The name of the module that [`emit`] writes last.
pub fn name(axes: usize, prefix: &str) -> String {
    emit::shared_name(prefix, &base_name(axes))
}

fn base_name(axes: usize) -> String {
    format!("group_{axes}")
}

/// The Verilog of the group of so many axes, called as [`name`] says.
///
/// # Errors
/// [`EmitError`] where `prefix` makes no Verilog name.
pub fn emit(axes: usize, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let options = EmitOptions {
        top: base_name(axes),
        prefix: prefix.to_owned(),
        header: Header {
            about: "Axes of a stage: they start in one clock, and one that stops for a fault stops all.".to_owned(),
            parameters: vec![Parameter {
                name: "axes".to_owned(),
                value: axes.to_string(),
                meaning: "axes of the stage".to_owned(),
            }],
        },
    };
    emit::emit(block(axes).as_ref(), &options)
}
