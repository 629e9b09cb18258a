//! The closed loop as pictures.

use super::ClosedLoop;
use crate::plot::{Band, Curve, Mark, Panel};
use crate::run::pictures::with_settling;
use posicast_testbench::stage_bench::AxisSample;
use posicast_testbench::stage_run::{Circled, Moved};

impl ClosedLoop<'_> {
    /// Name in the folder and panels of each picture.
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
        if let Some(circles) = &self.circles {
            let curve = |name: &str, circled: &Circled| {
                let micro = |(degrees, distance): (f64, f64)| (degrees, 1e6 * distance);
                (name.to_owned(), circled.distances().into_iter().map(micro).collect())
            };
            let matched = circles.matched.as_ref().ok();
            let matched = matched.map(|circled| curve("delays made equal", circled));
            let apart = curve("each shaper with its own delay", &circles.apart);
            let shaped = std::iter::once(apart).chain(matched);
            let curves = shaped.map(|(name, points)| Curve::new(name, points)).collect();
            let panel = Panel {
                title: format!("{}, circle: how far the load is outside of it", self.machine.name),
                x_label: "direction from the centre, degrees".into(),
                y_label: "distance, millionths of the unit".into(),
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

    /// Points over the time since the start, ms.
    fn points(&self, samples: &[AxisSample], value: impl Fn(&AxisSample) -> f64) -> Vec<(f64, f64)> {
        let per_ms = self.machine.clock.sample_hz / 1e3;
        let points = samples.iter().enumerate();
        points
            .map(|(tick, sample)| (tick as f64 / per_ms, value(sample)))
            .collect()
    }

    /// Where a run was given up, in ms after its start.
    fn trips<'a>(&self, runs: impl IntoIterator<Item = (&'a str, &'a Moved)>) -> Vec<Mark> {
        let per_ms = self.machine.clock.sample_hz / 1e3;
        let trip = |(name, moved): (&str, &Moved)| {
            let trouble = moved.trouble.as_ref()?;
            let ticks = moved.samples.first().map_or(0, Vec::len);
            Some(Mark {
                name: format!("{name}: axis {}", trouble.in_short()),
                at: ticks as f64 / per_ms,
            })
        };
        runs.into_iter().filter_map(trip).collect()
    }

    fn title(&self, axis: usize, what: &str) -> String {
        format!("{}, axis {}: {what}", self.machine.name, self.machine.axes[axis].name)
    }

    fn position(&self, axis: usize) -> Panel {
        let of_axis = &self.machine.axes[axis];
        let thousandths = 1e3 / of_axis.loop_counts_per_unit();
        let samples = self.samples(&self.shaped, axis);
        Panel {
            title: self.title(axis, "position"),
            x_label: "time, ms".into(),
            y_label: "position, thousandths of the unit".into(),
            curves: vec![
                Curve::reference("command", self.points(samples, |sample| sample.command * thousandths)),
                Curve::new("shaped", self.points(samples, |sample| sample.shaped * thousandths)),
                Curve::new("load", self.points(samples, |sample| 1e3 * sample.load)),
            ],
            marks: self.trips([("trip", &self.shaped)]),
            ..Panel::default()
        }
    }

    fn error(&self, axis: usize) -> Panel {
        let of_axis = &self.machine.axes[axis];
        let millionths = 1e6 / of_axis.loop_counts_per_unit();
        let samples = self.samples(&self.shaped, axis);
        Panel {
            title: self.title(axis, "what the controller sees of the error"),
            x_label: "time, ms".into(),
            y_label: "error, millionths of the unit".into(),
            curves: vec![Curve::new(
                "error",
                self.points(samples, |sample| sample.error * millionths),
            )],
            band: Some(self.one_count(axis)),
            marks: self.trips([("trip", &self.shaped)]),
            ..Panel::default()
        }
    }

    fn one_count(&self, axis: usize) -> Band {
        let count = 1e6 / self.machine.axes[axis].loop_counts_per_unit();
        Band {
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

    /// The load after its move; where a run was given up, all runs from their start, since there may be nothing after it.
    fn vibration(&self, axis: usize) -> Panel {
        if self.runs().iter().any(|(_, moved)| moved.trouble.is_some()) {
            return self.until_the_trip(axis);
        }
        let per_ms = self.machine.clock.sample_hz / 1e3;
        let band = self.one_count(axis);
        let curves = self.runs().into_iter().enumerate().map(|(index, (name, moved))| {
            let points = moved.ringing(axis).into_iter().enumerate();
            let points: Vec<_> = points
                .map(|(tick, metres)| (tick as f64 / per_ms, 1e6 * metres))
                .collect();
            let name = with_settling(name, &points, band.range.1);
            match index {
                0 => Curve::reference(name, points),
                _ => Curve::new(name, points),
            }
        });
        Panel {
            title: self.title(axis, "the load after its move"),
            x_label: "time since the command came to its end, ms".into(),
            y_label: "from its place of rest, millionths".into(),
            curves: curves.collect(),
            band: Some(band),
            ..Panel::default()
        }
    }

    fn until_the_trip(&self, axis: usize) -> Panel {
        let per_unit = self.machine.axes[axis].loop_counts_per_unit();
        let curves = self.runs().into_iter().enumerate().map(|(index, (name, moved))| {
            let samples = self.samples(moved, axis);
            let points = self.points(samples, |sample| 1e6 * (sample.load - sample.shaped / per_unit));
            match index {
                0 => Curve::reference(name, points),
                _ => Curve::new(name, points),
            }
        });
        Panel {
            title: self.title(axis, "the load about its command, until the run was given up"),
            x_label: "time, ms".into(),
            y_label: "load less command, millionths".into(),
            curves: curves.collect(),
            marks: self.trips(self.runs()),
            ..Panel::default()
        }
    }
}
