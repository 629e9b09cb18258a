//! Places one impulse on the sample grid: `n = ⌊t/T_s⌋`, `f = t/T_s − n`.
//!
//! | method | taps | residual that it leaves at the mode |
//! |---|---|---|
//! | [`nearest`] | `A` at `⌊t/T_s + ½⌋` | up to `\|A\|·ω·T_s/2` |
//! | [`linear`] | `A(1−f)` at `n`, `A·f` at `n+1` | about `\|A\|·(ωT_s)²·f(1−f)/2` |
//! | [`modal`] | the two taps whose pole sum is `A·e^{(ζω + jω_d)t}` | none, as long as `ω_d·T_s < π` |

use crate::digitise::RealTap;
use crate::impulse::{Impulse, ImpulseSequence};
use crate::mode::Mode;

/// An impulse this close to a sample, in samples, counts as on it. The rounding error of a time that is a whole
/// number of samples is a thousandth of this at the longest delay, and the residual does not notice so small a shift.
const ON_SAMPLE: f64 = 1e-11;

/// The one or two taps of an impulse.
pub type Placed = [Option<RealTap>; 2];

/// Splits the time of an impulse into whole samples and the fraction beyond them.
fn split(impulse: &Impulse, sample_hz: f64) -> (u32, f64) {
    let position = impulse.time_s * sample_hz;
    let nearest = position.round();
    if (position - nearest).abs() <= ON_SAMPLE {
        (nearest as u32, 0.0)
    } else {
        (position.floor() as u32, position - position.floor())
    }
}

/// The last sample that a sequence can reach; a float, so that it holds any time.
pub(super) fn last_sample(impulses: &ImpulseSequence, sample_hz: f64) -> f64 {
    let position = impulses.duration_s() * sample_hz;
    if (position - position.round()).abs() <= ON_SAMPLE {
        position.round()
    } else {
        position.ceil()
    }
}

/// Makes two taps, or one where the second is not needed.
fn pair(delay_samples: u32, first: f64, second: Option<f64>) -> Placed {
    let tap = |delay_samples, weight| RealTap { delay_samples, weight };
    [
        Some(tap(delay_samples, first)),
        second.map(|w| tap(delay_samples + 1, w)),
    ]
}

/// One tap at the nearest sample; a half is rounded up.
pub fn nearest(impulse: &Impulse, sample_hz: f64) -> Placed {
    let (sample, fraction) = split(impulse, sample_hz);
    let sample = if fraction >= 0.5 { sample + 1 } else { sample };
    pair(sample, impulse.amplitude, None)
}

/// Two taps weighted by distance, which keep the sum and the delay.
pub fn linear(impulse: &Impulse, sample_hz: f64) -> Placed {
    let (sample, fraction) = split(impulse, sample_hz);
    let second = (fraction > 0.0).then_some(impulse.amplitude * fraction);
    pair(sample, impulse.amplitude * (1.0 - fraction), second)
}

/// Two taps with the same pole sum as the impulse, for `ω_d·T_s < π`:
///
/// ```text
/// a_n     = A·e^{ ζω f T_s}     · sin(ω_d (1−f) T_s) / sin(ω_d T_s)
/// a_(n+1) = A·e^{−ζω (1−f) T_s} · sin(ω_d f T_s)     / sin(ω_d T_s)
/// ```
pub fn modal(impulse: &Impulse, mode: &Mode, sample_hz: f64) -> Placed {
    let (sample, fraction) = split(impulse, sample_hz);
    if fraction == 0.0 {
        return pair(sample, impulse.amplitude, None);
    }
    let angle = mode.omega_damped() / sample_hz;
    let decay = mode.decay() / sample_hz;
    let scale = impulse.amplitude / angle.sin();
    let rest = 1.0 - fraction;
    pair(
        sample,
        scale * (decay * fraction).exp() * (angle * rest).sin(),
        Some(scale * (-decay * rest).exp() * (angle * fraction).sin()),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::pole_sum;

    const MODE: Mode = Mode {
        frequency_hz: 131.0,
        damping: 0.16,
    };

    fn taps(placed: Placed) -> Vec<(u32, f64)> {
        placed
            .into_iter()
            .flatten()
            .map(|t| (t.delay_samples, t.weight))
            .collect()
    }

    #[test]
    fn an_impulse_on_a_sample_is_one_tap() {
        // 0.0039 · 10000 is 38.99999999999999
        let impulse = Impulse {
            time_s: 0.0039,
            amplitude: 0.4,
        };
        for placed in [
            nearest(&impulse, 1e4),
            linear(&impulse, 1e4),
            modal(&impulse, &MODE, 1e4),
        ] {
            assert_eq!(taps(placed), [(39, 0.4)]);
        }
    }

    #[test]
    fn nearest_rounds_halves_up() {
        let at = |time_s| taps(nearest(&Impulse { time_s, amplitude: 1.0 }, 2.0))[0].0;
        assert_eq!((at(0.249), at(0.25), at(0.75)), (0, 1, 2));
    }

    #[test]
    fn modal_taps_have_the_pole_sum_of_the_impulse() {
        for (time_s, sample_hz) in [(0.00386, 1e4), (0.0005, 1300.0), (0.012_345, 50e3)] {
            let impulse = Impulse { time_s, amplitude: 0.7 };
            let placed: Vec<Impulse> = taps(modal(&impulse, &MODE, sample_hz))
                .into_iter()
                .map(|(delay, amplitude)| Impulse {
                    time_s: f64::from(delay) / sample_hz,
                    amplitude,
                })
                .collect();
            assert_eq!(placed.len(), 2);
            let difference = pole_sum(&placed, &MODE, time_s) - pole_sum(&[impulse], &MODE, time_s);
            assert!(difference.norm() < 1e-14, "{difference}");
        }
    }
}
