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

use std::collections::{BTreeMap, HashSet};

use super::pattern::Pattern;
use crate::WaveError;
use crate::reader::{Declarations, Kind};

/// A signal that may find a partner.
#[derive(Debug, Clone)]
pub(super) struct Entry {
    /// Name below the root.
    pub(super) path: String,
    /// Full name.
    pub(super) full: String,
    pub(super) slot: u32,
    /// Index in [`Names::groups`], if it is assembled from parts.
    pub(super) group: Option<usize>,
}

/// A vector assembled from signals that are its parts.
#[derive(Debug, Clone)]
pub(super) struct Group {
    /// Slot of the whole vector, after those of the file.
    pub(super) slot: u32,
    /// Slot of each part, its width, and the position of its last digit, where index 0 or the lowest index is the
    /// least significant bit.
    pub(super) parts: Vec<(u32, u32, u32)>,
}

/// The names of one file.
#[derive(Debug, Default)]
pub(super) struct Names {
    pub(super) entries: Vec<Entry>,
    pub(super) groups: Vec<Group>,
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

    fn keeps(&self, path: &str) -> bool {
        !self.ignore.iter().any(|pattern| takes(pattern, path))
    }
}

impl Names {
    /// Takes the names below `root` that pass the filter, and gives each vector that exists only in parts a slot of
    /// its own, after those of the file.
    pub(super) fn new(
        declarations: &mut Declarations,
        root: Option<&str>,
        filter: &Filter,
        file: &str,
    ) -> Result<Self, WaveError> {
        let below = |path: &str| match root {
            None => Some(path.to_owned()),
            Some(root) => Some(path.strip_prefix(root)?.strip_prefix('.')?.to_owned()),
        };
        let mut known = false;
        let mut taken: Vec<(usize, String)> = Vec::new();
        let mut vectors: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for (at, named) in declarations.names.iter().enumerate() {
            let Some(path) = below(&named.path) else { continue };
            known = true;
            // A part also goes by the name of the whole vector.
            let whole = named.part.as_ref().and_then(|(vector, _)| below(vector));
            if filter.takes(&path) && whole.as_ref().is_none_or(|whole| filter.keeps(whole))
                || whole.is_some_and(|whole| filter.takes(&whole) && filter.keeps(&path))
            {
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
        vectors.retain(|_, members| members.len() >= 2);
        let mut names = Self {
            left_out: declarations.names.len() - taken.len(),
            ..Self::default()
        };
        for (at, mut path) in taken {
            let named = &declarations.names[at];
            let mut full = named.path.clone();
            // The first part of a vector has the name of the whole vector.
            if let Some((vector, range)) = &named.part
                && *vector == full
                && vectors.contains_key(vector)
            {
                let range = format!("[{}:{}]", range.left, range.right);
                path.push_str(&range);
                full.push_str(&range);
            }
            names.entries.push(Entry {
                path,
                full,
                slot: named.slot,
                group: None,
            });
        }
        for (vector, members) in vectors {
            if let (Some(group), Some(path)) = (group(declarations, &members), below(&vector)) {
                names.entries.push(Entry {
                    path,
                    full: vector,
                    slot: group.slot,
                    group: Some(names.groups.len()),
                });
                names.groups.push(group);
            }
        }
        Ok(names)
    }

    /// Returns the slots of the parts of these groups.
    pub(super) fn parts_of(&self, groups: &HashSet<usize>) -> HashSet<u32> {
        let groups = groups.iter().filter_map(|at| self.groups.get(*at));
        groups.flat_map(|group| group.parts.iter().map(|part| part.0)).collect()
    }
}

/// Assembles a vector of parts that lie side by side without a gap.
fn group(declarations: &mut Declarations, members: &[usize]) -> Option<Group> {
    let mut parts = Vec::new();
    for at in members {
        let named = &declarations.names[*at];
        let (_, range) = named.part.as_ref()?;
        let low = range.left.min(range.right);
        let width = u32::try_from(range.left.abs_diff(range.right)).ok()? + 1;
        parts.push((low, width, named.slot));
    }
    parts.sort_unstable();
    let (lowest, ..) = *parts.first()?;
    let mut at = 0u32;
    let mut placed = Vec::new();
    for (low, width, slot) in parts {
        if low.checked_sub(lowest)? != i64::from(at) {
            return None;
        }
        placed.push((slot, width, at));
        at = at.checked_add(width)?;
    }
    let width = at;
    // The parts were counted already; the whole vector counts again, within the same limit.
    declarations.kinds.push(Kind::Bits(width));
    Some(Group {
        slot: declarations.kinds.len() as u32 - 1,
        parts: placed,
    })
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
    fn unit_one_writing_for_all() {
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
    fn unit_a_root_and_filters_choose() {
        let mut declarations = Declarations::default();
        let slot = declarations.add_slot(Kind::Bits(8), "").unwrap();
        for (scope, names) in [("tb", ["clk", "y"]), ("dut", ["y", "z"])] {
            declarations.enter(scope).unwrap();
            for name in names {
                declarations.add_name(name, slot).unwrap();
            }
        }
        let paths = |root: Option<&str>, only: &[&str], ignore: &[&str], declarations: &mut Declarations| {
            let owned = |texts: &[&str]| texts.iter().map(|t| (*t).to_owned()).collect::<Vec<_>>();
            let filter = Filter::new(&owned(only), &owned(ignore)).unwrap();
            let names = Names::new(declarations, root, &filter, "first")?;
            Ok::<Vec<String>, WaveError>(names.entries.into_iter().map(|e| e.path).collect())
        };
        let all = &mut declarations;
        assert_eq!(paths(Some("tb.dut"), &[], &[], all).unwrap(), ["y", "z"]);
        assert_eq!(paths(None, &["dut"], &["z"], all).unwrap(), ["tb.dut.y"]);
        assert_eq!(paths(None, &["tb.*"], &[], all).unwrap(), ["tb.clk", "tb.y"]);
        assert!(paths(Some("dut"), &[], &[], all).is_err());
    }
}
