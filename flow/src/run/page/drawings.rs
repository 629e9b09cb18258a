//! Pictures that only the page has: impulses, commands, residual maps, kinds of shaper.

use crate::plot::{Curve, Level, Map, Note, Panel, Writing, label, time_axis};
use crate::run::report::RunReport;
use crate::simulate::si_per_lsb;
use plotters::style::RGBColor;
use posicast_machine::compare::{Candidate, KindComparison};
use posicast_machine::machine_file::AxisSection;
use posicast_machine::plan::AxisTables;
use posicast_shaper::analysis::{sensitivity_grid, tap_impulses};
use posicast_shaper::impulse::Impulse;
use posicast_shaper::mode::Mode;
use posicast_shaper::unit::trimmed;

/// Frequency ratios that a map shows, its largest damping, and its points.
const RATIOS: (f64, f64) = (0.6, 1.4);
const DAMPINGS: (f64, f64) = (0.1, 0.95);
const GRID: (usize, usize) = (81, 31);
/// Residual in percent above which a kind is not drawn, unless it is the machine's own.
const SHOWN_PERCENT: f64 = 30.0;
/// Colours of a map's levels, which colour-blind readers can distinguish (ColorBrewer's RdBu): blue is within the tolerance.
const LEVELS: [RGBColor; 5] = [
    RGBColor(33, 102, 172),
    RGBColor(146, 197, 222),
    RGBColor(253, 219, 199),
    RGBColor(244, 165, 130),
    RGBColor(178, 24, 43),
];

/// Impulses as lines from 0 up to their amplitude.
fn stems(impulses: &[Impulse], per_s: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let stem = |impulse: &Impulse| {
        let at = per_s(impulse.time_s);
        [(at, 0.0), (at, impulse.amplitude), (at, 0.0)]
    };
    impulses.iter().flat_map(stem).collect()
}

/// The impulses of an axis's design and its integer taps.
pub(super) fn impulses(axis: &AxisSection, tables: &AxisTables, sample_hz: f64) -> Panel {
    let design = tables.design.impulses.impulses();
    let taps = tap_impulses(&tables.table, sample_hz);
    let last_s = taps.last().map_or(0.0, |tap| tap.time_s).max(1.0 / sample_hz);
    let time = time_axis(last_s);
    let dots = design
        .iter()
        .map(|impulse| (time.of(impulse.time_s), impulse.amplitude));
    // The ends of the time axis, so that the first and the last impulse are not on its border.
    let line = vec![(time.of(-0.04 * last_s), 0.0), (time.of(1.04 * last_s), 0.0)];
    Panel {
        title: format!("axis {}: impulses of {}", axis.name, tables.design.kind),
        x_label: label("time", time),
        y_label: "amplitude".into(),
        curves: vec![
            Curve::reference(
                "before: one impulse of 1",
                [(0.0, 0.0), (0.0, 1.0), (0.0, 0.0)].to_vec(),
            ),
            Curve::reference("", line),
            Curve::new("after: integer taps on the samples", stems(&taps, |s| time.of(s))),
            Curve::dots("after: impulses of the design", dots.collect()),
        ],
        ..Panel::default()
    }
}

