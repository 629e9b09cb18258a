//! Computes angle, frequency and PRBS, and the product of amplitude and wave, with one sum per clock.
//!
//! ```text
//! valid     ‾‾‾\____________________________________
//! phase     rest< advance >< turn … turn >< 16 scale >< rest
//! ahead     ------< + frequency >< − period … >---------
//! value     ----- as before ---------------< 0 … >< new
//! ```
//!
//! `turn` lasts as long as a period can be subtracted. Every clock of `scale` halves the sum of the value and the
//! amplitude, or of the value alone, rounding away from 0: the bits of the triangle come lowest first, and those of a
//! square are all ones.

use crate::prelude::*;

kernel! {
    pub(super) struct Wave;

    inputs {
        rst: Bit,
        run: Bit,
        start: Bit,
        valid: Bit,
        chirp: Bit,
        prbs: Bit,
        amplitude: Bits<16>,
        period_ticks: Bits<16>,
        sweep: Bits<16>,
    }
    outputs { value: Signed<17>, too_fast: Bit }
    registers {
        phase: Bits<2>, clocks: Bits<4>, angle: Bits<8>, ahead: Bits<21>,
        frequency: Bits<22> = from_u64(1 << 16),
        turned: Bit, noise: Bits<15>, value_q: Signed<17>,
    }
    wires {
        advances: Bit, turns: Bit, scales: Bit, not_period: Bits<16>, operand: Bits<23>, with_carry: Bits<23>,
        ahead_sum: Bits<22>, next_frequency: Bits<23>, next_angle: Bits<8>, whole_turn: Bit,
        feedback: Bits<1>, negative: Bit, fold: Bit, triangle_bit: Bit, adds: Bit, subtrahend: Bits<18>,
        complement: Bits<18>, value_sum: Bits<18>, halved: Bits<17>, wide_value: Signed<18>,
    }
    constants {
        rest_phase: Bits<2> = from_u64(0),
        advance_phase: Bits<2> = from_u64(1),
        turn_phase: Bits<2> = from_u64(2),
        scale_phase: Bits<2> = from_u64(3),
        no_clock: Bits<4> = from_u64(0),
        one_clock: Bits<4> = from_u64(1),
        no_angle: Bits<8> = from_u64(0),
        one_step: Bits<8> = from_u64(1),
        not_ahead: Bits<21> = from_u64(0),
        carry_in: Bits<23> = from_u64(1),
        ones_around: Bits<23> = from_u64(0x60_001f),
        first_frequency: Bits<22> = from_u64(1 << 16),
        no_bit: Bits<1> = from_u64(0),
        one_bit: Bits<1> = from_u64(1),
        seed: Bits<15> = from_u64(0),
        nothing: Bits<18> = from_u64(0),
        no_value: Signed<17> = from_i64(0),
    }
}

impl Logic for Wave {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module excitation_wave");
        self.advances.next = self.phase.q.val() == self.advance_phase.val();
        self.turns.next = self.phase.q.val() == self.turn_phase.val();
        self.scales.next = self.phase.q.val() == self.scale_phase.val();
        self.too_fast.next = false;

        comment!("Lag of the angle: add 256 frequencies at a tick,");
        comment!("subtract a period per step");
        self.operand.next = bit_cast::<23, 18>(self.frequency.q.val().get_bits::<18>(4)) << 1;
        self.not_period.next = !self.period_ticks.val();
        if self.turns.val() {
            self.operand.next = (bit_cast::<23, 16>(self.not_period.val()) << 5) | self.ones_around.val();
        }
        self.with_carry.next =
            ((bit_cast::<23, 21>(self.ahead.q.val()) << 1) | self.carry_in.val()) + self.operand.val();
        self.ahead_sum.next = self.with_carry.val().get_bits::<22>(1);

        comment!("The frequency rises; the signal ends at overflow");
        self.next_frequency.next = bit_cast::<23, 22>(self.frequency.q.val()) + bit_cast::<23, 16>(self.sweep.val());
        if self.advances.val() {
            self.ahead.d.next = self.ahead_sum.val().get_bits::<21>(0);
            self.turned.d.next = false;
            self.phase.d.next = self.turn_phase.val();
            self.frequency.d.next = self.next_frequency.val().get_bits::<22>(0);
            self.too_fast.next = self.chirp.val() & self.next_frequency.val().get_bit(22);
        }

