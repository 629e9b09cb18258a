//! Writes one self-contained HTML page: what was compared, which signals differ, and the waves around each difference.

use std::fmt::Write as _;
use std::path::Path;

use super::human::value_and_digits;
use super::picture::{self, Request};
use super::svg::{self, Lane};
use super::{Comparison, DiffVerdict, Difference};
use crate::WaveError;
use crate::wording::counted;

/// Largest number of differences whose waves are drawn, the earliest first.
const DRAWN: usize = 40;

const STYLE: &str = "body{font:15px/1.5 system-ui,sans-serif;margin:2em auto;max-width:1220px;padding:0 1em;color:#1b1b1b;\
    background:#fff}h1{font-size:1.5em}h2{font-size:1.05em;margin:2em 0 .4em;font-family:ui-monospace,monospace}\
    .different{color:#b00020}.equal{color:#1b6e2c}table{border-collapse:collapse;width:100%}th,td{text-align:left;padding:.25em \
    .7em;border-bottom:1px solid #ddd;vertical-align:top}td{font-family:ui-monospace,monospace;font-size:.9em;\
    overflow-wrap:anywhere}figure{margin:0;overflow-x:auto}figure svg{max-width:none}ul{padding-left:1.2em}";

/// Returns the page. The files are read again, so they must not have changed since the comparison.
///
/// # Errors
/// The errors of reading them.
pub fn html(a: &Path, b: &Path, comparison: &Comparison) -> Result<String, WaveError> {
    let drawn: Vec<(&Difference, Vec<(String, String)>)> = comparison
        .differences
        .iter()
        .filter_map(|difference| {
            let names = comparison
                .compared
                .iter()
                .find(|(name, _)| *name == difference.signal)?;
            let clock = comparison.clock.iter().filter(|clock| *clock != names);
            Some((difference, clock.chain([names]).cloned().collect()))
        })
        .take(DRAWN)
        .collect();
    let windows: Vec<_> = drawn
        .iter()
        .map(|(difference, _)| picture::window(comparison, difference.time))
        .collect();
    let requests = |of: fn(&(String, String)) -> &String| -> Vec<Request> {
        let each = drawn.iter().zip(&windows).map(|((_, lanes), window)| Request {
            signals: lanes.iter().map(|lane| of(lane).clone()).collect(),
            window: *window,
        });
        each.collect()
    };
    let of_a = picture::traces(comparison, 0, a, &requests(|names| &names.0))?;
    let of_b = picture::traces(comparison, 1, b, &requests(|names| &names.1))?;

    let (class, verdict) = match comparison.result {
        DiffVerdict::Equal => ("equal", "equal"),
        DiffVerdict::Different => ("different", "different"),
        DiffVerdict::Incomparable => ("different", "incomparable"),
    };
    let title = format!("{} | {}", a.display(), b.display());
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width\">\n<title>{verdict}: {title}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<h1><span \
         class=\"{class}\">{verdict}</span>: {title}</h1>\n<p>{}, compared at {}.</p>\n",
        svg::escaped(&comparison.differing()),
        counted(comparison.samples, "sample"),
        title = svg::escaped(&title),
    );
    let notes: Vec<String> = comparison
        .notes
        .iter()
        .map(|note| format!("<li>{}</li>", svg::escaped(note)))
        .collect();
    if !notes.is_empty() {
        let _ = writeln!(page, "<ul>{}</ul>", notes.concat());
    }
    table(&mut page, comparison);
    for (((difference, names), window), (a, b)) in drawn.iter().zip(&windows).zip(of_a.into_iter().zip(of_b)) {
        let lanes = names.iter().zip(a.into_iter().zip(b)).map(|(names, (a, b))| Lane {
            signal: names.0.clone(),
            differs: names.0 == difference.signal,
            a,
            b,
        });
        let lanes: Vec<Lane> = lanes.collect();
        let _ = writeln!(
            page,
            "<h2 id=\"{0}\">{0}</h2>\n<figure>{1}</figure>",
            svg::escaped(&difference.signal),
            svg::draw(&lanes, *window)
        );
    }
    if comparison.differences.len() > drawn.len() {
        let _ = writeln!(
            page,
            "<p>The waves of the first {} are drawn; those of signals that only one file has, and of {} more, are not.</p>",
            drawn.len(),
            comparison.differences.len() - drawn.len()
        );
    }
    Ok(page + "</body>\n</html>\n")
}

fn table(page: &mut String, comparison: &Comparison) {
    if comparison.differences.is_empty() {
        return;
    }
    page.push_str(
        "<table>\n<tr><th>signal</th><th>first at</th><th>first file</th><th>second file</th><th>samples</th></tr>\n",
    );
    for d in &comparison.differences {
        let _ = writeln!(
            page,
            "<tr><td><a href=\"#{0}\">{0}</a></td><td>{1}</td><td>{2}</td><td>{3}</td><td>{4}{5}</td></tr>",
            svg::escaped(&d.signal),
            comparison.time(d.time),
            svg::escaped(&value_and_digits(&d.a, d.view)),
            svg::escaped(&value_and_digits(&d.b, d.view)),
            d.count,
            if d.persistent { ", to the end" } else { "" }
        );
    }
    page.push_str("</table>\n");
}
