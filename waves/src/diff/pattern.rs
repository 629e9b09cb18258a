//! Names with wildcards, as `--map`, `--only`, `--tolerance` and similar options accept them.
//!
//! | in a pattern | stands for |
//! |---|---|
//! | `*` | any characters but a dot |
//! | `**` | any characters, dots too |
//! | `?` | one character but a dot |
//! | anything else, brackets too | itself |
//!
//! A pattern fits a whole path, or its end after a dot.

use crate::WaveError;
use crate::wording::counted;

/// Largest number of wildcards; the time to match a name grows with each.
const WILDCARDS: usize = 8;

#[derive(Debug, Clone, PartialEq)]
enum Piece {
    Text(String),
    One,
    Within,
    Across,
}

/// A name that may have wildcards.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pattern {
    pieces: Vec<Piece>,
    wildcards: usize,
}

impl Pattern {
    pub(super) fn new(text: &str) -> Result<Self, WaveError> {
        let mut pieces: Vec<Piece> = Vec::new();
        let mut characters = text.chars().peekable();
        while let Some(character) = characters.next() {
            match character {
                '*' if characters.next_if_eq(&'*').is_some() => pieces.push(Piece::Across),
                '*' => pieces.push(Piece::Within),
                '?' => pieces.push(Piece::One),
                other => match pieces.last_mut() {
                    Some(Piece::Text(text)) => text.push(other),
                    _ => pieces.push(Piece::Text(other.to_string())),
                },
            }
        }
        let wildcards = pieces.iter().filter(|p| !matches!(p, Piece::Text(_))).count();
        if wildcards > WILDCARDS {
            return Err(WaveError::Option(format!(
                "`{text}` has {}; {WILDCARDS} are allowed",
                counted(wildcards as u64, "wildcard")
            )));
        }
        Ok(Self { pieces, wildcards })
    }

    pub(super) fn has_wildcards(&self) -> bool {
        self.wildcards > 0
    }

    pub(super) fn wildcards(&self) -> usize {
        self.wildcards
    }

    /// Returns what the wildcards stand for if the pattern fits all of `name`.
    pub(super) fn whole<'a>(&self, name: &'a str) -> Option<Vec<&'a str>> {
        let mut captured = Vec::new();
        capture(&self.pieces, name, &mut captured).then_some(captured)
    }

    /// Returns whether the pattern fits `path`, or its end after a dot.
    pub(super) fn fits(&self, path: &str) -> bool {
        let ends = path.match_indices('.').map(|(at, _)| &path[at + 1..]);
        std::iter::once(path).chain(ends).any(|name| self.whole(name).is_some())
    }

    /// Returns the name in which the wildcards are replaced by `captured`, which must have as many entries.
    pub(super) fn filled(&self, captured: &[&str]) -> String {
        let mut captured = captured.iter();
        let pieces = self.pieces.iter().map(|piece| match piece {
            Piece::Text(text) => text.as_str(),
            _ => captured.next().copied().unwrap_or(""),
        });
        pieces.collect()
    }
}

fn capture<'a>(pieces: &[Piece], name: &'a str, captured: &mut Vec<&'a str>) -> bool {
    let Some((first, rest)) = pieces.split_first() else {
        return name.is_empty();
    };
    match first {
        Piece::Text(text) => name
            .strip_prefix(text.as_str())
            .is_some_and(|name| capture(rest, name, captured)),
        Piece::One => name.chars().next().filter(|c| *c != '.').is_some_and(|c| {
            let (one, name) = name.split_at(c.len_utf8());
            captured.push(one);
            capture(rest, name, captured) || captured.pop().is_none()
        }),
        Piece::Within | Piece::Across => {
            let reach = match first {
                Piece::Within => name.find('.').unwrap_or(name.len()),
                _ => name.len(),
            };
            let cuts = name.char_indices().map(|(at, _)| at).chain([name.len()]);
            for at in cuts.take_while(|at| *at <= reach) {
                captured.push(&name[..at]);
                if capture(rest, &name[at..], captured) {
                    return true;
                }
                captured.pop();
            }
            false
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fits(pattern: &str, path: &str) -> bool {
        Pattern::new(pattern).unwrap().fits(path)
    }

    #[test]
    fn wildcards_stay_within_a_scope_unless_doubled() {
        assert!(fits("dut.*_q", "top.dut.count_q"));
        assert!(!fits("dut.*_q", "top.dut.inner.count_q"));
        assert!(fits("dut.**_q", "top.dut.inner.count_q"));
        assert!(fits("y[?]", "t.y[3]") && !fits("y[?]", "t.y[31]"));
        assert!(fits("y", "t.y") && !fits("y", "t.my") && !fits("t", "t.y"));
        assert!(Pattern::new("*a*b*c*d*e*f*g*h*i").is_err());
    }

    #[test]
    fn captured_text_fills_the_wildcards_of_the_other_name() {
        let (from, to) = (Pattern::new("*.*_reg").unwrap(), Pattern::new("core.*.q_*").unwrap());
        let captured = from.whole("dut.count_reg").unwrap();
        assert_eq!(to.filled(&captured), "core.dut.q_count");
    }
}
