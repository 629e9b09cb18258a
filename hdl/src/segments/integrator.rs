//! `a += j; v += a; p += v`, one sum per clock; a quick stop; a point.
//!
//! ```text
//! clock         1   2   3   4
//! accelerate   ‾‾‾\___________
//! speed_up     ____/‾‾‾\_______
//! travel       ________/‾‾‾\___
//! position     --as before-< p     rounded: combinational from the exact registers
//! ```

use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct Integrator {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) accelerate: Signal<In, Bit>,
    pub(super) speed_up: Signal<In, Bit>,
    pub(super) travel: Signal<In, Bit>,
    pub(super) play: Signal<In, Bit>,
    pub(super) point: Signal<In, Bit>,
    pub(super) stop: Signal<In, Bit>,
    pub(super) preset: Signal<In, Bit>,
    pub(super) preset_position: Signal<In, Signed<32>>,
    pub(super) first: Signal<In, Bits<32>>,
    pub(super) second: Signal<In, Bits<32>>,
    pub(super) third: Signal<In, Bits<32>>,
    pub(super) stop_deceleration: Signal<In, Bits<31>>,
    pub(super) position: Signal<Out, Signed<32>>,
    pub(super) velocity: Signal<Out, Signed<32>>,
    pub(super) acceleration: Signal<Out, Signed<32>>,
    pub(super) at_rest: Signal<Out, Bit>,
    pub(super) overflowed: Signal<Out, Bit>,

    exact_position: Dff<Bits<64>>,
    exact_velocity: Dff<Signed<48>>,
    exact_acceleration: Dff<Signed<40>>,
    failed: Dff<Bit>,
    at_once: Dff<Bit>,
    deceleration: Dff<Bits<31>>,
    reverse: Dff<Signed<49>>,
    exceeds: Dff<Bit>,
    falls_below: Dff<Bit>,
    rests: Dff<Bit>,

    jerk_bits: Signal<Local, Bits<40>>,
    jerk: Signal<Local, Signed<40>>,
    wide_jerk: Signal<Local, Signed<41>>,
    wide_acceleration: Signal<Local, Signed<41>>,
    next_acceleration: Signal<Local, Signed<41>>,
    next_acceleration_bits: Signal<Local, Bits<41>>,
    asked_bits: Signal<Local, Bits<49>>,
    asked: Signal<Local, Signed<49>>,
    most_bits: Signal<Local, Bits<49>>,
    most: Signal<Local, Signed<49>>,
    least: Signal<Local, Signed<49>>,
    speed: Signal<Local, Signed<49>>,
    braking: Signal<Local, Signed<40>>,
    acceleration_step: Signal<Local, Signed<49>>,
    next_velocity: Signal<Local, Signed<49>>,
    next_velocity_bits: Signal<Local, Bits<49>>,
    velocity_step: Signal<Local, Signed<64>>,
    point_position: Signal<Local, Signed<56>>,
    wide_point: Signal<Local, Signed<64>>,
    position_sum: Signal<Local, Bits<64>>,
    velocity_sum: Signal<Local, Bits<48>>,
    acceleration_sum: Signal<Local, Bits<40>>,

    nil: Constant<Signed<49>>,
    rest_velocity: Constant<Signed<48>>,
    rest_acceleration: Constant<Signed<40>>,
    position_half: Constant<Bits<64>>,
    velocity_half: Constant<Bits<48>>,
    acceleration_half: Constant<Bits<40>>,
    largest: Constant<Signed<32>>,
}

