//! Vectors that a file has in parts: single bits, or ranges of bits.
//!
//! The bits of both files meet by their index. The file that has the vector as a whole determines where an index lies
//! in it: of `v [0:3]`, index 0 is the first digit; of `v [3:0]`, the last.
//!
//! | first file | second file | compared |
//! |---|---|---|
//! | `v [3]`, `v [2]`, `v [1]`, `v [0]` | `v [3:0]` | as a vector |
//! | `v [3:2]`, `v [1:0]` | `v [3]`, `v [2]`, `v [1]`, `v [0]` | as a vector |
//! | `v [3]`, `v [2]` | `v [3:0]` | `v[3]` and `v[2]`; `v[1:0]` is only in the second file |
//! | parts alike | parts alike | part by part |

use std::collections::BTreeMap;

use crate::reader::{Range, Values};

/// Consecutive bits of a slot that are bits of another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Run {
    pub(super) source: u32,
    /// The lowest bit in the source, and in the other slot; and the number of bits.
    pub(super) from: u32,
    pub(super) to: u32,
    pub(super) count: u32,
}

/// A slot of bits of others.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Derived {
    pub(super) slot: u32,
    pub(super) width: u32,
    pub(super) runs: Vec<Run>,
}

/// Where the bits of a slot go.
#[derive(Debug, Clone, Copy)]
pub(super) struct PartOf {
    pub(super) whole: u32,
    run: Run,
}

impl PartOf {
    /// Copies the bits.
    pub(super) fn copy(&self, values: &mut Values) {
        let Run {
            source,
            from,
            to,
            count,
            ..
        } = self.run;
        for bit in 0..count {
            let words = values.words(source);
            let (half, at) = (words.len() / 2, (from + bit) as usize);
            let digit = [0, half].map(|plane| words[plane + at / 64] >> (at % 64) & 1);
            values.set_bit(self.whole, to + bit, digit);
        }
    }
}

/// Returns for each of so many slots where its bits go; empty if there is nothing to derive.
pub(super) fn parts_by_slot<'a>(derived: impl Iterator<Item = &'a Derived>, slots: usize) -> Vec<Vec<PartOf>> {
    let mut parts = Vec::new();
    for derived in derived {
        if parts.is_empty() {
            parts = vec![Vec::new(); slots];
        }
        for run in &derived.runs {
            parts[run.source as usize].push(PartOf {
                whole: derived.slot,
                run: *run,
            });
        }
    }
    parts
}

/// A vector of a file as it is declared.
#[derive(Debug, Clone)]
pub(super) enum Shape {
    /// One signal of this width, with its range if the file declares it.
    Whole {
        slot: u32,
        width: u32,
        range: Option<Range>,
    },
    /// Signals that are parts, each with its range.
    Parts(Vec<(u32, Range)>),
}

impl Shape {
    /// Returns the range of one signal, if the file declares it.
    pub(super) fn range(&self) -> Option<Range> {
        match self {
            Self::Whole { range, .. } => *range,
            Self::Parts(_) => None,
        }
    }
}

/// How two vectors of one name meet.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Meeting {
    /// Digit by digit from the last on, as they are.
    AsDeclared,
    /// Part by part, since the parts are alike.
    PartByPart,
    /// They have no bit in common.
    Apart,
    /// Bit by bit, by their index.
    ByIndex {
        /// Whether each has all bits of the other.
        whole: bool,
        common: Vec<Common>,
        /// Bits that only one has.
        only: [Vec<Bits>; 2],
        /// Whether neither file says which index is the first digit.
        assumed: bool,
    },
}

/// Bits with consecutive indices, the most significant first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Bits {
    pub(super) left: i64,
    pub(super) right: i64,
    /// The bits, from the least significant on: slot and bit.
    bits: Vec<(u32, u32)>,
}

/// Bits of both.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Common {
    pub(super) of: [Bits; 2],
}

impl Bits {
    /// Returns ` [3]` or ` [3:0]` as it stands behind a name.
    pub(super) fn suffix(&self) -> String {
        if self.left == self.right {
            format!("[{}]", self.left)
        } else {
            format!("[{}:{}]", self.left, self.right)
        }
    }

    pub(super) fn width(&self) -> u32 {
        self.bits.len() as u32
    }

