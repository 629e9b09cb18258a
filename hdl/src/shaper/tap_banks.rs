//! The three tap tables: how one is loaded and becomes active.
//!
//! Bank 0 is a ROM with the machine's table; banks 1 and 2 are the halves of one RAM. A word of either is
//! `{delay, coefficient}`. The word of `tap` comes at `coefficient` and `delay` two clocks later: one clock is the
//! memory's, and because the output of block RAM is slow, it passes a register before it is used.
//!
//! - A write with index 0 begins a new table; the index of each further write must be the number of taps so far. Each
//!   loadable bank keeps that number and the sum of its coefficients.
//! - These are refused, with no effect except the flag: a write to bank 0 or 3 or to the active bank, out of
//!   sequence, with a delay of all ones, while a swap is pending, or in the clock of a `swap`; a swap while one is
//!   pending, to bank 3, or to a bank whose sum is not one.
//! - A swap waits for the next strobe with `take`. So a table whose sum is not one never becomes active, and one that
//!   is active or about to be never changes. A swap with `known` low is refused.
//! - For a handover, `old` reads the table that was active before; `locked` refuses writes and swaps as a pending
//!   swap does; `reach` is the longest delay of both tables of the last swap.
//! - A host can read back any tap. Its read uses the tables in the first clock in which no pass is `busy` and nothing
//!   is written; a tap that is not loaded reads as 0. Its word also passes the register `word`, which no pass uses
//!   then.

use crate::prelude::*;
use posicast_blocks::shaper::ShaperConfig;
use posicast_taps::COEFFICIENT_BITS;

kernel! {
    /// Sizes: A ring address bits, T index bits, COUNT = T + 1, SUM = 18 + T, WORD = 18 + A bits.
    pub(super) struct TapBanks<const A: usize, const T: usize, const COUNT: usize, const SUM: usize, const WORD: usize>
        (config: &ShaperConfig)
        where COUNT == T + 1 && SUM == 18 + T && WORD == 18 + A;

    inputs {
        rst: Bit,
        strobe: Bit,
        clear_flags: Bit,
        tap_write: Bit,
        tap_bank: Bits<2>,
        tap_index: Bits<T>,
        tap_coefficient: Signed<18>,
        tap_delay: Bits<A>,
        tap_read: Bit,
        busy: Bit,
        swap: Bit,
        swap_bank: Bits<2>,
        known: Bit,
        take: Bit,
        locked: Bit,
        old: Bit,
        tap: Bits<T>,
    }
    outputs {
        coefficient: Signed<18>,
        delay: Bits<A>,
        taps: Bits<COUNT>,
        accepted: Bit,
        reach: Bits<A>,
        swap_pending: Bit,
        bank: Bits<2>,
        refused: Bit,
        loaded_coefficient: Signed<18>,
        loaded_delay: Bits<A>,
        tap_read_waits: Bit,
    }
    parts {
        machine_taps: Rom<WORD, T> = Rom::new("machine_taps", rom_words(config)),
        loaded_taps: Ram<WORD, COUNT>,
    }
    registers {
        taps_1: Bits<COUNT>, taps_2: Bits<COUNT>, sum_1: Signed<SUM>, sum_2: Signed<SUM>, longest_1: Bits<A>,
        longest_2: Bits<A>, active: Bits<2>, previous: Bits<2>, upcoming: Bits<2>, pending: Bit,
        reach_q: Bits<A>, old_q: Bit, word: Bits<WORD>, refused_q: Bit,
        read_waits: Bit, served: Bit, served_rom: Bit, served_tap: Bit, read_back: Bits<WORD>,
    }
    wires {
        taps_so_far: Bits<COUNT>, sum_so_far: Signed<SUM>, longest_so_far: Bits<A>, index: Bits<COUNT>,
        begins: Bit, loadable: Bit, free: Bit, at_rest: Bit, in_reach: Bit, write_taken: Bit,
        new_taps: Bits<COUNT>, new_sum: Signed<SUM>, new_longest: Bits<A>, addend: Signed<SUM>,
        swap_taken: Bit, active_longest: Bits<A>, swap_longest: Bits<A>, read_bank: Bits<2>,
        word_bank: Bits<2>, write_address: Bits<COUNT>, read_address: Bits<COUNT>, coefficient_bits: Bits<18>,
        serves: Bit, host_taps: Bits<COUNT>, read_tap: Bits<T>, from_rom: Bit, read_word: Bits<WORD>,
    }
    constants {
        bank_rom: Bits<2> = from_u64(0),
        bank_1: Bits<2> = from_u64(1),
        bank_2: Bits<2> = from_u64(2),
        bank_none: Bits<2> = from_u64(3),
        upper_half: Bits<COUNT> = from_u64(u64::from(config.most_taps())),
        one_tap: Bits<COUNT> = from_u64(1),
        machine_count: Bits<COUNT> = from_u64(config.table().taps().len() as u64),
        machine_longest: Bits<A> = from_u64(u64::from(config.table().longest_delay_samples())),
        forbidden_delay: Bits<A> = from_u64(u64::from(config.longest_delay_samples()) + 1),
        no_delay: Bits<A> = from_u64(0),
        no_sum: Signed<SUM> = from_i64(0),
        no_word: Bits<WORD> = from_u64(0),
        unity: Signed<SUM> = from_i64(1 << config.coefficient_fraction()),
    }
    connect {
        loaded_taps: write_address, read_address;
    }
}

