//! The three tap tables, how one is loaded, and when one becomes active.
//!
//! Bank 0 is a ROM with the machine's table; banks 1 and 2 are the halves of one RAM. A word of either is
//! `{delay, coefficient}`. The word of `tap` stands at `coefficient` and `delay` two clocks later: one is the memory's, and since
//! block RAM is slow to show its word, it goes through a register before anything is made of it.
//!
//! - A write with index 0 begins a table anew, one with the number of taps so far goes on. Each loadable bank keeps that
//!   number and the sum of its coefficients.
//! - Refused, with no effect but the flag: a write to bank 0 or 3 or to the active bank, out of sequence, with a delay of
//!   all ones, while a swap is pending, or in the clock of a `swap`; a swap while one is pending, to bank 3, or to a
//!   bank whose sum is not one.
//! - A swap waits for the next strobe with `take`. So a table that does not sum to one never becomes active, and one that
//!   is active or about to be never changes. One that is not `known` is refused.
//! - For a handover, `old` reads the table that was active before; `locked` refuses writes and swaps as a swap that is
//!   pending does; `reach` is the longest delay of both tables of the last swap.

use crate::prelude::*;
use posicast_model::rtl::shaper::ShaperConfig;
use posicast_model::taps::COEFFICIENT_BITS;

/// A ring address, T index, COUNT = T + 1, SUM = 18 + T, WORD = 18 + A bits.
#[derive(LogicBlock)]
pub(super) struct TapBanks<const A: usize, const T: usize, const COUNT: usize, const SUM: usize, const WORD: usize> {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) strobe: Signal<In, Bit>,
    pub(super) clear_flags: Signal<In, Bit>,
    pub(super) tap_write: Signal<In, Bit>,
    pub(super) tap_bank: Signal<In, Bits<2>>,
    pub(super) tap_index: Signal<In, Bits<T>>,
    pub(super) tap_coefficient: Signal<In, Signed<18>>,
    pub(super) tap_delay: Signal<In, Bits<A>>,
    pub(super) swap: Signal<In, Bit>,
    pub(super) swap_bank: Signal<In, Bits<2>>,
    pub(super) known: Signal<In, Bit>,
    pub(super) take: Signal<In, Bit>,
    pub(super) locked: Signal<In, Bit>,
    pub(super) old: Signal<In, Bit>,
    pub(super) tap: Signal<In, Bits<T>>,
    pub(super) coefficient: Signal<Out, Signed<18>>,
    pub(super) delay: Signal<Out, Bits<A>>,
    pub(super) taps: Signal<Out, Bits<COUNT>>,
    pub(super) accepted: Signal<Out, Bit>,
    pub(super) reach: Signal<Out, Bits<A>>,
    pub(super) swap_pending: Signal<Out, Bit>,
    pub(super) bank: Signal<Out, Bits<2>>,
    pub(super) refused: Signal<Out, Bit>,

    machine_taps: Rom<WORD, T>,
    loaded_taps: Ram<WORD, COUNT>,

    taps_1: Dff<Bits<COUNT>>,
    taps_2: Dff<Bits<COUNT>>,
    sum_1: Dff<Signed<SUM>>,
    sum_2: Dff<Signed<SUM>>,
    longest_1: Dff<Bits<A>>,
    longest_2: Dff<Bits<A>>,
    active: Dff<Bits<2>>,
    previous: Dff<Bits<2>>,
    upcoming: Dff<Bits<2>>,
    pending: Dff<Bit>,
    reach_q: Dff<Bits<A>>,
    old_q: Dff<Bit>,
    word: Dff<Bits<WORD>>,
    refused_q: Dff<Bit>,

    taps_so_far: Signal<Local, Bits<COUNT>>,
    sum_so_far: Signal<Local, Signed<SUM>>,
    longest_so_far: Signal<Local, Bits<A>>,
    index: Signal<Local, Bits<COUNT>>,
    begins: Signal<Local, Bit>,
    loadable: Signal<Local, Bit>,
    free: Signal<Local, Bit>,
    at_rest: Signal<Local, Bit>,
    in_reach: Signal<Local, Bit>,
    write_taken: Signal<Local, Bit>,
    new_taps: Signal<Local, Bits<COUNT>>,
    new_sum: Signal<Local, Signed<SUM>>,
    new_longest: Signal<Local, Bits<A>>,
    addend: Signal<Local, Signed<SUM>>,
    swap_taken: Signal<Local, Bit>,
    active_longest: Signal<Local, Bits<A>>,
    swap_longest: Signal<Local, Bits<A>>,
    read_bank: Signal<Local, Bits<2>>,
    word_bank: Signal<Local, Bits<2>>,
    write_address: Signal<Local, Bits<COUNT>>,
    read_address: Signal<Local, Bits<COUNT>>,
    coefficient_bits: Signal<Local, Bits<18>>,

    bank_rom: Constant<Bits<2>>,
    bank_1: Constant<Bits<2>>,
    bank_2: Constant<Bits<2>>,
    upper_half: Constant<Bits<COUNT>>,
    one_tap: Constant<Bits<COUNT>>,
    machine_count: Constant<Bits<COUNT>>,
    machine_longest: Constant<Bits<A>>,
    forbidden_delay: Constant<Bits<A>>,
    no_delay: Constant<Bits<A>>,
    no_sum: Constant<Signed<SUM>>,
    unity: Constant<Signed<SUM>>,
}

