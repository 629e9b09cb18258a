//! Plots of the steps of an axis whose drive takes steps: their rate over the move, and the lines in the busiest tick.

use super::ClosedLoop;
use crate::plot::{Curve, Panel, label, time_axis};
use posicast_closed_loop::stage_bench::LineChange;
use posicast_machine::machine_file::{AxisSection, StepsSection};

/// Points of the rate over a move: each is a mean, because a tick has a whole number of steps.
const RATE_POINTS: usize = 200;
/// Height of the second line's levels above those of the first.
const RAISED: f64 = 1.5;

impl ClosedLoop<'_> {
    /// Two panels for each axis with steps.
    pub(super) fn step_panels(&self) -> Vec<Panel> {
        let axes = self.machine.axes.iter().enumerate();
        let with_steps = axes.filter_map(|(index, axis)| Some((index, axis, axis.steps.as_ref()?)));
        with_steps
            .flat_map(|(index, axis, steps)| [Some(self.rate(index, axis, steps)), self.lines(index, axis, steps)])
            .flatten()
            .collect()
    }

    fn rate(&self, index: usize, axis: &AxisSection, steps: &StepsSection) -> Panel {
        let samples = self.shaped.samples.get(index).map_or(&[][..], Vec::as_slice);
        let ticks = (samples.len() / RATE_POINTS).max(1);
        let time = time_axis(samples.len() as f64 / self.machine.clock.sample_hz);
        let rates = |positions: &[f64]| -> Vec<(f64, f64)> {
            let pairs = positions
                .iter()
                .step_by(ticks)
                .zip(positions.iter().skip(ticks).step_by(ticks));
            let middle = |part: usize| (part as f64 + 0.5) * ticks as f64 / self.machine.clock.sample_hz;
            let rate = |(before, after): (&f64, &f64)| (after - before) * self.machine.clock.sample_hz / ticks as f64;
            let points = pairs.enumerate();
            points
                .map(|(part, pair)| (time.of(middle(part)), rate(pair) / 1e3))
                .collect()
        };
        let command: Vec<f64> = samples.iter().map(|sample| sample.command).collect();
        let counted: Vec<f64> = samples.iter().map(|sample| sample.count).collect();
        let shortest_s = steps.times.pulse_s + steps.times.space_s;
        Panel {
            title: format!(
                "{}, axis {}: steps per second; the lines give at most {:.0} kHz",
                self.machine.name,
                axis.name,
                1e-3 / shortest_s
            ),
            x_label: label("time", time),
            y_label: "rate, kHz".into(),
            curves: vec![
                Curve::reference("demanded by the command", rates(&command)),
                Curve::new("given, counted at the lines", rates(&counted)),
            ],
            ..Panel::default()
        }
    }

    fn lines(&self, index: usize, axis: &AxisSection, steps: &StepsSection) -> Option<Panel> {
        let changes = self.shaped.lines.get(index).filter(|changes| changes.len() > 1)?;
        let tick_clocks = u64::from(self.machine.clock.clocks_per_sample());
        let end = tick_clocks.max(changes.last()?.clock);
        let seconds = |clocks: u64| clocks as f64 / self.machine.clock.frequency_hz;
        let time = time_axis(seconds(end));
        let [low_a, low_b] = [steps.active_low.a, steps.active_low.b];
        let named = |name: &str, low: bool| format!("{name}{}", if low { ", active low" } else { "" });
        let curve = |line: usize, name: String, above: f64| {
            let points = levels(changes, line, end).into_iter();
            let points = points.map(|(clock, level)| (time.of(seconds(clock)), above + f64::from(u8::from(level))));
            Curve::new(name, points.collect())
        };
        let [a, b] = steps.mode.line_names();
        Some(Panel {
            title: format!(
                "{}, axis {}: the lines in the tick with most steps",
                self.machine.name, axis.name
            ),
            x_label: label("time since the tick", time),
            y_label: format!("level; {a} is raised by {RAISED}"),
            curves: vec![curve(0, named(a, low_a), RAISED), curve(1, named(b, low_b), 0.0)],
            ..Panel::default()
        })
    }
}

/// The corners of a line's levels, from the first change to the clock `end`.
fn levels(changes: &[LineChange], line: usize, end: u64) -> Vec<(u64, bool)> {
    let mut corners: Vec<(u64, bool)> = Vec::new();
    for change in changes {
        let level = change.levels[line];
        match corners.last() {
            Some((_, before)) if *before == level => {}
            Some((_, before)) => corners.extend([(change.clock, *before), (change.clock, level)]),
            None => corners.push((change.clock, level)),
        }
    }
    let last = corners.last().map(|(_, level)| (end, *level));
    corners.extend(last);
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_has_corners_where_it_changes_and_ends_with_the_tick() {
        let change = |clock, a, b| LineChange { clock, levels: [a, b] };
        let changes = [
            change(0, false, true),
            change(3, true, true),
            change(5, false, true),
            change(6, false, false),
        ];
        let steps = [(0, false), (3, false), (3, true), (5, true), (5, false), (9, false)];
        assert_eq!(levels(&changes, 0, 9), steps);
        assert_eq!(levels(&changes, 1, 9), [(0, true), (6, true), (6, false), (9, false)]);
    }
}
