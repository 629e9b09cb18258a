//! SVG plots of curves that the model computed: a stack of panels, each with a legend above its curves.

mod legend;

use crate::failure::Failure;
use legend::Legend;
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use posicast_model::unit::{ShownUnit, time_unit};
use std::path::Path;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
type Drawn = Result<(), Box<dyn std::error::Error>>;

/// Style of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Look {
    /// Wide and pale, for a curve on which another is expected to lie: it is seen on both sides of that.
    Under,
    /// Grey, for a curve with which others are compared.
    Reference,
    /// A colour of its own, which no other curve of the panel has.
    Own,
    /// Dashed on top, in a shade of the colour of the curve before: another form of the same quantity, which may
    /// lie exactly on it.
    Dashed,
    /// Dashed and dark red, for a level that must not be exceeded.
    Limit,
}

/// A named curve.
pub(crate) struct Curve {
    name: String,
    /// Points `(x, y)` in order of x.
    points: Vec<(f64, f64)>,
    look: Look,
}

impl Curve {
    fn of(look: Look, name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        let name = name.into();
        Self { name, points, look }
    }

    /// A curve in a colour of its own.
    pub(crate) fn new(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::of(Look::Own, name, points)
    }

    /// A curve on which another is expected to lie.
    pub(crate) fn under(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::of(Look::Under, name, points)
    }

    /// Another form of the curve before it.
    pub(crate) fn beside(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::of(Look::Dashed, name, points)
    }

    /// A reference curve.
    pub(crate) fn reference(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::of(Look::Reference, name, points)
    }

    /// A level that must not be exceeded.
    pub(crate) fn limit(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self::of(Look::Limit, name, points)
    }
}

/// A range of values in which the curves should stay.
pub(crate) struct Band {
    /// Name in the legend.
    pub(crate) name: String,
    /// Its smallest and its largest value.
    pub(crate) range: (f64, f64),
}

impl Band {
    fn holds_all(&self, low: f64, high: f64) -> bool {
        self.range.0 <= low && high <= self.range.1
    }
}

/// A range of the horizontal axis.
pub(crate) struct Range {
    /// Name in the legend.
    pub(crate) name: String,
    /// Its two ends.
    pub(crate) ends: (f64, f64),
}

/// An event at a position on the horizontal axis.
pub(crate) struct Mark {
    /// Name of the event.
    pub(crate) name: String,
    /// Position.
    pub(crate) at: f64,
}

/// The unit of the time axis for a plot of this duration: the one that gives at least two of it.
pub(crate) fn time_axis(duration_s: f64) -> ShownUnit {
    time_unit(duration_s / 2.0)
}

/// Label of an axis, with its unit.
pub(crate) fn label(what: &str, unit: ShownUnit) -> String {
    format!("{what}, {}", unit.symbol())
}

/// One diagram.
#[derive(Default)]
pub(crate) struct Panel {
    /// Heading.
    pub(crate) title: String,
    /// Label of the horizontal axis, with its unit.
    pub(crate) x_label: String,
    /// Label of the vertical axis, with its unit.
    pub(crate) y_label: String,
    /// Curves of the panel.
    pub(crate) curves: Vec<Curve>,
    /// Shown range of the vertical axis; `None`: everything. Curves are cut at its ends.
    pub(crate) y_range: Option<(f64, f64)>,
    /// Whether the vertical axis counts something: only whole numbers are then written beside it.
    pub(crate) y_is_whole: bool,
    /// A band drawn under the curves.
    pub(crate) band: Option<Band>,
    /// Ranges drawn under the curves, from bottom to top.
    pub(crate) x_ranges: Vec<Range>,
    /// Marks drawn as vertical lines.
    pub(crate) marks: Vec<Mark>,
}

const PANEL_SIZE: (u32, u32) = (900, 400);
/// Margin round a chart and its legend, in pixels.
const MARGIN: i32 = 16;
const TITLE_SIZE: i32 = 18;
const TEXT_SIZE: i32 = 13;
// Colours that stay apart for colour-blind readers (Okabe and Ito; their yellow, which is faint on white, is left out), one for
// each mode that an axis may have.
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
/// Colour of the ends of a band, which show it where it is thin.
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

