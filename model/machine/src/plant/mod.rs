//! The simulated machine: modes in parallel, driven by a command that is a cubic of time between its jumps.
//!
//! ```text
//!            ┌─ share_1 · ω₁²/(s² + 2ζ₁ω₁s + ω₁²) ─┐
//! command u ─┼─ …                                  ┼─► Σ ─► position y         Σ share_k = 1
//!            └─ share_m · ω_m²/(…)                 ┘
//! ```
//!
//! Command and position have one unit, which may be any; times are in seconds. A mode's state is its distance `d`
//! from the command and its velocity `v`. While the command is constant both follow the closed form of a free
//! oscillation, so that every instant is exact, however far away ([`free_motion`]): this is the zero-order-hold
//! discretisation without approximation. Under a ramp, a parabola or a cubic the same oscillation runs about a
//! polynomial in closed form. Without modes the plant is rigid: the position is the command.
//!
//! The figures in [`response`] are measured on these states, independently of the pole sums of [`posicast_shaper::analysis`],
//! so that the two check each other.

pub mod axis;
pub mod drive_train;
pub mod response;

use nalgebra::{Matrix2, Vector2};
use thiserror::Error;

use crate::machine_file::AxisSection;
use crate::motion::Cubic;
use posicast_shaper::mode::Mode;

/// A mode with its share in the position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlantMode {
    /// Frequency and damping.
    pub mode: Mode,
    /// Share in the static response; the shares of a plant sum to one.
    pub share: f64,
}

/// A plant of modes in parallel.
#[derive(Debug, Clone, PartialEq)]
pub struct Plant {
    modes: Vec<PlantMode>,
}

/// Why modes cannot form a plant.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum PlantError {
    /// The participations cannot be scaled to the sum one.
    #[error("the participations of the modes sum to {0}: they must be finite and sum to more than 0")]
    Participation(f64),
}

impl Plant {
    /// Makes a plant of modes with their participations; only the ratios of these matter.
    ///
    /// # Errors
    /// [`PlantError::Participation`] if the participations do not have a positive, finite sum.
    pub fn new(modes: &[(Mode, f64)]) -> Result<Self, PlantError> {
        let sum: f64 = modes.iter().map(|(_, participation)| participation).sum();
        let scalable = sum > 0.0 && sum.is_finite();
        if !(scalable || modes.is_empty()) {
            return Err(PlantError::Participation(sum));
        }
        let modes = modes.iter().map(|&(mode, participation)| PlantMode {
            mode,
            share: participation / sum,
        });
        Ok(Self { modes: modes.collect() })
    }

    /// Makes a plant of modes with known shares, which must sum to one.
    pub fn of_shares(modes: Vec<PlantMode>) -> Self {
        Self { modes }
    }

    /// The plant that an axis of the machine file describes.
    ///
    /// # Errors
    /// Those of [`Plant::new`].
    pub fn of_axis(axis: &AxisSection) -> Result<Self, PlantError> {
        let modes: Vec<_> = axis.modes.iter().map(|m| (m.mode, m.participation)).collect();
        Self::new(&modes)
    }

    /// The modes; their shares sum to one.
    pub fn modes(&self) -> &[PlantMode] {
        &self.modes
    }

    /// The machine with all frequencies multiplied by `ratio`: 0.9 is 10 % slower than the model.
    pub fn scaled(&self, ratio: f64) -> Self {
        let modes = self.modes.iter().map(|m| PlantMode {
            mode: m.mode.scaled(ratio),
            share: m.share,
        });
        Self { modes: modes.collect() }
    }
}

/// State `(d, v)` of a mode after `time_s` seconds of constant command:
///
/// ```text
///                  ⎡ cos ω_d t + (σ/ω_d) sin ω_d t     (1/ω_d) sin ω_d t             ⎤
/// Φ(t) = e^{−σt} · ⎢                                                                 ⎥      σ = ζω
///                  ⎣ −(ω²/ω_d) sin ω_d t               cos ω_d t − (σ/ω_d) sin ω_d t ⎦
/// ```
pub fn free_motion(mode: &Mode, time_s: f64) -> Matrix2<f64> {
    let (omega, omega_damped, decay) = (mode.omega(), mode.omega_damped(), mode.decay());
    let (sin, cos) = (omega_damped * time_s).sin_cos();
    let slant = decay / omega_damped * sin;
    let motion = Matrix2::new(
        cos + slant,
        sin / omega_damped,
        -omega * omega / omega_damped * sin,
        cos - slant,
    );
    motion * (-decay * time_s).exp()
}

