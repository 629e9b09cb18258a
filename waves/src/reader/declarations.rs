//! Reads the declarations of a VCD, as every producer writes them.
//!
//! | producer writes | read as |
//! |---|---|
//! | `$var logic`, `int`, `enum`, … | a vector; `shortreal`, `realtime`, `real_parameter`: a real number |
//! | `$var port [3:0] <0 d $end` (EVCD) | a vector of 4 bits |
//! | `data [7:0]`, `data[7:0]`, `memory [3] [7:0]` | the range stays with the name |
//! | `$scope module $end`, without a name | a scope that adds nothing to the names |
//! | `$scope name $end`, `$unscope`, scopes that stay open, `$var` under a known id with another width | read, with a note |
//! | `$date`, `$version`, `$comment`, `$attrbegin`, any other `$word` | nothing; its text may hold whatever it likes |
//! | bytes that are not UTF-8 | U+FFFD |
//!
//! It stops after `$enddefinitions $end`, so that the value changes can be read from there.

use std::io::{self, BufRead};

use super::header::{Declarations, Kind, Selection};
use super::ids::Ids;
use super::put::shown;

/// Largest number of bytes in a word of the declarations, and of words in a command.
const WORD_BYTES: usize = 1 << 20;
const COMMAND_WORDS: usize = 1 << 10;

const REAL_TYPES: [&str; 5] = ["real", "shortreal", "realtime", "real_parameter", "real_time"];
/// Types that a scope may have. If the only word of a `$scope` is not among them, it is the scope's name.
const SCOPE_TYPES: [&str; 20] = [
    "module",
    "task",
    "function",
    "begin",
    "fork",
    "generate",
    "struct",
    "union",
    "class",
    "interface",
    "package",
    "program",
    "root",
    "vhdl_architecture",
    "vhdl_procedure",
    "vhdl_function",
    "vhdl_record",
    "vhdl_process",
    "vhdl_block",
    "vhdl_package",
];

/// Units of time and the number of femtoseconds in each.
const UNITS: [(&str, u64); 7] = [
    ("s", 1_000_000_000_000_000),
    ("ms", 1_000_000_000_000),
    ("us", 1_000_000_000),
    ("µs", 1_000_000_000),
    ("ns", 1_000_000),
    ("ps", 1_000),
    ("fs", 1),
];

/// Why the declarations could not be read.
pub(super) enum Stop {
    /// What is wrong in the current line.
    Wrong(String),
    /// Where the file ends too early.
    Cut(&'static str),
}

impl From<String> for Stop {
    fn from(what: String) -> Self {
        Self::Wrong(what)
    }
}

impl From<io::Error> for Stop {
    fn from(cause: io::Error) -> Self {
        match cause.kind() {
            // A packed file that ends in the middle of its packed data.
            io::ErrorKind::UnexpectedEof => Self::Cut("in the middle of a command"),
            _ => Self::Wrong(cause.to_string()),
        }
    }
}

/// The words of a text, with the line of each.
struct Words<'a, R> {
    inner: &'a mut R,
    line: &'a mut u64,
}

