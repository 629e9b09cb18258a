//! `antisymmetric`: one shaper for all modes of an axis that are inverted after the same time, a common antiperiod.
//!
//! Modes whose damped frequencies are odd multiples `m_i` of one `f_c` have the antiperiod `T_a = 1/(2 f_c)` in
//! common (Singh and Heppler 1993; [`ratios`] finds it). Two impulses then suffice for all of them, where a
//! convolution takes two per mode, multiplied. Modes without a common antiperiod are split into the fewest sets that
//! have one each, and the sets' shapers are convolved. With the decay rates `σ_i = ζ_i ω_i`:
//!
//! ```text
//! exact           Π_j [1, K_j]/(1 + K_j) at 0, T_a,  K_j = e^{−σ_j T_a}, over the distinct decay rates: no residual
//! two-impulse     [I_1, 1]/(I_1 + 1) at 0, T_a,      I_1 = Σ A_i m_i / Σ A_i m_i e^{−σ_i T_a}
//! three-impulse   sine and cosine part of the sum of the modes, seen as one oscillation at f_c, and their derivatives for a
//!                 common error of the frequencies are zero at the third impulse (the paper's equations 35 to 38, written
//!                 out at [`three_impulse`]), solved for two amplitudes and two times
//! ```
//!
//! `A_i` is the modal participation. Without damping the two impulses are `[½, ½]` and the three `[¼, ½, ¼]`, at
//! multiples of `T_a`. The two damped solutions of the paper bring the *sum* of the modes to rest, not each mode:
//! with unequal decay rates they leave a residual, which is reported. `exact` is this project's replacement and the
//! default.
//!
//! Limits: a relative error `e` of the frequencies acts on mode `i` as `m_i·e`, so high multiples are sensitive.

use std::f64::consts::PI;

use nalgebra::{Complex, DVector};

use super::joint::{Findings, check_zeros};
use super::joint_error::{JointError, check_distinct, list};
use super::kind::{Design, KindRow, Promise, ShaperKind};
use super::ratios::{self, Class, MULTIPLE_MAX};
use super::{DesignError, newton};
use crate::axis::ShapedAxis;
use crate::impulse::{Impulse, ImpulseSequence};
use crate::mode::Mode;

/// `antisymmetric`.
pub(super) const ANTISYMMETRIC: KindRow = KindRow::new(
    "antisymmetric",
    Promise::Unsaid,
    Design::Axis(|axis, _| design_axis(axis)),
    "one shaper for modes whose frequencies are odd multiples of one",
)
.source("Singh and Heppler 1993")
.keys(&["method", "ratio_tolerance"]);

/// Method by which the impulses of a set of modes are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AntisymmetricMethod {
    /// Product over the distinct decay rates: no residual at any mode.
    #[default]
    Exact,
    /// The paper's two impulses.
    TwoImpulse,
    /// The paper's three impulses.
    ThreeImpulse,
}

impl AntisymmetricMethod {
    /// The method of that name in the machine file.
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "exact" => Some(AntisymmetricMethod::Exact),
            "two-impulse" => Some(AntisymmetricMethod::TwoImpulse),
            "three-impulse" => Some(AntisymmetricMethod::ThreeImpulse),
            _ => None,
        }
    }
}

/// A mode with its modal participation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Participant {
    /// The mode.
    pub mode: Mode,
    /// Modal participation `A_i`; only ratios count.
    pub participation: f64,
}

/// An antisymmetric shaper.
#[derive(Debug, Clone, PartialEq)]
pub struct Antisymmetric {
    /// Impulses of the whole shaper.
    pub impulses: ImpulseSequence,
    /// The sets of modes that share an antiperiod, as indices of the modes; frequencies in Hz.
    pub classes: Vec<Class>,
}

