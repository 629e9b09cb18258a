//! Marlin: `M593` (ZV in the stepper interrupt) and `M493` (fixed-time motion, `FT_MOTION`).
//!
//! ```text
//! M593 X F.. D..     delay 1/(2F), whatever D is; second amplitude K/(1 + K), K = e^(−πD/√(1 − D²)), by a cubic fit of D, rounded down to 1/128
//! M493 X C2 A.. I..  delay of the second impulse base/(A·√(1 − I²)), rounded to whole samples of 1 ms; the others are its multiples
//! ```
//!
//! `base` is half a period, and 3/8 of `MZV`, whose amplitudes `1, √2·K, K²` decay by half periods all the same, so that a damped mode
//! is not quite cancelled.

use super::{classic_ei, normalised};
use crate::impulse::ImpulseSequence;

/// Sample rate of fixed-time motion, `FTM_FS`, in Hz.
pub const FT_SAMPLE_HZ: f64 = 1000.0;
/// Lowest frequency of fixed-time motion by default, `FTM_MIN_SHAPE_FREQ`, in Hz.
pub const FT_LEAST_HZ: f64 = 20.0;
/// Damping ratios that `M493 I` takes.
pub const FT_DAMPING: [f64; 2] = [0.01, 0.25];

/// Coefficients of the fit by which `M593` computes 128 times the second amplitude from the damping ratio.
const M593_FIT: [f64; 4] = [64.440_561_92, -99.020_088_32, -7.580_954_88, 43.073_216];

/// The fit at a damping ratio, before it is rounded down.
fn m593_fit(damping: f64) -> f64 {
    M593_FIT
        .iter()
        .rev()
        .fold(0.0, |value, coefficient| value * damping + coefficient)
}

/// The impulses that `M593` makes of a frequency in Hz and a damping ratio; `None` for values that Marlin refuses.
pub fn m593(frequency_hz: f64, damping: f64) -> Option<ImpulseSequence> {
    half_swing(damping)?;
    let second = if damping > 0.0 {
        m593_fit(damping).floor() / 128.0
    } else {
        0.5
    };
    normalised(&[0.0, 0.5 / frequency_hz], &[1.0 - second, second])
}

/// The damping ratio to write after `D`, with which the amplitudes of `M593` come nearest to those of a mode: its own, unless rounding down
/// misses the nearest 1/128.
pub fn m593_damping(damping: f64) -> f64 {
    let Some(half_swing) = half_swing(damping) else {
        return damping;
    };
    let nearest = (128.0 * half_swing / (1.0 + half_swing)).round();
    if damping == 0.0 || m593_fit(damping).floor() == nearest {
        return damping;
    }
    // The fit falls up to a damping ratio of 0.9; the middle of its step is the safest.
    let (mut low, mut high) = (0.0, 0.9);
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        if m593_fit(middle) > nearest + 0.5 {
            low = middle
        } else {
            high = middle
        }
    }
    if m593_fit(high).floor() == nearest {
        high
    } else {
        damping
    }
}

/// Compensators of `M493`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)] // the names are the documentation
pub enum FtKind {
    Zv,
    Zvd,
    Zvdd,
    Zvddd,
    Ei,
    TwoHumpEi,
    ThreeHumpEi,
    Mzv,
}

impl FtKind {
    /// All of them, with the number that `M493` takes and Marlin's name.
    pub const ALL: [(FtKind, u8, &'static str); 8] = [
        (FtKind::Zv, 1, "ZV"),
        (FtKind::Zvd, 2, "ZVD"),
        (FtKind::Zvdd, 3, "ZVDD"),
        (FtKind::Zvddd, 4, "ZVDDD"),
        (FtKind::Ei, 5, "EI"),
        (FtKind::TwoHumpEi, 6, "2HEI"),
        (FtKind::ThreeHumpEi, 7, "3HEI"),
        (FtKind::Mzv, 8, "MZV"),
    ];

    /// Number of humps of an EI kind, which takes a tolerance; `None` for the others.
    pub fn humps(self) -> Option<usize> {
        match self {
            FtKind::Ei => Some(1),
            FtKind::TwoHumpEi => Some(2),
            FtKind::ThreeHumpEi => Some(3),
            _ => None,
        }
    }

    /// The impulses that `M493` makes of a frequency in Hz, a damping ratio and the tolerance of the EI kinds; `None` for values that it
    /// refuses.
    pub fn impulses(self, frequency_hz: f64, damping: f64, tolerance: f64) -> Option<ImpulseSequence> {
        let k = half_swing(damping)?;
        let amplitudes = match self {
            FtKind::Zv => vec![1.0, k],
            FtKind::Zvd => vec![1.0, 2.0 * k, k * k],
            FtKind::Zvdd => vec![1.0, 3.0 * k, 3.0 * k * k, k.powi(3)],
            FtKind::Zvddd => vec![1.0, 4.0 * k, 6.0 * k * k, 4.0 * k.powi(3), k.powi(4)],
            FtKind::Mzv => vec![1.0, 2.0f64.sqrt() * k, k * k],
            FtKind::Ei | FtKind::TwoHumpEi | FtKind::ThreeHumpEi => {
                classic_ei::amplitudes(self.humps().unwrap_or(1), tolerance, k)
            }
        };
        let base = if self == FtKind::Mzv { 0.375 } else { 0.5 };
        let step = (base / frequency_hz / (1.0 - damping * damping).sqrt() * FT_SAMPLE_HZ).round();
        let times_s: Vec<f64> = (0..amplitudes.len()).map(|n| n as f64 * step / FT_SAMPLE_HZ).collect();
        normalised(&times_s, &amplitudes)
    }
}

/// Ratio of two half swings of a mode that is damped by `damping`.
fn half_swing(damping: f64) -> Option<f64> {
    (0.0..1.0)
        .contains(&damping)
        .then(|| (-damping * std::f64::consts::PI / (1.0 - damping * damping).sqrt()).exp())
}
