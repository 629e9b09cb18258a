//! The PWM's ports as raw bit patterns.

use super::kernel::Pwm;
use crate::prelude::*;
use crate::simulation::Pins;

impl Pins for Pwm {
    fn set_clk(&mut self, level: bool) {
        self.clk.next = level.into();
    }

    fn drive(&mut self, inputs: &[u64]) {
        let &[
            rst,
            enable,
            mode,
            period,
            duty,
            max_duty,
            update_at_peak,
            dead_time,
            minimum_pulse,
            sync,
            phase,
            trigger_phase,
            feed,
            watchdog_periods,
            filter_clocks,
            fault_n,
            pll_locked,
            filtered_fault_n,
            clear_trip,
            clear_flags,
            mask_pins,
        ] = inputs
        else {
            return;
        };
        self.rst.next = rst & 1 != 0;
        self.enable.next = enable & 1 != 0;
        self.mode.next = from_u64(mode);
        self.period.next = from_u64(period);
        self.duty.next = from_i64(duty as i64);
        self.max_duty.next = from_u64(max_duty);
        self.update_at_peak.next = update_at_peak & 1 != 0;
        self.dead_time.next = from_u64(dead_time);
        self.minimum_pulse.next = from_u64(minimum_pulse);
        self.sync.next = sync & 1 != 0;
        self.phase.next = from_u64(phase);
        self.trigger_phase.next = from_u64(trigger_phase);
        self.feed.next = feed & 1 != 0;
        self.watchdog_periods.next = from_u64(watchdog_periods);
        self.filter_clocks.next = from_u64(filter_clocks);
        self.fault_n.next = fault_n & 1 != 0;
        self.pll_locked.next = pll_locked & 1 != 0;
        self.filtered_fault_n.next = from_u64(filtered_fault_n);
        self.clear_trip.next = clear_trip & 1 != 0;
        self.clear_flags.next = clear_flags & 1 != 0;
        self.mask_pins.next = mask_pins & 1 != 0;
    }

    fn read(&self, outputs: &mut [u64]) {
        let shown = [
            u64::from(self.a_high.val()),
            u64::from(self.a_low.val()),
            u64::from(self.b_high.val()),
            u64::from(self.b_low.val()),
            u64::from(self.running.val()),
            u64::from(self.tripped.val()),
            self.trip_causes.val().into(),
            u64::from(self.negative.val()),
            u64::from(self.valley.val()),
            u64::from(self.peak.val()),
            u64::from(self.trigger.val()),
            u64::from(self.saturated.val()),
            u64::from(self.refused.val()),
            u64::from(self.below_floor.val()),
            u64::from(self.unaligned.val()),
            self.dead_time_used.val().into(),
            self.minimum_pulse_used.val().into(),
            self.gates.val().into(),
        ];
        for (output, value) in outputs.iter_mut().zip(shown) {
            *output = value;
        }
    }
}
