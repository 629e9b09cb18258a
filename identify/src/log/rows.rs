//! Reads rows that contain only numbers, as almost all rows of a log do. This is several times as fast as a general CSV reader, and uses
//! two cores.
//!
//! A row is plain if it is a line with as many fields as the header, without quotes, and if its first field and its used fields are finite
//! numbers. The plain rows end at the first other line. The general reader continues there, so both readers interpret a log in the same
//! way.

use super::text::number;
use super::uses::Use;
use crate::parallel::both;

/// The plain rows at the beginning of a text.
pub(super) struct PlainRows {
    /// For each field that is used, its values times its factor.
    pub(super) values: Vec<Vec<f64>>,
    /// Number of rows.
    pub(super) rows: usize,
    /// Number of bytes of the text that the rows take.
    pub(super) bytes: usize,
}

/// The format of plain rows.
#[derive(Clone, Copy)]
pub(super) struct Layout<'a> {
    pub(super) separator: u8,
    /// Number of fields of a row.
    pub(super) width: usize,
    pub(super) used: &'a [Use],
}

/// Length of a text in bytes below which a second thread costs more than it saves.
const LEAST_OF_TWO: usize = 1 << 20;

/// Reads the plain rows at the beginning of a text.
pub(super) fn plain(text: &[u8], layout: Layout<'_>) -> PlainRows {
    let middle = memchr::memchr(b'\n', &text[text.len() / 2..]).map(|end| text.len() / 2 + end + 1);
    let (Some(middle), true) = (middle, text.len() >= LEAST_OF_TWO) else {
        return one_after_another(text, layout, text.len());
    };
    let (one, other) = text.split_at(middle);
    let (second, mut first) = both(
        || one_after_another(other, layout, other.len()),
        || one_after_another(one, layout, text.len()),
    );
    if first.bytes == one.len() {
        for (all, more) in first.values.iter_mut().zip(second.values) {
            all.extend(more);
        }
        first.rows += second.rows;
        first.bytes += second.bytes;
    }
    first
}

/// The same on one core; reserves memory for the rows of `room` bytes.
fn one_after_another(text: &[u8], layout: Layout<'_>, room: usize) -> PlainRows {
    let length = memchr::memchr(b'\n', text).map_or(text.len(), |end| end + 1);
    let capacity = room / length.max(2) + room / length.max(2) / 16 + 16;
    let mut values: Vec<Vec<f64>> = layout.used.iter().map(|_| Vec::with_capacity(capacity)).collect();
    let (mut rows, mut bytes) = (0, 0);
    let mut fields: Vec<&[u8]> = Vec::with_capacity(layout.width);
    while let Some(end) = memchr::memchr(b'\n', &text[bytes..]) {
        let line = &text[bytes..bytes + end];
        if !is_plain(line, layout, &mut fields, &mut values) {
            break;
        }
        rows += 1;
        bytes += end + 1;
    }
    values.iter_mut().for_each(|column| column.truncate(rows));
    PlainRows { values, rows, bytes }
}

/// Adds the values of a line if it is plain; of another line, some values may be added.
fn is_plain<'a>(line: &'a [u8], layout: Layout<'_>, fields: &mut Vec<&'a [u8]>, values: &mut [Vec<f64>]) -> bool {
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    fields.clear();
    let mut begin = 0;
    for (n, byte) in line.iter().enumerate() {
        if *byte == layout.separator {
            fields.push(&line[begin..n]);
            begin = n + 1;
        } else if matches!(byte, b'"' | b'\r') {
            return false;
        }
    }
    fields.push(&line[begin..]);
    if fields.len() != layout.width || !layout.used.iter().any(|used| used.field == 0) && value(fields[0]).is_none() {
        return false;
    }
    for (used, column) in layout.used.iter().zip(values) {
        match value(fields[used.field]) {
            Some(value) => column.push(value * used.factor),
            None => return false,
        }
    }
    true
}

/// Powers of ten that are exact.
const TENS: [f64; 16] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
];

