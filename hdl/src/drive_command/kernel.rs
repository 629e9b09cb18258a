//! One multiplexer for both duties, one comparison for both signs of the manual one, a counter per gate that is tested.

use crate::prelude::*;
use posicast_model::rtl::axis::State;

#[derive(LogicBlock)]
pub(super) struct DriveCommand {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) tick: Signal<In, Bit>,
    pub(super) controller_duty: Signal<In, Signed<18>>,
    pub(super) controller_valid: Signal<In, Bit>,
    pub(super) axis_state: Signal<In, Bits<3>>,
    pub(super) axis_pwm_enable: Signal<In, Bit>,
    pub(super) axis_drive_enable: Signal<In, Bit>,
    pub(super) axis_brake_release: Signal<In, Bit>,
    pub(super) axis_pwm_trip_n: Signal<In, Bit>,
    pub(super) drive_fault_n: Signal<In, Bit>,
    pub(super) limit_plus_ok: Signal<In, Bit>,
    pub(super) limit_minus_ok: Signal<In, Bit>,
    pub(super) direct_enable: Signal<In, Bit>,
    pub(super) direct_kick: Signal<In, Bit>,
    pub(super) direct_hold_ticks: Signal<In, Bits<16>>,
    pub(super) direct_duty: Signal<In, Signed<17>>,
    pub(super) direct_limit: Signal<In, Bits<16>>,
    pub(super) self_test: Signal<In, Bit>,
    pub(super) gates: Signal<In, Bits<4>>,
    pub(super) valley: Signal<In, Bit>,
    pub(super) duty: Signal<Out, Signed<17>>,
    pub(super) feed: Signal<Out, Bit>,
    pub(super) pwm_enable: Signal<Out, Bit>,
    pub(super) drive_enable: Signal<Out, Bit>,
    pub(super) brake_release: Signal<Out, Bit>,
    pub(super) filtered_fault_n: Signal<Out, Bits<2>>,
    pub(super) direct_active: Signal<Out, Bit>,
    pub(super) direct_expired: Signal<Out, Bit>,
    pub(super) mask_pins: Signal<Out, Bit>,
    pub(super) self_test_high: Signal<Out, Bits<16>>,
    pub(super) self_test_low: Signal<Out, Bits<16>>,

    duty_q: Dff<Bits<17>>,
    feed_q: Dff<Bit>,
    pwm_enable_q: Dff<Bit>,
    drive_enable_q: Dff<Bit>,
    brake_release_q: Dff<Bit>,
    axis_trip_n_q: Dff<Bit>,
    drive_fault_pin: PinRegister,
    active: Dff<Bit>,
    expired: Dff<Bit>,
    ticks: Dff<Bits<16>>,
    hold_ticks: Dff<Bits<16>>,
    backward: Dff<Bit>,
    masked: Dff<Bit>,
    high_was_on: Dff<Bits<1>>,
    low_was_on: Dff<Bits<1>>,
    high_clocks: Dff<Bits<16>>,
    low_clocks: Dff<Bits<16>>,
    high_result: Dff<Bits<16>>,
    low_result: Dff<Bits<16>>,

    permitted: Signal<Local, Bit>,
    last_tick: Signal<Local, Bit>,
    next_active: Signal<Local, Bit>,
    next_test: Signal<Local, Bit>,
    tested: Signal<Local, Bit>,
    test_changes: Signal<Local, Bit>,
    controller_bits: Signal<Local, Bits<18>>,
    direct_bits: Signal<Local, Bits<17>>,
    negative: Signal<Local, Bit>,
    direct_size: Signal<Local, Bits<16>>,
    bound: Signal<Local, Bits<17>>,
    unlimited: Signal<Local, Bits<17>>,
    saturates: Signal<Local, Bit>,
    taken: Signal<Local, Bit>,
    on_switch: Signal<Local, Bit>,
    turns: Signal<Local, Bit>,
    silent: Signal<Local, Bit>,
    odd: Signal<Local, Bits<17>>,
    twice_size: Signal<Local, Bits<17>>,
    limit: Signal<Local, Bits<17>>,
    counted: Signal<Local, Bits<16>>,
    more: Signal<Local, Bits<16>>,
    high_more: Signal<Local, Bits<1>>,
    low_more: Signal<Local, Bits<1>>,
    high_sum: Signal<Local, Bits<16>>,
    low_sum: Signal<Local, Bits<16>>,

    ready_state: Constant<Bits<3>>,
    no_ticks: Constant<Bits<16>>,
    one_tick: Constant<Bits<16>>,
    no_clock: Constant<Bits<16>>,
    not_on: Constant<Bits<1>>,
    nothing: Constant<Bits<17>>,
    most: Constant<Bits<17>>,
    least: Constant<Bits<17>>,
    one_bit: Constant<Bits<17>>,
    no_bit: Constant<Bits<17>>,
    both_faults: Constant<Bits<2>>,
    fault_of_drive: Constant<Bits<2>>,
    fault_of_axis: Constant<Bits<2>>,
    no_fault: Constant<Bits<2>>,
}

