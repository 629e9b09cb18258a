//! The sampled loop of an axis: an exact solution for drive, mass and modes between two ticks, and the law at the
//! ticks.
//!
//! ```text
//!           tick n                                      T: tick, τ: capture to new duty, T_p: period of the PWM
//! e = r − y ─► C(z) ─► duty held for T, τ late, averaged over T_p ─► drive ─► mass, modes ─► y, captured at the next tick
//!
//! G(s) = Σ_i R_i/(s − p_i)          p_i: 0, −β (viscous friction per mass), −ω_b (drive), −ζω ± jω_d (each mode)
//! G(z) = Σ_i R_i (Γ0_i + Γ1_i z⁻¹) z^−m / (z − e^{p_i T})
//! C(z) = P + D (1 − z⁻¹)/T + I T z⁻¹/(1 − z⁻¹) − V (1 − z⁻¹)/T
//! ```
//!
//! The input of `G` is an acceleration (torque drive) or a velocity (velocity drive); `V` is the measured velocity
//! that the law feeds forward against viscous friction. `Γ0` and `Γ1` are the state of `x′ = p·x + u` at the next
//! tick after an input of 1 in this tick, and in the one before. The plant is that of [`crate::plant::axis`], without
//! friction at standstill, without the quantisation of the encoder and without limits. [`SampledLoop::margins`] gives
//! its stability, [`SampledLoop::follow`] its motion.

mod follow;
mod margins;

use std::f64::consts::TAU;

use nalgebra::Complex;

use crate::machine_file::{AxisSection, ClockSection, Drive, DriveMode, PwmSection, ScaleUse};
use crate::plant::Plant;

pub use follow::{FollowLimits, Followed};
pub use margins::{Margins, NyquistPoint};

/// Friction that replaces that of a frictionless mass, 1/T, because a double pole at 0 has no partial fractions.
const NO_FRICTION: f64 = 1e-7;
/// Relative distance to which two equal poles are moved apart.
const APART: f64 = 1e-6;
/// Largest delay in whole ticks.
const DELAY_TICKS_MAX: f64 = 1e4;

/// A linear control law without limits, in m and s (rad and s).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LinearLaw {
    /// Gain on the error.
    pub proportional: f64,
    /// Gain on the rate of the error.
    pub derivative: f64,
    /// Gain on the integral of the error.
    pub integral: f64,
    /// Gain on the measured velocity; positive feedback.
    pub velocity: f64,
    /// Gain on the reference velocity.
    pub velocity_reference: f64,
    /// Gain on the reference acceleration.
    pub acceleration_reference: f64,
}

impl LinearLaw {
    /// The law with its feedback multiplied by `factor`.
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            proportional: factor * self.proportional,
            derivative: factor * self.derivative,
            integral: factor * self.integral,
            ..*self
        }
    }
}

/// A pole of the plant, with its residues in the measured quantities.
#[derive(Debug, Clone, Copy, PartialEq)]
struct PlantPole {
    pole: Complex<f64>,
    /// Factor `e^{pT}` of its state per tick.
    per_tick: Complex<f64>,
    /// Its state at the next tick after an input of 1 in this tick, and in the one before.
    gamma: [Complex<f64>; 2],
    /// Residue in the position of the loop.
    position: Complex<f64>,
    /// Residue in the position whose change is the loop's velocity.
    motor: Complex<f64>,
    /// Residue in the position of the load.
    load: Complex<f64>,
}

/// The loop of an axis without its control law.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledLoop {
    tick_s: f64,
    /// Delay from the capture to the duty, in whole ticks.
    delay_ticks: usize,
    poles: Vec<PlantPole>,
}

/// A term of a transfer function: `gain · s^zeros / Π (s − p)`.
struct Term {
    gain: f64,
    zeros: i32,
    /// Indices of its poles.
    poles: Vec<usize>,
}

