//! Recommends shapers for the modes that were found: their residual within the uncertainty of the modes, and their
//! cost.
//!
//! After the acceleration jumps by `a`, a mode of participation `p` rings with the amplitude `p·a/ω²`. This amplitude, not `p`, is the
//! weight of a mode.

use crate::found::FoundMode;
use posicast_machine::plant::free_motion;
use posicast_shaper::analysis::worst_residual_of_convolution;
use posicast_shaper::design::kind::ShaperKind;
use posicast_shaper::design::{ModeSettings, design_mode};
use posicast_shaper::impulse::ImpulseSequence;
use posicast_shaper::mode::Mode;

/// Criteria by which a shaper is judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judgement {
    /// Jump of the acceleration at the start of a move, which excites the modes, in m/s² (rad/s²).
    pub acceleration: f64,
    /// Relative change of the frequencies by load, position or wear, in addition to the uncertainty of the log.
    pub margin: f64,
    /// Residual for which the kinds with a tolerance are designed.
    pub tolerance: f64,
    /// Fraction of the unshaped displacement that counts as small enough.
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

impl Judgement {
    /// Whether the residual of a shaper is small enough. A kind with a tolerance uses all of it, so the rounding of its design must not
    /// decide.
    pub fn is_enough(&self, shaper: &Recommendation) -> bool {
        const ROUNDING: f64 = 1e-6;
        shaper.ratio() <= self.enough * (1.0 + ROUNDING)
    }
}

/// A shaper for all modes that were found, with its figures.
#[derive(Debug, Clone, PartialEq)]
pub struct Recommendation {
    /// Kind of shaper, the same for every mode.
    pub kind: ShaperKind,
    /// Residual for which a kind with a tolerance is designed.
    pub tolerance: f64,
    /// Impulses: the convolution of those for each mode.
    pub impulses: ImpulseSequence,
    /// Largest displacement in m (rad) that still vibrates after a jump of the acceleration, with the modes anywhere
    /// in their intervals plus the margin.
    pub residual_displacement: f64,
    /// Largest displacement that vibrates without a shaper, in m (rad).
    pub unshaped_displacement: f64,
    /// Rounding of a path: half the acceleration times the variance of the impulses' times, in m (rad).
    pub smoothing: f64,
    /// Largest acceleration in m/s² with which a 3D printer rounds its corners by [`CORNER_SMOOTHING_M`] at most; 0 where the shaper
    /// alone rounds them more.
    pub max_acceleration: f64,
}

/// Rounding of corners in m up to which 3D printers are set, and their velocity in corners in m/s: Klipper's `TARGET_SMOOTHING` and the
/// default of `square_corner_velocity` (klippy/extras/shaper_calibrate.py).
pub const CORNER_SMOOTHING_M: f64 = 0.12e-3;
/// See [`CORNER_SMOOTHING_M`].
pub const SQUARE_CORNER_VELOCITY: f64 = 5e-3;

/// Rounding in m of a corner of 90° that is passed at `corner_velocity` (m/s), or of a reversal, at this acceleration in m/s².
///
/// ```text
/// 90°:  √2 · Σ_{T ≥ t̄} A·(v + ½a·(T − t̄))·(T − t̄)        180°:  ½a · Σ A·(T − t̄)²        t̄ = Σ A·T
/// ```
pub fn corner_smoothing(impulses: &ImpulseSequence, acceleration: f64, corner_velocity: f64) -> f64 {
    let [by_velocity, by_acceleration, reversal] = corner_sums(impulses);
    let corner = corner_velocity * by_velocity + 0.5 * acceleration * by_acceleration;
    corner.max(0.5 * acceleration * reversal)
}

/// Largest acceleration in m/s² at which [`corner_smoothing`] is at most `smoothing` (m); 0 where it is more at every acceleration.
pub fn max_acceleration(impulses: &ImpulseSequence, smoothing: f64, corner_velocity: f64) -> f64 {
    let [by_velocity, by_acceleration, reversal] = corner_sums(impulses);
    let corner = 2.0 * (smoothing - corner_velocity * by_velocity) / by_acceleration;
    corner.min(2.0 * smoothing / reversal).max(0.0)
}