/// Designs the shaper of an axis by the keys of the machine file.
fn design_axis(axis: ShapedAxis<'_>) -> Result<(ImpulseSequence, Findings), DesignError> {
    let given = axis.shaper;
    let method = given
        .and_then(|s| s.method.as_deref())
        .and_then(AntisymmetricMethod::from_name);
    let method = method.unwrap_or_default();
    let ratio_tolerance = given.and_then(|s| s.ratio_tolerance).unwrap_or(0.0);
    let participants = axis.modes.iter().map(|m| Participant {
        mode: m.mode,
        participation: m.participation,
    });
    let participants: Vec<Participant> = participants.collect();
    let found = design(&participants, method, ratio_tolerance)?;
    // The paper's damped impulses, and ratios with a tolerance, leave a residual that is only reported.
    if method == AntisymmetricMethod::Exact && ratio_tolerance == 0.0 {
        check_zeros(ShaperKind::Antisymmetric, &found.impulses, axis)?;
    }
    Ok((found.impulses.clone(), Findings::Antisymmetric(found)))
}

/// Designs a shaper for all modes. `ratio_tolerance` is the relative error at which a frequency counts as an odd
/// multiple; 0 takes the frequencies as they are.
///
/// With a tolerance all modes form one set; without, they form as few sets as possible.
///
/// # Errors
/// [`JointError::NoCommonDivisor`] without a usable antiperiod; [`JointError::NoAntisymmetry`] where there are
/// several modes and no two share one; [`JointError::ThreeImpulse`] where the paper's equations have no solution, and
/// [`JointError::ThreeImpulseMultiple`] where a mode is more than [`MULTIPLE_MAX`] times the divisor; [`DesignError`]
/// for an invalid mode.
pub fn design(
    participants: &[Participant],
    method: AntisymmetricMethod,
    ratio_tolerance: f64,
) -> Result<Antisymmetric, DesignError> {
    let modes: Vec<Mode> = participants.iter().map(|p| p.mode).collect();
    modes.iter().try_for_each(DesignError::check_mode)?;
    check_distinct(&modes)?;
    let damped_hz: Vec<f64> = modes.iter().map(Mode::damped_frequency_hz).collect();
    let classes = if ratio_tolerance > 0.0 {
        vec![Class {
            members: (0..modes.len()).collect(),
            multiples: ratios::nearest_odd(&damped_hz, ratio_tolerance)?,
        }]
    } else {
        antisymmetric_classes(&damped_hz)?
    };
    let no_sequence = |cause| DesignError::NoSequence {
        what: format!("shaper \"{}\"", ShaperKind::Antisymmetric),
        cause,
    };
    let mut impulses = ImpulseSequence::unity();
    for class in &classes {
        let members: Vec<Participant> = class.members.iter().map(|&index| participants[index]).collect();
        let own = class_impulses(&members, class, method)?;
        let own = ImpulseSequence::new(own).map_err(no_sequence)?;
        impulses = impulses.convolve(&own).map_err(no_sequence)?;
    }
    Ok(Antisymmetric { impulses, classes })
}

/// The smallest partition. With several modes, at least one set must have two members: else the kind gains nothing.
fn antisymmetric_classes(damped_hz: &[f64]) -> Result<Vec<Class>, JointError> {
    let classes = ratios::partition(damped_hz)?;
    if classes.len() > 1 && classes.len() == damped_hz.len() {
        let all = ratios::common_divisor(damped_hz)?;
        let multiples: Vec<String> = all.multiples.iter().map(u64::to_string).collect();
        return Err(JointError::NoAntisymmetry {
            frequencies_hz: list(damped_hz),
            multiples: multiples.join(", "),
            divisor_hz: all.divisor,
        });
    }
    Ok(classes)
}

