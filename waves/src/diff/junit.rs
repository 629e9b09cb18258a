//! The result of a comparison as JUnit XML, which test servers read: one test case per signal.

use std::collections::HashMap;

use super::human::value_and_digits;
use super::{Comparison, DiffVerdict, Difference};
use crate::wording::counted;

/// Returns the document. `name` is the name of the suite, such as the two files' names.
pub fn junit(comparison: &Comparison, name: &str) -> String {
    let by_signal: HashMap<&str, &Difference> = comparison.differences.iter().map(|d| (d.signal.as_str(), d)).collect();
    let alone: Vec<&String> = comparison.only_in_a.iter().chain(&comparison.only_in_b).collect();
    let skipped: Vec<&String> = alone
        .iter()
        .copied()
        .filter(|signal| !by_signal.contains_key(signal.as_str()))
        .chain(&comparison.not_compared)
        .collect();
    let compared: Vec<&String> = comparison.compared.iter().map(|(name, _)| name).collect();
    let differing_alone: Vec<&String> = alone
        .into_iter()
        .filter(|signal| by_signal.contains_key(signal.as_str()))
        .collect();
    let incomparable = comparison.result == DiffVerdict::Incomparable;
    let tests = if incomparable {
        1
    } else {
        compared.len() + differing_alone.len() + skipped.len()
    };
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"{}\" tests=\"{tests}\" failures=\"{}\" errors=\"{}\" \
         skipped=\"{}\">\n",
        escaped(name),
        comparison.differences.len(),
        u8::from(incomparable),
        if incomparable { 0 } else { skipped.len() },
    );
    if incomparable {
        let notes = escaped(&comparison.notes.join("; "));
        text += &format!("  <testcase name=\"comparable\"><error message=\"{notes}\"/></testcase>\n");
    } else {
        for signal in compared.into_iter().chain(differing_alone) {
            text += &match by_signal.get(signal.as_str()) {
                None => format!("  <testcase name=\"{}\"/>\n", escaped(signal)),
                Some(d) => format!(
                    "  <testcase name=\"{}\"><failure message=\"{}\"/></testcase>\n",
                    escaped(signal),
                    escaped(&format!(
                        "first at {}: {} | {}, {}, {}",
                        comparison.time(d.time),
                        value_and_digits(&d.a, d.view),
                        value_and_digits(&d.b, d.view),
                        counted(d.count, "sample"),
                        if d.persistent { "to the end" } else { "transient" }
                    ))
                ),
            };
        }
        for signal in skipped {
            text += &format!("  <testcase name=\"{}\"><skipped/></testcase>\n", escaped(signal));
        }
    }
    text += &format!(
        "  <system-out>{}</system-out>\n</testsuite>\n",
        escaped(&comparison.to_string())
    );
    text
}

/// Escapes a text for XML; control characters, which XML 1.0 does not permit, become U+FFFD.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\n' => escaped.push('\n'),
            control if control.is_control() => escaped.push('\u{fffd}'),
            other => escaped.push(other),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_escaped() {
        assert_eq!(escaped("a<b>&\"\u{1}"), "a&lt;b&gt;&amp;&quot;\u{fffd}");
    }
}
