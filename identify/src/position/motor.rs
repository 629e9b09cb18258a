//! Finds the modes of a load that hangs on a motor, from the command of the drive and the position that the motor's own encoder reports.
//!
//! ```text
//!  drive u ─► motor x ──/\/\/\── load         x/u = r₁/s + r₂/(s(s + a)) + Σ modes
//! ```
//!
//! A torque drive moves motor and load as one (`r₂`), a velocity drive integrates (`r₁`). At the poles of `x/u`, motor and load swing
//! against each other: these are the *free* modes with a torque drive, and what a velocity loop makes of them with a velocity drive. At the
//! zeros, the motor stands still while the load swings, whatever the drive does: these are the modes with the **motor held**, which a
//! position loop shows to its shaper. They are found as the zeros of a model that is fitted like any other ([`super`]). The fit includes a
//! constant force, such as dry friction while the motor moves one way.
//!
//! The share of the mass that swings in a held mode follows from the apparent mass `u/(s²x)`, whose poles are the held modes.

use super::held::{HeldModes, RigidBody};
use super::memory::beside_noise;
use super::rigid::is_tone;
use super::search::{Found, search};
use super::{
    FoundInPosition, LEAST_SAMPLES, LEAST_SHARE, MOST_ROWS, NO_VIBRATION, PositionError, PositionRemark,
    ROWS_PER_PERIOD, SEARCH_ROWS, VAGUE_DAMPING, VAGUE_FREQUENCY, check, largest, stretches,
};
use crate::found::{FoundMode, that_ring};
use crate::separable::{Effort, Gram, Separable, deviation_over_stretches, refine};
use crate::signal::{Between, DriveLog, PositionLog};
use nalgebra::{Complex, DMatrix, DVector};
use posicast_shaper::mode::Mode;
use std::f64::consts::TAU;

/// Modes found from the drive's command and the motor's position.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundAtMotor {
    /// The modes with the motor held, and the fit of the motor's motion. Participations are shares of the mass that swings.
    pub held: FoundInPosition,
    /// Vibrations while nothing holds the motor, by frequency: the free modes with a torque drive, those of the velocity loop with a
    /// velocity drive.
    pub free: Vec<Mode>,
    /// Whether the command acts as a force; otherwise it acts as a velocity.
    pub is_force: bool,
    /// Number of samples by which the motor is later than the command; negative if a row has the command of the tick before.
    pub delay: isize,
}

/// Delays in samples that are tried.
const DELAYS: std::ops::RangeInclusive<isize> = -2..=6;
/// Rates of viscous friction that are tried, times the length of the log: from none to a rate that stops a motor within a part of the log.
const RATES: [f64; 8] = [0.0, 0.03, 0.1, 0.3, 0.6, 1.0, 3.0, 10.0];

/// Finds the modes with the motor held.
///
/// # Errors
/// [`PositionError`].
pub fn identify(log: &DriveLog) -> Result<FoundAtMotor, PositionError> {
    let (start, unit) = (log.position.first().copied().unwrap_or(0.0), largest(&log.drive));
    let way: Vec<f64> = log.position.iter().map(|x| x - start).collect();
    let length = largest(&way);
    let log = PositionLog {
        sample_s: log.sample_s,
        command: log.drive.iter().map(|u| u / unit).collect(),
        between: Between::Held,
        response: way.iter().map(|x| x / length).collect(),
        missing: log.missing.clone(),
    };
    check(&log)?;
    let mut found = identify_scaled(&log)?;
    found.held.noise *= length;
    let rows = [&mut found.held.response, &mut found.held.fitted];
    rows.into_iter().flatten().for_each(|x| *x = start + *x * length);
    Ok(found)
}

/// Returns a log whose command comes `delay` samples later.
fn later(log: &PositionLog, delay: isize) -> PositionLog {
    let (samples, by) = (log.response.len(), delay.unsigned_abs());
    let (command, response) = if delay >= 0 {
        (0..samples - by, by..samples)
    } else {
        (by..samples, 0..samples - by)
    };
    PositionLog {
        command: log.command[command].to_vec(),
        missing: crate::signal::within(&log.missing, response.clone()),
        response: log.response[response].to_vec(),
        ..*log
    }
}