/// The sums of [`corner_smoothing`]: with the velocity and with half the acceleration in a corner, and in a reversal.
fn corner_sums(impulses: &ImpulseSequence) -> [f64; 3] {
    let mean = impulses.delay_s();
    let mut sums = [0.0; 3];
    for impulse in impulses.impulses() {
        let late = impulse.time_s - mean;
        if late >= 0.0 {
            sums[0] += std::f64::consts::SQRT_2 * impulse.amplitude * late;
            sums[1] += std::f64::consts::SQRT_2 * impulse.amplitude * late * late;
        }
        sums[2] += impulse.amplitude * late * late;
    }
    sums
}

impl Recommendation {
    /// Ratio of the residual to the unshaped displacement.
    pub fn ratio(&self) -> f64 {
        self.residual_displacement / self.unshaped_displacement
    }

    /// Rounding of a printer's corners in m at [`Recommendation::max_acceleration`].
    pub fn smoothing_in_corners(&self) -> f64 {
        corner_smoothing(&self.impulses, self.max_acceleration, SQUARE_CORNER_VELOCITY)
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

/// Returns shapers for the modes, the best first: the shortest of those whose residual is small enough, then the others by their residual.
/// Kinds that do not exist for a mode are left out; without modes the list is empty.
pub fn recommend(modes: &[FoundMode], judgement: &Judgement) -> Vec<Recommendation> {
    if modes.is_empty() {
        return Vec::new();
    }
    let mut tried: Vec<Recommendation> = TRIED
        .iter()
        .filter_map(|&kind| judged(modes, kind, judgement))
        .collect();
    tried.sort_by(|a, b| {
        let order = judgement.is_enough(b).cmp(&judgement.is_enough(a));
        order.then_with(|| {
            if judgement.is_enough(a) {
                a.impulses.duration_s().total_cmp(&b.impulses.duration_s())
            } else {
                a.residual_displacement.total_cmp(&b.residual_displacement)
            }
        })
    });
    tried
}

/// Designs a kind for all modes. A kind with a tolerance uses all of it at the modelled damping, and slightly exceeds it at other dampings:
/// then it is designed again for a smaller tolerance.
fn judged(modes: &[FoundMode], kind: ShaperKind, judgement: &Judgement) -> Option<Recommendation> {
    /// Largest ratio by which a kind may exceed its tolerance to be designed again, and largest number of designs.
    const NEAR: f64 = 1.1;
    const TRIALS: usize = 4;
    let mut tolerance = judgement.tolerance;
    let mut tried = designed(modes, kind, tolerance, judgement)?;
    for _ in 0..TRIALS {
        let misses = tried.ratio() / judgement.enough;
        if !kind.name().ends_with("ei") || judgement.is_enough(&tried) || misses > NEAR {
            break;
        }
        // Rounded down, because machine files have only a few digits.
        tolerance = (1e4 * tolerance / misses).floor().mul_add(1e-4, -1e-4);
        tried = designed(modes, kind, tolerance, judgement)?;
    }
    Some(tried)
}

fn designed(modes: &[FoundMode], kind: ShaperKind, tolerance: f64, judgement: &Judgement) -> Option<Recommendation> {
    let settings = ModeSettings {
        tolerance,
        order: 1,
        epsilon: tolerance,
    };
    let designs = modes.iter().map(|found| design_mode(kind, &found.mode, &settings).ok());
    let of_modes = designs.collect::<Option<Vec<ImpulseSequence>>>()?;
    let unity = ImpulseSequence::unity();
    let impulses = of_modes.iter().try_fold(unity, |all, one| all.convolve(one)).ok()?;
    let amplitude = |found: &FoundMode| found.ringing(judgement.acceleration);
    let residual = |found: &FoundMode| {
        let half = found.frequency_interval_hz().high - found.mode.frequency_hz;
        let band = judgement.margin + half / found.mode.frequency_hz;
        let dampings = found.damping_interval();
        let worst = |damping: f64| {
            let mode = Mode { damping, ..found.mode };
            worst_residual_of_convolution(&of_modes, &mode, band.min(1.0))
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
        tolerance,
        residual_displacement: modes.iter().map(|found| amplitude(found) * residual(found)).sum(),
        unshaped_displacement: modes.iter().map(amplitude).sum(),
        smoothing: 0.5 * judgement.acceleration * variance,
        max_acceleration: max_acceleration(&impulses, CORNER_SMOOTHING_M, SQUARE_CORNER_VELOCITY),
        impulses,
    })
}

/// Computes the deflection of the modes after a jump of the acceleration by `acceleration` through a shaper: time in s and
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
        let rest = found.ringing(acceleration);
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
    use posicast_shaper::analysis::worst_residual;
    use posicast_shaper::impulse::Impulse;

    fn found(frequency_hz: f64, damping: f64, participation: f64) -> FoundMode {
        FoundMode {
            mode: Mode { frequency_hz, damping },
            participation,
            frequency_sd_hz: 0.001 * frequency_hz,
            damping_sd: 0.0,
        }
    }

    #[test]
    fn the_first_is_the_shortest_with_a_small_enough_residual() {
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
    fn a_kind_that_leaves_more_than_five_percent_is_not_enough() {
        // zv leaves 5.081 % of this mode within its interval and margin; another kind leaves little enough, although its design
        // allows 5 %.
        let mut mode = found(60.0, 0.02, 1.0);
        mode.frequency_sd_hz = 0.0;
        let judgement = Judgement {
            margin: 0.0333,
            ..Judgement::default()
        };
        let tried = recommend(&[mode], &judgement);
        let zv = tried.iter().find(|shaper| shaper.kind == ShaperKind::Zv).unwrap();
        assert!(zv.ratio() > 0.05 && zv.ratio() < 0.052, "{}", zv.ratio());
        assert!(!judgement.is_enough(zv));
        let enough = tried.iter().take_while(|shaper| judgement.is_enough(shaper)).count();
        assert!(enough > 0 && tried[enough..].iter().all(|shaper| !judgement.is_enough(shaper)));
        assert!(
            tried[..enough]
                .iter()
                .all(|shaper| shaper.ratio() <= 0.05 * (1.0 + 1e-6))
        );
        assert!(tried[..enough].iter().any(|shaper| shaper.kind == ShaperKind::Ei));
    }

    /// Results of Klipper's Python for a shaper.
    struct OfKlipper {
        name: &'static str,
        amplitudes: &'static [f64],
        times_s: &'static [f64],
        /// `find_shaper_max_accel` with a `square_corner_velocity` of 5 mm/s, in mm/s².
        max_accel: f64,
        /// `_get_shaper_smoothing` at 5,000 mm/s², in mm.
        smoothing: f64,
    }

    /// From commit 84104bbb of 2026-08-07.
    const KLIPPER: [OfKlipper; 5] = [
        OfKlipper {
            name: "zv 40 Hz 0.1",
            amplitudes: &[0.578286182, 0.421713818],
            times_s: &[0.0, 0.012562973],
            max_accel: 6235.420747,
            smoothing: 0.10035828,
        },
        OfKlipper {
            name: "mzv 55.5 Hz 0.05",
            amplitudes: &[0.328223128, 0.41253043, 0.259246441],
            times_s: &[0.0, 0.006765219, 0.013530437],
            max_accel: 8998.990107,
            smoothing: 0.06667415,
        },
        OfKlipper {
            name: "ei 40 Hz 0.1",
            amplitudes: &[0.35488138, 0.45299809, 0.19212053],
            times_s: &[0.0, 0.012681004, 0.025125945],
            max_accel: 2913.560556,
            smoothing: 0.20593360,
        },
        OfKlipper {
            name: "2hump_ei 90 Hz 0.04",
            amplitudes: &[0.194666656, 0.352944138, 0.315042831, 0.137346375],
            times_s: &[0.0, 0.00561038, 0.011142483, 0.016612741],
            max_accel: 8657.522298,
            smoothing: 0.06930389,
        },
        OfKlipper {
            name: "3hump_ei 40 Hz 0.1",
            amplitudes: &[0.220854412, 0.277211466, 0.259699689, 0.16705516, 0.075179272],
            times_s: &[0.0, 0.013512547, 0.025701275, 0.037647475, 0.049573178],
            max_accel: 874.452416,
            smoothing: 0.56508985,
        },
    ];

    #[test]
    fn the_largest_acceleration_of_printers_is_klippers() {
        for of in &KLIPPER {
            // Klipper's amplitudes are written with nine digits.
            let sum: f64 = of.amplitudes.iter().sum();
            let impulses = of
                .times_s
                .iter()
                .zip(of.amplitudes)
                .map(|(&time_s, amplitude)| Impulse {
                    time_s,
                    amplitude: amplitude / sum,
                });
            let impulses = ImpulseSequence::new(impulses.collect()).unwrap();
            let ours = max_acceleration(&impulses, CORNER_SMOOTHING_M, SQUARE_CORNER_VELOCITY);
            assert!((1e3 * ours / of.max_accel - 1.0).abs() < 1e-5, "{}: {ours}", of.name);
            let at_5000 = 1e3 * corner_smoothing(&impulses, 5.0, SQUARE_CORNER_VELOCITY);
            assert!((at_5000 / of.smoothing - 1.0).abs() < 1e-5, "{}: {at_5000}", of.name);
            let at_it = corner_smoothing(&impulses, ours, SQUARE_CORNER_VELOCITY);
            assert!((at_it / CORNER_SMOOTHING_M - 1.0).abs() < 1e-9, "{}: {at_it}", of.name);
        }
        // A slow shaper rounds corners by more than that at any acceleration.
        let slow = recommend(&[found(2.0, 0.05, 1.0)], &Judgement::default());
        assert!(slow[0].max_acceleration == 0.0 && slow[0].smoothing_in_corners() > CORNER_SMOOTHING_M);
    }

    #[test]
    fn a_slow_mode_with_a_small_share_decides() {
        // 35.2 µm at 12 Hz and 15.0 µm at 90 Hz: a shaper for 90 Hz alone leaves 69 %.
        let modes = [found(12.0, 0.03, 0.04), found(90.0, 0.04, 0.96)];
        let judgement = Judgement::default();
        let unshaped = recommend(&modes, &judgement)[0].unshaped_displacement;
        assert!((unshaped - 50.2e-6).abs() < 0.1e-6, "{unshaped:e}");
        let alone = &recommend(&modes[1..], &judgement)[0].impulses;
        let left: f64 = modes
            .iter()
            .map(|found| found.ringing(judgement.acceleration) * worst_residual(alone.impulses(), &found.mode, 0.05))
            .sum();
        assert!((left / unshaped - 0.69).abs() < 0.03, "{}", left / unshaped);
        assert!(recommend(&modes, &judgement)[0].ratio() <= 0.05);
    }

    #[test]
    fn a_kind_with_a_tolerance_keeps_within_it_whatever_the_damping() {
        // Designed for exactly 5 % at 0.05, it would leave 5.1 % at the ends of the damping's interval.
        let mut vague = found(40.0, 0.05, 1.0);
        vague.damping_sd = 0.003;
        let judgement = Judgement::default();
        let tried = recommend(&[vague], &judgement);
        let ei = tried.iter().find(|shaper| shaper.kind == ShaperKind::Ei).unwrap();
        assert!(
            judgement.is_enough(ei) && ei.tolerance < 0.05 && ei.tolerance > 0.04,
            "{}",
            ei.tolerance
        );
    }

    #[test]
    fn without_margin_zv_leaves_no_residual_of_a_known_mode() {
        let mut mode = found(40.0, 0.05, 1.0);
        mode.frequency_sd_hz = 0.0;
        let judgement = Judgement {
            margin: 0.0,
            ..Judgement::default()
        };
        let zv = recommend(&[mode], &judgement);
        let zv = zv.iter().find(|r| r.kind == ShaperKind::Zv).unwrap();
        assert!(zv.ratio() < 1e-9);
        // Half the acceleration times the variance of two impulses half a period apart.
        let (a, t) = (zv.impulses.impulses()[1].amplitude, zv.impulses.duration_s());
        assert!((zv.smoothing - 2.5 * a * (1.0 - a) * t * t).abs() < 1e-12);
        let curve = deflection(&[mode], &zv.impulses, 5.0, 0.1, 1001);
        assert!(curve[0].1.abs() < 1e-12);
        let after = curve.iter().filter(|(time_s, _)| *time_s > zv.impulses.duration_s());
        let rest = zv.unshaped_displacement;
        assert!(after.map(|(_, x)| (x - rest).abs()).all(|x| x < 1e-12));
    }
}
