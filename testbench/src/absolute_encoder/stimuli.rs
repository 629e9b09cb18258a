//! An encoder that moves at every speed up to the limit, with line delays, jitter and every fault; ticks in time, early and rare;
//! clears and resets in any clock.
//!
//! A run begins with a list of readings that reaches every flag, `lost`, and the way out of it.

use posicast_blocks::absolute_encoder::{AbsoluteEncoderConfig, INPUT_PORTS, OUTPUT_PORTS, Outputs};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::encoder::{EncoderFault, SimulatedEncoder, allowed_delay, range};
use crate::stimuli::Stimuli;
use crate::stimuli::table::pick;

/// Good readings between two faults of the beginning.
const CALM_READINGS: u64 = 2;

/// An endless random mixture of readings.
#[derive(Debug, Clone)]
pub struct AbsoluteEncoderRandom {
    rng: Xoshiro256PlusPlus,
    config: AbsoluteEncoderConfig,
    encoder: SimulatedEncoder,
    clock: u64,
    clocks_to_tick: u64,
    readings: u64,
    /// Change of the position from reading to reading.
    speed: i64,
    speed_left: u64,
    /// Readings that this fault lasts.
    fault: EncoderFault,
    fault_left: u64,
    /// Whether the next tick stays until it is taken, and whether it has begun.
    stays: bool,
    holds: bool,
    lost_clocks: u64,
    clears: bool,
}

impl AbsoluteEncoderRandom {
    /// Creates the encoder. Equal seeds give equal inputs.
    pub fn new(config: &AbsoluteEncoderConfig, seed: u64) -> Self {
        let mut encoder = SimulatedEncoder::new(config);
        encoder.position = range(config) - 3;
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            config: *config,
            encoder,
            clock: 0,
            clocks_to_tick: 6,
            readings: 0,
            speed: 1,
            speed_left: 6,
            fault: EncoderFault::None,
            fault_left: 0,
            stays: false,
            holds: false,
            lost_clocks: 0,
            clears: false,
        }
    }

    fn one_in(&mut self, chances: u64) -> bool {
        self.rng.random_range(0..chances) == 0
    }

    /// Number of readings of the directed beginning.
    fn directed(&self) -> u64 {
        (EncoderFault::ALL.len() as u64 + 1) * (CALM_READINGS + 1) + self.config.limits().tolerated + 4
    }

    /// Moves the axis, and chooses what happens to the next reading.
    fn prepare(&mut self) {
        let place = self.readings;
        self.readings += 1;
        let tolerated = self.config.limits().tolerated;
        let last = EncoderFault::ALL.len() as u64 * (CALM_READINGS + 1);
        if place < self.directed() {
            let fault = EncoderFault::ALL[(place / (CALM_READINGS + 1)) as usize % EncoderFault::ALL.len()];
            let is_calm = place < last && place % (CALM_READINGS + 1) != CALM_READINGS;
            self.encoder.fault = match (is_calm, place >= last) {
                (true, _) => EncoderFault::None,
                // Enough in a row to be lost.
                (false, true) if place <= last + tolerated => EncoderFault::Silent,
                (false, true) => EncoderFault::None,
                (false, false) => fault,
            };
        } else {
            self.prepare_any();
        }
        self.encoder.position = self.encoder.position.wrapping_add_signed(self.speed) & range(&self.config);
    }

    fn prepare_any(&mut self) {
        let tolerated = self.config.limits().tolerated;
        if self.fault_left == 0 {
            self.fault = *pick(&mut self.rng, &EncoderFault::ALL);
            let more = self.rng.random_range(1..=tolerated + 2);
            self.fault_left = *pick(&mut self.rng, &[1, 1, 1, tolerated.max(1), more]);
            // A third of the readings has a fault.
            if self.fault == EncoderFault::None || self.one_in(3) {
                self.fault = EncoderFault::None;
                self.fault_left = self.rng.random_range(1..12);
            }
        }
        self.fault_left -= 1;
        // Faults in a row may be different ones.
        let changes = self.fault != EncoderFault::None && self.one_in(3);
        self.encoder.fault = if changes {
            *pick(&mut self.rng, &EncoderFault::ALL)
        } else {
            self.fault
        };

        if self.speed_left == 0 {
            let largest = self.config.limits().largest_jump as i64;
            let sign = *pick(&mut self.rng, &[1, -1]);
            let any = self.rng.random_range(-largest..=largest);
            let slow = self.rng.random_range(-2..=2);
            self.speed = *pick(
                &mut self.rng,
                &[sign * largest, sign * (largest - 1), any, any, slow, 0],
            );
            self.speed_left = self.rng.random_range(1..8);
        }
        self.speed_left -= 1;
        let beyond = self.config.limits().largest_jump as i64 + 1;
        let shift = match self.rng.random_range(0..60) {
            0 => beyond,
            1 => -beyond,
            // Anywhere: the next readings are far from the last good one.
            2 => self.rng.random(),
            _ => 0,
        };
        self.encoder.position = self
            .encoder
            .position
            .wrapping_add_signed(shift - if shift.abs() == beyond { self.speed } else { 0 });
        if self.one_in(6) {
            self.encoder.delay = allowed_delay(&self.config, &mut self.rng);
            // In a period of few clocks, a clock is much.
            self.encoder.jitters = self.config.times().half_period_clocks > 3 && self.rng.random();
            self.encoder.computes = *pick(&mut self.rng, &[0, 0, 0, 1, 4]);
        }
    }

    /// Clocks from this tick to the next.
    fn tick_after(&mut self) -> u64 {
        let least = self.config.least_tick_clocks();
        let calm = self.readings < self.directed();
        match self.rng.random_range(0..24) {
            0 if !calm => self.rng.random_range(1..=least),
            1 if !calm => self.rng.random_range(1..=6),
            2 if !calm => least + self.rng.random_range(1..=least),
            // A tick that stays until the block takes it.
            3 if !calm => {
                self.stays = true;
                self.rng.random_range(1..=least)
            }
            _ => least,
        }
    }
}

