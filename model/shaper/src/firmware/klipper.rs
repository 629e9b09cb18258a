//! Klipper's `[input_shaper]`, of its branch `advanced-features`, and of Kalico.
//!
//! `shaper_freq` is the undamped frequency `f`, `damping_ratio` is ζ. With `K` the ratio of two half swings and `T_d` the damped period:
//!
//! ```text
//! zv, zvd     amplitudes 1, K and 1, 2K, K²; times 0, T_d/2, T_d
//! mzv         n impulses over t·T_d, by default 3 over 3/4·T_d, with zeros at f and above it; amplitudes decay with the times
//! ei          by 2025: EI without damping, each amplitude times a power of K; since then fits of third degree in ζ and the tolerance v_tol
//! 2hump_ei, 3hump_ei    the same; the fits' times are in undamped periods 1/f
//! ```
//!
//! From September 2025 to March 2026 (v0.13.0-273 to -593), and in the two branches, `3hump_ei` lacks the terms of third degree: a comma was missing.

use super::{classic_ei, normalised};
use crate::impulse::ImpulseSequence;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

/// Damping ratio that Klipper uses if none is configured.
pub const DEFAULT_DAMPING: f64 = 0.1;
/// Tolerance of the EI kinds; only that of `ei` can be configured.
pub const DEFAULT_TOLERANCE: f64 = 0.05;

/// A kind of shaper.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)] // the names are the documentation
pub enum Kind {
    Zv,
    Mzv,
    Zvd,
    Ei,
    TwoHumpEi,
    ThreeHumpEi,
    /// `ei` with a tolerance of its own.
    EiOf {
        tolerance: f64,
    },
    /// `mzv` with `impulses` impulses over `periods` damped periods.
    MzvOf {
        impulses: usize,
        periods: f64,
    },
}

impl Kind {
    /// The kinds without parameters.
    pub const NAMED: [Kind; 6] = [
        Kind::Zv,
        Kind::Mzv,
        Kind::Zvd,
        Kind::Ei,
        Kind::TwoHumpEi,
        Kind::ThreeHumpEi,
    ];

    /// Text after `shaper_type_x:`. Klipper's parameters have no exponents.
    pub fn text(self) -> String {
        match self {
            Kind::Zv => "zv".into(),
            Kind::Mzv => "mzv".into(),
            Kind::Zvd => "zvd".into(),
            Kind::Ei => "ei".into(),
            Kind::TwoHumpEi => "2hump_ei".into(),
            Kind::ThreeHumpEi => "3hump_ei".into(),
            Kind::EiOf { tolerance } => format!("ei(v_tol={tolerance})"),
            Kind::MzvOf { impulses, periods } => format!("mzv(n={impulses},t={periods:?})"),
        }
    }

    /// Number of humps of an EI kind.
    fn humps(self) -> Option<usize> {
        match self {
            Kind::Ei | Kind::EiOf { .. } => Some(1),
            Kind::TwoHumpEi => Some(2),
            Kind::ThreeHumpEi => Some(3),
            _ => None,
        }
    }
}

/// Formulas of the EI kinds in a version.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EiFormulas {
    /// Those without damping, times powers of `K`.
    Classic,
    /// Fits; `3hump_ei` without its terms of third degree.
    FitsWithoutCubes,
    /// Fits.
    Fits,
}

/// Largest damping ratios that a version takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DampingLimits {
    /// Below 1 for every kind.
    BelowOne,
    /// 0.25 for every kind.
    Quarter,
    /// 0.99, and 0.4, 0.3 and 0.2 for EI kinds with one, two and three humps.
    ByKind,
}

impl DampingLimits {
    /// The largest damping ratio for a kind.
    pub fn of(self, kind: Kind) -> f64 {
        match (self, kind.humps()) {
            (DampingLimits::Quarter, _) => 0.25,
            (DampingLimits::ByKind, Some(1)) => 0.4,
            (DampingLimits::ByKind, Some(2)) => 0.3,
            (DampingLimits::ByKind, Some(_)) => 0.2,
            _ => 0.99,
        }
    }
}

