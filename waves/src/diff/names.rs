//! The names of a file for the comparison: below the root, filtered, with vectors assembled that are written bit by
//! bit.
//!
//! Producers write the same name in different ways. If exact names do not match, [`canonical`] ones may:
//!
//! | written | by | canonical |
//! |---|---|---|
//! | `dut.a$step`, `dut.a__step`, `dut.a__DOT__step` | RustHDL, its Verilog, Verilator | `dut.a.step` |
//! | `mem(3)`, `mem<3>`, `mem__BRA__3__KET__` | VHDL, Yosys, Verilator | `mem[3]` |
//! | `Count`, `count` | Verilog, GHDL | `count` |

use std::collections::BTreeMap;
use std::sync::Arc;

use super::parts::Shape;
use super::pattern::Pattern;
use crate::WaveError;
use crate::reader::{Declarations, Kind, Range, Selection};

/// A signal that may find a partner.
#[derive(Debug, Clone)]
pub(super) struct Entry {
    /// Name below the root.
    pub(super) path: String,
    /// Full name.
    pub(super) full: String,
    /// Its slot; that of the first part, if it is a vector in parts.
    pub(super) slot: u32,
    /// Its bits, if it has any.
    pub(super) shape: Option<Shape>,
    /// Full name of the vector it belongs to, if the file has that vector only in parts.
    pub(super) part_of: Option<Box<str>>,
}

impl Entry {
    /// Whether it is a vector that the file has only in parts.
    pub(super) fn is_in_parts(&self) -> bool {
        matches!(self.shape, Some(Shape::Parts(_)))
    }
}

/// The names of one file.
#[derive(Debug, Default)]
pub(super) struct Names {
    pub(super) entries: Vec<Entry>,
    /// Names of the file that do not take part.
    pub(super) left_out: usize,
}

/// Selection of the names of a file that take part.
pub(super) struct Filter {
    only: Vec<Pattern>,
    ignore: Vec<Pattern>,
}

/// Returns whether the pattern means the signal, or a scope above it.
fn takes(pattern: &Pattern, path: &str) -> bool {
    let mut scopes = path.match_indices('.').map(|(at, _)| &path[..at]);
    pattern.fits(path) || (!pattern.has_wildcards() && scopes.any(|scope| pattern.fits(scope)))
}

impl Filter {
    pub(super) fn new(only: &[String], ignore: &[String]) -> Result<Self, WaveError> {
        let patterns = |texts: &[String]| {
            texts
                .iter()
                .map(|text| Pattern::new(text))
                .collect::<Result<Vec<_>, WaveError>>()
        };
        Ok(Self {
            only: patterns(only)?,
            ignore: patterns(ignore)?,
        })
    }

    fn takes(&self, path: &str) -> bool {
        (self.only.is_empty() || self.only.iter().any(|pattern| takes(pattern, path))) && self.keeps(path)
    }

    /// Whether it takes a signal, which may be a part of a vector.
    fn takes_part(&self, path: &str, whole: Option<&str>) -> bool {
        self.takes(path) && whole.is_none_or(|whole| self.keeps(whole))
            || whole.is_some_and(|whole| self.takes(whole) && self.keeps(path))
    }

    fn keeps(&self, path: &str) -> bool {
        !self.ignore.iter().any(|pattern| takes(pattern, path))
    }
}

/// Returns the names of a file that the filter may take; the others need not be kept. A pattern that may mean how equal names
/// are distinguished is left to [`Names::new`].
pub(super) fn selection(root: Option<&str>, only: &[String], ignore: &[String]) -> Result<Selection, WaveError> {
    let by_number = only.iter().chain(ignore).any(|pattern| pattern.contains(['#', ':']));
    if by_number || root.is_none() && only.is_empty() && ignore.is_empty() {
        return Ok(Selection::default());
    }
    let filter = Filter::new(only, ignore)?;
    let root = root.map(str::to_owned);
    Ok(Selection(Some(Arc::new(move |path, whole| {
        let below = |path| below(root.as_deref(), path);
        Some(filter.takes_part(below(path)?, whole.and_then(below)))
    }))))
}

/// Returns the path below the root.
fn below<'a>(root: Option<&str>, path: &'a str) -> Option<&'a str> {
    match root {
        None => Some(path),
        Some(root) => path.strip_prefix(root)?.strip_prefix('.'),
    }
}

