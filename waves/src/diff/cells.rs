//! Keeps the two values of a pair side by side, for the pairs that are compared word by word: nearly all.
//!
//! A change costs one comparison, and a sample at which all are equal again costs nothing. Changes since the last sample are noted with the
//! value at that sample. Most signals of a design have one bit, and they change most often, so one byte holds both their values.

use super::matching::Pair;
use super::rule::Rule;
use super::side::Side;
use super::touched::Lists;
use crate::pile::Pile;
use crate::reader::{Changed, Changes, Kind};

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
struct Noted {
    cell: u32,
    before: Words,
}

/// The same for a cell of one bit, and below it both digits before that.
#[derive(Debug, Clone, Copy, Default)]
struct NotedBit(u32);

impl NotedBit {
    fn cell(self) -> u32 {
        self.0 >> 4
    }
}

/// Two slots that are each other's only partner.
pub(super) struct Partners {
    pub(super) slots: [u32; 2],
    pub(super) width: u32,
    /// The pairs of signals that have these slots.
    pub(super) pairs: Vec<u32>,
}

/// The cells of a comparison.
#[derive(Debug, Default)]
pub(super) struct Cells {
    /// The cells of one bit: the first file's digit in bits 0 and 1, the second's in bits 2 and 3.
    bits: Vec<u8>,
    /// The cells of more bits, whose numbers begin after those.
    wide: Vec<Cell>,
    /// Cell of each slot, for both files; empty if there are no cells.
    pub(super) of_slot: [Vec<u32>; 2],
    /// The pairs of each cell.
    pub(super) pairs: Lists,
    /// Cells whose values differ now.
    unequal: usize,
    /// Cells whose pairs count as different since the last sample.
    pub(super) different: usize,
    noted_bits: Pile<NotedBit>,
    noted: Vec<Noted>,
}

/// Effect of a new digit of a file on a cell of one bit: the cell's digits after it, and these flags. The index has the cell's digits in
/// its lower four bits and the new digit above them.
static STEPS: [[u8; 64]; 2] = {
    let mut steps = [[0; 64]; 2];
    let mut at = 0;
    while at < 128 {
        let (side, both, digit) = (at / 64, at % 16, at / 16 % 4);
        let after = both & !(3 << (2 * side)) | digit << (2 * side);
        let [was_equal, is_equal] = [both / 4 == both % 4, after / 4 == after % 4];
        let flags = match (was_equal, is_equal) {
            (true, false) => CHANGED | BECAME_UNEQUAL,
            (false, true) => CHANGED | BECAME_EQUAL,
            _ => 0,
        };
        steps[side][at % 64] = after as u8 | flags;
        at += 1;
    }
    steps
};
/// The cells of one bit while changes are taken.
struct Bits<'a> {
    both: &'a mut [u8],
    /// Places for notes, at least one for each change, and how many have been taken.
    notes: &'a mut [NotedBit],
    count: usize,
    unequal: usize,
    /// Flag that a change must have to be noted.
    noted_if: u8,
}

impl Bits<'_> {
    /// Changes the digit of one file; returns `false` if the cell has more than one bit.
    #[inline(always)] // a call for each change takes as long as the rest of it
    fn set<const SIDE: usize>(&mut self, cell: u32, digit: u8) -> bool {
        let (Some(both), Some(note)) = (self.both.get_mut(cell as usize), self.notes.get_mut(self.count)) else {
            return false;
        };
        let step = STEPS[SIDE][usize::from(*both & 15 | digit << 4) & 63];
        // The note is written without a branch to the first free place, and counts only if it is needed.
        *note = NotedBit(cell << 4 | u32::from(*both));
        *both = step & 15;
        self.count += usize::from(step & self.noted_if != 0);
        self.unequal += usize::from(step & BECAME_UNEQUAL != 0);
        self.unequal -= usize::from(step & BECAME_EQUAL != 0);
        true
    }
}

const CHANGED: u8 = 1 << 4;
const BECAME_UNEQUAL: u8 = 1 << 5;
const BECAME_EQUAL: u8 = 1 << 6;