impl<R: BufRead> Words<'_, R> {
    /// Returns the first byte of the next word, which is left where it is.
    fn peek(&mut self) -> io::Result<Option<u8>> {
        loop {
            let buffer = self.inner.fill_buf()?;
            let Some(at) = buffer.iter().position(|byte| *byte > b' ') else {
                if buffer.is_empty() {
                    return Ok(None);
                }
                *self.line += buffer.iter().filter(|byte| **byte == b'\n').count() as u64;
                let count = buffer.len();
                self.inner.consume(count);
                continue;
            };
            let first = buffer[at];
            *self.line += buffer[..at].iter().filter(|byte| **byte == b'\n').count() as u64;
            self.inner.consume(at);
            return Ok(Some(first));
        }
    }

    /// Takes the next word; `None` at the end of the text.
    fn next(&mut self) -> Result<Option<String>, Stop> {
        if self.peek()?.is_none() {
            return Ok(None);
        }
        let mut word = Vec::new();
        loop {
            let buffer = self.inner.fill_buf()?;
            let length = buffer.iter().take_while(|byte| **byte > b' ').count();
            if word.len() + length > WORD_BYTES {
                return Err(Stop::Wrong(format!(
                    "a word of the declarations is longer than {WORD_BYTES} bytes: this is not a VCD, or it is damaged"
                )));
            }
            let ends = length < buffer.len() || length == 0;
            word.extend_from_slice(&buffer[..length]);
            self.inner.consume(length);
            if ends {
                return Ok(Some(String::from_utf8_lossy(&word).into_owned()));
            }
        }
    }

    /// Takes the words of a command up to its `$end`. The first `certain` words never count as this end, because an id code may be `$end`.
    fn command(&mut self, certain: usize) -> Result<Vec<String>, Stop> {
        let mut words: Vec<String> = Vec::new();
        loop {
            let word = self.next()?.ok_or(Stop::Cut("in the middle of a command"))?;
            if word == "$end" && (words.len() >= certain || words.len() < 2) {
                return Ok(words);
            }
            if words.len() == COMMAND_WORDS {
                return Err(Stop::Wrong(format!(
                    "a command of more than {COMMAND_WORDS} words: its $end is missing"
                )));
            }
            words.push(word);
        }
    }

    /// Skips a text up to its `$end`, before which some writers put no space.
    fn text(&mut self) -> Result<(), Stop> {
        loop {
            let word = self.next()?.ok_or(Stop::Cut("in the middle of a command"))?;
            if word.ends_with("$end") {
                return Ok(());
            }
        }
    }
}

/// Reads a VCD up to the value changes. `line` counts the lines, for error messages.
pub(super) fn read<R: BufRead>(
    input: &mut R,
    line: &mut u64,
    selection: Selection,
) -> Result<(Declarations, Ids), Stop> {
    let mut words = Words { inner: input, line };
    let mut declarations = Declarations::new(1_000_000, selection);
    declarations.unit_is_assumed = true;
    let mut ids = Ids::default();
    loop {
        let first = words.peek()?.ok_or(Stop::Cut("before $enddefinitions"))?;
        if first != b'$' {
            if declarations.is_empty() || first != b'#' {
                let word = words.next()?.unwrap_or_default();
                let place = if declarations.is_empty() {
                    "where a VCD has declarations, such as $var"
                } else {
                    "before $enddefinitions"
                };
                return Err(Stop::Wrong(format!(
                    "`{}` {place}: this is not a VCD, or it is damaged",
                    shown(word.as_bytes())
                )));
            }
            let note = format!("line {}: the first time comes without $enddefinitions", words.line);
            declarations.notes.push(note);
            break;
        }
        let command = words.next()?.unwrap_or_default();
        match command.as_str() {
            "$enddefinitions" => {
                let next = words.peek()?.ok_or(Stop::Cut("before the $end of $enddefinitions"))?;
                if next != b'$' {
                    let note = format!("line {}: $enddefinitions without $end", words.line);
                    declarations.notes.push(note);
                } else if let Some(word) = words.next()?
                    && word != "$end"
                {
                    return Err(format!("`{}` where $enddefinitions has its $end", shown(word.as_bytes())).into());
                }
                break;
            }
            "$dumpvars" | "$dumpall" | "$dumpports" | "$dumpon" | "$dumpoff" if !declarations.is_empty() => {
                let note = format!("line {}: {command} comes without $enddefinitions", words.line);
                declarations.notes.push(note);
                break;
            }
            "$timescale" => {
                declarations.unit_fs = unit_fs(&words.command(0)?.concat())?;
                declarations.unit_is_assumed = false;
            }
            "$scope" => {
                let scope = words.command(0)?;
                let name = match scope.as_slice() {
                    [] => String::new(),
                    [word] if SCOPE_TYPES.contains(&word.as_str()) || word.starts_with("vhdl_") => String::new(),
                    [name] => {
                        let note = format!("line {}: `$scope {name}` has no type; it is read as a name", words.line);
                        declarations.note_once("has no type", note);
                        name.clone()
                    }
                    [_, name @ ..] => name.join(" "),
                };
                declarations.enter(&name)?;
            }
            "$upscope" | "$unscope" => {
                words.command(0)?;
                if command == "$unscope" {
                    let note = format!("line {}: `$unscope` is read as `$upscope`", words.line);
                    declarations.note_once("`$unscope`", note);
                }
                if !declarations.leave() {
                    let note = format!("line {}: `{command}` without `$scope` is ignored", words.line);
                    declarations.note_once("without `$scope`", note);
                }
            }
            "$var" => {
                let var = words.command(3)?;
                declare(&mut declarations, &mut ids, &var, *words.line)?;
            }
            "$end" => {}
            _ => words.text()?,
        }
    }
    declarations.finish();
    Ok((declarations, ids))
}

