//! The plots of `identify`: the fit, the shapers over the frequency, and the ringing.

use super::findings::{Evidence, Findings};
use crate::plot::{Curve, Mark, Panel, Range, label, time_axis};
use posicast_identify::log::Log;
use posicast_identify::modal::ResponsePoint;
use posicast_identify::recommend::{Recommendation, deflection};
use posicast_identify::spectrum::{PowerSpectrum, welch};
use posicast_shaper::analysis::sensitivity_curve;
use posicast_shaper::impulse::ImpulseSequence;
use posicast_shaper::unit::trimmed;

/// Number of shapers that are drawn.
const SHAPERS: usize = 4;
/// Range of frequencies that the curves of the shapers show, relative to a mode's.
const RATIOS: (f64, f64) = (0.5, 1.5);
const POINTS: usize = 601;

pub(super) fn panels(findings: &Findings, log: &Log) -> Vec<Panel> {
    let power = powers(findings, log);
    let mut panels: Vec<Panel> = power.iter().map(|power| spectrum(findings, power)).collect();
    panels.push(evidence(findings));
    if let Some(best) = findings.recommended.first() {
        panels.extend((0..findings.modes.len()).map(|mode| shapers(findings, mode)));
        panels.push(ringing(findings, best));
    }
    panels
}

/// The spectrum of the direction that was used, with a resolution of about half a hertz.
fn powers(findings: &Findings, log: &Log) -> Option<PowerSpectrum> {
    const SEGMENT_S: f64 = 2.0;
    let Log::Acceleration(log) = log else { return None };
    let (_, record) = log
        .directions
        .iter()
        .find(|(name, _)| Some(name) == findings.direction.as_ref())?;
    Some(welch(record, log.sample_s, (SEGMENT_S / log.sample_s) as usize))
}

/// Spectrum of the log, up to one and a half times the highest mode or the end of the sweep.
fn spectrum(findings: &Findings, power: &PowerSpectrum) -> Panel {
    const LEAST_HZ: f64 = 150.0;
    let highest = findings
        .modes
        .iter()
        .map(|found| found.mode.frequency_hz)
        .fold(LEAST_HZ, f64::max);
    let lines = (1.5 * highest / power.resolution_hz) as usize;
    let amplitudes = power.density.iter().take(lines).enumerate().skip(1);
    Panel {
        title: format!("{}: spectrum of the whole log", findings.source),
        x_label: "frequency, Hz".into(),
        y_label: "m/s² per √Hz".into(),
        curves: vec![Curve::new(
            format!("mean of {} segments (Welch)", power.segments),
            amplitudes
                .map(|(line, density)| (power.frequency_hz(line), density.sqrt()))
                .collect(),
        )],
        marks: findings
            .modes
            .iter()
            .map(|found| Mark {
                name: "mode".into(),
                at: found.mode.frequency_hz,
            })
            .collect(),
        ..Panel::default()
    }
}

fn evidence(findings: &Findings) -> Panel {
    match &findings.evidence {
        Evidence::Transfer { points, fitted } => transfer(findings, points, fitted),
        Evidence::Response {
            name,
            row_s,
            measured,
            fitted,
        } => response(name, *row_s, measured, fitted),
    }
}

fn transfer(findings: &Findings, points: &[ResponsePoint], fitted: &[(f64, f64)]) -> Panel {
    let measured = points.iter().map(|point| (point.frequency_hz, point.value.norm()));
    let left = points
        .iter()
        .zip(fitted)
        .map(|(point, (_, fit))| (point.frequency_hz, (point.value.norm() - fit).abs()));
    Panel {
        title: format!("{}: acceleration of the sensor over that of the axis", findings.source),
        x_label: "frequency, Hz".into(),
        y_label: "ratio".into(),
        curves: vec![
            Curve::under("measured", measured.collect()),
            Curve::new("modes", fitted.to_vec()),
            Curve::new("what they leave", left.collect()),
        ],
        x_ranges: intervals(findings),
        ..Panel::default()
    }
}

