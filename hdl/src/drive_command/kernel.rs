//! Selects the duty with one multiplexer, limits a manual duty of either sign with one comparison, and counts the
//! on-time of each gate that is tested.

use crate::prelude::*;
use posicast_blocks::axis::SupervisorState;

kernel! {
    pub(super) struct DriveCommand;
    ports posicast_blocks::drive_command_ports;

    registers {
        duty_q: Bits<17>, feed_q: Bit, pwm_enable_q: Bit, drive_enable_q: Bit, brake_release_q: Bit,
        axis_trip_n_q: Bit = true,
    }
    parts { drive_fault_pin: PinRegister }
    registers {
        active: Bit, expired: Bit, ticks: Bits<16>, hold_ticks: Bits<16>, backward: Bit, masked: Bit,
        high_was_on: Bits<1>, low_was_on: Bits<1>, high_clocks: Bits<16>, low_clocks: Bits<16>,
        high_result: Bits<16>, low_result: Bits<16>,
    }
    wires {
        permitted: Bit, last_tick: Bit, next_active: Bit, next_test: Bit, tested: Bit, test_changes: Bit,
        controller_bits: Bits<18>, direct_bits: Bits<17>, negative: Bit, direct_size: Bits<16>,
        bound: Bits<17>, unlimited: Bits<17>, saturates: Bit, taken: Bit, on_switch: Bit, turns: Bit,
        silent: Bit, odd: Bits<17>, twice_size: Bits<17>, limit: Bits<17>, counted: Bits<16>, more: Bits<16>,
        high_more: Bits<1>, low_more: Bits<1>, high_sum: Bits<16>, low_sum: Bits<16>,
    }
    constants {
        ready_state: Bits<3> = from_u64(SupervisorState::Ready as u64),
        no_ticks: Bits<16> = from_u64(0),
        one_tick: Bits<16> = from_u64(1),
        no_clock: Bits<16> = from_u64(0),
        not_on: Bits<1> = from_u64(0),
        nothing: Bits<17> = from_u64(0),
        most: Bits<17> = from_u64(0xffff),
        least: Bits<17> = from_u64(0x1_0000),
        one_bit: Bits<17> = from_u64(1),
        no_bit: Bits<17> = from_u64(0),
        both_faults: Bits<2> = from_u64(0),
        fault_of_drive: Bits<2> = from_u64(1),
        fault_of_axis: Bits<2> = from_u64(2),
        no_fault: Bits<2> = from_u64(3),
    }
}

impl Logic for DriveCommand {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module drive_command");

        comment!("Direct mode: in READY, from a kick, for a time");
        self.test_changes.next = self.active.q.val() & (self.self_test.val() ^ self.masked.q.val());
        self.permitted.next =
            (self.axis_state.val() == self.ready_state.val()) & self.direct_enable.val() & !self.test_changes.val();
        comment!("Ticks since the kick; bit 0 is stored inverted");
        self.counted.next = self.ticks.q.val() ^ self.one_tick.val();
        self.more.next = self.counted.val() + self.one_tick.val();
        self.last_tick.next = self.tick.val() & (self.counted.val() == self.hold_ticks.q.val());
        self.next_active.next = self.permitted.val() & self.active.q.val() & !self.last_tick.val();
        self.expired.d.next = self.permitted.val() & self.active.q.val() & self.last_tick.val();
        if self.tick.val() {
            self.ticks.d.next = self.more.val() ^ self.one_tick.val();
        }
        if self.direct_kick.val() {
            self.next_active.next = self.permitted.val() & self.direct_hold_ticks.val().any();
            self.expired.d.next = false;
            self.ticks.d.next = self.no_ticks.val();
            self.hold_ticks.d.next = self.direct_hold_ticks.val();
        }
        self.active.d.next = self.next_active.val();

        comment!("Self-test: pins masked, drive and brake off; the");
        comment!("mask stays on for a last clock with the PWM off");
        self.next_test.next = self.next_active.val() & self.self_test.val();
        self.tested.next = self.active.q.val() & self.masked.q.val();
        self.pwm_enable_q.d.next = (self.axis_pwm_enable.val() & !self.tested.val()) | self.next_active.val();
        self.drive_enable_q.d.next = (self.axis_drive_enable.val() | self.next_active.val()) & !self.next_test.val();
        self.brake_release_q.d.next = (self.axis_brake_release.val() | self.next_active.val()) & !self.next_test.val();
        self.masked.d.next = self.next_test.val() | self.tested.val();

        comment!("The controller's duty, saturated");
        self.controller_bits.next = unsigned_cast(self.controller_duty.val());
        self.direct_bits.next = unsigned_cast(self.direct_duty.val());
        self.taken.next = self.controller_valid.val();
        self.unlimited.next = self.controller_bits.val().get_bits::<17>(0);
        self.saturates.next = self.controller_bits.val().get_bit(17) ^ self.controller_bits.val().get_bit(16);
        self.bound.next = self.most.val();
        if self.controller_bits.val().get_bit(17) {
            self.bound.next = self.least.val();
        }

