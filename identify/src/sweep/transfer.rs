//! Measures the transfer function from the acceleration of an axis to that of the sensor over a whole sweep.
//!
//! The machine is at rest at both ends of a log, so the transforms of the whole record can be divided without
//! leakage: `H = Y/U` on lines `1/T` apart. Neighbouring lines are joined to [`ResponsePoint`]s by a local straight
//! line through `H`, by least squares with the weights `|U|²`; the residuals of the lines are the noise.
//!
//! A sensor that samples without a filter aliases the edges of the excitation into the band. That part is known too,
//! and is subtracted: it is the difference between the samples of the excitation and its means.

use super::excitation::SweptAcceleration;
use crate::modal::{Lateness, ResponsePoint};
use crate::spectrum::{Transform, fast_length};
use nalgebra::Complex;

/// Lines of a record within a band.
pub(super) struct Lines {
    first: usize,
    resolution_hz: f64,
    values: Vec<Complex<f64>>,
}

impl Lines {
    /// Difference of these lines and others of the same band.
    pub(super) fn beside(&self, other: &Self) -> Self {
        let values = self.values.iter().zip(&other.values).map(|(line, other)| line - other);
        Self {
            values: values.collect(),
            ..*self
        }
    }

    /// Sum of the squares of all lines.
    pub(super) fn power(&self) -> f64 {
        self.values.iter().map(Complex::norm_sqr).sum()
    }

