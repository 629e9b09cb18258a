//! Declarations of a waveform file: signals, their widths and names, the unit of time.

use std::collections::HashMap;
use std::sync::Arc;

use crate::wording::counted;

/// Largest number of signals of a file.
pub(super) const MOST_SIGNALS: u64 = 1 << 22;
const NAME_BYTES: usize = 1 << 30;
const DEPTH: usize = 256;
const TOTAL_BITS: u64 = 1 << 27;

/// Returns the message for a file with too many signals.
pub(super) fn too_many_signals() -> String {
    format!("more than {MOST_SIGNALS} signals: dump fewer scopes")
}

/// Type of a signal's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A vector of this many bits; it may have none.
    Bits(u32),
    /// A real number.
    Real,
    /// Text.
    Text,
    /// An event, which happens and has no value.
    Event,
    /// Values of any kind: some were of another kind than declared.
    Any(Declared),
}

/// How a signal of [`Kind::Any`] is declared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Declared {
    /// A vector of this many bits.
    Bits(u32),
    /// A real number.
    Real,
    /// Text.
    Text,
}

impl Kind {
    /// Returns the kind that holds values of any kind in place of this one.
    pub(crate) fn any(self) -> Self {
        match self {
            Self::Bits(width) => Self::Any(Declared::Bits(width)),
            Self::Real => Self::Any(Declared::Real),
            Self::Text => Self::Any(Declared::Text),
            Self::Event | Self::Any(_) => self,
        }
    }
}

/// The part of a vector that is declared: `[7:0]`, or a single bit `[3]`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Range {
    /// Index of the first digit.
    pub(crate) left: i64,
    /// Index of the last digit.
    pub(crate) right: i64,
}

/// A declared signal.
#[derive(Debug, Clone)]
pub(crate) struct Named {
    /// Scopes and name, joined by dots; without the range of a vector, with the index of a single bit.
    pub(crate) path: String,
    /// Slot of its value.
    pub(crate) slot: u32,
    /// The path without the index, and the declared bits, if it is declared as part of a vector.
    pub(crate) part: Option<(String, Range)>,
}

/// Decides from the path of a name, and of the vector it is a part of, whether it is wanted; `None` outside of the root.
pub(crate) type Wanted = Arc<dyn Fn(&str, Option<&str>) -> Option<bool> + Send + Sync>;

/// The wanted names of a file; the others take no memory.
#[derive(Clone, Default)]
pub(crate) struct Selection(pub(crate) Option<Wanted>);

impl std::fmt::Debug for Selection {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if self.0.is_some() { "some" } else { "all" })
    }
}

/// The declarations of a file.
#[derive(Debug, Default)]
pub(crate) struct Declarations {
    /// The signals in the order of the file.
    pub(crate) names: Vec<Named>,
    /// Kind of each slot; names may share a slot.
    pub(crate) kinds: Vec<Kind>,
    /// Number of femtoseconds per unit of the file's time.
    pub(crate) unit_fs: u64,
    /// Whether the file does not say its unit of time.
    pub(crate) unit_is_assumed: bool,
    /// The open scopes, each followed by a dot, and the end of each.
    scope: String,
    scope_ends: Vec<usize>,
    name_bytes: usize,
    bits: u64,
    /// What is unusual in the file and was read nevertheless, with its line.
    pub(crate) notes: Vec<String>,
    selection: Selection,
    /// Number of names that were not wanted, and whether any name was inside of the root.
    pub(crate) left_out: usize,
    pub(crate) root_is_known: bool,
    /// The slot of all signals without a wanted name; it has no bits, so that no change of it is kept.
    unwanted: Option<u32>,
    /// Number of times that a path was declared, and its first slot.
    seen: HashMap<String, (u32, Owner)>,
}

impl Declarations {
    /// Creates empty declarations with this many femtoseconds per unit of time.
    pub(super) fn new(unit_fs: u64, selection: Selection) -> Self {
        Self {
            unit_fs,
            selection,
            ..Self::default()
        }
    }

    pub(crate) fn enter(&mut self, name: &str) -> Result<(), String> {
        if self.scope_ends.len() == DEPTH || self.scope.len() + name.len() > NAME_BYTES {
            return Err(format!("scopes more than {DEPTH} deep: dump fewer scopes"));
        }
        // An unnamed scope (FST has them) adds nothing to the path.
        if !name.is_empty() {
            self.scope.push_str(plain(name));
            self.scope.push('.');
        }
        self.scope_ends.push(self.scope.len());
        Ok(())
    }

    /// Leaves a scope; returns `false` if none is open.
    pub(super) fn leave(&mut self) -> bool {
        let was_open = self.scope_ends.pop().is_some();
        let end = self.scope_ends.last().copied().unwrap_or(0);
        self.scope.truncate(end);
        was_open
    }