        comment!("Compare 2 * ~duty + 1 with 2 * limit: this saves the");
        comment!("carry chain of a negation");
        self.negative.next = self.direct_bits.val().get_bit(16);
        self.direct_size.next = self.direct_bits.val().get_bits::<16>(0);
        self.odd.next = self.no_bit.val();
        if self.negative.val() {
            self.direct_size.next = !self.direct_bits.val().get_bits::<16>(0);
            self.odd.next = self.one_bit.val();
        }
        self.twice_size.next = (bit_cast::<17, 16>(self.direct_size.val()) << 1) | self.odd.val();
        self.limit.next = bit_cast::<17, 16>(self.direct_limit.val());
        if self.active.q.val() {
            self.taken.next = self.tick.val();
            self.unlimited.next = self.direct_bits.val();
            self.saturates.next = self.twice_size.val() > (self.limit.val() << 1);
            self.bound.next = self.limit.val();
            if self.negative.val() {
                self.bound.next = self.nothing.val() - self.limit.val();
            }
        }
        self.feed_q.d.next = self.taken.val();
        if self.taken.val() {
            self.duty_q.d.next = self.unlimited.val();
            if self.saturates.val() {
                self.duty_q.d.next = self.bound.val();
            }
        }

        comment!("The duty is 0 while off, at a change of mode, for a");
        comment!("tick if its sign changes, and towards a limit switch");
        if self.tick.val() {
            self.backward.d.next = self.negative.val();
        }
        self.turns.next = self.tick.val() & (self.negative.val() ^ self.backward.q.val());
        self.on_switch.next = !self.limit_plus_ok.val();
        if self.backward.q.val() {
            self.on_switch.next = !self.limit_minus_ok.val();
        }
        self.silent.next = (!self.axis_pwm_enable.val() & !self.next_active.val())
            | (self.next_active.val() ^ self.active.q.val())
            | (self.active.q.val() & (self.turns.val() | self.on_switch.val()));
        if self.silent.val() {
            self.duty_q.d.next = self.nothing.val();
        }

        comment!("Faults: bit 0 the supervisor, bit 1 the drive");
        self.drive_fault_pin.pin.next = self.drive_fault_n.val();
        self.axis_trip_n_q.d.next = self.axis_pwm_trip_n.val();
        self.filtered_fault_n.next = self.both_faults.val();
        if self.axis_trip_n_q.q.val() {
            self.filtered_fault_n.next = self.fault_of_drive.val();
        }
        if self.drive_fault_pin.level.val() {
            self.filtered_fault_n.next = self.fault_of_axis.val();
            if self.axis_trip_n_q.q.val() {
                self.filtered_fault_n.next = self.no_fault.val();
            }
        }

        comment!("On-time of a gate in a period: at a valley the sum");
        comment!("is the result, and the counter is cleared");
        self.high_was_on.d.next = self.not_on.val();
        self.low_was_on.d.next = self.not_on.val();
        if self.masked.q.val() {
            self.high_was_on.d.next = self.gates.val().get_bits::<1>(0);
            self.low_was_on.d.next = self.gates.val().get_bits::<1>(1);
        }
        self.high_more.next = self.high_was_on.q.val();
        if self.high_clocks.q.val().all() {
            self.high_more.next = self.not_on.val();
        }
        self.low_more.next = self.low_was_on.q.val();
        if self.low_clocks.q.val().all() {
            self.low_more.next = self.not_on.val();
        }
        self.high_sum.next = self.high_clocks.q.val() + bit_cast::<16, 1>(self.high_more.val());
        self.low_sum.next = self.low_clocks.q.val() + bit_cast::<16, 1>(self.low_more.val());
        self.high_clocks.d.next = self.high_sum.val();
        self.low_clocks.d.next = self.low_sum.val();
        if self.valley.val() | !self.masked.q.val() {
            self.high_clocks.d.next = self.no_clock.val();
            self.low_clocks.d.next = self.no_clock.val();
        }
        if self.valley.val() & self.masked.q.val() {
            self.high_result.d.next = self.high_sum.val();
            self.low_result.d.next = self.low_sum.val();
        }

        comment!("Outputs");
        self.duty.next = signed_cast(self.duty_q.q.val());
        self.feed.next = self.feed_q.q.val();
        self.pwm_enable.next = self.pwm_enable_q.q.val();
        self.drive_enable.next = self.drive_enable_q.q.val();
        self.brake_release.next = self.brake_release_q.q.val();
        self.direct_active.next = self.active.q.val();
        self.direct_expired.next = self.expired.q.val();
        self.mask_pins.next = self.masked.q.val();
        self.self_test_high.next = self.high_result.q.val();
        self.self_test_low.next = self.low_result.q.val();
    }
}