fn identify_scaled(log: &PositionLog) -> Result<FoundAtMotor, PositionError> {
    let samples = log.response.len() - DELAYS.end().unsigned_abs();
    if samples < LEAST_SAMPLES {
        return Err(PositionError::Short(log.response.len()));
    }
    let turns = turns_round(&log.response);
    let seconds = log.sample_s * samples as f64;
    let coarse = samples.div_ceil(SEARCH_ROWS);
    // All delays are judged by equally many samples.
    let shifted = |delay: isize| {
        let mut log = later(log, delay);
        log.command.truncate(samples);
        log.response.truncate(samples);
        log
    };
    let body = |rate: f64| RigidBody { rate: rate / seconds };
    let square = |delay: isize, rate: f64, decimation: usize, modes: &[Mode]| {
        let log = shifted(delay);
        let problem = HeldModes::new(&log, 0..samples, decimation).with_body(body(rate));
        refine(&problem, &HeldModes::unknowns(modes), Effort::Rough).map_or(f64::INFINITY, |fit| fit.square)
    };
    let searched = |delay: isize, rate: f64, decimation: usize| {
        let log = shifted(delay);
        search(&HeldModes::new(&log, 0..samples, decimation).with_body(body(rate)), &[])
    };
    let best_rate = |delay: isize, decimation: usize, modes: &[Mode]| {
        let tried = RATES.map(|rate| (square(delay, rate, decimation, modes), rate));
        let best = tried.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        best.map_or(0.0, |(_, rate)| rate)
    };
    // Poles that do not decay in the first fit stand for the friction, which this fit does not include yet.
    let vibrations = |found: Option<Found>| {
        let mut modes = found.map_or(Vec::new(), |found| found.modes);
        modes.retain(|mode| !is_tone(mode, true, seconds));
        modes
    };
    let first = vibrations(searched(0, 0.0, coarse));
    let decimation = decimation(log, samples, coarse, &first);
    let delay = DELAYS
        .map(|delay| (square(delay, 0.0, decimation, &first), delay))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map_or(0, |(_, delay)| delay);
    let rate = best_rate(delay, decimation, &first);
    let modes = vibrations(searched(delay, rate, coarse));
    let log = shifted(delay);
    let decimation = self::decimation(&log, samples, coarse, &modes);
    let problem = HeldModes::new(&log, 0..samples, decimation).with_body(body(rate));
    let (problem, found) = beside_noise(problem, &modes).ok_or(PositionError::Short(samples))?;
    let plain = HeldModes::with_filled(&log, 0..samples, decimation).with_body(body(rate));
    let fitted = plain.basis(&found.solution.unknowns) * &found.solution.coefficients;
    let noise = ((plain.measured() - &fitted).norm_squared() / found.solution.freedoms).sqrt();
    let model = Model::new(&problem, &found, rate / seconds);
    let modes = reported_modes(&problem, &found, &model);
    let is_force = model.is_force();
    let mut free = found.modes;
    free.retain(|mode| mode.damping < NO_VIBRATION);
    free.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    Ok(FoundAtMotor {
        held: FoundInPosition {
            is_forced: plain.is_forced(),
            decimation,
            row_s: plain.row_s(),
            response: plain.measured().iter().copied().collect(),
            fitted: fitted.iter().copied().collect(),
            noise,
            remarks: remarks(&modes, &free, plain.is_forced(), is_force, turns, seconds),
            modes,
        },
        free,
        is_force,
        delay,
    })
}

fn decimation(log: &PositionLog, samples: usize, coarse: usize, modes: &[Mode]) -> usize {
    let fastest = modes.iter().map(|mode| mode.frequency_hz).fold(0.0, f64::max);
    let wanted = if fastest > 0.0 {
        (1.0 / (fastest * log.sample_s * ROWS_PER_PERIOD)).round() as usize
    } else {
        coarse
    };
    wanted.clamp(samples.div_ceil(MOST_ROWS), (samples / LEAST_SAMPLES).max(1))
}

/// Whether a motor moves in both directions fast enough for dry friction to matter.
fn turns_round(way: &[f64]) -> bool {
    /// Fraction of the largest velocity below which the motor counts as being at rest.
    const REST: f64 = 0.1;
    let velocities: Vec<f64> = way.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let fastest = largest(&velocities);
    let goes = |sign: f64| velocities.iter().any(|v| *v * sign > REST * fastest);
    goes(1.0) && goes(-1.0)
}

/// Number of periods in a log of the frequency at which a motor moves as a whole.
const SLOW_PERIODS: f64 = 5.0;

