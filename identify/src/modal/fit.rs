//! The separable least-squares fit of poles to points.

use super::ResponsePoint;
use nalgebra::{Cholesky, Complex, DMatrix, DVector, Dyn};
use std::f64::consts::TAU;

/// A pole pair in the making.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pole {
    pub(crate) frequency_hz: f64,
    pub(crate) damping: f64,
}

/// What is known of the phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Phase {
    /// Nothing: every coefficient is complex.
    Free,
    /// All coefficients are real behind a delay of about this many seconds.
    Delay(f64),
}

impl Phase {
    fn delay_s(self) -> f64 {
        match self {
            Self::Free => 0.0,
            Self::Delay(delay_s) => delay_s,
        }
    }
}

/// Range of damping ratios that a fit walks in.
const DAMPING: (f64, f64) = (2e-4, 2.0);
/// Terms of the complex polynomial that stands for all but the modes.
const FREE_TERMS: i32 = 5;
const ITERATIONS: usize = 60;

/// Poles that fit the points, and how well.
#[derive(Debug, Clone)]
pub(crate) struct Fit {
    pub(crate) poles: Vec<Pole>,
    pub(crate) phase: Phase,
    /// Of each pole: static share, and its standard deviation.
    pub(crate) shares: Vec<(f64, f64)>,
    /// Of each pole: standard deviations of frequency in Hz and of damping.
    pub(crate) deviations: Vec<(f64, f64)>,
    /// Sum of squares of the residuals over their standard deviations.
    pub(crate) square: f64,
    /// Values less unknowns.
    pub(crate) freedoms: f64,
    /// The fitted values.
    pub(crate) values: Vec<Complex<f64>>,
}

impl Fit {
    /// Square per degree of freedom: 1 where noise alone is left.
    pub(crate) fn reduced_square(&self) -> f64 {
        self.square / self.freedoms.max(1.0)
    }
}

const I: Complex<f64> = Complex::new(0.0, 1.0);

/// Denominator of a mode and the frequency over its own.
fn denominator(pole: &Pole, frequency_hz: f64) -> (Complex<f64>, f64) {
    let ratio = frequency_hz / pole.frequency_hz;
    (Complex::new(1.0 - ratio * ratio, 2.0 * pole.damping * ratio), ratio)
}

/// Values of the linear unknowns' columns at one frequency.
fn columns(poles: &[Pole], phase: Phase, frequency_hz: f64, top_hz: f64, row: &mut Vec<Complex<f64>>) {
    let turn = Complex::from_polar(1.0, -TAU * frequency_hz * phase.delay_s());
    for pole in poles {
        let (below, ratio) = denominator(pole, frequency_hz);
        let still = turn / below;
        row.extend([still, I * ratio * still]);
    }
    let relative = frequency_hz / top_hz;
    match phase {
        Phase::Delay(_) => row.extend([turn, turn * relative * relative]),
        Phase::Free => {
            row.extend((0..FREE_TERMS).map(|power| Complex::new((2.0 * relative - 1.0).powi(power), 0.0)));
            for column in 0..row.len() {
                row.push(I * row[column]);
            }
        }
    }
}

/// How many linear unknowns there are.
fn width(poles: &[Pole], phase: Phase) -> usize {
    match phase {
        Phase::Delay(_) => 2 * poles.len() + 2,
        Phase::Free => 2 * (2 * poles.len() + FREE_TERMS as usize),
    }
}

/// A row of values for each point, over its standard deviation; real parts before imaginary parts. `fill` writes the row of a
/// frequency in Hz.
fn stacked(points: &[ResponsePoint], width: usize, mut fill: impl FnMut(f64, &mut Vec<Complex<f64>>)) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(2 * points.len(), width);
    let mut row = Vec::with_capacity(width);
    for (n, point) in points.iter().enumerate() {
        for node_hz in point.nodes_hz() {
            row.clear();
            fill(node_hz, &mut row);
            for (column, value) in row.iter().enumerate() {
                matrix[(n, column)] += 0.5 * value.re / point.deviation;
                matrix[(points.len() + n, column)] += 0.5 * value.im / point.deviation;
            }
        }
    }
    matrix
}

/// Measured values over their standard deviations, real parts before imaginary parts.
fn weighted(points: &[ResponsePoint]) -> DVector<f64> {
    DVector::from_fn(2 * points.len(), |row, _| {
        let point = &points[row % points.len()];
        let value = if row < points.len() {
            point.value.re
        } else {
            point.value.im
        };
        value / point.deviation
    })
}

fn top_hz(points: &[ResponsePoint]) -> f64 {
    points.last().map_or(1.0, |point| point.frequency_hz)
}

/// Cholesky with columns scaled to one.
struct Gram {
    factor: Cholesky<f64, Dyn>,
    scale: DVector<f64>,
}