fn class_impulses(
    members: &[Participant],
    class: &Class,
    method: AntisymmetricMethod,
) -> Result<Vec<Impulse>, JointError> {
    let antiperiod_s = class.multiples.antiperiod().ok_or(JointError::NoCommonDivisor {
        frequencies_hz: list(&members.iter().map(|p| p.mode.damped_frequency_hz()).collect::<Vec<_>>()),
        most: MULTIPLE_MAX,
    })?;
    let decays: Vec<f64> = members.iter().map(|p| p.mode.decay()).collect();
    // Modes whose participations are all 0 count alike: they must come to rest too.
    let none = members.iter().all(|p| p.participation == 0.0);
    let swings = members
        .iter()
        .zip(&class.multiples.multiples)
        .map(|(p, &multiple)| Swing {
            amplitude: if none { 1.0 } else { p.participation },
            multiple: multiple as f64,
            decay: p.mode.decay() * antiperiod_s,
        });
    let swings: Vec<Swing> = swings.collect();
    let highest = class.multiples.multiples.iter().copied().fold(1, u64::max);
    match method {
        AntisymmetricMethod::Exact => Ok(exact(antiperiod_s, &decays)),
        AntisymmetricMethod::TwoImpulse => Ok(two_impulse(antiperiod_s, &swings)),
        // Its sums have as many terms as half the multiple.
        AntisymmetricMethod::ThreeImpulse if highest > MULTIPLE_MAX => Err(JointError::ThreeImpulseMultiple {
            multiple: highest,
            most: MULTIPLE_MAX,
        }),
        AntisymmetricMethod::ThreeImpulse => three_impulse(antiperiod_s, &swings),
    }
}

/// Impulses of the product form, with zero residual at every mode that has this antiperiod and one of these decay
/// rates in 1/s.
///
/// Rates that differ by rounding only count as one. There is one impulse more than there are distinct rates.
pub fn exact(antiperiod_s: f64, decays: &[f64]) -> Vec<Impulse> {
    const SAME: f64 = 1e-12;
    let mut sorted = decays.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup_by(|b, a| *b - *a <= SAME * *b);
    let mut amplitudes = vec![1.0];
    for decay in sorted {
        let ratio = (-decay * antiperiod_s).exp();
        let share = |amplitude: f64| amplitude / (1.0 + ratio);
        let mut next: Vec<f64> = amplitudes.iter().map(|a| share(*a)).chain([0.0]).collect();
        for (index, amplitude) in amplitudes.iter().enumerate() {
            next[index + 1] += share(*amplitude) * ratio;
        }
        amplitudes = next;
    }
    let impulses = amplitudes.iter().enumerate();
    impulses
        .map(|(index, &amplitude)| Impulse {
            time_s: index as f64 * antiperiod_s,
            amplitude,
        })
        .collect()
}

/// A mode with times in antiperiods.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swing {
    /// Participation `A_i`.
    pub amplitude: f64,
    /// Odd multiple `m_i` of the common divisor.
    pub multiple: f64,
    /// Decay `σ_i T_a` during one antiperiod.
    pub decay: f64,
}

/// The paper's two impulses: after the second, the sum of the modes has no velocity.
pub fn two_impulse(antiperiod_s: f64, swings: &[Swing]) -> Vec<Impulse> {
    let now: f64 = swings.iter().map(|s| s.amplitude * s.multiple).sum();
    let later: f64 = swings.iter().map(|s| s.amplitude * s.multiple * (-s.decay).exp()).sum();
    let first = now / later;
    [(0.0, first / (1.0 + first)), (antiperiod_s, 1.0 / (1.0 + first))]
        .map(|(time_s, amplitude)| Impulse { time_s, amplitude })
        .to_vec()
}