/// Refuses a file name for a plot whose extension is that of another picture format.
pub(crate) fn check_name(option: &str, path: &Path) -> Result<(), Failure> {
    let extension = path
        .extension()
        .map(|extension| extension.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some(other) if OTHER_FORMATS.contains(&other) => Err(Failure::from(miette::miette!(
            help = format!(
                "name it `{}`; `rsvg-convert` and any browser make other formats of it",
                path.with_extension("svg").display()
            ),
            "{option} `{}`: pictures are written as SVG, not as {other}",
            path.display()
        ))),
        _ => Ok(()),
    }
}

/// Draws the panels below each other as one SVG document.
pub(crate) fn svg(panels: &[Panel]) -> Result<String, Failure> {
    let mut text = String::new();
    draw(panels, &mut text).map_err(|error| Failure::from(miette::miette!("cannot draw the plot: {error}")))?;
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
    let points = || panel.curves.iter().flat_map(|c| c.points.iter());
    let (x_low, x_high) = span(points().map(|p| p.0).chain(panel.marks.iter().map(|mark| mark.at)));
    let (y_low, y_high) = panel.y_range.unwrap_or_else(|| {
        let (low, high) = span(points().map(|p| p.1));
        let margin = 0.05 * (high - low);
        (low - margin, high + margin)
    });
    let looks = looks(&panel.curves);
    let legend = Legend::new(
        panel,
        &looks,
        (y_low, y_high),
        area.dim_in_pixel().0 as i32 - 2 * MARGIN,
    );
    area.draw(&Text::new(
        panel.title.clone(),
        (MARGIN, MARGIN),
        ("sans-serif", TITLE_SIZE).into_font(),
    ))?;
    let first_row = MARGIN + TITLE_SIZE + 10;
    legend.draw(area, (MARGIN, first_row))?;
    let (_, below) = area.split_vertically(first_row + legend.height());
    let mut chart = ChartBuilder::on(&below)
        .margin(8)
        .margin_right(32)
        .x_label_area_size(44)
        .y_label_area_size(76)
        .build_cartesian_2d(x_low..x_high, y_low..y_high)?;
    if let Some(band) = &panel.band {
        let (low, high) = (band.range.0.max(y_low), band.range.1.min(y_high));
        if low < high {
            chart.draw_series(std::iter::once(Rectangle::new(
                [(x_low, low), (x_high, high)],
                BAND.filled(),
            )))?;
        }
        let ends = [band.range.0, band.range.1];
        for end in ends.into_iter().filter(|end| (y_low..=y_high).contains(end)) {
            draw_line(
                &mut chart,
                vec![(x_low, end), (x_high, end)],
                BAND_END.stroke_width(1),
                false,
            )?;
        }
    }
    for range in &panel.x_ranges {
        // However narrow it is, it must be visible.
        let thin = 0.001 * (x_high - x_low);
        let (low, high) = (range.ends.0 - thin, range.ends.1 + thin);
        let corners = [(low.max(x_low), y_low), (high.min(x_high), y_high)];
        chart.draw_series(std::iter::once(Rectangle::new(corners, BAND.filled())))?;
    }
    chart
        .configure_mesh()
        .x_desc(&panel.x_label)
        .y_desc(&panel.y_label)
        .axis_desc_style(("sans-serif", TEXT_SIZE))
        .label_style(("sans-serif", TEXT_SIZE))
        .x_label_formatter(&|value| axis_label(*value))
        .y_label_formatter(
            &|value| match panel.y_is_whole && (value - value.round()).abs() > 1e-9 {
                true => String::new(),
                false => axis_label(*value),
            },
        )
        .bold_line_style(GRID)
        .max_light_lines(0)
        .draw()?;
    // The first of the coloured curves lies on top of the others, and levels lie on top of all.
    let mut order: Vec<_> = panel.curves.iter().zip(looks).rev().collect();
    order.sort_by_key(|(curve, _)| curve.look);
    for (curve, (style, is_dashed)) in order {
        for part in cut(&curve.points, y_low, y_high) {
            draw_line(&mut chart, part, style, is_dashed)?;
        }
    }
    for mark in &panel.marks {
        draw_line(
            &mut chart,
            vec![(mark.at, y_low), (mark.at, y_high)],
            DARK_RED.stroke_width(1),
            true,
        )?;
    }
    Ok(())
}

