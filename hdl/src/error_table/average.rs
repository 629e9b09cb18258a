//! The adder of the error table: a running average.
//!
//! In every clock `average` becomes half the sum of itself and `entry`, `whole` or 0. `rounded` is the average, rounded
//! half up by the bit that was dropped last. `load` sets the average to `entry`, or to 0 without `takes_entry`; `clear`
//! sets it to 0.

use crate::prelude::*;

kernel! {
    pub(super) struct Average;

    inputs {
        rst: Bit,
        entry: Signed<18>,
        takes_entry: Bit,
        whole: Signed<18>,
        takes_whole: Bit,
        load: Bit,
        clear: Bit,
    }
    outputs { rounded: Signed<18> }
    registers { average: Signed<18>, dropped: Bits<1> }
    wires {
        wide_average: Signed<19>, wide_entry: Signed<19>, wide_whole: Signed<19>, sum_bits: Bits<19>, half: Signed<18>,
    }
    constants { none: Signed<18> = from_i64(0) }
}

impl Logic for Average {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module error_average");

        self.wide_average.next = signed_bit_cast::<19, 18>(self.average.q.val());
        self.wide_entry.next = signed_bit_cast::<19, 18>(self.entry.val());
        self.wide_whole.next = signed_bit_cast::<19, 18>(self.whole.val());
        self.sum_bits.next = unsigned_cast(self.wide_average.val());
        if self.takes_entry.val() {
            self.sum_bits.next = unsigned_cast(self.wide_average.val() + self.wide_entry.val());
        }
        if self.takes_whole.val() {
            self.sum_bits.next = unsigned_cast(self.wide_average.val() + self.wide_whole.val());
        }
        self.average.d.next = signed_cast(self.sum_bits.val().get_bits::<18>(1));
        self.dropped.d.next = self.sum_bits.val().get_bits::<1>(0);
        if self.load.val() {
            self.average.d.next = self.none.val();
            if self.takes_entry.val() {
                self.average.d.next = self.entry.val();
            }
        }
        if self.clear.val() {
            self.average.d.next = self.none.val();
        }

        self.half.next = signed_cast(bit_cast::<18, 1>(self.dropped.q.val()));
        self.rounded.next = self.average.q.val() + self.half.val();
    }
}
