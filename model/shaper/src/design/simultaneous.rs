//! `simultaneous`: one shaper for all modes, with impulses of alternating sign and bounded partial sums.
//!
//! ```text
//! ps: amplitudes 1, −2, 2, …, 2: partial sums −1 … 1        um: 1, −1, 1, …, 1: partial sums 0 … 1
//! zv:  S(p) = Σ A_i e^{p t_i} = 0                           zvd: also Σ A_i t_i e^{p t_i} = 0,   p = ζω + jω_d
//! ```
//!
//! A `zv` mode gives two real equations and a `zvd` mode four, and there are as many unknown times. With two modes
//! that is half the impulses of the convolution of two `ps-zv`, and the shaper is shorter and keeps the bounds that a
//! convolution breaks. The price is robustness: other frequencies than the modes' are amplified.
//!
//! First the shortest command within the bounds is found (`time_optimal`). If it has as many jumps as there are
//! equations it is this shaper, and no bounded command is shorter ([`Simultaneous::is_time_optimal`]). Otherwise, as
//! with frequencies far apart, Newton's method starts from several thousand deterministic pseudo-random sequences.
//! The shortest solution found is returned, and it is *not* proven to be the shortest.
//!
//! Limits: 1 to [`MODES_MAX`] modes.

use nalgebra::{Complex, DMatrix, DVector};

pub use super::constraint::{Amplitudes, Constraint};

use super::DesignError;
use super::joint::{Findings, check_zeros};
use super::joint_error::{JointError, check_distinct};
use super::kind::{Design, KindRow, Promise, ShaperKind};
use super::time_optimal::Problem;
use crate::axis::ShapedAxis;
use crate::impulse::{Impulse, ImpulseSequence};
use crate::mode::Mode;

/// `simultaneous`.
pub(super) const SIMULTANEOUS: KindRow = KindRow::new(
    "simultaneous",
    Promise::Unsaid,
    Design::Axis(|axis, _| design_axis(axis)),
    "one shaper with bounded partial sums for at most 4 modes: short, and sensitive",
)
.keys(&["amplitude"]);

/// Largest number of modes that are solved together.
pub const MODES_MAX: usize = 4;

/// A simultaneous shaper.
#[derive(Debug, Clone, PartialEq)]
pub struct Simultaneous {
    /// The impulses.
    pub impulses: ImpulseSequence,
    /// Whether it is proven that no command within the bounds is shorter, with any number of jumps.
    pub is_time_optimal: bool,
}

/// Designs the shaper of an axis by the keys of the machine file.
fn design_axis(axis: ShapedAxis<'_>) -> Result<(ImpulseSequence, Findings), DesignError> {
    let given = axis.shaper;
    let amplitudes = match given.and_then(|s| s.amplitude.as_deref()) {
        Some("um") => Amplitudes::UnitMagnitude,
        _ => Amplitudes::PartialSum,
    };
    let constraints = axis.modes.iter().map(|m| match axis.kind_of(m) {
        ShaperKind::Zv => Ok((m.mode, Constraint::Zv)),
        ShaperKind::Zvd => Ok((m.mode, Constraint::Zvd)),
        other => Err(JointError::Constraint(other)),
    });
    let constraints: Vec<(Mode, Constraint)> = constraints.collect::<Result<_, _>>()?;
    let found = design(&constraints, amplitudes)?;
    check_zeros(ShaperKind::Simultaneous, &found.impulses, axis)?;
    Ok((found.impulses.clone(), Findings::Simultaneous(found)))
}

