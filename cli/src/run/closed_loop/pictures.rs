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
            let curve = |name: &str, circled: &Circled| {
                let micro = |(degrees, distance): (f64, f64)| (degrees, 1e6 * distance);
                (name.to_owned(), circled.distances().into_iter().map(micro).collect())
            };
            let (name, points) = curve("unshaped", &circles.unshaped);
            let mut curves = vec![Curve::reference(name, points)];
            let matched = circles.matched.as_ref().ok();
            let matched = matched.map(|circled| curve("shaped, delays made equal", circled));
            let apart = curve("shaped, each with its own delay", &circles.apart);
            let shaped = std::iter::once(apart).chain(matched);
            curves.extend(shaped.map(|(name, points)| Curve::new(name, points)));
            let panel = Panel {
                title: "Circle: how far the load is outside of it".into(),
                x_label: "direction from the centre, degrees".into(),
                y_label: "distance, millionths of the unit".into(),
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
        let thousandths = 1e3 / of_axis.loop_counts_per_unit();
        let samples = self.samples(&self.shaped, axis);
        Panel {
            title: format!("axis {}: position", of_axis.name),
            x_label: "time, ms".into(),
            y_label: "position, thousandths of the unit".into(),
            curves: vec![
                Curve::reference("command", self.points(samples, |sample| sample.command * thousandths)),
                Curve::new("shaped", self.points(samples, |sample| sample.shaped * thousandths)),
                Curve::new("load", self.points(samples, |sample| 1e3 * sample.load)),
            ],
        }
    }

    fn error(&self, axis: usize) -> Panel {
        let of_axis = &self.machine.axes[axis];
        let millionths = 1e6 / of_axis.loop_counts_per_unit();
        let samples = self.samples(&self.shaped, axis);
        Panel {
            title: format!("axis {}: what the controller sees of the error", of_axis.name),
            x_label: "time, ms".into(),
            y_label: "error, millionths of the unit".into(),
            curves: vec![Curve::new(
                "error",
                self.points(samples, |sample| sample.error * millionths),
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
        let curves = runs.into_iter().enumerate().map(|(index, (name, moved))| {
            let ringing = moved.ringing(axis);
            let per_ms = self.machine.clock.sample_hz / 1e3;
            let points = ringing.iter().enumerate();
            let points = points
                .map(|(tick, metres)| (tick as f64 / per_ms, 1e6 * metres))
                .collect();
            match index {
                0 => Curve::reference(name, points),
                _ => Curve::new(name, points),
            }
        });
        Panel {
            title: format!("axis {}: the load after its move", self.machine.axes[axis].name),
            x_label: "time since the command came to its end, ms".into(),
            y_label: "from its place of rest, millionths".into(),
            curves: curves.collect(),
        }
    }
}