impl<const A: usize, const T: usize, const COUNT: usize, const SUM: usize, const WORD: usize>
    TapBanks<A, T, COUNT, SUM, WORD>
{
    pub(super) fn new(config: &ShaperConfig) -> Self {
        const { assert!(COUNT == T + 1 && SUM == 18 + T && WORD == 18 + A) };
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            strobe: Signal::default(),
            clear_flags: Signal::default(),
            tap_write: Signal::default(),
            tap_bank: Signal::default(),
            tap_index: Signal::default(),
            tap_coefficient: Signal::default(),
            tap_delay: Signal::default(),
            swap: Signal::default(),
            swap_bank: Signal::default(),
            known: Signal::default(),
            take: Signal::default(),
            locked: Signal::default(),
            old: Signal::default(),
            tap: Signal::default(),
            coefficient: Signal::default(),
            delay: Signal::default(),
            taps: Signal::default(),
            accepted: Signal::default(),
            reach: Signal::default(),
            swap_pending: Signal::default(),
            bank: Signal::default(),
            refused: Signal::default(),
            machine_taps: Rom::new("machine_taps", rom_words(config)),
            loaded_taps: Ram::default(),
            taps_1: Dff::default(),
            taps_2: Dff::default(),
            sum_1: Dff::default(),
            sum_2: Dff::default(),
            longest_1: Dff::default(),
            longest_2: Dff::default(),
            active: Dff::default(),
            previous: Dff::default(),
            upcoming: Dff::default(),
            pending: Dff::default(),
            reach_q: Dff::default(),
            old_q: Dff::default(),
            word: Dff::default(),
            refused_q: Dff::default(),
            taps_so_far: Signal::default(),
            sum_so_far: Signal::default(),
            longest_so_far: Signal::default(),
            index: Signal::default(),
            begins: Signal::default(),
            loadable: Signal::default(),
            free: Signal::default(),
            at_rest: Signal::default(),
            in_reach: Signal::default(),
            write_taken: Signal::default(),
            new_taps: Signal::default(),
            new_sum: Signal::default(),
            new_longest: Signal::default(),
            addend: Signal::default(),
            swap_taken: Signal::default(),
            active_longest: Signal::default(),
            swap_longest: Signal::default(),
            read_bank: Signal::default(),
            word_bank: Signal::default(),
            write_address: Signal::default(),
            read_address: Signal::default(),
            coefficient_bits: Signal::default(),
            bank_rom: Constant::new(from_u64(0)),
            bank_1: Constant::new(from_u64(1)),
            bank_2: Constant::new(from_u64(2)),
            upper_half: Constant::new(from_u64(u64::from(config.most_taps()))),
            one_tap: Constant::new(from_u64(1)),
            machine_count: Constant::new(from_u64(config.table().taps().len() as u64)),
            machine_longest: Constant::new(from_u64(u64::from(config.table().longest_delay_samples()))),
            forbidden_delay: Constant::new(from_u64(u64::from(config.longest_delay_samples()) + 1)),
            no_delay: Constant::new(from_u64(0)),
            no_sum: Constant::new(from_i64(0)),
            unity: Constant::new(from_i64(1 << config.coefficient_fraction())),
        }
    }
}

