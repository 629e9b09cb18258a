//! Separable least-squares fit of poles to points.

use super::ResponsePoint;
use super::columns::{Coefficients, Nodes, resonance, times_j, top_hz, weighted};
use crate::separable::{self, Effort, Gram, Separable};
use nalgebra::{Complex, DMatrix, DVector};
use std::f64::consts::TAU;

/// A pole pair that is being fitted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pole {
    pub(crate) frequency_hz: f64,
    pub(crate) damping: f64,
}

/// Knowledge of the phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Phase {
    /// Nothing is known: every coefficient is complex.
    Free,
    /// All coefficients are real, apart from about this lateness.
    Late(Lateness),
}

/// Lateness of a response: `delay_s` at all frequencies, plus `bend_s` for each multiple of the highest frequency,
/// because the error of a clock grows with the time at which a frequency comes in a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Lateness {
    pub(crate) delay_s: f64,
    pub(crate) bend_s: f64,
}

impl Lateness {
    /// The phase factor `e^{−j2πf(delay + bend·f/top)}`.
    pub(crate) fn turn(&self, frequency_hz: f64, top_hz: f64) -> Complex<f64> {
        let late_s = self.delay_s + self.bend_s * frequency_hz / top_hz;
        if late_s == 0.0 {
            return Complex::ONE;
        }
        Complex::from_polar(1.0, -TAU * frequency_hz * late_s)
    }
}

impl Phase {
    /// Returns the lateness; zero if the phase is not known.
    pub(crate) fn lateness(self) -> Lateness {
        match self {
            Self::Free => Lateness::default(),
            Self::Late(lateness) => lateness,
        }
    }
}

/// Range of damping ratios of a fit.
const DAMPING: (f64, f64) = (2e-4, 2.0);
/// Smallest half width `ζ·f` of a pole, over the distance of the points: a narrower pole lies between two points.
const NARROWEST: f64 = 0.25;
/// Smallest ratio to a bound for a pole that does not count as being at it.
const OFF_BOUND: f64 = 1.1;

/// Largest ratio of the static value to that of the lowest point.
const STILL: f64 = 5.0;

/// Smallest damping ratio that the points can resolve for a pole at a frequency.
fn least_damping(points: &[ResponsePoint], frequency_hz: f64) -> f64 {
    let above = points.partition_point(|point| point.frequency_hz < frequency_hz);
    let first = above.min(points.len().saturating_sub(1)).saturating_sub(1);
    let near = points.get(first..first + 2).unwrap_or_default();
    let distance_hz = match near {
        [a, b] => b.frequency_hz - a.frequency_hz,
        _ => 0.0,
    };
    DAMPING.0.max(NARROWEST * distance_hz / frequency_hz)
}

/// Whether a pole is away from the bounds of the fit, and wide enough for the points to resolve it.
pub(crate) fn is_resolved(points: &[ResponsePoint], pole: &Pole) -> bool {
    pole.damping > OFF_BOUND * least_damping(points, pole.frequency_hz) && pole.damping * OFF_BOUND < DAMPING.1
}

/// Poles fitted to the points, with the quality of the fit.
#[derive(Debug, Clone)]
pub(crate) struct Fit {
    pub(crate) poles: Vec<Pole>,
    pub(crate) phase: Phase,
    /// Static share of each pole, and its standard deviation.
    pub(crate) shares: Vec<(f64, f64)>,
    /// Static value of the axis and all poles; 1 if the phase is not known.
    pub(crate) still: f64,
    /// Standard deviations of each pole's frequency in Hz and damping ratio.
    pub(crate) deviations: Vec<(f64, f64)>,
    /// Standard deviation of the bend of the lateness in seconds; infinite if the phase is not known.
    pub(crate) bend_deviation_s: f64,
    /// Sum of squares of the residuals divided by their standard deviations.
    pub(crate) square: f64,
    /// Degrees of freedom: number of values minus unknowns.
    pub(crate) freedoms: f64,
    /// The fitted values.
    pub(crate) values: Vec<Complex<f64>>,
}

impl Fit {
    /// Sum of squares per degree of freedom: 1 where only noise is left.
    pub(crate) fn reduced_square(&self) -> f64 {
        self.square / self.freedoms.max(1.0)
    }
}

/// The fit of poles to points. The unknowns are `ln f` and `ln ζ` of each pole, and delay and bend if the phase is
/// known.
struct Poles<'a> {
    points: &'a [ResponsePoint],
    nodes: Nodes,
    measured: DVector<f64>,
    is_free: bool,
}

impl<'a> Poles<'a> {
    fn new(points: &'a [ResponsePoint], phase: Phase) -> Self {
        Self {
            points,
            nodes: Nodes::new(points),
            measured: weighted(points),
            is_free: phase == Phase::Free,
        }
    }

