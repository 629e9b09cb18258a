//! Simulated logs of machines with known modes, to test the methods.
//!
//! A machine with modes under a resonance test is simulated exactly from event to event, by closed forms that no method uses.

use crate::signal::{AccelerationLog, Between, PositionLog};
use crate::sweep::{QuarterOrder, Rise, SquareWave, Sweep, Sweeping, SweptAcceleration};
use nalgebra::{Matrix2, Vector2};
use posicast_machine::plant::{Plant, PlantError, SampledPlant, free_motion};
use posicast_shaper::mode::Mode;
use rand::RngExt;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;

/// A mode of the machine with its share in the displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownMode {
    /// Frequency and damping ratio.
    pub mode: Mode,
    /// Share in the static displacement; the rest of the sum to one is rigid.
    pub share: f64,
}

/// Makes a mode from frequency in Hz, damping ratio and share.
pub fn known(frequency_hz: f64, damping: f64, share: f64) -> KnownMode {
    KnownMode {
        mode: Mode { frequency_hz, damping },
        share,
    }
}

/// Conditions under which a log is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensor {
    /// Time between samples in seconds.
    pub sample_s: f64,
    /// Time from the first sample to the start of the sweep, in seconds.
    pub start_s: f64,
    /// Time from the end of the sweep to the last sample, in seconds.
    pub rest_s: f64,
    /// Standard deviation of the sensor's noise in m/s².
    pub noise: f64,
    /// Quantisation step in m/s²; 0 for none.
    pub step: f64,
    /// Whether the excitation acts only from the next sample on, as in simulations on a grid.
    pub held: bool,
    /// Deceleration in m/s² after a test that ends in motion, such as one with a square wave; the firmware uses its `max_accel`.
    pub stop: f64,
}

impl Default for Sensor {
    fn default() -> Self {
        Self {
            sample_s: 1.0 / 3200.0,
            start_s: 0.437_21,
            rest_s: 0.3,
            noise: 0.2,
            step: 0.037,
            held: false,
            stop: 3.0,
        }
    }
}

/// Normally distributed random numbers, by the Box–Muller method.
pub struct Noise(Xoshiro256PlusPlus);

impl Noise {
    /// A generator that gives the same numbers for the same seed.
    pub fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    /// The next number, with variance 1.
    pub fn draw(&mut self) -> f64 {
        let (a, b): (f64, f64) = (self.0.random(), self.0.random());
        (-2.0 * (1.0 - a).ln()).sqrt() * (std::f64::consts::TAU * b).cos()
    }
}

/// One mode under a piecewise constant acceleration of its base: `d″ + 2ζωd′ + ω²d = −u`.
struct Moving {
    truth: KnownMode,
    state: Vector2<f64>,
}

impl Moving {
    fn advance(&mut self, seconds: f64, base: f64) {
        let rest = Vector2::new(-base / (self.truth.mode.omega() * self.truth.mode.omega()), 0.0);
        let motion: Matrix2<f64> = free_motion(&self.truth.mode, seconds);
        self.state = motion * (self.state - rest) + rest;
    }

    /// Acceleration relative to the base.
    fn acceleration(&self, base: f64) -> f64 {
        let mode = &self.truth.mode;
        -base - 2.0 * mode.decay() * self.state.y - mode.omega() * mode.omega() * self.state.x
    }
}

/// The sweep of Klipper's resonance test since December 2024, with its square wave.
pub fn present_test() -> Sweep {
    Sweep {
        sweeping: Sweeping::Wave(SquareWave::default()),
        ..Sweep::default()
    }
}

