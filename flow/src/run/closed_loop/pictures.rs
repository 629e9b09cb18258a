//! Plots of the closed loop.

use super::ClosedLoop;
use crate::plot::{Corridor, Curve, Mark, Panel, label, time_axis};
use crate::run::pictures::{slowest_period_s, with_settling};
use posicast_closed_loop::stage_bench::AxisSample;
use posicast_closed_loop::stage_run::{Circled, Moved};
use posicast_shaper::unit::ShownUnit;

impl ClosedLoop<'_> {
    /// Each plot with its name in the folder and its panels.
    pub(crate) fn pictures(&self) -> Vec<(&'static str, Vec<Panel>)> {
        let axes = || 0..self.machine.axes.len();
        let mut pictures = vec![
            (
                "plots/stage-move.svg",
                axes()
                    .flat_map(|axis| [self.position(axis), self.error(axis)])
                    .collect(),
            ),
            (
                "plots/stage-vibration.svg",
                axes().map(|axis| self.vibration(axis)).collect(),
            ),
        ];
        let steps = self.step_panels();
        if !steps.is_empty() {
            pictures.push(("plots/stage-steps.svg", steps));
        }
        let compensated: Vec<_> = self.compensated().map(|(axis, _)| self.at_rest(axis)).collect();
        if !compensated.is_empty() {
            pictures.push(("plots/stage-error-table.svg", compensated));
        }
        if let Some(panel) = self.contours.as_ref().and_then(|contours| contours.panel(self.machine)) {
            pictures.push(("plots/stage-contour.svg", vec![panel]));
        }
        if let Ok(circles) = &self.circles {
            let matched = circles.matched.as_ref().ok();
            let all = std::iter::once(&circles.apart).chain(matched);
            let distances = all.flat_map(Circled::distances).map(|(_, distance)| distance);
            let unit = self.circle_unit().for_largest(distances);
            let curve = |name: &str, circled: &Circled| {
                let shown = |(degrees, distance): (f64, f64)| (degrees, unit.of(distance));
                (name.to_owned(), circled.distances().into_iter().map(shown).collect())
            };
            let matched = matched.map(|circled| curve("delays made equal", circled));
            let apart = curve("each shaper with its own delay", &circles.apart);
            let shaped = std::iter::once(apart).chain(matched);
            let curves = shaped.map(|(name, points)| Curve::new(name, points)).collect();
            let panel = Panel {
                title: format!("{}, circle: how far the load is outside of it", self.machine.name),
                x_label: "direction from the centre, degrees".into(),
                y_label: label("distance", unit),
                curves,
                ..Panel::default()
            };
            pictures.push(("plots/stage-circle.svg", vec![panel]));
        }
        pictures
    }

    fn samples<'a>(&self, moved: &'a Moved, axis: usize) -> &'a [AxisSample] {
        moved.samples.get(axis).map_or(&[], Vec::as_slice)
    }

    /// The unit of time in the plots of the move.
    fn time(&self) -> ShownUnit {
        let samples = self.runs().into_iter().flat_map(|(_, moved)| moved.samples.first());
        let ticks = samples.map(Vec::len).max().unwrap_or(0);
        time_axis(self.seconds(ticks))
    }

    fn seconds(&self, ticks: usize) -> f64 {
        ticks as f64 / self.machine.clock.sample_hz
    }

    /// Values over the time since the start.
    fn points(&self, samples: &[AxisSample], value: impl Fn(&AxisSample) -> f64) -> Vec<(f64, f64)> {
        let time = self.time();
        let points = samples.iter().enumerate();
        points
            .map(|(tick, sample)| (time.of(self.seconds(tick)), value(sample)))
            .collect()
    }

    /// Marks the times at which runs were aborted.
    fn trips<'a>(&self, runs: impl IntoIterator<Item = (&'a str, &'a Moved)>) -> Vec<Mark> {
        let time = self.time();
        let trip = |(name, moved): (&str, &Moved)| {
            let trouble = moved.trouble.as_ref()?;
            let ticks = moved.samples.first().map_or(0, Vec::len);
            Some(Mark {
                name: format!("{name}: axis {}", trouble.in_short()),
                at: time.of(self.seconds(ticks)),
            })
        };
        runs.into_iter().filter_map(trip).collect()
    }

    fn title(&self, axis: usize, what: &str) -> String {
        format!("{}, axis {}: {what}", self.machine.name, self.machine.axes[axis].name)
    }

    fn position(&self, axis: usize) -> Panel {
        let of_axis = &self.machine.axes[axis];
        let count = 1.0 / of_axis.loop_counts_per_unit();
        let samples = self.samples(&self.shaped, axis);
        let unit = of_axis
            .unit
            .for_largest(samples.iter().map(|sample| sample.command * count));
        let per_count = unit.of(count);
        Panel {
            title: self.title(axis, "position"),
            x_label: label("time", self.time()),
            y_label: label("position", unit),
            curves: vec![
                Curve::reference("command", self.points(samples, |sample| sample.command * per_count)),
                Curve::new("shaped", self.points(samples, |sample| sample.shaped * per_count)),
                Curve::under("load", self.points(samples, |sample| unit.of(sample.load))),
            ],
            marks: self.trips([("trip", &self.shaped)]),
            ..Panel::default()
        }
    }

    fn error(&self, axis: usize) -> Panel {
        let of_axis = &self.machine.axes[axis];
        let count = 1.0 / of_axis.loop_counts_per_unit();
        let samples = self.samples(&self.shaped, axis);
        let unit = of_axis
            .unit
            .for_largest(samples.iter().map(|sample| sample.error * count));
        let per_count = unit.of(count);
        Panel {
            title: self.title(
                axis,
                match of_axis.steps {
                    None => "what the controller sees of the error",
                    Some(_) => "distance of the counted steps from the shaped position",
                },
            ),
            x_label: label("time", self.time()),
            y_label: label("error", unit),
            curves: vec![Curve::new(
                "error",
                self.points(samples, |sample| sample.error * per_count),
            )],
            band: Some(self.one_count(axis, unit)),
            marks: self.trips([("trip", &self.shaped)]),
            ..Panel::default()
        }
    }

    fn one_count(&self, axis: usize, unit: ShownUnit) -> Corridor {
        let count = unit.of(1.0 / self.machine.axes[axis].loop_counts_per_unit());
        Corridor {
            name: "±1 count".into(),
            range: (-count, count),
        }
    }

    fn runs(&self) -> [(&'static str, &Moved); 4] {
        [
            ("unshaped", &self.unshaped),
            ("shaped", &self.shaped),
            ("machine 10 % slower", &self.slower),
            ("machine 10 % faster", &self.faster),
        ]
    }

    /// The load after its move. If a run was aborted, all runs from their start, because there may be nothing after the
    /// move.
    fn vibration(&self, axis: usize) -> Panel {
        if self.runs().iter().any(|(_, moved)| moved.trouble.is_some()) {
            return self.until_the_trip(axis);
        }
        // Commands end at different times, so the remaining times differ: all curves are as long as the shortest.
        let runs = self.runs().map(|(name, moved)| (name, moved.ringing(axis)));
        let shown = runs.iter().map(|(_, load)| load.len()).filter(|ticks| *ticks > 0).min();
        let shown = shown.unwrap_or(0);
        let time = time_axis(self.seconds(shown));
        let all = runs.iter().flat_map(|(_, load)| load.iter().take(shown).copied());
        let unit = self.machine.axes[axis].unit.for_largest(all);
        let band = self.one_count(axis, unit);
        let slowest_s = slowest_period_s(&self.machine.axes[axis]);
        let curves = runs.into_iter().enumerate().map(|(index, (name, load))| {
            let points = load.into_iter().take(shown).enumerate();
            let points: Vec<_> = points
                .map(|(tick, position)| (time.of(self.seconds(tick)), unit.of(position)))
                .collect();
            let name = with_settling(name, &points, band.range.1, time, slowest_s);
            match index {
                0 => Curve::reference(name, points),
                _ => Curve::new(name, points),
            }
        });
        Panel {
            title: self.title(axis, "the load after its move"),
            x_label: label("time since the command came to its end", time),
            y_label: label("from its place of rest", unit),
            curves: curves.collect(),
            band: Some(band),
            ..Panel::default()
        }
    }

    /// The distance of an axis's load from its target after the move, with the error table and without it.
    fn at_rest(&self, axis: usize) -> Panel {
        let of_axis = &self.machine.axes[axis];
        let count = 1.0 / of_axis.loop_counts_per_unit();
        let distances = |moved: &Moved| -> Vec<f64> {
            let samples = self.samples(moved, axis);
            let target = samples.last().map_or(0.0, |last| last.shaped * count);
            let moving = samples.iter().rposition(|sample| sample.shaped * count != target);
            let rest = samples.get(moving.map_or(0, |last| last + 1)..).unwrap_or_default();
            rest.iter().map(|sample| sample.load - target).collect()
        };
        let without = self.uncompensated.as_ref().map(distances).unwrap_or_default();
        let with = distances(&self.shaped);
        let unit = of_axis.unit.for_largest(without.iter().chain(&with).copied());
        let points = |distances: Vec<f64>| {
            let ticks = distances.into_iter().enumerate();
            ticks
                .map(|(tick, distance)| (self.time().of(self.seconds(tick)), unit.of(distance)))
                .collect()
        };
        Panel {
            title: self.title(axis, "the load after its move, from its target"),
            x_label: label("time since the command came to its end", self.time()),
            y_label: label("from the target", unit),
            curves: vec![
                Curve::reference("without the error table", points(without)),
                Curve::new("with the error table", points(with)),
            ],
            band: Some(self.one_count(axis, unit)),
            ..Panel::default()
        }
    }

    fn until_the_trip(&self, axis: usize) -> Panel {
        let of_axis = &self.machine.axes[axis];
        let off = |sample: &AxisSample| sample.load - sample.shaped / of_axis.loop_counts_per_unit();
        let runs = self.runs().map(|(name, moved)| (name, self.samples(moved, axis)));
        let unit = of_axis
            .unit
            .for_largest(runs.iter().flat_map(|(_, samples)| samples.iter().map(off)));
        let curves = runs.into_iter().enumerate().map(|(index, (name, samples))| {
            let points = self.points(samples, |sample| unit.of(off(sample)));
            match index {
                0 => Curve::reference(name, points),
                _ => Curve::new(name, points),
            }
        });
        Panel {
            title: self.title(axis, "the load about its command, until the run was given up"),
            x_label: label("time", self.time()),
            y_label: label("load less command", unit),
            curves: curves.collect(),
            marks: self.trips(self.runs()),
            ..Panel::default()
        }
    }
}
