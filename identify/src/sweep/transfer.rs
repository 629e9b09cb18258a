//! Measures the transfer function from the acceleration of an axis to that of the sensor over a whole sweep.
//!
//! The machine is at rest at both ends of a log, so the transforms of the whole record can be divided without
//! leakage: `H = Y/U` on lines `1/T` apart. Neighbouring lines are joined to [`ResponsePoint`]s by a local straight
//! line through `H`, by least squares with the weights `|U|²`; the residuals of the lines are the noise.
//!
//! A sensor that samples without a filter aliases the edges of the excitation into the band. That part is known too,
//! and is subtracted: it is the difference between the samples of the excitation and its means.

use crate::modal::{Lateness, ResponsePoint};
use crate::separable::Gram;
use crate::spectrum::{Transform, fast_length};
use nalgebra::{Complex, DMatrix, DVector};

/// Lines of a record within a band.
#[derive(Clone)]
pub(super) struct Lines {
    pub(super) first: usize,
    pub(super) resolution_hz: f64,
    /// Number of lines for each independent one.
    pub(super) dense: usize,
    pub(super) values: Vec<Complex<f64>>,
}

impl Lines {
    /// Sum of the squares of all lines.
    pub(super) fn power(&self) -> f64 {
        self.values.iter().map(Complex::norm_sqr).sum()
    }

    /// Sum of these lines and a multiple of others of the same band.
    pub(super) fn plus(&self, factor: f64, other: &Self) -> Self {
        let values = self.values.iter().zip(&other.values);
        Self {
            values: values.map(|(line, other)| line + other * factor).collect(),
            ..*self
        }
    }

    /// Frequency of one of these lines in Hz.
    pub(super) fn frequency_hz(&self, line: usize) -> f64 {
        (self.first + line) as f64 * self.resolution_hz
    }
}

/// A band of frequencies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Lower end.
    pub low_hz: f64,
    /// Upper end.
    pub high_hz: f64,
}

/// Lines whose excitation is below this fraction of the mean are not used.
const EXCITED: f64 = 1e-3;

/// Delay of the response in seconds, and its sharpness: the largest value of the impulse response over its root mean square. The record is
/// treated as periodic.
pub(super) fn delay(response: &Lines, excitation: &Lines) -> (f64, f64) {
    let mean = excitation.values.iter().map(Complex::norm_sqr).sum::<f64>() / excitation.values.len().max(1) as f64;
    // Only the phase is used: a resonance would outweigh the rest, and has a delay of its own.
    let phases = response.values.iter().zip(&excitation.values).map(|(y, u)| {
        let cross = y * u.conj();
        if u.norm_sqr() < EXCITED * mean || cross.norm() == 0.0 {
            Complex::new(0.0, 0.0)
        } else {
            cross / cross.norm()
        }
    });
    let mut lines = vec![Complex::new(0.0, 0.0); response.first];
    lines.extend(phases);
    let length = fast_length(8 * lines.len());
    let impulse = Transform::new(length).inverse(lines);
    let square = impulse.iter().map(|x| x * x).sum::<f64>() / length as f64;
    let mut largest = (0, 0.0);
    for (n, x) in impulse.iter().enumerate() {
        if x.abs() > largest.1 {
            largest = (n, x.abs());
        }
    }
    let record_s = 1.0 / response.resolution_hz;
    let late_s = largest.0 as f64 / length as f64 * record_s;
    let late_s = if late_s > 0.5 * record_s {
        late_s - record_s
    } else {
        late_s
    };
    (late_s, largest.1 / square.sqrt().max(f64::MIN_POSITIVE))
}