    fn unknowns(&self, poles: &[Pole], phase: Phase) -> Vec<f64> {
        let of_poles = poles
            .iter()
            .flat_map(|pole| [pole.frequency_hz.ln(), pole.damping.ln()]);
        let Lateness { delay_s, bend_s } = phase.lateness();
        let late = [delay_s, bend_s];
        of_poles.chain(late.into_iter().filter(|_| !self.is_free)).collect()
    }

    fn poles(&self, unknowns: &[f64]) -> (Vec<Pole>, Phase) {
        let (pairs, _) = unknowns.as_chunks::<2>();
        let (phase, pairs) = match pairs {
            [of_poles @ .., [delay_s, bend_s]] if !self.is_free => {
                let (delay_s, bend_s) = (*delay_s, *bend_s);
                (Phase::Late(Lateness { delay_s, bend_s }), of_poles)
            }
            all => (Phase::Free, all),
        };
        let poles = pairs.iter().map(|[frequency, damping]| Pole {
            frequency_hz: frequency.exp(),
            damping: damping.exp(),
        });
        (poles.collect(), phase)
    }

    /// Returns the complex coefficients of a pole's displacement and velocity.
    fn coefficients_of_pole(&self, coefficients: &DVector<f64>, pole: usize) -> Coefficients {
        let half = coefficients.len() / 2;
        let at = |column: usize| {
            if self.is_free {
                Complex::new(coefficients[column], coefficients[column + half])
            } else {
                Complex::new(coefficients[column], 0.0)
            }
        };
        [at(2 * pole), at(2 * pole + 1)]
    }

    fn values(&self, fitted: &DVector<f64>) -> Vec<Complex<f64>> {
        let value = |(n, point): (usize, &ResponsePoint)| {
            Complex::new(fitted[n], fitted[self.points.len() + n]) * point.deviation
        };
        self.points.iter().enumerate().map(value).collect()
    }
}

impl Separable for Poles<'_> {
    fn measured(&self) -> &DVector<f64> {
        &self.measured
    }

    fn basis(&self, unknowns: &[f64]) -> DMatrix<f64> {
        let (poles, phase) = self.poles(unknowns);
        self.nodes.basis(&poles, phase)
    }

    fn slopes(&self, unknowns: &[f64], _: &DMatrix<f64>, coefficients: &DVector<f64>) -> DMatrix<f64> {
        let (poles, phase) = self.poles(unknowns);
        let rest = [coefficients[2 * poles.len()], coefficients[2 * poles.len() + 1]];
        let of_poles = (0..poles.len()).map(|pole| self.coefficients_of_pole(coefficients, pole));
        self.nodes.slopes(&poles, phase, &of_poles.collect::<Vec<_>>(), rest)
    }

    fn stepped(&self, unknowns: &[f64], step: &DVector<f64>) -> Vec<f64> {
        let mut unknowns = unknowns.to_vec();
        let (pairs, _) = unknowns.as_chunks_mut::<2>();
        let poles = if self.is_free { pairs.len() } else { pairs.len() - 1 };
        for (k, [first, second]) in pairs.iter_mut().enumerate() {
            let (by_first, by_second) = (step[2 * k], step[2 * k + 1]);
            if k < poles {
                *first += by_first.clamp(-0.2, 0.2);
                let least = least_damping(self.points, first.exp()).min(DAMPING.1);
                *second = (*second + by_second.clamp(-1.0, 1.0)).clamp(least.ln(), DAMPING.1.ln());
            } else {
                *first += by_first;
                *second += by_second;
            }
        }
        unknowns
    }
}

/// Returns which of these delays in seconds explains most with exactly these poles; `None` if the points do not determine their shares. The
/// phase factor of a point is that of its mean frequency, so all delays have the same columns.
pub(crate) fn likeliest_delay(
    points: &[ResponsePoint],
    poles: &[Pole],
    delays_s: impl Iterator<Item = f64>,
) -> Option<Lateness> {
    let basis = Nodes::new(points).basis(poles, Phase::Late(Lateness::default()));
    let gram = Gram::of(&basis)?;
    let explained = |late: Lateness| {
        let earlier = points.iter().map(|point| ResponsePoint {
            value: point.value * late.turn(point.frequency_hz, 1.0).conj(),
            ..*point
        });
        let pull = basis.tr_mul(&weighted(&earlier.collect::<Vec<_>>()));
        gram.solve_one(&pull).dot(&pull)
    };
    let tried = delays_s.map(|delay_s| Lateness { delay_s, bend_s: 0.0 });
    let tried = tried.map(|late| (explained(late), late));
    tried.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, late)| late)
}