/// `ei` of the fits, times in damped periods: coefficients of powers of the tolerance, for each power of ζ.
const EI_FIRST: [[f64; 2]; 3] = [[0.24968, 0.24961], [0.80008, 1.23328], [0.49599, 3.17316]];
const EI_LAST: [[f64; 2]; 3] = [[0.25149, 0.21474], [-0.83249, 1.41498], [0.85181, -4.90094]];
const EI_TIME: [[f64; 3]; 4] = [
    [0.4999, 0.0, 0.0],
    [0.0, 0.46159, 8.57843],
    [0.0, 4.26169, -108.644],
    [0.0, 1.75601, 336.989],
];

/// Coefficients of powers of ζ, for each impulse: amplitudes, and times in undamped periods.
type Fit<const N: usize> = [[f64; 4]; N];
const TWO_HUMP_AMPLITUDES: Fit<4> = [
    [0.16054, 0.76699, 2.26560, -1.22750],
    [0.33911, 0.45081, -2.58080, 1.73650],
    [0.34089, -0.61533, -0.68765, 0.42261],
    [0.15997, -0.60246, 1.00280, -0.93145],
];
const TWO_HUMP_TIMES: Fit<4> = [
    [0.0; 4],
    [0.49890, 0.16270, -0.54262, 6.16180],
    [0.99748, 0.18382, -1.58270, 8.17120],
    [1.49920, -0.09297, -0.28338, 1.85710],
];
const THREE_HUMP_AMPLITUDES: Fit<5> = [
    [0.11275, 0.76632, 3.29160, -1.44380],
    [0.23698, 0.61164, -2.57850, 4.85220],
    [0.30008, -0.19062, -2.14560, 0.13744],
    [0.23775, -0.73297, 0.46885, -2.08650],
    [0.11244, -0.45439, 0.96382, -1.46000],
];
const THREE_HUMP_TIMES: Fit<5> = [
    [0.0; 4],
    [0.49974, 0.23834, 0.44559, 12.4720],
    [0.99849, 0.29808, -2.36460, 23.3990],
    [1.49870, 0.10306, -2.01390, 17.0320],
    [1.99960, -0.28231, 0.61536, 5.40450],
];

fn polynomial(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |value, c| value * x + c)
}

/// A fit in two variables.
fn polynomial_of_two<const N: usize, const M: usize>(
    coefficients: &[[f64; N]; M],
    tolerance: f64,
    damping: f64,
) -> f64 {
    polynomial(&coefficients.map(|row| polynomial(&row, tolerance)), damping)
}

