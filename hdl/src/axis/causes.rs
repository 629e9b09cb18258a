//! The cause word and its consequences: emergency stop, PWM trip, lost drive and range act in the clock in which they
//! become active, all others one clock later, when their bit is set.
//!
//! The consequences of causes that are set are registered with them, so that only four lines are combinational on the
//! way to the state.

use crate::prelude::*;
use posicast_blocks::axis::{ALWAYS_OFF, CAUSE_BITS, Cause, HARMLESS};

kernel! {
    pub(super) struct Causes;

    inputs {
        rst: Bit,
        forget: Bit,
        emergency: Bit,
        tripped: Bit,
        drive_lost: Bit,
        out_of_range: Bit,
        encoder_error: Bit,
        segments_failed: Bit,
        group_stops: Bit,
        group_stop: Bit,
        late: Bit,
        watched: Bits<17>,
        off_causes: Bits<16>,
    }
    outputs { causes: Bits<17>, any_cause: Bit, fault: Bit, cut: Bit, had_fault: Bit }
    registers { causes_q: Bits<17>, had_fault_q: Bit, had_cut_q: Bit }
    wires {
        by_emergency: Bits<17>, by_tripped: Bits<17>, by_drive_lost: Bits<17>, by_out_of_range: Bits<17>,
        by_encoder_error: Bits<17>, by_segments_failed: Bits<17>, by_group_stops: Bits<17>, by_late: Bits<17>,
        kept: Bits<17>, lines: Bits<17>, flags: Bits<17>, now: Bits<17>, harmful: Bits<17>, off: Bits<17>,
        cutting: Bits<17>, cutting_now: Bits<17>, harmless: Bits<17>, switches_off: Bit,
    }
    constants {
        no_causes: Bits<17> = from_u64(0),
        of_emergency: Bits<17> = from_u64(u64::from(Cause::EmergencyStop.bit())),
        of_tripped: Bits<17> = from_u64(u64::from(Cause::PwmTripped.bit())),
        of_drive_lost: Bits<17> = from_u64(u64::from(Cause::DriveLost.bit())),
        of_out_of_range: Bits<17> = from_u64(u64::from(Cause::Range.bit())),
        of_encoder_error: Bits<17> = from_u64(u64::from(Cause::EncoderError.bit())),
        of_segments_failed: Bits<17> = from_u64(u64::from(Cause::Segments.bit())),
        of_group_stops: Bits<17> = from_u64(u64::from(Cause::GroupStop.bit())),
        of_late: Bits<17> = from_u64(u64::from(Cause::Schedule.bit())),
        harmful_causes: Bits<17> = from_u64(u64::from(!HARMLESS & ((1 << CAUSE_BITS) - 1))),
        always_off: Bits<17> = from_u64(u64::from(ALWAYS_OFF)),
    }
}

impl Logic for Causes {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module axis_causes");
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

        comment!("These lines act at once;");
        self.off.next = (bit_cast::<17, 16>(self.off_causes.val()) | self.always_off.val()) & self.harmful_causes.val();
        self.harmless.next = self.causes_q.q.val() & !self.harmful_causes.val();
        self.switches_off.next = self.emergency.val() | self.tripped.val() | self.out_of_range.val();
        self.fault.next = self.switches_off.val() | self.drive_lost.val() | self.had_fault_q.q.val();
        self.cutting.next = self.by_drive_lost.val() & self.off.val();
        self.cut.next = self.switches_off.val() | self.cutting.val().any() | self.had_cut_q.q.val();
        comment!("the axis that stops the group is not affected;");
        self.any_cause.next = self.fault.val() | self.harmless.val().any() | self.group_stop.val();

        comment!("all others act a clock later, once set");
        self.harmful.next = self.now.val() & self.harmful_causes.val();
        self.cutting_now.next = self.now.val() & self.off.val();
        self.had_fault_q.d.next = self.harmful.val().any();
        self.had_cut_q.d.next = self.cutting_now.val().any();
        self.had_fault.next = self.had_fault_q.q.val();
        self.causes.next = self.causes_q.q.val();
    }
}
