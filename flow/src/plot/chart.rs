//! The chart of a panel: its curves in a frame with axes.

use super::names::{self, Name};
use super::series::For;
use super::{
    Area, BAND, BAND_END, COLOURS, Curve, DARK, DARK_RED, DASH, Drawn, GREY, GRID, Look, PALE, Panel, UNDER_WIDTH,
    Writing,
};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Radius of a dot, in pixels.
pub(super) const DOT: i32 = 4;
/// Largest number of labels along an axis of a picture on a page, whose texts are large.
pub(super) const NUMBERS: usize = 6;
/// Number of columns to which a curve's points are thinned: more than a chart has pixels.
const COLUMNS: usize = 1000;

/// The range that a chart shows: the ends of its axes.
pub(super) struct Frame {
    /// Left and right end.
    pub(super) x: (f64, f64),
    /// Lower and upper end.
    pub(super) y: (f64, f64),
}

impl Frame {
    /// Returns the frame that contains all curves of a panel, or the part of them that the panel requests.
    pub(super) fn of(panel: &Panel) -> Self {
        let points = || panel.curves.iter().flat_map(|c| c.points.iter());
        let x = span(points().map(|p| p.0).chain(panel.marks.iter().map(|mark| mark.at)));
        let y = panel.y_range.unwrap_or_else(|| {
            let (low, high) = span(points().map(|p| p.1));
            let margin = 0.05 * (high - low);
            (low - margin, high + margin)
        });
        Self { x, y }
    }
}

/// Position of a chart inside its picture, in pixels: left, right, top and bottom.
pub(super) type Edges = [i32; 4];

/// Draws the chart of a panel, with texts of this size in pixels, and returns where its frame lies.
pub(super) fn draw_chart(
    area: &Area<'_>,
    panel: &Panel,
    frame: &Frame,
    text_size: i32,
    drawn_for: For<'_>,
) -> Result<Edges, Box<dyn std::error::Error>> {
    let Frame {
        x: (x_low, x_high),
        y: (y_low, y_high),
    } = *frame;
    let looks = looks(&panel.curves);
    let mut chart = ChartBuilder::on(area)
        .margin(8)
        .margin_right(32)
        .x_label_area_size(34 + 10 * text_size / 13)
        .y_label_area_size(58 + 18 * text_size / 13)
        .build_cartesian_2d(x_low..x_high, y_low..y_high)?;
    if let Some(band) = &panel.band {
        drawn_for.series(area, &band.name, || draw_band(&mut chart, band.range, frame))?;
    }
    for range in &panel.x_ranges {
        // A very narrow range must stay visible.
        let thin = 0.001 * (x_high - x_low);
        let (low, high) = (range.ends.0 - thin, range.ends.1 + thin);
        let corners = [(low.max(x_low), y_low), (high.min(x_high), y_high)];
        drawn_for.series(area, &range.name, || {
            chart.draw_series(std::iter::once(Rectangle::new(corners, BAND.filled())))?;
            Ok(())
        })?;
    }
    let y_label = |value: &f64| {
        if panel.y_is_whole && (value - value.round()).abs() > 1e-9 {
            String::new()
        } else {
            axis_label(*value)
        }
    };
    let x_label = |value: &f64| axis_label(*value);
    let mut mesh = chart.configure_mesh();
    mesh.x_desc(&panel.x_label)
        .y_desc(&panel.y_label)
        .axis_desc_style(("sans-serif", text_size))
        .label_style(("sans-serif", text_size))
        .x_label_formatter(&x_label)
        .y_label_formatter(&y_label)
        .bold_line_style(GRID)
        .max_light_lines(0);
    if matches!(drawn_for, For::Page(_)) {
        mesh.x_labels(NUMBERS).y_labels(NUMBERS);
    }
    mesh.draw()?;
    // The first coloured curve lies on top of the others, and levels lie on top of all.
    let mut order: Vec<_> = panel.curves.iter().zip(looks).rev().collect();
    order.sort_by_key(|(curve, _)| curve.look);
    for (curve, (style, is_dashed)) in order {
        drawn_for.series(area, &curve.name, || {
            if curve.look == Look::Dots {
                let dots = curve.points.iter();
                chart.draw_series(dots.map(|point| Circle::new(*point, DOT, style.filled())))?;
                return Ok(());
            }
            for part in cut(&curve.points, y_low, y_high) {
                let part = match drawn_for {
                    For::File => part,
                    For::Page(_) => thinned(&part, (x_low, x_high)),
                };
                draw_line(&mut chart, part, style, is_dashed)?;
            }
            Ok(())
        })?;
    }
    for mark in &panel.marks {
        let line = vec![(mark.at, y_low), (mark.at, y_high)];
        drawn_for.series(area, &mark.name, || {
            draw_line(&mut chart, line, DARK_RED.stroke_width(1), true)
        })?;
    }
    let (x, y) = chart.plotting_area().get_pixel_range();
    let edges = [x.start, x.end, y.start, y.end];
    let dots = panel.curves.iter().filter(|curve| curve.look == Look::Dots);
    let dots: Vec<_> = dots
        .flat_map(|curve| &curve.points)
        .map(|point| chart.backend_coord(point))
        .collect();
    let written = panel.notes.iter().filter(|note| note.writing != Writing::Never);
    let written: Vec<_> = written
        .map(|note| Name {
            text: &note.text,
            at: chart.backend_coord(&note.at),
            is_needed: note.writing == Writing::Always,
        })
        .collect();
    drawn_for.notes(area, || {
        for (text, place) in names::placed(&written, &dots, text_size, edges) {
            area.draw(&Text::new(
                text.to_owned(),
                place,
                ("sans-serif", text_size).into_font(),
            ))?;
        }
        Ok(())
    })?;
    Ok(edges)
}

