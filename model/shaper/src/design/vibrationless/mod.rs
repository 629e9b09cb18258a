//! `vibrationless`: half sums of the command with itself delayed by half a period, for several frequencies round each
//! mode.
//!
//! ```text
//! F_k(t) = (F_{k−1}(t) + F_{k−1}(t − τ_k))/2,   τ_k = π/(r_k ω_d),  k = 1…n          2^n impulses of weight 2^−n
//! P(ω) = Π cos(πω / (2 r_k ω_d))                                                       the gain at a frequency
//! ```
//!
//! (Prourzin and Shevlyakov.) The ratios `r_k` make the robustness index `Δ` as large as possible: `2|P| ≤ ε` on
//! `(1 ± Δ)·ω_d`; the factor 2 is the largest vibration that a start of full height can leave. At the optimum `n + 1`
//! of the peaks of `|P|` are equal: some of the two ends of the band and the maxima between zeros. They give `n + 1`
//! equations for `r_1 … r_n` and `Δ`, solved by Newton's method to the last digits.
//!
//! A zero repeats at its odd multiples, so in a wide band one frequency may serve twice: there are several *families*
//! of optima, which differ in how many such repetitions lie in the band. Each is followed from a known member to the
//! wanted `ε`; where another peak rises to the bound, it takes the place of one of the equal ones. The widest band is
//! chosen. The starting members were found by multistart minimax search over Δ = 0.1 … 0.8: the index of a design is
//! certain, but it is not proven that no family is wider. At ε = 0.05 it agrees with a global search for every order. From ε = 0.002 on,
//! the band grows in each of 400 steps, as the widest must: the cascade of a smaller ε keeps a larger one too.
//!
//! Damping is ignored in the design, and included in the residual that is reported.

mod family;

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::{Mutex, MutexGuard, PoisonError};

use self::family::{Above, Family, SEEDS};
use super::DesignError;
use super::joint_error::JointError;
use super::kind::{Design, KindRow, Promise, ShaperKind};
use crate::axis::{AxisMode, ShapedAxis};
use crate::impulse::{Impulse, ImpulseSequence};
use crate::mode::Mode;

/// `vibrationless`. The cascade promises a band, not a residual at the mode: its design ignores damping, which the
/// report includes.
pub(super) const VIBRATIONLESS: KindRow = KindRow::new(
    "vibrationless",
    Promise::Unsaid,
    Design::Mode(|_, mode, settings| design(mode, settings.order, settings.epsilon)),
    "half sums with 2·gain ≤ `epsilon` on the widest band",
)
.source("Prourzin and Shevlyakov")
.keys(&["order", "epsilon"])
.order(2);

/// Largest number of frequencies per mode.
pub const ORDER_MAX: u32 = 5;
/// Smallest `ε`; below it, the frequencies coincide to half of their digits.
pub const EPSILON_MIN: f64 = 1e-6;

/// Frequencies of a half-sum cascade, as ratios to the mode's.
#[derive(Debug, Clone, PartialEq)]
pub struct VibrationlessCascade {
    /// The ratios `r_1 < … < r_n`.
    pub ratios: Vec<f64>,
    /// Robustness index `Δ`: `2|P| ≤ ε` on `1 ± Δ`.
    pub index: f64,
}

/// Largest `ε` that is solved, for the orders 1 to 5; above it, the known families end.
pub const EPSILON_MAX: [f64; ORDER_MAX as usize] = [0.5, 0.5, 0.38, 0.2, 0.06];

/// Designs the cascade of one mode, with `order` frequencies and the bound `epsilon`.
///
/// # Errors
/// [`JointError::Vibrationless`] for an order or bound that is not solved; [`DesignError`] for an invalid mode, or
/// times beyond `f64`.
pub fn design(mode: &Mode, order: u32, epsilon: f64) -> Result<ImpulseSequence, DesignError> {
    half_sum_cascade(&half_sums_s(mode, order, epsilon)?)
        .map_err(|cause| DesignError::no_sequence(ShaperKind::Vibrationless, mode, cause))
}