/// Additional delay in seconds for each multiple of the highest frequency, as caused by a clock that drifts against that of the sweep. The
/// delay must be about right for the middle of the band.
pub(super) fn bend(response: &Lines, excitation: &Lines, high_hz: f64) -> f64 {
    /// Spacing of the frequencies, and of the bends, that are tried.
    const RESOLUTION_HZ: f64 = 0.25;
    const STEP_S: f64 = 0.4e-3;
    const STEPS: i32 = 240;
    let joined = ((RESOLUTION_HZ / response.resolution_hz) as usize).max(1);
    let lines: Vec<usize> = (0..response.values.len()).step_by(joined).collect();
    let phases: Vec<(f64, Complex<f64>)> = lines
        .windows(2)
        .map(|pair| {
            let cross = (pair[0]..pair[1]).map(|n| response.values[n] * excitation.values[n].conj());
            let sum: Complex<f64> = cross.sum();
            let middle = (pair[0] + pair[1]) / 2;
            (response.frequency_hz(middle), sum / sum.norm().max(f64::MIN_POSITIVE))
        })
        .collect();
    let length = fast_length(4 * phases.len());
    let transform = Transform::new(length);
    let sharpness = |bend_s: f64| {
        let bent = Lateness {
            delay_s: -bend_s,
            bend_s,
        };
        let straight = phases
            .iter()
            .map(|(frequency_hz, phase)| phase * bent.turn(*frequency_hz, high_hz).conj());
        let impulse = transform.inverse(straight.collect());
        impulse.iter().map(|x| x.abs()).fold(0.0, f64::max)
    };
    let straight = sharpness(0.0);
    let tried = (-STEPS..=STEPS).map(|step| STEP_S * f64::from(step));
    let best = tried
        .map(|bend_s| (sharpness(bend_s), bend_s))
        .max_by(|a, b| a.0.total_cmp(&b.0));
    // A slightly sharper result is a coincidence, and the phase of modes is not quite straight.
    best.filter(|(sharpest, _)| *sharpest > 1.15 * straight)
        .map_or(0.0, |(_, bend_s)| bend_s)
}

/// A transfer function with its noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Transfer {
    /// Points in order of frequency.
    pub points: Vec<ResponsePoint>,
    /// Fraction of the response's power in the band that the excitation explains, 0 to 1.
    pub explained: f64,
    /// Fraction of the aliased edges that the sensor shows: 1 where it samples without a filter, 0 with an ideal
    /// filter.
    pub folded: f64,
}

impl Transfer {
    /// Returns a transfer function without points.
    pub(super) fn empty() -> Self {
        Self {
            points: Vec::new(),
            explained: 0.0,
            folded: 0.0,
        }
    }

    /// Returns only the points in a band.
    pub(super) fn within(mut self, band: &Band) -> Self {
        self.points
            .retain(|point| (band.low_hz..=band.high_hz).contains(&point.frequency_hz));
        self
    }
}

/// Width of a point relative to its frequency: a tenth of the width of a mode with 1 % damping.
const RELATIVE_WIDTH: f64 = 0.002;
/// Smallest number of lines in a point: two determine the straight line, the others its noise.
const LEAST_LINES: usize = 5;
/// Number of neighbours on either side whose noise is averaged.
const NOISE_NEIGHBOURS: usize = 10;

/// Fraction of the samples at which a frequency shakes the axis, relative to that of the whole log, below which this frequency is not
/// reported.
const LEAST_SEEN: f64 = 0.6;

/// Transforms that are divided, with their aliases.
#[derive(Clone, Copy)]
pub(super) struct Division<'a> {
    pub(super) response: &'a Lines,
    pub(super) excitation: &'a Lines,
    /// Aliases in the band of the samples of the excitation and of its integrals; empty if unknown.
    pub(super) folded: &'a [Lines],
    /// Lines that count.
    pub(super) trusted: &'a [bool],
}

/// A transfer function line by line, in straight pieces.
pub(super) struct Estimate {
    pieces: Vec<Piece>,
    /// Fraction of the response's power in the band that the excitation explains, 0 to 1.
    pub(super) explained: f64,
    /// Fraction of each aliased part that the sensor shows.
    pub(super) folded: Vec<f64>,
    least_seen: f64,
}

struct Piece {
    lines: std::ops::Range<usize>,
    fitted: Straight,
    /// Sum of squares of the residual, and degrees of freedom.
    rest: f64,
    freedoms: f64,
    /// Number of lines for each independent one.
    dense: f64,
    /// Fraction of the samples at which these frequencies shake the axis that were measured.
    seen: f64,
}

impl Estimate {
    fn seen(&self) -> impl Iterator<Item = &Piece> {
        self.pieces.iter().filter(|piece| piece.seen >= self.least_seen)
    }

    /// Returns the transfer function at each line of the band; at lines that were not measured, interpolated between neighbours.
    pub(super) fn lines(&self, excitation: &Lines) -> Vec<Complex<f64>> {
        let seen: Vec<&Piece> = self.seen().collect();
        let mut next = 0;
        let value = |line: usize| {
            while seen.get(next).is_some_and(|piece| piece.lines.end <= line) {
                next += 1;
            }
            let at_hz = excitation.frequency_hz(line);
            let before = next.checked_sub(1).map(|n| &seen[n].fitted);
            match (before, seen.get(next)) {
                (_, Some(here)) if here.lines.contains(&line) => here.fitted.at(at_hz),
                (Some(a), Some(b)) => {
                    let part = (at_hz - a.centre_hz) / (b.fitted.centre_hz - a.centre_hz);
                    a.value + (b.fitted.value - a.value) * part
                }
                (Some(one), None) => one.value,
                (None, Some(one)) => one.fitted.value,
                (None, None) => Complex::new(1.0, 0.0),
            }
        };
        (0..excitation.values.len()).map(value).collect()
    }

