//! Computes a sample of a motion shaper: over all channels, and in a handover over both tables.
//!
//! ```text
//! for channel in 0 .. C                          one multiplier, one product per clock
//!     in a handover: taps of the old table
//!     taps of the active table
//!     in a handover, channel 0: −2^F · x[n0]
//! ```
//!
//! A product passes the same stages as in [`super::kernel`]; between the table and the ring buffers is
//! [`super::handover`]. `since` is m; a tap of the old table applies to the increments with delay d ≥ m, one of the
//! new table to those with d < m. Any other tap uses `x[n − m]` for the position, and counts as zero for velocity and
//! acceleration.
//!
//! After a channel there is one clock without a tap: when it reaches the accumulator, one sum is taken and the next
//! begins. `lasts` carries a mark with it from stage to stage; the mark of the strobe comes before the first channel.
//!
//! With N products `y` comes N + C + 9 clocks after the strobe. In addition to the plain shaper there are one clock
//! for the handover, one from the ring buffers to the multiplier, and one between two channels.

use super::channel_sums::ChannelSums;
use super::handover::Handover;
use super::history::History;
use super::tap_banks::TapBanks;
use crate::prelude::*;
use posicast_blocks::shaper::ShaperConfig;

kernel! {
    /// Sizes: W word bits, P = W + 18 product bits, ACC = P + T + 1 accumulator bits, A ring address bits, T index
    /// bits, COUNT = T + 1, SUM = 18 + T and WORD = 18 + A bits, C channels, H = C − 1.
    ///
    /// A shaper for `config`, whose sizes must not exceed these; if its position wraps, its word must have W bits.
    pub(super) struct MotionShaper<const W: usize, const P: usize, const ACC: usize, const A: usize, const T: usize,
        const COUNT: usize, const SUM: usize, const WORD: usize, const C: usize, const H: usize>
        (config: &ShaperConfig)
        where P == W + 18 && ACC == P + T + 1 && C <= 3 && H + 1 == C;
    ports posicast_blocks::motion_shaper_ports;

    parts {
        banks: TapBanks<A, T, COUNT, SUM, WORD> = TapBanks::new(config),
        handover: Handover<W, A> = Handover::new(config),
        history: History<W, A, C> = History::new(config),
        sums: ChannelSums<W, P, ACC, C, H> = ChannelSums::new(config),
    }
    registers {
        tap: Bits<T>, running: Bit, channel: Bits<2>, second: Bit, correcting: Bit, lasts: Bits<9>,
        sample_channel: Bits<2>, overrun_q: Bit,
    }
    wires {
        tap_number: Bits<COUNT>, old: Bit, of_position: Bit, table_ends: Bit, ends: Bit, begin_lasts: Bits<9>,
    }
    constants {
        first_tap: Bits<T> = from_u64(0),
        one_tap: Bits<T> = from_u64(1),
        one_more: Bits<COUNT> = from_u64(1),
        first_channel: Bits<2> = from_u64(0),
        one_channel: Bits<2> = from_u64(1),
        last_channel: Bits<2> = from_u64(C as u64 - 1),
        no_channel: Bits<2> = from_u64(3),
        no_stage: Bits<9> = from_u64(0),
        first_stage: Bits<9> = from_u64(1),
        second_stage: Bits<9> = from_u64(2),
        unknown_how: Bits<2> = from_u64(3),
    }
    connect {
        banks: strobe, clear_flags, tap_write, tap_bank, tap_index, tap_coefficient, tap_delay, tap_read, swap,
            swap_bank, old;
        banks from sums: busy;
        banks from handover: take;
        handover: strobe, start, swap_how, old, of_position;
        handover from banks: accepted, swap_pending, reach;
        history: strobe, start;
        history from handover: delay;
        sums from handover: coefficient, newest;
        sums from history: blank;
        sums: start, clear_flags;
        outputs from banks: bank, refused, loaded_coefficient, loaded_delay, tap_read_waits;
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
    const C: usize,
    const H: usize,
> Logic for MotionShaper<W, P, ACC, A, T, COUNT, SUM, WORD, C, H>
{
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module shaper");

        comment!("Tables: the word of tap comes two clocks later");
        self.of_position.next = self.channel.q.val() == self.first_channel.val();
        self.old.next = self.handover.active.val() & !self.second.q.val();
        self.banks.known.next = self.swap_how.val() != self.unknown_how.val();
        self.banks.locked.next = self.handover.active.val();
        self.banks.tap.next = self.tap.q.val();

        comment!("Time at which a swap takes effect");
        self.handover.position.next = self.x[0].val();

        comment!("Tap during a handover");
        self.handover.correcting.next = self.correcting.q.val();
        self.handover.tap_coefficient.next = self.banks.coefficient.val();
        self.handover.tap_delay.next = self.banks.delay.val();

        comment!("Samples: those at delay come a clock later");
        for i in 0..C {
            self.history.x[i].next = self.x[i].val();
            self.sums.sample[i].next = self.history.sample[i].val();
            self.sums.x[i].next = self.x[i].val();
        }

        comment!("Sums: one ends and the next begins");
        self.sums.begin_pass.next = self.strobe.val();
        self.sums.sample_channel.next = self.sample_channel.q.val();
        self.sums.boundary.next = self.lasts.q.val().get_bit(8);

        comment!("One product per clock, and a gap after a channel");
        self.tap_number.next = bit_cast::<COUNT, T>(self.tap.q.val()) + self.one_more.val();
        self.table_ends.next = self.tap_number.val() == self.banks.taps.val();
        self.ends.next = false;
        self.lasts.d.next = self.lasts.q.val() << 1;
        if self.running.q.val() & !self.lasts.q.val().get_bit(0) {
            self.tap.d.next = self.tap.q.val() + self.one_tap.val();
            if self.correcting.q.val() {
                self.ends.next = true;
            } else if self.table_ends.val() {
                if self.old.val() {
                    self.second.d.next = true;
                    self.tap.d.next = self.first_tap.val();
                } else if self.handover.active.val() & self.of_position.val() {
                    self.correcting.d.next = true;
                } else {
                    self.ends.next = true;
                }
            }
        }
        if self.ends.val() {
            self.lasts.d.next = (self.lasts.q.val() << 1) | self.first_stage.val();
            self.tap.d.next = self.first_tap.val();
            self.second.d.next = false;
            self.correcting.d.next = false;
            self.channel.d.next = self.channel.q.val() + self.one_channel.val();
            if self.channel.q.val() == self.last_channel.val() {
                self.running.d.next = false;
            }
        }
        if self.lasts.q.val().get_bit(4) {
            self.sample_channel.d.next = self.sample_channel.q.val() + self.one_channel.val();
        }

        comment!("A start or a strobe abandons a running pass");
        self.begin_lasts.next = self.no_stage.val();
        if self.strobe.val() {
            self.begin_lasts.next = self.second_stage.val();
        }
        if self.start.val() | self.strobe.val() {
            self.running.d.next = self.strobe.val();
            self.tap.d.next = self.first_tap.val();
            self.channel.d.next = self.first_channel.val();
            self.sample_channel.d.next = self.no_channel.val();
            self.second.d.next = false;
            self.correcting.d.next = false;
            self.lasts.d.next = self.begin_lasts.val();
        }
        if self.clear_flags.val() {
            self.overrun_q.d.next = false;
        }
        if self.strobe.val() & self.sums.busy.val() & !self.start.val() {
            self.overrun_q.d.next = true;
        }

        comment!("Outputs");
        for i in 0..C {
            self.y[i].next = self.sums.y[i].val();
        }
        self.valid.next = self.sums.valid.val();
        self.saturated.next = self.sums.saturated.val();
        self.busy.next = self.sums.busy.val();
        self.overrun.next = self.overrun_q.q.val();
        self.swap_pending.next = self.banks.swap_pending.val() | self.handover.active.val();
    }
}