/// Delays of the half sums of an axis in seconds, those of all modes in their order.
///
/// # Errors
/// Those of [`design`].
pub fn axis_half_sums_s(axis: ShapedAxis<'_>) -> Result<Vec<f64>, DesignError> {
    let of_mode = |mode: &AxisMode| half_sums_s(&mode.mode, axis.order_of(mode), axis.epsilon());
    let of_modes: Result<Vec<_>, DesignError> = axis.modes.iter().map(of_mode).collect();
    Ok(of_modes?.concat())
}

/// Delays of the half sums of one mode in seconds, as many as the order.
fn half_sums_s(mode: &Mode, order: u32, epsilon: f64) -> Result<Vec<f64>, DesignError> {
    DesignError::check_mode(mode)?;
    let cascade = optimum(order, epsilon)?;
    let half_sums = cascade
        .ratios
        .iter()
        .map(|ratio| 0.5 / (ratio * mode.damped_frequency_hz()));
    Ok(half_sums.collect())
}

/// Impulses of the half sums with these delays in seconds: `2^n` of weight `2^−n`, coincident ones merged.
///
/// # Errors
/// [`crate::impulse::ImpulseError`] for a delay that is not above 0, or for sums beyond `f64`.
pub fn half_sum_cascade(delays_s: &[f64]) -> Result<ImpulseSequence, crate::impulse::ImpulseError> {
    delays_s.iter().try_fold(ImpulseSequence::unity(), |whole, &delay_s| {
        let half = |time_s| Impulse { time_s, amplitude: 0.5 };
        whole.convolve(&ImpulseSequence::new(vec![half(0.0), half(delay_s)])?)
    })
}

/// The cascade with the largest robustness index.
///
/// # Errors
/// [`JointError::Vibrationless`] for an order outside 1..=[`ORDER_MAX`] or an `ε` that no family reaches.
pub fn optimum(order: u32, epsilon: f64) -> Result<VibrationlessCascade, JointError> {
    let largest = EPSILON_MAX[(order.clamp(1, ORDER_MAX) - 1) as usize];
    let refused = || JointError::Vibrationless {
        order,
        epsilon,
        most: ORDER_MAX,
        least: EPSILON_MIN,
        largest,
    };
    if !(EPSILON_MIN..=largest).contains(&epsilon) {
        return Err(refused());
    }
    if order == 1 {
        let index = 2.0 / PI * (epsilon / 2.0).asin();
        return Ok(VibrationlessCascade {
            ratios: vec![1.0],
            index,
        });
    }
    // Design, tables, curves and kinds of one axis ask for the same cascade, and a large order takes hundredths of a
    // second.
    let key = (order, epsilon.to_bits());
    if let Some(known) = lock(&KNOWN).get(&key) {
        return Ok(known.clone());
    }
    let seeds = SEEDS.get((order as usize).wrapping_sub(2)).ok_or_else(refused)?;
    let ways = [Above::Exchanged, Above::Crossed];
    let starts = seeds.iter().flat_map(|seed| ways.map(|way| (seed, way)));
    let found = starts.filter_map(|(seed, way)| Family::of(seed).follow(seed, epsilon, way));
    let widest = found.max_by(|a, b| a.index.total_cmp(&b.index)).ok_or_else(refused)?;
    let mut known = lock(&KNOWN);
    if known.len() >= MOST_KNOWN {
        known.clear();
    }
    known.insert(key, widest.clone());
    Ok(widest)
}

/// Number of cascades that are remembered: a program that sweeps the bound would fill the memory.
const MOST_KNOWN: usize = 64;

/// Cascades that were solved, by order and bits of the bound.
static KNOWN: Mutex<BTreeMap<(u32, u64), VibrationlessCascade>> = Mutex::new(BTreeMap::new());

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The gain `|P|` at a frequency, both as ratios to the mode's.
pub fn gain(ratios: &[f64], frequency: f64) -> f64 {
    let factors = ratios.iter().map(|ratio| (PI * frequency / (2.0 * ratio)).cos());
    factors.product::<f64>().abs()
}

