//! `a += j; v += a; p += v`, a quick stop and a point, byte by byte on one adder.
//!
//! Each register turns past the adder, lowest byte first, as `passes` says; what is written is the sum. Outputs are rounded
//! from the registers at rest.

use super::passes::Passes;
use crate::prelude::*;

#[derive(LogicBlock)]
pub(super) struct Integrator {
    pub(super) clk: Signal<In, Clock>,
    pub(super) rst: Signal<In, Bit>,
    pub(super) phase: Signal<In, Bits<6>>,
    pub(super) takes_tick: Signal<In, Bit>,
    pub(super) preset: Signal<In, Bit>,
    pub(super) brakes: Signal<In, Bit>,
    pub(super) moves: Signal<In, Bit>,
    pub(super) held: Signal<In, Bit>,
    pub(super) points: Signal<In, Bit>,
    pub(super) modulo: Signal<In, Bit>,
    pub(super) preset_position: Signal<In, Signed<32>>,
    pub(super) stop_deceleration: Signal<In, Bits<31>>,
    pub(super) read_data: Signal<In, Bits<32>>,
    pub(super) read_word: Signal<Out, Bits<2>>,
    pub(super) position: Signal<Out, Signed<32>>,
    pub(super) velocity: Signal<Out, Signed<32>>,
    pub(super) acceleration: Signal<Out, Signed<32>>,
    pub(super) at_rest: Signal<Out, Bit>,
    pub(super) overflowed: Signal<Out, Bit>,
    pub(super) leaves: Signal<Out, Bit>,
    pub(super) entry_ends: Signal<Out, Bit>,
    pub(super) decides: Signal<Out, Bit>,
    pub(super) reads_flags: Signal<Out, Bit>,
    pub(super) ends: Signal<Out, Bit>,

    passes: Passes,

    exact_position: Dff<Bits<56>>,
    exact_velocity: Dff<Bits<48>>,
    exact_acceleration: Dff<Bits<40>>,
    ticks: Dff<Bits<24>>,
    entry_half: Dff<Bits<16>>,
    upper_byte: Dff<Bit>,
    blank: Dff<Bit>,
    carry: Dff<Bit>,
    jerk_failed: Dff<Bit>,
    speed_failed: Dff<Bit>,
    moving: Dff<Bit>,
    velocity_ends: Dff<Bit>,
    acceleration_ends: Dff<Bit>,

    entry_byte: Signal<Local, Bits<8>>,
    augend: Signal<Local, Bits<8>>,
    addend: Signal<Local, Bits<8>>,
    chosen: Signal<Local, Bits<8>>,
    wide_sum: Signal<Local, Bits<10>>,
    sum: Signal<Local, Bits<8>>,
    unfit: Signal<Local, Bit>,
    turned_sign: Signal<Local, Bit>,
    gathered: Signal<Local, Bits<8>>,
    shifted_addend: Signal<Local, Bits<10>>,
    backwards: Signal<Local, Bit>,
    below: Signal<Local, Bit>,
    outwards: Signal<Local, Bit>,
    past_reach: Signal<Local, Bit>,
    stands: Signal<Local, Bit>,
    upper_bits: Signal<Local, Bits<6>>,
    reach_bits: Signal<Local, Bits<5>>,
    stand_bit: Signal<Local, Bit>,
    starts_point: Signal<Local, Bit>,
    preset_word: Signal<Local, Bits<32>>,
    preset_bits: Signal<Local, Bits<24>>,
    velocity_byte: Signal<Local, Bits<8>>,
    acceleration_byte: Signal<Local, Bits<8>>,
    deceleration: Signal<Local, Bits<40>>,
    position_sum: Signal<Local, Bits<33>>,
    velocity_sum: Signal<Local, Bits<33>>,
    acceleration_sum: Signal<Local, Bits<33>>,
    velocity_half: Signal<Local, Bits<33>>,
    acceleration_half: Signal<Local, Bits<33>>,

    nil: Constant<Bits<8>>,
    full_reach: Constant<Bits<5>>,
    no_reach: Constant<Bits<5>>,
    carry_in: Constant<Bits<10>>,
    half: Constant<Bits<33>>,
    no_half: Constant<Bits<33>>,
    no_position: Constant<Bits<56>>,
    no_velocity: Constant<Bits<48>>,
    no_acceleration: Constant<Bits<40>>,
    no_ticks: Constant<Bits<24>>,
}

