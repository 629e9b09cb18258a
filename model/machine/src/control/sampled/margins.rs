//! Stability and margins of a sampled loop, from its Nyquist curve.
//!
//! The open loop has no poles outside the unit circle. So the closed loop has as many poles there as `1 + L(z)` turns
//! clockwise round 0 while `z` goes once round a circle slightly larger than the unit circle. The curve is refined
//! until the direction changes little in each step.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use super::{LinearLaw, SampledLoop};

/// Points of the curve per decade of frequency, before refinement.
const PER_DECADE: f64 = 24.0;
/// Lowest frequency, as a fraction of π/T.
const LOWEST: f64 = 1e-7;
/// Growth rate that still counts as stable, as a fraction of the lowest frequency, so that the open loop's
/// integrators stay inside the circle.
const GROWTH: f64 = 0.1;
/// Largest change of the direction of `L` or `1 + L` between two points, in rad, and largest relative change of |L|.
const TURN: f64 = 0.12;
const CHANGE: f64 = 1.2;
/// A gain counts as within the stability limit up to this fraction of it.
const NEARLY: f64 = 0.98;
/// Largest number of bisections of a step.
const DEPTH: u32 = 40;

/// Stability margins of a loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Margins {
    /// Whether the loop is stable. For an unstable loop the other figures show how far it is beyond the limit.
    pub stable: bool,
    /// Factor on the feedback at which the loop reaches the stability limit: above 1 for a stable loop, below 1 for
    /// one that lower gains make stable. Infinite where no gain is too high; `None` where the loop is unstable at any
    /// gain.
    pub gain_margin: Option<f64>,
    /// The lower factor at which the loop reaches the limit, for a loop that lower gains make unstable.
    pub gain_reduction: Option<f64>,
    /// Smallest distance of the phase from −180° where |L| is 1, in degrees; `None` where |L| never is 1.
    pub phase_margin_deg: Option<f64>,
    /// Additional dead time at which the loop becomes unstable, s.
    pub delay_margin_s: Option<f64>,
    /// Smallest distance of `L` from −1, which is the inverse of the largest sensitivity.
    pub modulus_margin: f64,
    /// Highest frequency at which |L| is 1, in Hz.
    pub crossover_hz: Option<f64>,
}

impl Margins {
    /// The gain margin in dB.
    pub fn gain_margin_db(&self) -> Option<f64> {
        self.gain_margin.map(|factor| 20.0 * factor.log10())
    }
}

/// A point of the Nyquist curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NyquistPoint {
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// Open loop `L` at this frequency.
    pub open_loop: Complex<f64>,
}

impl SampledLoop {
    /// Margins of the loop with this law.
    pub fn margins(&self, law: &LinearLaw) -> Margins {
        let curve = self.curve(law, 0.0);
        let stable = self.is_stable(law);
        let crossings = axis_crossings(&curve);
        let (gain_margin, gain_reduction) = if stable {
            let above = crossings.iter().copied().filter(|factor| *factor > 1.0);
            let below = crossings.iter().copied().filter(|factor| *factor <= 1.0);
            (Some(above.fold(f64::INFINITY, f64::min)), below.reduce(f64::max))
        } else {
            (self.largest_stable(law, &crossings), None)
        };
        let unity = unity_crossings(&curve);
        let distances = unity.iter().map(|(_, phase)| (PI - phase.abs()).to_degrees());
        // The phase falls towards −180° from where it is; a lead is a whole turn away from it.
        let delays = unity.iter().map(|(omega, phase)| (phase + PI).rem_euclid(TAU) / omega);
        Margins {
            stable,
            gain_margin,
            gain_reduction,
            phase_margin_deg: distances.reduce(f64::min),
            delay_margin_s: delays.reduce(f64::min),
            modulus_margin: distance(&curve),
            crossover_hz: unity.iter().map(|(omega, _)| omega / TAU).reduce(f64::max),
        }
    }

    /// Whether the loop with this law is stable and has at least this modulus margin.
    pub fn holds(&self, law: &LinearLaw, modulus_margin: f64) -> bool {
        let curve = self.curve(law, 0.0);
        distance(&curve) >= modulus_margin && self.is_stable(law)
    }

    /// Whether the loop with this law is stable.
    pub fn is_stable(&self, law: &LinearLaw) -> bool {
        let lowest = LOWEST * PI / self.tick_s;
        let growth = GROWTH * lowest;
        let start = 1.0 + self.open_loop(law, Complex::from((growth * self.tick_s).exp()));
        let curve = self.curve(law, growth);
        let points = std::iter::once(start).chain(curve.iter().map(|(_, open)| 1.0 + open));
        let points: Vec<Complex<f64>> = points.collect();
        if points
            .iter()
            .any(|point| !(point.re.is_finite() && point.im.is_finite()))
        {
            return false;
        }
        let turned: f64 = points.windows(2).map(|step| (step[1] / step[0]).arg()).sum();
        // The curve goes from the real axis to the real axis, so it makes a whole number of half turns.
        turned.abs() < PI / 2.0 && points.first().is_some_and(|first| first.re > 0.0)
    }

    /// The Nyquist curve by frequency, from a ten-millionth of the highest frequency on.
    pub fn nyquist(&self, law: &LinearLaw) -> Vec<NyquistPoint> {
        let points = self.curve(law, 0.0).into_iter();
        points
            .map(|(omega, open_loop)| NyquistPoint {
                frequency_hz: omega / TAU,
                open_loop,
            })
            .collect()
    }

