//! Finds the entries beside a position, interpolates the error there, and multiplies it by the weight, one bit per
//! clock.
//!
//! ```text
//! step           action
//! 0              place := position relative to the first entry, in 256ths of a count
//! 1 .. 40        the place rotates once: its bits from K on become the index n; bits above show a place outside
//! 41             n := the first or the last entry, if the place is outside the table
//! 42             E_n is read
//! 43             average := E_n
//! 44 .. 43+K     average := (average + E_n or E_n+1) / 2       by the bits of the fraction
//! 44+K           whole := average, rounded; place := weight; average := 0
//! 45+K .. 54+K   average := (average + 0 or whole) / 2         by the bits of the weight
//! 55+K           error := average, rounded; at the full weight, whole
//! ```
//!
//! K is the number of bits of the place below the index: the fraction. Averaging both neighbours by these bits, lowest
//! first, interpolates without a multiplier. Averaging 0 and the whole error by the bits of the weight multiplies them.

use super::average::Average;
use crate::prelude::*;
use posicast_blocks::error_table::{ErrorTableConfig, FULL_WEIGHT};

kernel! {
    pub(super) struct Lookup(config: &ErrorTableConfig);

    inputs {
        rst: Bit,
        valid: Bit,
        counts: Bits<32>,
        fraction: Bits<8>,
        weight: Bits<11>,
        entry: Signed<18>,
    }
    outputs { address: Bits<8>, busy: Bit, ends: Bit, error: Signed<18> }
    parts { average: Average }
    registers {
        runs: Bit, step: Bits<7>, place_low: Bits<8>, place_high: Bits<32>, index: Bits<8>, beyond: Bit, below: Bit,
        in_table: Bit, whole: Signed<18>, shown: Signed<18>,
    }
    wires {
        last_step: Bit, reads_first: Bit, leaving: Bit, entering_high: Bits<32>, entering_low: Bits<8>,
        upper: Bit, fades: Bit, in_range: Bit, full: Bit,
    }
    constants {
        first_step: Bits<7> = from_u64(0),
        one_step: Bits<7> = from_u64(1),
        places_end: Bits<7> = from_u64(40),
        settle_step: Bits<7> = from_u64(41),
        first_entry: Bits<7> = from_u64(42),
        load_step: Bits<7> = from_u64(43),
        index_end: Bits<7> = from_u64(fraction_bits(config) + 8),
        found_step: Bits<7> = from_u64(fraction_bits(config) + 44),
        weighted_step: Bits<7> = from_u64(fraction_bits(config) + 55),
        end_step: Bits<7> = from_u64(fraction_bits(config) + 56),
        last: Bits<8> = from_u64(config.last().into()),
        full_weight: Bits<11> = from_u64(FULL_WEIGHT.into()),
        no_index: Bits<8> = from_u64(0),
        one_index: Bits<8> = from_u64(1),
    }
    connect {
        average: entry;
    }
}

/// Bits of a position below the table's index: those of the spacing, and the 8 fraction bits of a count.
fn fraction_bits(config: &ErrorTableConfig) -> u64 {
    u64::from(config.format().spacing_bits) + 8
}

impl Logic for Lookup {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module error_lookup_${value index_end}x${value last}");

        comment!("Count the steps from valid on");
        self.last_step.next = self.step.q.val() == self.end_step.val();
        self.step.d.next = self.first_step.val();
        self.runs.d.next = false;
        if self.runs.q.val() & !self.last_step.val() {
            self.step.d.next = self.step.q.val() + self.one_step.val();
            self.runs.d.next = true;
        }
        if self.valid.val() {
            self.step.d.next = self.first_step.val();
            self.runs.d.next = true;
        }

        comment!("The place rotates, except while an entry is read");
        self.reads_first.next = self.step.q.val() == self.first_entry.val();
        self.leaving.next = self.place_low.q.val().get_bit(0);
        self.entering_high.next = bit_cast::<32, 8>(self.place_low.q.val());
        self.entering_low.next = bit_cast::<8, 32>(self.place_high.q.val());
        if !((self.step.q.val() == self.settle_step.val()) | self.reads_first.val()) {
            self.place_high.d.next = (self.place_high.q.val() >> 1) | (self.entering_high.val() << 31);
            self.place_low.d.next = (self.place_low.q.val() >> 1) | (self.entering_low.val() << 7);
        }
        if self.step.q.val() == self.first_step.val() {
            self.place_high.d.next = self.counts.val();
            self.place_low.d.next = self.fraction.val();
        }
        if self.step.q.val() == self.found_step.val() {
            self.place_high.d.next = bit_cast::<32, 2>(self.weight.val().get_bits::<2>(8));
            self.place_low.d.next = self.weight.val().get_bits::<8>(0);
        }

        comment!("The index, and whether a bit above it is set");
        self.upper.next = (self.step.q.val() > self.index_end.val()) & (self.step.q.val() <= self.places_end.val());
        if self.step.q.val() <= self.index_end.val() {
            self.index.d.next = (self.index.q.val() >> 1) | (self.place_low.q.val() << 7);
        }
        self.beyond.d.next = self.beyond.q.val() | (self.leaving.val() & self.upper.val());
        if self.step.q.val() == self.first_step.val() {
            self.beyond.d.next = false;
        }
        if self.step.q.val() == self.places_end.val() {
            self.below.d.next = self.leaving.val();
        }

        comment!("Outside the table, its end values are used");
        self.in_range.next = !self.beyond.q.val() & (self.index.q.val() < self.last.val());
        if self.step.q.val() == self.settle_step.val() {
            self.in_table.d.next = self.in_range.val();
            if !self.in_range.val() {
                self.index.d.next = self.last.val();
            }
            if self.below.q.val() {
                self.index.d.next = self.no_index.val();
            }
        }
        self.address.next = self.index.q.val();
        if self.leaving.val() & self.in_table.q.val() & !self.reads_first.val() {
            self.address.next = self.index.q.val() + self.one_index.val();
        }

        comment!("Average the neighbours, then 0 and the error");
        self.fades.next = self.step.q.val() > self.found_step.val();
        self.average.takes_entry.next = self.weight.val().any() & !self.fades.val();
        self.average.whole.next = self.whole.q.val();
        self.average.takes_whole.next = self.fades.val() & self.leaving.val();
        self.average.load.next = self.step.q.val() == self.load_step.val();
        self.average.clear.next = self.step.q.val() == self.found_step.val();
        if self.step.q.val() == self.found_step.val() {
            self.whole.d.next = self.average.rounded.val();
        }
        self.full.next = self.weight.val() == self.full_weight.val();
        if self.step.q.val() == self.weighted_step.val() {
            self.shown.d.next = self.average.rounded.val();
            if self.full.val() {
                self.shown.d.next = self.whole.q.val();
            }
        }

        comment!("Outputs");
        self.busy.next = self.runs.q.val();
        self.ends.next = self.runs.q.val() & self.last_step.val();
        self.error.next = self.shown.q.val();
    }
}
