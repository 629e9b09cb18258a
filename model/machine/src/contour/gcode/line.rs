//! One line of G-code as its words.
//!
//! Comments (`;` to the end of the line, `( )`), line numbers (`N10`), checksums (`*71`) and the lines of `%` are left
//! out. Letters are read in either case, with or without spaces between words and inside them; a number has no
//! exponent, because `E` is a word.

/// Number of letters.
const LETTERS: usize = 26;

/// Meaning of a line.
#[expect(
    clippy::large_enum_variant,
    reason = "there is one at a time, and a box would cost an allocation for each line"
)]
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Line {
    /// A line that does not move an axis.
    Nothing,
    /// Words.
    Words(Words),
    /// A command called by name, such as a firmware macro.
    Named {
        /// The name as written.
        name: String,
        /// Whether a parameter is X or Y.
        has_place: bool,
    },
    /// Text that cannot be read and may change the path of the axes.
    Unreadable(String),
}

/// A code, such as G38.2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Code {
    /// `G` or `M`.
    pub(super) letter: u8,
    pub(super) major: u32,
    /// The digit behind the point.
    pub(super) minor: u32,
}

impl std::fmt::Display for Code {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let letter = char::from(self.letter);
        match self.minor {
            0 => write!(f, "{letter}{}", self.major),
            minor => write!(f, "{letter}{}.{minor}", self.major),
        }
    }
}

/// The words of a line.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Words {
    /// Its codes, in their order.
    pub(super) codes: Vec<Code>,
    /// The number of each letter.
    numbers: [Option<f64>; LETTERS],
    /// Whether each letter is there, with or without a number.
    present: [bool; LETTERS],
    /// Problem of the first part that is not a letter with a number.
    pub(super) bad: Option<String>,
    /// Whether the line begins with `/`: a switch of the controller decides whether it runs.
    pub(super) is_optional: bool,
}

impl Words {
    pub(super) fn number(&self, letter: u8) -> Option<f64> {
        self.numbers[usize::from(letter - b'A')]
    }

    pub(super) fn has(&self, letter: u8) -> bool {
        self.present[usize::from(letter - b'A')]
    }

    pub(super) fn has_any(&self, letters: &[u8]) -> bool {
        letters.iter().any(|letter| self.has(*letter))
    }
}

/// Reads a line. `scratch` is a buffer for reuse.
pub(super) fn read(line: &[u8], scratch: &mut Vec<u8>) -> Line {
    strip(line, scratch);
    let mut text = scratch.trim_ascii();
    let mut is_optional = false;
    loop {
        text = text.trim_ascii_start();
        match text {
            [b'/', rest @ ..] => (text, is_optional) = (rest, true),
            [b'n' | b'N', rest @ ..] if digits(rest).is_some() => text = digits(rest).unwrap_or_default(),
            _ => break,
        }
    }
    match text {
        [] => Line::Nothing,
        [b'$', b'H' | b'h' | b'J' | b'j', ..] => Line::Unreadable(shown(text)),
        // Numbers of programs, settings of grbl, commands to hosts, assignments, and characters of real time.
        [b'@', second, ..] if !is_name(*second) => Line::Unreadable(shown(text)),
        [b'%' | b':' | b'$' | b'@' | b'{' | b'#' | b'!' | b'~' | b'?' | b'<', ..] => Line::Nothing,
        [b'O' | b'o', rest @ ..] if !rest.first().is_some_and(u8::is_ascii_alphabetic) => match digits(rest) {
            Some(after) if after.trim_ascii().is_empty() => Line::Nothing,
            _ => Line::Unreadable(shown(text)),
        },
        [first, second, ..] if is_name(*first) && is_name(*second) => named(text),
        _ => Line::Words(words(text, is_optional)),
    }
}

fn is_name(byte: u8) -> bool {
    byte.is_ascii_alphabetic() || byte == b'_'
}

/// Skips spaces and digits, and returns the rest; `None` if there are no digits.
fn digits(text: &[u8]) -> Option<&[u8]> {
    let text = text.trim_ascii_start();
    let count = text.iter().take_while(|byte| byte.is_ascii_digit()).count();
    (count > 0).then(|| &text[count..])
}

