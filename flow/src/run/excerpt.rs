//! The waves of one sample, read from `wave/rtl.vcd`: from its strobe to the end of its recorded part.

use crate::failure::Failure;
use maud::{Markup, html};
use std::collections::HashMap;
use std::fmt::Write as _;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use vcd::{Command, IdCode, Parser, ScopeItem};

/// Largest number of signals that are drawn.
const LANES: usize = 18;

/// A signal during the sample.
struct Lane {
    name: String,
    width: u32,
    /// Times and values, the first at the beginning.
    values: Vec<(u64, String)>,
}

/// The waves of a sample.
pub(super) struct Excerpt {
    /// Number of the sample, from 0.
    pub(super) sample: usize,
    lanes: Vec<Lane>,
    from: u64,
    to: u64,
    /// Seconds of a unit of time.
    unit_s: f64,
}

/// Reads the waves of a sample, whose strobe is the one with this number; `None` if the file ends before.
pub(super) fn read(path: &Path, sample: usize) -> Result<Option<Excerpt>, Failure> {
    let unreadable = |error: std::io::Error| Failure::input(format!("cannot read `{}`: {error}", path.display()));
    let mut parser = Parser::new(BufReader::new(File::open(path).map_err(unreadable)?));
    let header = parser.parse_header().map_err(unreadable)?;
    let mut names: Vec<(IdCode, String, u32)> = Vec::new();
    for item in &header.items {
        if let ScopeItem::Scope(scope) = item {
            names.extend(scope.items.iter().filter_map(|item| match item {
                ScopeItem::Var(of) => Some((of.code, of.reference.clone(), of.size)),
                _ => None,
            }));
        }
    }
    let code = |wanted: &str| names.iter().find(|(_, name, _)| name == wanted).map(|(code, ..)| *code);
    let (strobe, recording) = (code("strobe"), code("recording"));
    let unit_s = header
        .timescale
        .map_or(1e-9, |(number, unit)| f64::from(number) / unit.divisor() as f64);
    let mut now: HashMap<IdCode, String> = HashMap::new();
    let mut changes: Vec<(u64, IdCode, String)> = Vec::new();
    let (mut time, mut strobes, mut from, mut to) = (0, 0, None, None);
    for command in parser {
        let (id, text) = match command.map_err(unreadable)? {
            Command::Timestamp(at) => {
                time = at;
                continue;
            }
            Command::ChangeScalar(id, value) => (id, value.to_string()),
            Command::ChangeVector(id, value) => (id, value.to_string()),
            _ => continue,
        };
        if Some(id) == strobe && text == "1" {
            strobes += 1;
            if strobes == sample + 1 {
                from = Some(time);
            }
        }
        // The sample ends when the recording pauses, or else at the next strobe.
        let ends = Some(id) == recording && text == "0" || strobes == sample + 2;
        if ends && from.is_some() {
            to = Some(time);
            break;
        }
        match from {
            Some(_) => changes.push((time, id, text)),
            None => {
                now.insert(id, text);
            }
        }
    }
    let Some(from) = from else {
        return Ok(None);
    };
    let to = to.unwrap_or(time);
    // The clock becomes unknown when the recording pauses.
    changes.retain(|(at, ..)| *at < to);
    let lane = |(code, name, width): &(IdCode, String, u32)| {
        let mut values = vec![(from, now.get(code).cloned().unwrap_or_else(|| "x".to_owned()))];
        for (at, id, text) in &changes {
            if id == code {
                // Signals that change at the strobe have their new values from the beginning on.
                if *at == from {
                    values.clear();
                }
                values.push((*at, text.clone()));
            }
        }
        let values = values
            .into_iter()
            .map(|(at, text)| (at, shown(name, *width, &text)))
            .collect();
        Lane {
            name: name.clone(),
            width: *width,
            values,
        }
    };
    let mut lanes: Vec<Lane> = names.iter().map(lane).collect();
    // A word of the sample is shown even if it equals the word before.
    lanes.retain(|lane| lane.values.len() > 1 || lane.name.ends_with("_x"));
    lanes.truncate(LANES);
    Ok((to > from).then_some(Excerpt {
        sample,
        lanes,
        from,
        to,
        unit_s,
    }))
}

/// Formats a value for people: words of positions are signed.
fn shown(name: &str, width: u32, bits: &str) -> String {
    if width == 1 || bits.contains(['x', 'z']) {
        return bits.to_owned();
    }
    let Ok(value) = u64::from_str_radix(bits, 2) else {
        return bits.to_owned();
    };
    let is_negative = (name.ends_with("_x") || name.ends_with("_y")) && value >> (width - 1) == 1;
    if is_negative {
        (i128::from(value) - (1i128 << width)).to_string()
    } else {
        value.to_string()
    }
}

const NAMES: f64 = 150.0;
const WIDTH: f64 = 1000.0;
const ROW: f64 = 30.0;
const HIGH: f64 = 18.0;
const TOP: f64 = 8.0;
/// Width of a letter in pixels.
const LETTER: f64 = 8.5;