fn draw_line(chart: &mut Chart<'_, '_>, points: Vec<(f64, f64)>, style: ShapeStyle, is_dashed: bool) -> Drawn {
    if is_dashed {
        chart.draw_series(DashedLineSeries::new(points, DASH.0, DASH.1, style))?;
    } else {
        chart.draw_series(LineSeries::new(points, style))?;
    }
    Ok(())
}

/// Colour and width of each curve, and whether it is dashed.
fn looks(curves: &[Curve]) -> Vec<(ShapeStyle, bool)> {
    let mut next = 0;
    let mut colour = COLOURS[0];
    let look = |curve: &Curve| match curve.look {
        Look::Own => {
            colour = COLOURS[next % COLOURS.len()];
            next += 1;
            (colour.stroke_width(2), false)
        }
        Look::Under => {
            colour = COLOURS[next % COLOURS.len()];
            next += 1;
            (shade(colour, PALE, 255).stroke_width(UNDER_WIDTH), false)
        }
        Look::Dashed => {
            // Black has no darker shade.
            let end = if colour == RGBColor(0, 0, 0) { 255 } else { 0 };
            (shade(colour, DARK, end).stroke_width(2), true)
        }
        Look::Reference => (GREY.stroke_width(1), false),
        Look::Limit => (DARK_RED.stroke_width(1), true),
    };
    curves.iter().map(look).collect()
}

/// A colour, this part of the way to black (0) or white (255).
fn shade(colour: RGBColor, part: f64, end: u8) -> RGBColor {
    let mixed = |channel: u8| (f64::from(channel) * (1.0 - part) + f64::from(end) * part).round() as u8;
    RGBColor(mixed(colour.0), mixed(colour.1), mixed(colour.2))
}

/// The parts of a curve between `low` and `high`, each up to where it crosses one of them.
fn cut(points: &[(f64, f64)], low: f64, high: f64) -> Vec<Vec<(f64, f64)>> {
    let is_inside = |(_, y): &(f64, f64)| (low..=high).contains(y);
    let crossing = |inside: (f64, f64), outside: (f64, f64)| {
        let level = outside.1.clamp(low, high);
        let part = (level - inside.1) / (outside.1 - inside.1);
        (inside.0 + part * (outside.0 - inside.0), level)
    };
    let mut parts: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut before: Option<(f64, f64)> = None;
    for &point in points.iter().filter(|(_, y)| y.is_finite()) {
        match (before.filter(|before| !is_inside(before)), is_inside(&point)) {
            (Some(outside), true) => parts.push(vec![crossing(point, outside), point]),
            (None, true) if before.is_none() => parts.push(vec![point]),
            (None, inside) => {
                if let (Some(part), Some(before)) = (parts.last_mut(), before) {
                    part.push(if inside { point } else { crossing(before, point) });
                }
            }
            (Some(_), false) => {}
        }
        before = Some(point);
    }
    parts
}

/// A number on an axis: without the digits that only binary fractions have, and never "-0".
fn axis_label(value: f64) -> String {
    let rounded = (value * 1e6).round() / 1e6;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}

