//! Keeps both values side by side of the pairs that are compared word by word, which are nearly all.
//!
//! A change costs one comparison, and a sample at which all are equal again costs nothing. Changes since the last
//! sample are noted with the value at that sample.

use super::matching::Pair;
use super::rule::Rule;
use super::side::Side;
use super::touched::Lists;
use crate::reader::Kind;

/// Marks a slot without a cell; its pairs are compared the general way.
pub(super) const GENERAL: u32 = u32::MAX;

/// Bits, and a mask of the unknown ones.
pub(super) type Words = [u64; 2];

/// One value per file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell {
    pub(super) of: [Words; 2],
}

/// A cell that became equal or different, and the first file's value before that.
#[derive(Debug, Clone, Copy)]
pub(super) struct Noted {
    pub(super) cell: u32,
    pub(super) before: Words,
}

/// The cells of a comparison.
#[derive(Debug, Default)]
pub(super) struct Cells {
    pub(super) cells: Vec<Cell>,
    /// Cell of each slot, for both files; empty if there are no cells.
    pub(super) of_slot: [Vec<u32>; 2],
    /// The pairs of each cell.
    pub(super) pairs: Lists,
    /// Cells whose values differ now.
    unequal: usize,
    /// Cells whose pairs count as different since the last sample.
    pub(super) different: usize,
    pub(super) noted: Vec<Noted>,
}

/// Compares word by word: a comparison of whole arrays reads them in one piece, which must wait until the pieces that were
/// written last have arrived in memory.
#[inline]
fn same(a: Words, b: Words) -> bool {
    (a[0] ^ b[0]) | (a[1] ^ b[1]) == 0
}

impl Cells {
    /// Creates cells for these pairs of slots, each with the numbers of its pairs, all without a value.
    pub(super) fn new(slots: [usize; 2], cells: &[([u32; 2], u32, Vec<u32>)]) -> Self {
        let mut of_slot = slots.map(|count| vec![GENERAL; count]);
        let mut entries = Vec::new();
        let mut values = Vec::new();
        for (at, (slots, width, pairs)) in (0..).zip(cells) {
            for (of_slot, slot) in of_slot.iter_mut().zip(slots) {
                of_slot[*slot as usize] = at;
            }
            entries.extend(pairs.iter().map(|pair| (at, *pair)));
            let unknown = [0, u64::MAX >> (64 - width)];
            values.push(Cell { of: [unknown; 2] });
        }
        let noted = (0..cells.len() as u32).map(|cell| Noted {
            cell,
            before: values[cell as usize].of[0],
        });
        Self {
            noted: noted.collect(),
            cells: values,
            of_slot,
            pairs: Lists::new(cells.len(), &entries),
            unequal: 0,
            different: 0,
        }
    }

    /// Returns the cell of a slot of a file, or [`GENERAL`].
    #[inline]
    pub(super) fn of(&self, side: usize, slot: u32) -> u32 {
        self.of_slot[side].get(slot as usize).copied().unwrap_or(GENERAL)
    }

    /// Changes the value of one file.
    #[inline]
    pub(super) fn set(&mut self, side: usize, at: u32, words: Words) {
        let cell = &mut self.cells[at as usize];
        let before = cell.of[0];
        let was_equal = same(before, cell.of[1]);
        let is_equal = same(words, cell.of[1 - side]);
        cell.of[side] = words;
        if was_equal == is_equal {
            // Both values of an equal cell cannot change at once; of a different one, the difference continues.
            return;
        }
        if is_equal {
            self.unequal -= 1;
            if self.different == 0 {
                return;
            }
        } else {
            self.unequal += 1;
        }
        self.noted.push(Noted { cell: at, before });
        if self.noted.len() > 4 * self.cells.len() + 1024 {
            self.press();
        }
    }

    /// Changes the values of both files to the same.
    pub(super) fn set_both(&mut self, at: u32, words: Words) {
        let cell = &mut self.cells[at as usize];
        self.unequal -= usize::from(cell.of[0] != cell.of[1]);
        cell.of = [words; 2];
    }

    /// Returns whether all cells are equal and were equal at the last sample.
    #[inline]
    pub(super) fn all_equal(&self) -> bool {
        self.unequal == 0 && self.different == 0
    }

    pub(super) fn is_equal(&self, at: u32) -> bool {
        let cell = &self.cells[at as usize];
        cell.of[0] == cell.of[1]
    }

    /// Returns the first file's value at the last sample.
    pub(super) fn before(&self, at: u32) -> Words {
        let noted = self.noted.iter().find(|noted| noted.cell == at);
        noted.map_or(self.cells[at as usize].of[0], |noted| noted.before)
    }

    /// Keeps only the first note of each cell, since there may be no sample for a long time.
    fn press(&mut self) {
        let mut seen = vec![false; self.cells.len()];
        self.noted
            .retain(|noted| !std::mem::replace(&mut seen[noted.cell as usize], true));
    }
}

/// Returns the cells and the cell of each pair. A pair has a cell if it is compared word by word and each of its slots
/// has one partner.
pub(super) fn cells(a: &Side, b: &Side, pairs: &[(Pair, Rule)]) -> (Cells, Vec<u32>) {
    let mut cell_of = vec![GENERAL; pairs.len()];
    if !(a.is_plain() && b.is_plain()) {
        return (Cells::default(), cell_of);
    }
    let slots = [a.values.count(), b.values.count()];
    let mut partners = slots.map(|count| vec![None; count]);
    let mut is_general = slots.map(|count| vec![false; count]);
    for (side, reset) in [a.reset_slot(), b.reset_slot()].into_iter().enumerate() {
        if let Some(slot) = reset {
            is_general[side][slot as usize] = true;
        }
    }
    let width = |pair: &Pair| match (a.values.kind(pair.a?), b.values.kind(pair.b?)) {
        (Kind::Bits(a), Kind::Bits(b)) if a == b && a <= 64 => Some(a),
        _ => None,
    };
    for (pair, rule) in pairs {
        let simple = rule.is_plain() && width(pair).is_some();
        for (side, [slot, partner]) in [[pair.a, pair.b], [pair.b, pair.a]].into_iter().enumerate() {
            let Some(slot) = slot else { continue };
            let known = partners[side][slot as usize].get_or_insert(partner);
            is_general[side][slot as usize] |= !simple || *known != partner;
        }
    }
    let mut cells: Vec<([u32; 2], u32, Vec<u32>)> = Vec::new();
    let mut of_slot = std::collections::HashMap::new();
    for (at, (pair, _)) in (0..).zip(pairs) {
        let (Some(slot_a), Some(slot_b), Some(width)) = (pair.a, pair.b, width(pair)) else {
            continue;
        };
        if is_general[0][slot_a as usize] || is_general[1][slot_b as usize] {
            continue;
        }
        let cell = *of_slot.entry(slot_a).or_insert_with(|| {
            cells.push(([slot_a, slot_b], width, Vec::new()));
            cells.len() - 1
        });
        cells[cell].2.push(at);
        cell_of[at as usize] = cell as u32;
    }
    (Cells::new(slots, &cells), cell_of)
}
