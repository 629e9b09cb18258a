//! A bitstream as text (`.asc`): its tiles, their comparison, and single flips.

use super::netlist::MemoryCell;
use crate::report::{FlipKind, TilesReport};
use crate::toolchain::TextBit;
use std::collections::BTreeMap;

/// The bit of a logic cell's two rows of ten that is entry `k` of its look-up table; of the IceStorm documentation.
const TABLE_BITS: [usize; 16] = [4, 14, 15, 5, 6, 16, 17, 7, 3, 13, 12, 2, 1, 11, 10, 0];
/// First column of the logic cells' bits in a logic tile.
const CELL_COLUMN: usize = 36;
/// Columns of a logic cell's bits.
const CELL_COLUMNS: usize = 10;
/// Logic cells of a tile.
const CELLS: usize = 8;
/// Bits of a hexadecimal digit of a memory.
const DIGIT_BITS: usize = 4;

/// The tiles of a bitstream's text: rows by the heading of their tile. A tile without a set bit is left out, since a program may leave it
/// out, too.
fn tiles(text: &str) -> BTreeMap<&str, Vec<&str>> {
    let mut tiles: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    let mut current = None;
    for line in text.lines().map(str::trim).filter(|line| !line.is_empty()) {
        if line.starts_with('.') {
            let kind = line.split_whitespace().next().unwrap_or_default();
            current = (![".comment", ".sym"].contains(&kind)).then_some(line);
            // A single bit outside the tiles, and the device, have no rows.
            if [".extra_bit", ".device"].contains(&kind) {
                tiles.insert(line, vec!["1"]);
            }
        } else if let Some(heading) = current {
            tiles.entry(heading).or_default().push(line);
        }
    }
    tiles.retain(|_, rows| rows.iter().any(|row| row.bytes().any(|digit| digit != b'0')));
    tiles
}

/// Compares two bitstreams: that of the router, and that which was read back.
#[must_use]
pub fn compare_tiles(routed: &str, read_back: &str) -> TilesReport {
    let (ours, theirs) = (tiles(routed), tiles(read_back));
    let all: std::collections::BTreeSet<&str> = ours.keys().chain(theirs.keys()).copied().collect();
    let differs = all.iter().filter(|heading| ours.get(*heading) != theirs.get(*heading));
    let set = |row: &&str| {
        row.chars()
            .filter_map(|digit| digit.to_digit(16))
            .map(u32::count_ones)
            .sum::<u32>()
    };
    TilesReport {
        tiles: all.len() as u64,
        set: ours.values().flatten().map(|row| u64::from(set(row))).sum(),
        unnamed: 0,
        differences: differs
            .map(|heading| heading.trim_start_matches('.').to_owned())
            .collect(),
    }
}

/// The bits of this kind that a flip may change.
#[must_use]
pub fn candidates(text: &str, kind: FlipKind, memories: &[MemoryCell]) -> Vec<TextBit> {
    let lines: Vec<&str> = text.lines().collect();
    let mut bits = Vec::new();
    for (heading, line) in lines.iter().enumerate() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [what, x, y] = words[..] else {
            continue;
        };
        let rows = |count: usize| lines.get(heading + 1..heading + 1 + count).unwrap_or_default();
        match (kind, what) {
            (FlipKind::Table, ".logic_tile") => {
                for cell in 0..CELLS {
                    let at = |entry: usize| (2 * cell + entry / CELL_COLUMNS, CELL_COLUMN + entry % CELL_COLUMNS);
                    let places = TABLE_BITS.map(at);
                    let is_set = |(row, column): &(usize, usize)| is_one(rows(16).get(*row), *column);
                    if places.iter().any(is_set) {
                        bits.extend(places.map(|(row, column)| TextBit {
                            line: heading + 1 + row,
                            column,
                            bit: 0,
                        }));
                    }
                }
            }
            (FlipKind::Routing, ".logic_tile") => {
                for (row, text) in rows(16).iter().enumerate() {
                    let outside = |column: &usize| !(CELL_COLUMN..CELL_COLUMN + CELL_COLUMNS).contains(column);
                    let columns = (0..text.len())
                        .filter(outside)
                        .filter(|column| is_one(Some(text), *column));
                    bits.extend(columns.map(|column| TextBit {
                        line: heading + 1 + row,
                        column,
                        bit: 0,
                    }));
                }
            }
            (FlipKind::Memory, ".ram_data") => {
                let is_used = |memory: &MemoryCell| memory.place.x.to_string() == x && memory.place.y.to_string() == y;
                if memories.iter().any(is_used) {
                    for (row, text) in rows(16).iter().enumerate() {
                        let digits = (0..text.len()).flat_map(|column| (0..DIGIT_BITS).map(move |bit| (column, bit)));
                        bits.extend(digits.map(|(column, bit)| TextBit {
                            line: heading + 1 + row,
                            column,
                            bit,
                        }));
                    }
                }
            }
            _ => {}
        }
    }
    bits
}

