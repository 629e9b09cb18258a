//! Knows the nearest position on either side of the count, and finds when one of them is passed.

use super::entry_list::EntryList;
use super::pulse::Pulse;
use crate::prelude::*;

kernel! {
    pub(super) struct Compare;
    ports posicast_blocks::compare_ports;

    parts { list: EntryList, timer: Pulse }
    registers {
        counted: Signed<32>, earlier: Signed<32>, by_list: Bit, on_rise: Bit, on_fall: Bit, distance: Signed<35>, total: Bits<32>,
        margin: Bits<16>, width_clocks: Bits<24>, armed_q: Bit, ready_q: Bit, index: Bits<32>, above: Signed<35>, above_known: Bit,
        below: Signed<35>, below_known: Bit, fetches: Bit, fetches_above: Bit, word_shown: Bit, last: Signed<32>, near: Bit,
        passed_q: Bit, upward_q: Bit, passes_q: Bits<32>, merged_q: Bit, jumped_q: Bit, refused_q: Bit,
    }
    wires {
        wide_count: Signed<35>, wide_earlier: Signed<35>, change: Signed<35>, rose: Bit, fell: Bit, still: Bit, jumps: Bit,
        from_above: Signed<35>, above_bits: Bits<35>, has_above: Bit, at_above: Bit, from_below: Signed<35>, below_bits: Bits<35>,
        has_below: Bit, under_below: Bit, upward: Bit, downward: Bit, seeks: Bit, seeks_up: Bit, seeks_down: Bit, steps_up: Bit,
        steps_down: Bit, wide_last: Signed<35>, from_last: Signed<35>, last_bits: Bits<35>, away: Bits<35>, is_near: Bit, same: Bit,
        wanted: Bit, fires: Bit, index_before: Bits<32>, word: Signed<35>, spacing_bits: Bits<35>, spaced: Signed<35>,
        wide_first: Signed<35>,
    }
    constants {
        one_up: Signed<35> = from_i64(1),
        one_down: Signed<35> = from_i64(-1),
        no_change: Signed<35> = from_i64(0),
        largest: Signed<35> = from_i64(i64::from(i32::MAX)),
        one_index: Bits<32> = from_u64(1),
        none: Bits<32> = from_u64(0),
        one_count: Bits<35> = from_u64(1),
        one_clock: Bits<24> = from_u64(1),
    }
    connect {
        list: entry, entry_write, entries_clear;
        timer: fires;
    }
}

impl Logic for Compare {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module compare");

        comment!("The change of the count");
        self.counted.d.next = self.count.val();
        self.earlier.d.next = self.counted.q.val();
        self.wide_count.next = signed_bit_cast::<35, 32>(self.counted.q.val());
        self.wide_earlier.next = signed_bit_cast::<35, 32>(self.earlier.q.val());
        self.change.next = self.wide_count.val() - self.wide_earlier.val();
        self.rose.next = self.ready_q.q.val() & (self.change.val() == self.one_up.val());
        self.fell.next = self.ready_q.q.val() & (self.change.val() == self.one_down.val());
        self.still.next = self.change.val() == self.no_change.val();
        self.jumps.next = self.ready_q.q.val() & !self.rose.val() & !self.fell.val() & !self.still.val();

        comment!("The positions on either side, and their passages");
        self.from_above.next = self.wide_count.val() - self.above.q.val();
        self.above_bits.next = unsigned_cast(self.from_above.val());
        self.from_below.next = self.wide_count.val() - self.below.q.val();
        self.below_bits.next = unsigned_cast(self.from_below.val());
        self.has_above.next = self.above_known.q.val()
            & (self.index.q.val() != self.total.q.val())
            & (self.above.q.val() <= self.largest.val());
        self.has_below.next = self.below_known.q.val() & self.index.q.val().any();
        self.at_above.next = self.has_above.val() & !self.above_bits.val().any();
        self.under_below.next = self.has_below.val() & self.below_bits.val().get_bit(34);
        self.upward.next = self.rose.val() & self.at_above.val();
        self.downward.next = self.fell.val() & self.has_below.val() & self.below_bits.val().all();

        comment!("Until ready, a step towards the count");
        self.seeks.next = self.armed_q.q.val() & !self.ready_q.q.val() & !self.fetches.q.val();
        self.seeks_up.next = self.seeks.val() & self.has_above.val() & !self.above_bits.val().get_bit(34);
        self.seeks_down.next = self.seeks.val() & self.under_below.val() & !self.seeks_up.val();
        self.steps_up.next = self.upward.val() | self.seeks_up.val();
        self.steps_down.next = self.downward.val() | self.seeks_down.val();
        if self.seeks.val() & !self.seeks_up.val() & !self.seeks_down.val() {
            self.ready_q.d.next = true;
        }
        if self.jumps.val() {
            self.ready_q.d.next = false;
        }

