//! The legend of a panel, in rows above its chart, so that no curve runs under it.

use super::{Area, BAND, DARK_RED, DASH, Drawn, Panel, TEXT_SIZE};
use plotters::prelude::*;

/// Length of the line sample before a name, and the gaps beside it, in pixels.
const SAMPLE: i32 = 26;
const GAP: i32 = 6;
const BETWEEN: i32 = 20;
const ROW: i32 = 18;
/// Fraction of a panel's height below which a band is thinner than a curve, which would hide it.
const THIN: f64 = 0.008;
/// Average width of a letter, as a fraction of the text size.
const LETTER: f64 = 0.5;

enum Sample {
    Line(ShapeStyle, bool),
    Band,
}

struct Entry {
    sample: Sample,
    name: String,
    /// Position in the legend.
    place: (i32, i32),
}

pub(super) struct Legend {
    entries: Vec<Entry>,
    height: i32,
}

impl Legend {
    /// Arranges the entries of a panel that shows the values from `low` to `high`, each name once, in rows of this
    /// width.
    pub(super) fn new(panel: &Panel, looks: &[(ShapeStyle, bool)], (low, high): (f64, f64), width: i32) -> Self {
        let curves = panel.curves.iter().zip(looks);
        let curves = curves.map(|(curve, (style, is_dashed))| (Sample::Line(*style, *is_dashed), curve.name.clone()));
        let band = panel.band.iter().map(|band| {
            let part = (band.range.1 - band.range.0) / (high - low);
            let name = match band.holds_all(low, high) {
                true => format!("{}: more than is shown", band.name),
                false if part < THIN => format!("{}: thinner than a line", band.name),
                false => band.name.clone(),
            };
            (Sample::Band, name)
        });
        let band = band.chain(panel.x_ranges.iter().map(|range| (Sample::Band, range.name.clone())));
        let marks = panel.marks.iter();
        let marks = marks.map(|mark| (Sample::Line(DARK_RED.stroke_width(1), true), mark.name.clone()));
        let mut entries: Vec<Entry> = Vec::new();
        let mut place = (0, 0);
        for (sample, name) in curves.chain(band).chain(marks) {
            if name.is_empty() || entries.iter().any(|entry| entry.name == name) {
                continue;
            }
            let letters = name.chars().count() as f64;
            let long = SAMPLE + GAP + (LETTER * f64::from(TEXT_SIZE) * letters).ceil() as i32;
            if place.0 > 0 && place.0 + long > width {
                place = (0, place.1 + ROW);
            }
            entries.push(Entry { sample, name, place });
            place.0 += long + BETWEEN;
        }
        let height = place.1 + if entries.is_empty() { 0 } else { ROW };
        Self { entries, height }
    }

    /// Height in pixels.
    pub(super) fn height(&self) -> i32 {
        self.height
    }

    /// Draws the legend with its first row at `origin`.
    pub(super) fn draw(&self, area: &Area<'_>, origin: (i32, i32)) -> Drawn {
        for entry in &self.entries {
            let (x, y) = (origin.0 + entry.place.0, origin.1 + entry.place.1);
            let middle = y + TEXT_SIZE / 2;
            match entry.sample {
                Sample::Line(style, false) => {
                    area.draw(&PathElement::new([(x, middle), (x + SAMPLE, middle)], style))?;
                }
                Sample::Line(style, true) => {
                    for begin in (x..x + SAMPLE).step_by((DASH.0 + DASH.1) as usize) {
                        let end = (begin + DASH.0).min(x + SAMPLE);
                        area.draw(&PathElement::new([(begin, middle), (end, middle)], style))?;
                    }
                }
                Sample::Band => area.draw(&Rectangle::new([(x, y), (x + SAMPLE, y + TEXT_SIZE)], BAND.filled()))?,
            }
            let text = (x + SAMPLE + GAP, y);
            area.draw(&Text::new(
                entry.name.clone(),
                text,
                ("sans-serif", TEXT_SIZE).into_font(),
            ))?;
        }
        Ok(())
    }
}