    /// Returns the slot that consists of exactly these bits, in this order; `widths` returns a slot's width.
    pub(super) fn slot(&self, width: impl Fn(u32) -> u32) -> Option<u32> {
        let (slot, _) = *self.bits.first()?;
        let in_order = self.bits.iter().zip(0..).all(|(bit, at)| *bit == (slot, at));
        (in_order && width(slot) == self.width()).then_some(slot)
    }

    /// Returns runs that copy these bits into another slot.
    pub(super) fn runs(&self) -> Vec<Run> {
        let mut runs: Vec<Run> = Vec::new();
        for ((source, from), to) in self.bits.iter().copied().zip(0..) {
            match runs.last_mut() {
                Some(run) if run.source == source && run.from + run.count == from => run.count += 1,
                _ => runs.push(Run {
                    source,
                    from,
                    to,
                    count: 1,
                }),
            }
        }
        runs
    }
}

/// Returns the indices of a range from its last digit on.
fn indices(range: Range) -> Vec<i64> {
    let (left, right) = (range.left, range.right);
    if left >= right {
        (right..=left).collect()
    } else {
        (left..=right).rev().collect()
    }
}

fn by_index(slot: u32, range: Range) -> impl Iterator<Item = (i64, (u32, u32))> {
    indices(range)
        .into_iter()
        .zip(0..)
        .map(move |(index, bit)| (index, (slot, bit)))
}

/// Slot and bit of each index.
type Indexed = BTreeMap<i64, (u32, u32)>;

/// Returns how two vectors meet.
pub(super) fn meeting(a: &Shape, b: &Shape) -> Meeting {
    if let (Shape::Parts(a), Shape::Parts(b)) = (a, b) {
        let ranges = |parts: &[(u32, Range)]| {
            let mut ranges: Vec<(i64, i64)> = parts.iter().map(|(_, range)| (range.left, range.right)).collect();
            ranges.sort_unstable();
            ranges
        };
        if ranges(a) == ranges(b) {
            return Meeting::PartByPart;
        }
    }
    if let (Shape::Whole { range: of_a, .. }, Shape::Whole { range: of_b, .. }) = (a, b) {
        let (Some(of_a), Some(of_b)) = (of_a, of_b) else {
            return Meeting::AsDeclared;
        };
        let width = |range: &Range| range.left.abs_diff(range.right);
        // If both end with the same index, the narrower is extended, which compares more than their common bits.
        if width(of_a) == width(of_b) || of_a.right == of_b.right {
            return Meeting::AsDeclared;
        }
    }
    let mut assumed = false;
    let [maps_a, maps_b] = [(a, b), (b, a)].map(|(shape, other)| match shape {
        Shape::Parts(parts) => Some(parts.iter().flat_map(|(slot, range)| by_index(*slot, *range)).collect()),
        Shape::Whole {
            slot,
            range: Some(range),
            ..
        } => Some(by_index(*slot, *range).collect()),
        Shape::Whole { slot, width, .. } => {
            assumed = true;
            Some(by_index(*slot, assumed_range(*width, other)?).collect())
        }
    });
    let (Some(of_a), Some(of_b)): (Option<Indexed>, Option<Indexed>) = (maps_a, maps_b) else {
        return Meeting::Apart;
    };
    // The file that has the whole vector determines the significance of the bits.
    let ascending = [a, b].into_iter().any(|shape| match shape {
        Shape::Whole { range: Some(range), .. } => range.left < range.right,
        Shape::Whole { slot, .. } => {
            let map = if std::ptr::eq(shape, a) { &of_a } else { &of_b };
            map.first_key_value().is_some_and(|(_, first)| *first != (*slot, 0))
        }
        Shape::Parts(_) => false,
    });
    let met: Vec<i64> = of_a.keys().copied().filter(|index| of_b.contains_key(index)).collect();
    if met.is_empty() {
        return Meeting::Apart;
    }
    let whole = met.len() == of_a.len() && met.len() == of_b.len();
    // In parts, a run ends where a part of any file ends.
    let ends =
        |before: i64, index: i64, map: &Indexed| map.get(&before).map(|at| at.0) != map.get(&index).map(|at| at.0);
    let runs = |indices: &[i64], maps: &[&Indexed]| {
        let mut runs: Vec<Vec<i64>> = Vec::new();
        for index in indices {
            match runs.last_mut() {
                Some(run)
                    if whole
                        || run.last().is_some_and(|last| {
                            last + 1 == *index && !maps.iter().any(|map| ends(*last, *index, map))
                        }) =>
                {
                    run.push(*index);
                }
                _ => runs.push(vec![*index]),
            }
        }
        runs
    };
    let bits = |run: &[i64], map: &Indexed| {
        let mut order = run.to_vec();
        if ascending {
            order.reverse();
        }
        Bits {
            left: order.last().copied().unwrap_or(0),
            right: order.first().copied().unwrap_or(0),
            bits: order.iter().filter_map(|index| map.get(index).copied()).collect(),
        }
    };
    let common = runs(&met, &[&of_a, &of_b]);
    let common = common.iter().map(|run| Common {
        of: [bits(run, &of_a), bits(run, &of_b)],
    });
    let common: Vec<Common> = common.collect();
    let only = [(&of_a, &of_b), (&of_b, &of_a)].map(|(of, other)| {
        let alone: Vec<i64> = of.keys().copied().filter(|index| !other.contains_key(index)).collect();
        runs(&alone, &[of]).iter().map(|run| bits(run, of)).collect()
    });
    Meeting::ByIndex {
        whole,
        common,
        only,
        assumed,
    }
}