    /// Gain of the lowest or the highest frequencies.
    pub(super) fn gain(&self, at_top: bool) -> f64 {
        const PIECES: usize = 20;
        let seen: Vec<&Piece> = self.seen().collect();
        let few = if at_top {
            &seen[seen.len().saturating_sub(PIECES)..]
        } else {
            &seen[..seen.len().min(PIECES)]
        };
        let (sum, weight) = few.iter().fold((0.0, 0.0), |(sum, weight), piece| {
            let fitted = &piece.fitted;
            (sum + fitted.weight * fitted.value.re, weight + fitted.weight)
        });
        if weight > 0.0 { sum / weight } else { 1.0 }
    }

    /// Returns the points of the pieces that were measured.
    pub(super) fn transfer(&self) -> Transfer {
        let variance = |piece: &Piece| piece.rest / piece.freedoms / piece.seen;
        let seen: Vec<&Piece> = self.seen().collect();
        let points = (0..seen.len()).map(|n| {
            let near = &seen[n.saturating_sub(NOISE_NEIGHBOURS)..(n + NOISE_NEIGHBOURS + 1).min(seen.len())];
            // The median is used, because a line of a fan or of the mains affects few points.
            let mut variances: Vec<f64> = near.iter().map(|piece| variance(piece)).collect();
            let middle = variances.len() / 2;
            let (_, median, _) = variances.select_nth_unstable_by(middle, f64::total_cmp);
            let fitted = &seen[n].fitted;
            ResponsePoint {
                frequency_hz: fitted.centre_hz,
                spread_hz: fitted.spread_hz,
                value: fitted.value,
                deviation: (median.max(0.1 * variance(seen[n])) * seen[n].dense / (fitted.weight * seen[n].seen))
                    .sqrt(),
            }
        });
        let points = points
            .filter(|p| p.deviation.is_finite() && p.deviation > 0.0)
            .collect();
        Transfer {
            points,
            explained: self.explained,
            folded: self.folded.first().copied().unwrap_or(0.0),
        }
    }

    /// Returns the bands in which too little was measured.
    pub(super) fn unseen(&self, excitation: &Lines) -> Vec<Band> {
        let mut bands: Vec<Band> = Vec::new();
        let mut joins = false;
        for piece in &self.pieces {
            let is_unseen = piece.seen < self.least_seen;
            if is_unseen {
                let high_hz = excitation.frequency_hz(piece.lines.end);
                match bands.last_mut().filter(|_| joins) {
                    Some(last) => last.high_hz = high_hz,
                    None => bands.push(Band {
                        low_hz: excitation.frequency_hz(piece.lines.start),
                        high_hz,
                    }),
                }
            }
            joins = is_unseen;
        }
        bands
    }
}

/// Divides the lines of a band. `seen` returns, for a frequency in Hz, the fraction of the samples at which it shakes the axis that were
/// measured.
pub(super) fn estimate(division: &Division<'_>, seen: impl Fn(f64) -> f64) -> Estimate {
    let Division {
        response,
        excitation,
        folded,
        trusted,
    } = *division;
    let groups = groups(response, trusted);
    let mut clean = response.values.clone();
    let shares = shown(&groups, division);
    for (share, folded) in shares.iter().zip(folded) {
        for (line, folded) in clean.iter_mut().zip(&folded.values) {
            *line -= folded * *share;
        }
    }
    let (mut pieces, mut explained, mut power) = (Vec::with_capacity(groups.len()), 0.0, 0.0);
    for group in groups {
        let fitted = straight(group.clone(), &clean, excitation);
        let rest: f64 = group
            .clone()
            .map(|line| (clean[line] - excitation.values[line] * fitted.at(excitation.frequency_hz(line))).norm_sqr())
            .sum();
        let lines = group.len() as f64 / response.dense as f64;
        let total: f64 = group.clone().map(|line| clean[line].norm_sqr()).sum();
        power += total;
        explained += (total - rest * lines / (lines - 2.0)).max(0.0);
        pieces.push(Piece {
            seen: seen(fitted.centre_hz),
            lines: group,
            fitted,
            rest,
            freedoms: 2.0 * response.dense as f64 * (lines - 2.0),
            dense: response.dense as f64,
        });
    }
    let usual = pieces.iter().map(|piece| piece.seen).sum::<f64>() / pieces.len().max(1) as f64;
    Estimate {
        least_seen: LEAST_SEEN * usual,
        pieces,
        explained: if power > 0.0 { explained / power } else { 0.0 },
        folded: shares,
    }
}