impl SampledLoop {
    /// The plant of an axis whose modes are at `frequency_factor` times their frequencies, in a loop with this lag
    /// ([`super::loop_lag_s`]). `None` for an axis without PWM or drive, or with invalid participations.
    pub fn new(axis: &AxisSection, clock: ClockSection, lag_s: f64, frequency_factor: f64) -> Option<Self> {
        let (drive, pwm) = (axis.drive.as_ref()?, axis.pwm.as_ref()?);
        let plant = Plant::of_axis(axis).ok()?.scaled(frequency_factor);
        let tick_s = clock.sample_period_s();
        let delay = Delay::new(drive, pwm, tick_s, lag_s);
        let of_plant = PlantTerms::new(axis, drive, &plant, tick_s);
        let residues = |terms: &[Term]| -> Vec<Complex<f64>> {
            let of_pole = |at| terms.iter().map(|term| residue(term, &of_plant.poles, at)).sum();
            (0..of_plant.poles.len()).map(of_pole).collect()
        };
        let [position, motor, load] =
            [&of_plant.position, &of_plant.motor, &of_plant.load].map(|terms| residues(terms));
        let poles = of_plant.poles.iter().enumerate().map(|(at, pole)| PlantPole {
            pole: *pole,
            per_tick: (pole * tick_s).exp(),
            gamma: delay.gamma(*pole, tick_s),
            position: position[at],
            motor: motor[at],
            load: load[at],
        });
        Some(Self {
            tick_s,
            delay_ticks: delay.ticks,
            poles: poles.collect(),
        })
    }

    /// The open loop `L(z)` with this law.
    pub fn open_loop(&self, law: &LinearLaw, z: Complex<f64>) -> Complex<f64> {
        let one = Complex::from(1.0);
        let before = z.inv();
        let (mut position, mut motor) = (Complex::from(0.0), Complex::from(0.0));
        for pole in &self.poles {
            let answer = (pole.gamma[0] + pole.gamma[1] * before) / (z - pole.per_tick);
            position += pole.position * answer;
            motor += pole.motor * answer;
        }
        let rate = (one - before) / self.tick_s;
        let of_position = law.proportional + law.integral * self.tick_s * before / (one - before);
        let of_motor = rate * (law.derivative - law.velocity);
        (of_position * position + of_motor * motor) * before.powi(self.delay_ticks as i32)
    }
}

/// The time at which a duty acts.
struct Delay {
    ticks: usize,
    /// Fraction of a tick that remains, in s.
    rest_s: f64,
    /// Period in s over which the drive takes the mean of the duty.
    period_s: f64,
}

impl Delay {
    fn new(drive: &Drive, pwm: &PwmSection, tick_s: f64, lag_s: f64) -> Self {
        let of_drive_s = drive
            .bandwidth_hz
            .map_or(0.0, |bandwidth_hz| 1.0 / (TAU * bandwidth_hz));
        // A lag contains half a tick for the duty that is held, and half a tick for the velocity.
        let capture_s = (lag_s - of_drive_s - tick_s).max(0.0);
        // A sum of decimals that is a whole number of ticks may come out slightly below it.
        let ticks = (capture_s / tick_s + 1e-9).floor().min(DELAY_TICKS_MAX);
        let rest_s = (capture_s - ticks * tick_s).clamp(0.0, tick_s);
        let period_s = 1.0 / pwm.frequency_hz;
        Self {
            ticks: ticks as usize,
            rest_s,
            period_s: period_s.min(tick_s - rest_s),
        }
    }

    /// State at the next tick after an input of 1 in this tick, and in the one before.
    fn gamma(&self, pole: Complex<f64>, tick_s: f64) -> [Complex<f64>; 2] {
        let both = tick_s * first(pole * tick_s);
        let open_s = tick_s - self.rest_s;
        let now = if self.period_s < 1e-6 * tick_s {
            open_s * first(pole * open_s)
        } else {
            // The mean of t·φ1(pt), for t from the end of the period of the mean on.
            let integral = |time_s: f64| time_s * time_s * second(pole * time_s);
            (integral(open_s) - integral(open_s - self.period_s)) / self.period_s
        };
        [now, both - now]
    }
}