/// Returns the words of a digit, which is in bits 0 and 1.
#[inline]
fn words_of(digit: u8) -> &'static Words {
    static WORDS: [Words; 4] = [[0, 0], [1, 0], [0, 1], [1, 1]];
    &WORDS[usize::from(digit & 3)]
}

/// Returns the digit of the words of one bit.
fn digit_of(words: &[u64]) -> u8 {
    match words {
        [bit, unknown] => (unknown << 1 | bit) as u8 & 3,
        _ => 0,
    }
}

/// Compares word by word: a comparison of whole arrays reads them in one piece, which must wait until the pieces that were
/// written last have arrived in memory.
#[inline]
fn same(a: Words, b: Words) -> bool {
    (a[0] ^ b[0]) | (a[1] ^ b[1]) == 0
}

impl Cells {
    /// Creates cells for these partners, those of one bit first, all without a value.
    pub(super) fn new(slots: [usize; 2], cells: &[Partners]) -> Self {
        const UNKNOWN: u8 = 0b1010;
        let mut of_slot = slots.map(|count| vec![GENERAL; count]);
        let mut entries = Vec::new();
        let (mut bits, mut wide) = (Vec::new(), Vec::new());
        for (at, partners) in (0..).zip(cells) {
            for (of_slot, slot) in of_slot.iter_mut().zip(partners.slots) {
                of_slot[slot as usize] = at;
            }
            entries.extend(partners.pairs.iter().map(|pair| (at, *pair)));
            if partners.width == 1 {
                bits.push(UNKNOWN);
            } else {
                let unknown = [0, u64::MAX >> (64 - partners.width)];
                wide.push(Cell { of: [unknown; 2] });
            }
        }
        let noted_bits = (0..bits.len() as u32).map(|cell| NotedBit(cell << 4 | u32::from(UNKNOWN)));
        let noted = (bits.len() as u32..).zip(&wide).map(|(cell, values)| Noted {
            cell,
            before: values.of[0],
        });
        Self {
            noted_bits: Pile::from(noted_bits.collect::<Vec<_>>()),
            noted: noted.collect(),
            bits,
            wide,
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

    /// Returns the values of both files.
    pub(super) fn both(&self, at: u32) -> [&Words; 2] {
        match self.bits.get(at as usize) {
            Some(both) => [words_of(*both), words_of(both >> 2)],
            None => self.wide[at as usize - self.bits.len()].of.each_ref(),
        }
    }

    /// Changes the values of one file. `other` takes the changes of slots without a cell.
    ///
    /// Both values of an equal cell cannot change at once; of a different one, the difference continues.
    pub(super) fn take(&mut self, side: usize, changes: Changes<'_>, other: impl FnMut(u32, Changed<'_>)) {
        match side {
            0 => self.take_of::<0>(changes, other),
            _ => self.take_of::<1>(changes, other),
        }
    }

    fn take_of<const SIDE: usize>(&mut self, mut changes: Changes<'_>, mut other: impl FnMut(u32, Changed<'_>)) {
        // Local copies: the compiler would read the fields again after each byte written.
        let of_slot = &self.of_slot[SIDE][..];
        let cell_of = |slot: u32| of_slot.get(slot as usize).copied().unwrap_or(GENERAL);
        let was_different = self.different > 0;
        let mut bits = Bits {
            both: &mut self.bits[..],
            notes: self.noted_bits.room(changes.len()),
            count: 0,
            unequal: self.unequal,
            noted_if: if was_different { CHANGED } else { BECAME_UNEQUAL },
        };
        loop {
            if let Some((slot, digit)) = changes.next_digit() {
                if !bits.set::<SIDE>(cell_of(slot), digit) {
                    other(slot, Changed::Digit(digit));
                }
                continue;
            }
            let Some((slot, changed)) = changes.next() else { break };
            let at = cell_of(slot);
            if let (Some(cell), Some(words)) = (
                self.wide.get_mut((at as usize).wrapping_sub(bits.both.len())),
                changed.pair(),
            ) {
                let before = cell.of[0];
                let was_equal = same(before, cell.of[1]);
                let is_equal = same(words, cell.of[1 - SIDE]);
                cell.of[SIDE] = words;
                if was_equal != is_equal {
                    bits.unequal = bits.unequal + usize::from(was_equal) - usize::from(is_equal);
                    if was_equal || was_different {
                        self.noted.push(Noted { cell: at, before });
                    }
                }
            } else if !bits.set::<SIDE>(at, digit_of(changed.words())) {
                other(slot, changed);
            }
        }
        self.unequal = bits.unequal;
        let count = bits.count;
        self.noted_bits.grow(count);
        if self.noted.len() + self.noted_bits.len() > 4 * self.count() + 1024 {
            self.press();
        }
    }

