//! The text of a log: its encoding, its separator, its numbers and times of day, and the settings in its remarks.

use super::LogError;
use std::borrow::Cow;

/// First bytes of files that are not text, and the format of these files.
const PACKED: [(&[u8], &str); 4] = [
    (&[0x1f, 0x8b], "compressed by gzip: unpack it first (gunzip)"),
    (
        b"PK\x03\x04",
        "an archive or a spreadsheet: unpack it, or save it as CSV",
    ),
    (
        &[0x28, 0xb5, 0x2f, 0xfd],
        "compressed by Zstandard, as Shake&Tune's .stdata: record a log in CSV with Klipper's `TEST_RESONANCES AXIS=X OUTPUT=raw_data`",
    ),
    (b"BZh", "compressed by bzip2: unpack it first (bunzip2)"),
];

/// Returns the text in UTF-8, without a byte order mark; spreadsheets also write UTF-16.
pub(super) fn in_utf8(text: &[u8]) -> Result<Cow<'_, [u8]>, LogError> {
    if let Some((_, what)) = PACKED.iter().find(|(magic, _)| text.starts_with(magic)) {
        return Err(LogError::Packed(what));
    }
    let wide = |rest: &[u8], of: fn([u8; 2]) -> u16| {
        let (pairs, _) = rest.as_chunks::<2>();
        let words: Vec<u16> = pairs.iter().map(|pair| of(*pair)).collect();
        Cow::Owned(String::from_utf16_lossy(&words).into_bytes())
    };
    let text = match text {
        [0xef, 0xbb, 0xbf, rest @ ..] => Cow::Borrowed(rest),
        [0xff, 0xfe, rest @ ..] => wide(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => wide(rest, u16::from_be_bytes),
        _ => Cow::Borrowed(text),
    };
    if text.contains(&0) {
        return Err(LogError::Binary);
    }
    Ok(text)
}

/// Returns the separator of the fields, and the text to be read with it. The separator is the one that divides most of the first lines into
/// numbers. Commas may be decimal commas beside the other separators, and runs of spaces become tabulators. A first line `sep=;` decides.
pub(super) fn separator(text: &[u8]) -> (u8, Cow<'_, [u8]>) {
    const LOOKED_AT: usize = 96;
    if let Some(rest) = text.strip_prefix(b"sep=")
        && let [separator, rest @ ..] = rest
    {
        // The line stays as an empty one, so that line numbers match those of an editor.
        return (*separator, Cow::Borrowed(rest));
    }
    let lines = || text.split(|byte| *byte == b'\n').take(LOOKED_AT);
    let numbers = |separator: u8| {
        let rows = lines().filter(|line| {
            let fields = line.split(|byte| *byte == separator || (separator == b' ' && byte.is_ascii_whitespace()));
            let fields = fields.map(unquoted).filter(|field| !field.is_empty());
            let (values, others): (Vec<_>, Vec<_>) =
                fields.partition(|field| number(field).is_some() || time_of_day(field).is_some());
            values.len() > 1 && values.len() > 2 * others.len()
        });
        rows.count()
    };
    let mut best = (0, None);
    for separator in [b';', b'\t', b',', b'|', b' '] {
        let rows = numbers(separator);
        if rows > best.0 {
            best = (rows, Some(separator));
        }
    }
    // Without rows of numbers, the characters in the lines decide.
    let contained = || {
        let has = |separator: u8| lines().any(|line| !is_remark(line) && line.contains(&separator));
        [b';', b'\t', b',', b' '].into_iter().find(|separator| has(*separator))
    };
    match best.1.or_else(contained) {
        Some(b' ') => (b'\t', Cow::Owned(tabbed(text))),
        Some(separator) => (separator, Cow::Borrowed(text)),
        None => (b',', Cow::Borrowed(text)),
    }
}

fn unquoted(field: &[u8]) -> &[u8] {
    let field = field.trim_ascii();
    field
        .strip_prefix(b"\"")
        .and_then(|field| field.strip_suffix(b"\""))
        .unwrap_or(field)
}

/// Whether a line begins like a remark.
pub(super) fn is_remark(line: &[u8]) -> bool {
    matches!(line.first(), Some(b'#' | b';' | b'%')) || line.starts_with(b"//")
}

/// Replaces each run of spaces within a line by one tabulator.
fn tabbed(text: &[u8]) -> Vec<u8> {
    let words = |line: &[u8]| {
        let words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        words.collect::<Vec<_>>().join(&b'\t')
    };
    let lines: Vec<Vec<u8>> = text.split(|byte| *byte == b'\n').map(words).collect();
    lines.join(&b'\n')
}

/// Parses a finite number with a decimal point, or with a decimal comma if commas do not separate fields.
pub(super) fn number(field: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(field).ok()?;
    let value: f64 = text.parse().or_else(|_| text.replace(',', ".").parse()).ok()?;
    value.is_finite().then_some(value)
}