/// A fitted motion of a motor as a function of s, with its uncertainty.
struct Model {
    /// Logarithms of frequency and damping ratio of each mode, then the coefficients.
    parameters: Vec<f64>,
    modes: usize,
    per_mode: usize,
    rate: f64,
    /// Frequency in rad/s far below those of the modes.
    slow: f64,
    /// Covariance of the parameters for rows of variance 1; `None` if the rows do not determine them.
    covariance: Option<DMatrix<f64>>,
    /// Derivatives of the rows with respect to the parameters, and the residual of the fit.
    slopes: DMatrix<f64>,
    residual: DVector<f64>,
    /// Standard deviation of a row.
    row: f64,
}

/// Coefficients of a polynomial, the constant first.
type Polynomial = Vec<f64>;

fn times(a: &[f64], b: &[f64]) -> Polynomial {
    let mut product = vec![0.0; a.len() + b.len() - 1];
    for (n, a) in a.iter().enumerate() {
        for (m, b) in b.iter().enumerate() {
            product[n + m] += a * b;
        }
    }
    product
}

fn plus(a: &[f64], b: &[f64]) -> Polynomial {
    let at = |p: &[f64], n: usize| p.get(n).copied().unwrap_or(0.0);
    (0..a.len().max(b.len())).map(|n| at(a, n) + at(b, n)).collect()
}

/// Returns the roots, as eigenvalues of the companion matrix.
fn roots(polynomial: &[f64]) -> Vec<Complex<f64>> {
    const NOTHING: f64 = 1e-13;
    let size = largest(polynomial);
    let degree = polynomial.iter().rposition(|c| c.abs() > NOTHING * size).unwrap_or(0);
    if degree == 0 {
        return Vec::new();
    }
    let companion = DMatrix::from_fn(degree, degree, |row, column| match (row, column) {
        (row, column) if column + 1 == degree => -polynomial[row] / polynomial[degree],
        (row, column) if row == column + 1 => 1.0,
        _ => 0.0,
    });
    companion.complex_eigenvalues().iter().copied().collect()
}

impl Model {
    fn new(problem: &HeldModes<'_>, found: &Found, rate: f64) -> Self {
        let solution = &found.solution;
        let basis = problem.basis(&solution.unknowns);
        let slopes = problem.slopes(&solution.unknowns, &basis, &solution.coefficients);
        let columns = [slopes.as_slice(), basis.as_slice()].concat();
        let slopes = DMatrix::from_vec(basis.nrows(), slopes.ncols() + basis.ncols(), columns);
        Self {
            parameters: [&solution.unknowns[..], solution.coefficients.as_slice()].concat(),
            modes: found.modes.len(),
            per_mode: problem.per_mode(),
            rate,
            slow: TAU * SLOW_PERIODS / (problem.row_s() * problem.len() as f64),
            covariance: Gram::of(&slopes).map(|gram| gram.inverse()),
            residual: problem.measured() - &solution.fitted,
            slopes,
            row: solution.reduced_square().sqrt(),
        }
    }

    /// Frequency in rad/s of the fastest mode, which is the unit of a scaled s.
    fn fastest(&self) -> f64 {
        let frequencies = (0..self.modes).map(|k| TAU * self.parameters[2 * k].exp());
        frequencies.fold(0.0, f64::max)
    }

    /// Returns the factors `r₁` and `r₂` of the rigid motion, and the gain of what acts at once.
    fn rigid(&self, parameters: &[f64]) -> [f64; 3] {
        let rest = &parameters[(2 + self.per_mode) * self.modes..];
        let at = |n: usize| rest.get(n).copied().unwrap_or(0.0);
        let at_once = (0..RigidBody::TAPS).map(at).sum();
        [at(RigidBody::TAPS), at(RigidBody::TAPS + 1), at_once]
    }

    /// Whether the command acts more like a force than like a velocity at the slow frequency.
    fn is_force(&self) -> bool {
        let [velocity, force, _] = self.rigid(&self.parameters);
        force.abs() > (velocity * Complex::new(self.rate, self.slow)).norm()
    }

