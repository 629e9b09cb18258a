//! Controls which bytes are added in which clock of a tick: six passes of eight clocks, and one that reads.
//!
//! ```text
//! phase     sum               goes to
//! 1 .. 5    a + j             a         a point loads word 2
//! 9 .. 14   v + a                       only checks: does v fit, or in a stop, does its sign change
//! 17 .. 21  a - j, or 0 - v   a         if a + j did not fit; in the last tick of a stop
//! 25 .. 30  v + a             v         a point loads word 1
//! 33 .. 39  p + v             p         a point loads word 0
//! 41 .. 43  ticks + 1         ticks
//! 44                          outputs
//! 49 .. 51  0 - ticks         ticks     of the next entry
//! ```
//!
//! The first tick of a cubic loads a and v as a point does, but adds v to p. In its other ticks the jerk has four
//! bytes, and its sign makes the fifth. An extrapolated tick uses no word of an entry, and its a is 0.
//!
//! The first clock of a pass clears the register that is to be loaded, and sets the carry. A register that rotates
//! keeps its value, except where the sum is written. The words of an entry come two clocks after their address, its
//! bytes one clock after theirs.

use crate::prelude::*;

kernel! {
    pub(super) struct Passes;

    inputs {
        rst: Bit,
        phase: Bits<6>,
        moves: Bit,
        held: Bit,
        points: Bit,
        loads: Bit,
        short_jerk: Bit,
        extrapolates: Bit,
        jerk_failed: Bit,
        speed_failed: Bit,
        moving: Bit,
        addend_sign: Bit,
    }
    outputs {
        failed: Bit,
        turn_acceleration: Bit,
        turn_velocity: Bit,
        turn_position: Bit,
        turn_ticks: Bit,
        write_acceleration: Bit,
        write_velocity: Bit,
        clear_acceleration: Bit,
        clear_velocity: Bit,
        clear_position: Bit,
        clear_ticks: Bit,
        from_later: Bit,
        from_odd: Bit,
        add_acceleration: Bit,
        add_velocity: Bit,
        invert: Bit,
        first: Bit,
        carry: Bit,
        judges_jerk: Bit,
        judges_speed: Bit,
        forgets_moving: Bit,
        sees_moving: Bit,
        sizes: Bit,
        decides: Bit,
        reads_flags: Bit,
        ends: Bit,
        read_word: Bits<2>,
        read_byte_0: Bit,
        read_byte_1: Bit,
        blank: Bit,
    }
    registers { from_odd_q: Bit, add_acceleration_q: Bit, add_velocity_q: Bit, invert_q: Bit }
    wires {
        later: Bit, middle: Bit, odd: Bit, slot_0: Bit, slot_1: Bit, slot_2: Bit, any_slot: Bit,
        accelerates: Bit, corrects: Bit, speeds: Bit, travels: Bit, counts: Bit, reads: Bit, fails: Bit,
        subtracts: Bit, comes_to_rest: Bit, sums: Bit, widens: Bit, one_later: Bit, two_later: Bit,
        last_word: Bit, from_third: Bit, from_fourth: Bit, fifth_ahead: Bit, ends_jerk: Bit,
    }
    constants {
        jerk_phase: Bits<6> = from_u64(5),
        speed_phase: Bits<6> = from_u64(8 + 6),
        word_0: Bits<2> = from_u64(0),
        word_1: Bits<2> = from_u64(1),
        word_2: Bits<2> = from_u64(2),
        word_3: Bits<2> = from_u64(3),
    }
}

impl Logic for Passes {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module passes");
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
        self.fails.next = self.moves.val() & !self.loads.val() & (self.jerk_failed.val() | self.speed_failed.val());
        self.failed.next = self.fails.val();
        self.comes_to_rest.next = !self.moves.val() & self.speed_failed.val();
        self.subtracts.next = self.jerk_failed.val() | self.comes_to_rest.val();
        self.judges_jerk.next = self.phase.val() == self.jerk_phase.val();
        self.judges_speed.next = self.phase.val() == self.speed_phase.val();

        comment!("Whole rotations: 5, 6, 7 and 3 bytes");
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

