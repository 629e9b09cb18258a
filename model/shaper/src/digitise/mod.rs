//! Digitising: impulses at any time become taps at whole samples, and then integers.
//!
//! ```text
//! impulses ─► grid (two taps per impulse, real) ─► parts convolved ─► real taps a_i ─► quantise ─► TapTable, Σ c_i = 2^F
//! ```
//!
//! With `modal`, each part (one mode's shaper) is put on the grid by itself and divided by its own sum. The parts'
//! real sequences are then convolved, and taps on equal samples added, so that each mode keeps its own zeros.
//! `linear` and `nearest` place the impulses of the whole axis. Rounding to integers comes once, at the end
//! ([`quantise`]). The delay that an axis needs to match the other axes of a stage is added before that
//! ([`Digitised::delayed`]). The methods are in [`grid`]; the real taps are kept beside the integers, because the
//! float design that the hardware is compared with uses them.

mod error;
pub mod grid;
mod quantise;
mod stream;

use std::collections::BTreeMap;
use std::fmt;

pub use error::{DELAY_MAX_SAMPLES, DigitiseError, TAPS_MAX};
pub use quantise::{quantise, quantising_error};
pub use stream::RealShaper;

use crate::design::kind::ShaperKind;
use crate::design::{AxisDesign, Findings, ShaperParts};
use crate::impulse::{Impulse, ImpulseSequence};
use crate::mode::Mode;

/// A tap before rounding, which contributes `weight · x[n − delay_samples]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RealTap {
    /// Delay in samples.
    pub delay_samples: u32,
    /// Weight `a_i`.
    pub weight: f64,
}

/// Ways to turn impulses between two samples into taps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Digitise {
    /// Two taps per impulse, exact at the mode's pole.
    #[default]
    Modal,
    /// Two taps per impulse, weighted by distance.
    Linear,
    /// One tap per impulse at the nearest sample.
    Nearest,
}

/// Method by which the impulses of an axis were put on the sample grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DigitiseMethod {
    /// Two taps per impulse, exact at the pole of the mode that the impulse belongs to.
    Modal,
    /// Two taps per impulse, exact at the pole of the axis's first mode: the impulses serve all modes together.
    ModalAtFirstMode,
    /// Two taps per impulse, weighted by distance.
    Linear,
    /// One tap per impulse, at the nearest sample.
    Nearest,
    /// The impulses were designed on the samples.
    OnSamples,
    /// Each half sum was delayed by whole samples.
    HalfSums,
}

impl fmt::Display for DigitiseMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            DigitiseMethod::Modal => "modal",
            DigitiseMethod::ModalAtFirstMode => "modal at the first mode",
            DigitiseMethod::Linear => "linear",
            DigitiseMethod::Nearest => "nearest",
            DigitiseMethod::OnSamples => "as designed, on the samples",
            DigitiseMethod::HalfSums => "each half sum at the nearest sample",
        })
    }
}

/// A shaper on the sample grid, before rounding.
#[derive(Debug, Clone, PartialEq)]
pub struct Digitised {
    /// The method that was used, which is not always the one asked for ([`digitise`]).
    pub method_used: DigitiseMethod,
    /// The taps: delays strictly increasing, weights not zero, sum 1.
    pub taps: Vec<RealTap>,
}

impl Digitised {
    /// The taps as impulses in continuous time.
    pub fn impulses(&self, sample_hz: f64) -> Vec<Impulse> {
        let taps = self.taps.iter();
        taps.map(|tap| Impulse {
            time_s: f64::from(tap.delay_samples) / sample_hz,
            amplitude: tap.weight,
        })
        .collect()
    }

    /// Mean delay `Σ a_i d_i` in samples, by which a shaped ramp lags.
    pub fn mean_delay_samples(&self) -> f64 {
        let taps = self.taps.iter();
        taps.map(|tap| tap.weight * f64::from(tap.delay_samples)).sum()
    }

