//! The supervisor's ports as raw bit patterns.

use super::kernel::Axis;
use crate::prelude::*;
use crate::simulation::Pins;

impl Pins for Axis {
    fn set_clk(&mut self, level: bool) {
        self.clk.next = level.into();
    }

    fn drive(&mut self, inputs: &[u64]) {
        let mut values = inputs.iter().copied();
        let mut word = || values.next().unwrap_or_default();
        self.rst.next = word() & 1 != 0;
        self.tick.next = word() & 1 != 0;
        self.emergency_stop_n.next = word() & 1 != 0;
        self.limit_plus_n.next = word() & 1 != 0;
        self.limit_minus_n.next = word() & 1 != 0;
        self.drive_ready.next = word() & 1 != 0;
        self.home.next = word() & 1 != 0;
        self.filter_clocks.next = from_u64(word());
        self.enable.next = word() & 1 != 0;
        self.start.next = word() & 1 != 0;
        self.stop.next = word() & 1 != 0;
        self.clear_faults.next = word() & 1 != 0;
        self.kick.next = word() & 1 != 0;
        self.kick_word.next = from_u64(word());
        self.group_stop.next = word() & 1 != 0;
        self.group_emergency_stop.next = word() & 1 != 0;
        self.off_causes.next = from_u64(word());
        self.brake_release_ticks.next = from_u64(word());
        self.brake_apply_ticks.next = from_u64(word());
        self.settle_ticks.next = from_u64(word());
        self.soft_limit_plus.next = from_i64(word() as i64);
        self.soft_limit_minus.next = from_i64(word() as i64);
        self.following_error_limit.next = from_u64(word());
        self.deviation_limit.next = from_u64(word());
        self.saturation_ticks.next = from_u64(word());
        self.lost_command.next = from_u64(word());
        self.lost_ticks.next = from_u64(word());
        self.velocity_drive.next = word() & 1 != 0;
        self.watchdog_ticks.next = from_u64(word());
        self.modulo.next = word() & 1 != 0;
        self.position.next = from_i64(word() as i64);
        self.deviation.next = from_i64(word() as i64);
        self.segments_state.next = from_u64(word());
        self.segments_empty.next = word() & 1 != 0;
        self.segments_valid.next = word() & 1 != 0;
        self.segments_underrun.next = word() & 1 != 0;
        self.segments_overflow.next = word() & 1 != 0;
        self.segments_tick_missed.next = word() & 1 != 0;
        self.segments_out_of_range.next = word() & 1 != 0;
        self.command_velocity.next = from_i64(word() as i64);
        self.reference_position.next = from_i64(word() as i64);
        self.reference_velocity.next = from_i64(word() as i64);
        self.shaper_saturated.next = word() & 1 != 0;
        self.shaper_overrun.next = word() & 1 != 0;
        self.error.next = from_i64(word() as i64);
        self.command.next = from_i64(word() as i64);
        self.limited_ticks.next = from_u64(word());
        self.saturated_high.next = from_u64(word());
        self.saturated_low.next = from_u64(word());
        self.controller_overrun.next = word() & 1 != 0;
        self.pwm_tripped.next = word() & 1 != 0;
        self.encoder_illegal.next = word() & 1 != 0;
        self.encoder_disagreement.next = word() & 1 != 0;
        self.velocity_missed.next = word() & 1 != 0;
        self.scale_illegal.next = word() & 1 != 0;
        self.scale_disagreement.next = word() & 1 != 0;
    }

    fn read(&self, outputs: &mut [u64]) {
        let shown: [u64; 29] = [
            self.state.val().into(),
            self.causes.val().into(),
            self.drive_enable.val().into(),
            self.brake_release.val().into(),
            self.pwm_enable.val().into(),
            self.pwm_trip_n.val().into(),
            self.segments_enable.val().into(),
            self.segments_preset.val().into(),
            self.segments_quick_stop.val().into(),
            self.segments_restart.val().into(),
            self.shaper_start.val().into(),
            self.clear_integral.val().into(),
            self.clear_sources.val().into(),
            self.wants_group_stop.val().into(),
            self.emergency_stop.val().into(),
            self.can_start.val().into(),
            unsigned_cast(self.captured_position.val()).into(),
            self.level_emergency_stop_n.val().into(),
            self.level_limit_plus_n.val().into(),
            self.level_limit_minus_n.val().into(),
            self.level_drive_ready.val().into(),
            self.level_home.val().into(),
            self.enabled.val().into(),
            self.started.val().into(),
            self.stopping.val().into(),
            self.halted.val().into(),
            self.disabled.val().into(),
            self.faulted.val().into(),
            self.refused.val().into(),
        ];
        for (output, value) in outputs.iter_mut().zip(shown) {
            *output = value;
        }
    }
}