/// The machine's table as `{delay, coefficient}`.
fn rom_words(config: &ShaperConfig) -> Vec<RomWord> {
    let one = f64::from(1u32 << config.coefficient_fraction());
    let word = |tap: &posicast_taps::Tap| RomWord {
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

        comment!("Write: number of taps in the addressed bank");
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

        comment!("Accepted in sequence, into an inactive bank");
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
        self.loaded_taps.write_data.next =
            (bit_cast::<WORD, A>(self.tap_delay.val()) << 18) | bit_cast::<WORD, 18>(self.coefficient_bits.val());

        comment!("A host reads a tap back while no pass runs");
        self.serves.next = self.read_waits.q.val() & !self.served.q.val() & !self.busy.val() & !self.tap_write.val();
        self.served.d.next = self.serves.val();
        self.read_waits.d.next = self.tap_read.val() | (self.read_waits.q.val() & !self.served.q.val());
        self.host_taps.next = self.taps_so_far.val();
        if self.tap_bank.val() == self.bank_rom.val() {
            self.host_taps.next = self.machine_count.val();
        }
        self.served_rom.d.next = self.tap_bank.val() == self.bank_rom.val();
        self.served_tap.d.next =
            (self.tap_bank.val() != self.bank_none.val()) & (self.index.val() < self.host_taps.val());

        comment!("Swap: only to a table whose sum is one");
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

        comment!("Longest delay of a swap's tables");
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

        comment!("Refusals; setting wins over clearing");
        if self.clear_flags.val() {
            self.refused_q.d.next = false;
        }
        if (self.tap_write.val() & !self.write_taken.val()) | (self.swap.val() & !self.swap_taken.val()) {
            self.refused_q.d.next = true;
        }

        comment!("Read: the active table, or the old one");
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
        self.read_tap.next = self.tap.val();
        comment!("The host reads at the address of a write");
        if self.serves.val() {
            self.read_address.next = self.write_address.val();
            self.read_tap.next = self.tap_index.val();
        }
        self.machine_taps.address.next = self.read_tap.val();
        self.old_q.d.next = self.old.val();
        self.word_bank.next = self.active.q.val();
        if self.old_q.q.val() {
            self.word_bank.next = self.previous.q.val();
        }
        self.from_rom.next = self.word_bank.val() == self.bank_rom.val();
        if self.served.q.val() {
            self.from_rom.next = self.served_rom.q.val();
        }
        self.read_word.next = self.loaded_taps.read_data.val();
        if self.from_rom.val() {
            self.read_word.next = self.machine_taps.data.val();
        }
        self.word.d.next = self.read_word.val();
        if self.served.q.val() {
            self.read_back.d.next = self.no_word.val();
            if self.served_tap.q.val() {
                self.read_back.d.next = self.read_word.val();
            }
        }
        self.coefficient.next = signed_cast(self.word.q.val().get_bits::<18>(0));
        self.delay.next = self.word.q.val().get_bits::<A>(18);

        comment!("Outputs");
        self.accepted.next = self.swap_taken.val();
        self.reach.next = self.reach_q.q.val();
        self.swap_pending.next = self.pending.q.val();
        self.bank.next = self.active.q.val();
        self.refused.next = self.refused_q.q.val();
        self.loaded_coefficient.next = signed_cast(self.read_back.q.val().get_bits::<18>(0));
        self.loaded_delay.next = self.read_back.q.val().get_bits::<A>(18);
        self.tap_read_waits.next = self.read_waits.q.val();
    }
}