impl Default for Integrator {
    fn default() -> Self {
        Self {
            clk: Signal::default(),
            rst: Signal::default(),
            phase: Signal::default(),
            takes_tick: Signal::default(),
            preset: Signal::default(),
            brakes: Signal::default(),
            moves: Signal::default(),
            held: Signal::default(),
            points: Signal::default(),
            modulo: Signal::default(),
            preset_position: Signal::default(),
            stop_deceleration: Signal::default(),
            read_data: Signal::default(),
            read_word: Signal::default(),
            position: Signal::default(),
            velocity: Signal::default(),
            acceleration: Signal::default(),
            at_rest: Signal::default(),
            overflowed: Signal::default(),
            leaves: Signal::default(),
            entry_ends: Signal::default(),
            decides: Signal::default(),
            reads_flags: Signal::default(),
            ends: Signal::default(),
            passes: Passes::default(),
            exact_position: Dff::default(),
            exact_velocity: Dff::default(),
            exact_acceleration: Dff::default(),
            ticks: Dff::default(),
            entry_half: Dff::default(),
            upper_byte: Dff::default(),
            blank: Dff::default(),
            carry: Dff::default(),
            jerk_failed: Dff::default(),
            speed_failed: Dff::default(),
            moving: Dff::default(),
            velocity_ends: Dff::default(),
            acceleration_ends: Dff::default(),
            entry_byte: Signal::default(),
            augend: Signal::default(),
            addend: Signal::default(),
            chosen: Signal::default(),
            wide_sum: Signal::default(),
            sum: Signal::default(),
            unfit: Signal::default(),
            turned_sign: Signal::default(),
            gathered: Signal::default(),
            shifted_addend: Signal::default(),
            backwards: Signal::default(),
            below: Signal::default(),
            outwards: Signal::default(),
            past_reach: Signal::default(),
            stands: Signal::default(),
            upper_bits: Signal::default(),
            reach_bits: Signal::default(),
            stand_bit: Signal::default(),
            starts_point: Signal::default(),
            preset_word: Signal::default(),
            preset_bits: Signal::default(),
            velocity_byte: Signal::default(),
            acceleration_byte: Signal::default(),
            deceleration: Signal::default(),
            position_sum: Signal::default(),
            velocity_sum: Signal::default(),
            acceleration_sum: Signal::default(),
            velocity_half: Signal::default(),
            acceleration_half: Signal::default(),
            nil: Constant::new(from_u64(0)),
            full_reach: Constant::new(from_u64(31)),
            no_reach: Constant::new(from_u64(0)),
            carry_in: Constant::new(from_u64(1)),
            half: Constant::new(from_u64(1)),
            no_half: Constant::new(from_u64(0)),
            no_position: Constant::new(from_u64(0)),
            no_velocity: Constant::new(from_u64(0)),
            no_acceleration: Constant::new(from_u64(0)),
            no_ticks: Constant::new(from_u64(0)),
        }
    }
}

impl Logic for Integrator {
    #[hdl_gen]
    fn update(&mut self) {
        comment!("@module integrator");
        dff_setup!(
            self,
            clk,
            exact_position,
            exact_velocity,
            exact_acceleration,
            ticks,
            entry_half,
            upper_byte,
            blank,
            carry,
            jerk_failed,
            speed_failed,
            moving,
            velocity_ends,
            acceleration_ends
        );
        self.passes.clk.next = self.clk.val();
        self.passes.rst.next = self.rst.val();
        self.passes.phase.next = self.phase.val();
        self.passes.moves.next = self.moves.val();
        self.passes.held.next = self.held.val();
        self.passes.points.next = self.points.val();
        self.passes.jerk_failed.next = self.jerk_failed.q.val();
        self.passes.speed_failed.next = self.speed_failed.q.val();
        self.passes.moving.next = self.moving.q.val();

        comment!("A byte of the entry: half a word first, since");
        comment!("what a memory shows comes late in its clock");
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
        comment!("In the last 32nd before an end of the word, and");
        comment!("outwards; in the last 64th a stop stands at once");
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

        comment!("Beyond the end; a change of sign; any motion");
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

        comment!("Acceleration: a stop's begins at its tick");
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
        self.starts_point.next = self.takes_tick.val() & self.points.val() & !self.brakes.val();
        if self.preset.val()
            | self.starts_point.val()
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

        comment!("Position: what is above is never seen");
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

        comment!("Ticks of the entry: up to 0, from -ticks");
        if self.passes.turn_ticks.val() {
            self.ticks.d.next = (self.ticks.q.val() >> 8) | (bit_cast::<24, 8>(self.sum.val()) << 16);
        }
        if self.passes.clear_ticks.val() {
            self.ticks.d.next = self.no_ticks.val();
        }

        comment!("Each rounded once, half up, without wrapping");
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

        comment!("What comes of the tick");
        self.at_rest.next = !self.moving.q.val();
        self.overflowed.next = self.passes.failed.val();
        self.leaves.next = self.past_reach.val() & self.moving.q.val();
        self.entry_ends.next = self.carry.q.val();
        self.decides.next = self.passes.decides.val();
        self.reads_flags.next = self.passes.reads_flags.val();
        self.ends.next = self.passes.ends.val();
        self.read_word.next = self.passes.read_word.val();
    }
}