fn is_one(row: Option<&&str>, column: usize) -> bool {
    row.is_some_and(|row| row.as_bytes().get(column) == Some(&b'1'))
}

/// The text with one bit flipped, and the place of the bit in words.
#[must_use]
pub fn flipped(text: &str, bit: TextBit) -> (String, String) {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let heading = lines[..bit.line]
        .iter()
        .rposition(|line| line.starts_with('.'))
        .unwrap_or(0);
    let row = bit.line - heading - 1;
    let place = format!(
        "{}, row {row}, column {}",
        lines[heading].trim_start_matches('.'),
        bit.column
    );
    let line = &mut lines[bit.line];
    let digit = line
        .get(bit.column..=bit.column)
        .and_then(|digit| u8::from_str_radix(digit, 16).ok())
        .unwrap_or(0);
    line.replace_range(bit.column..=bit.column, &format!("{:x}", digit ^ 1 << bit.bit));
    (lines.join("\n") + "\n", place)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUTED: &str = ".comment from a router\n.device 5k\n.io_tile 1 0\n00\n01\n\n.io_tile 2 0\n00\n00\n.sym 1 name\n.extra_bit 0 1 2\n";

    #[test]
    fn tiles_are_equal_whatever_their_order_and_without_empty_ones() {
        let other = ".comment\na line\n.device 5k\n.extra_bit 0 1 2\n.io_tile 1 0\n00\n01\n";
        let report = compare_tiles(ROUTED, other);
        assert_eq!((report.tiles, report.set, report.differences.len()), (3, 3, 0));
        let report = compare_tiles(ROUTED, &other.replace("01", "11"));
        assert_eq!(report.differences, ["io_tile 1 0"]);
        assert_eq!(
            compare_tiles(ROUTED, &other.replace("0 1 2", "0 1 3"))
                .differences
                .len(),
            2
        );
    }

    #[test]
    fn a_flip_changes_one_bit_and_names_its_place() {
        let bit = TextBit {
            line: 4,
            column: 1,
            bit: 0,
        };
        let (text, place) = flipped(ROUTED, bit);
        assert_eq!(place, "io_tile 1 0, row 1, column 1");
        assert_eq!(text, ROUTED.replace("\n01\n", "\n00\n"));
    }

    #[test]
    fn only_tables_in_use_are_flipped() {
        let mut rows = vec!["0".repeat(54); 16];
        let none = format!(".logic_tile 1 1\n{}\n", rows.join("\n"));
        assert!(candidates(&none, FlipKind::Table, &[]).is_empty());
        rows[2].replace_range(40..41, "1");
        rows[3].replace_range(3..4, "1");
        let one = format!(".logic_tile 1 1\n{}\n", rows.join("\n"));
        let of_table = candidates(&one, FlipKind::Table, &[]);
        assert_eq!(of_table.len(), 16);
        assert!(of_table.iter().all(|bit| bit.line == 3 || bit.line == 4));
        assert_eq!(
            candidates(&one, FlipKind::Routing, &[]),
            [TextBit {
                line: 4,
                column: 3,
                bit: 0
            }]
        );
    }
}
