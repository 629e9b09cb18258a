//! Guesses at the mistake behind a wrong value: percent, kilohertz, milliseconds, a number in quotes.
//!
//! A hint is the remedy of a problem. It asks whether the guess is right, and shows the correct line if it is.

use toml::de::DeValue;

use super::range::NumberRange;
use posicast_shaper::unit::short;

/// A prefix of a unit: its symbol and its factor.
type Prefix = (&'static str, f64);

/// Prefixes of a clock frequency that is too low, the most likely first.
pub(super) const MEGA_OR_KILO: [Prefix; 2] = [("MHz", 1e6), ("kHz", 1e3)];
/// Prefixes of a sample rate or of a mode's frequency that is too low.
pub(super) const KILO: [Prefix; 1] = [("kHz", 1e3)];

/// Writes a number as in a machine file: a whole one with `_` between groups of three digits.
pub(super) fn written(value: f64) -> String {
    if value.fract() != 0.0 || value.abs() >= 1e15 {
        return short(value);
    }
    let digits = value.abs().to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push('_');
        }
        text.push(digit);
    }
    if value < 0.0 { format!("-{text}") } else { text }
}

/// Asks whether a frequency was meant in another unit: the first of `units` in which it passes `right`.
pub(super) fn in_other_unit(key: &str, found_hz: f64, units: &[Prefix], right: impl Fn(f64) -> bool) -> Option<String> {
    let (unit, factor) = units.iter().find(|(_, factor)| right(found_hz * factor))?;
    let (number, meant) = (short(found_hz), written(found_hz * factor));
    Some(format!(
        "{number} {unit}? Frequencies are in Hz: write `{key} = {meant}`"
    ))
}

/// Times the upper end of a shortened range, above which a time is taken for one in ms.
const FAR: f64 = 20.0;

/// The remedy for a number outside its range.
pub(super) fn of_number(key: &str, found: f64, range: NumberRange) -> String {
    let otherwise = format!("give `{key}` a value in this range");
    let ((low, _), (high, _)) = (range.low(), range.high());
    if (low, high) == (0.0, 1.0) && range.unit_name().is_empty() && (1.0..=100.0).contains(&found) {
        let (percent, part) = (short(found), short(found / 100.0));
        return format!("percent? {percent} % is {part}; else {otherwise}");
    }
    // A time that just exceeds a word is one in seconds.
    let far = if range.is_shortened() { FAR * high } else { high };
    if range.unit_name() == "s" && found > far && range.contains(found * 1e-3) {
        let number = short(found);
        let [ms, us, ns] = [1e-3, 1e-6, 1e-9].map(|unit| short(found * unit));
        return format!(
            "`{key}` is in seconds: {number} ms is {ms}, {number} µs {us}, {number} ns {ns}; else {otherwise}"
        );
    }
    if key.ends_with("_m") && found > high && range.contains(found * 1e-3) {
        let (number, meant) = (short(found), short(found * 1e-3));
        return format!("`{key}` is in metres: {number} mm is {meant}; else {otherwise}");
    }
    if found < 0.0 && low >= 0.0 && range.contains(-found) {
        return format!("{otherwise}, without the minus sign");
    }
    otherwise
}

/// The remedy for a value of another type. `dotted` is the key with its tables.
pub(super) fn of_type(key: &str, found: &DeValue<'_>, allowed: &str, dotted: &str) -> String {
    let number = allowed.starts_with("a number") || allowed.starts_with("a whole number");
    if let Some(text) = found.as_str() {
        if number && text.trim().parse::<f64>().is_ok() {
            return format!("write it without quotes: `{key} = {}`", text.trim());
        }
        if number {
            let unit = unit_of(key);
            return format!("write the number alone, without quotes and unit: {unit}");
        }
        if allowed == "true or false" {
            let flag = matches!(text.trim().to_lowercase().as_str(), "true" | "yes" | "on" | "1");
            return format!("write it without quotes: `{key} = {flag}`");
        }
    }
    match found {
        DeValue::Float(float) if allowed.starts_with("a whole number") => match float.as_str().parse::<f64>() {
            Ok(value) if value.fract() == 0.0 => format!("write it without a point: `{key} = {value}`"),
            _ => format!("give `{key}` a whole number"),
        },
        DeValue::Integer(integer) if allowed == "true or false" => {
            format!("write `{key} = {}`", integer.as_str() != "0")
        }
        DeValue::Integer(_) | DeValue::Float(_) | DeValue::Boolean(_) if allowed.starts_with("a text") => {
            format!("write it in quotes: `{key} = \"…\"`")
        }
        DeValue::Table(_) if allowed.contains("[[") => format!("write its header with two brackets: [[{dotted}]]"),
        DeValue::Array(tables) if allowed.starts_with("a table") && tables.iter().all(|t| t.get_ref().is_table()) => {
            format!("there is one such table: write its header with one bracket, [{dotted}]")
        }
        _ if allowed.starts_with("a table") => format!("write it as a table of its own, under the header [{dotted}]"),
        _ => format!("write `{key}` as {allowed}"),
    }
}