impl Gram {
    fn new(gram: &DMatrix<f64>) -> Option<Self> {
        let scale = gram.diagonal().map(|square| 1.0 / square.sqrt().max(f64::MIN_POSITIVE));
        let mut scaled = DMatrix::from_fn(gram.nrows(), gram.ncols(), |r, c| gram[(r, c)] * scale[r] * scale[c]);
        for n in 0..scaled.nrows() {
            scaled[(n, n)] += 1e-13;
        }
        scaled.cholesky().map(|factor| Self { factor, scale })
    }

    fn solve(&self, right: &DMatrix<f64>) -> DMatrix<f64> {
        let scaled = DMatrix::from_fn(right.nrows(), right.ncols(), |r, c| right[(r, c)] * self.scale[r]);
        let solved = self.factor.solve(&scaled);
        DMatrix::from_fn(right.nrows(), right.ncols(), |r, c| solved[(r, c)] * self.scale[r])
    }

    fn solve_one(&self, right: &DVector<f64>) -> DVector<f64> {
        let solved = self.factor.solve(&right.component_mul(&self.scale));
        solved.component_mul(&self.scale)
    }
}

/// The linear part of a fit at given poles and delay.
struct Linear {
    basis: DMatrix<f64>,
    gram: Gram,
    coefficients: DVector<f64>,
    residual: DVector<f64>,
}

/// Solves the linear unknowns; `None` where the points do not fix them.
fn linear(points: &[ResponsePoint], measured: &DVector<f64>, poles: &[Pole], phase: Phase) -> Option<Linear> {
    let top = top_hz(points);
    let basis = stacked(points, width(poles, phase), |frequency_hz, row| {
        columns(poles, phase, frequency_hz, top, row);
    });
    let gram = Gram::new(&basis.tr_mul(&basis))?;
    let coefficients = gram.solve_one(&basis.tr_mul(measured));
    let residual = measured - &basis * &coefficients;
    residual.norm_squared().is_finite().then_some(Linear {
        basis,
        gram,
        coefficients,
        residual,
    })
}

impl Linear {
    fn values(&self, points: &[ResponsePoint]) -> Vec<Complex<f64>> {
        let fitted = &self.basis * &self.coefficients;
        let value =
            |(n, point): (usize, &ResponsePoint)| Complex::new(fitted[n], fitted[points.len() + n]) * point.deviation;
        points.iter().enumerate().map(value).collect()
    }

    /// Complex coefficients of a pole: still, and with the velocity.
    fn of_pole(&self, pole: usize, phase: Phase) -> (Complex<f64>, Complex<f64>) {
        let at = |column: usize| match phase {
            Phase::Delay(_) => Complex::new(self.coefficients[column], 0.0),
            Phase::Free => Complex::new(
                self.coefficients[column],
                self.coefficients[column + self.coefficients.len() / 2],
            ),
        };
        (at(2 * pole), at(2 * pole + 1))
    }

    /// Weighted derivatives of the fitted values by `ln f` and `ln ζ` of each pole and by the delay, without what the linear
    /// unknowns take over.
    fn slopes(&self, points: &[ResponsePoint], poles: &[Pole], phase: Phase) -> DMatrix<f64> {
        let delays = usize::from(matches!(phase, Phase::Delay(_)));
        let (top, mut values) = (top_hz(points), Vec::new());
        let slopes = stacked(points, 2 * poles.len() + delays, |frequency_hz, row| {
            let turn = Complex::from_polar(1.0, -TAU * frequency_hz * phase.delay_s());
            for (k, pole) in poles.iter().enumerate() {
                let (below, ratio) = denominator(pole, frequency_hz);
                let (still, moving) = self.of_pole(k, phase);
                let above = still + I * moving * ratio;
                let by_ratio =
                    I * moving / below - above * Complex::new(-2.0 * ratio, 2.0 * pole.damping) / (below * below);
                row.push(-by_ratio * ratio * turn);
                row.push(-above * I * (2.0 * ratio * pole.damping) / (below * below) * turn);
            }
            if delays > 0 {
                values.clear();
                columns(poles, phase, frequency_hz, top, &mut values);
                let value: Complex<f64> = values.iter().zip(&self.coefficients).map(|(v, c)| v * c).sum();
                row.push(-I * TAU * frequency_hz * value);
            }
        });
        let shared = self.gram.solve(&self.basis.tr_mul(&slopes));
        slopes - &self.basis * shared
    }
}

fn stepped(poles: &[Pole], phase: Phase, step: &DVector<f64>) -> (Vec<Pole>, Phase) {
    let poles: Vec<Pole> = poles
        .iter()
        .enumerate()
        .map(|(k, pole)| Pole {
            frequency_hz: pole.frequency_hz * step[2 * k].clamp(-0.2, 0.2).exp(),
            damping: (pole.damping * step[2 * k + 1].clamp(-1.0, 1.0).exp()).clamp(DAMPING.0, DAMPING.1),
        })
        .collect();
    let phase = match phase {
        Phase::Free => Phase::Free,
        Phase::Delay(delay_s) => Phase::Delay(delay_s + step[2 * poles.len()]),
    };
    (poles, phase)
}