    /// `L` by frequency in rad/s, at `z = e^{(growth + jω)T}`.
    fn curve(&self, law: &LinearLaw, growth: f64) -> Vec<(f64, Complex<f64>)> {
        let highest = PI / self.tick_s;
        let steps = (-LOWEST.log10() * PER_DECADE) as i32;
        let mut omegas: Vec<f64> = (0..=steps)
            .map(|step| highest * LOWEST.powf(f64::from(steps - step) / f64::from(steps)))
            .collect();
        for pole in &self.poles {
            let (width, centre) = (pole.pole.re.abs().max(1e-6 * pole.pole.im), pole.pole.im);
            for widths in [-8.0, -3.0, -1.0, -0.3, 0.1, 0.3, 1.0, 3.0, 8.0] {
                omegas.push(centre + widths * width);
            }
        }
        omegas.retain(|omega| *omega > 0.0 && *omega <= highest);
        omegas.sort_by(f64::total_cmp);
        let at = |omega: f64| {
            let z = (Complex::new(growth, omega) * self.tick_s).exp();
            (omega, self.open_loop(law, z))
        };
        let mut curve: Vec<(f64, Complex<f64>)> = Vec::with_capacity(2 * omegas.len());
        for omega in omegas {
            let next = at(omega);
            if let Some(last) = curve.last().copied() {
                refine(&at, last, next, DEPTH, &mut curve);
            }
            curve.push(next);
        }
        curve
    }

    /// The largest factor below 1 on the feedback at which the loop is stable, of those at which the curve passes −1.
    fn largest_stable(&self, law: &LinearLaw, crossings: &[f64]) -> Option<f64> {
        let mut below: Vec<f64> = crossings.iter().copied().filter(|factor| *factor < 1.0).collect();
        below.sort_by(|a, b| b.total_cmp(a));
        below
            .into_iter()
            .find(|factor| self.is_stable(&law.scaled(NEARLY * factor)))
    }
}

/// Adds points between two until the direction changes little in each step.
fn refine(
    at: &impl Fn(f64) -> (f64, Complex<f64>),
    from: (f64, Complex<f64>),
    to: (f64, Complex<f64>),
    depth: u32,
    curve: &mut Vec<(f64, Complex<f64>)>,
) {
    let turns = |a: Complex<f64>, b: Complex<f64>| (b / a).arg().abs() > TURN;
    let (a, b) = (from.1, to.1);
    let ratio = b.norm() / a.norm();
    // Where |L| is far below or far above 1, only the number of turns matters.
    let matters = a.norm().max(b.norm()) > 1e-3;
    let far = turns(1.0 + a, 1.0 + b) || matters && (turns(a, b) || !(1.0 / CHANGE..CHANGE).contains(&ratio));
    if !far || depth == 0 {
        return;
    }
    let middle = at((from.0 * to.0).sqrt());
    refine(at, from, middle, depth - 1, curve);
    curve.push(middle);
    refine(at, middle, to, depth - 1, curve);
}

/// Smallest distance of −1 from the lines between the points.
fn distance(curve: &[(f64, Complex<f64>)]) -> f64 {
    let steps = curve.windows(2).map(|step| {
        let (from, along) = (1.0 + step[0].1, step[1].1 - step[0].1);
        let nearest = -(from * along.conj()).re / along.norm_sqr();
        // A step without length, or one that is not finite, is represented by its start.
        let part = if nearest.is_finite() {
            nearest.clamp(0.0, 1.0)
        } else {
            0.0
        };
        (from + along * part).norm()
    });
    steps.fold(f64::INFINITY, f64::min)
}

/// The factors on `L` at which it passes through −1.
fn axis_crossings(curve: &[(f64, Complex<f64>)]) -> Vec<f64> {
    let steps = curve.windows(2).filter_map(|step| {
        let (a, b) = (step[0].1, step[1].1);
        // Phases count from the negative real axis; between two points phase and logarithm are interpolated linearly.
        let (of_a, of_b) = ((-a).arg(), (-b).arg());
        let crosses = (of_a < 0.0) != (of_b < 0.0) && (of_a - of_b).abs() < PI;
        let part = of_a / (of_a - of_b);
        crosses.then(|| 1.0 / (a.norm() * (b.norm() / a.norm()).powf(part)))
    });
    // L is real at the highest frequency.
    let last = curve
        .last()
        .map(|(_, open)| -1.0 / open.re)
        .filter(|factor| *factor > 0.0);
    steps.chain(last).collect()
}

/// Frequency in rad/s and phase in ±π of each point where |L| is 1.
fn unity_crossings(curve: &[(f64, Complex<f64>)]) -> Vec<(f64, f64)> {
    let steps = curve.windows(2).filter_map(|step| {
        let [(omega, a), (next, b)] = [step[0], step[1]];
        let (of_a, of_b) = (a.norm().ln(), b.norm().ln());
        if (of_a < 0.0) == (of_b < 0.0) {
            return None;
        }
        let part = of_a / (of_a - of_b);
        let phase = a.arg() + part * (b / a).arg();
        let phase = (phase + PI).rem_euclid(TAU) - PI;
        Some((omega * (next / omega).powf(part), phase))
    });
    steps.collect()
}
