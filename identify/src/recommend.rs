//! Recommends shapers for the modes that were found: their residual within the uncertainty of the modes, and their
//! cost.

use crate::found::FoundMode;
use posicast_model::analysis::worst_residual;
use posicast_model::design::kind::ShaperKind;
use posicast_model::design::{ModeSettings, design_mode};
use posicast_model::impulse::ImpulseSequence;
use posicast_model::mode::Mode;
use posicast_model::plant::free_motion;

/// Criteria by which a shaper is judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judgement {
    /// Jump of the acceleration at the start of a move, which excites the modes, in m/s² (rad/s²).
    pub acceleration: f64,
    /// Relative change of the frequencies by load, position or wear, in addition to the uncertainty of the log.
    pub margin: f64,
    /// Residual for which the kinds with a tolerance are designed.
    pub tolerance: f64,
    /// Fraction of the unshaped displacement that is considered small enough.
    pub enough: f64,
}

impl Default for Judgement {
    fn default() -> Self {
        Self {
            acceleration: 5.0,
            margin: 0.05,
            tolerance: 0.05,
            enough: 0.05,
        }
    }
}

/// A shaper for all modes that were found, with its figures.
#[derive(Debug, Clone, PartialEq)]
pub struct Recommendation {
    /// Kind, which is the same for every mode.
    pub kind: ShaperKind,
    /// Impulses, which are the convolution of those for each mode.
    pub impulses: ImpulseSequence,
    /// Largest displacement in m (rad) that still vibrates after a jump of the acceleration, with the modes anywhere
    /// in their intervals plus the margin.
    pub residual_displacement: f64,
    /// Largest displacement that vibrates without a shaper, in m (rad).
    pub unshaped_displacement: f64,
    /// Rounding of a path: half the acceleration times the variance of the impulses' times, in m (rad).
    pub smoothing: f64,
}

impl Recommendation {
    /// Ratio of the residual to the unshaped displacement.
    pub fn ratio(&self) -> f64 {
        self.residual_displacement / self.unshaped_displacement
    }
}

/// Kinds that are tried: those with positive impulses, which do not need a stronger drive.
const TRIED: [ShaperKind; 8] = [
    ShaperKind::Zv,
    ShaperKind::Mzv,
    ShaperKind::Ei,
    ShaperKind::Zvd,
    ShaperKind::TwoHumpEi,
    ShaperKind::Zvdd,
    ShaperKind::ThreeHumpEi,
    ShaperKind::Zvddd,
];

/// Shapers for the modes, the best first: the shortest of those whose residual is small enough, then the others by
/// their residual. Kinds that do not exist for a mode are left out; without modes the list is empty.
pub fn recommend(modes: &[FoundMode], judgement: &Judgement) -> Vec<Recommendation> {
    if modes.is_empty() {
        return Vec::new();
    }
    let mut tried: Vec<Recommendation> = TRIED
        .iter()
        .filter_map(|&kind| judged(modes, kind, judgement))
        .collect();
    // A kind with a tolerance uses all of it; a little more at the ends of an interval must not decide.
    let enough = |r: &Recommendation| r.ratio() <= 1.02 * judgement.enough;
    tried.sort_by(|a, b| {
        let order = enough(b).cmp(&enough(a));
        order.then_with(|| {
            if enough(a) {
                a.impulses.duration_s().total_cmp(&b.impulses.duration_s())
            } else {
                a.residual_displacement.total_cmp(&b.residual_displacement)
            }
        })
    });
    tried
}

