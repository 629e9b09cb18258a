//! Computes `a += j; v += a; p += v`, a quick stop, a point, a cubic and an extrapolation, byte by byte with one adder.
//!
//! Each register rotates past the adder, lowest byte first, as `passes` controls; the sum is written back. The outputs
//! are the rounded registers, taken when these do not rotate.

use super::passes::Passes;
use crate::prelude::*;

kernel! {
    pub(super) struct Integrator;

    inputs {
        rst: Bit,
        phase: Bits<6>,
        takes_tick: Bit,
        preset: Bit,
        brakes: Bit,
        moves: Bit,
        held: Bit,
        points: Bit,
        loads: Bit,
        short_jerk: Bit,
        extrapolates: Bit,
        modulo: Bit,
        preset_position: Signed<32>,
        stop_deceleration: Bits<31>,
        read_data: Bits<32>,
    }
    outputs {
        read_word: Bits<2>,
        position: Signed<32>,
        velocity: Signed<32>,
        acceleration: Signed<32>,
        at_rest: Bit,
        overflowed: Bit,
        leaves: Bit,
        entry_ends: Bit,
        ticks_after: Bits<8>,
        decides: Bit,
        reads_flags: Bit,
        ends: Bit,
    }
    parts { passes: Passes }
    registers {
        exact_position: Bits<56>, exact_velocity: Bits<48>, exact_acceleration: Bits<40>, ticks: Bits<24>,
        entry_half: Bits<16>, upper_byte: Bit, blank: Bit, carry: Bit, jerk_failed: Bit, speed_failed: Bit,
        moving: Bit, velocity_ends: Bit, acceleration_ends: Bit,
    }
    wires {
        entry_byte: Bits<8>, augend: Bits<8>, addend: Bits<8>, chosen: Bits<8>, wide_sum: Bits<10>,
        sum: Bits<8>, unfit: Bit, turned_sign: Bit, gathered: Bits<8>, shifted_addend: Bits<10>, backwards: Bit,
        below: Bit, outwards: Bit, past_reach: Bit, stands: Bit, upper_bits: Bits<6>, reach_bits: Bits<5>,
        stand_bit: Bit, starts_anew: Bit, preset_word: Bits<32>, preset_bits: Bits<24>, velocity_byte: Bits<8>,
        acceleration_byte: Bits<8>, deceleration: Bits<40>, position_sum: Bits<33>, velocity_sum: Bits<33>,
        acceleration_sum: Bits<33>, velocity_half: Bits<33>, acceleration_half: Bits<33>,
    }
    constants {
        nil: Bits<8> = from_u64(0),
        full_reach: Bits<5> = from_u64(31),
        no_reach: Bits<5> = from_u64(0),
        carry_in: Bits<10> = from_u64(1),
        half: Bits<33> = from_u64(1),
        no_half: Bits<33> = from_u64(0),
        no_position: Bits<56> = from_u64(0),
        no_velocity: Bits<48> = from_u64(0),
        no_acceleration: Bits<40> = from_u64(0),
        no_ticks: Bits<24> = from_u64(0),
    }
    connect {
        passes: phase, moves, held, points, loads, short_jerk, extrapolates;
        outputs from passes: decides, reads_flags, ends, read_word;
    }
}

impl Logic for Integrator {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module integrator");
        self.passes.jerk_failed.next = self.jerk_failed.q.val();
        self.passes.speed_failed.next = self.speed_failed.q.val();
        self.passes.moving.next = self.moving.q.val();

        comment!("A byte of the entry, selected in two steps, because");
        comment!("the output of a memory comes late in its clock");
        self.entry_half.d.next = self.read_data.val().get_bits::<16>(0);
        if self.passes.read_byte_1.val() {
            self.entry_half.d.next = self.read_data.val().get_bits::<16>(16);
        }
        self.upper_byte.d.next = self.passes.read_byte_0.val();
        self.blank.d.next = self.passes.blank.val();
        self.entry_byte.next = self.entry_half.q.val().get_bits::<8>(0);
        if self.upper_byte.q.val() {
            self.entry_byte.next = self.entry_half.q.val().get_bits::<8>(8);
        }
        if self.blank.q.val() {
            self.entry_byte.next = self.nil.val();
        }

