//! Seeded random inputs for the controller: first the integral is wound up to both its ends, then everything is
//! random: motion of every size and at the ends of each word, gains of every size, arbitrary settings, laws that
//! change at any tick, starts at the pace of a pass and in any clock, inputs that change during a pass, clears and
//! resets.

use posicast_blocks::sliding_mode::{CONTROL_CLOCKS, Inputs, SETTINGS, Saturation, SettingRow, TickMotion, ports};
use posicast_blocks::{Direction, Port};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::stimuli::Stimuli;
use crate::stimuli::table::pick;

/// Number of ticks of the largest e until the integral is at an end: from 0, and from the other end.
const WIND_UP_TICKS: [u64; 2] = [260, 520];
/// Address of the limit; the other settings are gains.
const LIMIT: usize = SettingRow::Limit as usize;
/// Value of `law` with an integral.
const PID: u8 = 2;

/// An endless random mixture of all inputs.
#[derive(Debug, Clone)]
pub struct SlidingModeRandom {
    rng: Xoshiro256PlusPlus,
    inputs: Inputs,
    settings: [u32; SETTINGS],
    clock: u64,
    starts: u64,
}

impl SlidingModeRandom {
    /// Number of clocks in which the integral is wound up.
    pub const WIND_UP_CLOCKS: u64 = (WIND_UP_TICKS[0] + WIND_UP_TICKS[1]) * (CONTROL_CLOCKS as u64 + 1);

    /// Creates the generator. Equal seeds give equal inputs for equal outputs.
    pub fn new(seed: u64) -> Self {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        Self {
            inputs: Inputs::default(),
            // A memory that nobody has written holds arbitrary words.
            settings: std::array::from_fn(|_| rng.next_u32()),
            rng,
            clock: 0,
            starts: 0,
        }
    }

    /// Creates a generator without the ticks that wind the integral up: everything is random from the first clock.
    pub fn without_wind_up(seed: u64) -> Self {
        Self {
            starts: WIND_UP_TICKS[0] + WIND_UP_TICKS[1],
            ..Self::new(seed)
        }
    }

    fn one_in(&mut self, clocks: u32) -> bool {
        self.rng.random_range(0..clocks) == 0
    }

    /// Returns a word of any size, often at an end.
    fn word(&mut self) -> i32 {
        let sized = self.rng.next_u32() as i32 >> self.rng.random_range(0..32);
        *pick(
            &mut self.rng,
            &[sized, sized, sized, sized, 0, 1, -1, i32::MIN, i32::MAX],
        )
    }

    fn any_setting(&mut self, address: usize) -> u32 {
        let word = self.word() as u32;
        if address == LIMIT {
            return word;
        }
        let shift = self.rng.random_range(0..32u32);
        (word & 0x3_ffff) | shift << 18 | (self.rng.next_u32() & 0xff80_0000)
    }

    /// Draws references and measurements: unrelated, close to each other, or just at the end of e and de.
    fn motion(&mut self) -> TickMotion {
        let (position, velocity) = (self.word(), self.word());
        let near = self.word() >> self.rng.random_range(0..24);
        let edge = *pick(&mut self.rng, &[1 << 23, -(1 << 23), 0]) + self.rng.random_range(-2..=2);
        let offset = *pick(&mut self.rng, &[near, edge]);
        let rate = *pick(&mut self.rng, &[near, i32::MAX, i32::MIN]);
        let mut motion = TickMotion {
            position_reference: position.wrapping_mul(256).wrapping_add(offset),
            velocity_reference: velocity.wrapping_add(rate).wrapping_add(self.rng.random_range(-2..=2)),
            acceleration_reference: self.word(),
            position,
            velocity,
        };
        if self.one_in(4) {
            motion.position_reference = self.word();
            motion.velocity_reference = self.word();
        }
        if self.one_in(3) {
            // Below 2^23 counts, e is the plain difference.
            motion.position >>= 9;
        }
        motion
    }

    /// Draws the inputs that change from tick to tick.
    fn tick(&mut self) {
        self.starts += 1;
        self.inputs.law = self.rng.random_range(0..4);
        self.inputs.modulo = self.one_in(3);
        let motion = self.motion();
        self.inputs.set_motion(motion);
        if self.one_in(3) {
            self.settings = std::array::from_fn(|address| self.any_setting(address));
            // Some commands exceed the limit.
            self.settings[LIMIT] >>= self.rng.random_range(0..16);
        }
        // With gains of one, an input at an end gives an output at an end.
        if self.one_in(4) {
            let row = self.rng.random_range(0..SETTINGS);
            self.settings[row] = 0x1_ffff | self.rng.random_range(0..18) << 18;
        }
    }

    /// Applies the largest e of one sign with half the integral as the command, so that the integral reaches its ends and
    /// the command is not limited.
    fn wind_up(&mut self) {
        self.starts += 1;
        let high = self.starts <= WIND_UP_TICKS[0];
        self.settings = [0; SETTINGS];
        self.settings[SettingRow::Integral as usize] = 1;
        self.settings[SettingRow::Feedback as usize] = 1 | 1 << 18;
        self.settings[LIMIT] = u32::MAX;
        self.inputs = Inputs {
            law: PID,
            position_reference: if high { i32::MAX } else { i32::MIN },
            ..Inputs::default()
        };
    }
}