/// Smallest and largest finite value; the span is never empty.
fn span(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(v), high.max(v))
        });
    match (low <= high, low < high) {
        (false, _) => (0.0, 1.0),
        (true, false) => (low - 0.5, high + 0.5),
        (true, true) => (low, high),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_a_panel_shows_its_title_every_curve_the_band_and_the_mark() {
        let panel = Panel {
            title: "Residual".into(),
            x_label: "f / f0".into(),
            y_label: "%".into(),
            curves: vec![
                Curve::new("shaped", vec![(0.0, 1.0), (1.0, 0.0)]),
                Curve::reference("flat", vec![(0.0, 0.5), (1.0, 0.5)]),
            ],
            band: Some(Band {
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
    fn unit_eight_curves_have_eight_colours_and_a_dashed_one_a_shade_that_shows_on_its_neighbour() {
        let curve = |_| [Curve::new("", Vec::new()), Curve::beside("", Vec::new())];
        let curves: Vec<_> = (0..8).flat_map(curve).collect();
        let mut colours: Vec<_> = looks(&curves).iter().map(|(style, _)| style.color.rgb()).collect();
        let light = |(r, g, b): (u8, u8, u8)| 0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b);
        for pair in colours.chunks(2) {
            let (light_of, shade) = (light(pair[0]), light(pair[1]));
            assert!((light_of - shade).abs() > 50.0, "{pair:?}");
        }
        colours.sort_unstable();
        colours.dedup();
        assert_eq!(colours.len(), 16);
    }

    #[test]
    fn unit_a_curve_that_lies_exactly_on_another_is_still_seen() {
        let line = || vec![(0.0, 0.0), (1.0, 1.0)];
        let looks = looks(&[Curve::new("shaped", line()), Curve::under("load", line())]);
        let [on_top, under] = [&looks[0].0, &looks[1].0];
        assert!(under.stroke_width >= on_top.stroke_width + 2);
        // It is drawn before the other.
        assert!(Look::Under < Look::Own && Look::Own < Look::Dashed);
    }

    #[test]
    fn unit_a_band_that_is_wider_than_the_picture_fills_it_and_a_thin_one_has_ends() {
        let drawn = |range: (f64, f64)| {
            let panel = Panel {
                curves: vec![Curve::new("c", vec![(0.0, -1.0), (1.0, 1.0)])],
                band: Some(Band {
                    name: "±1 count".into(),
                    range,
                }),
                ..Panel::default()
            };
            svg(&[panel]).ok().unwrap()
        };
        let colour = |colour: RGBColor| format!("#{:02X}{:02X}{:02X}", colour.0, colour.1, colour.2);
        let wide = drawn((-5.0, 5.0));
        // The sample of the legend, and the whole picture.
        assert_eq!(wide.matches(&colour(BAND)).count(), 2, "{wide}");
        assert!(wide.contains("±1 count: more than is shown"));
        let thin = drawn((-1e-6, 1e-6));
        assert_eq!(thin.matches(&colour(BAND_END)).count(), 2);
        assert!(thin.contains("±1 count: thinner than a line"));
    }

    #[test]
    fn unit_a_curve_is_cut_where_it_leaves_the_range() {
        let points = [(0.0, -1.0), (1.0, 1.0), (2.0, 3.0), (3.0, 3.0), (4.0, 1.0)];
        let parts = cut(&points, 0.0, 2.0);
        assert_eq!(
            parts,
            [vec![(0.5, 0.0), (1.0, 1.0), (1.5, 2.0)], vec![(3.5, 2.0), (4.0, 1.0)]]
        );
        assert_eq!(cut(&points, -1.0, 3.0), [points.to_vec()]);
    }

    #[test]
    fn unit_a_long_picture_shows_seconds() {
        let labels = [0.001, 0.3, 30.0].map(|duration_s| label("time", time_axis(duration_s)));
        assert_eq!(labels, ["time, µs", "time, ms", "time, s"]);
        assert_eq!(time_axis(0.3).of(0.25), 250.0);
    }

    #[test]
    fn unit_an_axis_label_is_short_and_zero_has_no_sign() {
        let labels = [-0.0, 0.1 + 0.2, -1.5, 12000.0].map(axis_label);
        assert_eq!(labels, ["0", "0.3", "-1.5", "12000"]);
    }

    #[test]
    fn unit_empty_and_constant_curves_still_have_a_span() {
        assert_eq!(span([].into_iter()), (0.0, 1.0));
        assert_eq!(span([f64::NAN, 2.0].into_iter()), (1.5, 2.5));
    }
}