impl RunReport<'_> {
    /// The command of an axis before the shaper and after it.
    pub(super) fn command_panel(&self, index: usize, axis: &AxisSection) -> Panel {
        let sample_hz = self.sample_hz();
        let run = &self.axes[index];
        let words = &self.words[index];
        let per_lsb = si_per_lsb(self.machine, axis);
        let time = time_axis(words.len() as f64 / sample_hz);
        let values = || words.iter().map(|word| *word as f64 * per_lsb);
        let unit = axis.unit.for_largest(values());
        let points = |values: &mut dyn Iterator<Item = f64>| {
            let samples = values.enumerate();
            samples
                .map(|(n, value)| (time.of(n as f64 / sample_hz), unit.of(value)))
                .collect::<Vec<_>>()
        };
        let rtl = &self.waves.unwrapped[index];
        Panel {
            title: format!("axis {}: command", axis.name),
            x_label: label("time", time),
            y_label: label("position", unit),
            curves: vec![
                Curve::reference("before the shaper", points(&mut values())),
                Curve::new(
                    "after it, float design",
                    points(&mut run.float.iter().map(|word| word * per_lsb)),
                ),
                Curve::beside(
                    format!("after it, {}", self.waves.device),
                    points(&mut rtl.iter().map(|word| *word as f64 * per_lsb)),
                ),
            ],
            ..Panel::default()
        }
    }

    /// The residual over frequency and damping of each mode of an axis.
    pub(super) fn maps<'a>(&'a self, axis: &'a AxisSection, tables: &'a AxisTables) -> impl Iterator<Item = Map> + 'a {
        let taps = tap_impulses(&tables.table, self.sample_hz());
        axis.modes.iter().enumerate().map(move |(number, of)| {
            let Mode { frequency_hz, damping } = of.mode;
            let tolerance = axis.shaped().tolerance_of(of);
            let most = (2.0 * damping).clamp(DAMPINGS.0, DAMPINGS.1);
            let grid = sensitivity_grid(&taps, &of.mode, RATIOS, (0.0, most), GRID);
            let percent = |part: f64| format!("{} %", trimmed(100.0 * part, 3));
            let bounds = [0.5, 1.0, 2.0, 4.0].map(|factor| factor * tolerance);
            let names = [
                format!("up to {}", percent(bounds[0])),
                format!("up to the tolerance, {}", percent(bounds[1])),
                format!("up to {}", percent(bounds[2])),
                format!("up to {}", percent(bounds[3])),
                "more".to_owned(),
            ];
            let levels = names
                .into_iter()
                .zip(LEVELS)
                .zip(bounds.into_iter().chain([f64::INFINITY]));
            Map {
                title: format!(
                    "axis {}, mode {}: residual vibration of the integer taps",
                    axis.name,
                    number + 1
                ),
                labels: ["frequency of the mode, Hz".to_owned(), "damping".to_owned()],
                columns: grid.ratios.iter().map(|ratio| ratio * frequency_hz).collect(),
                rows: grid.dampings,
                values: grid.residual,
                levels: levels
                    .map(|((name, colour), up_to)| Level { up_to, name, colour })
                    .collect(),
                mark: (frequency_hz, damping),
            }
        })
    }
}

/// The kinds of shaper on an axis: duration against worst residual.
pub(super) fn kinds(of: &KindComparison, band_percent: f64) -> Panel {
    let longest_s = of.candidates.iter().map(|kind| kind.duration_s).fold(0.0, f64::max);
    let time = time_axis(longest_s);
    let place = |kind: &Candidate| (time.of(kind.duration_s), 100.0 * kind.worst_residual);
    let is_shown = |kind: &&Candidate| kind.in_file || 100.0 * kind.worst_residual <= SHOWN_PERCENT;
    let shown = || of.candidates.iter().filter(is_shown);
    let best: Vec<_> = shown().filter(|kind| kind.pareto && !kind.in_file).collect();
    let others: Vec<_> = shown().filter(|kind| !kind.pareto && !kind.in_file).collect();
    let own: Vec<_> = shown().filter(|kind| kind.in_file).collect();
    let note = |kind: &Candidate, writing: Writing| Note {
        text: kind.kind.clone(),
        at: place(kind),
        writing,
    };
    let notes = [
        (&own, Writing::Always),
        (&best, Writing::WhereFree),
        (&others, Writing::Never),
    ];
    let notes = notes.into_iter();
    let notes = notes.flat_map(|(kinds, writing)| kinds.iter().map(move |kind| note(kind, writing)));
    let notes: Vec<Note> = notes.collect();
    let dots = |kinds: &[&Candidate]| kinds.iter().map(|kind| place(kind)).collect();
    Panel {
        title: format!(
            "axis {}: kinds of shaper, modes off by up to ±{band_percent} %",
            of.axis
        ),
        x_label: label("duration", time),
        y_label: "worst residual, %".into(),
        curves: vec![
            Curve::dots("this machine's", dots(&own)),
            Curve::dots("no other is better in everything", dots(&best)),
            Curve::dots("other kinds", dots(&others)),
            Curve::reference("", vec![(0.0, 0.0), (1.1 * time.of(longest_s), 0.0)]),
        ],
        notes,
        ..Panel::default()
    }
}