/// `(e^x − 1)/x`.
fn first(x: Complex<f64>) -> Complex<f64> {
    1.0 + x * second(x)
}

/// `(e^x − 1 − x)/x²`, by its series where the difference would cancel.
fn second(x: Complex<f64>) -> Complex<f64> {
    if x.norm() > 0.3 {
        return (x.exp() - 1.0 - x) / (x * x);
    }
    // Horner's scheme of Σ x^k/(k+2)!, to 16 digits.
    (3..16)
        .rev()
        .fold(Complex::from(1.0), |sum, k| 1.0 + sum * x / f64::from(k))
        * 0.5
}

/// The plant's poles, with the terms of its outputs.
struct PlantTerms {
    poles: Vec<Complex<f64>>,
    position: Vec<Term>,
    motor: Vec<Term>,
    load: Vec<Term>,
}

impl PlantTerms {
    fn new(axis: &AxisSection, drive: &Drive, plant: &Plant, tick_s: f64) -> Self {
        let mut poles = vec![Complex::from(0.0)];
        let mut rigid = vec![0];
        if let DriveMode::Torque { equivalent_mass, .. } = drive.mode {
            let friction = (drive.viscous / equivalent_mass).max(NO_FRICTION / tick_s);
            rigid.push(poles.len());
            poles.push(Complex::from(-friction));
        }
        let mut gain = 1.0;
        if let Some(bandwidth_hz) = drive.bandwidth_hz {
            let mut pole = -TAU * bandwidth_hz;
            if poles.iter().any(|other| (other.re - pole).abs() < APART * pole.abs()) {
                pole *= 1.0 + 2.0 * APART;
            }
            gain = -pole;
            rigid.push(poles.len());
            poles.push(Complex::from(pole));
        }
        let torque = matches!(drive.mode, DriveMode::Torque { .. });
        let motor = || Term {
            gain,
            zeros: 0,
            poles: rigid.clone(),
        };
        let mut load = Vec::new();
        if torque || plant.modes().is_empty() {
            load.push(motor());
        }
        for of in plant.modes() {
            let (decay, omega_damped) = (of.mode.decay(), of.mode.omega_damped());
            let at = poles.len();
            poles.push(Complex::new(-decay, omega_damped));
            poles.push(Complex::new(-decay, -omega_damped));
            // The input of a torque drive's modes is its acceleration, s² times the driven coordinate.
            let (zeros, share, without) = if torque {
                (1, -of.share, 1)
            } else {
                (0, of.share * of.mode.omega().powi(2), 0)
            };
            let poles = rigid[without..].iter().copied().chain([at, at + 1]);
            load.push(Term {
                gain: gain * share,
                zeros,
                poles: poles.collect(),
            });
        }
        let on_scale = axis.scale.is_some_and(|scale| scale.usage == ScaleUse::Position);
        let copy = |terms: &[Term]| terms.iter().map(Term::copy).collect::<Vec<_>>();
        let (position, motor) = match (torque, on_scale) {
            (true, _) => (copy(&load), copy(&load)),
            (false, true) => (copy(&load), vec![motor()]),
            (false, false) => (vec![motor()], vec![motor()]),
        };
        Self {
            poles,
            position,
            motor,
            load,
        }
    }
}

impl Term {
    fn copy(&self) -> Self {
        Self {
            gain: self.gain,
            zeros: self.zeros,
            poles: self.poles.clone(),
        }
    }
}

/// The residue of a term at a pole; 0 where the term does not have that pole.
fn residue(term: &Term, poles: &[Complex<f64>], at: usize) -> Complex<f64> {
    if !term.poles.contains(&at) {
        return Complex::from(0.0);
    }
    let others = term.poles.iter().filter(|other| **other != at);
    others.fold(poles[at].powi(term.zeros) * term.gain, |residue, other| {
        residue / (poles[at] - poles[*other])
    })
}