    /// The taps delayed by `samples`: whole samples are added to every delay, and the fraction `f` is convolved in as
    /// `(1 − f, f)`. The sum stays 1. At a mode this multiplies the residual by at most 1, so no residual grows.
    ///
    /// `None` for a delay that is negative or NaN, or longer than the largest ring buffer.
    pub fn delayed(&self, samples: f64) -> Option<Self> {
        let (whole, fraction) = split_delay(samples)?;
        let last = self.taps.last().map_or(0, |tap| tap.delay_samples);
        let reaches = last.checked_add(whole)?.checked_add(u32::from(fraction > 0.0))?;
        if reaches > DELAY_MAX_SAMPLES {
            return None;
        }
        let mut later: BTreeMap<u32, f64> = BTreeMap::new();
        for tap in &self.taps {
            let delay = tap.delay_samples + whole;
            *later.entry(delay).or_default() += tap.weight * (1.0 - fraction);
            if fraction > 0.0 {
                *later.entry(delay + 1).or_default() += tap.weight * fraction;
            }
        }
        Some(Self {
            method_used: self.method_used,
            taps: real_taps(later),
        })
    }

    /// The float design's output for these command words, in the same unit; the hardware's output is compared with
    /// it. Before the first word the command had the value of the first word.
    pub fn shape(&self, command: &[i64]) -> Vec<f64> {
        let word = |sample: usize, delay_samples: u32| {
            let delayed = sample.saturating_sub(delay_samples as usize);
            command[delayed] as f64
        };
        let output = |sample| self.taps.iter().map(|t| t.weight * word(sample, t.delay_samples)).sum();
        (0..command.len()).map(output).collect()
    }
}

/// Puts an axis's shaper on the sample grid.
///
/// A cascade has each half sum at the nearest sample, whatever `how`.
///
/// For impulses that serve all modes together (`custom`, joint kinds), `modal` is exact only at the first mode of the
/// file, and becomes `linear` where there is no mode, which [`Digitised::method_used`] reports.
///
/// # Errors
/// [`DigitiseError::Delay`] for a shaper longer than the largest ring buffer, before anything is allocated;
/// [`DigitiseError::Nyquist`] for a mode whose frequency is too high for the sample rate;
/// [`DigitiseError::NoUnitSum`] where the taps of a part cancel.
pub fn digitise(design: &AxisDesign, how: Digitise, sample_hz: f64) -> Result<Digitised, DigitiseError> {
    if let Findings::HalfSums(delays_s) = &design.findings {
        check_delay(design, std::iter::once(&design.impulses), sample_hz)?;
        return Ok(half_sums(delays_s, sample_hz));
    }
    let whole = || vec![(&design.impulses, None)];
    let (method_used, sequences) = match (how, &design.parts) {
        _ if matches!(design.findings, Findings::Optimal(_)) => (DigitiseMethod::OnSamples, whole()),
        (Digitise::Linear, _) => (DigitiseMethod::Linear, whole()),
        (Digitise::Nearest, _) => (DigitiseMethod::Nearest, whole()),
        (Digitise::Modal, ShaperParts::PerMode(parts)) => {
            // Modes without a shaper do not matter for the grid.
            let shaped = parts.iter().filter(|p| p.kind != ShaperKind::None);
            let sequences: Vec<_> = shaped.map(|p| (&p.impulses, Some(p.mode))).collect();
            (DigitiseMethod::Modal, sequences)
        }
        (Digitise::Modal, ShaperParts::Joint { reference: Some(mode) }) => {
            (DigitiseMethod::ModalAtFirstMode, vec![(&design.impulses, Some(*mode))])
        }
        (Digitise::Modal, ShaperParts::Joint { reference: None }) => (DigitiseMethod::Linear, whole()),
    };
    check_delay(design, sequences.iter().map(|(impulses, _)| *impulses), sample_hz)?;
    let mut whole = BTreeMap::from([(0, 1.0)]);
    for (impulses, mode) in sequences {
        whole = convolve(&whole, &part(&design.name, impulses, mode, method_used, sample_hz)?);
    }
    Ok(Digitised {
        method_used,
        taps: real_taps(whole),
    })
}

