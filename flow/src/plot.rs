//! SVG plots of curves that the model computed: a stack of panels, each with a legend above its curves.

mod chart;
mod inline;
mod legend;
mod map;
mod names;
mod series;

use crate::failure::Failure;
use chart::{Frame, draw_chart, looks};
use legend::Legend;
use plotters::coord::Shift;
use plotters::prelude::*;
use posicast_shaper::unit::{ShownUnit, time_unit};
use series::For;
use std::path::Path;

pub(crate) use inline::{Inline, LegendEntry, inline, style_rules};
pub(crate) use map::{Level, Map, inline_map};

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), Box<dyn std::error::Error>>;

/// Style of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Look {
    /// Wide and pale, for a curve that another is expected to cover: it stays visible on both sides.
    Under,
    /// Grey, for a curve with which others are compared.
    Reference,
    /// A colour of its own, which no other curve of the panel has.
    Own,
    /// Dashed on top, in a shade of the colour of the curve before: another form of the same quantity, which may cover it exactly.
    Dashed,
    /// Dashed and dark red, for a level that must not be exceeded.
    Limit,
    /// Dots in a colour of their own, with no line between them.
    Dots,
}

/// A named curve.
pub struct Curve {
    name: String,
    /// Points `(x, y)` in order of x.
    points: Vec<(f64, f64)>,
    look: Look,
}

impl Curve {
    fn with_look(look: Look, name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        let name = name.into();
        Self { name, points, look }
    }

    /// Its name in the legend.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its points `(x, y)`, in order of x.
    pub fn points(&self) -> &[(f64, f64)] {
        &self.points
    }

    /// A curve in a colour of its own.
    pub fn new(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::with_look(Look::Own, name, points)
    }

    /// A curve that another is expected to cover.
    pub fn under(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::with_look(Look::Under, name, points)
    }

    /// Another form of the curve before it.
    pub fn beside(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::with_look(Look::Dashed, name, points)
    }

    /// Single points.
    pub fn dots(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::with_look(Look::Dots, name, points)
    }

    /// A reference curve.
    pub fn reference(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::with_look(Look::Reference, name, points)
    }

    /// A level that must not be exceeded.
    pub fn limit(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::with_look(Look::Limit, name, points)
    }
}

/// A range of values in which the curves should stay.
pub struct Corridor {
    /// Name in the legend.
    pub name: String,
    /// Its smallest and its largest value.
    pub range: (f64, f64),
}

impl Corridor {
    fn holds_all(&self, low: f64, high: f64) -> bool {
        self.range.0 <= low && high <= self.range.1
    }
}

/// A range of the horizontal axis.
pub struct Range {
    /// Name in the legend.
    pub name: String,
    /// Its two ends.
    pub ends: (f64, f64),
}

/// An event at a position on the horizontal axis.
pub struct Mark {
    /// Name of the event.
    pub name: String,
    /// Position.
    pub at: f64,
}

/// The name of a point of the chart.
pub struct Note {
    /// The name.
    pub text: String,
    /// The point, in the values of the axes.
    pub at: (f64, f64),
    /// When the name is written beside the point; the page's pointer always shows it.
    pub writing: Writing,
}

/// When a name is written into the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Writing {
    /// Also on top of something else.
    Always,
    /// If there is room for it.
    WhereFree,
    /// Never: only the pointer shows it.
    Never,
}

/// Returns the unit of the time axis for a plot of this duration: the largest in which it is at least 2.
pub fn time_axis(duration_s: f64) -> ShownUnit {
    time_unit(duration_s / 2.0)
}

/// Label of an axis, with its unit.
pub fn label(what: &str, unit: ShownUnit) -> String {
    format!("{what}, {}", unit.symbol())
}

/// One diagram.
#[derive(Default)]
pub struct Panel {
    /// Heading.
    pub title: String,
    /// Label of the horizontal axis, with its unit.
    pub x_label: String,
    /// Label of the vertical axis, with its unit.
    pub y_label: String,
    /// Curves of the panel.
    pub curves: Vec<Curve>,
    /// Shown range of the vertical axis; `None`: everything. Curves are cut at its ends.
    pub y_range: Option<(f64, f64)>,
    /// Whether the vertical axis counts something: its labels are then whole numbers.
    pub y_is_whole: bool,
    /// A band drawn under the curves.
    pub band: Option<Corridor>,
    /// Ranges drawn under the curves, from bottom to top.
    pub x_ranges: Vec<Range>,
    /// Marks drawn as vertical lines.
    pub marks: Vec<Mark>,
    /// Names of points of the chart, the most important first.
    pub notes: Vec<Note>,
}

