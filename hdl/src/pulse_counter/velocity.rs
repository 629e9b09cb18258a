//! Measures the velocity by the M/T method: divides the steps of a tick by the time between the last edge before this
//! tick and the last edge before the previous tick.
//!
//! ```text
//! edges     |     |     |      |      |
//! ticks        T              T              T
//!           ├───────────┤      at the second tick: 2 steps in this time, from the last edge before the first tick
//! ```
//!
//! At a tick, `steps` and `elapsed` go to the divider and stay until the next tick; the quotient may come in any clock
//! between. `job` is the meaning of the quotient. After a tick without an edge it is a bound: the velocity of one count
//! since the last edge, which the velocity cannot exceed. If there is nothing to measure, the velocity becomes 0.
//!
//! `smoothed` is Q16.19 plus 3/8 LSB of Q16.16, so that truncating the extra bits rounds. The sum in `resolved` has one
//! more bit at the bottom, whose value 1 makes the shift round half up.

use crate::prelude::*;

kernel! {
    pub(super) struct Velocity;

    inputs {
        rst: Bit,
        step: Bit,
        up: Bit,
        tick: Bit,
        velocity_m: Bit,
        quotient_valid: Bit,
        clear_flags: Bit,
        count: Bits<18>,
        time_stamp: Bits<24>,
        smoothing: Bits<2>,
        timeout: Bits<8>,
        quotient: Signed<32>,
    }
    outputs {
        steps: Signed<18>,
        elapsed: Bits<24>,
        velocity_pending: Bit,
        velocity_valid: Bit,
        velocity_missed: Bit,
        velocity: Signed<32>,
    }
    registers {
        last_low: Bits<19>, last_up: Bit, reference_stamp: Bits<24>, known: Bit, moved: Bit, turned: Bit,
        captured: Bits<18>, steps_q: Bits<18>, elapsed_q: Bits<24>, job: Bits<2>,
        smoothed: Signed<35> = from_i64(3),
        valid_q: Bit, missed_q: Bit,
    }
    wires {
        last_carry: Bits<5>, last_high: Bits<5>, last_stamp: Bits<24>, interval: Bits<24>, waits: Bit,
        borrow: Bits<19>, counted: Bits<19>, one_count: Bits<18>, recent: Bit, lost: Bit, rests: Bit,
        fresh: Bit, pending: Bit, take: Bit, within_bound: Bit, target: Signed<36>, wide_smoothed: Signed<36>,
        difference: Signed<36>, coarse: Signed<37>, target_bits: Bits<36>, scaled: Bits<36>,
        resolved: Bits<36>, half: Signed<35>, wide_difference: Signed<37>, shrunk: Bits<35>,
    }
    constants {
        no_carry: Bits<5> = from_u64(0),
        one_carry: Bits<5> = from_u64(1),
        no_elapsed: Bits<24> = from_u64(0),
        one_up: Bits<18> = from_u64(1),
        no_borrow: Bits<19> = from_u64(0),
        one_borrow: Bits<19> = from_u64(1),
        no_steps: Bits<18> = from_u64(0),
        idle: Bits<2> = from_u64(0),
        measured: Bits<2> = from_u64(1),
        bound: Bits<2> = from_u64(2),
        halt: Bits<2> = from_u64(3),
        rounding: Bits<36> = from_u64(3),
        rest: Signed<35> = from_i64(3),
        one: Bits<36> = from_u64(1),
    }
}

impl Logic for Velocity {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module velocity");

        comment!("The quotient: its distance from the velocity");
        self.pending.next = self.job.q.val().any();
        self.take.next = self.pending.val() & self.quotient_valid.val();
        self.target.next = signed_bit_cast::<36, 32>(self.quotient.val());
        self.target_bits.next = (unsigned_cast(self.target.val()) << 3) | self.rounding.val();
        self.wide_smoothed.next = signed_bit_cast::<36, 35>(self.smoothed.q.val());
        self.difference.next = signed_cast(self.target_bits.val() - unsigned_cast(self.wide_smoothed.val()));
        self.half.next = self.difference.val().get_bits::<35>(1);

