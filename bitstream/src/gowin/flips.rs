//! The bits of a Gowin file that a single fault may change, and the tiles in which two files differ.

use super::database::GowinDatabase;
use super::frames::GowinFrames;
use super::memory::StoredContents;
use super::tiles::{DecodedTiles, EMPTY_TABLE};
use crate::report::FlipKind;
use crate::toolchain::TextBit;
use std::collections::{BTreeMap, BTreeSet};

/// The bits of this kind that a flip may change: the entries of tables that are not constant, the first set bit of each switch before an
/// input of logic, and the contents of memories.
pub(super) fn candidates(tiles: &DecodedTiles, stored: &StoredContents<'_>, kind: FlipKind) -> Vec<TextBit> {
    let mut bits = Vec::new();
    for ((row, column), settings) in &tiles.settings {
        let Some(tile) = stored.database.kind(*row, *column) else {
            continue;
        };
        let place = |bit: u16| {
            let (top, left) = stored.database.corner(*row, *column);
            let bit = usize::from(bit);
            stored.frames.place(top + bit / tile.width, left + bit % tile.width)
        };
        match kind {
            FlipKind::Table => {
                let tables = tile.tables.iter().zip(&settings.tables);
                let used = tables.filter(|(_, values)| ![0, EMPTY_TABLE].contains(*values));
                bits.extend(used.flat_map(|(entries, _)| entries.iter().map(|bit| place(*bit))));
            }
            FlipKind::Routing if !tile.tables.is_empty() => {
                let is_set = |bit: &u16| {
                    let (row, column) = stored.frames.row_and_column(place(*bit));
                    stored.frames.bit(row, column)
                };
                let switches = tile.switches.iter().filter(|(sink, _)| is_logic_input(sink));
                let first = |bits: &BTreeSet<u16>| bits.iter().copied().find(is_set);
                bits.extend(switches.filter_map(|(_, sources)| first(&all_bits(sources))).map(place));
            }
            FlipKind::Memory if tile.ports.contains_key("DO0") && !settings.memory.is_empty() => {
                bits.extend(stored.digits((*row, *column)));
            }
            _ => {}
        }
    }
    bits
}

/// The bits of all switches to a wire.
fn all_bits(sources: &BTreeMap<String, Vec<u16>>) -> BTreeSet<u16> {
    sources.values().flatten().copied().collect()
}

/// The file with a bit flipped, or with the switch left out to which it belongs, and its place in words.
pub(super) fn flipped(database: &GowinDatabase, frames: &GowinFrames, bit: TextBit) -> (String, String) {
    let (row, column) = frames.row_and_column(bit);
    let Some((tile_row, tile_column, number)) = database.tile_with(row, column) else {
        let frame = row - database.bits().0;
        let place = format!("contents of memories, frame {frame}, bit {column}");
        return (frames.flipped(&[bit]), place);
    };
    let tile = format!("R{tile_row}C{tile_column}");
    let kind = database.kind(tile_row, tile_column);
    let switch = kind.and_then(|kind| {
        let mut switches = kind
            .switches
            .iter()
            .map(|(sink, sources)| (kind, sink, all_bits(sources)));
        switches.find(|(_, _, bits)| bits.contains(&number))
    });
    let Some((kind, sink, bits)) = switch else {
        return (frames.flipped(&[bit]), format!("{tile}, bit {number}"));
    };
    let (top, left) = database.corner(tile_row, tile_column);
    let places = bits.into_iter().map(|bit| {
        let bit = usize::from(bit);
        (top + bit / kind.width, left + bit % kind.width)
    });
    let set = places.filter(|(row, column)| frames.bit(*row, *column));
    let set: Vec<TextBit> = set.map(|(row, column)| frames.place(row, column)).collect();
    (frames.flipped(&set), format!("{tile}, the switch to {sink} left out"))
}

/// Whether a wire is an input of a table, of a multiplexer or of a flip-flop.
fn is_logic_input(name: &str) -> bool {
    let begins = ["A", "B", "C", "D", "SEL", "CE", "LSR"];
    begins.iter().any(|letters| {
        let number = name.strip_prefix(letters);
        number.is_some_and(|number| number.len() == 1 && number.bytes().all(|digit| digit.is_ascii_digit()))
    })
}

/// The tiles in which two files differ, and rows of frames with contents of memories.
pub(super) fn different_tiles(database: &GowinDatabase, frames: &GowinFrames, others: &GowinFrames) -> Vec<String> {
    let (rows, columns) = database.bits();
    if frames.memory_frames() != others.memory_frames() {
        return vec!["the number of frames".to_owned()];
    }
    let mut different = BTreeSet::new();
    for row in 0..rows + frames.memory_frames() {
        for column in (0..columns).filter(|column| frames.bit(row, *column) != others.bit(row, *column)) {
            different.insert(match database.tile_with(row, column) {
                Some((row, column, _)) => format!("R{row}C{column}"),
                None => format!("contents of memories, frame {}", row - rows),
            });
        }
    }
    different.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inputs_of_logic_are_told_from_wires_between_tiles() {
        for name in ["A0", "D7", "SEL3", "CE2", "LSR0"] {
            assert!(is_logic_input(name), "{name}");
        }
        for name in ["E100", "X01", "DI0", "SN10", "LBO0", "CLK0"] {
            assert!(!is_logic_input(name), "{name}");
        }
    }
}
