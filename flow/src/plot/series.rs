//! Which elements of a picture belong to which entry of its legend.
//!
//! Plotters does not name elements. A text that occurs in no picture is drawn before and after an entry's elements;
//! [`grouped`] replaces both by the beginning and the end of a group, which the page's script finds by `data-series`.

use super::{Area, Drawn, LegendEntry};
use plotters::prelude::*;

/// First letter of the texts, from Unicode's private use area.
const SIGN: char = '\u{E000}';

/// The use of a picture.
#[derive(Clone, Copy)]
pub(super) enum For<'a> {
    /// A file of its own, with every point of a curve.
    File,
    /// A page, which has many pictures: curves are thinned to their visible points, and elements belong to these
    /// entries.
    Page(&'a [LegendEntry]),
}

impl For<'_> {
    /// Draws the elements of the entry with this name.
    pub(super) fn series(self, area: &Area<'_>, name: &str, draw: impl FnOnce() -> Drawn) -> Drawn {
        let entry = match self {
            Self::File => None,
            Self::Page(entries) => entries.iter().position(|entry| entry.name == name),
        };
        match entry {
            Some(index) => group(area, &index.to_string(), draw),
            None => draw(),
        }
    }

    /// Draws words inside the chart.
    pub(super) fn notes(self, area: &Area<'_>, draw: impl FnOnce() -> Drawn) -> Drawn {
        match self {
            Self::File => draw(),
            Self::Page(_) => group(area, "notes", draw),
        }
    }
}

fn group(area: &Area<'_>, name: &str, draw: impl FnOnce() -> Drawn) -> Drawn {
    sign(area, name)?;
    draw()?;
    sign(area, "")
}

fn sign(area: &Area<'_>, name: &str) -> Drawn {
    let text = format!("{SIGN}{name}");
    area.draw(&Text::new(text, (0, 0), ("sans-serif", 1).into_font()))?;
    Ok(())
}

/// The document with its groups. Plotters writes each tag and each text on a line of its own.
pub(super) fn grouped(svg: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    let mut rest = svg.lines();
    while let Some(line) = rest.next() {
        let Some(name) = line.strip_prefix(SIGN) else {
            lines.push(line.to_owned());
            continue;
        };
        // These are the tags of the text, before and after it.
        lines.pop();
        rest.next();
        lines.push(match name {
            "" => "</g>".to_owned(),
            name => format!("<g data-series=\"{name}\">"),
        });
    }
    lines.join("\n")
}