/// Returns the best fit near the given poles; `None` if the points do not determine the unknowns.
pub(crate) fn refine(points: &[ResponsePoint], poles: &[Pole], phase: Phase, effort: Effort) -> Option<Fit> {
    let problem = Poles::new(points, phase);
    let solution = separable::refine(&problem, &problem.unknowns(poles, phase), effort)?;
    let (poles, phase) = problem.poles(&solution.unknowns);
    // A remainder beyond the noise of the points counts as additional noise.
    let row = solution.reduced_square().max(1.0).sqrt();
    let deviations = poles.iter().enumerate().map(|(k, pole)| {
        (
            pole.frequency_hz * solution.deviation(2 * k, row),
            pole.damping * solution.deviation(2 * k + 1, row),
        )
    });
    let shares = (0..poles.len()).map(|k| {
        let [still, _] = problem.coefficients_of_pole(&solution.coefficients, k);
        (still.norm(), solution.linear_deviation(2 * k, row))
    });
    Some(Fit {
        values: problem.values(&solution.fitted),
        deviations: deviations.collect(),
        bend_deviation_s: match phase {
            Phase::Late(_) => solution.deviation(2 * poles.len() + 1, row),
            Phase::Free => f64::INFINITY,
        },
        still: match phase {
            Phase::Late(_) => {
                let of_poles: f64 = (0..poles.len()).map(|k| solution.coefficients[2 * k]).sum();
                let still = of_poles + solution.coefficients[2 * poles.len()];
                // Poles far below the points cancel each other there, and so do not determine the static value.
                let lowest = problem
                    .values(&solution.fitted)
                    .first()
                    .map_or(1.0, |value| value.norm());
                if (lowest / STILL..lowest * STILL).contains(&still.abs()) {
                    still
                } else {
                    lowest
                }
            }
            Phase::Free => 1.0,
        },
        shares: shares.collect(),
        square: solution.square,
        freedoms: solution.freedoms,
        poles,
        phase,
    })
}

/// Lower bounds of the decrease of the sum of squares when a pole is added to a fit.
pub(super) struct Gains<'a> {
    points: Vec<&'a ResponsePoint>,
    residual: Vec<Complex<f64>>,
    turns: Vec<Complex<f64>>,
    free: bool,
}

impl<'a> Gains<'a> {
    /// Gains over a fit, computed from every `stride`-th point.
    pub(super) fn new(points: &'a [ResponsePoint], fit: &Fit, stride: usize) -> Self {
        let chosen: Vec<usize> = (0..points.len()).step_by(stride).collect();
        let (late, top) = (fit.phase.lateness(), top_hz(points));
        Self {
            residual: chosen
                .iter()
                .map(|&n| (points[n].value - fit.values[n]) / points[n].deviation)
                .collect(),
            turns: chosen
                .iter()
                .map(|&n| late.turn(points[n].frequency_hz, top) / points[n].deviation)
                .collect(),
            points: chosen.iter().map(|&n| &points[n]).collect(),
            free: fit.phase == Phase::Free,
        }
    }

    /// Returns what a pole with a share of 1 explains beside its moving part, if nothing else explains it.
    pub(super) fn of_unit_share(&self, pole: &Pole) -> f64 {
        let (mut cc, mut rr, mut cr) = (0.0, 0.0, 0.0);
        for (point, turn) in self.points.iter().zip(&self.turns) {
            let (resonance, ratio) = resonance(pole, point.frequency_hz);
            let still = turn * resonance;
            let moving = times_j(still) * ratio;
            cc += still.norm_sqr();
            rr += moving.norm_sqr();
            cr += (still.conj() * moving).re;
        }
        cc - cr * cr / rr.max(f64::MIN_POSITIVE)
    }

    /// Returns the gain of a pole with both its coefficients.
    pub(super) fn of(&self, pole: &Pole) -> f64 {
        // Products of the two columns `c` and `r`, and of each with the residual.
        let (mut cc, mut rr, mut cr) = (0.0, 0.0, Complex::new(0.0, 0.0));
        let (mut c_rest, mut r_rest) = (Complex::new(0.0, 0.0), Complex::new(0.0, 0.0));
        for ((point, rest), turn) in self.points.iter().zip(&self.residual).zip(&self.turns) {
            let (resonance, ratio) = resonance(pole, point.frequency_hz);
            let still = turn * resonance;
            let moving = times_j(still) * ratio;
            cc += still.norm_sqr();
            rr += moving.norm_sqr();
            cr += still.conj() * moving;
            c_rest += still.conj() * rest;
            r_rest += moving.conj() * rest;
        }
        if !self.free {
            (cr, c_rest, r_rest) = (cr.re.into(), c_rest.re.into(), r_rest.re.into());
        }
        let determinant = cc * rr - cr.norm_sqr();
        if determinant <= 1e-12 * cc * rr {
            return c_rest.norm_sqr() / cc.max(f64::MIN_POSITIVE);
        }
        (rr * c_rest.norm_sqr() + cc * r_rest.norm_sqr() - 2.0 * (c_rest.conj() * cr * r_rest).re) / determinant
    }
}