/// Draws a band within the frame, with lines at its ends, which keep a thin band visible.
fn draw_band(chart: &mut Chart<'_, '_>, range: (f64, f64), frame: &Frame) -> Drawn {
    let ((x_low, x_high), (y_low, y_high)) = (frame.x, frame.y);
    let (low, high) = (range.0.max(y_low), range.1.min(y_high));
    if low < high {
        let corners = [(x_low, low), (x_high, high)];
        chart.draw_series(std::iter::once(Rectangle::new(corners, BAND.filled())))?;
    }
    for end in [range.0, range.1] {
        if (y_low..=y_high).contains(&end) {
            draw_line(
                chart,
                vec![(x_low, end), (x_high, end)],
                BAND_END.stroke_width(1),
                false,
            )?;
        }
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
pub(super) fn looks(curves: &[Curve]) -> Vec<(ShapeStyle, bool)> {
    let mut next = 0;
    let mut colour = COLOURS[0];
    let look = |curve: &Curve| match curve.look {
        Look::Own | Look::Dots => {
            colour = COLOURS[next % COLOURS.len()];
            next += 1;
            (colour.stroke_width(2), false)
        }
        Look::Under => {
            colour = COLOURS[next % COLOURS.len()];
            next += 1;
            (under(colour).stroke_width(UNDER_WIDTH), false)
        }
        Look::Dashed => (dashed(colour).stroke_width(2), true),
        Look::Reference => (GREY.stroke_width(1), false),
        Look::Limit => (DARK_RED.stroke_width(1), true),
    };
    curves.iter().map(look).collect()
}

/// The colour of a dashed curve beside one of this colour.
pub(super) fn dashed(colour: RGBColor) -> RGBColor {
    // Black has no darker shade.
    let end = if colour == BLACK { 255 } else { 0 };
    shade(colour, DARK, end)
}

/// The colour of a curve that another curve is expected to cover.
pub(super) fn under(colour: RGBColor) -> RGBColor {
    shade(colour, PALE, 255)
}

/// Returns a colour shifted by this fraction towards black (`end` 0) or white (255).
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

/// A number on an axis: without digits that are artefacts of binary fractions, and never "-0".
pub(super) fn axis_label(value: f64) -> String {
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

/// The points of a curve that a picture can show: of many points in one column, the first, the lowest, the highest and
/// the last.
fn thinned(points: &[(f64, f64)], (low, high): (f64, f64)) -> Vec<(f64, f64)> {
    if points.len() <= 4 * COLUMNS {
        return points.to_vec();
    }
    let column = |point: &(f64, f64)| ((point.0 - low) / (high - low) * COLUMNS as f64) as usize;
    let of_column = |chunk: &[(f64, f64)]| {
        let by_value = |(_, a): &(usize, &(f64, f64)), (_, b): &(usize, &(f64, f64))| a.1.total_cmp(&b.1);
        let lowest = chunk.iter().enumerate().min_by(by_value).map_or(0, |(index, _)| index);
        let highest = chunk.iter().enumerate().max_by(by_value).map_or(0, |(index, _)| index);
        let mut kept = [0, lowest, highest, chunk.len() - 1];
        kept.sort_unstable();
        let mut kept = kept.to_vec();
        kept.dedup();
        kept.into_iter().map(|index| chunk[index]).collect::<Vec<_>>()
    };
    points
        .chunk_by(|a, b| column(a) == column(b))
        .flat_map(of_column)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_curves_have_eight_colours_and_a_dashed_one_a_shade_that_shows_on_its_neighbour() {
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
    fn a_curve_that_lies_exactly_on_another_is_still_seen() {
        let line = || vec![(0.0, 0.0), (1.0, 1.0)];
        let looks = looks(&[Curve::new("shaped", line()), Curve::under("load", line())]);
        let [on_top, under] = [&looks[0].0, &looks[1].0];
        assert!(under.stroke_width >= on_top.stroke_width + 2);
        // The lower curve is drawn first.
        assert!(Look::Under < Look::Own && Look::Own < Look::Dashed);
    }

    #[test]
    fn a_curve_is_cut_where_it_leaves_the_range() {
        let points = [(0.0, -1.0), (1.0, 1.0), (2.0, 3.0), (3.0, 3.0), (4.0, 1.0)];
        let parts = cut(&points, 0.0, 2.0);
        assert_eq!(
            parts,
            [vec![(0.5, 0.0), (1.0, 1.0), (1.5, 2.0)], vec![(3.5, 2.0), (4.0, 1.0)]]
        );
        assert_eq!(cut(&points, -1.0, 3.0), [points.to_vec()]);
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
    #[test]
    fn a_thinned_curve_keeps_its_ends_and_every_peak() {
        let wave = |n: usize| (n as f64, if n == 77_777 { 9.0 } else { (n as f64).sin() });
        let points: Vec<_> = (0..100_000).map(wave).collect();
        let thin = thinned(&points, (0.0, 99_999.0));
        assert!(thin.len() <= 4 * COLUMNS + 4, "{}", thin.len());
        assert_eq!((thin.first(), thin.last()), (points.first(), points.last()));
        assert!(thin.contains(&(77_777.0, 9.0)) && thin.is_sorted_by(|a, b| a.0 < b.0));
        assert_eq!(thinned(&points[..4000], (0.0, 3999.0)), points[..4000]);
    }
}
