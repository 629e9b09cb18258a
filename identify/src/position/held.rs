//! Modes under a command that is held between samples, in closed form at the samples.
//!
//! ```text
//! p = −ζω + jω√(1−ζ²)      w(k+1) = e^{pT}·w(k) + ((e^{pT} − 1)/p)·u(k)        forced, from rest
//!                          v(k)   = e^{pTk}                                     free
//!                          … + ((e^{pT} − 1 − pT)/(p²T))·(u(k+1) − u(k))       where it goes straight to the next
//! y(k) = Σ modes (α·Re w + β·Im w + γ·Re v + δ·Im v) + rigid·u(k) + late·u(k−1) + offset
//! ```
//!
//! A motor that its drive pushes also moves as a rigid body ([`RigidBody`]): its position has the integrals of the command too.
//!
//! This is the zero-order hold without approximation. Rows are means over `decimation` samples, of the response and of these columns alike,
//! so the relation between them stays exact.

use super::Quantity;
use super::memory::NoiseMemory;
use crate::separable::Separable;
use crate::signal::{Between, PositionLog, within};
use nalgebra::{Complex, DMatrix, DVector};
use posicast_shaper::mode::Mode;
use std::ops::Range;

/// A log prepared for the fit of its modes. The unknowns are `ln f` and `ln ζ` of each mode.
#[derive(Debug, Clone)]
pub(super) struct HeldModes<'a> {
    command: Option<&'a [f64]>,
    between: Between,
    sample_s: f64,
    decimation: usize,
    measured: DVector<f64>,
    /// Memory of the noise, which has been removed from rows and columns.
    memory: Option<NoiseMemory>,
    /// Rows that are ignored; they are zero in all columns. Empty if all rows count.
    clipped: Vec<bool>,
    body: Option<RigidBody>,
    quantity: Quantity,
}

/// Motion of a motor as a whole: `1/s` and `1/(s(s + rate))` of its drive's command.
#[derive(Debug, Clone, Copy)]
pub(super) struct RigidBody {
    /// Rate in 1/s at which viscous friction takes its velocity.
    pub(super) rate: f64,
}

impl RigidBody {
    /// Number of samples of the command that act at once or nearly so: parts of the machine faster than the samples, such as a current
    /// loop.
    pub(super) const TAPS: usize = 4;

    /// Columns of a held input: its integral; and that behind `1/(s + rate)`.
    fn moved(&self, input: &[f64], sample_s: f64) -> [Vec<f64>; 2] {
        let kept = (-self.rate * sample_s).exp();
        let [first, second] = [
            decay_integral(self.rate, sample_s),
            decay_integral_twice(self.rate, sample_s),
        ];
        let (mut once, mut velocity, mut position) = (0.0, 0.0, 0.0);
        let mut columns = [Vec::with_capacity(input.len()), Vec::with_capacity(input.len())];
        for now in input {
            columns[0].push(once);
            columns[1].push(position);
            once += sample_s * now;
            position += first * velocity + second * now;
            velocity = kept * velocity + first * now;
        }
        columns
    }
}

/// `(1 − e^{−at})/a`.
fn decay_integral(rate: f64, time_s: f64) -> f64 {
    let decays = rate * time_s;
    if decays == 0.0 {
        time_s
    } else {
        -(-decays).exp_m1() / rate
    }
}

/// `(t − (1 − e^{−at})/a)/a`.
fn decay_integral_twice(rate: f64, time_s: f64) -> f64 {
    let decays = rate * time_s;
    if decays < 1e-4 {
        // Here the difference would consist of rounding errors.
        return time_s * time_s * (0.5 - decays / 6.0);
    }
    (time_s - decay_integral(rate, time_s)) / rate
}

/// Range of damping ratios of a fit.
const DAMPING: (f64, f64) = (1e-5, 0.98);
/// Relative step of the derivatives.
const STEP: f64 = 1e-6;

