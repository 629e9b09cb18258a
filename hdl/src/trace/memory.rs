//! The words: a ring in block RAM from `oldest` to `pointer`, and reading in order of time.
//!
//! A write goes to `pointer`; with `drops` the oldest word goes. What lies between is valid, and all of it when `full`:
//! pointer and oldest are equal then, as they are when there is nothing. Any other word reads as 0, and so does every word
//! while `hidden`: then the RAM is being written, and what it gives for a word that is just written is unknown.

use crate::prelude::*;

/// A address bits.
#[derive(LogicBlock)]
pub(super) struct TraceMemory<const A: usize> {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) forget: Signal<In, Bit>,
    pub(super) write: Signal<In, Bit>,
    pub(super) drops: Signal<In, Bit>,
    pub(super) word: Signal<In, Signed<32>>,
    pub(super) full: Signal<In, Bit>,
    pub(super) hidden: Signal<In, Bit>,
    pub(super) read_address: Signal<In, Bits<11>>,
    pub(super) data: Signal<Out, Bits<32>>,

    ram: Ram<32, A>,

    pointer: Dff<Bits<A>>,
    oldest: Dff<Bits<A>>,
    valid: Dff<Bit>,

    between: Signal<Local, Bits<A>>,
    words: Signal<Local, Bits<12>>,

    no_address: Constant<Bits<A>>,
    one_word: Constant<Bits<A>>,
    all_words: Constant<Bits<12>>,
    no_data: Constant<Bits<32>>,
}

impl<const A: usize> Default for TraceMemory<A> {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            forget: Signal::default(),
            write: Signal::default(),
            drops: Signal::default(),
            word: Signal::default(),
            full: Signal::default(),
            hidden: Signal::default(),
            read_address: Signal::default(),
            data: Signal::default(),
            ram: Ram::default(),
            pointer: Dff::default(),
            oldest: Dff::default(),
            valid: Dff::default(),
            between: Signal::default(),
            words: Signal::default(),
            no_address: Constant::new(from_u64(0)),
            one_word: Constant::new(from_u64(1)),
            all_words: Constant::new(from_u64(1 << A)),
            no_data: Constant::new(from_u64(0)),
        }
    }
}

impl<const A: usize> Logic for TraceMemory<A> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module trace_memory_${words no_address}");
        comment!("@about The words of the trace, in a ring.");
        dff_setup!(self, clk, pointer, oldest, valid);
        self.ram.clk.next = self.clk.val();

        self.ram.write_enable.next = self.write.val();
        self.ram.write_address.next = self.pointer.q.val();
        self.ram.write_data.next = unsigned_cast(self.word.val());
        if self.write.val() {
            self.pointer.d.next = self.pointer.q.val() + self.one_word.val();
            if self.drops.val() {
                self.oldest.d.next = self.oldest.q.val() + self.one_word.val();
            }
        }
        if self.forget.val() {
            self.pointer.d.next = self.no_address.val();
            self.oldest.d.next = self.no_address.val();
        }

        comment!("Only words of the trace are shown; full, the");
        comment!("difference is 0, and the OR is a bit less logic");
        self.between.next = self.pointer.q.val() - self.oldest.q.val();
        self.words.next = bit_cast::<12, A>(self.between.val());
        if self.full.val() {
            self.words.next = bit_cast::<12, A>(self.between.val()) | self.all_words.val();
        }
        self.valid.d.next = !self.hidden.val() & (bit_cast::<12, 11>(self.read_address.val()) < self.words.val());
        self.ram.read_address.next = self.oldest.q.val() + bit_cast::<A, 11>(self.read_address.val());
        self.data.next = self.no_data.val();
        if self.valid.q.val() {
            self.data.next = self.ram.read_data.val();
        }
    }
}
