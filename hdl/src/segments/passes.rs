//! Which bytes are added in which clock of a tick: six passes of eight clocks, and one that reads.
//!
//! ```text
//! phase    1…5       9…14     17…21            25…30       33…39       41…43    44      49…51
//! sum      a + j     v + a    a − j, −v        v + a       p + v       ticks            ticks
//! goes to  a         (looked  a, if it did     v           p           ticks    outputs ticks of the next
//!          (point: w2)  at)   not fit, at rest (point: w1) (point: w0)                  entry
//! ```
//!
//! The first clock of a pass clears what is to be loaded and sets the carry; a turn of a register leaves it as it was, but
//! for what is written. Words of an entry come two clocks after their address, bytes of it one clock after theirs.

use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct Passes {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) phase: Signal<In, Bits<6>>,
    pub(super) moves: Signal<In, Bit>,
    pub(super) held: Signal<In, Bit>,
    pub(super) points: Signal<In, Bit>,
    pub(super) jerk_failed: Signal<In, Bit>,
    pub(super) speed_failed: Signal<In, Bit>,
    pub(super) moving: Signal<In, Bit>,
    pub(super) addend_sign: Signal<In, Bit>,
    pub(super) failed: Signal<Out, Bit>,
    pub(super) turn_acceleration: Signal<Out, Bit>,
    pub(super) turn_velocity: Signal<Out, Bit>,
    pub(super) turn_position: Signal<Out, Bit>,
    pub(super) turn_ticks: Signal<Out, Bit>,
    pub(super) write_acceleration: Signal<Out, Bit>,
    pub(super) write_velocity: Signal<Out, Bit>,
    pub(super) clear_acceleration: Signal<Out, Bit>,
    pub(super) clear_velocity: Signal<Out, Bit>,
    pub(super) clear_position: Signal<Out, Bit>,
    pub(super) clear_ticks: Signal<Out, Bit>,
    pub(super) from_later: Signal<Out, Bit>,
    pub(super) from_odd: Signal<Out, Bit>,
    pub(super) add_acceleration: Signal<Out, Bit>,
    pub(super) add_velocity: Signal<Out, Bit>,
    pub(super) invert: Signal<Out, Bit>,
    pub(super) first: Signal<Out, Bit>,
    pub(super) carry: Signal<Out, Bit>,
    pub(super) judges_jerk: Signal<Out, Bit>,
    pub(super) judges_speed: Signal<Out, Bit>,
    pub(super) forgets_moving: Signal<Out, Bit>,
    pub(super) sees_moving: Signal<Out, Bit>,
    pub(super) sizes: Signal<Out, Bit>,
    pub(super) decides: Signal<Out, Bit>,
    pub(super) reads_flags: Signal<Out, Bit>,
    pub(super) ends: Signal<Out, Bit>,
    pub(super) read_word: Signal<Out, Bits<2>>,
    pub(super) read_byte_0: Signal<Out, Bit>,
    pub(super) read_byte_1: Signal<Out, Bit>,
    pub(super) blank: Signal<Out, Bit>,

    from_odd_q: Dff<Bit>,
    add_acceleration_q: Dff<Bit>,
    add_velocity_q: Dff<Bit>,
    invert_q: Dff<Bit>,

    later: Signal<Local, Bit>,
    middle: Signal<Local, Bit>,
    odd: Signal<Local, Bit>,
    slot_0: Signal<Local, Bit>,
    slot_1: Signal<Local, Bit>,
    slot_2: Signal<Local, Bit>,
    any_slot: Signal<Local, Bit>,
    accelerates: Signal<Local, Bit>,
    corrects: Signal<Local, Bit>,
    speeds: Signal<Local, Bit>,
    travels: Signal<Local, Bit>,
    counts: Signal<Local, Bit>,
    reads: Signal<Local, Bit>,
    fails: Signal<Local, Bit>,
    subtracts: Signal<Local, Bit>,
    comes_to_rest: Signal<Local, Bit>,
    sums: Signal<Local, Bit>,
    widens: Signal<Local, Bit>,
    one_later: Signal<Local, Bit>,
    two_later: Signal<Local, Bit>,
    last_word: Signal<Local, Bit>,
    from_third: Signal<Local, Bit>,
    from_fourth: Signal<Local, Bit>,
    fifth_ahead: Signal<Local, Bit>,

    jerk_phase: Constant<Bits<6>>,
    speed_phase: Constant<Bits<6>>,
    word_0: Constant<Bits<2>>,
    word_1: Constant<Bits<2>>,
    word_2: Constant<Bits<2>>,
    word_3: Constant<Bits<2>>,
}