/// Amplitude of the free oscillation that starts in the state `(d, v)`.
fn free_amplitude(mode: &Mode, state: &Vector2<f64>) -> f64 {
    let quadrature = (state.y + mode.decay() * state.x) / mode.omega_damped();
    state.x.hypot(quadrature)
}

/// A plant in motion under a command that is a cubic of time.
#[derive(Debug, Clone, PartialEq)]
struct Motion<'a> {
    plant: &'a Plant,
    command: Cubic,
    /// State of each mode: its distance from the command, and the rate of that distance.
    states: Vec<Vector2<f64>>,
}

impl<'a> Motion<'a> {
    /// Starts at rest at position 0, as the command does.
    fn at_rest(plant: &'a Plant) -> Self {
        Self {
            plant,
            command: Cubic::default(),
            states: vec![Vector2::zeros(); plant.modes.len()],
        }
    }

    /// Lets the command jump by `jump` and continue as `command`; the state of the machine stays continuous.
    fn jump(&mut self, jump: &Cubic, command: Cubic) {
        for state in &mut self.states {
            *state -= Vector2::new(jump.position, jump.velocity);
        }
        self.command = command;
    }

    /// Position and velocity `time_s` seconds from now.
    fn ahead(&self, time_s: f64) -> (f64, f64) {
        let modes = self.plant.modes.iter().zip(&self.states);
        let moved = modes.map(|(m, state)| self.moved(&m.mode, state, time_s) * m.share);
        let sum: Vector2<f64> = moved.sum();
        let command = self.command.after(time_s);
        // Without modes the sum is 0: a rigid plant follows its command.
        (command.position + sum.x, command.velocity + sum.y)
    }

    /// Advances the time by `time_s` seconds.
    fn advance(&mut self, time_s: f64) {
        let modes = self.plant.modes.iter().zip(&self.states);
        let states = modes.map(|(m, state)| self.moved(&m.mode, state, time_s));
        self.states = states.collect();
        self.command = self.command.after(time_s);
    }

    /// State of a mode `time_s` seconds from now: its lag, and the free oscillation about it.
    fn moved(&self, mode: &Mode, state: &Vector2<f64>, time_s: f64) -> Vector2<f64> {
        let lag = Lag::new(mode, &self.command);
        lag.after(time_s) + free_motion(mode, time_s) * (state - lag.after(0.0))
    }

    /// Amplitude with which a mode now oscillates about its lag.
    fn amplitude(&self, mode: &Mode, state: &Vector2<f64>) -> f64 {
        free_amplitude(mode, &(state - Lag::new(mode, &self.command).after(0.0)))
    }
}

/// Lag of a mode behind a cubic command `u` without oscillation: the polynomial `e(t) = c_0 + c_1·t + c_2·t²` that
/// solves `e″ + 2σe′ + ω²e = −u″ − 2σu′` for the distance `e` from the command.
struct Lag {
    coefficients: [f64; 3],
}

impl Lag {
    fn new(mode: &Mode, command: &Cubic) -> Self {
        let stiffness = mode.omega() * mode.omega();
        let twice_decay = 2.0 * mode.decay();
        let square = -twice_decay * command.jerk / 2.0 / stiffness;
        let linear = -(command.jerk + twice_decay * command.acceleration + 2.0 * twice_decay * square) / stiffness;
        let constant =
            -(command.acceleration + twice_decay * command.velocity + twice_decay * linear + 2.0 * square) / stiffness;
        Self {
            coefficients: [constant, linear, square],
        }
    }

    fn after(&self, time_s: f64) -> Vector2<f64> {
        let [constant, linear, square] = self.coefficients;
        Vector2::new(
            constant + time_s * (linear + time_s * square),
            linear + 2.0 * time_s * square,
        )
    }
}

/// A plant in steps of one sample: one matrix per mode, one multiplication per sample.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledPlant {
    modes: Vec<PlantMode>,
    per_sample: Vec<Matrix2<f64>>,
    command: f64,
    states: Vec<Vector2<f64>>,
}

