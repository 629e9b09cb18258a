//! Stores the entries: bank 0 is a ROM with the machine's, bank 1 is a RAM that a host loads. A host can read back
//! both.
//!
//! - A write with index 0 begins a new table in bank 1; the index of each further write must be the number of entries
//!   so far. These are refused, with no effect except the flag: a write to bank 0, to bank 1 while it is in use, out of
//!   sequence, or beyond the last entry, and an entry that differs too much from the one before it.
//! - A host's read uses the memories in the first clock in which no pass is `busy` and nothing is written; an entry
//!   that is not loaded reads as 0.

use crate::prelude::*;
use posicast_blocks::error_table::ErrorTableConfig;

kernel! {
    pub(super) struct EntryBanks(config: &ErrorTableConfig);

    inputs {
        rst: Bit,
        in_use: Bit,
        busy: Bit,
        from_loaded: Bit,
        address: Bits<8>,
        error_write: Bit,
        error_bank: Bit,
        error_index: Bits<8>,
        error_entry: Signed<18>,
        error_read: Bit,
    }
    outputs { entry: Signed<18>, complete: Bit, refused: Bit, found: Signed<18>, read_waits: Bit }
    parts {
        machine_errors: Rom<18, 8> = Rom::new("machine_errors", rom_words(config)),
        loaded_errors: Ram<18, 8>,
    }
    registers {
        loaded: Bits<9>, previous: Signed<18>, refused_q: Bit, waits: Bit, served: Bit, served_bank: Bit, served_entry: Bit,
        read_back: Signed<18>,
    }
    wires {
        index: Bits<9>, begins: Bit, is_complete: Bit, follows: Bit, wide_entry: Signed<20>, wide_previous: Signed<20>,
        step: Signed<20>, gentle: Bit, taken: Bit, serves: Bit, read_address: Bits<8>, entries: Bits<9>,
        word: Signed<18>, word_loaded: Bit,
    }
    constants {
        all_entries: Bits<9> = from_u64(config.entries().len() as u64),
        one_entry: Bits<9> = from_u64(1),
        most_step: Signed<20> = from_i64(config.format().most_step().into()),
        least_step: Signed<20> = from_i64(-i64::from(config.format().most_step())),
        none: Signed<18> = from_i64(0),
    }
    connect {
        loaded_errors: read_address;
    }
}

/// The machine's table.
fn rom_words(config: &ErrorTableConfig) -> Vec<RomWord> {
    let format = config.format();
    let word = |(index, entry): (i64, &i32)| RomWord {
        pattern: *entry as u64 & 0x3_ffff,
        meaning: format!(
            "{} counts at {}",
            f64::from(*entry) * format.unit.counts(),
            i64::from(format.first_counts) + (index << format.spacing_bits)
        ),
    };
    (0..).zip(config.entries()).map(word).collect()
}

impl Logic for EntryBanks {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module error_entry_banks");

        comment!("Load in sequence, while the bank is not in use");
        self.index.next = bit_cast::<9, 8>(self.error_index.val());
        self.begins.next = !self.error_index.val().any();
        self.is_complete.next = self.loaded.q.val() == self.all_entries.val();
        self.follows.next = (self.index.val() == self.loaded.q.val()) & !self.is_complete.val();
        self.wide_entry.next = signed_bit_cast::<20, 18>(self.error_entry.val());
        self.wide_previous.next = signed_bit_cast::<20, 18>(self.previous.q.val());
        self.step.next = self.wide_entry.val() - self.wide_previous.val();
        self.gentle.next = (self.step.val() <= self.most_step.val()) & (self.step.val() >= self.least_step.val());
        self.taken.next = self.error_write.val()
            & self.error_bank.val()
            & !self.in_use.val()
            & (self.begins.val() | (self.follows.val() & self.gentle.val()));
        self.refused_q.d.next = self.error_write.val() & !self.taken.val();
        if self.taken.val() {
            self.loaded.d.next = self.index.val() + self.one_entry.val();
            self.previous.d.next = self.error_entry.val();
        }
        self.loaded_errors.write_enable.next = self.taken.val();
        self.loaded_errors.write_address.next = self.error_index.val();
        self.loaded_errors.write_data.next = unsigned_cast(self.error_entry.val());

        comment!("A host reads an entry back while no pass runs");
        self.serves.next = self.waits.q.val() & !self.served.q.val() & !self.busy.val() & !self.error_write.val();
        self.served.d.next = self.serves.val();
        self.waits.d.next = self.error_read.val() | (self.waits.q.val() & !self.served.q.val());
        self.entries.next = self.all_entries.val();
        if self.error_bank.val() {
            self.entries.next = self.loaded.q.val();
        }
        self.served_entry.d.next = self.index.val() < self.entries.val();

        comment!("Select the entry");
        self.read_address.next = self.address.val();
        if self.serves.val() {
            self.read_address.next = self.error_index.val();
        }
        self.machine_errors.address.next = self.read_address.val();
        self.word_loaded.next = self.from_loaded.val();
        if self.served.q.val() {
            self.word_loaded.next = self.served_bank.q.val();
        }
        self.served_bank.d.next = self.error_bank.val();
        self.word.next = signed_cast(self.machine_errors.data.val());
        if self.word_loaded.val() {
            self.word.next = signed_cast(self.loaded_errors.read_data.val());
        }
        if self.served.q.val() {
            self.read_back.d.next = self.none.val();
            if self.served_entry.q.val() {
                self.read_back.d.next = self.word.val();
            }
        }

        comment!("Outputs");
        self.entry.next = self.word.val();
        self.complete.next = self.is_complete.val();
        self.refused.next = self.refused_q.q.val();
        self.found.next = self.read_back.q.val();
        self.read_waits.next = self.waits.q.val();
    }
}