    /// Numerator of the model as a polynomial in s in units of `unit` rad/s.
    fn numerator(&self, parameters: &[f64], unit: f64) -> Polynomial {
        let (rate, [velocity, force, at_once]) = (self.rate / unit, self.rigid(parameters));
        let (velocity, force) = (velocity / unit, force / (unit * unit));
        let denominator = |k: usize| {
            let (omega, damping) = self.mode(parameters, k);
            let omega = omega / unit;
            vec![omega * omega, 2.0 * damping * omega, 1.0]
        };
        let others = |but: Option<usize>| {
            let others = (0..self.modes).filter(|k| Some(*k) != but);
            others.fold(vec![1.0], |product, k| times(&product, &denominator(k)))
        };
        let rigid = [velocity * rate + force, velocity + at_once * rate, at_once];
        (0..self.modes).fold(times(&rigid, &others(None)), |sum, k| {
            let (omega, damping) = self.mode(parameters, k);
            let omega = omega / unit;
            let coefficients = &parameters[2 * self.modes + self.per_mode * k..];
            let (along, across) = (coefficients[0], coefficients[1]);
            // ω/(s − p): real and imaginary part of its response to a real input.
            let damped = omega * (1.0 - damping * damping).max(0.0).sqrt();
            let own = [omega * (along * damping * omega + across * damped), omega * along];
            plus(&sum, &times(&times(&own, &[0.0, rate, 1.0]), &others(Some(k))))
        })
    }

    fn mode(&self, parameters: &[f64], k: usize) -> (f64, f64) {
        (TAU * parameters[2 * k].exp(), parameters[2 * k + 1].exp())
    }

    /// The zeros above the real axis, in rad/s.
    fn zeros(&self) -> Vec<Complex<f64>> {
        let unit = self.fastest();
        let zeros = roots(&self.numerator(&self.parameters, unit)).into_iter();
        zeros.filter(|zero| zero.im > 0.0).map(|zero| zero * unit).collect()
    }

    /// Finds the zero near another one, for parameters that differ a little.
    fn zero_near(&self, parameters: &[f64], near: Complex<f64>) -> Complex<f64> {
        let unit = self.fastest();
        let polynomial = self.numerator(parameters, unit);
        (0..3).fold(near / unit, |at, _| {
            let (value, slope) = value_and_slope(&polynomial, at);
            at - value / slope
        }) * unit
    }

    /// Mass that swings in a held mode, relative to the mass that the drive moves; with a velocity drive, in an arbitrary unit.
    fn mass(&self, zero: Complex<f64>) -> f64 {
        let unit = self.fastest();
        let at = zero / unit;
        let (_, slope) = value_and_slope(&self.numerator(&self.parameters, unit), at);
        let rate = self.rate / unit;
        let below = (0..self.modes).fold(at * (at + rate), |product, k| {
            let (omega, damping) = self.mode(&self.parameters, k);
            let omega = omega / unit;
            product * (at * at + 2.0 * damping * omega * at + omega * omega)
        });
        // Residue of 1/(s²·x/u), which is m·(2ζωs + ω²)/(s − p*) at s = p.
        let [velocity, force, _] = self.rigid(&self.parameters);
        if self.is_force() {
            (below / slope * (2.0 * at.im) / at.powu(4)).norm() * (force / (unit * unit)).abs()
        } else {
            (below / slope * (2.0 * at.im) / at.powu(3)).norm() * (velocity / unit).abs()
        }
    }

    /// Standard deviations of the logarithms of frequency and damping ratio of a zero; `seconds` is the length of the log.
    fn deviations(&self, zero: Complex<f64>, seconds: f64) -> [f64; 2] {
        /// Step of a derivative, in standard deviations.
        const STEP: f64 = 1e-3;
        /// Largest step relative to the parameter.
        const LARGEST_STEP: f64 = 1e-4;
        let Some(covariance) = &self.covariance else {
            return [f64::INFINITY; 2];
        };
        let logarithms = |zero: Complex<f64>| [zero.norm().ln(), (-zero.re / zero.norm()).max(1e-9).ln()];
        let base = logarithms(self.zero_near(&self.parameters, zero));
        let mut gradients = [0, 1].map(|_| DVector::zeros(self.parameters.len()));
        for n in 0..self.parameters.len() {
            let deviation = STEP * self.row * covariance[(n, n)].max(0.0).sqrt();
            // Parameters that the rows do not determine must not move the zero far away.
            let step = deviation.min(
                LARGEST_STEP
                    * if n < 2 * self.modes {
                        1.0
                    } else {
                        self.parameters[n].abs()
                    },
            );
            if step == 0.0 {
                continue;
            }
            let mut moved = self.parameters.clone();
            moved[n] += step;
            let there = logarithms(self.zero_near(&moved, zero));
            for k in 0..2 {
                gradients[k][n] = (there[k] - base[k]) / step;
            }
        }
        let stretches = stretches(-zero.re, seconds);
        gradients.map(|gradient| {
            let direction = covariance * &gradient;
            let alone = self.row * gradient.dot(&direction).max(0.0).sqrt();
            alone.max(deviation_over_stretches(
                &self.slopes,
                &self.residual,
                &direction,
                stretches,
            ))
        })
    }
}

