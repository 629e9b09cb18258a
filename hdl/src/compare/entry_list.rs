//! Keeps the list of positions: a host appends to it until the block is armed, and the position beside the count is
//! read from it.

use crate::prelude::*;
use posicast_blocks::compare::{LEAST_DISTANCE_COUNTS, LIST_POSITIONS};

kernel! {
    pub(super) struct EntryList;

    inputs {
        rst: Bit,
        frozen: Bit,
        entry: Signed<32>,
        entry_write: Bit,
        entries_clear: Bit,
        read_address: Bits<8>,
    }
    outputs { entries: Bits<9>, refuses: Bit, word: Signed<32> }
    parts { positions: Ram<32, 8> }
    registers { entries_q: Bits<9>, newest: Signed<32> }
    wires {
        wide_entry: Signed<33>, wide_newest: Signed<33>, distance: Signed<33>, follows: Bit, is_full: Bit, taken: Bit, clears: Bit,
    }
    constants {
        none: Bits<9> = from_u64(0),
        one_entry: Bits<9> = from_u64(1),
        all_entries: Bits<9> = from_u64(LIST_POSITIONS as u64),
        least: Signed<33> = from_i64(LEAST_DISTANCE_COUNTS),
    }
    connect {
        positions: read_address;
    }
}

impl Logic for EntryList {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module compare_list");

        comment!("Positions increase, by the least distance or more");
        self.wide_entry.next = signed_bit_cast::<33, 32>(self.entry.val());
        self.wide_newest.next = signed_bit_cast::<33, 32>(self.newest.q.val());
        self.distance.next = self.wide_entry.val() - self.wide_newest.val();
        self.follows.next = !self.entries_q.q.val().any() | (self.distance.val() >= self.least.val());
        self.is_full.next = self.entries_q.q.val() == self.all_entries.val();
        self.taken.next = self.entry_write.val()
            & !self.entries_clear.val()
            & !self.frozen.val()
            & !self.is_full.val()
            & self.follows.val();
        self.clears.next = self.entries_clear.val() & !self.frozen.val();
        self.refuses.next = (self.entry_write.val() & !self.entries_clear.val() & !self.taken.val())
            | (self.entries_clear.val() & self.frozen.val());

        if self.taken.val() {
            self.entries_q.d.next = self.entries_q.q.val() + self.one_entry.val();
            self.newest.d.next = self.entry.val();
        }
        if self.clears.val() {
            self.entries_q.d.next = self.none.val();
        }
        self.positions.write_enable.next = self.taken.val() & !self.rst.val();
        self.positions.write_address.next = self.entries_q.q.val().get_bits::<8>(0);
        self.positions.write_data.next = unsigned_cast(self.entry.val());
        self.word.next = signed_cast(self.positions.read_data.val());
        self.entries.next = self.entries_q.q.val();
    }
}
