//! Sticky flags of one side: seven bits; setting wins over clearing.
//!
//! e may saturate in any clock; all other values come one at a time, as `what`.

use crate::prelude::*;
use posicast_blocks::sliding_mode::Saturation;

kernel! {
    pub(super) struct Sticky;

    inputs { rst: Bit, clear_flags: Bit, tracking_error: Bit, what: Bits<7>, is_cut: Bit }
    outputs { flags: Bits<7> }
    registers { flags_q: Bits<7> }
    wires { kept: Bits<7>, by_error: Bits<7>, by_sum: Bits<7> }
    constants { nothing: Bits<7> = from_u64(0), of_error: Bits<7> = from_u64(u64::from(Saturation::Error.bit())) }
}

impl Logic for Sticky {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module sticky");

        self.kept.next = self.flags_q.q.val();
        if self.clear_flags.val() {
            self.kept.next = self.nothing.val();
        }
        self.by_error.next = self.nothing.val();
        if self.tracking_error.val() {
            self.by_error.next = self.of_error.val();
        }
        self.by_sum.next = self.nothing.val();
        if self.is_cut.val() {
            self.by_sum.next = self.what.val();
        }
        self.flags_q.d.next = self.kept.val() | self.by_error.val() | self.by_sum.val();
        self.flags.next = self.flags_q.q.val();
    }
}
