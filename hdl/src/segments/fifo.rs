//! The entries that wait: 64 of 4 words in block RAM, and the pointers.
//!
//! `pop` makes the oldest entry the one that plays: its slot, `head`, is read in every tick, and is free again at the next
//! `pop` or once nothing plays. The slots after it wait, and a word goes into the first one after those; word 3 commits it.

use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct CommandFifo {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) write: Signal<In, Bit>,
    pub(super) word: Signal<In, Bits<2>>,
    pub(super) data: Signal<In, Bits<32>>,
    pub(super) closed: Signal<In, Bit>,
    pub(super) plays: Signal<In, Bit>,
    pub(super) flush: Signal<In, Bit>,
    pub(super) pop: Signal<In, Bit>,
    pub(super) read_word: Signal<In, Bits<2>>,
    pub(super) level: Signal<Out, Bits<7>>,
    pub(super) refused: Signal<Out, Bit>,
    pub(super) malformed: Signal<Out, Bit>,
    pub(super) read_data: Signal<Out, Bits<32>>,

    memory: Ram<32, 8>,

    head: Dff<Bits<6>>,
    level_q: Dff<Bits<7>>,
    written: Dff<Bits<3>>,
    too_wide: Dff<Bit>,

    full: Signal<Local, Bit>,
    waiting: Signal<Local, Bits<6>>,
    slot: Signal<Local, Bits<6>>,
    level_step: Signal<Local, Bits<7>>,
    refuses: Signal<Local, Bit>,
    takes: Signal<Local, Bit>,
    commits: Signal<Local, Bit>,
    narrow: Signal<Local, Bit>,
    complete: Signal<Local, Bit>,
    well_formed: Signal<Local, Bit>,
    upper: Signal<Local, Bits<25>>,
    ticks: Signal<Local, Bits<24>>,
    reserved: Signal<Local, Bits<6>>,
    entered: Signal<Local, Bit>,

    all_but_one: Constant<Bits<6>>,
    one_less: Constant<Bits<7>>,
    no_level: Constant<Bits<7>>,
    one_level: Constant<Bits<7>>,
    one_slot: Constant<Bits<6>>,
    first_word: Constant<Bits<2>>,
    second_word: Constant<Bits<2>>,
    third_word: Constant<Bits<2>>,
    last_word: Constant<Bits<2>>,
    nothing: Constant<Bits<3>>,
    first: Constant<Bits<3>>,
    second: Constant<Bits<3>>,
    third: Constant<Bits<3>>,
    no_upper: Constant<Bits<25>>,
    all_upper: Constant<Bits<25>>,
}

impl Default for CommandFifo {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            write: Signal::default(),
            word: Signal::default(),
            data: Signal::default(),
            closed: Signal::default(),
            plays: Signal::default(),
            flush: Signal::default(),
            pop: Signal::default(),
            read_word: Signal::default(),
            level: Signal::default(),
            refused: Signal::default(),
            malformed: Signal::default(),
            read_data: Signal::default(),
            memory: Ram::default(),
            head: Dff::default(),
            level_q: Dff::default(),
            written: Dff::default(),
            too_wide: Dff::default(),
            full: Signal::default(),
            waiting: Signal::default(),
            slot: Signal::default(),
            level_step: Signal::default(),
            refuses: Signal::default(),
            takes: Signal::default(),
            commits: Signal::default(),
            narrow: Signal::default(),
            complete: Signal::default(),
            well_formed: Signal::default(),
            upper: Signal::default(),
            ticks: Signal::default(),
            reserved: Signal::default(),
            entered: Signal::default(),
            all_but_one: Constant::new(from_u64(63)),
            one_less: Constant::new(from_u64(u64::MAX)),
            no_level: Constant::new(from_u64(0)),
            one_level: Constant::new(from_u64(1)),
            one_slot: Constant::new(from_u64(1)),
            first_word: Constant::new(from_u64(0)),
            second_word: Constant::new(from_u64(1)),
            third_word: Constant::new(from_u64(2)),
            last_word: Constant::new(from_u64(3)),
            nothing: Constant::new(from_u64(0)),
            first: Constant::new(from_u64(1)),
            second: Constant::new(from_u64(2)),
            third: Constant::new(from_u64(4)),
            no_upper: Constant::new(from_u64(0)),
            all_upper: Constant::new(from_u64(u64::MAX)),
        }
    }
}

