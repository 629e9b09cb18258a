//! Computes a sample over the taps, one tap per clock.
//!
//! ```text
//! tap ─► tap_banks ─► delay ─────► history ─► sample ──────► weighted_sum ─────────────────► y
//!                  └► coefficient ──────────────────────────►
//! running   stages[0] stages[1]              stages[2]     stages[3] to [5] done         valid
//! ```
//!
//! A tap is in each stage of the pipeline for one clock. With N taps the last product is added in clock N + 6 after
//! the strobe, `done` shows in clock N + 7, and `y` in clock N + 8.

use super::history::History;
use super::tap_banks::TapBanks;
use super::weighted_sum::WeightedSum;
use crate::prelude::*;
use posicast_blocks::shaper::ShaperConfig;

kernel! {
    /// Sizes: W word bits, P = W + 18 product bits, ACC = P + T accumulator bits, A ring address bits, T index bits,
    /// COUNT = T + 1, SUM = 18 + T and WORD = 18 + A bits; U as in [`super::product`].
    ///
    /// A shaper for `config`, whose sizes must not exceed these.
    pub(super) struct Shaper<const W: usize, const P: usize, const ACC: usize, const A: usize, const T: usize,
        const COUNT: usize, const SUM: usize, const WORD: usize, const U: usize>
        (config: &ShaperConfig)
        where P == W + 18 && ACC == P + T;
    ports posicast_blocks::shaper_ports;

    parts {
        banks: TapBanks<A, T, COUNT, SUM, WORD> = TapBanks::new(config),
        history: History<W, A, 1> = History::new(config),
        sum: WeightedSum<W, P, ACC, U> = WeightedSum::new(config),
    }
    registers { tap: Bits<T>, running: Bit, stages: Bits<6>, done: Bit, valid_q: Bit, busy_q: Bit, overrun_q: Bit }
    wires { tap_number: Bits<COUNT>, finish: Bit }
    constants {
        first_tap: Bits<T> = from_u64(0),
        one_tap: Bits<T> = from_u64(1),
        one_more: Bits<COUNT> = from_u64(1),
        no_stage: Bits<6> = from_u64(0),
        first_stage: Bits<6> = from_u64(1),
    }
    connect {
        banks: strobe, clear_flags, tap_write, tap_bank, tap_index, tap_coefficient, tap_delay, tap_read, swap,
            swap_bank;
        history: strobe, start;
        history from banks: delay;
        sum from banks: coefficient;
        sum from history: blank;
        sum: finish, start, x, clear_flags;
        outputs from banks: swap_pending, bank, refused, loaded_coefficient, loaded_delay, tap_read_waits;
    }
}

impl<
    const W: usize,
    const P: usize,
    const ACC: usize,
    const A: usize,
    const T: usize,
    const COUNT: usize,
    const SUM: usize,
    const WORD: usize,
    const U: usize,
> Logic for Shaper<W, P, ACC, A, T, COUNT, SUM, WORD, U>
{
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module shaper");

        comment!("Tables: the word of tap comes two clocks later");
        self.banks.busy.next = self.busy_q.q.val();
        self.banks.tap.next = self.tap.q.val();

        comment!("A swap takes effect at the next strobe");
        self.banks.known.next = true;
        self.banks.take.next = true;
        self.banks.locked.next = false;
        self.banks.old.next = false;

        comment!("Samples: the one at delay comes a clock later");
        self.history.x[0].next = self.x.val();

        comment!("Sum: an abandoned pass leaves y unchanged");
        self.finish.next = self.done.q.val() & !self.start.val() & !self.strobe.val();
        self.sum.begin_pass.next = self.strobe.val();
        self.sum.sample.next = self.history.sample[0].val();
        self.sum.add.next = self.stages.q.val().get_bit(5);

        comment!("One tap per clock, up to the last of the table");
        self.tap_number.next = bit_cast::<COUNT, T>(self.tap.q.val()) + self.one_more.val();
        self.stages.d.next = self.stages.q.val() << 1;
        if self.running.q.val() {
            self.stages.d.next = (self.stages.q.val() << 1) | self.first_stage.val();
            if self.tap_number.val() == self.banks.taps.val() {
                self.running.d.next = false;
            } else {
                self.tap.d.next = self.tap.q.val() + self.one_tap.val();
            }
        }
        self.done.d.next = self.stages.q.val().get_bit(5) & !self.stages.q.val().get_bit(4);
        self.valid_q.d.next = self.finish.val();
        if self.finish.val() {
            self.busy_q.d.next = false;
        }

        comment!("A start or a strobe abandons a running pass");
        if self.start.val() | self.strobe.val() {
            self.running.d.next = false;
            self.stages.d.next = self.no_stage.val();
            self.done.d.next = false;
            self.busy_q.d.next = false;
        }
        if self.clear_flags.val() {
            self.overrun_q.d.next = false;
        }
        if self.strobe.val() {
            self.running.d.next = true;
            self.tap.d.next = self.first_tap.val();
            self.busy_q.d.next = true;
            if self.busy_q.q.val() & !self.start.val() {
                self.overrun_q.d.next = true;
            }
        }

        comment!("Outputs");
        self.y.next = self.sum.y.val();
        self.valid.next = self.valid_q.q.val();
        self.saturated.next = self.sum.saturated.val();
        self.busy.next = self.busy_q.q.val();
        self.overrun.next = self.overrun_q.q.val();
    }
}