/// Returns the range of a vector that is declared without one, from the parts of the other file: descending, unless a
/// part says otherwise.
fn assumed_range(width: u32, other: &Shape) -> Option<Range> {
    let Shape::Parts(parts) = other else { return None };
    let ends = || parts.iter().flat_map(|(_, range)| [range.left, range.right]);
    let (low, high) = (ends().min()?, ends().max()?);
    let span = u64::from(width).checked_sub(1)?;
    let (low, high) = match high.abs_diff(low) {
        all if all == span => (low, high),
        fewer if fewer < span && low >= 0 && high.unsigned_abs() <= span => (0, i64::try_from(span).ok()?),
        _ => return None,
    };
    let ascending = parts.iter().any(|(_, range)| range.left < range.right);
    Some(if ascending {
        Range { left: low, right: high }
    } else {
        Range { left: high, right: low }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn range(left: i64, right: i64) -> Range {
        Range { left, right }
    }

    fn whole(left: i64, right: i64) -> Shape {
        Shape::Whole {
            slot: 9,
            width: left.abs_diff(right) as u32 + 1,
            range: Some(range(left, right)),
        }
    }

    fn single(indices: &[i64]) -> Shape {
        Shape::Parts(
            indices
                .iter()
                .zip(0..)
                .map(|(index, slot)| (slot, range(*index, *index)))
                .collect(),
        )
    }

    #[test]
    fn the_whole_vector_orders_the_bits() {
        for (whole_range, order) in [((3, 0), [0, 1, 2, 3]), ((0, 3), [3, 2, 1, 0])] {
            let Meeting::ByIndex {
                whole: true, common, ..
            } = meeting(&single(&[0, 1, 2, 3]), &whole(whole_range.0, whole_range.1))
            else {
                panic!()
            };
            let slots: Vec<u32> = common[0].of[0].runs().iter().map(|run| run.source).collect();
            assert_eq!(slots, order, "{whole_range:?}");
            assert_eq!(common[0].of[1].slot(|_| 4), Some(9));
            assert_eq!((common[0].of[1].left, common[0].of[1].right), whole_range);
        }
    }

    #[test]
    fn negative_and_missing_indices_meet_by_their_number() {
        let Meeting::ByIndex {
            whole, common, only, ..
        } = meeting(&single(&[-2, -1]), &whole(0, -3))
        else {
            panic!()
        };
        assert!(!whole);
        let names: Vec<String> = common.iter().map(|common| common.of[0].suffix()).collect();
        assert_eq!(names, ["[-2]", "[-1]"]);
        assert_eq!(only[1].iter().map(Bits::suffix).collect::<Vec<_>>(), ["[-3]", "[0]"]);
        assert_eq!(meeting(&single(&[7, 8]), &self::whole(3, 0)), Meeting::Apart);
    }
}
