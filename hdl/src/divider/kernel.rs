//! Shift and add, then shift and subtract, one bit per clock in one register.
//!
//! ```text
//! phase   0 … 17    product = { partial sum (17), what is left of |steps| (18) }: T is added where its lowest bit is set
//! phase  18 … 68    |steps| · T leaves at the top into the remainder, then 16 zeros; quotient bits enter at the bottom
//! phase  69         quotient := product, clamped and signed
//! ```
//!
//! |steps| · T < 2^35 and 16 fraction bits give a quotient of 51 bits. Its upper 20 must be zero, or it is clamped; those
//! above the register's 35 leave at the top and, from phase 53 on, no longer go into the remainder.

use crate::prelude::*;
use crate::simulation::Pins;
use posicast_model::rtl::divider::{DividerConfig, QUOTIENT_MAX};

#[derive(LogicBlock)]
pub(super) struct Divider {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) start: Signal<In, Bit>,
    pub(super) steps: Signal<In, Signed<18>>,
    pub(super) elapsed: Signal<In, Bits<24>>,
    pub(super) clear_flags: Signal<In, Bit>,
    pub(super) quotient: Signal<Out, Signed<32>>,
    pub(super) done: Signal<Out, Bit>,
    pub(super) busy: Signal<Out, Bit>,
    pub(super) saturated: Signal<Out, Bit>,
    pub(super) overrun: Signal<Out, Bit>,

    phase: Dff<Bits<7>>,
    product: Dff<Bits<35>>,
    remainder: Dff<Bits<24>>,
    divisor: Dff<Bits<24>>,
    negative: Dff<Bit>,
    too_large: Dff<Bit>,
    busy_q: Dff<Bit>,
    quotient_q: Dff<Signed<32>>,
    done_q: Dff<Bit>,
    saturated_q: Dff<Bit>,
    overrun_q: Dff<Bit>,

    magnitude: Signal<Local, Bits<18>>,
    addend: Signal<Local, Bits<18>>,
    partial: Signal<Local, Bits<18>>,
    next_bit: Signal<Local, Bits<1>>,
    shifted: Signal<Local, Bits<26>>,
    difference: Signal<Local, Bits<26>>,
    quotient_bit: Signal<Local, Bits<1>>,
    size: Signal<Local, Bits<32>>,

    first_phase: Constant<Bits<7>>,
    one_phase: Constant<Bits<7>>,
    divide_phase: Constant<Bits<7>>,
    result_phase: Constant<Bits<7>>,
    zeros_phase: Constant<Bits<7>>,
    fits_phase: Constant<Bits<7>>,
    no_clocks: Constant<Bits<24>>,
    tick_clocks: Constant<Bits<24>>,
    tick_addend: Constant<Bits<18>>,
    no_addend: Constant<Bits<18>>,
    no_bits: Constant<Bits<18>>,
    no_bit: Constant<Bits<1>>,
    one_bit: Constant<Bits<1>>,
    largest: Constant<Bits<32>>,
    no_size: Constant<Bits<32>>,
}

impl Divider {
    pub(super) fn new(config: &DividerConfig) -> Self {
        let tick_clocks = u64::from(config.tick_clocks());
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            start: Signal::default(),
            steps: Signal::default(),
            elapsed: Signal::default(),
            clear_flags: Signal::default(),
            quotient: Signal::default(),
            done: Signal::default(),
            busy: Signal::default(),
            saturated: Signal::default(),
            overrun: Signal::default(),
            phase: Dff::default(),
            product: Dff::default(),
            remainder: Dff::default(),
            divisor: Dff::default(),
            negative: Dff::default(),
            too_large: Dff::default(),
            busy_q: Dff::default(),
            quotient_q: Dff::default(),
            done_q: Dff::default(),
            saturated_q: Dff::default(),
            overrun_q: Dff::default(),
            magnitude: Signal::default(),
            addend: Signal::default(),
            partial: Signal::default(),
            next_bit: Signal::default(),
            shifted: Signal::default(),
            difference: Signal::default(),
            quotient_bit: Signal::default(),
            size: Signal::default(),
            first_phase: Constant::new(from_u64(0)),
            one_phase: Constant::new(from_u64(1)),
            divide_phase: Constant::new(from_u64(18)),
            result_phase: Constant::new(from_u64(69)),
            zeros_phase: Constant::new(from_u64(53)),
            fits_phase: Constant::new(from_u64(38)),
            no_clocks: Constant::new(from_u64(0)),
            tick_clocks: Constant::new(from_u64(tick_clocks)),
            tick_addend: Constant::new(from_u64(tick_clocks)),
            no_addend: Constant::new(from_u64(0)),
            no_bits: Constant::new(from_u64(0)),
            no_bit: Constant::new(from_u64(0)),
            one_bit: Constant::new(from_u64(1)),
            largest: Constant::new(from_u64(QUOTIENT_MAX as u64)),
            no_size: Constant::new(from_u64(0)),
        }
    }
}