/// Returns a sentence that tells the user where to find the unit of a key.
fn unit_of(key: &str) -> String {
    let is_in_name = ["_hz", "_s", "_m", "_a"].iter().any(|unit| key.ends_with(unit));
    if is_in_name {
        format!("`{key}` has one unit, and its name says which")
    } else {
        format!("`{key}` has one unit, which docs/machine-file.md says")
    }
}

/// The remedy for text that is not valid TOML, from the parser's message and the line that it is about.
pub(super) fn of_syntax(message: &str, line: &str) -> String {
    let line = line.trim();
    let value = line.split_once('=').map_or("", |(_, value)| value.trim());
    let value = value.split('#').next().unwrap_or_default().trim();
    if value.starts_with(|c: char| c.is_ascii_digit() || c == '-') && value.contains(',') {
        return "a fraction begins with a point, and thousands are set apart with `_`: 100.5, 50_000_000".to_owned();
    }
    if value.starts_with(|c: char| c.is_ascii_digit() || c == '-') && value.ends_with(char::is_alphabetic) {
        return "write the number alone: the key's name says its unit".to_owned();
    }
    if message.contains("must be quoted") {
        return "write the text in quotes, such as `kind = \"zvd\"`".to_owned();
    }
    if message.contains("duplicate key") && line.starts_with('[') {
        return "a table stands once in a file: join the two. Only [[axis]] and [[axis.mode]], with two brackets, may be repeated"
            .to_owned();
    }
    if message.contains("duplicate key") {
        return "a key stands once in its table: remove one of the two. The next mode begins with [[axis.mode]], the next \
                axis with [[axis]]"
            .to_owned();
    }
    "correct the syntax of this line; docs/machine-file.md has every key with an example".to_owned()
}

/// The line, from 1, that has the key or the table of the line at `place` already. `None` where neither is written plainly.
pub(super) fn first_of_its_name(text: &str, place: usize) -> Option<usize> {
    let before = text.get(..place)?.matches('\n').count();
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let is_header = |line: &&str| line.starts_with('[');
    let key = |line: &str| line.split_once('=').map(|(key, _)| key.trim().to_owned());
    // With one bracket or two.
    let table = |line: &str| {
        let header = line.split('#').next().unwrap_or_default().trim();
        header.trim_matches(['[', ']']).trim().to_owned()
    };
    let repeated = *lines.get(before)?;
    let earlier = &lines[..before];
    let found = if is_header(&repeated) {
        earlier
            .iter()
            .rposition(|line| is_header(line) && table(line) == table(repeated))
    } else {
        let begin = earlier.iter().rposition(is_header).map_or(0, |at| at + 1);
        let name = key(repeated)?;
        let at = earlier[begin..]
            .iter()
            .position(|line| key(line).as_ref() == Some(&name));
        at.map(|at| begin + at)
    };
    found.map(|at| at + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_repeated_key_is_traced_to_its_first_line() {
        let text = "name = \"m\"\n# damping = 1\n[a]\ndamping = 1\n[[b]]\ndamping = 2  # here\nx = 1\ndamping = 3\n[[a]] # again\n";
        let at = |line: usize| text.lines().take(line - 1).map(|line| line.len() + 1).sum::<usize>();
        assert_eq!(first_of_its_name(text, at(8)), Some(6));
        assert_eq!(first_of_its_name(text, at(9)), Some(3));
        assert_eq!(first_of_its_name(text, at(7)), None);
        assert_eq!(first_of_its_name(text, 10_000), None);
    }

    #[test]
    fn numbers_are_written_as_in_a_machine_file() {
        for (value, text) in [
            (50e6, "50_000_000"),
            (10e3, "10_000"),
            (30.0, "30"),
            (131.117_015_808_451, "131.117"),
            (-1e3, "-1_000"),
        ] {
            assert_eq!(written(value), text);
        }
    }

    #[test]
    fn a_number_out_of_range_gets_the_question_that_fits() {
        let part = NumberRange::closed(0.0, 1.0).open_above();
        assert!(of_number("damping", 5.0, part).starts_with("percent? 5 % is 0.05"));
        assert_eq!(
            of_number("damping", 500.0, part),
            "give `damping` a value in this range"
        );
        let time = NumberRange::closed(0.0, 60.0).unit("s");
        let seconds = "`watchdog_s` is in seconds: 500 ms is 0.5, 500 µs 0.0005, 500 ns 5e-7";
        assert!(of_number("watchdog_s", 500.0, time).starts_with(seconds));
        let length = NumberRange::closed(1e-4, 1.0).unit("m");
        assert!(of_number("lead_m", 16.0, length).starts_with("`lead_m` is in metres: 16 mm is 0.016; else"));
        assert!(!of_number("lead_m", 16_000.0, length).contains("mm"));
        assert!(of_number("watchdog_s", -5.0, time).ends_with("without the minus sign"));
    }
}