/// The impulses that Klipper makes of a kind, an undamped frequency in Hz and a damping ratio; `None` where it makes no shaper of them.
pub fn impulses(kind: Kind, formulas: EiFormulas, frequency_hz: f64, damping: f64) -> Option<ImpulseSequence> {
    if !(0.0..1.0).contains(&damping) || frequency_hz <= 0.0 {
        return None;
    }
    let root = (1.0 - damping * damping).sqrt();
    let half_swing = (-damping * PI / root).exp();
    let damped_s = 1.0 / (frequency_hz * root);
    let even = |amplitudes: Vec<f64>, step_s: f64| {
        let times_s: Vec<f64> = (0..amplitudes.len()).map(|n| n as f64 * step_s).collect();
        normalised(&times_s, &amplitudes)
    };
    match (kind, formulas, kind.humps()) {
        (Kind::Zv, ..) => even(vec![1.0, half_swing], 0.5 * damped_s),
        (Kind::Zvd, ..) => even(vec![1.0, 2.0 * half_swing, half_swing.powi(2)], 0.5 * damped_s),
        (Kind::Mzv, ..) => mzv(3, 0.75, damping, damped_s),
        (Kind::MzvOf { impulses, periods }, ..) => mzv(impulses, periods, damping, damped_s),
        (_, EiFormulas::Classic, Some(humps)) => even(
            classic_ei::amplitudes(humps, tolerance(kind), half_swing),
            0.5 * damped_s,
        ),
        (Kind::TwoHumpEi, ..) => fitted(&TWO_HUMP_TIMES, &TWO_HUMP_AMPLITUDES, 3, frequency_hz, damping),
        (Kind::ThreeHumpEi, EiFormulas::FitsWithoutCubes, _) => {
            // The two last coefficients of the first amplitude were one number, and their count became that of all rows.
            let mut amplitudes = THREE_HUMP_AMPLITUDES;
            amplitudes[0][2] += amplitudes[0][3];
            fitted(&THREE_HUMP_TIMES, &amplitudes, 2, frequency_hz, damping)
        }
        (Kind::ThreeHumpEi, ..) => fitted(&THREE_HUMP_TIMES, &THREE_HUMP_AMPLITUDES, 3, frequency_hz, damping),
        _ => {
            let v = tolerance(kind);
            let [first, last] = [EI_FIRST, EI_LAST].map(|fit| polynomial_of_two(&fit, v, damping));
            let middle_s = polynomial_of_two(&EI_TIME, v, damping) * damped_s;
            normalised(&[0.0, middle_s, damped_s], &[first, 1.0 - first - last, last])
        }
    }
}

fn tolerance(kind: Kind) -> f64 {
    match kind {
        Kind::EiOf { tolerance } => tolerance,
        _ => DEFAULT_TOLERANCE,
    }
}

/// A fit up to a power of the damping ratio.
fn fitted<const N: usize>(
    times: &Fit<N>,
    amplitudes: &Fit<N>,
    degree: usize,
    frequency_hz: f64,
    damping: f64,
) -> Option<ImpulseSequence> {
    let at = |fit: &Fit<N>| fit.map(|row| polynomial(&row[..=degree], damping));
    normalised(&at(times).map(|time| time / frequency_hz), &at(amplitudes))
}

/// `mzv` with any number of impulses over any duration: equal steps, and zeros at `f(1 + i/τ)` with `τ = t(n − 2)/(n − 2t − 1)`.
fn mzv(count: usize, periods: f64, damping: f64, damped_s: f64) -> Option<ImpulseSequence> {
    let n = count as f64;
    if count < 3 || n <= 2.0 * periods + 1.0 + 1e-7 {
        return None;
    }
    let spread = periods * (n - 2.0) / (n - 2.0 * periods - 1.0);
    let step = periods / (n - 1.0);
    // The equations are consistent, so that least squares solve them; those of the last zeros follow from the others.
    let rows = 1 + 2 * (count - 1);
    let equations = DMatrix::from_fn(rows, count, |row, column| match row {
        0 => 1.0,
        _ => {
            let zero = ((row - 1) / 2) as f64;
            let angle = 2.0 * PI * (1.0 + zero / spread) * column as f64 * step;
            if row % 2 == 1 { angle.cos() } else { angle.sin() }
        }
    });
    let mut wanted = DVector::zeros(rows);
    wanted[0] = 1.0;
    let undamped = equations.svd(true, true).solve(&wanted, 1e-9).ok()?;
    if undamped.iter().any(|amplitude| *amplitude < -1e-5) {
        return None;
    }
    let decay = (-2.0 * PI * step * damping / (1.0 - damping * damping).sqrt()).exp();
    let powers = std::iter::successors(Some(1.0), |power| Some(power * decay));
    let amplitudes: Vec<f64> = undamped
        .iter()
        .zip(powers)
        .map(|(amplitude, power)| amplitude * power)
        .collect();
    let times_s: Vec<f64> = (0..count).map(|i| i as f64 * step * damped_s).collect();
    normalised(&times_s, &amplitudes)
}
