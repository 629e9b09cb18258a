//! One divider for all pulse counters of a stage: their divisions one after the other, in a fixed order.
//!
//! The reference is `posicast_model::rtl::divider_share`.

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::prelude::*;
use crate::simulation::{Pins, Simulated, SimulationError};
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::divider_share::{MOST_CHANNELS, SHARE_CLOCKS, ports};

/// C channels.
#[derive(LogicBlock)]
struct DividerShare<const C: usize> {
    clk: Signal<In, Clock>,
    rst: Signal<In, Bit>,
    divide: Signal<In, Bit>,
    steps_of: [Signal<In, Signed<18>>; C],
    elapsed_of: [Signal<In, Bits<24>>; C],
    done: Signal<In, Bit>,
    start: Signal<Out, Bit>,
    steps: Signal<Out, Signed<18>>,
    elapsed: Signal<Out, Bits<24>>,
    quotient_valid: [Signal<Out, Bit>; C],

    turn: Dff<Bits<4>>,
    start_q: Dff<Bit>,
    steps_q: Dff<Signed<18>>,
    elapsed_q: Dff<Bits<24>>,
    valid_q: [Dff<Bit>; C],

    is_idle: Signal<Local, Bit>,
    begins: Signal<Local, Bit>,
    next_turn: Signal<Local, Bits<4>>,

    channel: [Constant<Bits<4>>; C],
    first_channel: Constant<Bits<4>>,
    last_channel: Constant<Bits<4>>,
    idle: Constant<Bits<4>>,
    one: Constant<Bits<4>>,
}

impl<const C: usize> Default for DividerShare<C> {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            divide: Signal::default(),
            steps_of: std::array::from_fn(|_| Signal::default()),
            elapsed_of: std::array::from_fn(|_| Signal::default()),
            done: Signal::default(),
            start: Signal::default(),
            steps: Signal::default(),
            elapsed: Signal::default(),
            quotient_valid: std::array::from_fn(|_| Signal::default()),
            turn: Dff::new(from_u64(MOST_CHANNELS as u64)),
            start_q: Dff::default(),
            steps_q: Dff::default(),
            elapsed_q: Dff::default(),
            valid_q: std::array::from_fn(|_| Dff::default()),
            is_idle: Signal::default(),
            begins: Signal::default(),
            next_turn: Signal::default(),
            channel: std::array::from_fn(|channel| Constant::new(from_u64(channel as u64))),
            first_channel: Constant::new(from_u64(0)),
            last_channel: Constant::new(from_u64(C as u64 - 1)),
            idle: Constant::new(from_u64(MOST_CHANNELS as u64)),
            one: Constant::new(from_u64(1)),
        }
    }
}

impl<const C: usize> Logic for DividerShare<C> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module divider_share");
        dff_setup!(self, clk, turn, start_q, steps_q, elapsed_q);
        for i in 0..C {
            self.valid_q[i].clock.next = self.clk.val();
            self.valid_q[i].rst.next = self.rst.val();
            self.valid_q[i].d.next = self.done.val() & (self.turn.q.val() == self.channel[i].val());
        }

        comment!("A tick's first division, or the next one");
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

        comment!("Its operands");
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

impl<const C: usize> Pins for DividerShare<C> {
    fn set_clk(&mut self, level: bool) {
        self.clk.next = level.into();
    }

    fn drive(&mut self, inputs: &[u64]) {
        let mut values = inputs.iter().copied();
        let mut next = || values.next().unwrap_or_default();
        self.rst.next = next() & 1 != 0;
        self.divide.next = next() & 1 != 0;
        for steps in &mut self.steps_of {
            steps.next = from_i64(next() as i64);
        }
        for elapsed in &mut self.elapsed_of {
            elapsed.next = from_u64(next());
        }
        self.done.next = next() & 1 != 0;
    }

    fn read(&self, outputs: &mut [u64]) {
        let shown = [
            self.start.val().into(),
            unsigned_cast(self.steps.val()).into(),
            self.elapsed.val().into(),
        ];
        let valid = self.quotient_valid.iter().map(|valid| valid.val().into());
        for (output, value) in outputs.iter_mut().zip(shown.into_iter().chain(valid)) {
            *output = value;
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

/// The share of so many channels, 1 to [`MOST_CHANNELS`], in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds a fault in the block.
pub fn simulate(channels: usize) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    Ok(Box::new(Simulated::new(
        "divider_share",
        block(channels),
        ports(channels),
    )?))
}

/// The name of the module that [`emit`] writes last.
pub fn name(channels: usize, prefix: &str) -> String {
    emit::shared_name(prefix, &base_name(channels))
}

fn base_name(channels: usize) -> String {
    format!("divider_share_{channels}")
}

/// The Verilog of the share of so many channels, called as [`name`] says.
///
/// # Errors
/// [`EmitError`] where `prefix` makes no Verilog name.
pub fn emit(channels: usize, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let parameter = |name: &str, value: String, meaning: &str| Parameter {
        name: name.to_owned(),
        value,
        meaning: meaning.to_owned(),
    };
    let options = EmitOptions {
        top: base_name(channels),
        prefix: prefix.to_owned(),
        header: Header {
            about: "One divider for all pulse counters: their divisions one after the other.".to_owned(),
            parameters: vec![
                parameter("channels", channels.to_string(), "pulse counters"),
                parameter("share_clocks", SHARE_CLOCKS.to_string(), "clocks per channel"),
            ],
        },
    };
    emit::emit(block(channels).as_ref(), &options)
}