        comment!("Twice the distance, times 2^-k");
        self.wide_difference.next = signed_bit_cast::<37, 36>(self.difference.val());
        self.coarse.next = signed_cast(unsigned_cast(self.wide_difference.val()) << 1);
        if self.smoothing.val().get_bit(1) {
            self.coarse.next = signed_bit_cast::<37, 35>(self.half.val());
        }
        self.scaled.next = unsigned_cast(self.coarse.val().get_bits::<36>(0));
        if self.smoothing.val().get_bit(0) {
            self.scaled.next = unsigned_cast(self.coarse.val().get_bits::<36>(1));
        }
        self.resolved.next = ((unsigned_cast(self.wide_smoothed.val()) << 1) | self.one.val()) + self.scaled.val();
        self.shrunk.next = self.resolved.val().get_bits::<35>(1);
        self.within_bound.next = (self.job.q.val() == self.bound.val())
            & (self.difference.val().get_bit(35) == self.smoothed.q.val().get_bit(34));
        self.valid_q.d.next = self.take.val();
        if self.take.val() {
            self.job.d.next = self.idle.val();
            if !self.within_bound.val() {
                self.smoothed.d.next = signed_cast(self.shrunk.val());
            }
        }
        if self.take.val() & (self.job.q.val() == self.halt.val()) {
            self.smoothed.d.next = self.rest.val();
        }

        comment!("The last edge was less than 2^18 clocks ago: its");
        comment!("high bits are those of now, or one less");
        self.last_carry.next = self.no_carry.val();
        if self.last_low.q.val().get_bit(18) & !self.time_stamp.val().get_bit(18) {
            self.last_carry.next = self.one_carry.val();
        }
        self.last_high.next = self.time_stamp.val().get_bits::<5>(19) - self.last_carry.val();
        self.last_stamp.next =
            (bit_cast::<24, 5>(self.last_high.val()) << 19) | bit_cast::<24, 19>(self.last_low.q.val());

        comment!("Time from the reference to the last edge, or to now");
        comment!("in a tick without an edge");
        self.interval.next = self.last_stamp.val() - self.reference_stamp.q.val();
        self.recent.next = self.interval.val().get_bits::<8>(16) < self.timeout.val();
        self.fresh.next = self.known.q.val() & (self.recent.val() | self.moved.q.val());
        self.lost.next = !self.velocity_m.val() & (!self.known.q.val() | self.turned.q.val());
        self.rests.next = !self.velocity_m.val() & (!self.fresh.val() | self.turned.q.val());

        comment!("Steps of the tick. Without an edge they are 0, and");
        comment!("1 or -1 is divided: a borrow at bit 0 gives -1");
        self.waits.next = !self.moved.q.val() & !self.velocity_m.val();
        self.borrow.next = self.no_borrow.val();
        if self.waits.val() & self.smoothed.q.val().get_bit(34) {
            self.borrow.next = self.one_borrow.val();
        }
        self.counted.next = (bit_cast::<19, 18>(self.count.val()) << 1)
            - ((bit_cast::<19, 18>(self.captured.q.val()) << 1) | self.borrow.val());
        self.one_count.next = self.no_steps.val();
        if self.waits.val() {
            self.one_count.next = self.one_up.val();
        }

        comment!("A tick");
        if self.clear_flags.val() {
            self.missed_q.d.next = false;
        }
        if self.tick.val() {
            if self.pending.val() & !self.take.val() {
                self.missed_q.d.next = true;
            }
            self.job.d.next = self.measured.val();
            if self.waits.val() {
                self.job.d.next = self.bound.val();
            }
            if self.rests.val() {
                self.job.d.next = self.halt.val();
            }
            if self.moved.q.val() {
                self.reference_stamp.d.next = self.last_stamp.val();
            }
            self.captured.d.next = self.count.val();
            self.known.d.next = self.moved.q.val() | self.fresh.val();
            self.moved.d.next = false;
            self.turned.d.next = false;
            self.steps_q.d.next = self.counted.val().get_bits::<18>(1) | self.one_count.val();
            self.elapsed_q.d.next = self.interval.val();
        }
        if self.tick.val() & self.velocity_m.val() {
            self.elapsed_q.d.next = self.no_elapsed.val();
        }
        if self.tick.val() & self.lost.val() {
            self.steps_q.d.next = self.no_steps.val();
        }

        comment!("Time of the last edge; until the first edge, now");
        if self.step.val() | self.tick.val() | !self.moved.q.val() {
            self.last_low.d.next = self.time_stamp.val().get_bits::<19>(0);
        }

        comment!("An edge in the clock of a tick belongs to the next");
        if self.step.val() {
            self.last_up.d.next = self.up.val();
            self.moved.d.next = true;
            if self.up.val() != self.last_up.q.val() {
                self.turned.d.next = true;
            }
        }

        comment!("Outputs");
        self.steps.next = signed_cast(self.steps_q.q.val());
        self.elapsed.next = self.elapsed_q.q.val();
        self.velocity_pending.next = self.pending.val();
        self.velocity.next = self.smoothed.q.val().get_bits::<32>(3);
        self.velocity_valid.next = self.valid_q.q.val();
        self.velocity_missed.next = self.missed_q.q.val();
    }
}