impl Default for Passes {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            phase: Signal::default(),
            moves: Signal::default(),
            held: Signal::default(),
            points: Signal::default(),
            jerk_failed: Signal::default(),
            speed_failed: Signal::default(),
            moving: Signal::default(),
            addend_sign: Signal::default(),
            failed: Signal::default(),
            turn_acceleration: Signal::default(),
            turn_velocity: Signal::default(),
            turn_position: Signal::default(),
            turn_ticks: Signal::default(),
            write_acceleration: Signal::default(),
            write_velocity: Signal::default(),
            clear_acceleration: Signal::default(),
            clear_velocity: Signal::default(),
            clear_position: Signal::default(),
            clear_ticks: Signal::default(),
            from_later: Signal::default(),
            from_odd: Signal::default(),
            add_acceleration: Signal::default(),
            add_velocity: Signal::default(),
            invert: Signal::default(),
            first: Signal::default(),
            carry: Signal::default(),
            judges_jerk: Signal::default(),
            judges_speed: Signal::default(),
            forgets_moving: Signal::default(),
            sees_moving: Signal::default(),
            sizes: Signal::default(),
            decides: Signal::default(),
            reads_flags: Signal::default(),
            ends: Signal::default(),
            read_word: Signal::default(),
            read_byte_0: Signal::default(),
            read_byte_1: Signal::default(),
            blank: Signal::default(),
            from_odd_q: Dff::default(),
            add_acceleration_q: Dff::default(),
            add_velocity_q: Dff::default(),
            invert_q: Dff::default(),
            later: Signal::default(),
            middle: Signal::default(),
            odd: Signal::default(),
            slot_0: Signal::default(),
            slot_1: Signal::default(),
            slot_2: Signal::default(),
            any_slot: Signal::default(),
            accelerates: Signal::default(),
            corrects: Signal::default(),
            speeds: Signal::default(),
            travels: Signal::default(),
            counts: Signal::default(),
            reads: Signal::default(),
            fails: Signal::default(),
            subtracts: Signal::default(),
            comes_to_rest: Signal::default(),
            sums: Signal::default(),
            widens: Signal::default(),
            one_later: Signal::default(),
            two_later: Signal::default(),
            last_word: Signal::default(),
            from_third: Signal::default(),
            from_fourth: Signal::default(),
            fifth_ahead: Signal::default(),
            jerk_phase: Constant::new(from_u64(5)),
            speed_phase: Constant::new(from_u64(8 + 6)),
            word_0: Constant::new(from_u64(0)),
            word_1: Constant::new(from_u64(1)),
            word_2: Constant::new(from_u64(2)),
            word_3: Constant::new(from_u64(3)),
        }
    }
}

impl Logic for Passes {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module passes");
        dff_setup!(self, clk, from_odd_q, add_acceleration_q, add_velocity_q, invert_q);
        self.later.next = self.phase.val().get_bit(5);
        self.middle.next = self.phase.val().get_bit(4);
        self.odd.next = self.phase.val().get_bit(3);
        self.slot_2.next = self.phase.val().get_bit(2);
        self.slot_1.next = self.phase.val().get_bit(1);
        self.slot_0.next = self.phase.val().get_bit(0);
        self.any_slot.next = self.slot_2.val() | self.slot_1.val() | self.slot_0.val();
        self.accelerates.next = !self.later.val() & !self.middle.val() & !self.odd.val();
        self.corrects.next = !self.later.val() & self.middle.val() & !self.odd.val();
        self.speeds.next = self.middle.val() & self.odd.val();
        self.travels.next = self.later.val() & !self.middle.val() & !self.odd.val();
        self.counts.next = self.later.val() & self.odd.val();
        self.reads.next = self.later.val() & self.middle.val();

        comment!("What did not fit, and a stop's last tick");
        self.fails.next = self.moves.val() & !self.points.val() & (self.jerk_failed.val() | self.speed_failed.val());
        self.failed.next = self.fails.val();
        self.comes_to_rest.next = !self.moves.val() & self.speed_failed.val();
        self.subtracts.next = self.jerk_failed.val() | self.comes_to_rest.val();
        self.judges_jerk.next = self.phase.val() == self.jerk_phase.val();
        self.judges_speed.next = self.phase.val() == self.speed_phase.val();

        comment!("Whole turns: 5, 6, 7 and 3 bytes");
        self.turn_acceleration.next =
            !self.later.val() & self.any_slot.val() & !(self.slot_2.val() & self.slot_1.val());
        self.turn_velocity.next = (!self.later.val() | self.travels.val())
            & self.any_slot.val()
            & !(self.slot_2.val() & self.slot_1.val() & self.slot_0.val());
        self.turn_position.next = self.travels.val() & self.any_slot.val();
        self.turn_ticks.next =
            self.later.val() & !self.travels.val() & !self.slot_2.val() & (self.slot_1.val() | self.slot_0.val());
        self.write_acceleration.next = !self.odd.val();
        self.write_velocity.next = self.speeds.val();
        self.from_later.next = self.later.val();
        self.from_odd_q.d.next = self.odd.val() | self.reads.val();
        self.from_odd.next = self.from_odd_q.q.val();