fn value_and_slope(polynomial: &[f64], at: Complex<f64>) -> (Complex<f64>, Complex<f64>) {
    let zero = Complex::new(0.0, 0.0);
    let step = |(value, slope): (Complex<f64>, Complex<f64>), c: &f64| (value * at + c, slope * at + value);
    polynomial.iter().rev().fold((zero, zero), step)
}

/// Returns the zeros that are vibrations, and that the fit determines.
fn reported_modes(problem: &HeldModes<'_>, found: &Found, model: &Model) -> Vec<FoundMode> {
    /// Largest ratio of a held mode's frequency to that of the fastest free mode: held modes are below the free ones with a torque drive,
    /// beside them with a velocity drive.
    const ABOVE: f64 = 1.3;
    /// Smallest share of the mass for a mode that rings much for its mass, because it is slow.
    const LEAST_MASS: f64 = 0.015;
    if found.modes.is_empty() || !problem.is_forced() {
        return Vec::new();
    }
    let seconds = problem.row_s() * problem.len() as f64;
    let highest = model.fastest() / TAU;
    let mut kept: Vec<(FoundMode, f64)> = Vec::new();
    for zero in model.zeros() {
        let mode = Mode {
            frequency_hz: zero.norm() / TAU,
            damping: -zero.re / zero.norm(),
        };
        let [frequency, damping] = model.deviations(zero, seconds);
        let is_vibration = (0.0..NO_VIBRATION).contains(&mode.damping)
            && mode.frequency_hz < ABOVE * highest
            && mode.frequency_hz * seconds > 1.0
            && frequency < VAGUE_FREQUENCY
            && damping * mode.damping < VAGUE_DAMPING * mode.damping.max(0.01);
        if is_vibration {
            let found = FoundMode {
                mode,
                participation: 0.0,
                frequency_sd_hz: mode.frequency_hz * frequency,
                damping_sd: mode.damping * damping,
            };
            kept.push((found, model.mass(zero)));
        }
    }
    let whole: f64 = kept.iter().map(|(_, mass)| mass).sum();
    let rings = |(found, mass): &(FoundMode, f64)| mass / found.mode.omega().powi(2);
    let all: f64 = kept.iter().map(rings).sum();
    // A pole that fits noise has a zero beside it with almost no mass.
    let one = if model.is_force() { whole.max(1.0) } else { whole };
    kept.retain(|mode| mode.1 >= LEAST_SHARE * one || (mode.1 >= LEAST_MASS * one && rings(mode) >= LEAST_SHARE * all));
    let modes = kept.into_iter().map(|(found, mass)| FoundMode {
        participation: mass,
        ..found
    });
    that_ring(modes.collect())
}

fn remarks(
    modes: &[FoundMode],
    free: &[Mode],
    is_forced: bool,
    is_force: bool,
    turns: bool,
    seconds: f64,
) -> Vec<PositionRemark> {
    const FEW_PERIODS: f64 = 3.0;
    if !is_forced {
        return vec![PositionRemark::NoDrive];
    }
    if modes.is_empty() {
        return vec![if is_force {
            PositionRemark::RigidMotor
        } else {
            PositionRemark::StiffDrive
        }];
    }
    let few = modes.iter().filter_map(|found| {
        let frequency_hz = found.mode.frequency_hz;
        let periods = seconds * frequency_hz;
        (periods < FEW_PERIODS).then_some(PositionRemark::FewPeriods { frequency_hz, periods })
    });
    let free = free.iter().filter(|_| is_force).map(|mode| PositionRemark::MotorFree {
        frequency_hz: mode.frequency_hz,
        damping: mode.damping,
    });
    let turns = (turns && is_force).then_some(PositionRemark::TurnsRound);
    few.chain(free).chain(turns).collect()
}
