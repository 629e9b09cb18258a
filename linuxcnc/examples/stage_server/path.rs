//! The distance between the load of the machine and the path of a program.

use plotters::prelude::*;
use posicast_closed_loop::stage_bench::AxisSample;
use posicast_machine::contour::{Shape, Stroke, gcode};
use posicast_machine::plant::axis::ErrorFigures;
use std::error::Error;
use std::path::Path;

const PICTURE: (u32, u32) = (900, 420);
const COLOURS: [RGBColor; 2] = [RGBColor(31, 119, 180), RGBColor(214, 39, 40)];
/// Largest number of points of a curve.
const POINTS: usize = 4000;

/// The errors of a run, in m.
pub(crate) struct Recording {
    name: String,
    errors: Vec<f64>,
    sample_s: f64,
}

impl Recording {
    /// Computes the distance of the load of the first two axes from the nearest point of a program's path, at each tick at which it moves
    /// or has just moved. `origins` are the positions of the program's zero.
    pub(crate) fn new(
        name: &str,
        program: &str,
        samples: &[Vec<AxisSample>],
        origins: [f64; 2],
        sample_s: f64,
    ) -> Result<Self, Box<dyn Error>> {
        let strokes = gcode::strokes(program)?;
        let [x, y] = samples else {
            return Err("a path has two axes".into());
        };
        let errors = x.iter().zip(y).map(|(x, y)| {
            let load = [x.load - origins[0], y.load - origins[1]];
            strokes
                .iter()
                .map(|stroke| distance(stroke, load))
                .fold(f64::INFINITY, f64::min)
        });
        Ok(Self {
            name: name.to_owned(),
            errors: errors.collect(),
            sample_s,
        })
    }

    /// Its figures in µm.
    pub(crate) fn json(&self) -> String {
        let figures = ErrorFigures::of(self.errors.iter().copied());
        let peak_at = self.errors.iter().position(|error| *error == figures.peak).unwrap_or(0);
        format!(
            "{{\"name\": {:?}, \"seconds\": {:.3}, \"peak_um\": {:.3}, \"peak_s\": {:.3}, \"rms_um\": {:.3}}}",
            self.name,
            self.errors.len() as f64 * self.sample_s,
            figures.peak * 1e6,
            peak_at as f64 * self.sample_s,
            figures.rms * 1e6
        )
    }
}

fn distance(Stroke { shape, .. }: &Stroke, point: [f64; 2]) -> f64 {
    let [x, y] = Shape::at(shape, shape.nearest(point));
    (point[0] - x).hypot(point[1] - y)
}

/// Draws the errors of all recordings over time.
pub(crate) fn picture(file: &Path, recordings: &[Recording]) -> Result<(), Box<dyn Error>> {
    let seconds = recordings
        .iter()
        .map(|one| one.errors.len() as f64 * one.sample_s)
        .fold(0.1, f64::max);
    let most = recordings
        .iter()
        .flat_map(|one| &one.errors)
        .fold(1e-6, |most, error| error.max(most))
        * 1e6;
    let root = SVGBackend::new(file, PICTURE).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .margin(12)
        .x_label_area_size(40)
        .y_label_area_size(56)
        .build_cartesian_2d(0.0..seconds, 0.0..most * 1.05)?;
    chart
        .configure_mesh()
        .x_desc("time, s")
        .y_desc("distance from the path, µm")
        .draw()?;
    for (one, colour) in recordings.iter().zip(COLOURS.into_iter().cycle()) {
        let every = one.errors.len().div_ceil(POINTS).max(1);
        let places = one.errors.chunks(every).enumerate();
        let line = places.map(|(place, errors)| {
            let most = errors.iter().copied().fold(0.0, f64::max);
            ((place * every) as f64 * one.sample_s, most * 1e6)
        });
        chart
            .draw_series(LineSeries::new(line, &colour))?
            .label(&one.name)
            .legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 18, y)], colour));
    }
    chart
        .configure_series_labels()
        .background_style(WHITE.mix(0.8))
        .draw()?;
    root.present()?;
    Ok(())
}