        comment!("First clock of a pass: clear, and set the carry");
        self.first.next = !self.any_slot.val();
        self.clear_acceleration.next = self.corrects.val() & !self.any_slot.val() & self.comes_to_rest.val();
        self.clear_velocity.next =
            self.speeds.val() & !self.any_slot.val() & (self.loads.val() | (!self.moves.val() & !self.moving.val()));
        self.clear_position.next = self.travels.val() & !self.any_slot.val() & self.points.val();
        self.clear_ticks.next = self.reads.val() & !self.any_slot.val();
        self.carry.next =
            (self.corrects.val() & self.subtracts.val()) | (self.counts.val() & !self.held.val()) | self.reads.val();

        comment!("The addend, a clock ahead");
        self.sums.next = !self.fails.val() & !self.points.val();
        self.add_acceleration_q.d.next = (!self.later.val() & self.odd.val())
            & (!self.middle.val() | (!self.fails.val() & !self.loads.val()))
            & !(self.slot_2.val() & (self.slot_1.val() | self.slot_0.val()));
        self.add_velocity_q.d.next = ((self.corrects.val() & self.comes_to_rest.val())
            | (self.travels.val() & self.sums.val()))
            & !(self.slot_2.val() & self.slot_1.val());
        self.ends_jerk.next = self.short_jerk.val()
            & (self.accelerates.val() | self.corrects.val())
            & self.slot_2.val()
            & !self.slot_1.val()
            & !self.slot_0.val();
        self.widens.next = self.slot_2.val()
            & ((!self.later.val() & !self.loads.val() & !self.slot_1.val() & self.slot_0.val())
                | (self.later.val() & !self.points.val() & self.slot_1.val() & !self.slot_0.val()));
        self.invert_q.d.next = (self.corrects.val() & self.subtracts.val())
            | self.reads.val()
            | (self.widens.val() & self.addend_sign.val());
        if self.ends_jerk.val() {
            self.invert_q.d.next = self.addend_sign.val();
        }
        self.add_acceleration.next = self.add_acceleration_q.q.val();
        self.add_velocity.next = self.add_velocity_q.q.val();
        self.invert.next = self.invert_q.q.val();

        comment!("Detect remaining motion; update the outputs");
        self.forgets_moving.next = self.corrects.val() & !self.any_slot.val();
        self.sees_moving.next =
            self.middle.val() & (self.turn_acceleration.val() | (self.odd.val() & self.turn_velocity.val()));
        self.sizes.next = self.counts.val() & !self.slot_2.val() & self.slot_1.val() & self.slot_0.val();
        self.decides.next = self.counts.val() & self.slot_2.val() & !self.slot_1.val() & !self.slot_0.val();
        self.ends.next = self.reads.val() & self.slot_1.val() & self.slot_0.val();

        comment!("Select the words and bytes of the entry, ahead");
        self.from_third.next = self.slot_2.val() | self.slot_1.val();
        self.from_fourth.next = self.slot_2.val() | (self.slot_1.val() & self.slot_0.val());
        self.fifth_ahead.next = !self.slot_2.val() & self.slot_1.val() & self.slot_0.val();
        self.last_word.next =
            self.later.val() & ((self.odd.val() & self.slot_1.val()) | (self.middle.val() & !self.slot_1.val()));
        self.reads_flags.next = self.reads.val() & !self.slot_1.val();
        self.read_word.next = self.word_0.val();
        if self.loads.val() {
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
        self.one_later.next = self.loads.val() & !self.middle.val() & !self.odd.val();
        self.two_later.next = self.loads.val() & (self.speeds.val() | self.travels.val());
        self.read_byte_0.next = self.slot_0.val() ^ self.one_later.val();
        self.read_byte_1.next = self.slot_1.val() ^ self.two_later.val() ^ (self.one_later.val() & !self.slot_0.val());
        self.blank.next = !((self.accelerates.val()
            & (!self.loads.val() | self.any_slot.val())
            & !self.ends_jerk.val()
            & !self.extrapolates.val())
            | (self.corrects.val() & self.jerk_failed.val() & !self.ends_jerk.val())
            | (self.speeds.val() & self.loads.val() & self.from_third.val())
            | (self.travels.val() & self.points.val() & self.from_fourth.val())
            | self.reads.val());
    }
}