impl Default for Integrator {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            accelerate: Signal::default(),
            speed_up: Signal::default(),
            travel: Signal::default(),
            play: Signal::default(),
            point: Signal::default(),
            stop: Signal::default(),
            preset: Signal::default(),
            preset_position: Signal::default(),
            first: Signal::default(),
            second: Signal::default(),
            third: Signal::default(),
            stop_deceleration: Signal::default(),
            position: Signal::default(),
            velocity: Signal::default(),
            acceleration: Signal::default(),
            at_rest: Signal::default(),
            overflowed: Signal::default(),
            exact_position: Dff::default(),
            exact_velocity: Dff::default(),
            exact_acceleration: Dff::default(),
            failed: Dff::default(),
            at_once: Dff::default(),
            deceleration: Dff::default(),
            reverse: Dff::default(),
            exceeds: Dff::default(),
            falls_below: Dff::default(),
            rests: Dff::default(),
            jerk_bits: Signal::default(),
            jerk: Signal::default(),
            wide_jerk: Signal::default(),
            wide_acceleration: Signal::default(),
            next_acceleration: Signal::default(),
            next_acceleration_bits: Signal::default(),
            asked_bits: Signal::default(),
            asked: Signal::default(),
            most_bits: Signal::default(),
            most: Signal::default(),
            least: Signal::default(),
            speed: Signal::default(),
            braking: Signal::default(),
            acceleration_step: Signal::default(),
            next_velocity: Signal::default(),
            next_velocity_bits: Signal::default(),
            velocity_step: Signal::default(),
            point_position: Signal::default(),
            wide_point: Signal::default(),
            position_sum: Signal::default(),
            velocity_sum: Signal::default(),
            acceleration_sum: Signal::default(),
            nil: Constant::new(from_i64(0)),
            rest_velocity: Constant::new(from_i64(0)),
            rest_acceleration: Constant::new(from_i64(0)),
            position_half: Constant::new(from_u64(1 << 23)),
            velocity_half: Constant::new(from_u64(1 << 15)),
            acceleration_half: Constant::new(from_u64(1 << 7)),
            largest: Constant::new(from_i64(i64::from(i32::MAX))),
        }
    }
}

impl Logic for Integrator {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module integrator");
        comment!("@about a += j; v += a; p += v: exact, one sum");
        comment!("@about per clock, in 2^-32 counts.");
        dff_setup!(
            self,
            clk,
            exact_position,
            exact_velocity,
            exact_acceleration,
            failed,
            at_once,
            deceleration,
            reverse,
            exceeds,
            falls_below,
            rests
        );

        comment!("Acceleration: plus the jerk, or against v");
        self.jerk_bits.next =
            (bit_cast::<40, 8>(self.second.val().get_bits::<8>(0)) << 32) | bit_cast::<40, 32>(self.first.val());
        self.jerk.next = signed_cast(self.jerk_bits.val());
        self.wide_jerk.next = signed_bit_cast::<41, 40>(self.jerk.val());
        self.wide_acceleration.next = signed_bit_cast::<41, 40>(self.exact_acceleration.q.val());
        self.next_acceleration.next = self.wide_acceleration.val() + self.wide_jerk.val();
        self.next_acceleration_bits.next = unsigned_cast(self.next_acceleration.val());
        self.speed.next = signed_bit_cast::<49, 48>(self.exact_velocity.q.val());
        comment!("-v, and compared: ready before the next tick");
        self.reverse.d.next = self.nil.val() - self.speed.val();
        self.deceleration.d.next = self.stop_deceleration.val();
        self.asked_bits.next = bit_cast::<49, 31>(self.stop_deceleration.val()) << 8;
        self.asked.next = signed_cast(self.asked_bits.val());
        self.exceeds.d.next = self.reverse.q.val() > self.asked.val();
        self.falls_below.d.next = self.speed.val() > self.asked.val();
        self.most_bits.next = bit_cast::<49, 31>(self.deceleration.q.val()) << 8;
        self.most.next = signed_cast(self.most_bits.val());
        self.least.next = self.nil.val() - self.most.val();
        self.braking.next = signed_bit_cast::<40, 49>(self.reverse.q.val());
        if self.exceeds.q.val() {
            self.braking.next = signed_bit_cast::<40, 49>(self.most.val());
        }
        if self.falls_below.q.val() {
            self.braking.next = signed_bit_cast::<40, 49>(self.least.val());
        }
        if self.accelerate.val() {
            self.failed.d.next = false;
            self.at_once.d.next = !self.deceleration.q.val().any();
            if self.play.val() {
                if self.point.val() {
                    self.exact_acceleration.d.next = signed_cast(bit_cast::<40, 32>(self.third.val()) << 8);
                } else {
                    if self.next_acceleration_bits.val().get_bit(40) == self.next_acceleration_bits.val().get_bit(39) {
                        self.exact_acceleration.d.next = signed_bit_cast::<40, 41>(self.next_acceleration.val());
                    } else {
                        self.failed.d.next = true;
                    }
                }
            }
            if self.stop.val() {
                self.exact_acceleration.d.next = self.braking.val();
            }
        }