impl Names {
    /// Takes the names below `root` that pass the filter, and adds the vectors that exist only in parts.
    pub(super) fn new(
        declarations: &Declarations,
        root: Option<&str>,
        filter: &Filter,
        file: &str,
    ) -> Result<Self, WaveError> {
        let below = |path: &str| below(root, path).map(str::to_owned);
        let mut known = declarations.root_is_known;
        let mut taken: Vec<(usize, String)> = Vec::new();
        let mut vectors: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for (at, named) in declarations.names.iter().enumerate() {
            let Some(path) = below(&named.path) else { continue };
            known = true;
            // A part also goes by the name of the whole vector.
            let whole = named.part.as_ref().and_then(|(vector, _)| below(vector));
            if filter.takes_part(&path, whole.as_deref()) {
                taken.push((at, path));
                if let Some((vector, _)) = &named.part {
                    vectors.entry(vector.clone()).or_default().push(at);
                }
            }
        }
        if let (Some(root), false) = (root, known) {
            return Err(WaveError::Option(format!(
                "the {file} file has no scope `{root}` to be the root"
            )));
        }
        let parts: BTreeMap<String, Vec<(u32, Range)>> = vectors
            .into_iter()
            .filter_map(|(vector, members)| Some((vector, parts(declarations, &members)?)))
            .collect();
        let mut names = Self {
            left_out: declarations.left_out + declarations.names.len() - taken.len(),
            ..Self::default()
        };
        for (at, mut path) in taken {
            let named = &declarations.names[at];
            let mut full = named.path.clone();
            let range = named.part.as_ref().map(|(_, range)| *range);
            let shape = match declarations.kinds[named.slot as usize] {
                Kind::Bits(width @ 1..) => Some(Shape::Whole {
                    slot: named.slot,
                    width,
                    range,
                }),
                _ => None,
            };
            let part = named.part.as_ref().filter(|(vector, _)| parts.contains_key(vector));
            // The first part of a vector has the name of the whole vector.
            if let Some((vector, range)) = part
                && *vector == full
            {
                let range = format!("[{}:{}]", range.left, range.right);
                path.push_str(&range);
                full.push_str(&range);
            }
            names.entries.push(Entry {
                path,
                full,
                slot: named.slot,
                shape,
                part_of: part.map(|(vector, _)| vector.as_str().into()),
            });
        }
        for (vector, parts) in parts {
            if let (Some((slot, _)), Some(path)) = (parts.first().copied(), below(&vector)) {
                names.entries.push(Entry {
                    path,
                    full: vector,
                    slot,
                    shape: Some(Shape::Parts(parts)),
                    part_of: None,
                });
            }
        }
        Ok(names)
    }
}

/// Returns the parts of a vector, if the file has it only in parts: no part contains all the others, and no two overlap.
fn parts(declarations: &Declarations, members: &[usize]) -> Option<Vec<(u32, Range)>> {
    let mut parts = Vec::new();
    for at in members {
        let named = &declarations.names[*at];
        let (vector, range) = named.part.as_ref()?;
        // A vector that the file declares once, as a whole, is not a part.
        if members.len() == 1 && *vector == named.path
            || !matches!(declarations.kinds[named.slot as usize], Kind::Bits(_))
        {
            return None;
        }
        parts.push((named.slot, *range));
    }
    let ends = |range: &Range| (range.left.min(range.right), range.left.max(range.right));
    let mut ordered: Vec<(i64, i64)> = parts.iter().map(|(_, range)| ends(range)).collect();
    ordered.sort_unstable();
    let is_apart = ordered.windows(2).all(|pair| pair[0].1 < pair[1].0);
    is_apart.then_some(parts)
}

/// Returns the common form of a name; see the module documentation.
pub(super) fn canonical(path: &str) -> String {
    let path = path.to_ascii_lowercase();
    let plain = path
        .replace("__dot__", ".")
        .replace("__bra__", "[")
        .replace("__ket__", "]")
        .replace("__", ".")
        .replace('$', ".")
        .replace(['(', '<'], "[")
        .replace([')', '>'], "]")
        .replace(['\\', ' '], "");
    let parts: Vec<&str> = plain.split('.').filter(|part| !part.is_empty()).collect();
    parts.join(".")
}

pub(super) fn last_part(path: &str) -> &str {
    path.rsplit('.').next().unwrap_or(path)
}

/// Returns whether a reset's name indicates that it is active low.
pub(super) fn is_low_active(name: &str) -> bool {
    let name = last_part(name).to_ascii_lowercase();
    name.ends_with("_n") || name.ends_with("resetn") || name.ends_with("rstn") || name.ends_with("_b")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equivalent_names_have_one_canonical_form() {
        for written in [
            "dut.a$mem[3]",
            "DUT.a__mem(3)",
            "dut.\\a__DOT__mem__BRA__3__KET__ ",
            "dut.a.mem<3>",
        ] {
            assert_eq!(canonical(written), "dut.a.mem[3]");
        }
    }

    #[test]
    fn a_root_and_filters_select_names() {
        let mut declarations = Declarations::default();
        let slot = declarations.add_slot(Kind::Bits(8)).unwrap();
        for (scope, names) in [("tb", ["clk", "y"]), ("dut", ["y", "z"])] {
            declarations.enter(scope).unwrap();
            for name in names {
                declarations.add_name(name, slot).unwrap();
            }
        }
        let paths = |root: Option<&str>, only: &[&str], ignore: &[&str], declarations: &Declarations| {
            let owned = |texts: &[&str]| texts.iter().map(|t| (*t).to_owned()).collect::<Vec<_>>();
            let filter = Filter::new(&owned(only), &owned(ignore)).unwrap();
            let names = Names::new(declarations, root, &filter, "first")?;
            Ok::<Vec<String>, WaveError>(names.entries.into_iter().map(|e| e.path).collect())
        };
        let all = &declarations;
        assert_eq!(paths(Some("tb.dut"), &[], &[], all).unwrap(), ["y", "z"]);
        assert_eq!(paths(None, &["dut"], &["z"], all).unwrap(), ["tb.dut.y"]);
        assert_eq!(paths(None, &["tb.*"], &[], all).unwrap(), ["tb.clk", "tb.y"]);
        assert!(paths(Some("dut"), &[], &[], all).is_err());
    }
}
