//! One of 16 signals, a clock after `select`.
//!
//! The only multiplexer of the block, and more than half of its area: the trigger's signal and those of a row go through it
//! one after the other. As a tree it takes ten LUTs per bit; as a chain of comparisons with `select` it would take more.

use crate::prelude::*;

#[derive(LogicBlock, Default)]
pub(super) struct SignalSelect {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) signal: [Signal<In, Signed<32>>; 16],
    pub(super) select: Signal<In, Bits<4>>,
    pub(super) chosen: Signal<Out, Signed<32>>,

    chosen_q: Dff<Signed<32>>,

    of_two: [Signal<Local, Signed<32>>; 8],
    of_four: [Signal<Local, Signed<32>>; 4],
    of_eight: [Signal<Local, Signed<32>>; 2],
    of_all: Signal<Local, Signed<32>>,
}

impl Logic for SignalSelect {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module signal_select");
        comment!("@about One of 16 signals, a clock after select.");
        dff_setup!(self, clk, chosen_q);

        comment!("One of 16, a bit of select at a time");
        self.of_two[0].next = self.signal[0].val();
        if self.select.val().get_bit(0) {
            self.of_two[0].next = self.signal[1].val();
        }
        self.of_two[1].next = self.signal[2].val();
        if self.select.val().get_bit(0) {
            self.of_two[1].next = self.signal[3].val();
        }
        self.of_two[2].next = self.signal[4].val();
        if self.select.val().get_bit(0) {
            self.of_two[2].next = self.signal[5].val();
        }
        self.of_two[3].next = self.signal[6].val();
        if self.select.val().get_bit(0) {
            self.of_two[3].next = self.signal[7].val();
        }
        self.of_two[4].next = self.signal[8].val();
        if self.select.val().get_bit(0) {
            self.of_two[4].next = self.signal[9].val();
        }
        self.of_two[5].next = self.signal[10].val();
        if self.select.val().get_bit(0) {
            self.of_two[5].next = self.signal[11].val();
        }
        self.of_two[6].next = self.signal[12].val();
        if self.select.val().get_bit(0) {
            self.of_two[6].next = self.signal[13].val();
        }
        self.of_two[7].next = self.signal[14].val();
        if self.select.val().get_bit(0) {
            self.of_two[7].next = self.signal[15].val();
        }
        self.of_four[0].next = self.of_two[0].val();
        if self.select.val().get_bit(1) {
            self.of_four[0].next = self.of_two[1].val();
        }
        self.of_four[1].next = self.of_two[2].val();
        if self.select.val().get_bit(1) {
            self.of_four[1].next = self.of_two[3].val();
        }
        self.of_four[2].next = self.of_two[4].val();
        if self.select.val().get_bit(1) {
            self.of_four[2].next = self.of_two[5].val();
        }
        self.of_four[3].next = self.of_two[6].val();
        if self.select.val().get_bit(1) {
            self.of_four[3].next = self.of_two[7].val();
        }
        self.of_eight[0].next = self.of_four[0].val();
        if self.select.val().get_bit(2) {
            self.of_eight[0].next = self.of_four[1].val();
        }
        self.of_eight[1].next = self.of_four[2].val();
        if self.select.val().get_bit(2) {
            self.of_eight[1].next = self.of_four[3].val();
        }
        self.of_all.next = self.of_eight[0].val();
        if self.select.val().get_bit(3) {
            self.of_all.next = self.of_eight[1].val();
        }
        self.chosen_q.d.next = self.of_all.val();
        self.chosen.next = self.chosen_q.q.val();
    }
}
