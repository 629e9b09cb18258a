//! Seeded random inputs for the linear scale: an axis that moves and a scale that follows it, at the configured ratio
//! or not; counts that wrap and ratios that saturate; ticks, velocities and aligns at every pace, also during a pass.
//! The tied inputs change in reset.

use posicast_blocks::linear_scale::{INPUT_PORTS, Inputs, OUTPUT_PORTS, Outputs, PASS_CLOCKS};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::lockstep::Clock;
use crate::stimuli::Stimuli;
use crate::stimuli::table::pick;

/// Mean number of clocks between resets, that is the life of a machine.
const LIFE_CLOCKS: u32 = 3_000;

/// Settings that hold from one reset to the next.
#[derive(Debug, Clone, Copy, Default)]
struct Life {
    mantissa: i64,
    shift: u64,
    use_scale: bool,
    /// Largest step of the motor per clock, in counts.
    step: i64,
    /// Whether the scale follows the motor.
    follows: bool,
    tick_pace: u32,
    velocity_pace: u32,
    align_pace: u32,
    velocity_bits: u32,
}

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct LinearScaleRandom {
    rng: Xoshiro256PlusPlus,
    clock: u64,
    life: Life,
    motor: i64,
    scale: i64,
}

impl LinearScaleRandom {
    /// Creates the generator. Equal seeds give equal inputs.
    pub fn new(seed: u64) -> Self {
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            clock: 0,
            life: Life::default(),
            motor: 0,
            scale: 0,
        }
    }

    fn new_life(&mut self) {
        let rng = &mut self.rng;
        let any: i64 = rng.random_range(-131_072..=131_071);
        let normal: i64 = rng.random_range(65_536..=131_071);
        let any_shift = rng.random_range(0..32);
        let pass = PASS_CLOCKS + 1;
        self.life = Life {
            mantissa: *pick(rng, &[any, normal, normal, -normal, 1, 0, -131_072, 131_071]),
            shift: *pick(rng, &[0, 1, 16, 17, 31, any_shift, any_shift]),
            use_scale: rng.random_range(0..3) != 0,
            step: *pick(rng, &[1, 40, 3000, 1 << 24]),
            follows: rng.random_range(0..2) == 0,
            tick_pace: *pick(rng, &[pass, pass - 1, pass + 1, 2 * pass, 2 * pass + 5, 30]),
            velocity_pace: *pick(rng, &[pass, pass - 1, pass + 1, 2 * pass, 2 * pass + 5, 30]),
            align_pace: *pick(rng, &[20, 300, 1_000_000]),
            velocity_bits: rng.random_range(1..=32),
        };
        self.motor = rng.next_u64() as i64;
        self.scale = rng.next_u64() as i64;
    }

    /// Moves the axis by one clock. A scale that follows has the ratio of the configured loop.
    fn moves(&mut self) {
        let life = self.life;
        let step = self.rng.random_range(-life.step..=life.step);
        let own = self.rng.random_range(-life.step..=life.step);
        let of_scale = match (life.follows, life.use_scale, life.mantissa) {
            (true, true, mantissa) => (step * mantissa) >> life.shift,
            (true, false, mantissa) if mantissa != 0 => (step << life.shift) / mantissa,
            _ => own,
        };
        // A life may begin at the end of the range.
        self.motor = self.motor.wrapping_add(step);
        self.scale = self.scale.wrapping_add(of_scale);
    }
}

impl Stimuli for LinearScaleRandom {
    fn fill(&mut self, _seen: &[u64], inputs: &mut [u64]) {
        let Ok(raw) = <&mut [u64; INPUT_PORTS]>::try_from(inputs) else {
            return;
        };
        let rst = self.clock < 2 || self.rng.random_range(0..LIFE_CLOCKS) == 0;
        if rst {
            self.new_life();
        }
        self.moves();
        let life = self.life;
        let mut once_in = |pace: u32| self.rng.random_range(0..pace) == 0;
        // Each event comes at its own pace, and now and then in between.
        let mut paced = |pace: u32| self.clock.is_multiple_of(pace.into()) | once_in(50 * pace);
        let (tick, velocity_valid) = (paced(life.tick_pace), paced(life.velocity_pace));
        let inputs = Inputs {
            rst,
            tick,
            motor_position: self.motor as i32,
            scale_position: self.scale as i32,
            motor_velocity: (self.rng.next_u64() as i64 >> (64 - life.velocity_bits)) as i32,
            velocity_valid,
            align: self.rng.random_range(0..life.align_pace) == 0,
            ratio_mantissa: life.mantissa as i32,
            ratio_shift: life.shift as u8,
            use_scale: life.use_scale,
        };
        *raw = inputs.to_raw();
        self.clock += 1;
    }
}

/// Names of the counted events.
const NAMES: [&str; 13] = [
    "resets",
    "deviations in scale counts",
    "deviations in motor counts",
    "deviations of 0 by align",
    "small deviations",
    "deviations at the upper end",
    "deviations at the lower end",
    "aligns between passes",
    "aligns in a pass of the positions",
    "ticks left out",
    "velocities that waited for positions",
    "velocities of the motor",
    "velocities scaled",
];

/// Counts of the events in a lockstep run of the linear scale.
#[derive(Debug, Clone, Copy, Default)]
pub struct LinearScaleCoverage {
    counts: [u64; NAMES.len()],
    /// Whether the deviation of an accepted tick is still being computed.
    computes: bool,
    asked: bool,
}

impl LinearScaleCoverage {
    /// Adds a clock.
    pub fn observe(&mut self, clock: &Clock<'_>) {
        let (Ok(inputs), Ok(shown)) = (
            <&[u64; INPUT_PORTS]>::try_from(clock.inputs),
            <&[u64; OUTPUT_PORTS]>::try_from(clock.expected),
        ) else {
            return;
        };
        let Inputs {
            rst,
            tick,
            velocity_valid,
            align,
            use_scale,
            ..
        } = Inputs::from_raw(inputs);
        let Outputs {
            deviation,
            deviation_valid,
            ..
        } = Outputs::from_raw(shown);
        let valid = deviation_valid && !rst;
        self.computes &= !valid && !rst;
        let taken = !rst && tick && !self.computes;
        let seen = [
            rst,
            valid && use_scale,
            valid && !use_scale,
            valid && deviation == 0 && self.asked,
            valid && deviation != 0 && deviation.unsigned_abs() < 100,
            valid && deviation == i32::MAX,
            valid && deviation == i32::MIN,
            !rst && align && !self.computes && !taken,
            !rst && align && self.computes,
            !rst && tick && self.computes,
            !rst && velocity_valid && self.computes && use_scale,
            !rst && velocity_valid && !use_scale,
            !rst && velocity_valid && !self.computes && use_scale,
        ];
        for (count, seen) in self.counts.iter_mut().zip(seen) {
            *count += u64::from(seen);
        }
        self.asked = !rst && (align || self.asked && !valid);
        self.computes |= taken;
    }

    /// Returns each event's name and count.
    pub fn counts(&self) -> [(&'static str, u64); NAMES.len()] {
        std::array::from_fn(|bin| (NAMES[bin], self.counts[bin]))
    }
}