/// Returns the log of one moving direction, with another direction at rest. The excitation includes a square wave if `sweep` specifies one.
pub fn resonance_test(truths: &[KnownMode], sweep: &Sweep, sensor: &Sensor, seed: u64) -> AccelerationLog {
    let mut excitation = SweptAcceleration::new(sweep, QuarterOrder::Mirrored, Rise::HalfPeriod);
    if let Sweeping::Wave(wave) = sweep.sweeping {
        let wave = SweptAcceleration::square_wave(&wave, excitation.duration_s());
        excitation = excitation.beside(&wave).with_stop(sensor.stop);
    }
    let seconds = sensor.start_s + excitation.duration_s() + sensor.rest_s;
    let samples = (seconds / sensor.sample_s) as usize;
    let mut moving: Vec<Moving> = truths
        .iter()
        .map(|&truth| Moving {
            truth,
            state: Vector2::zeros(),
        })
        .collect();
    let mut noise = Noise::new(seed);
    let (mut along, mut across) = (Vec::with_capacity(samples), Vec::with_capacity(samples));
    let quantised = |x: f64| {
        if sensor.step > 0.0 {
            (x / sensor.step).round() * sensor.step
        } else {
            x
        }
    };
    let mut now_s = -sensor.start_s;
    let mut pieces = excitation.pieces().peekable();
    let mut base = 0.0;
    for n in 0..samples {
        let at_s = n as f64 * sensor.sample_s - sensor.start_s;
        while let Some((begin_s, acceleration)) = pieces.next_if(|(begin_s, _)| *begin_s <= at_s) {
            let begin_s = if sensor.held { at_s } else { begin_s };
            for mode in &mut moving {
                mode.advance(begin_s - now_s, base);
            }
            (now_s, base) = (begin_s, acceleration);
        }
        for mode in &mut moving {
            mode.advance(at_s - now_s, base);
        }
        now_s = at_s;
        let relative: f64 = moving
            .iter()
            .map(|mode| mode.truth.share * mode.acceleration(base))
            .sum();
        along.push(quantised(base + relative + sensor.noise * noise.draw()));
        across.push(quantised(9.81 + sensor.noise * noise.draw()));
    }
    AccelerationLog {
        sample_s: sensor.sample_s,
        directions: vec![("accel_x".into(), along), ("accel_z".into(), across)],
        missing: Vec::new(),
    }
}

/// Bits of a maximum-length sequence of ±1, `x^10 + x^7 + 1`, each held for `held` samples.
pub fn pseudo_random(samples: usize, held: usize) -> Vec<f64> {
    let mut register = 1u32;
    let mut bits = Vec::new();
    while bits.len() < samples {
        let bit = (register >> 9 ^ register >> 6) & 1;
        register = (register << 1 | bit) & 0x3ff;
        bits.extend(std::iter::repeat_n(if bit == 1 { 1.0 } else { -1.0 }, held));
    }
    bits.truncate(samples);
    bits
}

/// A command of 0 that becomes 1 after a tenth of the samples.
pub fn step(samples: usize) -> Vec<f64> {
    (0..samples).map(|n| if n < samples / 10 { 0.0 } else { 1.0 }).collect()
}

/// Returns the log of the position under a command that is held from sample to sample, with noise of this standard deviation. The shares of
/// the modes are scaled to the sum one.
///
/// # Errors
/// [`PlantError`] if the shares do not have a positive sum.
pub fn position_log(
    truths: &[KnownMode],
    command: &[f64],
    sample_s: f64,
    noise: f64,
    seed: u64,
) -> Result<PositionLog, PlantError> {
    let modes: Vec<(Mode, f64)> = truths.iter().map(|truth| (truth.mode, truth.share)).collect();
    let plant = Plant::new(&modes)?;
    let mut sampled = SampledPlant::new(&plant, sample_s, 0.0);
    let mut source = Noise::new(seed);
    let mut at = 0.0;
    let response = command.iter().map(|u| {
        let before = at;
        at = sampled.step(*u);
        before + noise * source.draw()
    });
    Ok(PositionLog {
        sample_s,
        between: Between::Held,
        response: response.collect(),
        command: command.to_vec(),
        missing: Vec::new(),
    })
}