/// Copies a line without its comments, its checksum and its end.
fn strip(line: &[u8], into: &mut Vec<u8>) {
    into.clear();
    let line = line.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(line);
    let (mut is_comment, mut is_quoted) = (false, false);
    for (index, byte) in line.iter().enumerate() {
        match byte {
            b')' if is_comment => is_comment = false,
            _ if is_comment => (),
            b'"' => {
                is_quoted = !is_quoted;
                into.push(*byte);
            }
            _ if is_quoted => into.push(*byte),
            b'(' => is_comment = true,
            b';' => break,
            b'*' if line[index + 1..].trim_ascii().iter().all(u8::is_ascii_digit) => break,
            _ => into.push(*byte),
        }
    }
}

/// Words that control which lines run.
const CONTROL: [&str; 18] = [
    "if", "elif", "elseif", "else", "endif", "while", "endwhile", "do", "end", "goto", "repeat", "call", "sub",
    "endsub", "return", "break", "continue", "loop",
];

/// A line that begins with a name.
fn named(text: &[u8]) -> Line {
    let count = text
        .iter()
        .take_while(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'.'))
        .count();
    let name = shown(&text[..count]);
    let word: String = name.chars().take_while(char::is_ascii_alphabetic).collect();
    if CONTROL.contains(&word.to_ascii_lowercase().as_str()) {
        return Line::Unreadable(shown(text));
    }
    // `X=10` or `X10`, as a parameter of its own.
    let is_place = |parameter: &[u8]| match parameter {
        [b'x' | b'X' | b'y' | b'Y', b'=', _, ..] => true,
        [b'x' | b'X' | b'y' | b'Y', rest @ ..] => number(rest).is_some_and(|(_, after)| after.is_empty()),
        _ => false,
    };
    let has_place = text[count..].split(u8::is_ascii_whitespace).any(is_place);
    Line::Named { name, has_place }
}

/// Reads the words of a text, up to the first part that is not a word.
fn words(mut text: &[u8], is_optional: bool) -> Words {
    let mut words = Words {
        is_optional,
        ..Words::default()
    };
    let no_number = |text: &[u8]| Some(format!("`{}` has no number", shown(text)));
    loop {
        text = text.trim_ascii_start();
        let Some((letter, rest)) = text.split_first() else {
            return words;
        };
        let letter = letter.to_ascii_uppercase();
        let place = usize::from(letter.wrapping_sub(b'A'));
        if !letter.is_ascii_uppercase() || place >= LETTERS {
            words.bad = no_number(text);
            return words;
        }
        let rest = rest.trim_ascii_start();
        match (letter, number(rest), rest.first()) {
            (b'G' | b'M', Some((value, after)), _) => {
                let tenths = (value * 10.0).round();
                if !(0.0..1e6).contains(&tenths) {
                    words.bad = no_number(text);
                    return words;
                }
                words.codes.push(Code {
                    letter,
                    major: tenths as u32 / 10,
                    minor: tenths as u32 % 10,
                });
                text = after;
            }
            (_, Some((value, after)), _) => {
                if words.numbers[place].is_some() {
                    words.bad = Some(format!("{} stands there twice", char::from(letter)));
                    return words;
                }
                (words.numbers[place], words.present[place]) = (Some(value), true);
                text = after;
            }
            // A text, as file names are given.
            (_, None, Some(b'"')) => {
                let end = rest[1..].iter().position(|byte| *byte == b'"');
                words.present[place] = true;
                text = end.map_or(&[], |end| &rest[end + 2..]);
            }
            // A letter alone is a flag.
            (_, None, next) if next.is_none_or(u8::is_ascii_alphabetic) => {
                words.present[place] = true;
                text = rest;
            }
            _ => {
                words.present[place] = true;
                words.bad = no_number(text);
                return words;
            }
        }
    }
}

/// Largest number of digits that a 64-bit word holds.
const DIGITS: usize = 18;

/// A number at the beginning of a text, without an exponent, and what follows it.
fn number(text: &[u8]) -> Option<(f64, &[u8])> {
    let (sign, unsigned) = match text {
        [b'-', rest @ ..] => (-1.0, rest),
        [b'+', rest @ ..] => (1.0, rest),
        _ => (1.0, text),
    };
    let (mut mantissa, mut digits, mut fraction, mut has_point, mut count) = (0u64, 0, 0i32, false, 0);
    for byte in unsigned {
        match byte {
            b'0'..=b'9' => {
                digits += 1;
                if digits <= DIGITS {
                    mantissa = mantissa * 10 + u64::from(byte - b'0');
                }
                fraction += i32::from(has_point);
            }
            b'.' if !has_point => has_point = true,
            _ => break,
        }
        count += 1;
    }
    if digits == 0 {
        return None;
    }
    let rest = &unsigned[count..];
    // A quotient of two numbers that are exact is rounded once.
    if digits <= 15 {
        return Some((sign * mantissa as f64 / 10f64.powi(fraction), rest));
    }
    let digits = std::str::from_utf8(&unsigned[..count]).ok()?;
    let value: f64 = digits.parse().ok()?;
    value.is_finite().then_some((sign * value, rest))
}