        comment!("Before the first byte: 0, and the carry");
        self.first.next = !self.any_slot.val();
        self.clear_acceleration.next = self.corrects.val() & !self.any_slot.val() & self.comes_to_rest.val();
        self.clear_velocity.next =
            self.speeds.val() & !self.any_slot.val() & (self.points.val() | (!self.moves.val() & !self.moving.val()));
        self.clear_position.next = self.travels.val() & !self.any_slot.val() & self.points.val();
        self.clear_ticks.next = self.reads.val() & !self.any_slot.val();
        self.carry.next =
            (self.corrects.val() & self.subtracts.val()) | (self.counts.val() & !self.held.val()) | self.reads.val();

        comment!("The addend, a clock ahead");
        self.sums.next = !self.fails.val() & !self.points.val();
        self.add_acceleration_q.d.next = (!self.later.val() & self.odd.val())
            & (!self.middle.val() | self.sums.val())
            & !(self.slot_2.val() & (self.slot_1.val() | self.slot_0.val()));
        self.add_velocity_q.d.next = ((self.corrects.val() & self.comes_to_rest.val())
            | (self.travels.val() & self.sums.val()))
            & !(self.slot_2.val() & self.slot_1.val());
        self.widens.next = !self.points.val()
            & self.slot_2.val()
            & ((!self.later.val() & !self.slot_1.val() & self.slot_0.val())
                | (self.later.val() & self.slot_1.val() & !self.slot_0.val()));
        self.invert_q.d.next = (self.corrects.val() & self.subtracts.val())
            | self.reads.val()
            | (self.widens.val() & self.addend_sign.val());
        self.add_acceleration.next = self.add_acceleration_q.q.val();
        self.add_velocity.next = self.add_velocity_q.q.val();
        self.invert.next = self.invert_q.q.val();

        comment!("Is there any motion left; the outputs");
        self.forgets_moving.next = self.corrects.val() & !self.any_slot.val();
        self.sees_moving.next =
            self.middle.val() & (self.turn_acceleration.val() | (self.odd.val() & self.turn_velocity.val()));
        self.sizes.next = self.counts.val() & !self.slot_2.val() & self.slot_1.val() & self.slot_0.val();
        self.decides.next = self.counts.val() & self.slot_2.val() & !self.slot_1.val() & !self.slot_0.val();
        self.ends.next = self.reads.val() & self.slot_1.val() & self.slot_0.val();

        comment!("The entry's words and bytes, ahead");
        self.from_third.next = self.slot_2.val() | self.slot_1.val();
        self.from_fourth.next = self.slot_2.val() | (self.slot_1.val() & self.slot_0.val());
        self.fifth_ahead.next = !self.slot_2.val() & self.slot_1.val() & self.slot_0.val();
        self.last_word.next =
            self.later.val() & ((self.odd.val() & self.slot_1.val()) | (self.middle.val() & !self.slot_1.val()));
        self.reads_flags.next = self.reads.val() & !self.slot_1.val();
        self.read_word.next = self.word_0.val();
        if self.points.val() {
            if self.speeds.val() {
                self.read_word.next = self.word_1.val();
            } else {
                if !self.later.val() {
                    self.read_word.next = self.word_2.val();
                }
            }
        } else {
            if !self.later.val() & self.fifth_ahead.val() {
                self.read_word.next = self.word_1.val();
            }
        }
        if self.last_word.val() {
            self.read_word.next = self.word_3.val();
        }
        comment!("a, v and p of a point: 1, 2, 3 bytes later");
        self.one_later.next = self.points.val() & !self.middle.val() & !self.odd.val();
        self.two_later.next = self.points.val() & (self.speeds.val() | self.travels.val());
        self.read_byte_0.next = self.slot_0.val() ^ self.one_later.val();
        self.read_byte_1.next = self.slot_1.val() ^ self.two_later.val() ^ (self.one_later.val() & !self.slot_0.val());
        self.blank.next = !((self.accelerates.val() & (!self.points.val() | self.any_slot.val()))
            | (self.corrects.val() & self.jerk_failed.val())
            | (self.speeds.val() & self.points.val() & self.from_third.val())
            | (self.travels.val() & self.points.val() & self.from_fourth.val())
            | self.reads.val());
    }
}