        comment!("A position of the list takes the place that is free");
        self.index_before.next = self.index.q.val() - self.one_index.val();
        self.list.read_address.next = self.index_before.val().get_bits::<8>(0);
        if self.fetches_above.q.val() {
            self.list.read_address.next = self.index.q.val().get_bits::<8>(0);
        }
        self.word.next = signed_bit_cast::<35, 32>(self.list.word.val());
        self.word_shown.d.next = self.fetches.q.val() & !self.word_shown.q.val();
        if self.fetches.q.val() & self.word_shown.q.val() {
            self.fetches.d.next = false;
            if self.fetches_above.q.val() {
                self.above.d.next = self.word.val();
                self.above_known.d.next = true;
            } else {
                self.below.d.next = self.word.val();
                self.below_known.d.next = true;
            }
        }
        if self.steps_up.val() {
            self.index.d.next = self.index.q.val() + self.one_index.val();
            self.below.d.next = self.above.q.val();
            self.below_known.d.next = true;
            self.above.d.next = self.above.q.val() + self.distance.q.val();
            self.above_known.d.next = !self.by_list.q.val();
        }
        if self.steps_down.val() {
            self.index.d.next = self.index_before.val();
            self.above.d.next = self.below.q.val();
            self.above_known.d.next = true;
            self.below.d.next = self.below.q.val() - self.distance.q.val();
            self.below_known.d.next = !self.by_list.q.val();
        }
        if self.by_list.q.val() & (self.steps_up.val() | self.steps_down.val()) {
            self.fetches.d.next = true;
            self.fetches_above.d.next = self.steps_up.val();
            self.word_shown.d.next = false;
        }

        comment!("Near the position of the last pulse there is none");
        self.wide_last.next = signed_bit_cast::<35, 32>(self.last.q.val());
        self.from_last.next = self.wide_count.val() - self.wide_last.val();
        self.last_bits.next = unsigned_cast(self.from_last.val());
        self.away.next = self.last_bits.val();
        if self.last_bits.val().get_bit(34) {
            self.away.next = !self.last_bits.val();
        }
        self.is_near.next = self.near.q.val() & (self.away.val() < bit_cast::<35, 16>(self.margin.q.val()));
        self.same.next =
            (self.upward.val() & !self.last_bits.val().any()) | (self.downward.val() & self.last_bits.val().all());
        self.wanted.next = (self.upward.val() & self.on_rise.q.val()) | (self.downward.val() & self.on_fall.q.val());
        self.fires.next = self.wanted.val() & !(self.is_near.val() & self.same.val());
        self.near.d.next = self.is_near.val() | self.fires.val();
        self.passed_q.d.next = self.fires.val();
        if self.fires.val() {
            self.passes_q.d.next = self.passes_q.q.val() + self.one_index.val();
            self.upward_q.d.next = self.upward.val();
            self.last.d.next = self.earlier.q.val();
            if self.upward.val() {
                self.last.d.next = self.counted.q.val();
            }
        }

        comment!("Arm and disarm");
        self.wide_first.next = signed_bit_cast::<35, 32>(self.first.val());
        self.spacing_bits.next = bit_cast::<35, 32>(self.spacing.val());
        if !self.spacing.val().any() {
            self.spacing_bits.next = self.one_count.val();
        }
        self.spaced.next = signed_cast(self.spacing_bits.val());
        if self.arm.val() {
            self.by_list.d.next = self.use_list.val();
            self.on_rise.d.next = self.rises.val();
            self.on_fall.d.next = self.falls.val();
            self.distance.d.next = self.spaced.val();
            self.total.d.next = self.positions.val();
            if self.use_list.val() {
                self.total.d.next = bit_cast::<32, 9>(self.list.entries.val());
            }
            self.margin.d.next = self.hysteresis.val();
            self.width_clocks.d.next = self.pulse_clocks.val();
            if !self.pulse_clocks.val().any() {
                self.width_clocks.d.next = self.one_clock.val();
            }
            self.armed_q.d.next = true;
            self.ready_q.d.next = false;
            self.index.d.next = self.none.val();
            self.above.d.next = self.wide_first.val();
            self.above_known.d.next = !self.use_list.val();
            self.below.d.next = self.wide_first.val() - self.spaced.val();
            self.below_known.d.next = true;
            self.fetches.d.next = self.use_list.val();
            self.fetches_above.d.next = true;
            self.word_shown.d.next = false;
            self.near.d.next = false;
            self.passes_q.d.next = self.none.val();
        }
        if self.disarm.val() {
            self.armed_q.d.next = false;
            self.ready_q.d.next = false;
        }
        self.list.frozen.next = self.armed_q.q.val() | self.arm.val();
        self.timer.width_clocks.next = self.width_clocks.q.val();

        comment!("Flags; setting wins");
        self.merged_q.d.next = self.timer.merges.val() | (self.merged_q.q.val() & !self.clear_flags.val());
        self.jumped_q.d.next = self.jumps.val() | (self.jumped_q.q.val() & !self.clear_flags.val());
        self.refused_q.d.next = self.list.refuses.val() | (self.refused_q.q.val() & !self.clear_flags.val());

        comment!("Outputs");
        self.pulse.next = self.timer.pulse.val();
        self.passed.next = self.passed_q.q.val();
        self.passed_upward.next = self.upward_q.q.val();
        self.passes.next = self.passes_q.q.val();
        self.armed.next = self.armed_q.q.val();
        self.ready.next = self.ready_q.q.val();
        self.entries.next = self.list.entries.val();
        self.merged.next = self.merged_q.q.val();
        self.jumped.next = self.jumped_q.q.val();
        self.refused.next = self.refused_q.q.val();
    }
}