/// The robustness index of any frequencies: the largest `Δ < 1` with `2|P| ≤ epsilon` on `1 ± Δ`, to the last digit.
/// It is 0 if the bound does not hold even at 1, or for ratios outside 0.001 to 1000.
pub fn robustness_index(ratios: &[f64], epsilon: f64) -> f64 {
    let bound = epsilon / 2.0;
    if gain(ratios, 1.0) > bound || !are_solvable(ratios) {
        return 0.0;
    }
    let within = |index: f64| {
        let ends = [1.0 - index, 1.0 + index];
        let ends_hold = ends.iter().all(|end| gain(ratios, *end) <= bound);
        ends_hold && peaks(ratios, index).all(|(_, peak)| gain(ratios, peak) <= bound)
    };
    let (mut low, mut high) = (0.0, 1.0);
    while high - low > 4.0 * f64::EPSILON {
        let middle = f64::midpoint(low, high);
        if within(middle) { low = middle } else { high = middle }
    }
    low
}

/// Whether the band contains few zeros; a smaller ratio has thousands of them, and no practical design needs one.
fn are_solvable(ratios: &[f64]) -> bool {
    ratios.iter().all(|ratio| (1e-3..=1e3).contains(ratio))
}

/// Zeros of the gain in ascending order: the ratios and their odd multiples, up to the first few above `high`.
fn zeros(ratios: &[f64], high: f64) -> Vec<f64> {
    if !are_solvable(ratios) {
        return Vec::new();
    }
    let largest = ratios.iter().fold(0.0, |most: f64, ratio| most.max(*ratio));
    let limit = high + 2.0 * largest;
    let repeated = |ratio: &f64| {
        let ratio = *ratio;
        (0..)
            .map(move |k| ratio * f64::from(2 * k + 1))
            .take_while(move |zero| *zero <= limit)
    };
    let mut zeros: Vec<f64> = ratios.iter().flat_map(repeated).collect();
    zeros.sort_by(f64::total_cmp);
    zeros
}

/// Frequencies in the band `1 ± index` at which the gain is largest between two neighbouring zeros, each with the
/// index of the zero before it. Below the first zero the gain only falls.
fn peaks(ratios: &[f64], index: f64) -> impl Iterator<Item = (usize, f64)> + use<'_> {
    let zeros = zeros(ratios, 1.0 + index);
    let all = (1..zeros.len()).map(move |right| (right - 1, peak_between(ratios, zeros[right - 1], zeros[right])));
    all.filter(move |(_, peak)| (1.0 - index..=1.0 + index).contains(peak))
}

/// The one stationary point of `ln|P|` between two neighbouring zeros, where its slope rises from minus to plus infinity.
fn peak_between(ratios: &[f64], left: f64, right: f64) -> f64 {
    // The slope, up to a factor, and its derivative.
    let slope = |frequency: f64| {
        let terms = ratios.iter().map(|ratio| {
            let tangent = (PI * frequency / (2.0 * ratio)).tan();
            (tangent / ratio, PI / 2.0 * (1.0 + tangent * tangent) / (ratio * ratio))
        });
        terms.fold((0.0, 0.0), |sum, term| (sum.0 + term.0, sum.1 + term.1))
    };
    let (mut low, mut high) = (left, right);
    let mut middle = f64::midpoint(low, high);
    // The height is stationary there, so half of the digits of the frequency give all digits of the height.
    for round in 0..32 {
        let (value, rise) = slope(middle);
        if value > 0.0 {
            high = middle
        } else {
            low = middle
        }
        let newton = middle - value / rise;
        let is_near = round >= 4 && low < newton && newton < high;
        let next = if is_near { newton } else { f64::midpoint(low, high) };
        if is_near && (next - middle).abs() < 1e-9 * middle {
            return next;
        }
        middle = next;
    }
    middle
}