impl Stimuli for AbsoluteEncoderRandom {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        let Ok([rst, tick, data, clear_flags]) = <&mut [u64; INPUT_PORTS]>::try_from(inputs) else {
            return;
        };
        let Ok(seen) = <&[u64; OUTPUT_PORTS]>::try_from(seen) else {
            return;
        };
        let seen = Outputs::from_raw(seen);
        let calm = self.readings < self.directed();
        let least = self.config.least_tick_clocks();
        *rst = u64::from(self.clock < 2 || (!calm && self.one_in(60 * least)));
        // The outputs of a clock that was not are 0.
        let clock_out = self.clock == 0 || seen.clock_out;
        *data = u64::from(self.encoder.clock(clock_out, &mut self.rng));

        self.clocks_to_tick -= 1;
        self.holds &= seen.busy;
        *tick = u64::from(self.clocks_to_tick == 0 || self.holds);
        if self.clocks_to_tick == 0 {
            self.prepare();
            self.holds = std::mem::take(&mut self.stays);
            self.clocks_to_tick = self.tick_after();
            if self.readings == 4 {
                // The first overrun.
                self.clocks_to_tick = least / 2;
            }
        }

        // An axis that is lost waits for a while, and some flags are cleared in the clock in which they come.
        self.lost_clocks = if seen.lost { self.lost_clocks + 1 } else { 0 };
        if !calm && self.one_in(3 * least) {
            self.clears = self.one_in(6);
        }
        let now = self.clears || self.one_in(10 * least) || (self.lost_clocks > 0 && self.one_in(2 * least));
        *clear_flags = u64::from(now && (!calm || self.lost_clocks > 0));
        self.clock += 1;
    }
}
