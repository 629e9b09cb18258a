//! Controls the weight and the bank in use, and subtracts the error from the position reference.

use super::entry_banks::EntryBanks;
use super::lookup::Lookup;
use crate::prelude::*;
use posicast_blocks::error_table::{ErrorTableConfig, FULL_WEIGHT};

kernel! {
    pub(super) struct ErrorTable(config: &ErrorTableConfig);
    ports posicast_blocks::error_table_ports;

    parts { banks: EntryBanks = EntryBanks::new(config), lookup: Lookup = Lookup::new(config) }
    registers { weight: Bits<11>, loaded: Bit, base: Signed<32>, compensated_q: Signed<32>, valid_q: Bit }
    wires {
        off: Bit, wanted: Bit, goes_on: Bit, reference_bits: Bits<32>, reference_counts: Signed<24>, position: Signed<32>,
        fraction: Bits<8>, from_first: Signed<32>, fine_error: Signed<32>, error_bits: Bits<32>, in_force: Signed<32>,
        wide_reference: Signed<33>, wide_error: Signed<33>, sum: Signed<33>, sum_bits: Bits<33>, beyond: Bit,
    }
    constants {
        first_counts: Signed<32> = from_i64(config.format().first_counts.into()),
        no_weight: Bits<11> = from_u64(0),
        one_weight: Bits<11> = from_u64(1),
        full_weight: Bits<11> = from_u64(FULL_WEIGHT.into()),
        no_fraction: Bits<8> = from_u64(0),
        largest: Signed<32> = from_i64(i64::from(i32::MAX)),
        smallest: Signed<32> = from_i64(i64::from(i32::MIN)),
    }
    connect {
        lookup: valid, fraction;
        lookup from banks: entry;
        banks from lookup: busy, address;
        banks: error_write, error_bank, error_index, error_entry, error_read;
    }
}

impl Logic for ErrorTable {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module error_table");

        comment!("The weight goes up or down by one; bank and origin");
        comment!("change only while it is 0");
        self.off.next = !self.weight.q.val().any();
        self.wanted.next =
            self.error_enable.val() & self.homed.val() & (!self.error_select.val() | self.banks.complete.val());
        self.goes_on.next = self.wanted.val() & !(self.error_select.val() ^ self.loaded.q.val());
        if self.valid.val() {
            if self.off.val() {
                self.loaded.d.next = self.error_select.val();
                self.base.d.next = self.origin.val() + self.first_counts.val();
                if self.wanted.val() & !self.error_write.val() {
                    self.weight.d.next = self.one_weight.val();
                }
            } else {
                self.weight.d.next = self.weight.q.val() - self.one_weight.val();
                if self.goes_on.val() {
                    self.weight.d.next = self.weight.q.val();
                    if self.weight.q.val() != self.full_weight.val() {
                        self.weight.d.next = self.weight.q.val() + self.one_weight.val();
                    }
                }
            }
            if !self.drive_enable.val() {
                self.weight.d.next = self.no_weight.val();
            }
        }

        comment!("The position relative to the first entry");
        self.reference_bits.next = unsigned_cast(self.position_reference.val());
        self.reference_counts.next = signed_cast(self.reference_bits.val().get_bits::<24>(8));
        self.position.next = signed_bit_cast::<32, 24>(self.reference_counts.val());
        self.fraction.next = self.reference_bits.val().get_bits::<8>(0);
        if self.on_measured.val() {
            self.position.next = self.measured.val();
            self.fraction.next = self.no_fraction.val();
        }
        self.from_first.next = self.position.val() - self.base.q.val();

        self.lookup.counts.next = unsigned_cast(self.from_first.val());
        self.lookup.weight.next = self.weight.q.val();

        self.banks.in_use.next = self.loaded.q.val() & !self.off.val();
        self.banks.from_loaded.next = self.loaded.q.val();

        comment!("The reference minus the error in use");
        self.fine_error.next = signed_bit_cast::<32, 18>(self.lookup.error.val());
        self.error_bits.next = unsigned_cast(self.fine_error.val());
        self.in_force.next = self.fine_error.val();
        if self.coarse.val() {
            self.in_force.next = signed_cast(self.error_bits.val() << 4);
        }
        self.wide_reference.next = signed_bit_cast::<33, 32>(self.position_reference.val());
        self.wide_error.next = signed_bit_cast::<33, 32>(self.in_force.val());
        self.sum.next = self.wide_reference.val() - self.wide_error.val();
        self.sum_bits.next = unsigned_cast(self.sum.val());
        self.beyond.next = self.sum_bits.val().get_bit(32) ^ self.sum_bits.val().get_bit(31);
        self.valid_q.d.next = self.lookup.ends.val();
        if self.lookup.ends.val() {
            self.compensated_q.d.next = signed_bit_cast::<32, 33>(self.sum.val());
            if self.beyond.val() {
                self.compensated_q.d.next = self.largest.val();
                if self.sum_bits.val().get_bit(32) {
                    self.compensated_q.d.next = self.smallest.val();
                }
            }
        }

        comment!("Outputs");
        self.compensated.next = self.compensated_q.q.val();
        self.compensated_valid.next = self.valid_q.q.val();
        self.table_error.next = self.in_force.val();
        self.error_weight.next = self.weight.q.val();
        self.error_bank_used.next = self.loaded.q.val();
        self.error_complete.next = self.banks.complete.val();
        self.error_refused.next = self.banks.refused.val();
        self.error_loaded.next = self.banks.found.val();
        self.error_read_waits.next = self.banks.read_waits.val();
    }
}