/// What is left of the points with exactly these poles and this phase: the square of the residuals over their deviations.
pub(crate) fn square(points: &[ResponsePoint], poles: &[Pole], phase: Phase) -> Option<f64> {
    linear(points, &weighted(points), poles, phase).map(|linear| linear.residual.norm_squared())
}

/// The best fit near the given poles: Levenberg and Marquardt's method. `None` where the points do not fix the unknowns.
pub(crate) fn refine(points: &[ResponsePoint], poles: &[Pole], phase: Phase) -> Option<Fit> {
    let measured = weighted(points);
    let (mut poles, mut phase) = (poles.to_vec(), phase);
    let mut now = linear(points, &measured, &poles, phase)?;
    let mut slopes = now.slopes(points, &poles, phase);
    let mut damping = 1e-3;
    for _ in 0..ITERATIONS {
        let gram = slopes.tr_mul(&slopes);
        if gram.is_empty() {
            break;
        }
        let mut stiff = gram.clone();
        for n in 0..gram.nrows() {
            stiff[(n, n)] *= 1.0 + damping;
        }
        let step = Gram::new(&stiff)?.solve_one(&slopes.tr_mul(&now.residual));
        let (tried, tried_phase) = stepped(&poles, phase, &step);
        let square = now.residual.norm_squared();
        match linear(points, &measured, &tried, tried_phase) {
            Some(better) if better.residual.norm_squared() < square => {
                let gain = square - better.residual.norm_squared();
                (poles, phase, now) = (tried, tried_phase, better);
                slopes = now.slopes(points, &poles, phase);
                damping = (damping * 0.2).max(1e-9);
                if gain < 1e-6 * square {
                    break;
                }
            }
            _ => {
                damping *= 8.0;
                if damping > 1e6 {
                    break;
                }
            }
        }
    }
    Some(finished(points, poles, phase, &now, &slopes))
}

fn finished(points: &[ResponsePoint], poles: Vec<Pole>, phase: Phase, now: &Linear, slopes: &DMatrix<f64>) -> Fit {
    let square = now.residual.norm_squared();
    let freedoms = (now.residual.len() as f64 - now.coefficients.len() as f64 - slopes.ncols() as f64).max(1.0);
    // What the noise of the points does not explain is taken as more noise.
    let scale = (square / freedoms).max(1.0);
    let covariance = Gram::new(&slopes.tr_mul(slopes))
        .map(|gram| gram.solve(&DMatrix::identity(slopes.ncols(), slopes.ncols())) * scale);
    let deviation = |n: usize| covariance.as_ref().map_or(f64::INFINITY, |c| c[(n, n)].max(0.0).sqrt());
    let deviations = poles
        .iter()
        .enumerate()
        .map(|(k, pole)| {
            (
                pole.frequency_hz * deviation(2 * k),
                pole.damping * deviation(2 * k + 1),
            )
        })
        .collect();
    let width = now.coefficients.len();
    let of_linear = now.gram.solve(&DMatrix::identity(width, width)) * scale;
    let shares = (0..poles.len())
        .map(|k| {
            (
                now.of_pole(k, phase).0.norm(),
                of_linear[(2 * k, 2 * k)].max(0.0).sqrt(),
            )
        })
        .collect();
    Fit {
        values: now.values(points),
        poles,
        phase,
        shares,
        deviations,
        square,
        freedoms,
    }
}

/// How much the square of the residuals falls at least if a pole is added to a fit.
pub(super) struct Gains<'a> {
    points: Vec<&'a ResponsePoint>,
    residual: Vec<Complex<f64>>,
    turns: Vec<Complex<f64>>,
    free: bool,
}

impl<'a> Gains<'a> {
    /// Gains over a fit, judged from every `stride`-th point.
    pub(super) fn new(points: &'a [ResponsePoint], fit: &Fit, stride: usize) -> Self {
        let chosen: Vec<usize> = (0..points.len()).step_by(stride).collect();
        let delay_s = fit.phase.delay_s();
        Self {
            residual: chosen
                .iter()
                .map(|&n| (points[n].value - fit.values[n]) / points[n].deviation)
                .collect(),
            turns: chosen
                .iter()
                .map(|&n| Complex::from_polar(1.0 / points[n].deviation, -TAU * points[n].frequency_hz * delay_s))
                .collect(),
            points: chosen.iter().map(|&n| &points[n]).collect(),
            free: fit.phase == Phase::Free,
        }
    }

    /// The gain of a pole with both its coefficients.
    pub(super) fn of(&self, pole: &Pole) -> f64 {
        // Two columns `c` and `r`, their products and those with the residual.
        let (mut cc, mut rr, mut cr) = (0.0, 0.0, Complex::new(0.0, 0.0));
        let (mut c_rest, mut r_rest) = (Complex::new(0.0, 0.0), Complex::new(0.0, 0.0));
        for ((point, rest), turn) in self.points.iter().zip(&self.residual).zip(&self.turns) {
            let (below, ratio) = denominator(pole, point.frequency_hz);
            let still = turn / below;
            let moving = I * ratio * still;
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