impl Stimuli for SlidingModeRandom {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        let (address, busy) = (seen.first().copied(), seen.get(6).copied());
        let wound_up = self.starts >= WIND_UP_TICKS[0] + WIND_UP_TICKS[1];
        self.inputs.start = busy == Some(0) && self.clock > 3 && !self.inputs.start;
        self.inputs.rst = self.clock < 3;
        self.inputs.clear_flags = self.one_in(300);
        self.inputs.clear_integral = false;
        self.inputs.setting = self.settings[address.unwrap_or(0) as usize % SETTINGS];
        if wound_up {
            self.inputs.start &= !self.one_in(20);
            if self.inputs.start {
                self.tick();
            }
            self.inputs.start |= self.one_in(2000);
            self.inputs.rst |= self.one_in(30_000);
            // The clear often comes while the integral's next value is under way.
            let clears = if address == Some(LIMIT as u64) { 150 } else { 5000 };
            self.inputs.clear_integral = self.one_in(clears);
            if self.one_in(500) {
                let motion = self.motion();
                self.inputs.set_motion(motion);
            }
            // Any setting may change except the limit, which its step uses for some clocks.
            if self.one_in(300) && address != Some(LIMIT as u64) {
                self.inputs.setting = self.rng.next_u32();
            }
        } else if self.inputs.start {
            self.wind_up();
            self.inputs.start = true;
        }
        self.clock += 1;
        for (input, value) in inputs.iter_mut().zip(self.inputs.to_raw()) {
            *input = value;
        }
    }
}

/// Counts of the events in a lockstep run of the controller, by name.
#[derive(Debug, Clone)]
pub struct SlidingModeCoverage {
    outputs: Vec<String>,
    before: Vec<u64>,
    /// Number of times that each output changed.
    changed: Vec<u64>,
    /// Number of times that each flag of the upper and the lower side rose.
    rose: [[u64; 7]; 2],
    /// Number of passes with each value of `law`.
    laws: [u64; 4],
    modulo: u64,
    resets: u64,
    /// Number of limited outputs of the PID, with an e of either sign at either limit.
    against_limit: [u64; 4],
    law: usize,
}

impl Default for SlidingModeCoverage {
    fn default() -> Self {
        let is_output = |port: &Port| port.direction == Direction::Output;
        let outputs: Vec<String> = ports().into_iter().filter(is_output).map(|port| port.name).collect();
        Self {
            before: vec![0; outputs.len()],
            changed: vec![0; outputs.len()],
            outputs,
            rose: [[0; 7]; 2],
            laws: [0; 4],
            modulo: 0,
            resets: 0,
            against_limit: [0; 4],
            law: 0,
        }
    }
}

impl SlidingModeCoverage {
    /// Adds a clock, given its inputs and the model's outputs.
    pub fn observe(&mut self, inputs: &[u64], shown: &[u64]) {
        let (&[rst, start, law, modulo, ..], &[_, error, _, _, _, valid, busy, high, low, ..]) = (inputs, shown) else {
            return;
        };
        self.resets += rst;
        if start != 0 && busy == 0 && rst == 0 {
            self.law = law as usize & 3;
            self.laws[self.law] += 1;
            self.modulo += modulo;
        } else if valid != 0 && self.law == usize::from(PID) && high + low != 0 {
            self.against_limit[(error >> 31) as usize & 1 | (low as usize) << 1] += 1;
        }
        for (side, rose) in self.rose.iter_mut().enumerate() {
            let new = shown[10 + side] & !self.before[10 + side];
            for (bit, count) in rose.iter_mut().enumerate() {
                *count += new >> bit & 1;
            }
        }
        for (at, (value, before)) in shown.iter().zip(&mut self.before).enumerate() {
            self.changed[at] += u64::from(value != before);
            *before = *value;
        }
    }

    /// Returns each event's name and count.
    pub fn counts(&self) -> Vec<(String, u64)> {
        use Saturation::{Command, Duty, Error, ErrorRate, Feedback, Integral, Sliding};
        let outputs = self.outputs.iter().cloned().zip(self.changed.iter().copied());
        let flags = [Error, ErrorRate, Sliding, Feedback, Integral, Command, Duty];
        let rose = ["high", "low"].into_iter().zip(self.rose).flat_map(|(side, counts)| {
            let named = move |(flag, count)| (format!("{flag:?} {side}"), count);
            flags.into_iter().zip(counts).map(named)
        });
        let laws = (0..4).map(|law| (format!("law {law}"), self.laws[law]));
        let limits = (0..4).map(|case| (format!("PID against its limit, case {case}"), self.against_limit[case]));
        let more = [("modulo".to_owned(), self.modulo), ("resets".to_owned(), self.resets)];
        outputs.chain(rose).chain(laws).chain(limits).chain(more).collect()
    }
}
