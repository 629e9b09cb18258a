//! Multiplies, divides and negates with one bit per clock in one register.
//!
//! ```text
//! phase  27 .. 44   product = { partial sum (17), remaining bits of steps (18) } shifts down: T is added where the
//!                   lowest bit of |steps| is 1
//! phase  45 .. 95   product shifts up: |steps| · T leaves at the top into the remainder, quotient bits enter at the
//!                   bottom. The first 16 of these are stored as 0, and leave at the top as the 16 fraction bits of
//!                   the dividend
//! phase  96 .. 127  product shifts down once more: the bits of the quotient enter at the top, negated or not
//! ```
//!
//! To negate a number lowest bit first needs no adder: every bit after the lowest 1 is inverted. |steps| · T < 2^35 and
//! 16 fraction bits give a quotient of 51 bits. If one of its upper 20 bits is 1, it is clamped: all further bits are
//! ones. The numbers of the phases are chosen so that they are easy to decode.

use crate::prelude::*;
use posicast_blocks::divider::DividerConfig;

kernel! {
    pub(super) struct Divider(config: &DividerConfig);
    ports posicast_blocks::divider_ports;

    registers {
        phase: Bits<7>, product: Bits<35>, remainder: Bits<24>, divisor: Bits<24>, negative: Bit,
        turns_over: Bit, too_large: Bit, busy_q: Bit, quotient_q: Signed<32>, done_q: Bit, saturated_q: Bit,
        overrun_q: Bit, downward: Bit, last_pass: Bit, fits: Bit,
    }
    wires {
        next_phase: Bits<7>, magnitude_bit: Bit, entering: Bits<1>, addend: Bits<18>, partial: Bits<18>,
        next_bit: Bits<1>, shifted: Bits<26>, difference: Bits<26>, subtracts: Bit, kept_bit: Bits<1>,
        result: Bits<32>, one_tick: Bits<24>,
    }
    constants {
        first_phase: Bits<7> = from_u64(27),
        one_phase: Bits<7> = from_u64(1),
        divide_phase: Bits<7> = from_u64(45),
        fits_phase: Bits<7> = from_u64(65),
        sign_phase: Bits<7> = from_u64(96),
        no_clocks: Bits<24> = from_u64(0),
        tick_clocks: Bits<24> = from_u64(u64::from(config.tick_clocks())),
        tick_addend: Bits<18> = from_u64(u64::from(config.tick_clocks())),
        no_addend: Bits<18> = from_u64(0),
        no_bit: Bits<1> = from_u64(0),
        one_bit: Bits<1> = from_u64(1),
    }
}

impl Logic for Divider {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module divider");
        self.done_q.d.next = false;
        if self.clear_flags.val() {
            self.overrun_q.d.next = false;
        }

        comment!("Negate a negative number, lowest bit first");
        self.magnitude_bit.next = self.product.q.val().get_bit(0) ^ (self.negative.q.val() & self.turns_over.q.val());
        self.turns_over.d.next = self.downward.q.val() & (self.turns_over.q.val() | self.product.q.val().get_bit(0));

        comment!("Multiply: add T or 0, and shift down");
        self.addend.next = self.no_addend.val();
        self.entering.next = self.no_bit.val();
        if self.magnitude_bit.val() {
            if self.last_pass.q.val() {
                self.entering.next = self.one_bit.val();
            } else {
                self.addend.next = self.tick_addend.val();
            }
        }
        self.partial.next = bit_cast::<18, 17>(self.product.q.val().get_bits::<17>(18)) + self.addend.val();
        self.result.next =
            (bit_cast::<32, 1>(self.entering.val()) << 31) | bit_cast::<32, 31>(self.product.q.val().get_bits::<31>(4));

        comment!("Divide: a bit into the remainder; subtract");
        self.next_bit.next = self.no_bit.val();
        if !self.downward.q.val() {
            self.next_bit.next = self.product.q.val().get_bits::<1>(34);
        }
        self.shifted.next = (bit_cast::<26, 24>(self.remainder.q.val()) << 1) | bit_cast::<26, 1>(self.next_bit.val());
        self.difference.next = self.shifted.val() - bit_cast::<26, 24>(self.divisor.q.val());
        self.subtracts.next = !self.difference.val().get_bit(25);

        comment!("All ones if the quotient exceeds 31 bits");
        self.kept_bit.next = self.no_bit.val();
        if self.fits.q.val() & (self.subtracts.val() | self.too_large.q.val()) {
            self.kept_bit.next = self.one_bit.val();
        }

        comment!("One phase per clock; between divisions,");
        comment!("the contents of the registers do not matter");
        if self.downward.q.val() {
            self.product.d.next = (bit_cast::<35, 1>(self.entering.val()) << 34)
                | (bit_cast::<35, 18>(self.partial.val()) << 17)
                | bit_cast::<35, 17>(self.product.q.val().get_bits::<17>(1));
        } else {
            self.product.d.next = (self.product.q.val() << 1) | bit_cast::<35, 1>(self.kept_bit.val());
        }
        self.remainder.d.next = self.shifted.val().get_bits::<24>(0);
        if self.subtracts.val() {
            self.remainder.d.next = self.difference.val().get_bits::<24>(0);
        }
        self.next_phase.next = self.phase.q.val();
        if self.busy_q.q.val() {
            self.next_phase.next = self.phase.q.val() + self.one_phase.val();
        }
        comment!("Clamp; while multiplying, the remainder is 0");
        if self.subtracts.val() & !self.fits.q.val() {
            self.too_large.d.next = true;
        }
        if self.phase.q.val().all() {
            self.quotient_q.d.next = signed_cast(self.result.val());
            self.saturated_q.d.next = self.too_large.q.val();
            self.done_q.d.next = true;
            self.busy_q.d.next = false;
        }

        comment!("A start, unless a division runs");
        self.one_tick.next = self.no_clocks.val();
        if !self.elapsed.val().any() {
            self.one_tick.next = self.tick_clocks.val();
        }
        if self.start.val() & self.busy_q.q.val() {
            self.overrun_q.d.next = true;
        }
        if self.start.val() & !self.busy_q.q.val() {
            self.busy_q.d.next = true;
            self.next_phase.next = self.first_phase.val();
            self.product.d.next = bit_cast::<35, 18>(unsigned_cast(self.steps.val()));
            self.remainder.d.next = self.no_clocks.val();
            self.divisor.d.next = self.elapsed.val() | self.one_tick.val();
            self.negative.d.next = self.steps.val().get_bit(17);
            self.turns_over.d.next = false;
            self.too_large.d.next = false;
        }

        comment!("Part of the next phase, decoded a clock ahead");
        self.phase.d.next = self.next_phase.val();
        self.last_pass.d.next = self.next_phase.val() >= self.sign_phase.val();
        self.downward.d.next =
            (self.next_phase.val() >= self.sign_phase.val()) | (self.next_phase.val() < self.divide_phase.val());
        self.fits.d.next = self.next_phase.val() >= self.fits_phase.val();

        comment!("Outputs");
        self.quotient.next = self.quotient_q.q.val();
        self.done.next = self.done_q.q.val();
        self.busy.next = self.busy_q.q.val();
        self.saturated.next = self.saturated_q.q.val();
        self.overrun.next = self.overrun_q.q.val();
    }
}