    /// Ends the declarations of a file whose scopes need not have been left: their end changes no name.
    pub(super) fn finish_open(&mut self) {
        self.scope_ends.clear();
        self.seen = HashMap::new();
    }

    /// Ends the declarations.
    pub(super) fn finish(&mut self) {
        if !self.scope_ends.is_empty() {
            let open = counted(self.scope_ends.len() as u64, "scope");
            self.notes.push(format!("{open} still open at $enddefinitions"));
        }
        self.seen = HashMap::new();
    }

    /// Adds a note, unless there is one that has `key` in it.
    pub(super) fn note_once(&mut self, key: &str, note: String) {
        if !self.notes.iter().any(|known| known.contains(key)) {
            self.notes.push(note);
        }
    }

    /// Makes a slot, which is declared again with another kind, hold both.
    pub(super) fn merge_kinds(&mut self, slot: u32, kind: Kind) -> Result<(), String> {
        let known = &mut self.kinds[slot as usize];
        match (*known, kind) {
            (Kind::Bits(width), Kind::Bits(other)) => {
                self.bits += u64::from(other.saturating_sub(width));
                *known = Kind::Bits(width.max(other));
                Ok(())
            }
            (Kind::Event, _) | (_, Kind::Event) => {
                Err("an id code is declared twice, once as an event and once as a value".to_owned())
            }
            _ => {
                *known = Kind::Any(Declared::Real);
                Ok(())
            }
        }
    }

    /// Whether nothing has been declared.
    pub(super) fn is_empty(&self) -> bool {
        self.names.is_empty() && self.left_out == 0
    }

    /// Returns whether a name, of a signal of this kind in the open scopes, is wanted; otherwise it is counted as left out.
    pub(super) fn is_wanted(&mut self, name: &str, kind: Kind) -> Result<bool, String> {
        let Some(wanted) = self.selection.0.clone() else {
            return Ok(true);
        };
        let (path, vector, range) = self.path(name, kind);
        let whole = range.is_some().then_some(vector.as_str());
        let answer = wanted(&path, whole);
        self.root_is_known |= answer.is_some();
        if answer == Some(true) {
            return Ok(true);
        }
        self.left_out += 1;
        if self.left_out as u64 > MOST_SIGNALS {
            return Err(too_many_signals());
        }
        Ok(false)
    }

    /// Returns the slot of signals without a wanted name.
    pub(super) fn unwanted_slot(&mut self) -> Result<u32, String> {
        if let Some(slot) = self.unwanted {
            return Ok(slot);
        }
        let slot = self.add_slot(Kind::Bits(0))?;
        self.unwanted = Some(slot);
        Ok(slot)
    }

    /// Whether a slot is that of signals without a wanted name.
    pub(super) fn is_unwanted(&self, slot: u32) -> bool {
        self.unwanted == Some(slot)
    }

    /// Returns the path of a name in the open scopes, that of the vector if it is a part of one, and the declared bits.
    fn path(&self, name: &str, kind: Kind) -> (String, String, Option<Range>) {
        let width = match kind {
            Kind::Bits(width) => u64::from(width),
            Kind::Real | Kind::Text | Kind::Event | Kind::Any(_) => 0,
        };
        let whole_name = plain(name);
        let (name, range) = split_range(whole_name, width);
        let vector = format!("{}{name}", self.scope);
        let path = match range {
            // With the brackets that the file has.
            Some(Range { left, right }) if left == right => {
                if whole_name.ends_with(']') {
                    format!("{vector}[{left}]")
                } else {
                    format!("{}{whole_name}", self.scope)
                }
            }
            _ => vector.clone(),
        };
        (path, vector, range)
    }

    /// Adds a value of `kind`; returns its slot.
    pub(crate) fn add_slot(&mut self, kind: Kind) -> Result<u32, String> {
        let bits = match kind {
            Kind::Bits(width) => u64::from(width),
            Kind::Real | Kind::Text | Kind::Event | Kind::Any(_) => 64,
        };
        self.bits += bits;
        if self.bits > TOTAL_BITS {
            return Err(format!(
                "the signals have more than {TOTAL_BITS} bits together: leave out memories and wide arrays when dumping"
            ));
        }
        self.kinds.push(kind);
        Ok(self.kinds.len() as u32 - 1)
    }