/// A part of a line for a message, at most 40 characters of it.
fn shown(text: &[u8]) -> String {
    let text = String::from_utf8_lossy(text.trim_ascii());
    let mut shown: String = text
        .chars()
        .take(40)
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    if shown.len() < text.len() {
        shown.push('…');
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words_of(line: &str) -> Words {
        match read(line.as_bytes(), &mut Vec::new()) {
            Line::Words(words) => words,
            other => panic!("{line}: {other:?}"),
        }
    }

    #[test]
    fn words_are_read_in_every_spelling() {
        for line in [
            "G1 X10.5 Y-2 E1 F3000",
            "g1x10.5y-2e1f3000",
            "N12 G01 X+10.5 Y-2. E1. F3000*71",
            "  G 1 X 10.5 (to (here) Y -2 E1 F3000 ; on",
            "\u{feff}G1 X010.50 Y-2.0 E1 F3000 (",
            "N7G1X10.5Y-2E1F3000",
        ] {
            let words = words_of(line);
            let code = Code {
                letter: b'G',
                major: 1,
                minor: 0,
            };
            assert_eq!(words.codes, [code], "{line}");
            let found = [b'X', b'Y', b'E', b'F'].map(|letter| words.number(letter));
            assert_eq!(found, [Some(10.5), Some(-2.0), Some(1.0), Some(3000.0)], "{line}");
            assert_eq!(words.bad, None, "{line}");
        }
        assert_eq!(words_of("X.5").number(b'X'), Some(0.5));
        assert_eq!(words_of("X-.25Y0").number(b'X'), Some(-0.25));
        assert_eq!(
            words_of("X0.123456789012345678901").number(b'X'),
            Some(0.123_456_789_012_345_68)
        );
        assert_eq!(words_of("G38.2 Z1").codes[0].to_string(), "G38.2");
        assert!(words_of("G28 X Y").has(b'Y') && words_of("G28 X Y").number(b'Y').is_none());
        assert!(words_of("/G1 X1").is_optional);
    }

    #[test]
    fn parts_without_a_number_are_errors() {
        for (line, bad) in [
            ("G1 X[1+2]", "X[1+2]"),
            ("G1 X#1", "X#1"),
            ("G1 @10 ^45", "@10 ^45"),
            ("G1 X10,5", ",5"),
            ("G1 X{x}", "X{x}"),
            ("G1 X-", "X-"),
        ] {
            let expected = format!("`{bad}` has no number");
            assert_eq!(words_of(line).bad, Some(expected), "{line}");
        }
        assert_eq!(words_of("G1 X1 X2").bad.as_deref(), Some("X stands there twice"));
    }

    #[test]
    fn lines_that_are_not_moves_are_classified() {
        let read = |line: &str| read(line.as_bytes(), &mut Vec::new());
        for nothing in [
            "",
            "%",
            "; X1",
            "(G1 X1)",
            "O1000",
            "O0001 (PART)",
            "#1 = 5",
            ":1234",
            "$X",
            "@OBJECT x",
            "\r",
        ] {
            assert_eq!(read(nothing), Line::Nothing, "{nothing}");
        }
        for unreadable in [
            "o100 sub",
            "O<hole> call [1]",
            "IF [#1 GT 5] GOTO 10",
            "while true",
            "$H",
            "o[#1] if [1]",
        ] {
            assert!(matches!(read(unreadable), Line::Unreadable(_)), "{unreadable}");
        }
        for (line, place) in [
            ("EXCLUDE_OBJECT_DEFINE NAME=a CENTER=10,10 POLYGON=[[1,2]]", false),
            ("SET_PRESSURE_ADVANCE ADVANCE=0.02", false),
            ("TIMELAPSE_TAKE_FRAME", false),
            ("_PARK X=10 Y=20", true),
            ("MOVE_TO Y10", true),
            ("EXCLUDE_OBJECT_START NAME=X10", false),
        ] {
            assert!(
                matches!(read(line), Line::Named { has_place, .. } if has_place == place),
                "{line}"
            );
        }
    }
}
