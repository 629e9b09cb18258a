//! Converts the declarations of every producer into the words that the crate `vcd` knows.
//!
//! | producer writes | becomes |
//! |---|---|
//! | `$var logic`, `int`, `port`, … | `$var wire`; `shortreal`, `realtime`, `real_parameter`: `real` |
//! | `$scope struct`, `interface`, `vhdl_architecture`, … | `$scope module` |
//! | `data [7:0]`, `data [-1:-8]`, `memory [3] [7:0]` | `data[7:0]` …: the range stays with the name |
//! | `$date`, `$version`, `$comment`, `$attrbegin`, any other `$word` | nothing; its text may hold whatever it likes |
//! | bytes that are not UTF-8 | U+FFFD |
//!
//! It stops right after `$enddefinitions $end`, so that the value changes can be read from there. Line breaks stay
//! where they are, so that the parser's line numbers are correct.

use std::io::{self, BufRead, Read};

/// Largest number of bytes in a word of the declarations.
const WORD_BYTES: usize = 1 << 20;

const VAR_TYPES: [&[u8]; 18] = [
    b"event",
    b"integer",
    b"parameter",
    b"real",
    b"reg",
    b"supply0",
    b"supply1",
    b"time",
    b"tri",
    b"triand",
    b"trior",
    b"trireg",
    b"tri0",
    b"tri1",
    b"wand",
    b"wire",
    b"wor",
    b"string",
];
const REAL_TYPES: [&[u8]; 3] = [b"shortreal", b"realtime", b"real_parameter"];
const SCOPE_TYPES: [&[u8]; 5] = [b"module", b"task", b"function", b"begin", b"fork"];

/// Kind of the next word of a command.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    /// Outside any command.
    Between,
    /// The type after `$var` or `$scope`.
    VarType,
    ScopeType,
    /// Width, id code and name, counted down, then the range.
    Var(u8),
    /// Any other word of a command that the parser reads.
    Inside,
    /// After `$enddefinitions`.
    Last,
    /// Text that is ignored, up to `$end`.
    Text,
    Done,
}

/// Reads the declarations in converted words.
pub(super) struct Dialect<'a, R> {
    inner: &'a mut R,
    place: Place,
    /// The current word.
    word: Vec<u8>,
    /// Output for the parser, and how much of it has been taken.
    out: Vec<u8>,
    taken: usize,
}

impl<'a, R: BufRead> Dialect<'a, R> {
    pub(super) fn new(inner: &'a mut R) -> Self {
        Self {
            inner,
            place: Place::Between,
            word: Vec::new(),
            out: Vec::new(),
            taken: 0,
        }
    }

    /// Converts the next word with the space before it.
    fn translate(&mut self) -> io::Result<()> {
        self.word.clear();
        let mut lines = 0usize;
        loop {
            let buffer = self.inner.fill_buf()?;
            if buffer.is_empty() {
                break;
            }
            let space = buffer.iter().take_while(|b| b.is_ascii_whitespace()).count();
            if self.word.is_empty() && space > 0 {
                lines += buffer[..space].iter().filter(|b| **b == b'\n').count();
                self.inner.consume(space);
                continue;
            }
            if space > 0 {
                break;
            }
            let length = buffer.iter().take_while(|b| !b.is_ascii_whitespace()).count();
            if self.word.len() + length > WORD_BYTES {
                return Err(io::Error::other(format!(
                    "a word of the declarations is longer than {WORD_BYTES} bytes: the file is damaged"
                )));
            }
            let ends = length < buffer.len();
            self.word.extend_from_slice(&buffer[..length]);
            self.inner.consume(length);
            if ends {
                break;
            }
        }
        self.out.resize(lines, b'\n');
        if !self.word.is_ascii() {
            self.word = String::from_utf8_lossy(&self.word).into_owned().into_bytes();
        }
        self.put();
        Ok(())
    }

    fn put(&mut self) {
        let word: &[u8] = &self.word;
        let mut space = true;
        let (written, next): (&[u8], Place) = match (self.place, word) {
            (_, b"") => (b"", self.place),
            (Place::Text, b"$end") => (b"", Place::Between),
            (Place::Text, text) => {
                // Some writers put no space before it.
                let ends = text.ends_with(b"$end");
                (b"", if ends { Place::Between } else { Place::Text })
            }
            (Place::Last, word) => (word, Place::Done),
            (Place::Between, b"$var") => (word, Place::VarType),
            (Place::Between, b"$scope") => (word, Place::ScopeType),
            (Place::Between, b"$upscope" | b"$timescale") => (word, Place::Inside),
            (Place::Between, b"$enddefinitions") => (word, Place::Last),
            // This is a value change, not a declaration: the parser reports it as such.
            (Place::Between, b"$end" | b"$dumpvars" | b"$dumpall" | b"$dumpon" | b"$dumpoff") => (word, Place::Between),
            (Place::Between, word) if word.starts_with(b"$") => (b"", Place::Text),
            (Place::Between, word) => (word, Place::Between),
            (_, b"$end") => (word, Place::Between),
            (Place::VarType, word) => (var_type(word), Place::Var(3)),
            (Place::ScopeType, word) if SCOPE_TYPES.contains(&word) => (word, Place::Inside),
            (Place::ScopeType, _) => (b"module", Place::Inside),
            (Place::Var(0), range) => {
                space = !range.starts_with(b"[");
                (range, Place::Var(0))
            }
            (Place::Var(left), word) => (word, Place::Var(left - 1)),
            (Place::Inside | Place::Done, word) => (word, self.place),
        };
        // After the last word the parser waits for a space, which must not come from the value changes.
        if space && !written.is_empty() {
            self.out.push(b' ');
        }
        self.out.extend_from_slice(written);
        if next == Place::Done {
            self.out.push(b' ');
        }
        self.place = next;
    }
}

fn var_type(word: &[u8]) -> &[u8] {
    if VAR_TYPES.contains(&word) {
        word
    } else if REAL_TYPES.contains(&word) {
        b"real"
    } else {
        b"wire"
    }
}

impl<R: BufRead> BufRead for Dialect<'_, R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        while self.taken == self.out.len() && self.place != Place::Done {
            self.out.clear();
            self.taken = 0;
            self.translate()?;
            if self.word.is_empty() {
                break;
            }
        }
        Ok(&self.out[self.taken..])
    }

    fn consume(&mut self, count: usize) {
        self.taken += count;
    }
}

impl<R: BufRead> Read for Dialect<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(buffer)?;
        self.consume(count);
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn translated(text: &str) -> (String, String) {
        // It reads one byte at a time, so that every word is cut everywhere.
        let mut inner = io::BufReader::with_capacity(1, text.as_bytes());
        let mut out = String::new();
        Dialect::new(&mut inner).read_to_string(&mut out).unwrap();
        let mut rest = String::new();
        inner.read_to_string(&mut rest).unwrap();
        (out, rest)
    }

    #[test]
    fn unit_types_ranges_and_texts_of_other_producers_become_plain() {
        let text = "$date $var x$end\n$scope vhdl_architecture a $end\n$var logic 8 ! m [3] [-1:-8] $end $attrbegin $scope $end \
                    $var shortreal 1 # r $end $enddefinitions $end\n#0";
        let (out, rest) = translated(text);
        assert_eq!(
            out,
            "\n $scope module a $end\n $var wire 8 ! m[3][-1:-8] $end $var real 1 # r $end $enddefinitions $end "
        );
        assert_eq!(rest, "\n#0");
    }
}
