//! The leg: dead time and minimum pulse, whatever is wanted of it and from whatever state.
//!
//! The outputs are those of the next clock: the gates take them into registers.
//!
//! The timer counts up from 0 while off and from 1 in every new state, so that it needs no load, and compares with what it
//! is to reach: of the two times only equality is asked. It stays there until something else is wanted.

use crate::prelude::*;

#[derive(LogicBlock, Default)]
pub(super) struct Leg {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) wanted: Signal<In, Bit>,
    pub(super) wants_high: Signal<In, Bit>,
    pub(super) low_first: Signal<In, Bit>,
    pub(super) dead_time: Signal<In, Bits<10>>,
    pub(super) minimum_pulse: Signal<In, Bits<10>>,
    pub(super) awake: Signal<Out, Bit>,
    pub(super) high_side: Signal<Out, Bit>,
    pub(super) low_side: Signal<Out, Bit>,

    awake_q: Dff<Bit>,
    lit_q: Dff<Bit>,
    high_q: Dff<Bit>,
    timer: Dff<Bits<10>>,

    awake_next: Signal<Local, Bit>,
    lit_next: Signal<Local, Bit>,
    high_next: Signal<Local, Bit>,
    lasts: Signal<Local, Bits<10>>,
}

impl Logic for Leg {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module pwm_leg");
        comment!("@about Never both sides; dead time between them;");
        comment!("@about no pulse below the minimum.");
        dff_setup!(self, clk, awake_q, lit_q, high_q, timer);

        self.awake_next.next = self.awake_q.q.val();
        self.lit_next.next = self.lit_q.q.val();
        self.high_next.next = self.high_q.q.val();

        comment!("The timer counts up to what the state lasts");
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
