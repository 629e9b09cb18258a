//! Reduces the rate of a log to what its band needs: a log of 3,200 samples per second has four times as many as a sweep up to 135 Hz.
//!
//! Each sample that is kept is the mean of those around it, weighted by a low-pass filter with symmetrical taps (a sinc with a Kaiser
//! window). The response of the filter to an excitation follows from its edges: each adds a step, and the response to a step is the sum of
//! the taps. So log and excitation pass the same filter, and the aliases of the sensor's own samples are kept.

use super::excitation::SweptAcceleration;
use crate::parallel::both;
use crate::signal::AccelerationLog;
use std::f64::consts::PI;
use std::ops::Range;

/// Highest frequency in Hz that is kept of every log.
pub(super) const KEPT_HZ: f64 = 320.0;
/// Frequencies up to which the filter passes and above which it stops, relative to the reduced rate.
const PASSED: f64 = 0.4;
const STOPPED: f64 = 0.6;
/// Attenuation of the stopped frequencies in dB: their remainder changes the log by 3e-5.
const STOP_DB: f64 = 90.0;

/// A low-pass filter that keeps one of `factor` samples.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Filter {
    factor: usize,
    /// Number of taps on either side of the middle.
    half: usize,
    taps: Vec<f64>,
    /// Sums of the first taps: of none, of one, and so on up to all.
    sums: Vec<f64>,
}

impl Filter {
    /// Returns the filter that keeps one of `factor` samples; for 1, the filter that changes nothing.
    pub(super) fn new(factor: usize) -> Self {
        let taps = match factor {
            0 | 1 => vec![1.0],
            _ => kaiser(factor),
        };
        let mut sum = 0.0;
        let later = taps.iter().map(|tap| {
            sum += tap;
            sum
        });
        let mut sums: Vec<f64> = std::iter::once(0.0).chain(later).collect();
        if let Some(last) = sums.last_mut() {
            *last = 1.0;
        }
        Self {
            factor: factor.max(1),
            half: taps.len() / 2,
            taps,
            sums,
        }
    }

    /// Returns the filter for a log whose frequencies up to `highest_hz` matter.
    fn up_to(highest_hz: f64, sample_s: f64) -> Self {
        Self::new((PASSED / (highest_hz * sample_s)).min(64.0) as usize)
    }

    /// Number of samples before the first that is kept, and after the last.
    pub(super) fn half(&self) -> usize {
        self.half
    }

    /// The samples that are kept.
    fn kept(&self, samples: &[f64]) -> Vec<f64> {
        let windows = samples.windows(self.taps.len()).step_by(self.factor);
        windows.map(|window| product(window, &self.taps)).collect()
    }

    /// Response of the filter, `now` samples after the first, to an edge that acts from the sample `at` on: the sum of all taps up to
    /// `now − at` samples after the middle.
    #[inline]
    fn response_to_sampled_edge(&self, now: i64, at: i64) -> f64 {
        let taps = (now - at + self.half as i64 + 1).max(0) as usize;
        self.sums.get(taps).copied().unwrap_or(1.0)
    }

    /// The same for an edge `steps` samples ago that acts at once on a sensor which averages over a sample.
    #[inline]
    fn response_to_edge(&self, steps: f64) -> f64 {
        let at = steps + self.half as f64 + 0.5;
        let taps = at.max(0.0) as usize;
        match (self.sums.get(taps), self.taps.get(taps)) {
            (Some(sum), Some(tap)) => sum + tap * (at.max(0.0) - taps as f64),
            _ => 1.0,
        }
    }

    /// Response of the filter to an excitation: `length` samples that are kept, the first `first_s` after the excitation began, of a sensor
    /// with `fine_s` seconds between samples. `averages` tells whether the sensor averages over a sample.
    pub(super) fn of_excitation(
        &self,
        excitation: &SweptAcceleration,
        (first_s, fine_s): (f64, f64),
        length: usize,
        averages: bool,
    ) -> Vec<f64> {
        struct Edge {
            /// In samples after the first.
            at: f64,
            /// The first sample that is not before it.
            sample: i64,
            /// The excitation after it, and by how much it changes.
            level: f64,
            step: f64,
        }
        let mut before = 0.0;
        let edge = |(begin_s, level): (f64, f64)| {
            let at = (begin_s - first_s) / fine_s;
            let step = level - std::mem::replace(&mut before, level);
            let sample = at.ceil() as i64;
            Edge {
                at,
                sample,
                level,
                step,
            }
        };
        let edges: Vec<Edge> = excitation.pieces().map(edge).collect();
        let reach = self.half as f64 + 1.0;
        let (mut settled, mut before) = (0, 0.0);
        let kept = (0..length).map(|n| {
            let sample = n * self.factor;
            let now = sample as f64;
            while let Some(edge) = edges.get(settled).filter(|edge| edge.at < now - reach) {
                (settled, before) = (settled + 1, edge.level);
            }
            let near = edges[settled..].iter().take_while(|edge| edge.at <= now + reach);
            near.fold(before, |value, edge| {
                let part = if averages {
                    self.response_to_edge(now - edge.at)
                } else {
                    self.response_to_sampled_edge(sample as i64, edge.sample)
                };
                value + edge.step * part
            })
        });
        kept.collect()
    }
}

