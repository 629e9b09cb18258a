//! Id codes, the short names of signals in a VCD, as numbers that index a table.

use std::collections::HashMap;

/// Id codes up to this number are looked up in a table, others in a hash map.
const TABLE_IDS: u64 = 1 << 20;
const NO_SLOT: u32 = u32::MAX;

/// Returns the number of an id code and the position after it. The first character is the least significant, as most
/// writers have it, so that numbers are dense. Ten characters and more do not fit, and give `None`.
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

/// Slots by id code.
#[derive(Debug, Default)]
pub(super) struct Ids {
    table: Vec<u32>,
    others: HashMap<u64, u32>,
}

impl Ids {
    pub(super) fn number(id: &str) -> Option<u64> {
        id_number(id.as_bytes(), 0).0
    }

    pub(super) fn insert(&mut self, number: u64, slot: u32) {
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
}