fn unit_fs(text: &str) -> Result<u64, String> {
    let problem = || {
        format!(
            "timescale `{}`: write a whole number of s, ms, us, ns, ps or fs, at least 1 fs",
            shown(text.as_bytes())
        )
    };
    let unit_at = text.find(|c: char| c.is_alphabetic()).ok_or_else(problem)?;
    let (number, unit) = text.split_at(unit_at);
    let unit = unit.to_lowercase();
    let (_, unit) = UNITS.iter().find(|(name, _)| *name == unit).ok_or_else(problem)?;
    let number: f64 = number.parse().ok().ok_or_else(problem)?;
    let fs = number * *unit as f64;
    let is_whole = (1.0..=1e17).contains(&fs) && fs.fract() == 0.0;
    if is_whole { Ok(fs as u64) } else { Err(problem()) }
}

/// Declares the signal of a `$var`: type, width, id code, name and range.
fn declare(declarations: &mut Declarations, ids: &mut Ids, var: &[String], line: u64) -> Result<(), String> {
    let [var_type, width, id, reference @ ..] = var else {
        return Err("a $var needs a type, a width, an id code and a name".to_owned());
    };
    let mut name = String::new();
    for word in reference {
        if !(name.is_empty() || word.starts_with('[')) {
            name.push(' ');
        }
        name.push_str(word);
    }
    if name.is_empty() {
        name.clone_from(id);
        declarations.note_once(
            "has no name",
            format!("line {line}: `{id}` has no name; it goes by its id code"),
        );
    }
    let range = width.strip_prefix('[').and_then(|range| range.strip_suffix(']'));
    let width = match range {
        // An EVCD has the range in place of the width.
        Some(range) => {
            if !name.ends_with(']') {
                name = format!("{name}[{range}]");
            }
            let (left, right) = range.split_once(':').unwrap_or((range, range));
            let ends = left.trim().parse::<i64>().ok().zip(right.trim().parse::<i64>().ok());
            ends.and_then(|(left, right)| u32::try_from(left.abs_diff(right)).ok()?.checked_add(1))
        }
        None => width.parse::<u32>().ok(),
    };
    let width = width.ok_or_else(|| format!("`{}` is not a width", shown(var[1].as_bytes())))?;
    let kind = match var_type.as_str() {
        real if REAL_TYPES.contains(&real) => Kind::Real,
        "string" => Kind::Text,
        "event" => Kind::Event,
        _ => Kind::Bits(width),
    };
    if !declarations.is_wanted(&name, kind)? {
        if ids.find(id.as_bytes()).is_none() {
            let slot = declarations.unwanted_slot()?;
            ids.left_out = Some(slot);
            ids.insert(id.as_bytes(), slot);
        }
        return Ok(());
    }
    let slot = match ids.find(id.as_bytes()) {
        Some(slot) if !declarations.is_unwanted(slot) => {
            let known = declarations.kinds[slot as usize];
            if known != kind {
                declarations.merge_kinds(slot, kind)?;
                let note = format!("line {line}: `{id}` was declared before, with another width or type");
                declarations.note_once("was declared before", note);
            }
            slot
        }
        _ => {
            let slot = declarations.add_slot(kind)?;
            ids.insert(id.as_bytes(), slot);
            slot
        }
    };
    declarations.add_name(&name, slot)
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::*;

    /// Returns the declarations, the notes, and what was left unread.
    fn read_slowly(text: &str) -> (Declarations, String) {
        // The buffer of one byte cuts every word at every place.
        let mut inner = io::BufReader::with_capacity(1, text.as_bytes());
        let read = read(&mut inner, &mut 1, Selection::default()).unwrap_or_else(|_| panic!("{text}"));
        let mut rest = String::new();
        inner.read_to_string(&mut rest).unwrap();
        (read.0, rest)
    }

    #[test]
    fn types_ranges_and_texts_of_other_producers_are_read() {
        let text = "$date $var x$end\n$scope vhdl_architecture a $end\n$var logic 8 ! m [3] [-1:-8] $end $attrbegin $scope $end \
                    $var shortreal 1 # r $end $var port [3:0] <0 d $end $var wire 2 $end e $end $upscope $end\n\
                    $timescale 10\tuS $end $enddefinitions $end\n#0";
        let (declarations, rest) = read_slowly(text);
        let paths: Vec<&str> = declarations.names.iter().map(|named| &*named.path).collect();
        assert_eq!(paths, ["a.m[3]", "a.r", "a.d", "a.e"]);
        assert_eq!(
            declarations.kinds,
            [Kind::Bits(8), Kind::Real, Kind::Bits(4), Kind::Bits(2)]
        );
        assert_eq!(declarations.unit_fs, 10_000_000_000);
        assert!(declarations.notes.is_empty(), "{:?}", declarations.notes);
        assert_eq!(rest, "\n#0");
    }

    #[test]
    fn unusual_declarations_are_read_with_a_note() {
        for (text, path, note) in [
            (
                "$scope module $end $var wire 1 ! a $end $upscope $end $enddefinitions $end ",
                "a",
                "",
            ),
            (
                "$scope signals $end $var wire 1 ! a $end $unscope $end $enddefinitions $end ",
                "signals.a",
                "no type",
            ),
            (
                "$scope module t $end $var wire 1 ! a $end $enddefinitions $end ",
                "t.a",
                "still open",
            ),
            (
                "$upscope $end $var wire 1 ! a $end $enddefinitions $end ",
                "a",
                "without `$scope`",
            ),
            ("$var wire 1 ! a $end #0 ", "a", "without $enddefinitions"),
            ("$var wire 1 ! $end $enddefinitions $end ", "!", "no name"),
        ] {
            let (declarations, _) = read_slowly(text);
            assert_eq!(declarations.names[0].path, path, "{text}");
            let notes = declarations.notes.join("\n");
            assert!(
                notes.contains(note) && notes.is_empty() == note.is_empty(),
                "{text}: {notes}"
            );
        }
    }

    #[test]
    fn unwanted_names_take_no_memory() {
        let mut text = "$scope module t $end ".to_owned();
        for at in 0..1000 {
            // The last has the id code of the first.
            text += &format!("$var wire 64 i{} v{at} [63:0] $end ", at % 999);
        }
        text += "$upscope $end $enddefinitions $end ";
        for (wanted, slots) in [("t.v7", 2), ("t.v999", 2), ("t.v1000", 1)] {
            let selection = Selection(Some(std::sync::Arc::new(move |path, whole| {
                assert_eq!(whole, Some(path));
                Some(path == wanted)
            })));
            let mut input = io::BufReader::new(text.as_bytes());
            let (declarations, ids) = read(&mut input, &mut 1, selection).unwrap_or_else(|_| panic!("{wanted}"));
            let names: Vec<&str> = declarations.names.iter().map(|named| named.path.as_str()).collect();
            assert_eq!(names, if slots == 2 { vec![wanted] } else { Vec::new() });
            assert_eq!(
                (declarations.kinds.len(), declarations.left_out),
                (slots, 1000 - names.len())
            );
            assert_eq!(declarations.kinds[0], Kind::Bits(0), "all the others");
            let id = if wanted == "t.v7" { "i7" } else { "i0" };
            let slot = ids.find(id.as_bytes()).unwrap();
            assert_eq!(declarations.is_unwanted(slot), slots == 1, "{wanted}");
            assert!(ids.find(b"i8").is_some_and(|slot| declarations.is_unwanted(slot)));
        }
    }

    #[test]
    fn timescales_are_numbers_of_units() {
        for (text, fs) in [
            ("1ns", 1_000_000),
            ("100ps", 100_000),
            ("0.5ns", 500_000),
            ("8NS", 8_000_000),
            ("1s", UNITS[0].1),
        ] {
            assert_eq!(unit_fs(text), Ok(fs), "{text}");
        }
        for text in ["", "1", "ns", "1ks", "0ns", "0.5fs", "-1ns"] {
            assert!(unit_fs(text).is_err(), "{text}");
        }
    }
}