/// The taps of a filter for this factor (Kaiser 1974); their sum is one.
fn kaiser(factor: usize) -> Vec<f64> {
    let width = 2.0 * PI * (STOPPED - PASSED) / factor as f64;
    let half = (0.5 * (STOP_DB - 8.0) / (2.285 * width)).ceil();
    let shape = 0.1102 * (STOP_DB - 8.7);
    let cut = 0.5 * (PASSED + STOPPED) / factor as f64;
    let tap = |n: i32| {
        let at = f64::from(n);
        let sinc = if n == 0 {
            2.0 * cut
        } else {
            (2.0 * PI * cut * at).sin() / (PI * at)
        };
        sinc * bessel(shape * (1.0 - (at / half).powi(2)).max(0.0).sqrt())
    };
    let half = half as i32;
    let mut taps: Vec<f64> = (-half..=half).map(tap).collect();
    let sum: f64 = taps.iter().sum();
    taps.iter_mut().for_each(|tap| *tap /= sum);
    taps
}

/// The modified Bessel function of the first kind and order zero, by its series.
fn bessel(x: f64) -> f64 {
    let (mut term, mut sum) = (1.0, 1.0);
    for n in 1..100 {
        term *= (0.5 * x / f64::from(n)).powi(2);
        sum += term;
    }
    sum
}

/// The sum of products, in several parts that a processor adds at once.
fn product(a: &[f64], b: &[f64]) -> f64 {
    const AT_ONCE: usize = 8;
    let (of_a, rest_a) = a.as_chunks::<AT_ONCE>();
    let (of_b, rest_b) = b.as_chunks::<AT_ONCE>();
    let mut sums = [0.0; AT_ONCE];
    for (a, b) in of_a.iter().zip(of_b) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    let rest: f64 = rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

/// A log at the rate that its band needs.
pub(super) struct Reduced<'a> {
    pub(super) filter: Filter,
    /// Time between the samples of the sensor in seconds.
    pub(super) fine_s: f64,
    /// Number of samples that are kept.
    pub(super) samples: usize,
    pub(super) directions: Vec<(&'a str, Vec<f64>)>,
    pub(super) missing: &'a [Range<usize>],
}

impl<'a> Reduced<'a> {
    /// Returns the log with its frequencies up to `highest_hz`. If samples are missing, all are kept, because a missing one would spoil all
    /// around it.
    pub(super) fn new(log: &'a AccelerationLog, highest_hz: f64) -> Self {
        let filter = if log.missing.is_empty() {
            Filter::up_to(highest_hz.max(KEPT_HZ), log.sample_s)
        } else {
            Filter::new(1)
        };
        let all = log.directions.iter().map(|(_, values)| values.len()).min().unwrap_or(0);
        let kept = |(name, values): &'a (String, Vec<f64>)| (name.as_str(), filter.kept(&values[..all]));
        let (some, others) = log.directions.split_at(log.directions.len() / 2);
        let (mut directions, others): (Vec<_>, Vec<_>) = both(
            || some.iter().map(kept).collect::<Vec<_>>(),
            || others.iter().map(kept).collect::<Vec<_>>(),
        );
        directions.extend(others);
        Self {
            samples: directions.iter().map(|(_, values)| values.len()).min().unwrap_or(0),
            directions,
            fine_s: log.sample_s,
            missing: &log.missing,
            filter,
        }
    }

    /// Time between the samples that are kept, in seconds.
    pub(super) fn sample_s(&self) -> f64 {
        self.fine_s * self.filter.factor as f64
    }

    /// Duration of what is kept, in seconds.
    pub(super) fn seconds(&self) -> f64 {
        self.samples as f64 * self.sample_s()
    }
}

#[cfg(test)]
mod tests {
    use super::super::excitation::{QuarterOrder, Rise, Sweep};
    use super::*;

    #[test]
    fn the_filter_passes_its_band_and_stops_aliases() {
        for factor in [2, 4, 7] {
            let filter = Filter::new(factor);
            let gain = |cycles: f64| -> f64 {
                let turns = filter.taps.iter().enumerate();
                turns
                    .map(|(n, tap)| tap * (2.0 * PI * cycles * (n as f64 - filter.half as f64)).cos())
                    .sum()
            };
            for n in 0..100 {
                let passed = PASSED / factor as f64 * f64::from(n) / 99.0;
                assert!((gain(passed) - 1.0).abs() < 5e-5, "{factor} {passed}");
                let stopped = STOPPED / factor as f64;
                let stopped = stopped + (0.5 - stopped) * f64::from(n) / 99.0;
                assert!(gain(stopped).abs() < 5e-5, "{factor} {stopped}");
            }
        }
    }

    #[test]
    fn log_and_excitation_pass_the_same_filter() {
        let sweep = Sweep {
            end_hz: 40.0,
            rate_hz_per_s: 10.0,
            ..Sweep::default()
        };
        let excitation = SweptAcceleration::new(&sweep, QuarterOrder::Mirrored, Rise::HalfPeriod);
        let fine_s = 1.0 / 3200.0;
        for factor in [1, 4] {
            let filter = Filter::new(factor);
            // The first sample is before the excitation, the last behind it.
            let (before_s, samples) = (0.123_41, 13_000);
            let log = excitation.samples(-before_s, fine_s, samples);
            let kept = filter.kept(&log);
            let first_s = filter.half as f64 * fine_s - before_s;
            let driven = filter.of_excitation(&excitation, (first_s, fine_s), kept.len(), false);
            for (kept, driven) in kept.iter().zip(&driven) {
                assert!((kept - driven).abs() < 1e-12, "{factor} {kept} {driven}");
            }
            // Means over a sample equal those of a hundred times as many samples.
            let many = excitation.samples(-before_s - 0.495 * fine_s, 0.01 * fine_s, 100 * samples);
            let means: Vec<f64> = many.chunks(100).map(|few| few.iter().sum::<f64>() / 100.0).collect();
            let driven = filter.of_excitation(&excitation, (first_s, fine_s), kept.len(), true);
            for (kept, driven) in filter.kept(&means).iter().zip(&driven) {
                assert!((kept - driven).abs() < 0.02 * 2.4, "{factor} {kept} {driven}");
            }
        }
    }
}
