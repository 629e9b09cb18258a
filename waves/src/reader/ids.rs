//! Id codes, the short names of signals in a VCD, as numbers that index a table.

use std::collections::HashMap;

/// Id codes up to this number are looked up in a table, others in a hash map.
const TABLE_IDS: u64 = 1 << 20;
const NO_SLOT: u32 = u32::MAX;

/// Returns the number of an id code and the position after it. The first character is the least significant, as most
/// writers have it, so that numbers are dense. Ten characters and more do not fit, and give `None`, as do other bytes than
/// IEEE 1364 allows.
#[inline]
pub(super) fn id_number(data: &[u8], mut at: usize) -> (Option<u64>, usize) {
    let (from, mut number, mut scale) = (at, 0u64, 1u64);
    while let Some(byte) = data.get(at) {
        let character = byte.wrapping_sub(b'!');
        if character > b'~' - b'!' {
            break;
        }
        number = number.wrapping_add(scale.wrapping_mul(u64::from(character) + 1));
        scale = scale.wrapping_mul(94);
        at += 1;
    }
    (((1..10).contains(&(at - from))).then_some(number), at)
}

/// As [`id_number`], for a position that eight bytes follow: most id codes have one to four characters, whose number is
/// computed at once.
#[inline]
fn short_id_number(data: &[u8], at: usize) -> (Option<u64>, usize) {
    let Some(eight) = data.get(at..at + 8) else {
        return id_number(data, at);
    };
    let mut bytes = [0; 8];
    bytes.copy_from_slice(eight);
    let characters = u64::from_le_bytes(bytes);
    // This sets the upper bit of each byte below `!` and of each from 0x80 on. Only the first such bit is sure to be
    // correct.
    let ends = (characters.wrapping_sub(0x2121_2121_2121_2121) | characters) & 0x8080_8080_8080_8080;
    let length = ends.trailing_zeros() / 8;
    if !(1..=4).contains(&length) || characters >> (8 * length) & 0xff > b' '.into() {
        return id_number(data, at);
    }
    let id = characters & (u64::MAX >> (64 - 8 * length));
    if (id + 0x0101_0101) & 0x8080_8080 != 0 {
        return id_number(data, at);
    }
    let character = |place: u32| (id >> (8 * place) & 0xff).saturating_sub(u64::from(b' '));
    let number = character(0) + 94 * character(1) + 94 * 94 * character(2) + 94 * 94 * 94 * character(3);
    (Some(number), at + length as usize)
}

/// Slots by id code.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Ids {
    table: Vec<u32>,
    others: HashMap<u64, u32>,
    /// Those without a number: some producers take the whole name.
    long: HashMap<Box<[u8]>, u32>,
    /// The slot of all signals that are left out.
    pub(super) left_out: Option<u32>,
}

impl Ids {
    fn number(id: &[u8]) -> Option<u64> {
        let (number, end) = id_number(id, 0);
        number.filter(|_| end == id.len())
    }

    /// Returns the slot of an id code.
    pub(super) fn find(&self, id: &[u8]) -> Option<u32> {
        match Self::number(id) {
            Some(number) => self.get(number),
            None => self.long.get(id).copied(),
        }
    }

    pub(super) fn insert(&mut self, id: &[u8], slot: u32) {
        let Some(number) = Self::number(id) else {
            self.long.insert(id.into(), slot);
            return;
        };
        if number >= TABLE_IDS {
            self.others.insert(number, slot);
            return;
        }
        let at = number as usize;
        if at >= self.table.len() {
            self.table.resize(at + 1, NO_SLOT);
        }
        self.table[at] = slot;
    }

    #[inline]
    pub(super) fn get(&self, number: u64) -> Option<u32> {
        if number < TABLE_IDS {
            let slot = self.table.get(number as usize).copied();
            return slot.filter(|slot| *slot != NO_SLOT);
        }
        self.others.get(&number).copied()
    }

    /// Returns the largest number in the table.
    pub(super) fn most(&self) -> Option<u64> {
        (self.table.len() as u64).checked_sub(1)
    }

    /// Returns the slot of the id code at `at`, if there is one, and the position after the id code.
    #[inline(always)] // a call for each change takes as long as the rest of it
    pub(super) fn slot_at(&self, data: &[u8], at: usize) -> (Option<u32>, usize) {
        // The signals that were declared first have an id code of one character.
        if let Some([first @ b'!'..=b'~', ..=b' ']) = data.get(at..at + 2) {
            return (self.get(u64::from(first - b' ')), at + 1);
        }
        self.long_slot_at(data, at)
    }

    fn long_slot_at(&self, data: &[u8], at: usize) -> (Option<u32>, usize) {
        let (number, end) = short_id_number(data, at);
        let rest = data.get(end..).unwrap_or_default();
        let word_end = end + rest.iter().take_while(|byte| **byte > b' ').count();
        match number {
            Some(number) if word_end == end => (self.get(number), end),
            _ => (self.long.get(&data[at.min(word_end)..word_end]).copied(), word_end),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn prop_short_ids_have_the_same_number(id in prop::collection::vec(any::<u8>(), 0..6), behind in any::<[u8; 3]>()) {
            let data = [id.as_slice(), &behind, b"\n\n\n\n\n\n\n\n"].concat();
            prop_assert_eq!(short_id_number(&data, 0), id_number(&data, 0));
        }

        #[test]
        fn prop_ids_of_writers_give_the_same_number(id in "[!-~]{1,5}") {
            let data = [id.as_bytes(), b"\n#1234567"].concat();
            prop_assert_eq!(short_id_number(&data, 0), id_number(&data, 0));
            prop_assert_eq!(short_id_number(&data, 0).1, id.len());
            let mut ids = Ids::default();
            prop_assert_eq!(ids.slot_at(&data, 0), (None, id.len()));
            ids.insert(id.as_bytes(), 7);
            prop_assert_eq!(ids.slot_at(&data, 0), (Some(7), id.len()));
        }

        #[test]
        fn prop_ids_of_any_length_and_of_any_letters_are_found(
            known in prop::collection::btree_set("[!-~]{1,14}|[a-zäß]{1,20}", 1..20), which: prop::sample::Index,
        ) {
            let known: Vec<String> = known.into_iter().collect();
            let mut ids = Ids::default();
            for (id, slot) in known.iter().zip(0..) {
                ids.insert(id.as_bytes(), slot);
            }
            let id = which.get(&known);
            let data = [id.as_bytes(), b"\n#1234567"].concat();
            prop_assert_eq!(ids.slot_at(&data, 0), (Some(which.index(known.len()) as u32), id.len()));
            let other = [id.as_bytes(), b"~~~~~~~~~~\n"].concat();
            let slot = known.iter().position(|known| *known == format!("{id}~~~~~~~~~~"));
            prop_assert_eq!(ids.slot_at(&other, 0), (slot.map(|slot| slot as u32), id.len() + 10));
        }
    }
}
