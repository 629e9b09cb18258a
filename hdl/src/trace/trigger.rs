//! The trigger: does it come with this row?
//!
//! `compare` is high in the clock in which `value` is that of the row; `comes` counts in that clock.

use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct Trigger {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) forget: Signal<In, Bit>,
    pub(super) compare: Signal<In, Bit>,
    pub(super) value: Signal<In, Signed<32>>,
    pub(super) mode: Signal<In, Bits<2>>,
    pub(super) level: Signal<In, Signed<32>>,
    pub(super) happens: Signal<In, Bit>,
    pub(super) comes: Signal<Out, Bit>,

    has_row: Dff<Bit>,
    was_above: Dff<Bit>,
    kept_event: Dff<Bit>,

    wide_value: Signal<Local, Signed<33>>,
    wide_level: Signal<Local, Signed<33>>,
    difference: Signal<Local, Signed<33>>,
    above: Signal<Local, Bit>,

    rising_mode: Constant<Bits<2>>,
    falling_mode: Constant<Bits<2>>,
    event_mode: Constant<Bits<2>>,
}

impl Default for Trigger {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            forget: Signal::default(),
            compare: Signal::default(),
            value: Signal::default(),
            mode: Signal::default(),
            level: Signal::default(),
            happens: Signal::default(),
            comes: Signal::default(),
            has_row: Dff::default(),
            was_above: Dff::default(),
            kept_event: Dff::default(),
            wide_value: Signal::default(),
            wide_level: Signal::default(),
            difference: Signal::default(),
            above: Signal::default(),
            rising_mode: Constant::new(from_u64(1)),
            falling_mode: Constant::new(from_u64(2)),
            event_mode: Constant::new(from_u64(3)),
        }
    }
}

impl Logic for Trigger {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module trace_trigger");
        comment!("@about Does the trigger come with this row?");
        dff_setup!(self, clk, has_row, was_above, kept_event);

        comment!("At or above: what >= says, in less logic");
        self.wide_value.next = signed_bit_cast::<33, 32>(self.value.val());
        self.wide_level.next = signed_bit_cast::<33, 32>(self.level.val());
        self.difference.next = self.wide_value.val() - self.wide_level.val();
        self.above.next = !self.difference.val().get_bit(32);

        comment!("From row to row; the first has none before it");
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

        comment!("An event of this clock is of the next row");
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