/// Designs a shaper that meets every mode's constraint.
///
/// # Errors
/// [`JointError::TooManyModes`], [`JointError::Coincident`]; [`JointError::NoSimultaneous`] where no sequence was found;
/// [`DesignError`] for an invalid mode or times beyond `f64`.
pub fn design(modes: &[(Mode, Constraint)], amplitudes: Amplitudes) -> Result<Simultaneous, DesignError> {
    let plain: Vec<Mode> = modes.iter().map(|(mode, _)| *mode).collect();
    plain.iter().try_for_each(DesignError::check_mode)?;
    check_distinct(&plain)?;
    if modes.is_empty() || modes.len() > MODES_MAX {
        return Err(JointError::TooManyModes {
            found: modes.len(),
            most: MODES_MAX,
        }
        .into());
    }
    // Times are in radians of the fastest mode, so that they are of order one whatever the frequencies.
    let fastest = plain.iter().map(Mode::omega_damped).fold(0.0, f64::max);
    let poles = modes.iter().map(|(mode, constraint)| {
        let pole = Complex::new(mode.decay(), mode.omega_damped()) / fastest;
        (pole, *constraint)
    });
    let system = System {
        poles: poles.collect(),
        amplitudes,
    };
    let (times, is_time_optimal) = system.solve().ok_or(JointError::NoSimultaneous {
        impulses: system.unknowns() + 1,
        amplitudes: amplitudes.text(),
    })?;
    let later = times.iter().enumerate().map(|(index, time)| Impulse {
        time_s: time / fastest,
        amplitude: amplitudes.at(index + 1),
    });
    let first = Impulse {
        time_s: 0.0,
        amplitude: 1.0,
    };
    let impulses = ImpulseSequence::new([first].into_iter().chain(later).collect());
    Ok(Simultaneous {
        impulses: impulses.map_err(|cause| DesignError::NoSequence {
            what: format!("shaper \"{}\"", ShaperKind::Simultaneous),
            cause,
        })?,
        is_time_optimal,
    })
}

/// The constraints, as equations for the times after the first, which is 0.
struct System {
    poles: Vec<(Complex<f64>, Constraint)>,
    amplitudes: Amplitudes,
}

/// Largest value at which an equation counts as zero; each is of order one.
const ACCURACY: f64 = 1e-12;
const NEWTON_ROUNDS: usize = 60;
/// Largest number of Newton steps of all starts together, times the cube of the number of unknowns: some tenths of a
/// second.
const BUDGET: usize = 8_000_000;

impl System {
    fn unknowns(&self) -> usize {
        self.poles.iter().map(|(_, constraint)| constraint.equations()).sum()
    }

    /// Solves for the times. Returns them and whether they are time-optimal.
    fn solve(&self) -> Option<(DVector<f64>, bool)> {
        let problem = Problem {
            poles: &self.poles,
            amplitudes: self.amplitudes,
        };
        let optimal = problem
            .solve()
            .filter(|o| o.starts_high && o.times.len() == self.unknowns());
        if let Some(start) = optimal.map(|o| DVector::from_vec(o.times)) {
            let near = |times: &DVector<f64>| (times - &start).amax() < 1e-2 * start.amax();
            let mut steps = NEWTON_ROUNDS;
            let found = self.refine(start.clone(), &mut steps);
            if let Some(times) = found.filter(near) {
                return Some((times, true));
            }
        }
        self.search().map(|times| (times, false))
    }

    /// The shortest solution from pseudo-random starts.
    fn search(&self) -> Option<DVector<f64>> {
        let unknowns = self.unknowns();
        let periods = self
            .poles
            .iter()
            .map(|(pole, constraint)| constraint.equations() as f64 / 4.0 / pole.im);
        let longest = 1.2 * std::f64::consts::TAU * periods.sum::<f64>();
        let mut random = Random(0x9E37_79B9_7F4A_7C15);
        let mut steps = BUDGET / (unknowns * unknowns * unknowns);
        let mut shortest: Option<DVector<f64>> = None;
        while steps > 0 {
            // A start is never longer than the shortest solution so far, since only shorter ones are of interest.
            let end = shortest.as_ref().map_or(longest, |times| times[unknowns - 1]) * random.next().sqrt();
            let mut times: Vec<f64> = (1..unknowns).map(|_| end * random.next()).chain([end]).collect();
            times.sort_by(f64::total_cmp);
            let found = self.refine(DVector::from_vec(times), &mut steps);
            let is_shorter = |found: &DVector<f64>| match &shortest {
                Some(times) => found[unknowns - 1] < times[unknowns - 1],
                None => true,
            };
            if let Some(found) = found.filter(is_shorter) {
                shortest = Some(found);
            }
        }
        shortest
    }