impl Default for DriveCommand {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            tick: Signal::default(),
            controller_duty: Signal::default(),
            controller_valid: Signal::default(),
            axis_state: Signal::default(),
            axis_pwm_enable: Signal::default(),
            axis_drive_enable: Signal::default(),
            axis_brake_release: Signal::default(),
            axis_pwm_trip_n: Signal::default(),
            drive_fault_n: Signal::default(),
            limit_plus_ok: Signal::default(),
            limit_minus_ok: Signal::default(),
            direct_enable: Signal::default(),
            direct_kick: Signal::default(),
            direct_hold_ticks: Signal::default(),
            direct_duty: Signal::default(),
            direct_limit: Signal::default(),
            self_test: Signal::default(),
            gates: Signal::default(),
            valley: Signal::default(),
            duty: Signal::default(),
            feed: Signal::default(),
            pwm_enable: Signal::default(),
            drive_enable: Signal::default(),
            brake_release: Signal::default(),
            filtered_fault_n: Signal::default(),
            direct_active: Signal::default(),
            direct_expired: Signal::default(),
            mask_pins: Signal::default(),
            self_test_high: Signal::default(),
            self_test_low: Signal::default(),
            duty_q: Dff::default(),
            feed_q: Dff::default(),
            pwm_enable_q: Dff::default(),
            drive_enable_q: Dff::default(),
            brake_release_q: Dff::default(),
            axis_trip_n_q: Dff::new(true),
            drive_fault_pin: PinRegister::default(),
            active: Dff::default(),
            expired: Dff::default(),
            ticks: Dff::default(),
            hold_ticks: Dff::default(),
            backward: Dff::default(),
            masked: Dff::default(),
            high_was_on: Dff::default(),
            low_was_on: Dff::default(),
            high_clocks: Dff::default(),
            low_clocks: Dff::default(),
            high_result: Dff::default(),
            low_result: Dff::default(),
            permitted: Signal::default(),
            last_tick: Signal::default(),
            next_active: Signal::default(),
            next_test: Signal::default(),
            tested: Signal::default(),
            test_changes: Signal::default(),
            controller_bits: Signal::default(),
            direct_bits: Signal::default(),
            negative: Signal::default(),
            direct_size: Signal::default(),
            bound: Signal::default(),
            unlimited: Signal::default(),
            saturates: Signal::default(),
            taken: Signal::default(),
            on_switch: Signal::default(),
            turns: Signal::default(),
            silent: Signal::default(),
            odd: Signal::default(),
            twice_size: Signal::default(),
            limit: Signal::default(),
            counted: Signal::default(),
            more: Signal::default(),
            high_more: Signal::default(),
            low_more: Signal::default(),
            high_sum: Signal::default(),
            low_sum: Signal::default(),
            ready_state: Constant::new(from_u64(State::Ready as u64)),
            no_ticks: Constant::new(from_u64(0)),
            one_tick: Constant::new(from_u64(1)),
            no_clock: Constant::new(from_u64(0)),
            not_on: Constant::new(from_u64(0)),
            nothing: Constant::new(from_u64(0)),
            most: Constant::new(from_u64(0xffff)),
            least: Constant::new(from_u64(0x1_0000)),
            one_bit: Constant::new(from_u64(1)),
            no_bit: Constant::new(from_u64(0)),
            both_faults: Constant::new(from_u64(0)),
            fault_of_drive: Constant::new(from_u64(1)),
            fault_of_axis: Constant::new(from_u64(2)),
            no_fault: Constant::new(from_u64(3)),
        }
    }
}

impl Logic for DriveCommand {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module drive_command");
        dff_setup!(
            self,
            clk,
            duty_q,
            feed_q,
            pwm_enable_q,
            drive_enable_q,
            brake_release_q,
            axis_trip_n_q,
            active,
            expired,
            ticks,
            hold_ticks,
            backward,
            masked,
            high_was_on,
            low_was_on,
            high_clocks,
            low_clocks,
            high_result,
            low_result
        );

        comment!("Direct mode: in READY, from a kick, for a time");
        self.test_changes.next = self.active.q.val() & (self.self_test.val() ^ self.masked.q.val());
        self.permitted.next =
            (self.axis_state.val() == self.ready_state.val()) & self.direct_enable.val() & !self.test_changes.val();
        comment!("Ticks since the kick; bit 0 is kept inverted");
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
        comment!("mask stays for a clock with the PWM off");
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

        comment!("Manual: 2 size + 1 of a negative, no carry");
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

        comment!("Zero while off, at a change, for a tick where the");
        comment!("sign turns, and towards a limit switch");
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
        self.drive_fault_pin.clk.next = self.clk.val();
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

        comment!("Clocks of a gate in a period; the last clock's is");
        comment!("added as it is counted, so that a valley clears");
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
