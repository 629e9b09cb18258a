//! One axis of the inline shaper in hardware: it samples the counted command, and says what the step generator follows.
//!
//! The datasheet is `docs/inline_axis.md`, the reference `posicast_blocks::inline_axis`.

use crate::emit::{self, EmitError, EmitOptions, Header, Module, Parameter};
use crate::prelude::*;
use crate::simulation::{Simulated, SimulationError};
use posicast_blocks::inline_axis::{InlineAxisConfig, PORTS, ports};
use posicast_blocks::{ClockedBlock, port_notes};

kernel! {
    struct InlineAxis(config: &InlineAxisConfig);
    ports posicast_blocks::inline_axis_ports;

    parts { line_a: PinRegister, line_b: PinRegister }
    registers {
        strobe_q: Bit, start_q: Bit, sampled: Bits<24>, position_q: Bits<32>, follow_q: Bit, stood: Bits<14>,
        offset: Bits<32>, settled_q: Bit, input_too_fast_q: Bit, steps_stopped_q: Bit, input_illegal_q: Bit,
    }
    wires {
        count_bits: Bits<32>, difference: Bits<18>, biased: Bits<18>, moved: Bit, exceeds: Bit, stops: Bit, illegal_now: Bit,
        caused: Bit, has_cause: Bit, goes: Bit, behind: Bits<32>, has_stood: Bit, sampled_x: Bits<32>,
    }
    constants {
        a_low: Bit = config.lines_active_low().a,
        b_low: Bit = config.lines_active_low().b,
        middle: Bits<18> = from_u64(1 << 17),
        most: Bits<18> = from_u64((1 << 17) + u64::from(config.limit_steps())),
        least: Bits<18> = from_u64((1 << 17) - u64::from(config.limit_steps())),
        settle_ticks: Bits<14> = from_u64(config.settle_ticks().into()),
        one_tick: Bits<14> = from_u64(1),
        no_ticks: Bits<14> = from_u64(0),
    }
}

impl Logic for InlineAxis {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module inline_axis");

        comment!("Lines of the command, high if they are active");
        self.line_a.pin.next = self.pin_a.val() ^ self.a_low.val();
        self.line_b.pin.next = self.pin_b.val() ^ self.b_low.val();
        self.a.next = self.line_a.level.val();
        self.b.next = self.line_b.level.val();

        comment!("Steps of the input since the last tick");
        self.count_bits.next = unsigned_cast(self.count.val());
        self.difference.next = self.count_bits.val().get_bits::<18>(0) - self.sampled.q.val().get_bits::<18>(0);
        self.biased.next = self.difference.val() ^ self.middle.val();
        self.moved.next = self.difference.val().any();
        self.exceeds.next = self.tick.val()
            & self.follow_q.q.val()
            & ((self.biased.val() > self.most.val()) | (self.biased.val() < self.least.val()));

        comment!("Causes; setting wins over clearing");
        self.stops.next = self.follow_q.q.val() & (self.too_fast.val() | self.owed_exceeded.val());
        self.illegal_now.next = self.follow_q.q.val() & self.illegal.val();
        self.has_cause.next =
            self.input_too_fast_q.q.val() | self.steps_stopped_q.q.val() | self.input_illegal_q.q.val();
        self.caused.next = self.exceeds.val() | self.stops.val() | self.illegal_now.val() | self.has_cause.val();
        if self.clear.val() {
            self.input_too_fast_q.d.next = false;
            self.steps_stopped_q.d.next = false;
            self.input_illegal_q.d.next = false;
        }
        if self.exceeds.val() {
            self.input_too_fast_q.d.next = true;
        }
        if self.stops.val() {
            self.steps_stopped_q.d.next = true;
        }
        if self.illegal_now.val() {
            self.input_illegal_q.d.next = true;
        }

        comment!("Follow from a tick on, and stop at once");
        self.goes.next = self.run.val() & !self.caused.val();
        self.follow_q.d.next = self.goes.val() & (self.follow_q.q.val() | self.tick.val());
        self.strobe_q.d.next = self.tick.val();
        self.start_q.d.next = self.tick.val() & !self.follow_q.q.val();