const PANEL_SIZE: (u32, u32) = (900, 400);
/// Margin round a chart and its legend, in pixels.
const MARGIN: i32 = 16;
const TITLE_SIZE: i32 = 18;
const TEXT_SIZE: i32 = 13;
// Colours that colour-blind readers can distinguish (Okabe and Ito, without their yellow, which is faint on white), one for each mode that
// an axis may have.
const COLOURS: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
    RGBColor(120, 81, 169),
];
const GREY: RGBColor = RGBColor(140, 140, 140);
const DARK_RED: RGBColor = RGBColor(170, 0, 0);
const BAND: RGBColor = RGBColor(222, 240, 222);
/// Colour of the ends of a band, which keep a thin band visible.
const BAND_END: RGBColor = RGBColor(120, 180, 120);
const GRID: RGBColor = RGBColor(225, 225, 225);
/// Width in pixels of a curve under another, and how pale it is.
const UNDER_WIDTH: u32 = 6;
const PALE: f64 = 0.5;
/// How much darker a dashed curve is than the one before it.
const DARK: f64 = 0.7;
/// Lengths of a dash and of the gap after it, in pixels.
const DASH: (i32, i32) = (8, 7);

/// File name extensions of picture formats other than SVG.
const OTHER_FORMATS: [&str; 11] = [
    "png", "jpg", "jpeg", "gif", "webp", "bmp", "tif", "tiff", "pdf", "ps", "eps",
];

/// Refuses a file name for a plot with the extension of another picture format.
pub fn check_name(option: &str, path: &Path) -> Result<(), Failure> {
    let extension = path
        .extension()
        .map(|extension| extension.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some(other) if OTHER_FORMATS.contains(&other) => Err(Failure::input(format!(
            "{option} `{}`: pictures are written as SVG, not as {other}",
            path.display()
        ))
        .with_help(format!(
            "name it `{}`; `rsvg-convert` and any browser make other formats of it",
            path.with_extension("svg").display()
        ))),
        _ => Ok(()),
    }
}

/// Draws the panels below each other as one SVG document.
pub fn svg(panels: &[Panel]) -> Result<String, Failure> {
    let mut text = String::new();
    draw(panels, &mut text).map_err(|error| Failure::input(format!("cannot draw the plot: {error}")))?;
    Ok(text)
}

fn draw(panels: &[Panel], text: &mut String) -> Drawn {
    let count = panels.len().max(1);
    let root = SVGBackend::with_string(text, (PANEL_SIZE.0, PANEL_SIZE.1 * count as u32)).into_drawing_area();
    root.fill(&WHITE)?;
    for (area, panel) in root.split_evenly((count, 1)).iter().zip(panels) {
        draw_panel(area, panel)?;
    }
    root.present()?;
    Ok(())
}

fn draw_panel(area: &Area<'_>, panel: &Panel) -> Drawn {
    let frame = Frame::of(panel);
    let looks = looks(&panel.curves);
    let legend = Legend::new(panel, &looks, frame.y, area.dim_in_pixel().0 as i32 - 2 * MARGIN);
    area.draw(&Text::new(
        panel.title.clone(),
        (MARGIN, MARGIN),
        ("sans-serif", TITLE_SIZE).into_font(),
    ))?;
    let first_row = MARGIN + TITLE_SIZE + 10;
    legend.draw(area, (MARGIN, first_row))?;
    let (_, below) = area.split_vertically(first_row + legend.height());
    draw_chart(&below, panel, &frame, TEXT_SIZE, For::File)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panel_shows_its_title_every_curve_the_band_and_the_mark() {
        let panel = Panel {
            title: "Residual".into(),
            x_label: "f / f0".into(),
            y_label: "%".into(),
            curves: vec![
                Curve::new("shaped", vec![(0.0, 1.0), (1.0, 0.0)]),
                Curve::reference("flat", vec![(0.0, 0.5), (1.0, 0.5)]),
            ],
            band: Some(Corridor {
                name: "one count".into(),
                range: (0.2, 0.4),
            }),
            marks: vec![Mark {
                name: "trip".into(),
                at: 0.7,
            }],
            ..Panel::default()
        };
        let svg = svg(&[panel]).ok().unwrap();
        for text in ["Residual", "shaped", "flat", "f / f0", "one count", "trip"] {
            assert!(svg.contains(text), "{text}");
        }
    }

    #[test]
    fn a_band_that_is_wider_than_the_picture_fills_it_and_a_thin_one_has_ends() {
        let drawn = |range: (f64, f64)| {
            let panel = Panel {
                curves: vec![Curve::new("c", vec![(0.0, -1.0), (1.0, 1.0)])],
                band: Some(Corridor {
                    name: "±1 count".into(),
                    range,
                }),
                ..Panel::default()
            };
            svg(&[panel]).ok().unwrap()
        };
        let colour = |colour: RGBColor| format!("#{:02X}{:02X}{:02X}", colour.0, colour.1, colour.2);
        let wide = drawn((-5.0, 5.0));
        // One is the sample in the legend; the other covers the whole picture.
        assert_eq!(wide.matches(&colour(BAND)).count(), 2, "{wide}");
        assert!(wide.contains("±1 count: more than is shown"));
        let thin = drawn((-1e-6, 1e-6));
        assert_eq!(thin.matches(&colour(BAND_END)).count(), 2);
        assert!(thin.contains("±1 count: thinner than a line"));
    }

    #[test]
    fn a_long_picture_shows_seconds() {
        let labels = [0.001, 0.3, 30.0].map(|duration_s| label("time", time_axis(duration_s)));
        assert_eq!(labels, ["time, µs", "time, ms", "time, s"]);
        assert_eq!(time_axis(0.3).of(0.25), 250.0);
    }
}
