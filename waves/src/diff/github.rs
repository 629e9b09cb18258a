//! Writes the result for GitHub Actions: annotations of the run, and the summary of its step.

use std::fmt::Write as _;

use super::human::value_and_digits;
use super::{Comparison, DiffVerdict, Difference};
use crate::wording::counted;

/// Largest number of annotations that GitHub shows for one step.
const ANNOTATIONS: usize = 10;
/// Largest number of rows of the summary's table.
const ROWS: usize = 100;

/// Returns workflow commands, one per line: an error per signal that differs, the earliest first, and a warning for a
/// file that was cut off. `files` names the two files.
pub fn annotations(comparison: &Comparison, files: &str) -> String {
    let mut text = String::new();
    let mut command = |kind: &str, title: &str, message: &str| {
        let _ = writeln!(text, "::{kind} title={}::{}", property(title), data(message));
    };
    match comparison.result {
        DiffVerdict::Incomparable => command("error", &format!("{files}: incomparable"), &comparison.notes.join("; ")),
        DiffVerdict::Equal => {}
        DiffVerdict::Different => {
            let differences = &comparison.differences;
            let last = if differences.len() > ANNOTATIONS {
                ANNOTATIONS - 1
            } else {
                ANNOTATIONS
            };
            for difference in differences.iter().take(last) {
                command(
                    "error",
                    &format!("{} differs", difference.signal),
                    &one_line(comparison, difference),
                );
            }
            if differences.len() > last {
                let more = counted((differences.len() - last) as u64, "signal");
                command("error", &format!("{more} more differ"), files);
            }
        }
    }
    for cut in &comparison.cut {
        let message = format!("compared only up to {}", cut.place);
        command(
            "warning",
            &format!("{files}: the {} file is cut off", cut.file),
            &message,
        );
    }
    text
}

/// Returns the step's summary in Markdown.
pub fn step_summary(comparison: &Comparison, files: &str) -> String {
    let verdict = match comparison.result {
        DiffVerdict::Equal => "✅ equal",
        DiffVerdict::Different => "❌ different",
        DiffVerdict::Incomparable => "⚠️ incomparable",
    };
    let mut text = format!("### {verdict}: {}\n\n", cell(files));
    let _ = match comparison.result {
        DiffVerdict::Different => writeln!(
            text,
            "{}, compared at {}.\n\n| signal | first at | first file | second file | samples |\n|---|---|---|---|---|",
            comparison.differing(),
            counted(comparison.samples, "sample")
        ),
        _ => writeln!(
            text,
            "{} at {}.",
            counted(comparison.signals, "signal"),
            counted(comparison.samples, "sample")
        ),
    };
    for d in comparison.differences.iter().take(ROWS) {
        let _ = writeln!(
            text,
            "| `{}` | {} | `{}` | `{}` | {}{} |",
            cell(&d.signal),
            comparison.time(d.time),
            cell(&value_and_digits(&d.a, d.view)),
            cell(&value_and_digits(&d.b, d.view)),
            d.count,
            if d.persistent { ", to the end" } else { "" }
        );
    }
    if comparison.differences.len() > ROWS {
        let _ = writeln!(text, "\n… and {} more.", comparison.differences.len() - ROWS);
    }
    for note in &comparison.notes {
        let _ = write!(text, "\n- {}", cell(note));
    }
    text + "\n"
}

fn one_line(comparison: &Comparison, d: &Difference) -> String {
    format!(
        "first at {}: {} | {}, {}",
        comparison.time(d.time),
        value_and_digits(&d.a, d.view),
        value_and_digits(&d.b, d.view),
        counted(d.count, "sample")
    )
}

/// Escapes the text of a workflow command.
fn data(text: &str) -> String {
    text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A")
}

/// Escapes the value of a property of a workflow command.
fn property(text: &str) -> String {
    data(text).replace(':', "%3A").replace(',', "%2C")
}

/// Escapes a text for a cell of a table, within backticks or not.
fn cell(text: &str) -> String {
    let text: String = text
        .chars()
        .map(|c| if c.is_control() || c == '`' { ' ' } else { c })
        .collect();
    text.replace('|', "\\|").replace('<', "&lt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn workflow_commands_are_escaped() {
        assert_eq!(property("a:b,c%\n"), "a%3Ab%2Cc%25%0A");
        assert_eq!(data("a:b,c%\n"), "a:b,c%25%0A");
        assert_eq!(cell("a|b`<c>"), "a\\|b &lt;c>");
    }
}