impl<'a> HeldModes<'a> {
    /// The samples of a log in `range`, in rows of `decimation` samples; rows with a missing sample do not count. The command is left out
    /// if it does not change in the range.
    pub(super) fn new(log: &'a PositionLog, range: Range<usize>, decimation: usize) -> Self {
        let mut missing = vec![false; range.len()];
        for gap in within(&log.missing, range.clone()) {
            missing[gap].fill(true);
        }
        Self::with_filled(log, range, decimation).without(&missing)
    }

    /// The same, but missing samples count with the values that fill them.
    pub(super) fn with_filled(log: &'a PositionLog, range: Range<usize>, decimation: usize) -> Self {
        let response = &log.response[range.clone()];
        let command = log.command.get(range).filter(|command| moves(command));
        let rows = response.len() / decimation;
        let mut this = Self {
            command,
            between: log.between,
            sample_s: log.sample_s,
            decimation,
            measured: DVector::zeros(rows),
            memory: None,
            clipped: Vec::new(),
            body: None,
            quantity: Quantity::Position,
        };
        this.measured = DVector::from_vec(this.rows(response.iter().copied()));
        this
    }

    /// Ignores the rows with a sample that `clipped` marks; the modes continue to move during these rows.
    pub(super) fn without(mut self, clipped: &[bool]) -> Self {
        if clipped.contains(&true) {
            let rows = clipped.chunks_exact(self.decimation).map(|row| row.contains(&true));
            let before = self.clipped.iter().copied().chain(std::iter::repeat(false));
            self.clipped = rows
                .take(self.len())
                .zip(before)
                .map(|(now, before)| now || before)
                .collect();
            let mut measured = self.measured.as_slice().to_vec();
            self.zero_clipped(&mut measured);
            self.measured = DVector::from_vec(measured);
        }
        self
    }

    /// The same for a response of another quantity.
    pub(super) fn of(self, quantity: Quantity) -> Self {
        Self { quantity, ..self }
    }

    /// The same for a motor that moves as a whole.
    pub(super) fn with_body(self, body: RigidBody) -> Self {
        Self {
            body: Some(body),
            ..self
        }
    }

    /// Whether it is a motor that moves as a whole.
    pub(super) fn has_body(&self) -> bool {
        self.body.is_some()
    }

    /// Sets the rows that do not count to zero, in one column after the other.
    pub(super) fn zero_clipped(&self, columns: &mut [f64]) {
        for (value, clipped) in columns.iter_mut().zip(self.clipped.iter().cycle()) {
            if *clipped {
                *value = 0.0;
            }
        }
    }

    /// Fraction of the rows that are used.
    pub(super) fn counted(&self) -> f64 {
        let clipped = self.clipped.iter().filter(|clipped| **clipped).count();
        1.0 - clipped as f64 / self.len().max(1) as f64
    }

    /// Removes from the rows what the past of the noise predicts.
    pub(super) fn whitened(&self, memory: NoiseMemory) -> Self {
        Self {
            measured: DVector::from_vec(memory.whitened(self.measured.as_slice())),
            memory: Some(memory),
            ..self.clone()
        }
    }

    /// The rows with the noise model of another problem.
    pub(super) fn with_memory_of(self, other: &HeldModes<'_>) -> Self {
        match &other.memory {
            Some(memory) => self.whitened(memory.clone()),
            None => self,
        }
    }

    /// Makes columns of rows, and removes from each what the past of the noise predicts.
    fn columns(&self, mut columns: Vec<f64>) -> DMatrix<f64> {
        let rows = self.len();
        self.zero_clipped(&mut columns);
        let columns = match &self.memory {
            None => columns,
            Some(memory) => columns
                .chunks_exact(rows.max(1))
                .flat_map(|column| memory.whitened(column))
                .collect(),
        };
        DMatrix::from_vec(rows, columns.len() / rows.max(1), columns)
    }

    /// Whether a command drives the modes.
    pub(super) fn is_forced(&self) -> bool {
        self.command.is_some()
    }