/// Converts a time of day such as `2026-01-31 12:00:01.250`, or minutes and seconds, to seconds since midnight.
pub(super) fn time_of_day(field: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(field).ok()?;
    let clock = text.trim_end_matches(['Z', 'z']).rsplit([' ', 'T']).next()?;
    let mut parts = clock
        .split(':')
        .map(|part| number(part.as_bytes()).filter(|value| *value >= 0.0));
    let (first, second) = (parts.next()??, parts.next()??);
    match (parts.next(), parts.next()) {
        (Some(third), None) => Some(3600.0 * first + 60.0 * second + third?),
        (None, None) => Some(60.0 * first + second),
        _ => None,
    }
}

/// Length of a day in seconds.
pub(super) const DAY_S: f64 = 86_400.0;

/// Settings of the whole recording, from lines beside the samples.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Said {
    /// Samples per second.
    pub(super) rate_hz: Option<f64>,
    /// How often the sensor's memory has overflowed.
    pub(super) overflows: Option<u64>,
}

impl Said {
    /// Adds the settings in a line such as `Rate 1344, overflows 0` or `# data_rate = 2000 Hz`.
    pub(super) fn hear(&mut self, line: &str) {
        let line = line.to_lowercase();
        let after = |word: &str| {
            let (_, rest) = line.split_once(word)?;
            let rest = rest.trim_start_matches(|letter: char| " \t:=,;\"".contains(letter));
            let end = rest.find(|letter: char| !(letter.is_ascii_digit() || ".e+-".contains(letter)));
            let (value, unit) = rest.split_at(end.unwrap_or(rest.len()));
            Some((value.parse::<f64>().ok()?, unit))
        };
        // A feed rate or a baud rate is not the rate of the samples.
        const RATES: [&str; 9] = [
            "samplerate",
            "sample rate",
            "sample_rate",
            "sampling rate",
            "sampling_rate",
            "sampling frequency",
            "data_rate",
            "data rate",
            "datarate",
        ];
        let alone = line.starts_with("rate").then(|| after("rate")).flatten();
        if let Some((value, unit)) = RATES.iter().find_map(|word| after(word)).or(alone) {
            let unit = unit.trim_start_matches(|letter: char| " ,;\"".contains(letter));
            let factor = if unit.starts_with("khz") {
                1e3
            } else if unit.starts_with("mhz") {
                1e6
            } else {
                1.0
            };
            if value > 0.0 && value.is_finite() {
                self.rate_hz = Some(value * factor);
            }
        }
        if let Some((count, _)) = ["overflows", "skipped samples"].iter().find_map(|word| after(word)) {
            self.overflows = Some(count as u64);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn separators_follow_from_the_rows_whatever_remarks_contain() {
        let cases: [(&str, u8); 7] = [
            ("time,x\n0,1\n1,2\n", b','),
            (";Title, logger\n;Headers, time,Ax\n0.003,799\n0.013,805\n", b','),
            ("Zeit;x\n0,5;1,5\n0,6;1,5\n", b';'),
            ("# a; b; c\ntime\tx\n0,5\t1,5\n", b'\t'),
            ("time x\n0.5 1.5\n0.6 1.5\n", b'\t'),
            ("t x\n0,5 1,5\n0,6 1,5\n", b'\t'),
            ("\"t\",\"x\"\n\"0,5\",\"1,5\"\n", b','),
        ];
        for (text, expected) in cases {
            assert_eq!(separator(text.as_bytes()).0, expected, "{text}");
        }
    }

    #[test]
    fn times_of_day_and_settings_in_remarks_are_read() {
        assert_eq!(time_of_day(b"2026-01-31 12:00:01.250"), Some(43_201.25));
        assert_eq!(time_of_day(b"2026-01-31T00:00:01,5Z"), Some(1.5));
        assert_eq!(time_of_day(b"01:02.5"), Some(62.5));
        assert_eq!(
            (time_of_day(b"12"), time_of_day(b"a:b"), time_of_day(b"1:2:3:4")),
            (None, None, None)
        );
        let said = |line: &str| {
            let mut said = Said::default();
            said.hear(line);
            (said.rate_hz, said.overflows)
        };
        assert_eq!(said("Rate 1344, overflows 2"), (Some(1344.0), Some(2)));
        assert_eq!(
            said("# Config: data_rate = 2000.0 Hz, filter = 488 Hz"),
            (Some(2000.0), None)
        );
        assert_eq!(said(";SampleRate, 100,Hz"), (Some(100.0), None));
        assert_eq!(said("; Samplerate: 1.5 kHz"), (Some(1500.0), None));
        assert_eq!(said("# feed rate 3000"), (None, None));
    }
}