    /// Returns the cells that became equal or different since the last sample; a cell may be among them several times.
    pub(super) fn noted(&self) -> impl Iterator<Item = u32> {
        let bits = self.noted_bits.as_slice().iter().map(|noted| noted.cell());
        bits.chain(self.noted.iter().map(|noted| noted.cell))
    }

    /// Forgets what was noted, at a sample.
    #[inline]
    pub(super) fn forget_noted(&mut self) {
        self.noted_bits.truncate(0);
        self.noted.clear();
    }

    fn count(&self) -> usize {
        self.bits.len() + self.wide.len()
    }

    /// Changes the values of both files to the same.
    pub(super) fn set_both(&mut self, at: u32, words: Words) {
        self.unequal -= usize::from(!self.is_equal(at));
        match self.bits.get_mut(at as usize) {
            Some(both) => *both = digit_of(&words) * 0b101,
            None => {
                let place = at as usize - self.bits.len();
                self.wide[place].of = [words; 2];
            }
        }
    }

    /// Returns whether all cells are equal and were equal at the last sample.
    #[inline]
    pub(super) fn all_equal(&self) -> bool {
        self.unequal == 0 && self.different == 0
    }

    pub(super) fn is_equal(&self, at: u32) -> bool {
        let [a, b] = self.both(at);
        a == b
    }

    /// Returns the first file's value at the last sample.
    pub(super) fn before(&self, at: u32) -> Words {
        if let Some(noted) = self.noted_bits.as_slice().iter().find(|noted| noted.cell() == at) {
            return *words_of(noted.0 as u8);
        }
        let noted = self.noted.iter().find(|noted| noted.cell == at);
        noted.map_or(*self.both(at)[0], |noted| noted.before)
    }

    /// Keeps only the first note of each cell, since there may be no sample for a long time.
    fn press(&mut self) {
        let mut seen = vec![false; self.count()];
        let mut is_first = |cell: u32| !std::mem::replace(&mut seen[cell as usize], true);
        self.noted_bits.retain(|noted| is_first(noted.cell()));
        self.noted.retain(|noted| is_first(noted.cell));
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
        (Kind::Bits(a), Kind::Bits(b)) if a == b && (1..=64).contains(&a) => Some(a),
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
    let mut cells: Vec<Partners> = Vec::new();
    let mut of_slot: Vec<Option<usize>> = vec![None; slots[0]];
    for of_one_bit in [true, false] {
        for (at, (pair, _)) in (0..).zip(pairs) {
            let (Some(slot_a), Some(slot_b), Some(width)) = (pair.a, pair.b, width(pair)) else {
                continue;
            };
            if (width == 1) != of_one_bit || is_general[0][slot_a as usize] || is_general[1][slot_b as usize] {
                continue;
            }
            let cell = *of_slot[slot_a as usize].get_or_insert_with(|| {
                cells.push(Partners {
                    slots: [slot_a, slot_b],
                    width,
                    pairs: Vec::new(),
                });
                cells.len() - 1
            });
            cells[cell].pairs.push(at);
            cell_of[at as usize] = cell as u32;
        }
    }
    (Cells::new(slots, &cells), cell_of)
}