/// Parses a finite number. If its digits and its power of ten are both exact in an `f64`, their quotient is the nearest to the decimal
/// number, as any correct parser returns it (Clinger 1990).
fn value(field: &[u8]) -> Option<f64> {
    let field = field.trim_ascii();
    let (is_negative, unsigned) = match field {
        [b'-', rest @ ..] => (true, rest),
        rest => (false, rest),
    };
    let (mut digits, mut count, mut behind_point) = (0u64, 0, None);
    for byte in unsigned {
        match byte {
            b'0'..=b'9' => {
                digits = digits * 10 + u64::from(byte - b'0');
                count += 1;
                behind_point = behind_point.map(|places: usize| places + 1);
            }
            b'.' if behind_point.is_none() => behind_point = Some(0),
            _ => return number(field),
        }
        if count > TENS.len() - 1 {
            return number(field);
        }
    }
    if count == 0 {
        return number(field);
    }
    let size = digits as f64 / TENS[behind_point.unwrap_or(0)];
    Some(if is_negative { -size } else { size })
}

#[cfg(test)]
mod tests {
    use super::super::uses::Target;
    use super::*;
    use proptest::prelude::*;

    const USED: [Use; 2] = [
        Use {
            field: 0,
            target: Target::Time,
            factor: 1.0,
        },
        Use {
            field: 2,
            target: Target::Column(0),
            factor: 0.5,
        },
    ];

    fn layout() -> Layout<'static> {
        Layout {
            separator: b',',
            width: 3,
            used: &USED,
        }
    }

    proptest! {
        #[test]
        fn numbers_match_the_standard_library(digits in 0u64..u64::MAX, places in 0usize..20, sign in "[-+]?") {
            let text = format!("{sign}{digits:0width$}", width = places + 1);
            let (whole, part) = text.split_at(text.len() - places);
            let text = format!("{whole}.{part}");
            prop_assert_eq!(value(text.as_bytes()).unwrap().to_bits(), text.parse::<f64>().unwrap().to_bits());
        }
    }

    #[test]
    fn other_numbers_match_the_general_reader() {
        for text in [
            "", "-", ".", "-.5", "5.", "1e3", "nan", "inf", "1.2.3", "+4", "0,5", " 7 ", "1_0", "-0",
        ] {
            let expected = number(text.trim().as_bytes());
            assert_eq!(
                value(text.as_bytes()).map(f64::to_bits),
                expected.map(f64::to_bits),
                "{text}"
            );
        }
    }

    #[test]
    fn plain_rows_end_before_the_first_other_line() {
        for (rest, expected) in [
            ("3,x,0\n", 3),
            ("3,0\n", 2),
            ("3,\"x\",0\n", 2),
            ("\n3,x,0\n", 2),
            ("# 3,x,0\n", 2),
            ("Rate 1344, overflows 0, x\n", 2),
            ("3,x,nan\n", 2),
            ("3,x,0", 2),
            ("3,x\r,0\n", 2),
        ] {
            let text = format!("1,x,5\r\n2,x, 7\n{rest}");
            let found = plain(text.as_bytes(), layout());
            assert_eq!(found.rows, expected, "{rest}");
            assert_eq!(found.values[0][..2], [1.0, 2.0]);
            assert_eq!(found.values[1][..2], [2.5, 3.5]);
            assert_eq!(found.values[0].len(), expected);
            assert_eq!(found.bytes, if expected == 3 { text.len() } else { 14 }, "{rest}");
        }
    }

    #[test]
    fn two_threads_read_the_same_as_one() {
        let rows = |broken: usize| -> String {
            (0..60_000)
                .map(|n| {
                    if n == broken {
                        "x\n".into()
                    } else {
                        format!("{n},-,{}.25\n", 3 * n)
                    }
                })
                .collect()
        };
        for broken in [100, 59_000, 60_000] {
            let text = rows(broken) + &" ".repeat(LEAST_OF_TWO);
            let (two, one) = (
                plain(text.as_bytes(), layout()),
                one_after_another(text.as_bytes(), layout(), 0),
            );
            assert_eq!((two.rows, two.bytes, two.values), (one.rows, one.bytes, one.values));
        }
    }
}