        comment!("One adder of a byte");
        self.augend.next = self.exact_acceleration.q.val().get_bits::<8>(0);
        if self.passes.from_odd.val() {
            self.augend.next = self.exact_velocity.q.val().get_bits::<8>(0);
        }
        if self.passes.from_later.val() {
            self.augend.next = self.exact_position.q.val().get_bits::<8>(0);
            if self.passes.from_odd.val() {
                self.augend.next = self.ticks.q.val().get_bits::<8>(0);
            }
        }
        self.chosen.next = self.nil.val();
        if self.passes.add_acceleration.val() {
            self.chosen.next = self.exact_acceleration.q.val().get_bits::<8>(0);
        }
        if self.passes.add_velocity.val() {
            self.chosen.next = self.exact_velocity.q.val().get_bits::<8>(0);
        }
        self.gathered.next = self.chosen.val();
        if self.moves.val() {
            self.gathered.next = self.chosen.val() | self.entry_byte.val();
        }
        self.addend.next = self.gathered.val();
        if self.passes.invert.val() {
            self.addend.next = !self.gathered.val();
        }
        self.passes.addend_sign.next = self.addend.val().get_bit(7);
        self.shifted_addend.next = bit_cast::<10, 8>(self.addend.val()) << 1;
        self.wide_sum.next = ((bit_cast::<10, 8>(self.augend.val()) << 1) | self.carry_in.val())
            + self.shifted_addend.val().replace_bit(0, self.carry.q.val());
        self.sum.next = self.wide_sum.val().get_bits::<8>(1);
        self.backwards.next = self.exact_velocity.q.val().get_bit(47);
        comment!("Outwards in the last 32nd before an end of the word;");
        comment!("in the last 64th a stop is immediate");
        self.below.next = self.exact_position.q.val().get_bit(55);
        self.outwards.next = (self.backwards.val() == self.below.val()) & !self.modulo.val();
        self.upper_bits.next = self.exact_position.q.val().get_bits::<6>(49);
        self.reach_bits.next = self.upper_bits.val().get_bits::<5>(1);
        self.stand_bit.next = self.upper_bits.val().get_bit(0);
        self.past_reach.next = self.outwards.val() & (self.reach_bits.val() == self.full_reach.val());
        if self.below.val() {
            self.past_reach.next = self.outwards.val() & (self.reach_bits.val() == self.no_reach.val());
        }
        self.stands.next = self.past_reach.val() & (self.stand_bit.val() != self.below.val());
        self.carry.d.next = self.wide_sum.val().get_bit(9);
        if self.passes.first.val() {
            self.carry.d.next =
                self.passes.carry.val() | (self.brakes.val() & !self.backwards.val() & !self.stands.val());
        }

        comment!("Detect overflow, a change of sign, and motion");
        self.turned_sign.next = self.sum.val().get_bit(7) != self.augend.val().get_bit(7);
        self.unfit.next = self.turned_sign.val() & (self.augend.val().get_bit(7) == self.addend.val().get_bit(7));
        if self.passes.judges_jerk.val() {
            self.jerk_failed.d.next = self.unfit.val();
        }
        if self.passes.judges_speed.val() {
            if self.moves.val() {
                self.speed_failed.d.next = self.unfit.val();
            } else {
                self.speed_failed.d.next = self.turned_sign.val();
            }
        }
        if self.passes.sees_moving.val() & self.sum.val().any() {
            self.moving.d.next = true;
        }
        if self.passes.forgets_moving.val() {
            self.moving.d.next = false;
        }

