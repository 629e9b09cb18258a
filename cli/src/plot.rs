//! SVG pictures of curves that the model computed: a stack of panels, each with named curves.

use crate::failure::Failure;
use plotters::prelude::*;

/// A named curve.
pub(crate) struct Curve {
    /// Name in the legend.
    pub(crate) name: String,
    /// Points `(x, y)` in order of x.
    pub(crate) points: Vec<(f64, f64)>,
    /// Drawn thin and grey: a reference beside the curves that matter.
    pub(crate) reference: bool,
}

impl Curve {
    /// A curve.
    pub(crate) fn new(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self {
            name: name.into(),
            points,
            reference: false,
        }
    }

    /// A curve to compare with.
    pub(crate) fn reference(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self {
            name: name.into(),
            points,
            reference: true,
        }
    }
}

/// One diagram.
pub(crate) struct Panel {
    /// Heading.
    pub(crate) title: String,
    /// What the horizontal axis shows, with its unit.
    pub(crate) x_label: String,
    /// What the vertical axis shows, with its unit.
    pub(crate) y_label: String,
    /// Curves.
    pub(crate) curves: Vec<Curve>,
}

const PANEL_SIZE: (u32, u32) = (900, 380);
// Colours that stay apart for colour-blind readers (Okabe and Ito).
const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
];

/// The panels below each other as one SVG document.
pub(crate) fn svg(panels: &[Panel]) -> Result<String, Failure> {
    let mut text = String::new();
    draw(panels, &mut text).map_err(|error| Failure::from(miette::miette!("cannot draw the plot: {error}")))?;
    Ok(text)
}

fn draw(panels: &[Panel], text: &mut String) -> Result<(), Box<dyn std::error::Error>> {
    let count = panels.len().max(1);
    let root = SVGBackend::with_string(text, (PANEL_SIZE.0, PANEL_SIZE.1 * count as u32)).into_drawing_area();
    root.fill(&WHITE)?;
    for (area, panel) in root.split_evenly((count, 1)).iter().zip(panels) {
        draw_panel(area, panel)?;
    }
    root.present()?;
    Ok(())
}

fn draw_panel(
    area: &DrawingArea<SVGBackend<'_>, plotters::coord::Shift>,
    panel: &Panel,
) -> Result<(), Box<dyn std::error::Error>> {
    let points = || panel.curves.iter().flat_map(|c| c.points.iter());
    let (x_low, x_high) = span(points().map(|p| p.0));
    let (y_low, y_high) = span(points().map(|p| p.1));
    let margin = 0.05 * (y_high - y_low);
    let mut chart = ChartBuilder::on(area)
        .caption(&panel.title, ("sans-serif", 20))
        .margin(12)
        .x_label_area_size(42)
        .y_label_area_size(64)
        .build_cartesian_2d(x_low..x_high, (y_low - margin)..(y_high + margin))?;
    chart
        .configure_mesh()
        .x_desc(&panel.x_label)
        .y_desc(&panel.y_label)
        .x_label_formatter(&|value| axis_label(*value))
        .y_label_formatter(&|value| axis_label(*value))
        .light_line_style(WHITE)
        .draw()?;
    for (index, curve) in panel.curves.iter().enumerate() {
        let style = curve_style(curve, index);
        chart
            .draw_series(LineSeries::new(curve.points.iter().copied(), style))?
            .label(&curve.name)
            .legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 22, y)], style));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.3))
        .draw()?;
    Ok(())
}

fn curve_style(curve: &Curve, index: usize) -> ShapeStyle {
    if curve.reference {
        RGBColor(150, 150, 150).stroke_width(1)
    } else {
        COLOURS[index % COLOURS.len()].stroke_width(2)
    }
}

/// A number on an axis: without the digits that only binary fractions have, and never "-0".
fn axis_label(value: f64) -> String {
    let rounded = (value * 1e6).round() / 1e6;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}

/// Least and largest finite value, never an empty span.
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
    fn a_panel_shows_its_title_and_every_curve() {
        let panel = Panel {
            title: "Residual".into(),
            x_label: "f / f0".into(),
            y_label: "%".into(),
            curves: vec![
                Curve::new("shaped", vec![(0.0, 1.0), (1.0, 0.0)]),
                Curve::reference("flat", vec![(0.0, 0.5), (1.0, 0.5)]),
            ],
        };
        let svg = svg(&[panel]).ok().unwrap();
        for text in ["Residual", "shaped", "flat", "f / f0"] {
            assert!(svg.contains(text), "{text}");
        }
    }

    #[test]
    fn an_axis_label_is_short_and_zero_has_no_sign() {
        let labels = [-0.0, 0.1 + 0.2, -1.5, 12000.0].map(axis_label);
        assert_eq!(labels, ["0", "0.3", "-1.5", "12000"]);
    }

    #[test]
    fn empty_and_constant_curves_still_have_a_span() {
        assert_eq!(span([].into_iter()), (0.0, 1.0));
        assert_eq!(span([f64::NAN, 2.0].into_iter()), (1.5, 2.5));
    }
}