fn response(name: &str, row_s: f64, measured: &[f64], fitted: &[f64]) -> Panel {
    let time = time_axis(row_s * measured.len() as f64);
    let over_time = |values: &mut dyn Iterator<Item = f64>| {
        values
            .enumerate()
            .map(|(n, value)| (time.of(n as f64 * row_s), value))
            .collect::<Vec<_>>()
    };
    let mut left = measured.iter().zip(fitted).map(|(measured, fitted)| measured - fitted);
    Panel {
        title: format!("{name}: measured, and reconstructed from the modes"),
        x_label: label("time", time),
        y_label: "unit of the log".into(),
        curves: vec![
            Curve::under("measured", over_time(&mut measured.iter().copied())),
            Curve::new("modes", over_time(&mut fitted.iter().copied())),
            Curve::new("what they leave", over_time(&mut left)),
        ],
        ..Panel::default()
    }
}

/// The 95 % intervals of the frequencies.
fn intervals(findings: &Findings) -> Vec<Range> {
    let range = |low: f64, high: f64| Range {
        name: "95 % interval of the frequency".into(),
        ends: (low, high),
    };
    let of_modes = findings.modes.iter().map(|found| found.frequency_interval_hz());
    of_modes.map(|interval| range(interval.low, interval.high)).collect()
}

fn shapers(findings: &Findings, mode: usize) -> Panel {
    let found = &findings.modes[mode];
    let frequency_hz = found.mode.frequency_hz;
    let curve = |shaper: &Recommendation| {
        let points = sensitivity_curve(shaper.impulses.impulses(), &found.mode, RATIOS.0, RATIOS.1, POINTS);
        let points = points
            .into_iter()
            .map(|(ratio, residual)| (ratio * frequency_hz, 100.0 * residual));
        Curve::new(shaper.kind.name(), points.collect())
    };
    let enough = 100.0 * findings.judgement.enough;
    let mut curves: Vec<Curve> = findings.recommended.iter().take(SHAPERS).map(curve).collect();
    curves.push(Curve::limit(
        format!("{} %", trimmed(enough, 3)),
        vec![(RATIOS.0 * frequency_hz, enough), (RATIOS.1 * frequency_hz, enough)],
    ));
    let interval = found.frequency_interval_hz();
    let margin = findings.judgement.margin * frequency_hz;
    Panel {
        title: format!("mode of {} Hz: what the shapers leave of it", trimmed(frequency_hz, 4)),
        x_label: "true frequency of the mode, Hz".into(),
        y_label: "residual vibration, %".into(),
        curves,
        x_ranges: vec![Range {
            name: "interval and margin".into(),
            ends: (interval.low - margin, interval.high + margin),
        }],
        ..Panel::default()
    }
}

fn ringing(findings: &Findings, best: &Recommendation) -> Panel {
    /// Number of periods of the slowest mode that are shown.
    const PERIODS: f64 = 12.0;
    let slowest = findings
        .modes
        .iter()
        .map(|found| found.mode.frequency_hz)
        .fold(f64::INFINITY, f64::min);
    let duration_s = best.impulses.duration_s() + PERIODS / slowest;
    let acceleration = findings.judgement.acceleration;
    let of = |impulses: &ImpulseSequence| deflection(&findings.modes, impulses, acceleration, duration_s, POINTS);
    let (unshaped, shaped) = (of(&ImpulseSequence::unity()), of(&best.impulses));
    let largest = unshaped.iter().map(|(_, x)| x.abs()).fold(0.0, f64::max);
    let (time, length) = (time_axis(duration_s), findings.unit.for_size(largest));
    let scaled = |points: Vec<(f64, f64)>| points.into_iter().map(|(t, x)| (time.of(t), length.of(x))).collect();
    Panel {
        title: format!(
            "deflection after a jump of the acceleration by {} {}/s²",
            trimmed(acceleration, 4),
            findings.unit.si_name()
        ),
        x_label: label("time", time),
        y_label: label("deflection", length),
        curves: vec![
            Curve::reference("without a shaper", scaled(unshaped)),
            Curve::new(best.kind.name(), scaled(shaped)),
        ],
        ..Panel::default()
    }
}