/// Draws the waves.
pub(super) fn figure(of: &Excerpt) -> Markup {
    let x = |time: u64| NAMES + (WIDTH - NAMES - 10.0) * (time - of.from) as f64 / (of.to - of.from).max(1) as f64;
    let height = TOP + ROW * of.lanes.len() as f64 + 24.0;
    html! {
        figure.waves {
            div.wide {
                svg viewBox=(format!("0 0 {WIDTH} {height}")) role="img" aria-label="waves of one sample" {
                    @for (row, lane) in of.lanes.iter().enumerate() {
                        @let top = TOP + ROW * row as f64;
                        text x="4" y=(format!("{:.1}", top + HIGH - 3.0)) { (lane.name) }
                        @let spans = spans(lane, of.to);
                        @if lane.width == 1 && spans.iter().all(|(_, _, value)| matches!(*value, "0" | "1")) {
                            path.wave d=(line(&spans, top, &x)) {}
                        } @else {
                            @for (from, to, value) in &spans {
                                @let (left, right) = (x(*from), x(*to));
                                path.wave d=(format!("M{:.1} {:.1}l3 {h:.1}H{:.1}l3 -{h:.1}l-3 -{h:.1}H{:.1}Z", left, top + HIGH / 2.0, right - 3.0, left + 3.0, h = HIGH / 2.0)) {}
                                @if LETTER * value.chars().count() as f64 <= right - left - 4.0 {
                                    text.value x=(format!("{:.1}", (left + right) / 2.0)) y=(format!("{:.1}", top + HIGH - 4.0)) { (value) }
                                }
                            }
                        }
                    }
                    @let bottom = TOP + ROW * of.lanes.len() as f64 + 14.0;
                    text.time x=(NAMES) y=(format!("{bottom:.1}")) { "0" }
                    text.time.end x=(WIDTH - 10.0) y=(format!("{bottom:.1}")) {
                        (posicast_shaper::unit::show_seconds((of.to - of.from) as f64 * of.unit_s, 3))
                    }
                }
            }
        }
    }
}

/// Begin, end and value of each stretch of a lane.
fn spans(lane: &Lane, to: u64) -> Vec<(u64, u64, &str)> {
    let ends = lane.values.iter().skip(1).map(|(at, _)| *at).chain([to]);
    lane.values
        .iter()
        .zip(ends)
        .map(|((at, value), end)| (*at, end, value.as_str()))
        .collect()
}

fn line(spans: &[(u64, u64, &str)], top: f64, x: &impl Fn(u64) -> f64) -> String {
    let mut path = String::new();
    for (from, to, value) in spans {
        let level = if *value == "1" { top } else { top + HIGH };
        let letter = if path.is_empty() { 'M' } else { 'L' };
        let _ = write!(path, "{letter}{:.1} {level:.1}H{:.1}", x(*from), x(*to));
    }
    path
}

/// The sample in which a command changes most.
pub(super) fn largest_step(words: &[i64]) -> usize {
    let steps = words.windows(2).map(|pair| pair[1].abs_diff(pair[0])).enumerate();
    steps
        .max_by_key(|(index, step)| (*step, std::cmp::Reverse(*index)))
        .map_or(0, |(index, _)| index + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    const VCD: &str = "$timescale 1 ns $end\n$scope module one $end\n$var wire 1 ! clk $end\n$var wire 1 \" strobe $end\n\
        $var wire 1 % recording $end\n$var wire 4 # x_x $end\n$var wire 4 $ x_y $end\n$upscope $end\n$enddefinitions $end\n\
        #0\n0!\n0\"\n1%\nb0000 #\nb0000 $\n#10\n1!\n1\"\nb0001 #\n#20\n0!\n0\"\nb0001 $\n#30\n1!\n0%\n\
        #100\n1%\n1\"\n1!\nb1110 #\n#110\n0!\n0\"\n#120\n1!\nb1111 $\n#130\n0!\n0%\n";

    #[test]
    fn the_waves_of_a_sample_begin_at_its_strobe() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rtl.vcd");
        std::fs::write(&path, VCD).unwrap();
        let excerpt = read(&path, 1).ok().unwrap().unwrap();
        assert_eq!((excerpt.from, excerpt.to, excerpt.unit_s), (100, 130, 1e-9));
        let of = |name: &str| {
            excerpt
                .lanes
                .iter()
                .find(|lane| lane.name == name)
                .map(|lane| lane.values.clone())
        };
        assert_eq!(of("x_x").unwrap(), [(100, "-2".to_owned())]);
        assert_eq!(of("x_y").unwrap(), [(100, "1".to_owned()), (120, "-1".to_owned())]);
        assert_eq!(of("recording"), None);
        assert!(read(&path, 2).ok().unwrap().is_none(), "there is no third strobe");
        let drawn = figure(&excerpt).into_string();
        assert!(drawn.contains(">x_y<") && drawn.contains("30.0 ns"), "{drawn}");
    }

    #[test]
    fn the_sample_with_the_largest_step_is_the_first_of_equals() {
        assert_eq!(largest_step(&[0, 0, 5, 9, 4, 4]), 2);
        assert_eq!(largest_step(&[]), 0);
    }
}