        comment!("At a tick: sample, and count how long it stands");
        self.behind.next = self.count_bits.val() - unsigned_cast(self.given.val());
        self.has_stood.next = self.stood.q.val() == self.settle_ticks.val();
        if self.tick.val() {
            self.sampled.d.next = self.count_bits.val().get_bits::<24>(0);
            if !self.has_stood.val() {
                self.stood.d.next = self.stood.q.val() + self.one_tick.val();
            }
            if self.moved.val() {
                self.stood.d.next = self.no_ticks.val();
            }
            if !self.follow_q.q.val() {
                self.stood.d.next = self.no_ticks.val();
                self.offset.d.next = self.behind.val();
            }
        }
        self.settled_q.d.next =
            self.follow_q.q.val() & self.goes.val() & self.has_stood.val() & (self.behind.val() == self.offset.q.val());

        comment!("The position that the step generator takes");
        self.sampled_x.next = bit_cast::<32, 24>(self.sampled.q.val()) << 8;
        self.position_q.d.next = unsigned_cast(self.shaped.val());
        if self.unshaped.val() {
            self.position_q.d.next = self.sampled_x.val();
        }

        self.strobe.next = self.strobe_q.q.val();
        self.start.next = self.start_q.q.val();
        self.x.next = signed_cast(self.sampled_x.val());
        self.position.next = signed_cast(self.position_q.q.val());
        self.follow.next = self.follow_q.q.val();
        self.settled.next = self.settled_q.q.val();
        self.fault.next = self.has_cause.val();
        self.input_too_fast.next = self.input_too_fast_q.q.val();
        self.steps_stopped.next = self.steps_stopped_q.q.val();
        self.input_illegal.next = self.input_illegal_q.q.val();
    }
}

/// The inline axis in RustHDL's own simulator.
///
/// # Errors
/// [`SimulationError`] where RustHDL finds an error in the block.
pub fn simulate(config: &InlineAxisConfig) -> Result<Box<dyn ClockedBlock>, SimulationError> {
    let block = Box::new(InlineAxis::new(config));
    Ok(Box::new(Simulated::new("inline_axis", block, ports())?))
}

/// Name of the last module that [`emit()`] writes.
pub fn name(config: &InlineAxisConfig, prefix: &str) -> String {
    emit::shared_name(prefix, &base_name(config))
}

fn base_name(config: &InlineAxisConfig) -> String {
    let low = config.lines_active_low();
    let polarity = [low.a, low.b].map(|low| if low { '1' } else { '0' });
    format!(
        "inline_axis_{}_{}_{}{}",
        config.limit_steps(),
        config.settle_ticks(),
        polarity[0],
        polarity[1]
    )
}

/// Verilog of an axis of the inline shaper; [`name`] gives its name.
///
/// # Errors
/// [`EmitError`] where `prefix` is not a valid Verilog name.
pub fn emit(config: &InlineAxisConfig, prefix: &str) -> Result<Vec<Module>, EmitError> {
    let low = config.lines_active_low();
    let low = match (low.a, low.b) {
        (false, false) => "none",
        (true, false) => "a",
        (false, true) => "b",
        (true, true) => "a b",
    };
    let options = EmitOptions {
        top: base_name(config),
        prefix: prefix.to_owned(),
        header: Header {
            about:
                "Axis of the inline shaper: samples the counted command, and says what the step generator follows.\n\
                    The synchronisers of the pulse counter must follow a and b."
                    .to_owned(),
            ports: port_notes(PORTS),
            parameters: vec![
                Parameter::new(
                    "limit_steps",
                    config.limit_steps(),
                    "of the input in a tick; more stop the axis",
                ),
                Parameter::new(
                    "settle_ticks",
                    config.settle_ticks(),
                    "without a step of the input, until it may be settled",
                ),
                Parameter::new("active low lines", low, "off at high"),
            ],
        },
    };
    emit::emit(&InlineAxis::new(config), &options)
}
