//! The closed loop as pictures.

use super::ClosedLoop;
use crate::plot::{Curve, Panel};
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
                title: "circle: how far the load is outside of it".into(),
                x_label: "direction from the centre, degrees".into(),
                y_label: format!("distance, {}", unit.symbol()),
                curves,
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

    fn position(&self, axis: usize) -> Panel {
        let of_axis = &self.machine.axes[axis];
        let count = 1.0 / of_axis.loop_counts_per_unit();
        let samples = self.samples(&self.shaped, axis);
        let unit = of_axis
            .unit
            .for_largest(samples.iter().map(|sample| sample.command * count));
        let per_count = unit.of(count);
        Panel {
            title: format!("axis {}: position", of_axis.name),
            x_label: "time, ms".into(),
            y_label: format!("position, {}", unit.symbol()),
            curves: vec![
                Curve::reference("command", self.points(samples, |sample| sample.command * per_count)),
                Curve::new("shaped", self.points(samples, |sample| sample.shaped * per_count)),
                Curve::new("load", self.points(samples, |sample| unit.of(sample.load))),
            ],
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
            title: format!("axis {}: what the controller sees of the error", of_axis.name),
            x_label: "time, ms".into(),
            y_label: format!("error, {}", unit.symbol()),
            curves: vec![Curve::new(
                "error",
                self.points(samples, |sample| sample.error * per_count),
            )],
        }
    }

    fn vibration(&self, axis: usize) -> Panel {
        let runs = [
            ("unshaped", &self.unshaped),
            ("shaped", &self.shaped),
            ("shaped, machine 10 % slower", &self.slower),
            ("shaped, machine 10 % faster", &self.faster),
        ];
        let of_axis = &self.machine.axes[axis];
        let all = runs.iter().flat_map(|(_, moved)| moved.ringing(axis));
        let unit = of_axis.unit.for_largest(all);
        let curves = runs.into_iter().enumerate().map(|(index, (name, moved))| {
            let ringing = moved.ringing(axis);
            let per_ms = self.machine.clock.sample_hz / 1e3;
            let points = ringing.iter().enumerate();
            let points = points
                .map(|(tick, position)| (tick as f64 / per_ms, unit.of(*position)))
                .collect();
            match index {
                0 => Curve::reference(name, points),
                _ => Curve::new(name, points),
            }
        });
        Panel {
            title: format!("axis {}: the load after its move", of_axis.name),
            x_label: "time since the command came to its end, ms".into(),
            y_label: format!("from its place of rest, {}", unit.symbol()),
            curves: curves.collect(),
        }
    }
}