    fn frequency_hz(&self, line: usize) -> f64 {
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

/// Converts records to lines of one band.
pub(super) struct Analyser {
    transform: Transform,
    sample_s: f64,
    samples: usize,
    length: usize,
    band: Band,
}

impl Analyser {
    pub(super) fn new(samples: usize, sample_s: f64, band: Band) -> Self {
        let length = fast_length(samples);
        Self {
            transform: Transform::new(length),
            sample_s,
            samples,
            length,
            band,
        }
    }

    /// Lines of a record, whose mean is subtracted first.
    pub(super) fn lines(&mut self, record: &[f64]) -> Lines {
        let mean = record.iter().sum::<f64>() / record.len().max(1) as f64;
        let centred: Vec<f64> = record.iter().map(|x| x - mean).collect();
        let all = self.transform.forward(&centred);
        let resolution_hz = 1.0 / (self.length as f64 * self.sample_s);
        let first = (self.band.low_hz / resolution_hz).ceil() as usize;
        let last = ((self.band.high_hz / resolution_hz).floor() as usize).min(all.len() - 1);
        Lines {
            first,
            resolution_hz,
            values: all.get(first..=last).unwrap_or_default().to_vec(),
        }
    }

    /// Lines of an excitation that begins `start_s` after the first sample, without what its samples alias into the
    /// band.
    pub(super) fn excitation(&mut self, excitation: &SweptAcceleration, start_s: f64) -> Lines {
        let means = excitation.means(-start_s, self.sample_s, self.samples);
        let mut lines = self.lines(&means);
        for line in 0..lines.values.len() {
            // The mean over a sample attenuates a line by sinc(f·T).
            let angle = std::f64::consts::PI * lines.frequency_hz(line) * self.sample_s;
            if angle > 0.0 {
                lines.values[line] *= angle / angle.sin();
            }
        }
        lines
    }

    /// Lines of the samples of an excitation, with everything that they alias into the band.
    pub(super) fn sampled(&mut self, excitation: &SweptAcceleration, start_s: f64) -> Lines {
        let samples = excitation.samples(-start_s, self.sample_s, self.samples);
        self.lines(&samples)
    }

    /// Lines of an excitation, from those of one that began `delay_s` earlier. This is exact if the log contains both
    /// completely.
    pub(super) fn later(&self, lines: &Lines, delay_s: f64) -> Lines {
        let late = Lateness { delay_s, bend_s: 0.0 };
        let turned = lines.values.iter().enumerate();
        let turned = turned.map(|(n, line)| line * late.turn(lines.frequency_hz(n), self.band.high_hz));
        Lines {
            values: turned.collect(),
            ..*lines
        }
    }
}

/// Lines whose excitation is below this fraction of the mean are not used.
const EXCITED: f64 = 1e-3;

/// Delay of the response in seconds, and its sharpness: the largest value of the impulse response over its root mean
/// square. The record is treated as periodic.
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
    let impulse = Transform::new(length).inverse(&lines);
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

/// Additional delay in seconds for each multiple of the highest frequency, as a clock causes that drifts against that
/// of the sweep. The delay must be about right for the middle of the band.
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
    let mut transform = Transform::new(length);
    let mut sharpness = |bend_s: f64| {
        let bent = Lateness {
            delay_s: -bend_s,
            bend_s,
        };
        let straight = phases
            .iter()
            .map(|(frequency_hz, phase)| phase * bent.turn(*frequency_hz, high_hz).conj());
        let impulse = transform.inverse(&straight.collect::<Vec<_>>());
        impulse.iter().map(|x| x.abs()).fold(0.0, f64::max)
    };
    let straight = sharpness(0.0);
    let tried = (-STEPS..=STEPS).map(|step| STEP_S * f64::from(step));
    let best = tried
        .map(|bend_s| (sharpness(bend_s), bend_s))
        .max_by(|a, b| a.0.total_cmp(&b.0));
    // A slightly sharper result is chance, and modes are not quite straight.
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
    /// The points of a band.
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

/// The transfer function of lines of one band.
///
/// `folded` is what the samples of the excitation alias into the band, where that is known.
pub(super) fn transfer(response: &Lines, excitation: &Lines, folded: Option<&Lines>) -> Transfer {
    let groups = groups(response);
    let (mut clean, mut share) = (response.values.clone(), 0.0);
    if let Some(folded) = folded {
        share = shown(&groups, response, excitation, folded);
        for (line, folded) in clean.iter_mut().zip(&folded.values) {
            *line -= folded * share;
        }
    }
    let (mut fits, mut explained, mut power) = (Vec::new(), 0.0, 0.0);
    for group in groups {
        let fitted = straight(group.clone(), &clean, excitation);
        let rest: f64 = group
            .clone()
            .map(|line| (clean[line] - excitation.values[line] * fitted.at(excitation.frequency_hz(line))).norm_sqr())
            .sum();
        let (lines, freedoms) = (group.len() as f64, 2.0 * (group.len() as f64 - 2.0));
        let total: f64 = group.map(|line| clean[line].norm_sqr()).sum();
        power += total;
        explained += (total - rest * lines / (lines - 2.0)).max(0.0);
        fits.push((fitted, rest, freedoms));
    }
    let points = (0..fits.len()).map(|n| {
        let near = &fits[n.saturating_sub(NOISE_NEIGHBOURS)..(n + NOISE_NEIGHBOURS + 1).min(fits.len())];
        // The median is used, because a line of a fan or of the mains affects few points.
        let mut variances: Vec<f64> = near.iter().map(|(_, rest, freedoms)| rest / freedoms).collect();
        variances.sort_by(f64::total_cmp);
        let variance = variances[variances.len() / 2].max(fits[n].1 / fits[n].2 * 0.1);
        ResponsePoint {
            frequency_hz: fits[n].0.centre_hz,
            spread_hz: fits[n].0.spread_hz,
            value: fits[n].0.value,
            deviation: (variance / fits[n].0.weight).sqrt(),
        }
    });
    let points = points
        .filter(|p| p.deviation.is_finite() && p.deviation > 0.0)
        .collect();
    Transfer {
        points,
        explained: if power > 0.0 { explained / power } else { 0.0 },
        folded: share,
    }
}

/// The fraction of the aliased part that a response contains.
fn shown(groups: &[std::ops::Range<usize>], response: &Lines, excitation: &Lines, folded: &Lines) -> f64 {
    let (mut shared, mut square) = (Complex::new(0.0, 0.0), 0.0);
    for group in groups {
        let fitted = straight(group.clone(), &response.values, excitation);
        for line in group.clone() {
            let rest = response.values[line] - excitation.values[line] * fitted.at(excitation.frequency_hz(line));
            shared += rest * folded.values[line].conj();
            square += folded.values[line].norm_sqr();
        }
    }
    if square > 0.0 { shared.re / square } else { 0.0 }
}

/// Ranges of lines, each for a point.
fn groups(lines: &Lines) -> Vec<std::ops::Range<usize>> {
    let mut groups = Vec::new();
    let mut begin = 0;
    while begin < lines.values.len() {
        let width = (RELATIVE_WIDTH * lines.frequency_hz(begin) / lines.resolution_hz) as usize;
        let end = begin + width.max(LEAST_LINES);
        if end > lines.values.len() {
            break;
        }
        groups.push(begin..end);
        begin = end;
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