        comment!("Velocity");
        self.acceleration_step.next = signed_bit_cast::<49, 40>(self.exact_acceleration.q.val());
        self.next_velocity.next = self.speed.val() + self.acceleration_step.val();
        self.next_velocity_bits.next = unsigned_cast(self.next_velocity.val());
        if self.speed_up.val() {
            if self.play.val() & self.point.val() {
                self.exact_velocity.d.next = signed_cast(bit_cast::<48, 32>(self.second.val()) << 16);
            } else {
                if self.next_velocity_bits.val().get_bit(48) != self.next_velocity_bits.val().get_bit(47) {
                    self.failed.d.next = true;
                } else {
                    if !self.failed.q.val() {
                        self.exact_velocity.d.next = signed_bit_cast::<48, 49>(self.next_velocity.val());
                    }
                }
            }
            if self.stop.val() & self.at_once.q.val() {
                self.exact_velocity.d.next = self.rest_velocity.val();
            }
        }

        comment!("Position");
        self.velocity_step.next = signed_bit_cast::<64, 48>(self.exact_velocity.q.val());
        self.point_position.next = signed_cast(bit_cast::<56, 32>(self.first.val()) << 24);
        self.wide_point.next = signed_bit_cast::<64, 56>(self.point_position.val());
        if self.travel.val() {
            if self.play.val() & self.point.val() {
                self.exact_position.d.next = unsigned_cast(self.wide_point.val());
            } else {
                if !self.failed.q.val() {
                    self.exact_position.d.next = self.exact_position.q.val() + unsigned_cast(self.velocity_step.val());
                }
            }
        }
        if self.preset.val() {
            self.exact_position.d.next = bit_cast::<64, 32>(unsigned_cast(self.preset_position.val())) << 32;
            self.exact_velocity.d.next = self.rest_velocity.val();
            self.exact_acceleration.d.next = self.rest_acceleration.val();
        }

        comment!("Each rounded once, half up, without wrapping");
        self.position_sum.next = self.exact_position.q.val() + self.position_half.val();
        self.position.next = signed_cast(self.position_sum.val().get_bits::<32>(24));
        self.velocity_sum.next = unsigned_cast(self.exact_velocity.q.val()) + self.velocity_half.val();
        self.velocity.next = signed_cast(self.velocity_sum.val().get_bits::<32>(16));
        if self.velocity_sum.val().get_bit(47) & !self.exact_velocity.q.val().get_bit(47) {
            self.velocity.next = self.largest.val();
        }
        self.acceleration_sum.next = unsigned_cast(self.exact_acceleration.q.val()) + self.acceleration_half.val();
        self.acceleration.next = signed_cast(self.acceleration_sum.val().get_bits::<32>(8));
        if self.acceleration_sum.val().get_bit(39) & !self.exact_acceleration.q.val().get_bit(39) {
            self.acceleration.next = self.largest.val();
        }
        self.rests.d.next = (self.exact_velocity.q.val() == self.rest_velocity.val())
            & (self.exact_acceleration.q.val() == self.rest_acceleration.val());
        self.at_rest.next = self.rests.q.val();
        self.overflowed.next = self.failed.q.val();
    }
}
