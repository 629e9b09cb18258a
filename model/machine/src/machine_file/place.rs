//! Finds the line of a key in a machine file, for problems that are found after the file was read.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Line of a key's value, from 1; for an absent key the line of its table. `key` is dotted, such as
/// `axis.drive.bandwidth_hz`; `axis` counts the tables `[[axis]]` from 0, and a table of another array has its index
/// from 0 in the key, as in `axis.mode[1].damping`. `None` where the text has no such table.
///
/// ```
/// use posicast_machine::machine_file::line_of;
///
/// let text = "[clock]\nsample_hz = 1\n[[axis]]\nname = \"x\"\n[axis.drive]\n";
/// assert_eq!(line_of(text, 0, "clock.sample_hz"), Some(2));
/// assert_eq!(line_of(text, 0, "axis.drive.bandwidth_hz"), Some(5));
/// assert_eq!(line_of(text, 1, "axis.name"), None);
/// ```
pub fn line_of(text: &str, axis: usize, key: &str) -> Option<usize> {
    let root = DeTable::parse(text).ok()?;
    let mut table = root.get_ref();
    let mut start = None;
    for part in key.split('.') {
        let (name, index) = part
            .strip_suffix(']')
            .and_then(|part| part.split_once('['))
            .unwrap_or((part, ""));
        let Some(value) = table.get(name) else {
            break;
        };
        let value = element(value, index.parse().unwrap_or(axis))?;
        start = Some(value.span().start);
        match value.get_ref().as_table() {
            Some(inner) => table = inner,
            None => break,
        }
    }
    let before = text.get(..start?)?;
    Some(1 + before.bytes().filter(|byte| *byte == b'\n').count())
}

/// Returns the value itself, or of an array of tables the table with this index.
fn element<'a, 't>(value: &'a Spanned<DeValue<'t>>, axis: usize) -> Option<&'a Spanned<DeValue<'t>>> {
    match value.get_ref().as_array() {
        Some(tables) => tables.get(axis),
        None => Some(value),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "name = \"n\"\n\n[clock]\nsample_hz = 5\n\n[[axis]]\nname = \"x\"\n[[axis]]\nname = \"y\"\n\
                        [axis.drive]\nmode = \"torque\"\n";

    #[test]
    fn a_key_stands_in_its_line_and_a_missing_one_in_that_of_its_table() {
        let line = |axis, key| line_of(TEXT, axis, key);
        assert_eq!(line(0, "clock.sample_hz"), Some(4));
        assert_eq!(line(0, "axis.name"), Some(7));
        assert_eq!(line(1, "axis.name"), Some(9));
        assert_eq!(line(1, "axis.drive.mode"), Some(11));
        assert_eq!(line(1, "axis.drive.bandwidth_hz"), Some(10));
        assert_eq!(line(0, "axis.drive.bandwidth_hz"), Some(6));
    }

    #[test]
    fn the_modes_of_an_axis_have_lines_of_their_own() {
        let text =
            "[[axis]]\n[[axis.mode]]\ndamping = 0\n[[axis.mode]]\ndamping = 1\n[[axis]]\n[[axis.mode]]\ndamping = 2\n";
        let line = |axis, key| line_of(text, axis, key);
        assert_eq!(line(0, "axis.mode[0].damping"), Some(3));
        assert_eq!(line(0, "axis.mode[1].damping"), Some(5));
        assert_eq!(line(1, "axis.mode[0].damping"), Some(8));
        assert_eq!(line(1, "axis.mode[1].damping"), None);
    }

    #[test]
    fn a_missing_key_or_table_has_no_line() {
        assert_eq!(line_of(TEXT, 2, "axis.name"), None);
        assert_eq!(line_of(TEXT, 0, "stage.extra_delay_s"), None);
        assert_eq!(line_of("no toml", 0, "name"), None);
        assert_eq!(line_of("", 0, ""), None);
    }
}
