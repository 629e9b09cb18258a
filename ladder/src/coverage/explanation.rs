//! Explanations of what is not reached: the table `ladder/coverage/holes.txt`.
//!
//! ```text
//! BLOCK | MODULE | line, toggle, condition or bin | WHAT | reason
//! ```
//!
//! Block (with its instance), module and what are patterns: `*` stands for any characters, `?` for one. What is a line's
//! text in the Verilog, a net with its bit, a term with its value and its condition, or the name of a bin; `not if (…)` is an `if` that was always true. A net's bits
//! are a list, as in `count[0,4,24-31]`. Lines that begin with `#` are comments.

use std::fmt;

use super::point::CoveragePoint;
use posicast_testbench::Error;

/// The project's table.
const TABLE: &str = include_str!("../../coverage/holes.txt");

/// A coverage point that was not reached.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Hole {
    /// Name of the module; for a bin, of the block.
    pub module: String,
    /// Kind: `line`, `toggle`, `condition` or `bin`.
    pub kind: &'static str,
    /// Description of the point.
    pub what: String,
}

impl Hole {
    pub(super) fn of_point(point: &CoveragePoint) -> Self {
        Self {
            module: point.module.clone(),
            kind: point.kind.name(),
            what: point.what.clone(),
        }
    }

    pub(super) fn of_bin(block: &str, bin: &str) -> Self {
        Self {
            module: block.to_owned(),
            kind: "bin",
            what: bin.to_owned(),
        }
    }
}

impl fmt::Display for Hole {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} | {} | {}", self.module, self.kind, self.what)
    }
}

/// A row of the table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Explanation {
    block: String,
    module: String,
    kind: String,
    what: String,
    reason: String,
}

impl Explanation {
    /// Whether the explanation applies to this block, by name and instance.
    pub fn concerns(&self, block: &str) -> bool {
        fits(&self.block, block)
    }

    /// Whether the explanation covers this hole of this block.
    pub fn explains(&self, block: &str, hole: &Hole) -> bool {
        self.concerns(block) && self.kind == hole.kind && fits(&self.module, &hole.module) && self.names(&hole.what)
    }

    fn names(&self, what: &str) -> bool {
        let bits = |text: &str| {
            let (net, bits) = text.strip_suffix(']')?.rsplit_once('[')?;
            Some((net.to_owned(), bits.to_owned()))
        };
        match (self.kind.as_str(), bits(&self.what), bits(what)) {
            ("toggle", Some((pattern, list)), Some((net, bit))) => {
                let has = |bit: u32| list.split(',').any(|part| is_among(part, bit));
                fits(&pattern, &net) && bit.parse().is_ok_and(has)
            }
            _ => fits(&self.what, what),
        }
    }

    /// Why the point cannot be reached, or need not be.
    pub fn reason(&self) -> &str {
        &self.reason
    }
}

impl fmt::Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} | {} | {} | {}", self.block, self.module, self.kind, self.what)
    }
}

/// The project's table.
///
/// # Errors
/// [`Error::Option`] where a row does not have the format above.
pub fn all() -> Result<Vec<Explanation>, Error> {
    parse(TABLE)
}

/// Parses a table.
///
/// # Errors
/// Those of [`all`].
pub fn parse(table: &str) -> Result<Vec<Explanation>, Error> {
    let rows = table.lines().zip(1..);
    let rows = rows.filter(|(row, _)| !row.trim().is_empty() && !row.starts_with('#'));
    rows.map(|(row, number)| {
        // The description of the point may contain a bar.
        let mut front = row.splitn(4, " | ").map(str::trim);
        let mut next = || front.next().filter(|cell| !cell.is_empty()).map(str::to_owned);
        let cells = (|| Some((next()?, next()?, next()?, next()?)))();
        let found = cells.and_then(|(block, module, kind, rest)| {
            let (what, reason) = rest.rsplit_once(" | ")?;
            let known = ["line", "toggle", "condition", "bin"].contains(&kind.as_str());
            // If the reason ends with a bar it is empty.
            (known && !reason.ends_with('|')).then(|| Explanation {
                what: what.trim().to_owned(),
                reason: reason.trim().to_owned(),
                block,
                module,
                kind,
            })
        });
        let wanted = "BLOCK | MODULE | line, toggle, condition or bin | WHAT | reason";
        found.ok_or_else(|| Error::Option(format!("holes.txt:{number}: `{row}` is not `{wanted}`")))
    })
    .collect()
}

/// Whether `part` is this number, or a range that contains it.
fn is_among(part: &str, bit: u32) -> bool {
    let (low, high) = part.split_once('-').unwrap_or((part, part));
    match (low.trim().parse::<u32>(), high.trim().parse::<u32>()) {
        (Ok(low), Ok(high)) => (low..=high).contains(&bit),
        _ => false,
    }
}

/// Whether a text matches a pattern.
fn fits(pattern: &str, text: &str) -> bool {
    let (pattern, text) = (pattern.as_bytes(), text.as_bytes());
    let (mut at, mut read) = (0, 0);
    // Position at which the last `*` takes one more character.
    let mut retry: Option<(usize, usize)> = None;
    while read < text.len() {
        match pattern.get(at) {
            Some(b'*') => {
                retry = Some((at + 1, read));
                at += 1;
            }
            Some(c) if *c == b'?' || *c == text[read] => {
                at += 1;
                read += 1;
            }
            _ => match &mut retry {
                Some((after, from)) => {
                    *from += 1;
                    (at, read) = (*after, *from);
                }
                None => return false,
            },
        }
    }
    pattern[at..].iter().all(|c| *c == b'*')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_star_matches_any_text_and_other_characters_themselves() {
        for (pattern, text, fit) in [
            ("*", "", true),
            ("a*c", "abcbc", true),
            ("a*c", "abcb", false),
            ("x[?]", "x[3]", true),
            ("x[?]", "x[31]", false),
            ("x", "xy", false),
            ("", "", true),
        ] {
            assert_eq!(fits(pattern, text), fit, "{pattern} {text}");
        }
    }

    #[test]
    fn a_bit_list_matches_its_numbers_and_ranges() {
        let rows = parse("b | m | toggle | *count[0,4,24-31] | slow").unwrap();
        let hole = |what: &str| Hole {
            module: "m".to_owned(),
            kind: "toggle",
            what: what.to_owned(),
        };
        for (what, fit) in [
            ("count[4]", true),
            ("a_count[31]", true),
            ("count[5]", false),
            ("count", false),
        ] {
            assert_eq!(rows[0].explains("b", &hole(what)), fit, "{what}");
        }
    }

    #[test]
    fn rows_are_read_and_others_refused() {
        let rows = parse("# a comment\n\nb * | m | line | if (a | b) | tied | \n").unwrap_err();
        assert!(rows.to_string().contains("holes.txt:3"), "{rows}");
        let rows = parse("b * | m | line | if (a | b) | tied low").unwrap();
        let hole = Hole {
            module: "m".to_owned(),
            kind: "line",
            what: "if (a | b)".to_owned(),
        };
        assert!(rows[0].explains("b alone", &hole) && !rows[0].explains("c alone", &hole));
        assert_eq!(rows[0].reason(), "tied low");
        for wrong in ["b | m | line | x", "b | m | word | x | y", "b | m"] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
        assert!(!all().unwrap().is_empty());
    }
}