impl Logic for CommandFifo {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module command_fifo");
        dff_setup!(self, clk, head, level_q, written, too_wide);
        self.memory.clk.next = self.clk.val();

        comment!("A word, unless closed or full");
        self.waiting.next = self.level_q.q.val().get_bits::<6>(0);
        self.full.next =
            self.level_q.q.val().get_bit(6) | (self.plays.val() & (self.waiting.val() == self.all_but_one.val()));
        self.refuses.next = self.closed.val() | self.full.val();
        self.takes.next = self.write.val() & !self.refuses.val();
        self.slot.next = self.head.q.val() + self.waiting.val() + self.one_slot.val();
        self.memory.write_enable.next = self.takes.val();
        self.memory.write_address.next = (bit_cast::<8, 6>(self.slot.val()) << 2) | bit_cast::<8, 2>(self.word.val());
        self.memory.write_data.next = self.data.val();

        comment!("The last word commits a whole entry");
        self.ticks.next = self.data.val().get_bits::<24>(0);
        self.reserved.next = self.data.val().get_bits::<6>(24);
        self.complete.next = self.written.q.val().get_bit(0)
            & self.written.q.val().get_bit(1)
            & (self.written.q.val().get_bit(2) | !self.data.val().get_bit(31));
        self.well_formed.next = self.complete.val()
            & (!self.too_wide.q.val() | self.data.val().get_bit(31))
            & self.ticks.val().any()
            & !self.reserved.val().any();
        self.commits.next = self.takes.val() & (self.word.val() == self.last_word.val());
        self.entered.next = self.commits.val() & self.well_formed.val();
        self.refused.next = self.write.val() & self.refuses.val();
        self.malformed.next = self.commits.val() & !self.well_formed.val();

        comment!("Which words are there, and a jerk too wide");
        self.upper.next = self.data.val().get_bits::<25>(7);
        self.narrow.next = (self.upper.val() == self.no_upper.val()) | (self.upper.val() == self.all_upper.val());
        if self.takes.val() {
            if self.word.val() == self.first_word.val() {
                self.written.d.next = self.written.q.val() | self.first.val();
            }
            if self.word.val() == self.second_word.val() {
                self.written.d.next = self.written.q.val() | self.second.val();
                self.too_wide.d.next = !self.narrow.val();
            }
            if self.word.val() == self.third_word.val() {
                self.written.d.next = self.written.q.val() | self.third.val();
            }
        }
        if self.write.val() & (self.word.val() == self.last_word.val()) {
            self.written.d.next = self.nothing.val();
            self.too_wide.d.next = false;
        }

        comment!("One in, one out");
        self.level_step.next = self.one_level.val();
        if self.pop.val() {
            self.head.d.next = self.head.q.val() + self.one_slot.val();
            self.level_step.next = self.one_less.val();
        }
        if self.entered.val() != self.pop.val() {
            self.level_q.d.next = self.level_q.q.val() + self.level_step.val();
        }
        if self.flush.val() {
            self.level_q.d.next = self.no_level.val();
            self.written.d.next = self.nothing.val();
            self.too_wide.d.next = false;
        }

        comment!("The entry that plays, a word at a time");
        self.memory.read_address.next =
            (bit_cast::<8, 6>(self.head.q.val()) << 2) | bit_cast::<8, 2>(self.read_word.val());
        self.read_data.next = self.memory.read_data.val();
        self.level.next = self.level_q.q.val();
    }
}
