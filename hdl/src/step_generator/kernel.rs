//! The step generator: joins the line between samples and the pulser by the steps that are owed, counts, and drives the
//! lines.

use super::interpolation::StepInterpolation;
use super::pulser::StepPulser;
use crate::prelude::*;
use posicast_blocks::step_generator::{StepGeneratorConfig, StepMode};

kernel! {
    /// Sizes: A bits of the accumulator, B = A + 1.
    pub(super) struct StepGenerator<const A: usize, const B: usize>(config: &StepGeneratorConfig)
        where B == A + 1;
    ports posicast_blocks::step_generator_ports;

    parts {
        interpolation: StepInterpolation<A, B> = StepInterpolation::new(config),
        pulser: StepPulser = StepPulser::new(config),
    }
    registers {
        active_q: Bit, too_fast_q: Bit, owed_exceeded_q: Bit, owed_q: Bits<16>, count_q: Bits<32>, a_line: Bit,
        b_line: Bit,
    }
    wires {
        exceeds: Bit, stands: Bit, gives_up: Bit, gives_down: Bit, change: Bits<32>, next_count: Bits<32>,
        demanded: Bits<3>, given: Bits<3>, balance: Bits<3>, more: Signed<16>, next_owed: Bits<16>, owed_all: Bits<16>, pulses_up: Bit,
        pulses_down: Bit, pulses: Bit, quadrature_a: Bit,
    }
    constants {
        used_owed: Bits<16> = from_u64(used_owed(config)),
        unused_owed: Bits<16> = from_u64(0xffff ^ used_owed(config)),
        owed_sign: Bits<16> = from_u64(used_owed(config).div_ceil(2)),
        too_many_up: Bits<16> = from_u64(u64::from(config.owed_limit()) + 1),
        too_many_down: Bits<16> = from_u64((-1 - i64::from(config.owed_limit())) as u64 & used_owed(config)),
        no_steps: Bits<16> = from_u64(0),
        no_change: Bits<32> = from_u64(0),
        one_up: Bits<32> = from_u64(1),
        one_down: Bits<32> = from_u64(0xffff_ffff),
        none: Bits<3> = from_u64(0),
        plus_one: Bits<3> = from_u64(1),
        minus_one: Bits<3> = from_u64(7),
        step_direction: Bit = config.mode() == StepMode::StepDirection,
        up_down: Bit = config.mode() == StepMode::UpDown,
        quadrature: Bit = config.mode() == StepMode::Quadrature,
        a_off: Bit = config.lines_active_low().a,
        b_off: Bit = config.lines_active_low().b,
    }
    connect {
        interpolation: tick, position, stands;
    }
}

/// The bits that the owed steps need, their sign included: one more than the limit, either way.
fn used_owed(config: &StepGeneratorConfig) -> u64 {
    2 * (u64::from(config.owed_limit()) + 2).next_power_of_two() - 1
}

impl<const A: usize, const B: usize> Logic for StepGenerator<A, B> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module step_generator");

        comment!("Follow the position, or stop with a cause");
        self.exceeds.next =
            (self.owed_q.q.val() == self.too_many_up.val()) | (self.owed_q.q.val() == self.too_many_down.val());
        self.interpolation.runs.next = self.active_q.q.val() & self.enable.val() & !self.exceeds.val();
        self.stands.next = self.tick.val()
            & self.enable.val()
            & !self.active_q.q.val()
            & !self.too_fast_q.q.val()
            & !self.owed_exceeded_q.q.val();
        self.active_q.d.next = self.interpolation.keeps.val() | self.stands.val();
        if self.clear_flags.val() {
            self.too_fast_q.d.next = false;
            self.owed_exceeded_q.d.next = false;
        }
        if self.interpolation.too_fast.val() {
            self.too_fast_q.d.next = true;
        }
        if self.exceeds.val() {
            self.owed_exceeded_q.d.next = true;
        }

        comment!("Steps owed: those demanded less those given");
        self.pulser.wanted.next = self.active_q.q.val() & self.enable.val() & self.owed_q.q.val().any();
        self.owed_all.next = self.owed_q.q.val();
        if (self.owed_q.q.val() & self.owed_sign.val()).any() {
            self.owed_all.next = self.owed_q.q.val() | self.unused_owed.val();
        }
        self.pulser.wants_up.next = !self.owed_all.val().get_bit(15);
        self.gives_up.next = self.pulser.gives.val() & self.pulser.up.val();
        self.gives_down.next = self.pulser.gives.val() & !self.pulser.up.val();
        self.demanded.next = self.none.val();
        if self.interpolation.demands_up.val() {
            self.demanded.next = self.plus_one.val();
        }
        if self.interpolation.demands_down.val() {
            self.demanded.next = self.minus_one.val();
        }
        self.given.next = self.none.val();
        if self.gives_up.val() {
            self.given.next = self.minus_one.val();
        }
        if self.gives_down.val() {
            self.given.next = self.plus_one.val();
        }
        self.balance.next = self.demanded.val() + self.given.val();
        self.more.next = signed_bit_cast::<16, 3>(signed_cast(self.balance.val()));
        self.next_owed.next = (self.owed_q.q.val() + unsigned_cast(self.more.val())) & self.used_owed.val();
        self.owed_q.d.next = self.no_steps.val();
        if self.interpolation.keeps.val() {
            self.owed_q.d.next = self.next_owed.val();
        }

        comment!("The count changes with the edge of the step");
        self.change.next = self.no_change.val();
        if self.gives_up.val() {
            self.change.next = self.one_up.val();
        }
        if self.gives_down.val() {
            self.change.next = self.one_down.val();
        }
        self.next_count.next = self.count_q.q.val() + self.change.val();
        self.count_q.d.next = self.next_count.val();

        comment!("Lines: pulse and direction, two pulses, or quadrature");
        self.pulses.next = self.pulser.shows_pulse.val();
        self.pulses_up.next = self.pulses.val() & self.pulser.shows_up.val();
        self.pulses_down.next = self.pulses.val() & !self.pulser.shows_up.val();
        self.quadrature_a.next = self.next_count.val().get_bit(1) ^ self.next_count.val().get_bit(0);
        self.a_line.d.next = (self.step_direction.val() & self.pulses.val())
            | (self.up_down.val() & self.pulses_up.val())
            | (self.quadrature.val() & self.quadrature_a.val());
        self.b_line.d.next = (self.step_direction.val() & self.pulser.shows_up.val())
            | (self.up_down.val() & self.pulses_down.val())
            | (self.quadrature.val() & self.next_count.val().get_bit(1));

        self.a.next = self.a_line.q.val() ^ self.a_off.val();
        self.b.next = self.b_line.q.val() ^ self.b_off.val();
        self.count.next = signed_cast(self.count_q.q.val());
        self.owed.next = signed_cast(self.owed_all.val());
        self.active.next = self.active_q.q.val();
        self.too_fast.next = self.too_fast_q.q.val();
        self.owed_exceeded.next = self.owed_exceeded_q.q.val();
        self.tripped.next = self.too_fast_q.q.val() | self.owed_exceeded_q.q.val();
    }
}
