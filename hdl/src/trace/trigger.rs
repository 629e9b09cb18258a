//! The trigger: decides whether it comes with this row.
//!
//! `compare` is high in the clock in which `value` belongs to the row; `comes` is valid in that clock.

use crate::prelude::*;

kernel! {
    pub(super) struct Trigger;

    inputs {
        rst: Bit,
        forget: Bit,
        compare: Bit,
        value: Signed<32>,
        mode: Bits<2>,
        level: Signed<32>,
        happens: Bit,
    }
    outputs { comes: Bit }
    registers { has_row: Bit, was_above: Bit, kept_event: Bit }
    wires { wide_value: Signed<33>, wide_level: Signed<33>, difference: Signed<33>, above: Bit }
    constants {
        rising_mode: Bits<2> = from_u64(1),
        falling_mode: Bits<2> = from_u64(2),
        event_mode: Bits<2> = from_u64(3),
    }
}

impl Logic for Trigger {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module trace_trigger");

        comment!("At or above: the result of >= with less logic");
        self.wide_value.next = signed_bit_cast::<33, 32>(self.value.val());
        self.wide_level.next = signed_bit_cast::<33, 32>(self.level.val());
        self.difference.next = self.wide_value.val() - self.wide_level.val();
        self.above.next = !self.difference.val().get_bit(32);

        comment!("Compare with the row before; the first row has none");
        self.comes.next = true;
        if self.mode.val() == self.rising_mode.val() {
            self.comes.next = self.has_row.q.val() & self.above.val() & !self.was_above.q.val();
        }
        if self.mode.val() == self.falling_mode.val() {
            self.comes.next = self.has_row.q.val() & !self.above.val() & self.was_above.q.val();
        }
        if self.mode.val() == self.event_mode.val() {
            self.comes.next = self.kept_event.q.val();
        }

        comment!("An event in this clock belongs to the next row");
        self.kept_event.d.next = self.happens.val() | (self.kept_event.q.val() & !self.compare.val());
        if self.compare.val() {
            self.has_row.d.next = true;
            self.was_above.d.next = self.above.val();
        }
        if self.forget.val() {
            self.has_row.d.next = false;
            self.kept_event.d.next = false;
        }
    }
}
