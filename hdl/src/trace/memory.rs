//! The recorded words: a ring buffer in block RAM from `oldest` to `pointer`, read in order of time.
//!
//! A write goes to `pointer`; with `drops` the oldest word is dropped. The words between are valid, and all of them
//! when `full`: pointer and oldest are then equal, as they are when the memory is empty. Any other word reads as 0,
//! and so does every word while `hidden`, when the RAM is being written and a word that is just written reads as
//! unknown.

use crate::prelude::*;
use posicast_blocks::trace::TraceConfig;

kernel! {
    /// Sizes: A address bits.
    pub(super) struct TraceMemory<const A: usize>(config: &TraceConfig);

    inputs {
        rst: Bit,
        forget: Bit,
        write: Bit,
        drops: Bit,
        word: Signed<32>,
        full: Bit,
        hidden: Bit,
        read_address: Bits<11>,
    }
    outputs { data: Bits<32> }
    parts { ram: Ram<32, A> }
    registers { pointer: Bits<A>, oldest: Bits<A>, valid: Bit }
    wires { between: Bits<A>, words: Bits<12> }
    constants {
        no_address: Bits<A> = from_u64(0),
        one_word: Bits<A> = from_u64(1),
        all_words: Bits<12> = from_u64(u64::from(config.samples())),
        no_data: Bits<32> = from_u64(0),
    }
}

impl<const A: usize> Logic for TraceMemory<A> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module trace_memory_${words no_address}");

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

        comment!("Only words of the trace are shown. If full, the");
        comment!("difference is 0, and an OR replaces a sum");
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
