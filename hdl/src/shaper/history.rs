//! The samples since the last start, and the start value for all before.
//!
//! A ring of 2^A words in block RAM, the newest at `head`. What `delay` asks for stands at `sample` one clock later:
//! `delay < age ? ring[head − delay] : start value`. So no word is used that was not written since the start.
//!
//! `delay` is at most 2^A − 2: the word read is never the one that a strobe writes.

use crate::prelude::*;

/// W word, A ring address bits.
#[derive(LogicBlock)]
pub(super) struct History<const W: usize, const A: usize> {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) strobe: Signal<In, Bit>,
    pub(super) start: Signal<In, Bit>,
    pub(super) x: Signal<In, Signed<W>>,
    pub(super) delay: Signal<In, Bits<A>>,
    pub(super) sample: Signal<Out, Signed<W>>,

    ring: Ram<W, A>,

    head: Dff<Bits<A>>,
    age: Dff<Bits<A>>,
    start_value: Dff<Signed<W>>,
    before_start: Dff<Bit>,

    next_head: Signal<Local, Bits<A>>,
    age_before: Signal<Local, Bits<A>>,

    one_sample: Constant<Bits<A>>,
    no_age: Constant<Bits<A>>,
    full_age: Constant<Bits<A>>,
}

impl<const W: usize, const A: usize> Default for History<W, A> {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            strobe: Signal::default(),
            start: Signal::default(),
            x: Signal::default(),
            delay: Signal::default(),
            sample: Signal::default(),
            ring: Ram::default(),
            head: Dff::default(),
            age: Dff::default(),
            start_value: Dff::default(),
            before_start: Dff::default(),
            next_head: Signal::default(),
            age_before: Signal::default(),
            one_sample: Constant::new(from_u64(1)),
            no_age: Constant::new(from_u64(0)),
            full_age: Constant::new(from_u64(u64::MAX)),
        }
    }
}

impl<const W: usize, const A: usize> Logic for History<W, A> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module history");
        comment!("@about The samples since the last start, in a");
        comment!("@about ring, and for all before, its value.");
        comment!("@about sample: that of delay one clock before.");
        dff_setup!(self, clk, head, age, start_value, before_start);
        self.ring.clk.next = self.clk.val();

        comment!("A start forgets, then a strobe adds x");
        self.age_before.next = self.age.q.val();
        if self.start.val() {
            self.start_value.d.next = self.x.val();
            self.age_before.next = self.no_age.val();
            self.age.d.next = self.no_age.val();
        }
        self.next_head.next = self.head.q.val() + self.one_sample.val();
        if self.strobe.val() {
            self.head.d.next = self.next_head.val();
            if self.age_before.val() != self.full_age.val() {
                self.age.d.next = self.age_before.val() + self.one_sample.val();
            }
        }
        self.ring.write_enable.next = self.strobe.val();
        self.ring.write_address.next = self.next_head.val();
        self.ring.write_data.next = unsigned_cast(self.x.val());

        comment!("The sample that lies delay samples back");
        self.ring.read_address.next = self.head.q.val() - self.delay.val();
        self.before_start.d.next = self.delay.val() >= self.age.q.val();
        self.sample.next = signed_cast(self.ring.read_data.val());
        if self.before_start.q.val() {
            self.sample.next = self.start_value.q.val();
        }
    }
}