/// The taps of half sums in series, each of which is delayed by whole samples: their weights are multiples of 2^−N.
fn half_sums(delays_s: &[f64], sample_hz: f64) -> Digitised {
    let mut whole = BTreeMap::from([(0, 1.0)]);
    for delay_samples in half_sums_samples(delays_s, sample_hz) {
        let mut half_sum = BTreeMap::from([(0, 0.5)]);
        *half_sum.entry(delay_samples).or_default() += 0.5;
        whole = convolve(&whole, &half_sum);
    }
    Digitised {
        method_used: DigitiseMethod::HalfSums,
        taps: real_taps(whole),
    }
}

/// Delays of half sums in whole samples.
pub fn half_sums_samples(delays_s: &[f64], sample_hz: f64) -> Vec<u32> {
    delays_s
        .iter()
        .map(|delay_s| (delay_s * sample_hz).round() as u32)
        .collect()
}

/// Makes taps of weights by delay, without those that are 0.
fn real_taps(weights: BTreeMap<u32, f64>) -> Vec<RealTap> {
    let weights = weights.into_iter().filter(|(_, weight)| *weight != 0.0);
    weights
        .map(|(delay_samples, weight)| RealTap { delay_samples, weight })
        .collect()
}

/// A delay this close to whole samples counts as whole. This saves taps, and the difference is far below what
/// rounding the coefficients changes.
const WHOLE_DELAY: f64 = 1e-10;

/// Splits a delay into whole samples and the fraction beyond them; `None` for a delay that the hardware does not
/// have.
fn split_delay(samples: f64) -> Option<(u32, f64)> {
    if !(0.0..=f64::from(DELAY_MAX_SAMPLES)).contains(&samples) {
        return None;
    }
    let nearest = samples.round();
    if (samples - nearest).abs() <= WHOLE_DELAY {
        return Some((nearest as u32, 0.0));
    }
    Some((samples.floor() as u32, samples - samples.floor()))
}

/// Refuses a sequence that no ring buffer holds; each sequence ends at most one sample after its last impulse.
fn check_delay<'a>(
    design: &AxisDesign,
    sequences: impl Iterator<Item = &'a ImpulseSequence>,
    sample_hz: f64,
) -> Result<(), DigitiseError> {
    let samples: f64 = sequences.map(|s| grid::last_sample(s, sample_hz)).sum();
    if samples <= f64::from(DELAY_MAX_SAMPLES) {
        return Ok(());
    }
    Err(DigitiseError::Delay {
        axis: design.name.clone(),
        found: samples,
        duration_s: design.impulses.duration_s(),
        sample_hz,
    })
}

/// Puts one sequence on the grid and divides it by its sum.
fn part(
    axis: &str,
    impulses: &ImpulseSequence,
    mode: Option<Mode>,
    method: DigitiseMethod,
    sample_hz: f64,
) -> Result<BTreeMap<u32, f64>, DigitiseError> {
    let mut taps: BTreeMap<u32, f64> = BTreeMap::new();
    for impulse in impulses.impulses() {
        let placed = match (method, mode) {
            (DigitiseMethod::Nearest | DigitiseMethod::OnSamples, _) => grid::nearest(impulse, sample_hz),
            (DigitiseMethod::Modal | DigitiseMethod::ModalAtFirstMode, Some(mode)) => {
                if mode.omega_damped() >= std::f64::consts::PI * sample_hz {
                    return Err(DigitiseError::Nyquist {
                        axis: axis.to_owned(),
                        frequency_hz: mode.frequency_hz,
                        sample_hz,
                    });
                }
                grid::modal(impulse, &mode, sample_hz)
            }
            _ => grid::linear(impulse, sample_hz),
        };
        for tap in placed.into_iter().flatten() {
            *taps.entry(tap.delay_samples).or_default() += tap.weight;
        }
    }
    let sum: f64 = taps.values().sum();
    let size: f64 = taps.values().map(|w| w.abs()).sum();
    if size.is_finite() && sum.abs() > 1e-6 * size {
        taps.values_mut().for_each(|weight| *weight /= sum);
        Ok(taps)
    } else {
        Err(DigitiseError::NoUnitSum {
            axis: axis.to_owned(),
            sum,
        })
    }
}

