//! The samples since the last start, and before them its words: C rings that go together.
//!
//! A ring of 2^A words in block RAM per channel, the newest word at `head`. A strobe writes `x` behind it, a start as well,
//! and from then on `age` counts the strobes, so that the start's word lies that many words back. What `delay` asks for stands
//! at `sample` one clock later: `ring[head − min(delay, age)]`, and so, of all before the start, the start's own word. Where that
//! lies is kept in `origin`, so that difference and comparison go side by side.
//!
//! After a reset `age` counts from the first strobe. What lies before that is 0, which no ring holds: `blank` tells of it, a
//! clock before its sample. So no word is used that was not written since the reset.
//!
//! `delay` is at most 2^A − 2: the word read is never the one that is written.

use crate::prelude::*;
use posicast_model::rtl::shaper::ShaperConfig;

kernel! {
    /// W word, A ring address bits, C channels.
    pub(super) struct History<const W: usize, const A: usize, const C: usize>(config: &ShaperConfig);

    inputs { rst: Bit, strobe: Bit, start: Bit, x[C]: Signed<W>, delay: Bits<A> }
    outputs { sample[C]: Signed<W>, blank: Bit }
    parts { ring[C]: Ram<W, A> }
    registers { head: Bits<A>, age: Bits<A>, origin: Bits<A>, begun: Bit, started: Bit }
    wires { writes: Bit, next_head: Bits<A>, before_start: Bit, address: Bits<A> }
    constants {
        one_sample: Bits<A> = from_u64(1),
        no_age: Bits<A> = from_u64(0),
        full_age: Bits<A> = from_u64(u64::from(config.longest_delay_samples()) + 1),
    }
}

impl<const W: usize, const A: usize, const C: usize> Logic for History<W, A, C> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module history_${width x$0}x${words delay}x${count x}");

        comment!("A strobe adds x; a start too, and forgets");
        self.writes.next = self.strobe.val() | self.start.val();
        self.next_head.next = self.head.q.val() + self.one_sample.val();
        if self.writes.val() {
            self.head.d.next = self.next_head.val();
            self.begun.d.next = true;
        }
        if self.strobe.val() & self.begun.q.val() & (self.age.q.val() != self.full_age.val()) {
            self.age.d.next = self.age.q.val() + self.one_sample.val();
        }
        if self.start.val() {
            self.age.d.next = self.no_age.val();
            self.started.d.next = true;
        }
        if self.start.val() | (self.strobe.val() & !self.begun.q.val()) {
            self.origin.d.next = self.next_head.val();
        }

        comment!("The sample that lies delay samples back");
        self.before_start.next = self.delay.val() > self.age.q.val();
        self.address.next = self.head.q.val() - self.delay.val();
        if self.before_start.val() {
            self.address.next = self.origin.q.val();
        }
        self.blank.next = self.before_start.val() & !self.started.q.val();
        for i in 0..C {
            self.ring[i].clk.next = self.clk.val();
            self.ring[i].write_enable.next = self.writes.val();
            self.ring[i].write_address.next = self.next_head.val();
            self.ring[i].write_data.next = unsigned_cast(self.x[i].val());
            self.ring[i].read_address.next = self.address.val();
            self.sample[i].next = signed_cast(self.ring[i].read_data.val());
        }
    }
}