        comment!("Step the angle while it lags; detect a whole turn");
        self.next_angle.next = self.angle.q.val() + self.one_step.val();
        self.whole_turn.next = self.turns.val() & !self.ahead_sum.val().get_bit(21) & self.angle.q.val().all();
        if self.turns.val() {
            if self.ahead_sum.val().get_bit(21) {
                self.phase.d.next = self.scale_phase.val();
            } else {
                self.ahead.d.next = self.ahead_sum.val().get_bits::<21>(0);
                self.angle.d.next = self.next_angle.val();
            }
        }
        if self.whole_turn.val() {
            self.turned.d.next = true;
            self.too_fast.next = self.turned.q.val();
        }

        comment!("PRBS x^15 + x^14 + 1, inverted: seed is 0");
        self.feedback.next = self.one_bit.val();
        if self.noise.q.val().get_bit(14) ^ self.noise.q.val().get_bit(13) {
            self.feedback.next = self.no_bit.val();
        }
        if self.whole_turn.val() {
            self.noise.d.next = (self.noise.q.val() << 1) | bit_cast::<15, 1>(self.feedback.val());
        }

        comment!("Sign and bit of the wave");
        self.negative.next = self.angle.q.val().get_bit(7);
        if self.prbs.val() {
            self.negative.next = self.noise.q.val().get_bit(14);
        }
        self.fold.next = self.angle.q.val().get_bit(6);
        self.triangle_bit.next = false;
        if self.clocks.q.val() == 9 {
            self.triangle_bit.next = true;
        }
        if self.clocks.q.val() == 10 {
            self.triangle_bit.next = self.angle.q.val().get_bit(0) ^ self.fold.val();
        }
        if self.clocks.q.val() == 11 {
            self.triangle_bit.next = self.angle.q.val().get_bit(1) ^ self.fold.val();
        }
        if self.clocks.q.val() == 12 {
            self.triangle_bit.next = self.angle.q.val().get_bit(2) ^ self.fold.val();
        }
        if self.clocks.q.val() == 13 {
            self.triangle_bit.next = self.angle.q.val().get_bit(3) ^ self.fold.val();
        }
        if self.clocks.q.val() == 14 {
            self.triangle_bit.next = self.angle.q.val().get_bit(4) ^ self.fold.val();
        }
        if self.clocks.q.val().all() {
            self.triangle_bit.next = self.angle.q.val().get_bit(5) ^ self.fold.val();
        }
        self.adds.next = !self.chirp.val() | self.triangle_bit.val();

        comment!("Half of value + 1 + addend, or value - addend");
        self.subtrahend.next = self.nothing.val();
        if self.adds.val() {
            self.subtrahend.next = bit_cast::<18, 16>(self.amplitude.val());
        }
        self.complement.next = !self.subtrahend.val();
        if self.negative.val() {
            self.complement.next = self.subtrahend.val();
        }
        self.wide_value.next = signed_bit_cast::<18, 17>(self.value_q.q.val());
        self.value_sum.next = unsigned_cast(self.wide_value.val()) - self.complement.val();
        self.halved.next = self.value_sum.val().get_bits::<17>(1);
        if self.scales.val() {
            self.value_q.d.next = signed_cast(self.halved.val());
            self.clocks.d.next = self.clocks.q.val() + self.one_clock.val();
            if self.clocks.q.val().all() {
                self.phase.d.next = self.rest_phase.val();
            }
        }
        if self.turns.val() & self.ahead_sum.val().get_bit(21) {
            self.value_q.d.next = self.no_value.val();
            self.clocks.d.next = self.no_clock.val();
        }

        comment!("A tick begins; without a signal, everything is reset");
        if self.valid.val() {
            self.phase.d.next = self.advance_phase.val();
        }
        if !self.chirp.val() {
            self.frequency.d.next = self.first_frequency.val();
        }
        if !self.run.val() {
            self.phase.d.next = self.rest_phase.val();
            self.clocks.d.next = self.no_clock.val();
            self.angle.d.next = self.no_angle.val();
            self.ahead.d.next = self.not_ahead.val();
            self.frequency.d.next = self.first_frequency.val();
            self.turned.d.next = false;
            self.noise.d.next = self.seed.val();
            self.value_q.d.next = self.no_value.val();
        }
        if self.start.val() {
            self.phase.d.next = self.scale_phase.val();
        }
        self.value.next = self.value_q.q.val();
    }
}
