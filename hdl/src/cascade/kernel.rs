//! The pass over the stages, two clocks each: one reads and writes the ring, one adds.
//!
//! ```text
//! clock      0 (strobe)   2k + 1              2k + 2                 2n + 1         2n + 2
//! sum                     y_k                 y_k                    y_n
//! delays     of stage 0   of stage k          of stage k + 1
//! ring                    write y_k, read     y_k[n − d], add        y := rounded   valid
//! ```
//!
//! One RAM holds the rings of all stages, which share `head` and `age`: a word's address is `{stage, head}`. `age` counts
//! the samples since the start, so no word is used that was not written since; before it, a stage has seen its constant
//! input `earlier`, the start value doubled from stage to stage.
//!
//! A delay is 1 to 2^A − 2: the word read is never the one that is written in the same clock.

use crate::prelude::*;
use crate::simulation::Pins;
use posicast_model::rtl::cascade::CascadeConfig;

/// W word, S sum of W + one bit per stage, A ring address, I stage index and ADDRESS = A + I bits.
#[derive(LogicBlock)]
pub(super) struct Cascade<const W: usize, const S: usize, const A: usize, const I: usize, const ADDRESS: usize> {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) strobe: Signal<In, Bit>,
    pub(super) start: Signal<In, Bit>,
    pub(super) x: Signal<In, Signed<W>>,
    pub(super) clear_flags: Signal<In, Bit>,
    pub(super) y: Signal<Out, Signed<W>>,
    pub(super) valid: Signal<Out, Bit>,
    pub(super) busy: Signal<Out, Bit>,
    pub(super) overrun: Signal<Out, Bit>,

    delays: Rom<A, I>,
    rings: Ram<S, ADDRESS>,

    head: Dff<Bits<A>>,
    age: Dff<Bits<A>>,
    start_value: Dff<Signed<W>>,
    stage: Dff<Bits<I>>,
    sum: Dff<Signed<S>>,
    earlier: Dff<Signed<S>>,
    before_start: Dff<Bit>,
    running: Dff<Bit>,
    adding: Dff<Bit>,
    finish: Dff<Bit>,
    y_q: Dff<Signed<W>>,
    valid_q: Dff<Bit>,
    busy_q: Dff<Bit>,
    overrun_q: Dff<Bit>,

    take: Signal<Local, Bit>,
    age_before: Signal<Local, Bits<A>>,
    next_head: Signal<Local, Bits<A>>,
    next_stage: Signal<Local, Bits<I>>,
    back: Signal<Local, Bits<A>>,
    base: Signal<Local, Bits<ADDRESS>>,
    delayed: Signal<Local, Signed<S>>,
    rounded: Signal<Local, Signed<S>>,

    one_sample: Constant<Bits<A>>,
    no_age: Constant<Bits<A>>,
    full_age: Constant<Bits<A>>,
    first_stage: Constant<Bits<I>>,
    one_stage: Constant<Bits<I>>,
    last_stage: Constant<Bits<I>>,
    ring_bits: Constant<Bits<4>>,
    half: Constant<Signed<S>>,
    stages: Constant<Bits<5>>,
}

impl<const W: usize, const S: usize, const A: usize, const I: usize, const ADDRESS: usize>
    Cascade<W, S, A, I, ADDRESS>
{
    /// A cascade for `config`, whose sizes must not be above these.
    pub(super) fn new(config: &CascadeConfig) -> Self {
        const { assert!(S > W && ADDRESS == A + I) };
        let stages = u64::from(config.stages());
        let word = |&delay: &u32| RomWord {
            pattern: u64::from(delay),
            meaning: format!("{delay} samples"),
        };
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            strobe: Signal::default(),
            start: Signal::default(),
            x: Signal::default(),
            clear_flags: Signal::default(),
            y: Signal::default(),
            valid: Signal::default(),
            busy: Signal::default(),
            overrun: Signal::default(),
            delays: Rom::new("stage_delays", config.delays_samples().iter().map(word).collect()),
            rings: Ram::default(),
            head: Dff::default(),
            age: Dff::default(),
            start_value: Dff::default(),
            stage: Dff::default(),
            sum: Dff::default(),
            earlier: Dff::default(),
            before_start: Dff::default(),
            running: Dff::default(),
            adding: Dff::default(),
            finish: Dff::default(),
            y_q: Dff::default(),
            valid_q: Dff::default(),
            busy_q: Dff::default(),
            overrun_q: Dff::default(),
            take: Signal::default(),
            age_before: Signal::default(),
            next_head: Signal::default(),
            next_stage: Signal::default(),
            back: Signal::default(),
            base: Signal::default(),
            delayed: Signal::default(),
            rounded: Signal::default(),
            one_sample: Constant::new(from_u64(1)),
            no_age: Constant::new(from_u64(0)),
            full_age: Constant::new(from_u64((1 << config.ring_address_bits()) - 1)),
            first_stage: Constant::new(from_u64(0)),
            one_stage: Constant::new(from_u64(1)),
            last_stage: Constant::new(from_u64(stages - 1)),
            ring_bits: Constant::new(from_u64(A as u64)),
            half: Constant::new(from_i64(1 << (stages - 1))),
            stages: Constant::new(from_u64(stages)),
        }
    }
}

