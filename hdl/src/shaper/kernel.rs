//! The pass over the taps: ring, multiplier, accumulator, output.
//!
//! ```text
//! clock       1..N      +1          +2            +3, +4      +5            then      then
//!             tap ─► table word ─► ring word ─► multiplier ─► accumulator ─► done ─► y, valid
//!             running  stages[0]   stages[1]    [2]    [3]
//! ```

use super::tap_banks::TapBanks;
use crate::prelude::*;
use crate::simulation::Pins;
use posicast_model::rtl::shaper::ShaperConfig;

/// W word, P = W + 18 product, ACC = P + T accumulator, A ring address, T index, COUNT = T + 1, SUM = 18 + T and
/// WORD = 18 + A bits.
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
    ring: Ram<W, A>,
    multiplier: SMul<W, 18, P>,

    head: Dff<Bits<A>>,
    age: Dff<Bits<A>>,
    start_value: Dff<Signed<W>>,
    tap: Dff<Bits<T>>,
    running: Dff<Bit>,
    stages: Dff<Bits<4>>,
    done: Dff<Bit>,
    coefficient: Dff<Signed<18>>,
    before_start: Dff<Bit>,
    accumulator: Dff<Signed<ACC>>,
    y_q: Dff<Signed<W>>,
    valid_q: Dff<Bit>,
    saturated_q: Dff<Bit>,
    busy_q: Dff<Bit>,
    overrun_q: Dff<Bit>,

    next_head: Signal<Local, Bits<A>>,
    age_before: Signal<Local, Bits<A>>,
    tap_number: Signal<Local, Bits<COUNT>>,
    sample: Signal<Local, Signed<W>>,
    product: Signal<Local, Signed<ACC>>,

    one_sample: Constant<Bits<A>>,
    zero_age: Constant<Bits<A>>,
    full_age: Constant<Bits<A>>,
    first_tap: Constant<Bits<T>>,
    one_tap: Constant<Bits<T>>,
    one_more: Constant<Bits<COUNT>>,
    no_stage: Constant<Bits<4>>,
    first_stage: Constant<Bits<4>>,
    half: Constant<Signed<ACC>>,
    too_large: Constant<Signed<ACC>>,
    smallest: Constant<Signed<ACC>>,
    y_max: Constant<Signed<W>>,
    y_min: Constant<Signed<W>>,
    fraction: Constant<Bits<5>>,
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
> Shaper<W, P, ACC, A, T, COUNT, SUM, WORD>
{
    /// A shaper for `config`, whose sizes must be these.
    pub(super) fn new(config: &ShaperConfig) -> Self {
        const { assert!(P == W + 18 && ACC == P + T) };
        let fraction = config.coefficient_fraction();
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
            ring: Ram::default(),
            multiplier: SMul::default(),
            head: Dff::default(),
            age: Dff::default(),
            start_value: Dff::default(),
            tap: Dff::default(),
            running: Dff::default(),
            stages: Dff::default(),
            done: Dff::default(),
            coefficient: Dff::default(),
            before_start: Dff::default(),
            accumulator: Dff::default(),
            y_q: Dff::default(),
            valid_q: Dff::default(),
            saturated_q: Dff::default(),
            busy_q: Dff::default(),
            overrun_q: Dff::default(),
            next_head: Signal::default(),
            age_before: Signal::default(),
            tap_number: Signal::default(),
            sample: Signal::default(),
            product: Signal::default(),
            one_sample: Constant::new(from_u64(1)),
            zero_age: Constant::new(from_u64(0)),
            full_age: Constant::new(from_u64(u64::MAX)),
            first_tap: Constant::new(from_u64(0)),
            one_tap: Constant::new(from_u64(1)),
            one_more: Constant::new(from_u64(1)),
            no_stage: Constant::new(from_u64(0)),
            first_stage: Constant::new(from_u64(1)),
            half: Constant::new(from_i64(1 << (fraction - 1))),
            too_large: Constant::new(from_i64((config.word_max() + 1) << fraction)),
            smallest: Constant::new(from_i64(config.word_min() << fraction)),
            y_max: Constant::new(from_i64(config.word_max())),
            y_min: Constant::new(from_i64(config.word_min())),
            fraction: Constant::new(from_u64(u64::from(fraction))),
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
> Logic for Shaper<W, P, ACC, A, T, COUNT, SUM, WORD>
{
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module shaper");
        dff_setup!(
            self,
            clk,
            head,
            age,
            start_value,
            tap,
            running,
            stages,
            done,
            coefficient,
            before_start,
            accumulator,
            y_q,
            valid_q,
            saturated_q,
            busy_q,
            overrun_q
        );
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
        self.ring.clk.next = self.clk.val();
        self.multiplier.clk.next = self.clk.val();

        comment!("One tap per clock, to the last of the table");
        self.stages.d.next = self.stages.q.val() << 1;
        self.tap_number.next = bit_cast::<COUNT, T>(self.tap.q.val()) + self.one_more.val();
        if self.running.q.val() {
            self.stages.d.next = (self.stages.q.val() << 1) | self.first_stage.val();
            if self.tap_number.val() == self.banks.taps.val() {
                self.running.d.next = false;
            } else {
                self.tap.d.next = self.tap.q.val() + self.one_tap.val();
            }
        }

        comment!("Ring: the newest sample is at head");
        self.next_head.next = self.head.q.val() + self.one_sample.val();
        self.ring.write_enable.next = self.strobe.val();
        self.ring.write_address.next = self.next_head.val();
        self.ring.write_data.next = unsigned_cast(self.x.val());
        self.ring.read_address.next = self.head.q.val() - self.banks.delay.val();
        self.before_start.d.next = self.banks.delay.val() >= self.age.q.val();
        self.coefficient.d.next = self.banks.coefficient.val();

        comment!("Multiply and accumulate, exactly");
        self.sample.next = signed_cast(self.ring.read_data.val());
        if self.before_start.q.val() {
            self.sample.next = self.start_value.q.val();
        }
        self.multiplier.a.next = self.sample.val();
        self.multiplier.b.next = self.coefficient.q.val();
        self.product.next = signed_bit_cast::<ACC, P>(self.multiplier.product.val());
        if self.stages.q.val().get_bit(3) {
            self.accumulator.d.next = self.accumulator.q.val() + self.product.val();
        }
        self.done.d.next = self.stages.q.val().get_bit(3) & !self.stages.q.val().get_bit(2);

        if self.clear_flags.val() {
            self.saturated_q.d.next = false;
            self.overrun_q.d.next = false;
        }

        comment!("Half was added at the start: shift, saturate");
        self.valid_q.d.next = false;
        if self.done.q.val() & !self.start.val() & !self.strobe.val() {
            self.busy_q.d.next = false;
            self.valid_q.d.next = true;
            self.y_q.d.next = self.accumulator.q.val().get_bits::<W>(self.fraction.val().index());
            if self.accumulator.q.val() >= self.too_large.val() {
                self.y_q.d.next = self.y_max.val();
                self.saturated_q.d.next = true;
            }
            if self.accumulator.q.val() < self.smallest.val() {
                self.y_q.d.next = self.y_min.val();
                self.saturated_q.d.next = true;
            }
        }

        comment!("Start: history is x, the output too");
        self.age_before.next = self.age.q.val();
        if self.start.val() {
            self.age_before.next = self.zero_age.val();
            self.age.d.next = self.zero_age.val();
            self.start_value.d.next = self.x.val();
            self.y_q.d.next = self.x.val();
            self.busy_q.d.next = false;
            self.running.d.next = false;
            self.stages.d.next = self.no_stage.val();
            self.done.d.next = false;
        }

        comment!("Strobe: a sample, and a pass from the first tap");
        if self.strobe.val() {
            self.head.d.next = self.next_head.val();
            if self.age_before.val() != self.full_age.val() {
                self.age.d.next = self.age_before.val() + self.one_sample.val();
            }
            if self.busy_q.q.val() & !self.start.val() {
                self.overrun_q.d.next = true;
            }
            self.busy_q.d.next = true;
            self.tap.d.next = self.first_tap.val();
            self.running.d.next = true;
            self.stages.d.next = self.no_stage.val();
            self.done.d.next = false;
            self.accumulator.d.next = self.half.val();
        }

        self.y.next = self.y_q.q.val();
        self.valid.next = self.valid_q.q.val();
        self.saturated.next = self.saturated_q.q.val();
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
> Pins for Shaper<W, P, ACC, A, T, COUNT, SUM, WORD>
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