    /// Time between rows in seconds.
    pub(super) fn row_s(&self) -> f64 {
        self.sample_s * self.decimation as f64
    }

    /// Number of samples in a row.
    pub(super) fn decimation(&self) -> usize {
        self.decimation
    }

    /// Number of rows.
    pub(super) fn len(&self) -> usize {
        self.measured.len()
    }

    /// Number of coefficients of a mode: two of the forced motion, if there is any, and two of the free motion.
    pub(super) fn per_mode(&self) -> usize {
        if self.is_forced() { 4 } else { 2 }
    }

    fn rows(&self, samples: impl Iterator<Item = f64>) -> Vec<f64> {
        let mut rows = Vec::with_capacity(self.len());
        let (mut sum, mut count) = (0.0, 0);
        for sample in samples {
            sum += sample;
            count += 1;
            if count == self.decimation {
                rows.push(sum / self.decimation as f64);
                (sum, count) = (0.0, 0);
                if rows.len() == self.len() {
                    break;
                }
            }
        }
        rows
    }

    fn samples(&self) -> usize {
        self.len() * self.decimation
    }

    /// The columns of one mode.
    pub(super) fn mode_columns(&self, mode: &Mode) -> DMatrix<f64> {
        let pole = Complex::new(-mode.decay(), mode.omega_damped());
        let turn = (pole * self.sample_s).exp();
        let mut columns = Vec::with_capacity(self.per_mode() * self.len());
        if let Some(command) = self.command {
            let push = (turn - 1.0) / pole * mode.omega();
            let bend = match self.between {
                Between::Held => Complex::new(0.0, 0.0),
                Between::Straight => (turn - 1.0 - pole * self.sample_s) / (pole * pole * self.sample_s) * mode.omega(),
            };
            let first = command[0];
            let mut state = Complex::new(0.0, 0.0);
            let mut states = Vec::with_capacity(self.samples());
            // Commands count relative to the first: the effect of commands before the log is in the free motion.
            for (n, now) in command[..self.samples()].iter().enumerate() {
                states.push(state);
                let next = command.get(n + 1).unwrap_or(now);
                state = turn * state + push * (now - first) + bend * (next - now);
            }
            columns.extend(self.rows(states.iter().map(|state| state.re)));
            columns.extend(self.rows(states.iter().map(|state| state.im)));
        }
        let mut free = Complex::new(1.0, 0.0);
        let states: Vec<Complex<f64>> = (0..self.samples())
            .map(|_| {
                let now = free;
                free *= turn;
                now
            })
            .collect();
        columns.extend(self.rows(states.iter().map(|state| state.re)));
        columns.extend(self.rows(states.iter().map(|state| state.im)));
        self.columns(columns)
    }

    /// The columns of everything except the modes.
    fn rest_columns(&self) -> DMatrix<f64> {
        let mut columns = Vec::new();
        if let (Some(command), Some(body)) = (self.command, self.body) {
            return self.columns(self.body_columns(command, body));
        }
        if let Some(command) = self.command {
            let first = command[0];
            let late = std::iter::once(first).chain(command.iter().copied());
            columns.extend(self.rows(command.iter().map(|u| u - first)));
            columns.extend(self.rows(late.map(|u| u - first)));
        }
        columns.extend(std::iter::repeat_n(1.0, self.len()));
        self.columns(columns)
    }

    /// The columns of a motor: taps of the command and its integrals, then the motion from before the log under a constant force.
    fn body_columns(&self, command: &[f64], body: RigidBody) -> Vec<f64> {
        let samples = self.samples();
        let command: Vec<f64> = command[..samples].iter().map(|u| u - command[0]).collect();
        let mut columns = Vec::new();
        for late in 0..RigidBody::TAPS {
            let before = std::iter::repeat_n(0.0, late);
            columns.extend(self.rows(before.chain(command.iter().copied())));
        }
        for column in body.moved(&command, self.sample_s) {
            columns.extend(self.rows(column.into_iter()));
        }
        let time = |n: usize| n as f64 * self.sample_s;
        columns.extend(std::iter::repeat_n(1.0, self.len()));
        columns.extend(self.rows((0..samples).map(|n| decay_integral(body.rate, time(n)))));
        columns.extend(self.rows((0..samples).map(|n| decay_integral_twice(body.rate, time(n)))));
        columns
    }