impl<const W: usize, const S: usize, const A: usize, const I: usize, const ADDRESS: usize> Logic
    for Cascade<W, S, A, I, ADDRESS>
{
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module cascade");
        dff_setup!(
            self,
            clk,
            head,
            age,
            start_value,
            stage,
            sum,
            earlier,
            before_start,
            running,
            adding,
            finish,
            y_q,
            valid_q,
            busy_q,
            overrun_q
        );
        self.delays.clk.next = self.clk.val();
        self.rings.clk.next = self.clk.val();
        self.next_stage.next = self.stage.q.val();
        self.valid_q.d.next = false;
        self.finish.d.next = false;
        if self.clear_flags.val() {
            self.overrun_q.d.next = false;
        }

        comment!("One clock to read and write, one to add");
        self.delayed.next = signed_cast(self.rings.read_data.val());
        if self.before_start.q.val() {
            self.delayed.next = self.earlier.q.val();
        }
        if self.running.q.val() {
            self.adding.d.next = !self.adding.q.val();
            if self.adding.q.val() {
                self.sum.d.next = self.sum.q.val() + self.delayed.val();
                self.earlier.d.next = self.earlier.q.val() + self.earlier.q.val();
                self.next_stage.next = self.stage.q.val() + self.one_stage.val();
                if self.stage.q.val() == self.last_stage.val() {
                    self.running.d.next = false;
                    self.finish.d.next = true;
                }
            }
        }

        comment!("Halves round up, N bits are dropped");
        self.rounded.next = self.sum.q.val() + self.half.val();
        if self.finish.q.val() {
            self.y_q.d.next = self.rounded.val().get_bits::<W>(self.stages.val().index());
            self.valid_q.d.next = true;
            self.busy_q.d.next = false;
        }

        comment!("A start forgets, and cuts off what runs");
        self.age_before.next = self.age.q.val();
        if self.start.val() {
            self.start_value.d.next = self.x.val();
            self.y_q.d.next = self.x.val();
            self.age_before.next = self.no_age.val();
            self.age.d.next = self.no_age.val();
            self.running.d.next = false;
            self.finish.d.next = false;
            self.valid_q.d.next = false;
            self.busy_q.d.next = false;
        }

        comment!("A sample, unless a pass runs");
        self.take.next = self.strobe.val() & (self.start.val() | !self.busy_q.q.val());
        self.next_head.next = self.head.q.val() + self.one_sample.val();
        if self.take.val() {
            self.head.d.next = self.next_head.val();
            if self.age_before.val() != self.full_age.val() {
                self.age.d.next = self.age_before.val() + self.one_sample.val();
            }
            self.sum.d.next = signed_bit_cast::<S, W>(self.x.val());
            self.earlier.d.next = signed_bit_cast::<S, W>(self.start_value.q.val());
            if self.start.val() {
                self.earlier.d.next = signed_bit_cast::<S, W>(self.x.val());
            }
            self.next_stage.next = self.first_stage.val();
            self.running.d.next = true;
            self.adding.d.next = false;
            self.busy_q.d.next = true;
        }
        if self.strobe.val() & !self.take.val() {
            self.overrun_q.d.next = true;
        }

        comment!("The ring of the stage, and its delay");
        self.stage.d.next = self.next_stage.val();
        self.delays.address.next = self.next_stage.val();
        self.back.next = self.head.q.val() - self.delays.data.val();
        self.base.next = bit_cast::<ADDRESS, I>(self.stage.q.val()) << self.ring_bits.val();
        self.rings.read_address.next = self.base.val() | bit_cast::<ADDRESS, A>(self.back.val());
        self.rings.write_address.next = self.base.val() | bit_cast::<ADDRESS, A>(self.head.q.val());
        self.rings.write_enable.next = self.running.q.val() & !self.adding.q.val();
        self.rings.write_data.next = unsigned_cast(self.sum.q.val());
        self.before_start.d.next = self.delays.data.val() >= self.age.q.val();

        comment!("Outputs");
        self.y.next = self.y_q.q.val();
        self.valid.next = self.valid_q.q.val();
        self.busy.next = self.busy_q.q.val();
        self.overrun.next = self.overrun_q.q.val();
    }
}

impl<const W: usize, const S: usize, const A: usize, const I: usize, const ADDRESS: usize> Pins
    for Cascade<W, S, A, I, ADDRESS>
{
    fn set_clk(&mut self, level: bool) {
        self.clk.next = level.into();
    }

    fn drive(&mut self, inputs: &[u64]) {
        let &[rst, strobe, start, x, clear_flags] = inputs else {
            return;
        };
        self.rst.next = rst & 1 != 0;
        self.strobe.next = strobe & 1 != 0;
        self.start.next = start & 1 != 0;
        self.x.next = from_i64(x as i64);
        self.clear_flags.next = clear_flags & 1 != 0;
    }

    fn read(&self, outputs: &mut [u64]) {
        let shown = [
            unsigned_cast(self.y.val()).into(),
            u64::from(self.valid.val()),
            u64::from(self.busy.val()),
            u64::from(self.overrun.val()),
        ];
        for (output, value) in outputs.iter_mut().zip(shown) {
            *output = value;
        }
    }
}
