//! The cause word, and what follows from it: of emergency stop, PWM trip, lost drive and range in the clock in which they become
//! active, of all others when they stand, a clock later.
//!
//! What follows from causes that stand is registered with them, so that only four lines are on the way to the state.

use crate::prelude::*;
use posicast_model::rtl::axis::{ALWAYS_OFF, CAUSE_BITS, Cause, HARMLESS};

#[derive(LogicBlock)]
pub(super) struct Causes {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) forget: Signal<In, Bit>,
    pub(super) emergency: Signal<In, Bit>,
    pub(super) tripped: Signal<In, Bit>,
    pub(super) drive_lost: Signal<In, Bit>,
    pub(super) out_of_range: Signal<In, Bit>,
    pub(super) encoder_error: Signal<In, Bit>,
    pub(super) segments_failed: Signal<In, Bit>,
    pub(super) group_stops: Signal<In, Bit>,
    pub(super) group_stop: Signal<In, Bit>,
    pub(super) late: Signal<In, Bit>,
    pub(super) watched: Signal<In, Bits<17>>,
    pub(super) off_causes: Signal<In, Bits<16>>,
    pub(super) causes: Signal<Out, Bits<17>>,
    pub(super) any_cause: Signal<Out, Bit>,
    pub(super) fault: Signal<Out, Bit>,
    pub(super) cut: Signal<Out, Bit>,
    pub(super) had_fault: Signal<Out, Bit>,

    causes_q: Dff<Bits<17>>,
    had_fault_q: Dff<Bit>,
    had_cut_q: Dff<Bit>,

    by_emergency: Signal<Local, Bits<17>>,
    by_tripped: Signal<Local, Bits<17>>,
    by_drive_lost: Signal<Local, Bits<17>>,
    by_out_of_range: Signal<Local, Bits<17>>,
    by_encoder_error: Signal<Local, Bits<17>>,
    by_segments_failed: Signal<Local, Bits<17>>,
    by_group_stops: Signal<Local, Bits<17>>,
    by_late: Signal<Local, Bits<17>>,
    kept: Signal<Local, Bits<17>>,
    lines: Signal<Local, Bits<17>>,
    flags: Signal<Local, Bits<17>>,
    now: Signal<Local, Bits<17>>,
    harmful: Signal<Local, Bits<17>>,
    off: Signal<Local, Bits<17>>,
    cutting: Signal<Local, Bits<17>>,
    cutting_now: Signal<Local, Bits<17>>,
    harmless: Signal<Local, Bits<17>>,
    switches_off: Signal<Local, Bit>,

    no_causes: Constant<Bits<17>>,
    of_emergency: Constant<Bits<17>>,
    of_tripped: Constant<Bits<17>>,
    of_drive_lost: Constant<Bits<17>>,
    of_out_of_range: Constant<Bits<17>>,
    of_encoder_error: Constant<Bits<17>>,
    of_segments_failed: Constant<Bits<17>>,
    of_group_stops: Constant<Bits<17>>,
    of_late: Constant<Bits<17>>,
    harmful_causes: Constant<Bits<17>>,
    always_off: Constant<Bits<17>>,
}

impl Default for Causes {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            forget: Signal::default(),
            emergency: Signal::default(),
            tripped: Signal::default(),
            drive_lost: Signal::default(),
            out_of_range: Signal::default(),
            encoder_error: Signal::default(),
            segments_failed: Signal::default(),
            group_stops: Signal::default(),
            group_stop: Signal::default(),
            late: Signal::default(),
            watched: Signal::default(),
            off_causes: Signal::default(),
            causes: Signal::default(),
            any_cause: Signal::default(),
            fault: Signal::default(),
            cut: Signal::default(),
            had_fault: Signal::default(),
            causes_q: Dff::default(),
            had_fault_q: Dff::default(),
            had_cut_q: Dff::default(),
            by_emergency: Signal::default(),
            by_tripped: Signal::default(),
            by_drive_lost: Signal::default(),
            by_out_of_range: Signal::default(),
            by_encoder_error: Signal::default(),
            by_segments_failed: Signal::default(),
            by_group_stops: Signal::default(),
            by_late: Signal::default(),
            kept: Signal::default(),
            lines: Signal::default(),
            flags: Signal::default(),
            now: Signal::default(),
            harmful: Signal::default(),
            off: Signal::default(),
            cutting: Signal::default(),
            cutting_now: Signal::default(),
            harmless: Signal::default(),
            switches_off: Signal::default(),
            no_causes: Constant::new(from_u64(0)),
            of_emergency: Constant::new(from_u64(u64::from(Cause::EmergencyStop.bit()))),
            of_tripped: Constant::new(from_u64(u64::from(Cause::PwmTripped.bit()))),
            of_drive_lost: Constant::new(from_u64(u64::from(Cause::DriveLost.bit()))),
            of_out_of_range: Constant::new(from_u64(u64::from(Cause::Range.bit()))),
            of_encoder_error: Constant::new(from_u64(u64::from(Cause::EncoderError.bit()))),
            of_segments_failed: Constant::new(from_u64(u64::from(Cause::Segments.bit()))),
            of_group_stops: Constant::new(from_u64(u64::from(Cause::GroupStop.bit()))),
            of_late: Constant::new(from_u64(u64::from(Cause::Schedule.bit()))),
            harmful_causes: Constant::new(from_u64(u64::from(!HARMLESS & ((1 << CAUSE_BITS) - 1)))),
            always_off: Constant::new(from_u64(u64::from(ALWAYS_OFF))),
        }
    }
}

