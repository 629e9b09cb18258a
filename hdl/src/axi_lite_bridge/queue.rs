//! A queue of two entries: the next one that comes out, and one behind it.

use crate::prelude::*;

kernel! {
    /// Size: W bits of an entry.
    pub(super) struct Queue<const W: usize>;

    inputs { rst: Bit, put: Bit, entry: Bits<W>, take: Bit }
    outputs { first: Bits<W>, holds: Bit, full: Bit }
    registers { first_q: Bits<W>, second: Bits<W>, holds_q: Bit, full_q: Bit }
    wires { takes: Bit, puts: Bit, remains: Bit }
}

impl<const W: usize> Logic for Queue<W> {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module queue_${width entry}");
        self.takes.next = self.take.val() & self.holds_q.q.val();
        self.puts.next = self.put.val() & !self.full_q.q.val();
        self.remains.next = self.holds_q.q.val() & !self.takes.val();
        if self.takes.val() {
            self.first_q.d.next = self.second.q.val();
            self.holds_q.d.next = self.full_q.q.val();
            self.full_q.d.next = false;
        }
        if self.puts.val() & self.remains.val() {
            self.second.d.next = self.entry.val();
            self.full_q.d.next = true;
        }
        if self.puts.val() & !self.remains.val() {
            self.first_q.d.next = self.entry.val();
            self.holds_q.d.next = true;
        }

        self.first.next = self.first_q.q.val();
        self.holds.next = self.holds_q.q.val();
        self.full.next = self.full_q.q.val();
    }
}
