//! A panel as a picture inside a page: the page shows its title and its legend, and its style sheet chooses the colours.

use super::chart::{Edges, Frame, dashed, draw_chart, looks, under};
use super::series::{For, grouped};
use super::{BAND, BAND_END, COLOURS, DARK_RED, Drawn, GREY, GRID, Look, Panel};
use crate::failure::Failure;
use plotters::prelude::*;
use std::fmt::Write;

/// Size of a picture in pixels, and of its texts. A phone shows it at two thirds of that size, where the large texts stay readable. The
/// page's style sheet makes them smaller on wide screens.
pub(super) const SIZE: (u32, u32) = (520, 340);
pub(super) const TEXT_SIZE: i32 = 22;

/// A picture with its descriptions for the page.
pub(crate) struct Inline {
    /// Heading.
    pub(crate) title: String,
    /// The picture; its `stroke` and `fill` have the colours that [`style_rules`] knows.
    pub(crate) svg: String,
    /// Its legend.
    pub(crate) legend: Vec<LegendEntry>,
    /// Position of the frame and the values at its ends.
    pub(crate) window: Window,
    /// Points that have a name: position in pixels, and the name.
    pub(crate) points: Vec<(f64, f64, String)>,
}

/// What a drawing function returns.
pub(crate) type Picture = Result<Inline, Failure>;

/// An entry of a legend.
pub(crate) struct LegendEntry {
    /// Name of the curve, band or mark.
    pub(crate) name: String,
    /// Its colour in the picture, as `#RRGGBB`.
    pub(crate) colour: String,
    /// Form of its sample: `line`, `dash`, `dot` or `area`.
    pub(crate) form: &'static str,
}

/// The frame of a picture, which converts the place of a pointer into values.
pub(crate) struct Window {
    /// Left, right, top and bottom in pixels.
    pub(crate) edges: Edges,
    /// Values at the left and the right end.
    pub(crate) x: (f64, f64),
    /// Values at the bottom and the top.
    pub(crate) y: (f64, f64),
    /// Labels of the axes.
    pub(crate) labels: [String; 2],
}

/// The colours of a picture: name in the style sheet, on light ground, on dark ground.
const THEMES: [(&str, RGBColor, &str); 13] = [
    ("c0", COLOURS[0], "#5AB0E8"),
    ("c1", COLOURS[1], "#FF9142"),
    ("c2", COLOURS[2], "#34CC9C"),
    ("c3", COLOURS[3], "#E8A3CA"),
    ("c4", COLOURS[4], "#F3BC3E"),
    ("c5", COLOURS[5], "#9ADBFF"),
    ("c6", COLOURS[6], "#FFFFFF"),
    ("c7", COLOURS[7], "#BFA0EC"),
    ("reference", GREY, "#8F969E"),
    ("limit", DARK_RED, "#FF7070"),
    ("band", BAND, "#21402A"),
    ("band-end", BAND_END, "#5B9A64"),
    ("grid", GRID, "#30363C"),
];
/// Colours of the page itself.
const LIGHT: &str = "--paper:#FFFFFF;--ink:#1B1B1B;--soft:#5A6068;--line:#D9DCE0;--good:#1B6E2C;--bad:#B00020;--open:#8A5A00;--far:#000000";
const DARK: &str = "--paper:#14171A;--ink:#E6E6E6;--soft:#A4ABB3;--line:#363C43;--good:#5CC873;--bad:#FF6B7A;--open:#E5AE4A;--far:#FFFFFF";

/// The rules of a style sheet that give pictures the colours of the reader's theme; printed pages have the light ones.
pub(crate) fn style_rules() -> String {
    let mut light = format!("color-scheme:light;{LIGHT}");
    let mut dark = format!("color-scheme:dark;{DARK}");
    let mut rules = String::new();
    let mut rule = |colour: RGBColor, value: &str| {
        for property in ["stroke", "fill"] {
            let _ = write!(rules, "svg [{property}=\"{}\"]{{{property}:{value}}}", hex(colour));
        }
    };
    for (name, colour, on_dark) in THEMES {
        let _ = write!(light, ";--{name}:{}", hex(colour));
        let _ = write!(dark, ";--{name}:{on_dark}");
        rule(colour, &format!("var(--{name})"));
        if !COLOURS.contains(&colour) {
            continue;
        }
        // A curve beside another is farther from the paper's colour than that, and one under another is nearer.
        let far = if colour == BLACK { "paper" } else { "far" };
        rule(
            dashed(colour),
            &format!("color-mix(in srgb,var(--{name}) 35%,var(--{far}))"),
        );
        rule(
            under(colour),
            &format!("color-mix(in srgb,var(--{name}) 50%,var(--paper))"),
        );
    }
    format!(":root{{{light}}}@media screen and (prefers-color-scheme:dark){{:root{{{dark}}}}}{rules}")
}

/// A colour as SVG writes it.
pub(crate) fn hex(colour: RGBColor) -> String {
    format!("#{:02X}{:02X}{:02X}", colour.0, colour.1, colour.2)
}

/// Draws a panel for a page.
pub(crate) fn inline(panel: &Panel) -> Picture {
    let frame = Frame::of(panel);
    let legend = legend(panel);
    let mut svg = String::new();
    let mut edges = [0; 4];
    let drawn = (|| -> Drawn {
        let root = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        edges = draw_chart(&root, panel, &frame, TEXT_SIZE, For::Page(&legend))?;
        root.present()?;
        Ok(())
    })();
    drawn.map_err(|error| Failure::input(format!("cannot draw the plot: {error}")))?;
    let window = Window {
        edges,
        x: frame.x,
        y: frame.y,
        labels: [panel.x_label.clone(), panel.y_label.clone()],
    };
    let points = panel.notes.iter().map(|note| {
        let (x, y) = window.pixel(note.at);
        (x, y, note.text.clone())
    });
    Ok(Inline {
        title: panel.title.clone(),
        svg: grouped(&svg),
        legend,
        points: points.collect(),
        window,
    })
}

impl Window {
    /// Where a point of the chart is in the picture.
    fn pixel(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let [left, right, top, bottom] = self.edges.map(f64::from);
        let part = |value: f64, (low, high): (f64, f64)| (value - low) / (high - low);
        (
            left + part(x, self.x) * (right - left),
            bottom - part(y, self.y) * (bottom - top),
        )
    }
}

fn legend(panel: &Panel) -> Vec<LegendEntry> {
    let curves = panel.curves.iter().zip(looks(&panel.curves));
    let curves = curves.map(|(curve, (style, is_dashed))| {
        let (r, g, b) = style.color.rgb();
        let form = match (curve.look, is_dashed) {
            (Look::Dots, _) => "dot",
            (_, true) => "dash",
            (_, false) => "line",
        };
        (curve.name.clone(), RGBColor(r, g, b), form)
    });
    let ranges = panel.x_ranges.iter().map(|range| &range.name);
    let areas = panel.band.iter().map(|band| &band.name).chain(ranges);
    let areas = areas.map(|name| (name.clone(), BAND, "area"));
    let marks = panel.marks.iter().map(|mark| (mark.name.clone(), DARK_RED, "dash"));
    let mut entries: Vec<LegendEntry> = Vec::new();
    for (name, colour, form) in curves.chain(areas).chain(marks) {
        if !name.is_empty() && entries.iter().all(|entry| entry.name != name) {
            let colour = hex(colour);
            entries.push(LegendEntry { name, colour, form });
        }
    }
    entries
}