impl Logic for Causes {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_causes");
        comment!("@about Sticky causes: set wins over forget.");
        dff_setup!(self, clk, causes_q, had_fault_q, had_cut_q);
        self.by_emergency.next = self.no_causes.val();
        if self.emergency.val() {
            self.by_emergency.next = self.of_emergency.val();
        }
        self.by_tripped.next = self.no_causes.val();
        if self.tripped.val() {
            self.by_tripped.next = self.of_tripped.val();
        }
        self.by_drive_lost.next = self.no_causes.val();
        if self.drive_lost.val() {
            self.by_drive_lost.next = self.of_drive_lost.val();
        }
        self.by_out_of_range.next = self.no_causes.val();
        if self.out_of_range.val() {
            self.by_out_of_range.next = self.of_out_of_range.val();
        }
        self.by_encoder_error.next = self.no_causes.val();
        if self.encoder_error.val() {
            self.by_encoder_error.next = self.of_encoder_error.val();
        }
        self.by_segments_failed.next = self.no_causes.val();
        if self.segments_failed.val() {
            self.by_segments_failed.next = self.of_segments_failed.val();
        }
        self.by_group_stops.next = self.no_causes.val();
        if self.group_stops.val() {
            self.by_group_stops.next = self.of_group_stops.val();
        }
        self.by_late.next = self.no_causes.val();
        if self.late.val() {
            self.by_late.next = self.of_late.val();
        }
        self.lines.next = self.by_emergency.val()
            | self.by_tripped.val()
            | self.by_drive_lost.val()
            | self.by_out_of_range.val()
            | self.by_group_stops.val();
        self.flags.next = self.by_encoder_error.val() | self.by_segments_failed.val() | self.by_late.val();
        self.kept.next = self.causes_q.q.val();
        if self.forget.val() {
            self.kept.next = self.no_causes.val();
        }
        self.now.next = self.kept.val() | self.lines.val() | self.flags.val() | self.watched.val();
        self.causes_q.d.next = self.now.val();

        comment!("What follows: at once of these lines;");
        self.off.next = (bit_cast::<17, 16>(self.off_causes.val()) | self.always_off.val()) & self.harmful_causes.val();
        self.harmless.next = self.causes_q.q.val() & !self.harmful_causes.val();
        self.switches_off.next = self.emergency.val() | self.tripped.val() | self.out_of_range.val();
        self.fault.next = self.switches_off.val() | self.drive_lost.val() | self.had_fault_q.q.val();
        self.cutting.next = self.by_drive_lost.val() & self.off.val();
        self.cut.next = self.switches_off.val() | self.cutting.val().any() | self.had_cut_q.q.val();
        comment!("an axis that stops the group never asks here;");
        self.any_cause.next = self.fault.val() | self.harmless.val().any() | self.group_stop.val();

        comment!("of all others when they stand, a clock later");
        self.harmful.next = self.now.val() & self.harmful_causes.val();
        self.cutting_now.next = self.now.val() & self.off.val();
        self.had_fault_q.d.next = self.harmful.val().any();
        self.had_cut_q.d.next = self.cutting_now.val().any();
        self.had_fault.next = self.had_fault_q.q.val();
        self.causes.next = self.causes_q.q.val();
    }
}
