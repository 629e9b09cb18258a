//! The timer of brake and shaper, in ticks. It is cleared in the clock before it is loaded, so that loading uses the
//! same adder as counting. It is loaded in the first clock of its event, and elapses two clocks later at the earliest.

use crate::prelude::*;

kernel! {
    pub(super) struct Timer;

    inputs {
        rst: Bit,
        counts: Bit,
        /// Clears the timer in the clock before it is loaded.
        clears: Bit,
        load_release: Bit,
        load_settle: Bit,
        load_apply: Bit,
        brake_release_ticks: Bits<16>,
        brake_apply_ticks: Bits<16>,
        settle_ticks: Bits<16>,
    }
    outputs { elapsed: Bit }
    registers { left: Bits<16>, over: Bit }
    wires {
        loads: Bit, at_zero: Bit, released: Bits<16>, settled: Bits<16>, applied: Bits<16>,
        less_one: Bits<16>, addend: Bits<16>, sum: Bits<17>,
    }
    constants { no_ticks: Bits<16> = from_u64(0), minus_one: Bits<16> = from_u64(0xffff) }
}

impl Logic for Timer {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_timer");
        self.loads.next = self.load_release.val() | self.load_settle.val() | self.load_apply.val();
        self.released.next = self.no_ticks.val();
        if self.load_release.val() {
            self.released.next = self.brake_release_ticks.val();
        }
        self.settled.next = self.no_ticks.val();
        if self.load_settle.val() {
            self.settled.next = self.settle_ticks.val();
        }
        self.applied.next = self.no_ticks.val();
        if self.load_apply.val() {
            self.applied.next = self.brake_apply_ticks.val();
        }
        self.less_one.next = self.minus_one.val();
        if self.loads.val() {
            self.less_one.next = self.no_ticks.val();
        }
        comment!("Adding -1 carries unless the count is 0");
        self.addend.next = self.released.val() | self.settled.val() | self.applied.val() | self.less_one.val();
        self.sum.next = bit_cast::<17, 16>(self.left.q.val()) + bit_cast::<17, 16>(self.addend.val());
        self.at_zero.next = !self.sum.val().get_bit(16);
        if self.loads.val() | (self.counts.val() & !self.at_zero.val()) {
            self.left.d.next = self.sum.val().get_bits::<16>(0);
        }
        if self.clears.val() {
            self.left.d.next = self.no_ticks.val();
        }
        self.over.d.next = self.at_zero.val() & !self.loads.val();
        self.elapsed.next = self.over.q.val() & !self.loads.val();
    }
}