fn judged(modes: &[FoundMode], kind: ShaperKind, judgement: &Judgement) -> Option<Recommendation> {
    let settings = ModeSettings {
        tolerance: judgement.tolerance,
        order: 1,
        epsilon: judgement.tolerance,
    };
    let mut impulses = ImpulseSequence::unity();
    for found in modes {
        let of_mode = design_mode(kind, &found.mode, &settings).ok()?;
        impulses = impulses.convolve(&of_mode).ok()?;
    }
    // A jump of the acceleration by a moves the rest position of a mode by share·a/ω², which is the amplitude of its
    // ringing.
    let amplitude = |found: &FoundMode| found.participation * judgement.acceleration / found.mode.omega().powi(2);
    let residual = |found: &FoundMode| {
        let half = found.frequency_interval_hz().high - found.mode.frequency_hz;
        let band = judgement.margin + half / found.mode.frequency_hz;
        let dampings = found.damping_interval();
        let worst = |damping: f64| {
            let mode = Mode { damping, ..found.mode };
            worst_residual(impulses.impulses(), &mode, band.min(1.0))
        };
        worst(dampings.low).max(worst(dampings.high.min(0.99)))
    };
    let mean = impulses.delay_s();
    let variance: f64 = impulses
        .impulses()
        .iter()
        .map(|i| i.amplitude * (i.time_s - mean).powi(2))
        .sum();
    Some(Recommendation {
        kind,
        residual_displacement: modes.iter().map(|found| amplitude(found) * residual(found)).sum(),
        unshaped_displacement: modes.iter().map(amplitude).sum(),
        smoothing: 0.5 * judgement.acceleration * variance,
        impulses,
    })
}

/// Deflection of the modes after a jump of the acceleration by `acceleration` through a shaper: time in s and
/// deflection in m (rad) at `samples` instants over `duration_s`.
pub fn deflection(
    modes: &[FoundMode],
    impulses: &ImpulseSequence,
    acceleration: f64,
    duration_s: f64,
    samples: usize,
) -> Vec<(f64, f64)> {
    let of_mode = |found: &FoundMode, since_s: f64| {
        if since_s < 0.0 {
            return 0.0;
        }
        let mode = &found.mode;
        let rest = found.participation * acceleration / mode.omega().powi(2);
        rest * (1.0 - free_motion(mode, since_s)[(0, 0)])
    };
    (0..samples)
        .map(|n| {
            let time_s = duration_s * n as f64 / (samples.max(2) - 1) as f64;
            let sum = impulses.impulses().iter().map(|impulse| {
                let deflected: f64 = modes.iter().map(|found| of_mode(found, time_s - impulse.time_s)).sum();
                impulse.amplitude * deflected
            });
            (time_s, sum.sum())
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(frequency_hz: f64, damping: f64, participation: f64) -> FoundMode {
        FoundMode {
            mode: Mode { frequency_hz, damping },
            participation,
            frequency_sd_hz: 0.001 * frequency_hz,
            damping_sd: 0.0,
        }
    }

    #[test]
    fn unit_the_first_leaves_little_enough_and_none_that_does_is_shorter() {
        let judgement = Judgement::default();
        let tried = recommend(&[found(40.0, 0.05, 0.7), found(90.0, 0.03, 0.3)], &judgement);
        assert_eq!(tried.len(), TRIED.len());
        assert!(tried[0].ratio() <= judgement.enough);
        let enough = tried.iter().filter(|r| r.ratio() <= judgement.enough);
        assert!(
            enough
                .map(|r| r.impulses.duration_s())
                .all(|d| d >= tried[0].impulses.duration_s())
        );
        assert!(recommend(&[], &judgement).is_empty());
    }

    #[test]
    fn unit_without_margin_zv_leaves_nothing_of_a_mode_that_is_known() {
        let mut mode = found(40.0, 0.05, 1.0);
        mode.frequency_sd_hz = 0.0;
        let judgement = Judgement {
            margin: 0.0,
            ..Judgement::default()
        };
        let zv = recommend(&[mode], &judgement);
        let zv = zv.iter().find(|r| r.kind == ShaperKind::Zv).unwrap();
        assert!(zv.ratio() < 1e-9);
        // This is half the acceleration times the variance of two impulses half a period apart.
        let (a, t) = (zv.impulses.impulses()[1].amplitude, zv.impulses.duration_s());
        assert!((zv.smoothing - 2.5 * a * (1.0 - a) * t * t).abs() < 1e-12);
        let curve = deflection(&[mode], &zv.impulses, 5.0, 0.1, 1001);
        assert!(curve[0].1.abs() < 1e-12);
        let after = curve.iter().filter(|(time_s, _)| *time_s > zv.impulses.duration_s());
        let rest = zv.unshaped_displacement;
        assert!(after.map(|(_, x)| (x - rest).abs()).all(|x| x < 1e-12));
    }
}
