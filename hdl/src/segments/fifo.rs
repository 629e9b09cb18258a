//! The memory of the command FIFO, 64 entries of 4 words in block RAM, and its pointers.
//!
//! `pop` makes the oldest waiting entry the current one: its slot, `head`, is read in every tick, and becomes free at
//! the next `pop`, or when nothing plays any more. The slots after it hold the waiting entries, then the entries of an
//! incomplete batch, then the entry whose words are being written. Word 3 commits an entry, or stages it for its batch.

use crate::prelude::*;

kernel! {
    pub(super) struct CommandFifo;

    inputs {
        rst: Bit,
        write: Bit,
        word: Bits<2>,
        data: Bits<32>,
        closed: Bit,
        plays: Bit,
        flush: Bit,
        anew: Bit,
        pop: Bit,
        read_word: Bits<2>,
    }
    outputs { level: Bits<7>, refused: Bit, malformed: Bit, read_data: Bits<32> }
    parts { memory: Ram<32, 8> }
    registers { head: Bits<6>, level_q: Bits<7>, staged: Bits<7>, spoilt: Bit, written: Bits<3>, too_wide: Bit }
    wires {
        full: Bit, held: Bits<7>, behind: Bits<6>, slot: Bits<6>, level_step: Bits<7>, refuses: Bit, takes: Bit, commits: Bit,
        narrow: Bit, complete: Bit, well_formed: Bit, upper: Bits<25>, ticks: Bits<24>, reserved: Bits<4>,
        three_words: Bit, two_kinds: Bit, more: Bit, ends: Bit, entered: Bit, stages: Bit, released: Bit, spoils: Bit,
    }
    constants {
        all_but_one: Bits<6> = from_u64(63),
        one_less: Bits<7> = from_u64(u64::MAX),
        no_level: Bits<7> = from_u64(0),
        one_level: Bits<7> = from_u64(1),
        one_slot: Bits<6> = from_u64(1),
        first_word: Bits<2> = from_u64(0),
        second_word: Bits<2> = from_u64(1),
        third_word: Bits<2> = from_u64(2),
        last_word: Bits<2> = from_u64(3),
        nothing: Bits<3> = from_u64(0),
        first: Bits<3> = from_u64(1),
        second: Bits<3> = from_u64(2),
        third: Bits<3> = from_u64(4),
        no_upper: Bits<25> = from_u64(0),
        all_upper: Bits<25> = from_u64(u64::MAX),
    }
}

impl Logic for CommandFifo {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module command_fifo");

        comment!("A word, unless closed or full");
        self.held.next = self.level_q.q.val() + self.staged.q.val();
        self.behind.next = self.held.val().get_bits::<6>(0);
        self.full.next =
            self.held.val().get_bit(6) | (self.plays.val() & (self.behind.val() == self.all_but_one.val()));
        self.refuses.next = self.closed.val() | self.full.val();
        self.takes.next = self.write.val() & !self.refuses.val();
        self.slot.next = self.head.q.val() + self.behind.val() + self.one_slot.val();
        self.memory.write_enable.next = self.takes.val();
        self.memory.write_address.next = (bit_cast::<8, 6>(self.slot.val()) << 2) | bit_cast::<8, 2>(self.word.val());
        self.memory.write_data.next = self.data.val();

        comment!("The last word commits a whole entry");
        self.ticks.next = self.data.val().get_bits::<24>(0);
        self.reserved.next = self.data.val().get_bits::<4>(24);
        self.more.next = self.data.val().get_bit(28);
        self.three_words.next = self.data.val().get_bit(29) | self.data.val().get_bit(31);
        self.two_kinds.next = self.data.val().get_bit(29) & self.data.val().get_bit(31);
        self.complete.next = self.written.q.val().get_bit(0)
            & self.written.q.val().get_bit(1)
            & (self.written.q.val().get_bit(2) | !self.three_words.val());
        self.well_formed.next = self.complete.val()
            & (!self.too_wide.q.val() | self.three_words.val())
            & !self.two_kinds.val()
            & self.ticks.val().any()
            & !self.reserved.val().any()
            & !self.spoilt.q.val();
        self.ends.next = self.write.val() & (self.word.val() == self.last_word.val());
        self.commits.next = self.ends.val() & !self.refuses.val();
        self.entered.next = self.commits.val() & self.well_formed.val();
        self.refused.next = self.write.val() & self.refuses.val();
        self.malformed.next = self.commits.val() & !self.well_formed.val();

        comment!("Words written so far, and a jerk too wide");
        self.upper.next = self.data.val().get_bits::<25>(7);
        self.narrow.next = (self.upper.val() == self.no_upper.val()) | (self.upper.val() == self.all_upper.val());
        if self.takes.val() {
            if self.word.val() == self.first_word.val() {
                self.written.d.next = self.written.q.val() | self.first.val();
            }
            if self.word.val() == self.second_word.val() {
                self.written.d.next = self.written.q.val() | self.second.val();
                self.too_wide.d.next = !self.narrow.val();
            }
            if self.word.val() == self.third_word.val() {
                self.written.d.next = self.written.q.val() | self.third.val();
            }
        }
        if self.ends.val() {
            self.written.d.next = self.nothing.val();
            self.too_wide.d.next = false;
        }

        comment!("Entries of a batch are staged until the last one;");
        comment!("an entry that is dropped takes the others with it");
        self.stages.next = self.entered.val() & self.more.val();
        self.released.next = self.entered.val() & !self.more.val();
        self.spoils.next = self.spoilt.q.val();
        if self.ends.val() {
            self.staged.d.next = self.no_level.val();
            self.spoils.next = !self.entered.val() & self.more.val();
        }
        if self.stages.val() {
            self.staged.d.next = self.staged.q.val() + self.one_level.val();
        }
        self.spoilt.d.next = self.spoils.val();

        comment!("Number of waiting entries, and the head");
        self.level_step.next = self.no_level.val();
        if self.released.val() {
            self.level_step.next = self.staged.q.val() + self.one_level.val();
        }
        if self.pop.val() {
            self.head.d.next = self.head.q.val() + self.one_slot.val();
            self.level_step.next = self.one_less.val();
            if self.released.val() {
                self.level_step.next = self.staged.q.val();
            }
        }
        self.level_q.d.next = self.level_q.q.val() + self.level_step.val();
        if self.flush.val() {
            self.level_q.d.next = self.no_level.val();
            self.staged.d.next = self.no_level.val();
            self.spoilt.d.next = self.spoils.val() | self.stages.val() | (self.staged.q.val().any() & !self.ends.val());
            if self.anew.val() {
                self.spoilt.d.next = false;
            }
            self.written.d.next = self.nothing.val();
            self.too_wide.d.next = false;
        }

        comment!("The entry being played, a word at a time");
        self.memory.read_address.next =
            (bit_cast::<8, 6>(self.head.q.val()) << 2) | bit_cast::<8, 2>(self.read_word.val());
        self.read_data.next = self.memory.read_data.val();
        self.level.next = self.level_q.q.val();
    }
}