/// The machine's table as `{delay, coefficient}`.
fn rom_words(config: &ShaperConfig) -> Vec<RomWord> {
    let one = f64::from(1u32 << config.coefficient_fraction());
    let word = |tap: &posicast_model::taps::Tap| RomWord {
        pattern: u64::from(tap.delay_samples) << COEFFICIENT_BITS
            | (tap.coefficient as u64 & ((1 << COEFFICIENT_BITS) - 1)),
        meaning: format!(
            "{:.6} = {} / 2^{} after {} samples",
            f64::from(tap.coefficient) / one,
            tap.coefficient,
            config.coefficient_fraction(),
            tap.delay_samples
        ),
    };
    config.table().taps().iter().map(word).collect()
}

impl<const A: usize, const T: usize, const COUNT: usize, const SUM: usize, const WORD: usize> Logic
    for TapBanks<A, T, COUNT, SUM, WORD>
{
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module tap_banks");
        comment!("@about Tap tables: bank 0 is ROM, 1 and 2 load.");
        comment!("@about Index 0 begins a table, the rest in order.");
        comment!("@about A swap waits for the next strobe; refused");
        comment!("@about unless the coefficients sum to 2^F.");
        dff_setup!(
            self, clk, taps_1, taps_2, sum_1, sum_2, longest_1, longest_2, active, previous, upcoming, pending,
            reach_q, old_q, word, refused_q
        );
        self.machine_taps.clk.next = self.clk.val();
        self.loaded_taps.clk.next = self.clk.val();

        comment!("Writing: how far the bank addressed is loaded");
        self.taps_so_far.next = self.taps_1.q.val();
        self.sum_so_far.next = self.sum_1.q.val();
        self.longest_so_far.next = self.longest_1.q.val();
        self.write_address.next = bit_cast::<COUNT, T>(self.tap_index.val());
        if self.tap_bank.val() == self.bank_2.val() {
            self.taps_so_far.next = self.taps_2.q.val();
            self.sum_so_far.next = self.sum_2.q.val();
            self.longest_so_far.next = self.longest_2.q.val();
            self.write_address.next = bit_cast::<COUNT, T>(self.tap_index.val()) | self.upper_half.val();
        }
        self.begins.next = !self.tap_index.val().any();
        if self.begins.val() {
            self.sum_so_far.next = self.no_sum.val();
            self.longest_so_far.next = self.no_delay.val();
        }

        comment!("Taken in sequence, into a bank at rest");
        self.loadable.next = (self.tap_bank.val() == self.bank_1.val()) | (self.tap_bank.val() == self.bank_2.val());
        self.free.next = !(self.pending.q.val() | self.locked.val());
        self.at_rest.next = (self.tap_bank.val() != self.active.q.val()) & self.free.val() & !self.swap.val();
        self.in_reach.next = self.tap_delay.val() != self.forbidden_delay.val();
        self.index.next = bit_cast::<COUNT, T>(self.tap_index.val());
        self.write_taken.next = false;
        if self.begins.val() | (self.index.val() == self.taps_so_far.val()) {
            self.write_taken.next =
                self.tap_write.val() & self.loadable.val() & self.at_rest.val() & self.in_reach.val();
        }
        self.addend.next = signed_bit_cast::<SUM, 18>(self.tap_coefficient.val());
        self.new_taps.next = self.index.val() + self.one_tap.val();
        self.new_sum.next = self.sum_so_far.val() + self.addend.val();
        self.new_longest.next = self.longest_so_far.val();
        if self.tap_delay.val() > self.longest_so_far.val() {
            self.new_longest.next = self.tap_delay.val();
        }
        if self.write_taken.val() {
            if self.tap_bank.val() == self.bank_2.val() {
                self.taps_2.d.next = self.new_taps.val();
                self.sum_2.d.next = self.new_sum.val();
                self.longest_2.d.next = self.new_longest.val();
            } else {
                self.taps_1.d.next = self.new_taps.val();
                self.sum_1.d.next = self.new_sum.val();
                self.longest_1.d.next = self.new_longest.val();
            }
        }
        self.coefficient_bits.next = unsigned_cast(self.tap_coefficient.val());
        self.loaded_taps.write_enable.next = self.write_taken.val();
        self.loaded_taps.write_address.next = self.write_address.val();
        self.loaded_taps.write_data.next =
            (bit_cast::<WORD, A>(self.tap_delay.val()) << 18) | bit_cast::<WORD, 18>(self.coefficient_bits.val());

        comment!("Swapping: only to a table that sums to one");
        self.swap_taken.next = false;
        if self.swap_bank.val() == self.bank_rom.val() {
            self.swap_taken.next = self.swap.val() & self.free.val() & self.known.val();
        }
        if (self.swap_bank.val() == self.bank_1.val()) & (self.sum_1.q.val() == self.unity.val()) {
            self.swap_taken.next = self.swap.val() & self.free.val() & self.known.val();
        }
        if (self.swap_bank.val() == self.bank_2.val()) & (self.sum_2.q.val() == self.unity.val()) {
            self.swap_taken.next = self.swap.val() & self.free.val() & self.known.val();
        }
        if self.strobe.val() & self.pending.q.val() & self.take.val() {
            self.active.d.next = self.upcoming.q.val();
            self.previous.d.next = self.active.q.val();
            self.pending.d.next = false;
        }
        if self.swap_taken.val() {
            self.upcoming.d.next = self.swap_bank.val();
            self.pending.d.next = true;
        }

        comment!("How far back the tables of a swap reach");
        self.active_longest.next = self.longest_1.q.val();
        if self.active.q.val() == self.bank_2.val() {
            self.active_longest.next = self.longest_2.q.val();
        }
        if self.active.q.val() == self.bank_rom.val() {
            self.active_longest.next = self.machine_longest.val();
        }
        self.swap_longest.next = self.longest_1.q.val();
        if self.swap_bank.val() == self.bank_2.val() {
            self.swap_longest.next = self.longest_2.q.val();
        }
        if self.swap_bank.val() == self.bank_rom.val() {
            self.swap_longest.next = self.machine_longest.val();
        }
        if self.swap_taken.val() {
            self.reach_q.d.next = self.active_longest.val();
            if self.swap_longest.val() > self.active_longest.val() {
                self.reach_q.d.next = self.swap_longest.val();
            }
        }

        comment!("Refusals, set over clear");
        if self.clear_flags.val() {
            self.refused_q.d.next = false;
        }
        if (self.tap_write.val() & !self.write_taken.val()) | (self.swap.val() & !self.swap_taken.val()) {
            self.refused_q.d.next = true;
        }

        comment!("Reading: the active table, or the old one");
        self.read_bank.next = self.active.q.val();
        if self.old.val() {
            self.read_bank.next = self.previous.q.val();
        }
        self.taps.next = self.taps_1.q.val();
        if self.read_bank.val() == self.bank_2.val() {
            self.taps.next = self.taps_2.q.val();
        }
        if self.read_bank.val() == self.bank_rom.val() {
            self.taps.next = self.machine_count.val();
        }
        comment!("Bank 1 is the lower half, all others the upper");
        self.read_address.next = bit_cast::<COUNT, T>(self.tap.val()) | self.upper_half.val();
        if self.read_bank.val() == self.bank_1.val() {
            self.read_address.next = bit_cast::<COUNT, T>(self.tap.val());
        }
        self.machine_taps.address.next = self.tap.val();
        self.loaded_taps.read_address.next = self.read_address.val();
        self.old_q.d.next = self.old.val();
        self.word_bank.next = self.active.q.val();
        if self.old_q.q.val() {
            self.word_bank.next = self.previous.q.val();
        }
        self.word.d.next = self.loaded_taps.read_data.val();
        if self.word_bank.val() == self.bank_rom.val() {
            self.word.d.next = self.machine_taps.data.val();
        }
        self.coefficient.next = signed_cast(self.word.q.val().get_bits::<18>(0));
        self.delay.next = self.word.q.val().get_bits::<A>(18);

        comment!("Outputs");
        self.accepted.next = self.swap_taken.val();
        self.reach.next = self.reach_q.q.val();
        self.swap_pending.next = self.pending.q.val();
        self.bank.next = self.active.q.val();
        self.refused.next = self.refused_q.q.val();
    }
}