    /// Adds a name for a slot, in the open scopes. If it was declared before for the same slot and range, nothing happens.
    pub(crate) fn add_name(&mut self, name: &str, slot: u32) -> Result<(), String> {
        let (mut path, vector, range) = self.path(name, self.kinds[slot as usize]);
        self.name_bytes += vector.len();
        if self.name_bytes > NAME_BYTES {
            return Err(format!("more than {NAME_BYTES} bytes of names: dump fewer scopes"));
        }
        if self.names.len() as u64 == MOST_SIGNALS {
            return Err(too_many_signals());
        }
        let own = Owner { slot, range };
        let (count, first) = self.seen.entry(path.clone()).or_insert((0, own));
        *count += 1;
        if *count > 1 && first.is(own) {
            return Ok(());
        }
        if *count > 1 {
            // Equal names are distinguished by their range, or else by their order, so that neither is lost.
            path = match range {
                Some(Range { left, right }) if left != right => format!("{vector}[{left}:{right}]"),
                _ => format!("{path}#{count}"),
            };
            // Parts of a vector may have the same identifier: each is a name, once.
            if self
                .seen
                .insert(path.clone(), (1, own))
                .is_some_and(|(_, before)| before.is(own))
            {
                return Ok(());
            }
        }
        let part = range.map(|range| (vector, range));
        self.names.push(Named { path, slot, part });
        Ok(())
    }
}

/// What a name was declared for.
#[derive(Debug, Clone, Copy)]
struct Owner {
    slot: u32,
    range: Option<Range>,
}

impl Owner {
    /// Whether it is the same signal; a declaration without a range fits any.
    fn is(self, other: Self) -> bool {
        let ranges = self.range.zip(other.range);
        self.slot == other.slot && ranges.is_none_or(|(one, two)| one == two)
    }
}

/// Returns the plain form of an escaped name that needs no escape.
fn plain(name: &str) -> &str {
    name.strip_prefix('\\').unwrap_or(name)
}

/// Cuts `[7:0]` off the name of a vector, and `[3]` off that of a single bit; also `(7 downto 0)`, `(3)` and `<3>`, as
/// tools for VHDL and netlists write them. A range that does not have the signal's width does not describe its bits.
fn split_range(name: &str, width: u64) -> (&str, Option<Range>) {
    let bracket = match name.as_bytes().last() {
        Some(b']') => '[',
        Some(b')') => '(',
        Some(b'>') => '<',
        _ => return (name, None),
    };
    let Some(at) = name.rfind(bracket).filter(|at| *at > 0) else {
        return (name, None);
    };
    let inside = &name[at + 1..name.len() - 1];
    let cut = [":", " downto ", " to "]
        .into_iter()
        .find_map(|between| inside.split_once(between));
    let (left, right) = cut.unwrap_or((inside, inside));
    match (left.trim().parse::<i64>(), right.trim().parse::<i64>()) {
        (Ok(left), Ok(right)) if left.abs_diff(right).checked_add(1) == Some(width) => {
            (name[..at].trim_end(), Some(Range { left, right }))
        }
        _ if cut.is_some() && bracket == '[' => (&name[..at], None),
        _ => (name, None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_leave_the_name_and_indices_stay() {
        let mut declarations = Declarations::default();
        let byte = declarations.add_slot(Kind::Bits(8)).unwrap();
        let bit = declarations.add_slot(Kind::Bits(1)).unwrap();
        let other = declarations.add_slot(Kind::Bits(8)).unwrap();
        declarations.enter("t").unwrap();
        for (name, slot) in [
            ("y[7:0]", byte),
            ("\\y", byte),
            ("y[3]", bit),
            ("y[15:8]", other),
            ("array[3]", other),
            ("array[3][7:0]", byte),
            ("odd[x]", byte),
            ("wrong[9:0]", byte),
            ("word(7 downto 0)", byte),
            ("word(2)", bit),
            ("net<-1>", bit),
            ("call(x)", bit),
        ] {
            declarations.add_name(name, slot).unwrap();
        }
        let paths: Vec<&str> = declarations.names.iter().map(|n| n.path.as_str()).collect();
        let expected = [
            "t.y",
            "t.y[3]",
            "t.y[15:8]",
            "t.array[3]",
            "t.array[3][7:0]",
            "t.odd[x]",
            "t.wrong",
            "t.word",
            "t.word(2)",
            "t.net<-1>",
            "t.call(x)",
        ];
        assert_eq!(paths, expected);
        let part = |at: usize| declarations.names[at].part.clone();
        assert_eq!(part(9), Some(("t.net".to_owned(), Range { left: -1, right: -1 })));
        assert_eq!(part(10), None);
    }

    #[test]
    fn parts_of_a_vector_with_one_identifier_are_two_names() {
        let mut declarations = Declarations::default();
        let nibble = declarations.add_slot(Kind::Bits(4)).unwrap();
        for name in ["a[7:4]", "a[3:0]", "a[3:0]", "a[7:4]", "a"] {
            declarations.add_name(name, nibble).unwrap();
        }
        let parts = declarations.names.iter().map(|name| (name.path.as_str(), name.slot));
        assert_eq!(parts.collect::<Vec<_>>(), [("a", nibble), ("a[3:0]", nibble)]);
    }
}
