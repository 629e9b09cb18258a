//! The memory: entries in the order in which they came, the oldest of which is shown.
//!
//! The place of the next entry is `oldest + entries`, round the memory. It is also read only where nothing is left, so
//! `valid` is low where the read word is undefined. An entry is shown two clocks after its edge, and the next one in
//! the clock after `take`.

use crate::prelude::*;
use posicast_blocks::capture::AXES;

kernel! {
    pub(super) struct CaptureMemory;

    inputs { rst: Bit, offers: Bit, rising: Bit, count[4]: Signed<32>, stamp: Bits<32>, take: Bit, clear: Bit }
    outputs {
        captures: Bit, overflows: Bit, entries: Bits<5>, entry_valid: Bit, entry_count[4]: Signed<32>, entry_stamp: Bits<32>,
        entry_rising: Bit,
    }
    parts { positions[AXES]: Ram<32, 4>, marks: Ram<33, 4> }
    registers { oldest: Bits<4>, entries_q: Bits<5>, valid: Bit }
    wires {
        takes: Bit, left: Bits<5>, place: Bits<4>, shown: Bits<4>, writes: Bit, wide_stamp: Bits<33>,
        mark: Bits<33>, shown_mark: Bits<33>,
    }
    constants {
        none: Bits<5> = from_u64(0),
        one_entry: Bits<5> = from_u64(1),
        one_place: Bits<4> = from_u64(1),
        no_stamp: Bits<32> = from_u64(0),
        no_count: Signed<32> = from_i64(0),
    }
}

impl Logic for CaptureMemory {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module capture_memory");

        comment!("take and clear come first");
        self.takes.next = self.take.val() & self.valid.q.val();
        self.left.next = self.entries_q.q.val();
        self.place.next = self.oldest.q.val() + self.entries_q.q.val().get_bits::<4>(0);
        self.shown.next = self.oldest.q.val();
        if self.takes.val() {
            self.left.next = self.entries_q.q.val() - self.one_entry.val();
            self.shown.next = self.oldest.q.val() + self.one_place.val();
        }
        if self.clear.val() {
            self.left.next = self.none.val();
            self.shown.next = self.place.val();
        }
        self.oldest.d.next = self.shown.val();
        self.valid.d.next = self.left.val().any();

        comment!("Then the edge, if there is room");
        self.writes.next = false;
        self.entries_q.d.next = self.left.val();
        if self.offers.val() & !self.left.val().get_bit(4) {
            self.writes.next = true;
            self.entries_q.d.next = self.left.val() + self.one_entry.val();
        }
        self.wide_stamp.next = bit_cast::<33, 32>(self.stamp.val());
        self.mark.next = self.wide_stamp.val().replace_bit(32, self.rising.val());
        for i in 0..4 {
            self.positions[i].write_enable.next = self.writes.val();
            self.positions[i].write_address.next = self.place.val();
            self.positions[i].write_data.next = unsigned_cast(self.count[i].val());
            self.positions[i].read_address.next = self.shown.val();
        }
        self.marks.write_enable.next = self.writes.val();
        self.marks.write_address.next = self.place.val();
        self.marks.write_data.next = self.mark.val();
        self.marks.read_address.next = self.shown.val();

        comment!("A word that is not an entry's is not shown");
        for i in 0..4 {
            self.entry_count[i].next = self.no_count.val();
        }
        self.shown_mark.next = self.marks.read_data.val();
        self.entry_stamp.next = self.no_stamp.val();
        if self.valid.q.val() {
            for i in 0..4 {
                self.entry_count[i].next = signed_cast(self.positions[i].read_data.val());
            }
            self.entry_stamp.next = self.shown_mark.val().get_bits::<32>(0);
        }
        self.entry_rising.next = self.valid.q.val() & self.shown_mark.val().get_bit(32);
        self.entry_valid.next = self.valid.q.val();
        self.entries.next = self.entries_q.q.val();
        self.captures.next = self.writes.val();
        self.overflows.next = self.offers.val() & self.left.val().get_bit(4);
    }
}
