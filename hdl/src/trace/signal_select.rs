//! Selects one of 16 signals, a clock after `select`.
//!
//! It is the only multiplexer of the block, and more than half of its area: the trigger's signal and those of a row
//! pass it one after the other. First one of each four signals is selected by the lower bits of `select` into
//! registers, then one of these four. So it takes ten LUTs per bit, which an optimiser that sees all 16 signals at
//! once does not find, and the registers share elements with LUTs that are used anyway.

use crate::prelude::*;

kernel! {
    pub(super) struct SignalSelect;

    inputs { rst: Bit, signal[16]: Signed<32>, select: Bits<4> }
    outputs { chosen: Signed<32> }
    registers { first: Signed<32>, second: Signed<32>, third: Signed<32>, fourth: Signed<32>, upper: Bits<2> }
    wires { low_pair[4]: Signed<32>, high_pair[4]: Signed<32>, lower_two: Signed<32>, upper_two: Signed<32> }
}

impl Logic for SignalSelect {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module signal_select");

        comment!("Select one of each four");
        self.low_pair[0].next = self.signal[0].val();
        self.low_pair[1].next = self.signal[4].val();
        self.low_pair[2].next = self.signal[8].val();
        self.low_pair[3].next = self.signal[12].val();
        self.high_pair[0].next = self.signal[2].val();
        self.high_pair[1].next = self.signal[6].val();
        self.high_pair[2].next = self.signal[10].val();
        self.high_pair[3].next = self.signal[14].val();
        if self.select.val().get_bit(0) {
            self.low_pair[0].next = self.signal[1].val();
            self.low_pair[1].next = self.signal[5].val();
            self.low_pair[2].next = self.signal[9].val();
            self.low_pair[3].next = self.signal[13].val();
            self.high_pair[0].next = self.signal[3].val();
            self.high_pair[1].next = self.signal[7].val();
            self.high_pair[2].next = self.signal[11].val();
            self.high_pair[3].next = self.signal[15].val();
        }
        self.first.d.next = self.low_pair[0].val();
        self.second.d.next = self.low_pair[1].val();
        self.third.d.next = self.low_pair[2].val();
        self.fourth.d.next = self.low_pair[3].val();
        if self.select.val().get_bit(1) {
            self.first.d.next = self.high_pair[0].val();
            self.second.d.next = self.high_pair[1].val();
            self.third.d.next = self.high_pair[2].val();
            self.fourth.d.next = self.high_pair[3].val();
        }
        self.upper.d.next = self.select.val().get_bits::<2>(2);

        comment!("Select one of these");
        self.lower_two.next = self.first.q.val();
        self.upper_two.next = self.third.q.val();
        if self.upper.q.val().get_bit(0) {
            self.lower_two.next = self.second.q.val();
            self.upper_two.next = self.fourth.q.val();
        }
        self.chosen.next = self.lower_two.val();
        if self.upper.q.val().get_bit(1) {
            self.chosen.next = self.upper_two.val();
        }
    }
}
