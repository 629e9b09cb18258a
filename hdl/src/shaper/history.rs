//! Stores the samples since the last start, and the words of the start itself, in C ring buffers that move together.
//!
//! Each channel has a ring buffer of 2^A words in block RAM, with the newest word at `head`. A strobe or a start
//! appends `x`. From a start on `age` counts the strobes, so that the word of the start is `age` words back. One clock
//! after `delay`, `sample` is the word `ring[head − min(delay, age)]`: a sample from before the start is the word of
//! the start. The address of that word is kept in `origin`, so that subtraction and comparison run in parallel.
//!
//! After a reset `age` counts from the first strobe, and the samples before it are 0. The ring buffer does not contain
//! this 0: `blank` is high instead, one clock before the sample. So no word is used that was not written since the
//! reset.
//!
//! `delay` is at most 2^A − 2, so the word read is never the one being written.

use crate::prelude::*;
use posicast_blocks::shaper::ShaperConfig;

kernel! {
    /// Sizes: W word bits, A ring address bits, C channels.
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

        comment!("A strobe appends x; a start also clears the age");
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

        comment!("Read the sample that is delay samples old");
        self.before_start.next = self.delay.val() > self.age.q.val();
        self.address.next = self.head.q.val() - self.delay.val();
        if self.before_start.val() {
            self.address.next = self.origin.q.val();
        }
        self.blank.next = self.before_start.val() & !self.started.q.val();
        for i in 0..C {
            self.ring[i].write_enable.next = self.writes.val();
            self.ring[i].write_address.next = self.next_head.val();
            self.ring[i].write_data.next = unsigned_cast(self.x[i].val());
            self.ring[i].read_address.next = self.address.val();
            self.sample[i].next = signed_cast(self.ring[i].read_data.val());
        }
    }
}