/// The paper's three impulses, found by Newton's method from the closed form with times at `T_a` and `2T_a`.
///
/// With `m_i` odd, `sin(m_i x) = U_i(x) sin x`, `U_i(x) = 1 + 2 Σ_j cos(2 j x)`, `j = 1 … (m_i − 1)/2`: all modes together are
/// one oscillation at the common divisor. With `x_k = π(t_3 − t_k)/T_a`, `f_i = σ_i T_a/(π m_i)` and `I_3 = 1` the equations are
///
/// ```text
/// R(x) = Σ_i A_i e^{−f_i m_i x} U_i(x) e^{i x}
/// 35, 36   Re, Im of Σ_k I_k R(x_k) = 0
/// 38, 37   Re, Im of Σ_k I_k x_k R'(x_k) = 0       (a common error of the frequencies)
/// ```
///
/// Equation 36 is the displacement of the sum and 37 its derivative; 35 is *not* the velocity, which it equals only
/// at multiples of `T_a`, where `U_i = m_i`. The equations were not read from the paper but inferred from solutions
/// known to 16 digits, which satisfy all four to rounding.
///
/// # Errors
/// [`JointError::ThreeImpulse`] where no solution near the start has positive amplitudes and ordered times.
pub fn three_impulse(antiperiod_s: f64, swings: &[Swing]) -> Result<Vec<Impulse>, JointError> {
    let none = || JointError::ThreeImpulse { antiperiod_s };
    let response = Response(swings);
    // With both times at multiples of the antiperiod, equations 35 and 37 alone: I1 E2 − I2 E1 + E0 = 0, I2 E1 = 2 I1 E2.
    let [rest, once, twice] = [0.0, 1.0, 2.0].map(|time| response.at(time)[0].re);
    let first = rest / twice;
    let start = DVector::from_row_slice(&[first, -2.0 * first * twice / once, 1.0, 2.0]);
    let scale: f64 = swings.iter().map(|s| s.amplitude * s.multiple).sum();
    let equations = |x: &DVector<f64>| {
        let (since_first, since_second) = (x[3], x[3] - x[2]);
        let ([a, a_slope], [b, b_slope]) = (response.at(since_first), response.at(since_second));
        let sum = a * x[0] + b * x[1] + rest;
        let weighted = a_slope * (x[0] * since_first) + b_slope * (x[1] * since_second);
        DVector::from_row_slice(&[sum.re, sum.im, weighted.im, weighted.re]) / scale
    };
    let found = newton::solve(equations, start, 1e-11).ok_or_else(none)?;
    let amplitudes = [found[0], found[1], 1.0];
    let times = [0.0, found[2], found[3]];
    let ordered = times.windows(2).all(|pair| pair[0] < pair[1]);
    if !(ordered && amplitudes.iter().all(|a| *a > 0.0)) {
        return Err(none());
    }
    let total: f64 = amplitudes.iter().sum();
    let impulses = times.iter().zip(amplitudes).map(|(time, amplitude)| Impulse {
        time_s: time * antiperiod_s,
        amplitude: amplitude / total,
    });
    Ok(impulses.collect())
}

/// Response of the sum of the modes to one impulse, written as an oscillation at the common divisor whose amplitude
/// varies.
struct Response<'a>(&'a [Swing]);

impl Response<'_> {
    /// `R(τ)` of [`three_impulse`] with `time` in antiperiods after the impulse, and its derivative with respect to
    /// `π·time`.
    fn at(&self, time: f64) -> [Complex<f64>; 2] {
        let angle = PI * time;
        let carrier = Complex::cis(angle);
        let (mut value, mut slope) = (0.0, 0.0);
        for swing in self.0 {
            // sin(m x)/sin(x) = 1 + 2 Σ cos(2 j x), j = 1 … (m − 1)/2: no division where x is a multiple of π.
            let (mut ratio, mut ratio_slope) = (1.0, 0.0);
            let mut even = 2.0;
            while even < swing.multiple {
                let (sin, cos) = (even * angle).sin_cos();
                ratio += 2.0 * cos;
                ratio_slope -= 2.0 * even * sin;
                even += 2.0;
            }
            let share = swing.amplitude * (-swing.decay * time).exp();
            value += share * ratio;
            slope += share * (ratio_slope - swing.decay / PI * ratio);
        }
        [carrier * value, carrier * Complex::new(slope, value)]
    }
}