        comment!("Acceleration; a stop sets it at the tick");
        self.deceleration.next = bit_cast::<40, 31>(self.stop_deceleration.val()) << 8;
        self.acceleration_byte.next = self.exact_acceleration.q.val().get_bits::<8>(0);
        if self.passes.write_acceleration.val() {
            self.acceleration_byte.next = self.sum.val();
        }
        if self.passes.turn_acceleration.val() {
            self.exact_acceleration.d.next =
                (self.exact_acceleration.q.val() >> 8) | (bit_cast::<40, 8>(self.acceleration_byte.val()) << 32);
        }
        if self.brakes.val() {
            if self.backwards.val() {
                self.exact_acceleration.d.next = self.deceleration.val();
            } else {
                self.exact_acceleration.d.next = !self.deceleration.val();
            }
        }
        self.starts_anew.next =
            self.takes_tick.val() & (self.loads.val() | self.extrapolates.val()) & !self.brakes.val();
        if self.preset.val()
            | self.starts_anew.val()
            | (self.brakes.val() & self.stands.val())
            | self.passes.clear_acceleration.val()
        {
            self.exact_acceleration.d.next = self.no_acceleration.val();
        }

        comment!("Velocity");
        self.velocity_byte.next = self.exact_velocity.q.val().get_bits::<8>(0);
        if self.passes.write_velocity.val() {
            self.velocity_byte.next = self.sum.val();
        }
        if self.passes.turn_velocity.val() {
            self.exact_velocity.d.next =
                (self.exact_velocity.q.val() >> 8) | (bit_cast::<48, 8>(self.velocity_byte.val()) << 40);
        }
        if self.preset.val() | self.passes.clear_velocity.val() {
            self.exact_velocity.d.next = self.no_velocity.val();
        }

        comment!("Position: bits above are never used");
        self.preset_word.next = unsigned_cast(self.preset_position.val());
        self.preset_bits.next = self.preset_word.val().get_bits::<24>(0);
        if self.passes.turn_position.val() {
            self.exact_position.d.next = (self.exact_position.q.val() >> 8) | (bit_cast::<56, 8>(self.sum.val()) << 48);
        }
        if self.preset.val() {
            self.exact_position.d.next = bit_cast::<56, 24>(self.preset_bits.val()) << 32;
        }
        if self.passes.clear_position.val() {
            self.exact_position.d.next = self.no_position.val();
        }

        comment!("Ticks of the entry, counting from -ticks up to 0");
        if self.passes.turn_ticks.val() {
            self.ticks.d.next = (self.ticks.q.val() >> 8) | (bit_cast::<24, 8>(self.sum.val()) << 16);
        }
        if self.passes.clear_ticks.val() {
            self.ticks.d.next = self.no_ticks.val();
        }

        comment!("Round each once, half up, without wrapping");
        self.velocity_half.next = self.half.val();
        if self.velocity_ends.q.val() {
            self.velocity_half.next = self.no_half.val();
        }
        self.acceleration_half.next = self.half.val();
        if self.acceleration_ends.q.val() {
            self.acceleration_half.next = self.no_half.val();
        }
        self.position_sum.next = self.exact_position.q.val().get_bits::<33>(23) + self.half.val();
        self.velocity_sum.next = self.exact_velocity.q.val().get_bits::<33>(15) + self.velocity_half.val();
        self.acceleration_sum.next = self.exact_acceleration.q.val().get_bits::<33>(7) + self.acceleration_half.val();
        self.velocity_ends.d.next =
            self.passes.sizes.val() & self.velocity_sum.val().get_bit(32) & !self.exact_velocity.q.val().get_bit(47);
        self.acceleration_ends.d.next = self.passes.sizes.val()
            & self.acceleration_sum.val().get_bit(32)
            & !self.exact_acceleration.q.val().get_bit(39);
        self.position.next = signed_cast(self.position_sum.val().get_bits::<32>(1));
        self.velocity.next = signed_cast(self.velocity_sum.val().get_bits::<32>(1));
        self.acceleration.next = signed_cast(self.acceleration_sum.val().get_bits::<32>(1));

        comment!("Results of the tick");
        self.at_rest.next = !self.moving.q.val();
        self.overflowed.next = self.passes.failed.val();
        self.leaves.next = self.past_reach.val() & self.moving.q.val();
        self.entry_ends.next = self.carry.q.val();
        comment!("Ticks since the end of the entry");
        self.ticks_after.next = self.ticks.q.val().get_bits::<8>(0);
    }
}
