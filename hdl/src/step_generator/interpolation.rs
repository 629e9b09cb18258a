//! The straight line from sample to sample: every clock adds the difference of two samples, and a step is demanded where
//! the sum passes a whole number of units per step M.
//!
//! The line is u units above the middle below, 0 to M − 1. `sum` is u going down, and u − M going up, so that its sign alone
//! shows a step. A clock that has passed a middle leaves `sum` beyond, and the next one corrects it by M; so does a new
//! direction, and both at once cancel out. The correction is a constant that needs only a few bits of control.
//!
//! Three operands in one sum make Yosys save carries in LUTs, at twice the area. So `step` has a bit below, which is 0.
//!
//! Standing leaves 0 in `sum`, which going up is u = 0, a middle that has just been passed. `halfway` says that u is half of
//! M instead; the first clock of the movement adds it.

use crate::prelude::*;
use posicast_blocks::step_generator::StepGeneratorConfig;

kernel! {
    /// Sizes: A bits of the sum, B = A + 1.
    pub(super) struct StepInterpolation<const A: usize, const B: usize>(config: &StepGeneratorConfig)
        where B == A + 1;

    inputs { rst: Bit, tick: Bit, position: Signed<32>, runs: Bit, stands: Bit }
    outputs { keeps: Bit, too_fast: Bit, demands_up: Bit, demands_down: Bit }
    registers {
        taken: Bits<32>, difference: Bits<32>, fresh: Bit, moving: Bit, phase: Bits<17>, sum: Bits<A>,
        downwards: Bit, halfway: Bit, moved: Bit,
    }
    wires {
        position_bits: Bits<32>, negative: Bit, magnitude: Bits<32>, above: Bit, goes_on: Bit, last: Bit,
        takes: Bit, turns: Bit, below: Bit, passed: Bit, correction: Bits<A>, moves: Bits<A>, step: Bits<B>,
    }
    constants {
        whole_bits: Bits<32> = from_u64(whole_bits(config)),
        half_bit: Bits<32> = from_u64((1 << config.fraction_bits()) >> 1),
        largest: Bits<32> = from_u64(config.largest_difference().into()),
        no_phase: Bits<17> = from_u64(0),
        one_phase: Bits<17> = from_u64(1),
        used_phase: Bits<17> = from_u64(u64::from(config.tick_clocks()).next_power_of_two() - 1),
        last_phase: Bits<17> = from_u64(u64::from(config.tick_clocks()) - 1),
        sum_sign: Bits<A> = from_u64(1 << (config.accumulator_bits() - 1)),
        no_distance: Bits<A> = from_u64(0),
        one_up: Bits<A> = from_u64(config.step_units().into()),
        one_down: Bits<A> = from_u64((-i64::from(config.step_units())) as u64),
        half_up: Bits<A> = from_u64((config.step_units() / 2).into()),
        half_down: Bits<A> = from_u64((-i64::from(config.step_units().div_ceil(2))) as u64),
    }
}

/// The bits of a position that are halves and wholes.
fn whole_bits(config: &StepGeneratorConfig) -> u64 {
    let half = (1_u64 << config.fraction_bits()) >> 1;
    u64::from(u32::MAX) & !half.saturating_sub(1)
}

impl<const A: usize, const B: usize> Logic for StepInterpolation<A, B> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module step_interpolation_${value last_phase}x${value half_bit}x${value largest}");
        self.position_bits.next = unsigned_cast(self.position.val());
        self.negative.next = self.difference.q.val().get_bit(31);
        self.magnitude.next = self.difference.q.val();
        if self.negative.val() {
            self.magnitude.next = !self.difference.q.val();
        }

        comment!("Above: the highest differing bit; the complement is one less");
        self.above.next = self.negative.val();
        for i in 0..32 {
            if self.magnitude.val().get_bit(i) != self.largest.val().get_bit(i) {
                self.above.next = self.magnitude.val().get_bit(i);
            }
        }
        self.too_fast.next = self.fresh.q.val() & self.above.val();
        self.goes_on.next = self.runs.val() & !(self.fresh.q.val() & self.above.val());
        self.keeps.next = self.goes_on.val();

        comment!("A tick is taken as soon as the last one has been given");
        self.last.next = self.phase.q.val() == self.last_phase.val();
        self.takes.next = self.tick.val() & self.goes_on.val() & (!self.moving.q.val() | self.last.val());
        self.fresh.d.next = self.takes.val();
        self.moving.d.next = self.takes.val() | (self.goes_on.val() & self.moving.q.val() & !self.last.val());
        self.phase.d.next = self.no_phase.val();
        if self.moving.q.val() & !self.last.val() {
            self.phase.d.next = (self.phase.q.val() + self.one_phase.val()) & self.used_phase.val();
        }
        if self.takes.val() {
            self.difference.d.next = self.position_bits.val() - self.taken.q.val();
            self.taken.d.next = self.position_bits.val();
        }

        comment!("The distance to the next step: one clock further");
        self.turns.next = self.downwards.q.val() ^ self.negative.val();
        self.below.next = (self.sum.q.val() & self.sum_sign.val()).any();
        self.passed.next = !(self.downwards.q.val() ^ self.below.val());
        self.correction.next = self.no_distance.val();
        if self.passed.val() ^ self.turns.val() {
            self.correction.next = self.one_down.val();
            if self.negative.val() {
                self.correction.next = self.one_up.val();
            }
        }
        if self.halfway.q.val() {
            self.correction.next = self.half_down.val();
            if self.negative.val() {
                self.correction.next = self.half_up.val();
            }
        }
        comment!("The added bit keeps two carry chains apart");
        self.moves.next = bit_cast::<A, 32>(self.difference.q.val());
        self.step.next = (bit_cast::<B, A>(self.moves.val()) << 1) + (bit_cast::<B, A>(self.correction.val()) << 1);
        if self.moving.q.val() {
            self.sum.d.next = self.sum.q.val() + self.step.val().get_bits::<A>(1);
            self.downwards.d.next = self.negative.val();
            self.halfway.d.next = false;
        }
        self.moved.d.next = self.moving.q.val() & self.goes_on.val();
        self.demands_up.next = self.moved.q.val() & self.passed.val() & !self.downwards.q.val();
        self.demands_down.next = self.moved.q.val() & self.passed.val() & self.downwards.q.val();

        comment!("Standing: from the last half or whole step on");
        if self.stands.val() {
            self.taken.d.next = self.position_bits.val() & self.whole_bits.val();
            self.sum.d.next = self.no_distance.val();
            self.downwards.d.next = false;
            self.halfway.d.next = !(self.position_bits.val() & self.half_bit.val()).any();
        }
    }
}
