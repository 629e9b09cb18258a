//! The pass over the taps, one per clock.
//!
//! ```text
//! tap ─► tap_banks ─► delay ─────► history ─► sample ──────► weighted_sum ─────────────────► y
//!                  └► coefficient ──────────────────────────►
//! running   stages[0] stages[1]              stages[2]     stages[3] to [5] done         valid
//! ```
//!
//! A tap is in each place for one clock. So of N taps the last product is added in clock N + 6 after the strobe, `done`
//! shows in clock N + 7, and `y` in clock N + 8.

use super::history::History;
use super::tap_banks::TapBanks;
use super::weighted_sum::WeightedSum;
use crate::prelude::*;
use crate::simulation::Pins;
use posicast_model::rtl::shaper::ShaperConfig;

/// W word, P = W + 18 product, ACC = P + T accumulator, A ring address, T index, COUNT = T + 1, SUM = 18 + T and
/// WORD = 18 + A bits; U of [`super::product`].
#[derive(LogicBlock)]
pub(super) struct Shaper<
    const W: usize,
    const P: usize,
    const ACC: usize,
    const A: usize,
    const T: usize,
    const COUNT: usize,
    const SUM: usize,
    const WORD: usize,
    const U: usize,
> {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) strobe: Signal<In, Bit>,
    pub(super) start: Signal<In, Bit>,
    pub(super) x: Signal<In, Signed<W>>,
    pub(super) clear_flags: Signal<In, Bit>,
    pub(super) tap_write: Signal<In, Bit>,
    pub(super) tap_bank: Signal<In, Bits<2>>,
    pub(super) tap_index: Signal<In, Bits<T>>,
    pub(super) tap_coefficient: Signal<In, Signed<18>>,
    pub(super) tap_delay: Signal<In, Bits<A>>,
    pub(super) swap: Signal<In, Bit>,
    pub(super) swap_bank: Signal<In, Bits<2>>,
    pub(super) y: Signal<Out, Signed<W>>,
    pub(super) valid: Signal<Out, Bit>,
    pub(super) saturated: Signal<Out, Bit>,
    pub(super) busy: Signal<Out, Bit>,
    pub(super) overrun: Signal<Out, Bit>,
    pub(super) swap_pending: Signal<Out, Bit>,
    pub(super) bank: Signal<Out, Bits<2>>,
    pub(super) refused: Signal<Out, Bit>,

    banks: TapBanks<A, T, COUNT, SUM, WORD>,
    history: History<W, A, 1>,
    sum: WeightedSum<W, P, ACC, U>,

    tap: Dff<Bits<T>>,
    running: Dff<Bit>,
    stages: Dff<Bits<6>>,
    done: Dff<Bit>,
    valid_q: Dff<Bit>,
    busy_q: Dff<Bit>,
    overrun_q: Dff<Bit>,

    tap_number: Signal<Local, Bits<COUNT>>,
    finish: Signal<Local, Bit>,

    first_tap: Constant<Bits<T>>,
    one_tap: Constant<Bits<T>>,
    one_more: Constant<Bits<COUNT>>,
    no_stage: Constant<Bits<6>>,
    first_stage: Constant<Bits<6>>,
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
> Shaper<W, P, ACC, A, T, COUNT, SUM, WORD, U>
{
    /// A shaper for `config`, whose sizes must not be above these.
    pub(super) fn new(config: &ShaperConfig) -> Self {
        const { assert!(P == W + 18 && ACC == P + T) };
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            strobe: Signal::default(),
            start: Signal::default(),
            x: Signal::default(),
            clear_flags: Signal::default(),
            tap_write: Signal::default(),
            tap_bank: Signal::default(),
            tap_index: Signal::default(),
            tap_coefficient: Signal::default(),
            tap_delay: Signal::default(),
            swap: Signal::default(),
            swap_bank: Signal::default(),
            y: Signal::default(),
            valid: Signal::default(),
            saturated: Signal::default(),
            busy: Signal::default(),
            overrun: Signal::default(),
            swap_pending: Signal::default(),
            bank: Signal::default(),
            refused: Signal::default(),
            banks: TapBanks::new(config),
            history: History::new(config),
            sum: WeightedSum::new(config),
            tap: Dff::default(),
            running: Dff::default(),
            stages: Dff::default(),
            done: Dff::default(),
            valid_q: Dff::default(),
            busy_q: Dff::default(),
            overrun_q: Dff::default(),
            tap_number: Signal::default(),
            finish: Signal::default(),
            first_tap: Constant::new(from_u64(0)),
            one_tap: Constant::new(from_u64(1)),
            one_more: Constant::new(from_u64(1)),
            no_stage: Constant::new(from_u64(0)),
            first_stage: Constant::new(from_u64(1)),
        }
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
        dff_setup!(self, clk, tap, running, stages, done, valid_q, busy_q, overrun_q);

        comment!("The tables: the word of tap, two clocks later");
        self.banks.clk.next = self.clk.val();
        self.banks.rst.next = self.rst.val();
        self.banks.strobe.next = self.strobe.val();
        self.banks.clear_flags.next = self.clear_flags.val();
        self.banks.tap_write.next = self.tap_write.val();
        self.banks.tap_bank.next = self.tap_bank.val();
        self.banks.tap_index.next = self.tap_index.val();
        self.banks.tap_coefficient.next = self.tap_coefficient.val();
        self.banks.tap_delay.next = self.tap_delay.val();
        self.banks.swap.next = self.swap.val();
        self.banks.swap_bank.next = self.swap_bank.val();
        self.banks.tap.next = self.tap.q.val();

        comment!("A swap has one way: all at the next strobe");
        self.banks.known.next = true;
        self.banks.take.next = true;
        self.banks.locked.next = false;
        self.banks.old.next = false;

        comment!("The samples: the one at delay, a clock later");
        self.history.clk.next = self.clk.val();
        self.history.rst.next = self.rst.val();
        self.history.strobe.next = self.strobe.val();
        self.history.start.next = self.start.val();
        self.history.x[0].next = self.x.val();
        self.history.delay.next = self.banks.delay.val();

        comment!("The sum: a pass that is cut off leaves y");
        self.finish.next = self.done.q.val() & !self.start.val() & !self.strobe.val();
        self.sum.clk.next = self.clk.val();
        self.sum.rst.next = self.rst.val();
        self.sum.begin_pass.next = self.strobe.val();
        self.sum.coefficient.next = self.banks.coefficient.val();
        self.sum.sample.next = self.history.sample[0].val();
        self.sum.blank.next = self.history.blank.val();
        self.sum.add.next = self.stages.q.val().get_bit(5);
        self.sum.finish.next = self.finish.val();
        self.sum.start.next = self.start.val();
        self.sum.x.next = self.x.val();
        self.sum.clear_flags.next = self.clear_flags.val();

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

        comment!("A start or a strobe cuts off what runs");
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
        self.swap_pending.next = self.banks.swap_pending.val();
        self.bank.next = self.banks.bank.val();
        self.refused.next = self.banks.refused.val();
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
> Pins for Shaper<W, P, ACC, A, T, COUNT, SUM, WORD, U>
{
    fn set_clk(&mut self, level: bool) {
        self.clk.next = level.into();
    }

    fn drive(&mut self, inputs: &[u64]) {
        let &[
            rst,
            strobe,
            start,
            x,
            clear_flags,
            tap_write,
            tap_bank,
            tap_index,
            tap_coefficient,
            tap_delay,
            swap,
            swap_bank,
        ] = inputs
        else {
            return;
        };
        self.rst.next = rst & 1 != 0;
        self.strobe.next = strobe & 1 != 0;
        self.start.next = start & 1 != 0;
        self.x.next = from_i64(x as i64);
        self.clear_flags.next = clear_flags & 1 != 0;
        self.tap_write.next = tap_write & 1 != 0;
        self.tap_bank.next = from_u64(tap_bank);
        self.tap_index.next = from_u64(tap_index);
        self.tap_coefficient.next = from_i64(tap_coefficient as i64);
        self.tap_delay.next = from_u64(tap_delay);
        self.swap.next = swap & 1 != 0;
        self.swap_bank.next = from_u64(swap_bank);
    }

    fn read(&self, outputs: &mut [u64]) {
        let shown = [
            unsigned_cast(self.y.val()).into(),
            u64::from(self.valid.val()),
            u64::from(self.saturated.val()),
            u64::from(self.busy.val()),
            u64::from(self.overrun.val()),
            u64::from(self.swap_pending.val()),
            self.bank.val().into(),
            u64::from(self.refused.val()),
        ];
        for (output, value) in outputs.iter_mut().zip(shown) {
            *output = value;
        }
    }
}