/// Fractions of the aliased parts that a response contains, by least squares on the residual of a transfer function.
fn shown(groups: &[std::ops::Range<usize>], division: &Division<'_>) -> Vec<f64> {
    let Division {
        response,
        excitation,
        folded,
        ..
    } = *division;
    let parts = folded.len();
    let mut products = DMatrix::zeros(parts, parts);
    let mut shared = DVector::zeros(parts);
    if parts == 0 {
        return Vec::new();
    }
    for group in groups {
        // The part that a smooth transfer function would explain is removed from each.
        let rest = |values: &[Complex<f64>]| {
            let fitted = straight(group.clone(), values, excitation);
            let rest = group
                .clone()
                .map(|line| values[line] - excitation.values[line] * fitted.at(excitation.frequency_hz(line)));
            rest.collect::<Vec<_>>()
        };
        let left = rest(&response.values);
        let columns: Vec<Vec<Complex<f64>>> = folded.iter().map(|part| rest(&part.values)).collect();
        // The weight of a group is the reciprocal of its residual, so that a resonance does not outweigh the rest.
        let weight = 1.0 / left.iter().map(Complex::norm_sqr).sum::<f64>().max(f64::MIN_POSITIVE);
        let product = |a: &[Complex<f64>], b: &[Complex<f64>]| {
            weight * a.iter().zip(b).map(|(a, b)| (a.conj() * b).re).sum::<f64>()
        };
        for (n, column) in columns.iter().enumerate() {
            shared[n] += product(column, &left);
            for (m, other) in columns.iter().enumerate() {
                products[(n, m)] += product(column, other);
            }
        }
    }
    match Gram::new(&products) {
        Some(gram) => gram.solve_one(&shared).iter().copied().collect(),
        None => vec![0.0; parts],
    }
}

/// Ranges of lines that count, one for each point.
fn groups(lines: &Lines, trusted: &[bool]) -> Vec<std::ops::Range<usize>> {
    let mut groups = Vec::new();
    let mut begin = 0;
    while begin < lines.values.len() {
        let width = (RELATIVE_WIDTH * lines.frequency_hz(begin) / lines.resolution_hz) as usize;
        let end = begin + width.max(LEAST_LINES * lines.dense);
        if end > lines.values.len() {
            break;
        }
        match trusted[begin..end].iter().rposition(|trusted| !trusted) {
            // A straight line over omitted lines would be determined from one side only.
            Some(last) => begin += last + 1,
            None => {
                groups.push(begin..end);
                begin = end;
            }
        }
    }
    groups
}

/// A straight line through `H` over a few lines.
struct Straight {
    centre_hz: f64,
    value: Complex<f64>,
    slope: Complex<f64>,
    weight: f64,
    spread_hz: f64,
}

impl Straight {
    fn at(&self, frequency_hz: f64) -> Complex<f64> {
        self.value + self.slope * (frequency_hz - self.centre_hz)
    }
}

fn straight(group: std::ops::Range<usize>, response: &[Complex<f64>], excitation: &Lines) -> Straight {
    let weight = |line: usize| excitation.values[line].norm_sqr();
    let total: f64 = group.clone().map(weight).sum();
    let centre_hz = group
        .clone()
        .map(|l| weight(l) * excitation.frequency_hz(l))
        .sum::<f64>()
        / total;
    let (mut value, mut slope, mut spread) = (Complex::new(0.0, 0.0), Complex::new(0.0, 0.0), 0.0);
    for line in group {
        let cross = response[line] * excitation.values[line].conj();
        let off_hz = excitation.frequency_hz(line) - centre_hz;
        value += cross;
        slope += cross * off_hz;
        spread += weight(line) * off_hz * off_hz;
    }
    Straight {
        centre_hz,
        value: value / total,
        slope: if spread > 0.0 {
            slope / spread
        } else {
            Complex::new(0.0, 0.0)
        },
        weight: total,
        spread_hz: (spread / total).sqrt(),
    }
}