    /// Damped Newton's method: returns a solution whose times increase, or `None`. It subtracts its steps from
    /// `steps`.
    fn refine(&self, start: DVector<f64>, steps: &mut usize) -> Option<DVector<f64>> {
        let mut times = start;
        let (mut values, mut jacobian) = self.equations(&times);
        for _ in 0..NEWTON_ROUNDS {
            *steps = steps.saturating_sub(1);
            let step = jacobian.lu().solve(&values)?;
            let error = values.norm();
            let mut share = 1.0;
            loop {
                let next = &times - &step * share;
                let (next_values, next_jacobian) = self.equations(&next);
                let next_error = next_values.norm();
                // Rounding ends the descent; before that every step must make progress.
                if next_error < error * (1.0 - 0.1 * share) || (share == 1.0 && next_error < ACCURACY) {
                    (times, values, jacobian) = (next, next_values, next_jacobian);
                    break;
                }
                share /= 2.0;
                if share < 0.05 {
                    return None;
                }
            }
            if values.amax() < ACCURACY && (step.amax() * share < 1e-13 * times.amax() || values.amax() < 1e-15) {
                break;
            }
        }
        let increasing = times[0] > 0.0 && times.as_slice().windows(2).all(|pair| pair[0] < pair[1]);
        (increasing && values.amax() < ACCURACY).then_some(times)
    }

    /// The constraints and their derivatives, referred to the last impulse so that nothing grows.
    fn equations(&self, times: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let unknowns = times.len();
        let end = times[unknowns - 1];
        let mut values = DVector::zeros(unknowns);
        let mut jacobian = DMatrix::zeros(unknowns, unknowns);
        let mut row = 0;
        for &(pole, constraint) in &self.poles {
            // e^{p(t − end)} and p(t − end)·e^{p(t − end)}: the second moment about the end is zero where that about 0 is.
            let first = (-pole * end).exp();
            let mut sum = first;
            let mut moment = -pole * end * first;
            for (index, time) in times.iter().enumerate() {
                let phase = pole * (time - end);
                let term = phase.exp() * self.amplitudes.at(index + 1);
                sum += term;
                moment += phase * term;
                let (slope, moment_slope) = (pole * term, pole * (1.0 + phase) * term);
                set_column(&mut jacobian, row, index, slope);
                if constraint == Constraint::Zvd {
                    set_column(&mut jacobian, row + 2, index, moment_slope);
                }
            }
            // The last time is also the reference of all terms.
            let last = unknowns - 1;
            add_column(&mut jacobian, row, last, -pole * sum);
            values[row] = sum.re;
            values[row + 1] = sum.im;
            if constraint == Constraint::Zvd {
                add_column(&mut jacobian, row + 2, last, -pole * (sum + moment));
                values[row + 2] = moment.re;
                values[row + 3] = moment.im;
            }
            row += constraint.equations();
        }
        (values, jacobian)
    }
}

fn set_column(matrix: &mut DMatrix<f64>, row: usize, column: usize, value: Complex<f64>) {
    matrix[(row, column)] = value.re;
    matrix[(row + 1, column)] = value.im;
}

fn add_column(matrix: &mut DMatrix<f64>, row: usize, column: usize, value: Complex<f64>) {
    matrix[(row, column)] += value.re;
    matrix[(row + 1, column)] += value.im;
}

/// Marsaglia's xorshift generator, so that the starts are the same in every run.
struct Random(u64);

impl Random {
    /// Next number in (0, 1).
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        ((self.0 >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }
}