impl Logic for Divider {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module divider");
        dff_setup!(
            self,
            clk,
            phase,
            product,
            remainder,
            divisor,
            negative,
            too_large,
            busy_q,
            quotient_q,
            done_q,
            saturated_q,
            overrun_q
        );
        self.done_q.d.next = false;
        if self.clear_flags.val() {
            self.overrun_q.d.next = false;
        }

        comment!("Multiply: add T, or not, and shift right");
        self.addend.next = self.no_addend.val();
        if self.product.q.val().get_bit(0) {
            self.addend.next = self.tick_addend.val();
        }
        self.partial.next = bit_cast::<18, 17>(self.product.q.val().get_bits::<17>(18)) + self.addend.val();

        comment!("Divide: a bit into the remainder; subtract");
        self.next_bit.next = self.no_bit.val();
        if self.phase.q.val() < self.zeros_phase.val() {
            self.next_bit.next = self.product.q.val().get_bits::<1>(34);
        }
        self.shifted.next = (bit_cast::<26, 24>(self.remainder.q.val()) << 1) | bit_cast::<26, 1>(self.next_bit.val());
        self.difference.next = self.shifted.val() - bit_cast::<26, 24>(self.divisor.q.val());
        self.quotient_bit.next = self.one_bit.val();
        if self.difference.val().get_bit(25) {
            self.quotient_bit.next = self.no_bit.val();
        }

        comment!("Clamp and sign");
        self.size.next = bit_cast::<32, 31>(self.product.q.val().get_bits::<31>(0));
        if self.too_large.q.val() {
            self.size.next = self.largest.val();
        }

        comment!("One phase per clock");
        if self.busy_q.q.val() {
            self.phase.d.next = self.phase.q.val() + self.one_phase.val();
            if self.phase.q.val() < self.divide_phase.val() {
                self.product.d.next = (bit_cast::<35, 18>(self.partial.val()) << 17)
                    | bit_cast::<35, 17>(self.product.q.val().get_bits::<17>(1));
            } else {
                self.product.d.next = (self.product.q.val() << 1) | bit_cast::<35, 1>(self.quotient_bit.val());
                self.remainder.d.next = self.shifted.val().get_bits::<24>(0);
                if self.quotient_bit.val() == self.one_bit.val() {
                    self.remainder.d.next = self.difference.val().get_bits::<24>(0);
                    if self.phase.q.val() < self.fits_phase.val() {
                        self.too_large.d.next = true;
                    }
                }
            }
            if self.phase.q.val() == self.result_phase.val() {
                self.quotient_q.d.next = signed_cast(self.size.val());
                if self.negative.q.val() {
                    self.quotient_q.d.next = signed_cast(self.no_size.val() - self.size.val());
                }
                self.saturated_q.d.next = self.too_large.q.val();
                self.done_q.d.next = true;
                self.busy_q.d.next = false;
            }
        }

        comment!("A start, unless a division runs");
        self.magnitude.next = unsigned_cast(self.steps.val());
        if self.steps.val().get_bit(17) {
            self.magnitude.next = self.no_bits.val() - unsigned_cast(self.steps.val());
        }
        if self.start.val() {
            if self.busy_q.q.val() {
                self.overrun_q.d.next = true;
            } else {
                self.busy_q.d.next = true;
                self.phase.d.next = self.first_phase.val();
                self.product.d.next = bit_cast::<35, 18>(self.magnitude.val());
                self.remainder.d.next = self.no_clocks.val();
                self.divisor.d.next = self.elapsed.val();
                if !self.elapsed.val().any() {
                    self.divisor.d.next = self.tick_clocks.val();
                }
                self.negative.d.next = self.steps.val().get_bit(17);
                self.too_large.d.next = false;
            }
        }

        comment!("Outputs");
        self.quotient.next = self.quotient_q.q.val();
        self.done.next = self.done_q.q.val();
        self.busy.next = self.busy_q.q.val();
        self.saturated.next = self.saturated_q.q.val();
        self.overrun.next = self.overrun_q.q.val();
    }
}

impl Pins for Divider {
    fn set_clk(&mut self, level: bool) {
        self.clk.next = level.into();
    }

    fn drive(&mut self, inputs: &[u64]) {
        let &[rst, start, steps, elapsed, clear_flags] = inputs else {
            return;
        };
        self.rst.next = rst & 1 != 0;
        self.start.next = start & 1 != 0;
        self.steps.next = from_i64(steps as i64);
        self.elapsed.next = from_u64(elapsed);
        self.clear_flags.next = clear_flags & 1 != 0;
    }

    fn read(&self, outputs: &mut [u64]) {
        let shown = [
            unsigned_cast(self.quotient.val()).into(),
            u64::from(self.done.val()),
            u64::from(self.busy.val()),
            u64::from(self.saturated.val()),
            u64::from(self.overrun.val()),
        ];
        for (output, value) in outputs.iter_mut().zip(shown) {
            *output = value;
        }
    }
}
