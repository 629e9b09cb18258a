//! The drive command's ports as raw bit patterns.

use super::kernel::DriveCommand;
use crate::prelude::*;
use crate::simulation::Pins;

impl Pins for DriveCommand {
    fn set_clk(&mut self, level: bool) {
        self.clk.next = level.into();
    }

    fn drive(&mut self, inputs: &[u64]) {
        let &[
            rst,
            tick,
            controller_duty,
            controller_valid,
            axis_state,
            axis_pwm_enable,
            axis_drive_enable,
            axis_brake_release,
            axis_pwm_trip_n,
            drive_fault_n,
            limit_plus_ok,
            limit_minus_ok,
            direct_enable,
            direct_kick,
            direct_hold_ticks,
            direct_duty,
            direct_limit,
            self_test,
            gates,
            valley,
        ] = inputs
        else {
            return;
        };
        let bit = |value: u64| value & 1 != 0;
        self.rst.next = bit(rst);
        self.tick.next = bit(tick);
        self.controller_duty.next = from_i64(controller_duty as i64);
        self.controller_valid.next = bit(controller_valid);
        self.axis_state.next = from_u64(axis_state);
        self.axis_pwm_enable.next = bit(axis_pwm_enable);
        self.axis_drive_enable.next = bit(axis_drive_enable);
        self.axis_brake_release.next = bit(axis_brake_release);
        self.axis_pwm_trip_n.next = bit(axis_pwm_trip_n);
        self.drive_fault_n.next = bit(drive_fault_n);
        self.limit_plus_ok.next = bit(limit_plus_ok);
        self.limit_minus_ok.next = bit(limit_minus_ok);
        self.direct_enable.next = bit(direct_enable);
        self.direct_kick.next = bit(direct_kick);
        self.direct_hold_ticks.next = from_u64(direct_hold_ticks);
        self.direct_duty.next = from_i64(direct_duty as i64);
        self.direct_limit.next = from_u64(direct_limit);
        self.self_test.next = bit(self_test);
        self.gates.next = from_u64(gates);
        self.valley.next = bit(valley);
    }

    fn read(&self, outputs: &mut [u64]) {
        let shown = [
            unsigned_cast(self.duty.val()).into(),
            u64::from(self.feed.val()),
            u64::from(self.pwm_enable.val()),
            u64::from(self.drive_enable.val()),
            u64::from(self.brake_release.val()),
            self.filtered_fault_n.val().into(),
            u64::from(self.direct_active.val()),
            u64::from(self.direct_expired.val()),
            u64::from(self.mask_pins.val()),
            self.self_test_high.val().into(),
            self.self_test_low.val().into(),
        ];
        for (output, value) in outputs.iter_mut().zip(shown) {
            *output = value;
        }
    }
}