/// Convolves two tap sequences.
fn convolve(a: &BTreeMap<u32, f64>, b: &BTreeMap<u32, f64>) -> BTreeMap<u32, f64> {
    let mut product: BTreeMap<u32, f64> = BTreeMap::new();
    for (delay_a, weight_a) in a {
        for (delay_b, weight_b) in b {
            *product.entry(delay_a + delay_b).or_default() += weight_a * weight_b;
        }
    }
    product
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::ShaperPart;

    fn custom(pairs: &[(f64, f64)], reference: Option<Mode>) -> AxisDesign {
        let impulses = pairs.iter().map(|&(time_s, amplitude)| Impulse { time_s, amplitude });
        AxisDesign {
            name: "x".into(),
            kind: "custom".into(),
            impulses: ImpulseSequence::new(impulses.collect()).unwrap(),
            parts: ShaperParts::Joint { reference },
            findings: Findings::None,
        }
    }

    #[test]
    fn custom_says_which_method_it_took() {
        let mode = Mode {
            frequency_hz: 10.0,
            damping: 0.1,
        };
        let pairs = [(0.0, 0.5), (0.0104, 0.5)];
        let method = |reference, how| digitise(&custom(&pairs, reference), how, 1000.0).unwrap().method_used;
        assert_eq!(method(None, Digitise::Modal), DigitiseMethod::Linear);
        assert_eq!(method(Some(mode), Digitise::Modal), DigitiseMethod::ModalAtFirstMode);
        assert_eq!(method(Some(mode), Digitise::Linear), DigitiseMethod::Linear);
        assert_eq!(method(Some(mode), Digitise::Nearest), DigitiseMethod::Nearest);
        let linear = digitise(&custom(&pairs, None), Digitise::Modal, 1000.0).unwrap();
        let taps: Vec<_> = linear.taps.iter().map(|t| t.delay_samples).collect();
        assert_eq!(taps, [0, 10, 11]);
        assert!((linear.taps[1].weight - 0.3).abs() < 1e-12 && (linear.taps[2].weight - 0.2).abs() < 1e-12);
    }

    #[test]
    fn impulses_that_share_a_sample_add_up() {
        let design = custom(&[(0.0, 0.5), (0.0102, 0.25), (0.0105, 0.25)], None);
        let taps = digitise(&design, Digitise::Linear, 1000.0).unwrap().taps;
        for (tap, expected) in taps.iter().zip([(0, 0.5), (10, 0.325), (11, 0.175)]) {
            assert_eq!(tap.delay_samples, expected.0);
            assert!((tap.weight - expected.1).abs() < 1e-12);
        }
    }

    #[test]
    fn a_shaper_longer_than_any_ring_is_refused_before_it_is_built() {
        for last_s in [1e300, 1e9, 16.383] {
            let error = digitise(&custom(&[(0.0, 0.5), (last_s, 0.5)], None), Digitise::Linear, 1000.0).unwrap_err();
            assert!(matches!(error, DigitiseError::Delay { .. }), "{error}");
        }
        let longest = digitise(&custom(&[(0.0, 0.5), (16.382, 0.5)], None), Digitise::Linear, 1000.0).unwrap();
        assert_eq!(longest.taps.last().unwrap().delay_samples, DELAY_MAX_SAMPLES);
    }

    #[test]
    fn a_mode_beyond_half_the_sample_rate_has_no_modal_taps() {
        let mode = Mode {
            frequency_hz: 500.0,
            damping: 0.0,
        };
        let design = custom(&[(0.0, 0.5), (0.0015, 0.5)], Some(mode));
        let error = digitise(&design, Digitise::Modal, 1000.0).unwrap_err();
        assert!(matches!(error, DigitiseError::Nyquist { .. }), "{error}");
        assert!(digitise(&design, Digitise::Linear, 1000.0).is_ok());
    }

    #[test]
    fn shaping_starts_at_rest_on_the_first_word() {
        let digitised = digitise(&custom(&[(0.0, 0.25), (0.002, 0.75)], None), Digitise::Modal, 1000.0).unwrap();
        assert_eq!(digitised.shape(&[8, 8, 12, 12, 16]), [8.0, 8.0, 9.0, 9.0, 13.0]);
        assert!(digitised.shape(&[]).is_empty());
    }

    #[test]
    fn a_delay_is_folded_in_as_whole_samples_and_a_fraction() {
        let digitised = digitise(&custom(&[(0.0, 0.25), (0.002, 0.75)], None), Digitise::Modal, 1000.0).unwrap();
        let taps = |samples: f64| -> Vec<(u32, f64)> {
            let later = digitised.delayed(samples).unwrap();
            assert!((later.mean_delay_samples() - 1.5 - samples).abs() < 1e-9, "{samples}");
            later.taps.iter().map(|t| (t.delay_samples, t.weight)).collect()
        };
        assert_eq!(taps(0.0), [(0, 0.25), (2, 0.75)]);
        assert_eq!(taps(3.0 - 1e-12), [(3, 0.25), (5, 0.75)]);
        assert_eq!(taps(1.25), [(1, 0.1875), (2, 0.0625), (3, 0.5625), (4, 0.1875)]);
        // The last tap may reach the end of the ring buffer, but not beyond.
        let room = f64::from(DELAY_MAX_SAMPLES - 2);
        assert_eq!(taps(room).last().unwrap().0, DELAY_MAX_SAMPLES);
        for bad in [room + 0.5, room + 1.0, 1e300, -1e-9, f64::NAN, f64::INFINITY] {
            assert_eq!(digitised.delayed(bad), None, "{bad}");
        }
    }

    #[test]
    fn amplitudes_out_of_all_proportion_are_an_error() {
        let design = custom(&[(0.0, 1e8 + 1.0), (0.0015, -1e8)], None);
        let error = digitise(&design, Digitise::Linear, 1000.0).unwrap_err();
        assert!(matches!(error, DigitiseError::NoUnitSum { .. }), "{error}");
    }

    #[test]
    fn each_mode_keeps_its_own_pole() {
        let mode = |frequency_hz| Mode {
            frequency_hz,
            damping: 0.05,
        };
        let part = |frequency_hz| ShaperPart {
            mode: mode(frequency_hz),
            kind: ShaperKind::Zv,
            impulses: crate::design::zv::design(ShaperKind::Zv, &mode(frequency_hz), 1).unwrap(),
        };
        let (first, second) = (part(77.0), part(231.0));
        let design = AxisDesign {
            name: "x".into(),
            kind: "zv".into(),
            impulses: first.impulses.convolve(&second.impulses).unwrap(),
            parts: ShaperParts::PerMode(vec![first, second]),
            findings: Findings::None,
        };
        let taps = digitise(&design, Digitise::Modal, 2000.0).unwrap();
        assert_eq!(taps.method_used, DigitiseMethod::Modal);
        for frequency_hz in [77.0, 231.0] {
            let residual = crate::analysis::residual_vibration(&taps.impulses(2000.0), &mode(frequency_hz));
            assert!(residual < 1e-14, "{residual}");
        }
    }
}