impl SampledPlant {
    /// Makes a plant with `sample_period_s` seconds per sample, at rest at `position`.
    pub fn new(plant: &Plant, sample_period_s: f64, position: f64) -> Self {
        let per_sample = plant.modes.iter().map(|m| free_motion(&m.mode, sample_period_s));
        Self {
            modes: plant.modes.clone(),
            per_sample: per_sample.collect(),
            command: position,
            states: vec![Vector2::zeros(); plant.modes.len()],
        }
    }

    /// Holds `command` for one sample, and returns the position at its end.
    pub fn step(&mut self, command: f64) -> f64 {
        let jump = self.command - command;
        self.command = command;
        let mut position = command;
        for ((m, motion), state) in self.modes.iter().zip(&self.per_sample).zip(&mut self.states) {
            state.x += jump;
            *state = motion * *state;
            position += m.share * state.x;
        }
        position
    }

    /// Sum of the amplitudes with which the modes ring now, in the unit of the command: no later position is farther
    /// from the command.
    pub fn vibration(&self) -> f64 {
        let modes = self.modes.iter().zip(&self.states);
        modes
            .map(|(m, state)| m.share.abs() * free_amplitude(&m.mode, state))
            // `sum` would be -0 without a mode.
            .fold(0.0, |sum, amplitude| sum + amplitude)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SLOW: Mode = Mode {
        frequency_hz: 3.0,
        damping: 0.1,
    };
    const FAST: Mode = Mode {
        frequency_hz: 11.0,
        damping: 0.0,
    };

    #[test]
    fn free_motion_solves_its_differential_equation() {
        let (omega, decay) = (SLOW.omega(), SLOW.decay());
        let generator = Matrix2::new(0.0, 1.0, -omega * omega, -2.0 * decay);
        assert!((free_motion(&SLOW, 0.0) - Matrix2::identity()).amax() < 1e-15);
        for time_s in [0.01, 0.1, 1.0] {
            let step = 1e-6;
            let slope = (free_motion(&SLOW, time_s + step) - free_motion(&SLOW, time_s - step)) / (2.0 * step);
            let error = slope - generator * free_motion(&SLOW, time_s);
            assert!(error.amax() < 1e-5 * slope.amax().max(1.0), "{error}");
        }
        let twice = free_motion(&FAST, 0.7) - free_motion(&FAST, 0.3) * free_motion(&FAST, 0.4);
        assert!(twice.amax() < 1e-12);
    }

    #[test]
    fn sampled_plant_is_the_step_response_at_the_samples() {
        let plant = Plant::new(&[(SLOW, 3.0), (FAST, 1.0)]).unwrap();
        let mut sampled = SampledPlant::new(&plant, 1e-3, 0.0);
        let (mut y, mut time_s) = (0.0, 0.0);
        for _ in 0..777 {
            y = sampled.step(2.0);
            time_s += 1e-3;
        }
        let (sin, cos) = (SLOW.omega_damped() * time_s).sin_cos();
        let slow = 1.0 - (-SLOW.decay() * time_s).exp() * (cos + SLOW.decay() / SLOW.omega_damped() * sin);
        let fast = 1.0 - (FAST.omega() * time_s).cos();
        assert!((y - 2.0 * (0.75 * slow + 0.25 * fast)).abs() < 1e-11);
        let vibration = 0.75 * (-SLOW.decay() * time_s).exp() / (1.0 - 0.01f64).sqrt() + 0.25;
        assert!((sampled.vibration() - 2.0 * vibration).abs() < 1e-11);
    }

    #[test]
    fn a_plant_without_modes_is_rigid() {
        let plant = Plant::new(&[]).unwrap();
        let mut sampled = SampledPlant::new(&plant, 1e-3, 0.0);
        assert_eq!((sampled.step(1.5), sampled.vibration()), (1.5, 0.0));
    }

    #[test]
    fn participations_need_a_positive_sum() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Plant::new(&[(SLOW, bad)]).is_err());
        }
        assert_eq!(Plant::new(&[(SLOW, 5.0)]).unwrap().modes()[0].share, 1.0);
    }
}
