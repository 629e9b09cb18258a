//! The leg: keeps dead time and minimum pulse, for any command and from any state.
//!
//! The outputs are those of the next clock: the gates register them.
//!
//! The timer counts up from 0 while off and from 1 in every new state, so that it needs no load; it is compared with
//! the two times for equality only. It stays at its end until the other side is commanded.

use crate::prelude::*;

kernel! {
    pub(super) struct Leg;

    inputs {
        rst: Bit,
        wanted: Bit,
        wants_high: Bit,
        low_first: Bit,
        dead_time: Bits<10>,
        minimum_pulse: Bits<10>,
    }
    outputs { awake: Bit, high_side: Bit, low_side: Bit }
    registers { awake_q: Bit, lit_q: Bit, high_q: Bit, timer: Bits<10> }
    wires { awake_next: Bit, lit_next: Bit, high_next: Bit, lasts: Bits<10> }
}

impl Logic for Leg {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module pwm_leg");

        self.awake_next.next = self.awake_q.q.val();
        self.lit_next.next = self.lit_q.q.val();
        self.high_next.next = self.high_q.q.val();

        comment!("The timer counts up to the state's duration");
        self.lasts.next = self.dead_time.val();
        if self.lit_q.q.val() {
            self.lasts.next = self.minimum_pulse.val();
        }
        if self.timer.q.val() != self.lasts.val() {
            self.timer.d.next = self.timer.q.val() + 1;
        } else {
            if !self.lit_q.q.val() {
                comment!("The dead time is over");
                self.lit_next.next = true;
                self.awake_next.next = true;
                if !self.awake_q.q.val() {
                    self.high_next.next = self.wants_high.val() & !self.low_first.val();
                }
                self.timer.d.next = 1.into();
            } else {
                if self.high_q.q.val() != self.wants_high.val() {
                    comment!("The minimum pulse is over");
                    self.lit_next.next = false;
                    self.high_next.next = self.wants_high.val();
                    self.timer.d.next = 1.into();
                }
            }
        }
        if !self.wanted.val() {
            self.awake_next.next = false;
            self.lit_next.next = false;
            self.high_next.next = false;
            self.timer.d.next = 0.into();
        }

        self.awake_q.d.next = self.awake_next.val();
        self.lit_q.d.next = self.lit_next.val();
        self.high_q.d.next = self.high_next.val();
        self.awake.next = self.awake_next.val();
        self.high_side.next = self.lit_next.val() & self.high_next.val();
        self.low_side.next = self.lit_next.val() & !self.high_next.val();
    }
}
