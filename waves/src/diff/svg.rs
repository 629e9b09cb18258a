//! Draws the surroundings of a divergence: for each signal the two files' traces, red where they differ.

use std::fmt::Write as _;

use crate::wording::time;

/// A period of time in femtoseconds.
#[derive(Debug, Clone, Copy)]
pub(super) struct Window {
    pub(super) from: u128,
    pub(super) at: u128,
    pub(super) to: u128,
}

/// Values and their start times, the first at the window's beginning.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Trace {
    /// Whether it is a single bit, which is drawn as a line; anything else is drawn as boxes.
    pub(super) is_bit: bool,
    pub(super) values: Vec<(u128, String)>,
}

/// A signal in both files.
#[derive(Debug, Clone)]
pub(super) struct Lane {
    pub(super) signal: String,
    pub(super) differs: bool,
    pub(super) a: Trace,
    pub(super) b: Trace,
}

/// Width of the names in pixels.
const NAME_WIDTH: f64 = 250.0;
const WAVE_WIDTH: f64 = 900.0;
const ROW: f64 = 26.0;
const HIGH: f64 = 17.0;
const TOP: f64 = 40.0;
const SLOPE: f64 = 3.0;
const CHARACTER: f64 = 7.2;

const STYLE: &str = "<style>text{font:12px monospace;fill:#222}.wave{fill:none;stroke:#1f4e79;stroke-width:1.3}\
    .unknown{fill:#f6c9c9;stroke:#a33}.bad{fill:#ffe1dd}.mark{stroke:#c00;stroke-dasharray:4 3}.axis{fill:#666}</style>";

/// Returns the drawing as SVG.
pub(super) fn draw(lanes: &[Lane], window: Window) -> String {
    let height = TOP + lanes.len() as f64 * (2.0 * ROW + 8.0) + 30.0;
    let width = NAME_WIDTH + WAVE_WIDTH + 20.0;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n\
         {STYLE}\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
    );
    let mut y = TOP;
    for lane in lanes {
        if lane.differs {
            for (from, to) in differing(lane, window) {
                let (left, right) = (x(from, window), x(to, window));
                let _ = writeln!(
                    svg,
                    "<rect class=\"bad\" x=\"{left:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\"/>",
                    y - 3.0,
                    right - left,
                    2.0 * ROW
                );
            }
        }
        for (side, trace) in [("a", &lane.a), ("b", &lane.b)] {
            let name = if side == "a" { tail(&lane.signal) } else { String::new() };
            let baseline = y + HIGH - 4.0;
            let _ = writeln!(
                svg,
                "<text x=\"8\" y=\"{baseline:.1}\">{}</text><text x=\"{}\" y=\"{baseline:.1}\">{side}</text>",
                escaped(&name),
                NAME_WIDTH - 16.0
            );
            draw_trace(&mut svg, trace, y, window);
            y += ROW;
        }
        y += 8.0;
    }
    let mark = x(window.at, window);
    let _ = writeln!(
        svg,
        "<line class=\"mark\" x1=\"{mark:.1}\" y1=\"{:.1}\" x2=\"{mark:.1}\" y2=\"{y:.1}\"/>\
         <text x=\"{mark:.1}\" y=\"{:.1}\" text-anchor=\"middle\">first divergence, {}</text>",
        TOP - 12.0,
        TOP - 18.0,
        time(window.at)
    );
    for (fs, anchor) in [(window.from, "start"), (window.to, "end")] {
        let _ = writeln!(
            svg,
            "<text class=\"axis\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">{}</text>",
            x(fs, window),
            y + 14.0,
            time(fs)
        );
    }
    svg + "</svg>\n"
}

fn draw_trace(svg: &mut String, trace: &Trace, y: f64, window: Window) {
    let ends = trace.values.iter().skip(1).map(|(time, _)| *time).chain([window.to]);
    let mut path = String::new();
    let mut labels = String::new();
    for ((from, value), to) in trace.values.iter().zip(ends) {
        let (left, right) = (x(*from, window), x(to, window));
        let (high, low) = (y, y + HIGH);
        if let (true, "0" | "1") = (trace.is_bit, value.as_str()) {
            let level = if value == "1" { high } else { low };
            let _ = write!(
                path,
                "{}{left:.1} {level:.1}H{right:.1}",
                if path.is_empty() { "M" } else { "L" }
            );
            continue;
        }
        let unknown = value.contains(['x', 'z']) && value.bytes().all(|b| b"01xz".contains(&b));
        let middle = (high + low) / 2.0;
        let slope = SLOPE.min((right - left) / 2.0);
        let _ = writeln!(
            svg,
            "<path class=\"wave{}\" d=\"M{left:.1} {middle:.1}L{:.1} {high:.1}H{:.1}L{right:.1} {middle:.1}L{:.1} {low:.1}\
             H{:.1}Z\"/>",
            if unknown { " unknown" } else { "" },
            left + slope,
            right - slope,
            right - slope,
            left + slope
        );
        let room = ((right - left - 2.0 * SLOPE) / CHARACTER) as usize;
        let shown = if value.chars().count() <= room {
            value.clone()
        } else {
            String::new()
        };
        let _ = write!(
            labels,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            (left + right) / 2.0,
            y + HIGH - 4.0,
            escaped(&shown)
        );
    }
    if !path.is_empty() {
        let _ = writeln!(svg, "<path class=\"wave\" d=\"{path}\"/>");
    }
    if !labels.is_empty() {
        let _ = writeln!(svg, "{labels}");
    }
}

/// Returns the periods in which the two traces have different values.
fn differing(lane: &Lane, window: Window) -> Vec<(u128, u128)> {
    let mut times: Vec<u128> = lane
        .a
        .values
        .iter()
        .chain(&lane.b.values)
        .map(|(time, _)| *time)
        .collect();
    times.sort_unstable();
    times.dedup();
    let at = |trace: &Trace, time: u128| {
        let before = trace.values.iter().take_while(|(from, _)| *from <= time);
        before.last().map(|(_, value)| value.clone())
    };
    let ends = times.iter().skip(1).copied().chain([window.to]);
    let stretches = times.iter().copied().zip(ends);
    stretches
        .filter(|(from, _)| at(&lane.a, *from) != at(&lane.b, *from))
        .collect()
}

fn x(time: u128, window: Window) -> f64 {
    let part = time.saturating_sub(window.from) as f64 / (window.to - window.from).max(1) as f64;
    NAME_WIDTH + WAVE_WIDTH * part.min(1.0)
}

/// Returns the end of a long name, which identifies a signal better than its scopes.
fn tail(name: &str) -> String {
    let room = ((NAME_WIDTH - 30.0) / CHARACTER) as usize;
    let count = name.chars().count();
    if count <= room {
        return name.to_owned();
    }
    let end: String = name.chars().skip(count + 1 - room).collect();
    format!("…{end}")
}

pub(super) fn escaped(text: &str) -> String {
    let text: String = text
        .chars()
        .map(|c| if c.is_control() { '\u{fffd}' } else { c })
        .collect();
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