    /// Static gain of a forced mode, or the amplitude of a free one at the first sample, from its coefficients.
    pub(super) fn strength(&self, mode: &Mode, coefficients: &[f64]) -> f64 {
        match coefficients {
            [along, across, ..] if self.is_forced() => {
                let pole = Complex::new(-mode.decay(), mode.omega_damped());
                let still = -Complex::from(mode.omega()) / pole;
                (along * still.re + across * still.im).abs()
            }
            [along, across, ..] => along.hypot(*across),
            _ => 0.0,
        }
    }

    /// Participation of a mode, up to a factor that all modes share: the static gain if it is forced. A free mode counts as excited by a
    /// jump of the acceleration, after which the amplitudes of the accelerations are participations.
    pub(super) fn participation(&self, mode: &Mode, strength: f64) -> f64 {
        match (self.is_forced(), self.quantity) {
            (true, _) | (false, Quantity::Acceleration) => strength,
            (false, Quantity::Position) => strength * mode.omega().powi(2),
        }
    }

    /// The modes for given unknowns.
    pub(super) fn modes(unknowns: &[f64]) -> Vec<Mode> {
        let (pairs, _) = unknowns.as_chunks::<2>();
        let mode = |[frequency, damping]: &[f64; 2]| Mode {
            frequency_hz: frequency.exp(),
            damping: damping.exp(),
        };
        pairs.iter().map(mode).collect()
    }

    /// The unknowns for given modes.
    pub(super) fn unknowns(modes: &[Mode]) -> Vec<f64> {
        let pair = |mode: &Mode| [mode.frequency_hz.ln(), mode.damping.max(DAMPING.0).ln()];
        modes.iter().flat_map(pair).collect()
    }
}

impl Separable for HeldModes<'_> {
    fn measured(&self) -> &DVector<f64> {
        &self.measured
    }

    fn basis(&self, unknowns: &[f64]) -> DMatrix<f64> {
        let mut columns = Vec::new();
        for mode in Self::modes(unknowns) {
            columns.extend_from_slice(self.mode_columns(&mode).as_slice());
        }
        columns.extend_from_slice(self.rest_columns().as_slice());
        DMatrix::from_vec(self.len(), columns.len() / self.len().max(1), columns)
    }

    fn slopes(&self, unknowns: &[f64], basis: &DMatrix<f64>, coefficients: &DVector<f64>) -> DMatrix<f64> {
        let width = self.per_mode();
        let mut slopes = DMatrix::zeros(self.len(), unknowns.len());
        for n in 0..unknowns.len() {
            let mut moved = unknowns.to_vec();
            moved[n] += STEP;
            let first = n / 2 * width;
            let change = self.mode_columns(&Self::modes(&moved)[n / 2]) - basis.columns(first, width);
            slopes.set_column(n, &(change * coefficients.rows(first, width) / STEP));
        }
        slopes
    }

    fn stepped(&self, unknowns: &[f64], step: &DVector<f64>) -> Vec<f64> {
        let highest = (0.5 / self.sample_s).ln();
        let mut unknowns = unknowns.to_vec();
        let (pairs, _) = unknowns.as_chunks_mut::<2>();
        for (k, [frequency, damping]) in pairs.iter_mut().enumerate() {
            *frequency = (*frequency + step[2 * k].clamp(-0.2, 0.2)).min(highest);
            *damping = (*damping + step[2 * k + 1].clamp(-1.0, 1.0)).clamp(DAMPING.0.ln(), DAMPING.1.ln());
        }
        unknowns
    }
}

/// Returns whether a command changes.
pub(super) fn moves(command: &[f64]) -> bool {
    command.windows(2).any(|pair| pair[0] != pair[1])
}
