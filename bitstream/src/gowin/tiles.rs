//! What the bits of each tile say: the switches that are on, the look-up tables, and the uses of slices, pads and block RAMs.
//!
//! The bits of each part of a tile must be exactly those of one of its uses. A set bit outside all parts is an error, but for those with
//! settings of the whole device and of the banks of pads.

use super::database::{GowinDatabase, GowinWire};
use super::frames::GowinFrames;
use super::kind::{CellUses, MemoryUse, PadUse, SliceUse, TileKind, UseBits};
use crate::BitstreamError;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// A table without set bits.
pub const EMPTY_TABLE: u16 = u16::MAX;

/// What the bits of a device say.
#[derive(Debug, Default)]
pub struct DecodedTiles {
    /// The source of each wire with a switch that is on.
    pub switched: HashMap<GowinWire, GowinWire>,
    /// The settings of the tiles with set bits, by row and column.
    pub settings: BTreeMap<(u8, u8), TileSettings>,
    /// Switches that are on, and settings.
    pub set: u64,
    /// Set bits of the device's configuration, whose meaning is not read back, with their tiles.
    pub unnamed: Vec<(u8, u8, u16)>,
}

/// The settings of a tile.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct TileSettings {
    /// The look-up tables: bit `i` for inputs A, B, C and D whose levels are the bits of `i`.
    pub tables: Vec<u16>,
    /// The slices; `None` for one without set bits.
    pub slices: Vec<Option<SliceUse>>,
    /// The pads with set bits.
    pub pads: BTreeMap<char, PadUse>,
    /// The uses of a block RAM that have this tile's bits; none for one without set bits.
    pub memory: Vec<MemoryUse>,
    /// Ends of long wires that are cut off or driven here, and so not connected to anything else.
    pub ends: BTreeSet<String>,
}

/// The bits of a tile.
struct TileBits {
    row: u8,
    column: u8,
    set: Vec<bool>,
    /// Bits that belong to a part whose use is known.
    known: Vec<bool>,
}

impl TileBits {
    /// `None` for a tile without set bits.
    fn read(frames: &GowinFrames, database: &GowinDatabase, (row, column): (u8, u8), kind: &TileKind) -> Option<Self> {
        let (top, left) = database.corner(row, column);
        let rows = (0..kind.height).flat_map(|y| (0..kind.width).map(move |x| (top + y, left + x)));
        let set: Vec<bool> = rows.map(|(y, x)| frames.bit(y, x)).collect();
        let known = vec![false; set.len()];
        set.contains(&true).then_some(Self {
            row,
            column,
            set,
            known,
        })
    }

    fn is_set(&self, bit: u16) -> bool {
        self.set[usize::from(bit)]
    }

    fn know(&mut self, bits: &[u16]) {
        for bit in bits {
            self.known[usize::from(*bit)] = true;
        }
    }

    fn unknown(&self, what: &str) -> BitstreamError {
        BitstreamError::UnknownCell(format!("R{}C{}: {what}", self.row, self.column))
    }

    /// The uses whose bits are those that are set; none for a cell without set bits that has no use of no bits.
    fn uses<'u, U>(&mut self, uses: &'u CellUses<U>, what: &str) -> Result<Vec<&'u U>, BitstreamError> {
        let used = uses.used(|bit| self.is_set(bit));
        let fits = |form: &&UseBits<U>| form.bits == used;
        let found: Vec<&U> = uses.forms.iter().filter(fits).map(|form| &form.what).collect();
        if found.is_empty() && !used.is_empty() {
            return Err(self.unknown(&format!("{what} in a use that is not known")));
        }
        self.know(&used);
        Ok(found)
    }
}

impl DecodedTiles {
    /// Decodes the tiles of a bitstream.
    ///
    /// # Errors
    /// [`BitstreamError::UnknownCell`] for bits that are not known here, and for a wire with two sources.
    pub fn new(frames: &GowinFrames, database: &GowinDatabase) -> Result<Self, BitstreamError> {
        let mut decoded = Self::default();
        for row in 0..database.rows() {
            for column in 0..database.columns() {
                let Some(kind) = database.kind(row, column) else {
                    continue;
                };
                if let Some(bits) = TileBits::read(frames, database, (row, column), kind) {
                    decoded.tile(bits, database, kind)?;
                }
            }
        }
        decoded.check_long_wires(database)?;
        Ok(decoded)
    }

    fn tile(&mut self, mut bits: TileBits, database: &GowinDatabase, kind: &TileKind) -> Result<(), BitstreamError> {
        let (row, column) = (bits.row, bits.column);
        let mut settings = TileSettings {
            ends: self.switches(&mut bits, database, kind)?,
            ..TileSettings::default()
        };
        bits.know(&kind.fixed);
        for table in &kind.tables {
            let entries = table.iter().enumerate().filter(|(_, bit)| bits.is_set(**bit));
            settings
                .tables
                .push(entries.fold(EMPTY_TABLE, |table, (entry, _)| table & !(1 << entry)));
            bits.know(table);
        }
        for (index, slice) in kind.slices.iter().enumerate() {
            let uses = bits.uses(slice, &format!("slice {index}"))?;
            // The bits of the last slice of a tile say only that it is part of a small RAM.
            let only = uses.first().filter(|_| uses.len() == 1);
            settings.slices.push(only.map(|only| **only));
        }
        for (letter, pad) in &kind.pads {
            let uses = bits.uses(pad, &format!("pad {letter}"))?;
            if let Some(first) = uses.first() {
                settings.pads.insert(*letter, (*first).clone());
            }
        }
        if let Some(memory) = &kind.memory {
            let is_used = memory.every.iter().any(|bit| bits.is_set(*bit));
            let uses = bits.uses(memory, "a block RAM")?;
            if is_used {
                settings.memory = uses.into_iter().copied().collect();
            }
        }
        self.set += settings.tables.iter().filter(|table| **table != EMPTY_TABLE).count() as u64;
        self.set += (settings.slices.iter().flatten().count() + settings.pads.len()) as u64;
        self.set += u64::from(!settings.memory.is_empty());
        let unnamed = (0..bits.set.len()).filter(|bit| bits.set[*bit] && !bits.known[*bit]);
        let unnamed: Vec<u16> = unnamed.map(|bit| bit as u16).collect();
        if let Some(bit) = unnamed.iter().find(|bit| !kind.configuration.contains(bit)) {
            return Err(bits.unknown(&format!("the bit {bit} has no known meaning")));
        }
        self.unnamed.extend(unnamed.into_iter().map(|bit| (row, column, bit)));
        self.settings.insert((row, column), settings);
        Ok(())
    }

    fn switches(
        &mut self,
        bits: &mut TileBits,
        database: &GowinDatabase,
        kind: &TileKind,
    ) -> Result<BTreeSet<String>, BitstreamError> {
        let (row, column) = (bits.row, bits.column);
        let mut ends = BTreeSet::new();
        let wire = |name: &str| {
            let wire = database.wire(row, column, name);
            wire.ok_or_else(|| BitstreamError::UnknownCell(format!("R{row}C{column}: a wire {name}")))
        };
        for (sink, sources) in &kind.switches {
            let mut used: Vec<u16> = sources
                .values()
                .flatten()
                .copied()
                .filter(|bit| bits.is_set(*bit))
                .collect();
            if used.is_empty() {
                continue;
            }
            used.sort_unstable();
            used.dedup();
            // The end of a long wire that is cut off.
            if kind.isolated.get(sink).is_some_and(|isolated| *isolated == used) {
                continue;
            }
            let fits = sources.iter().filter(|(_, pattern)| **pattern == used);
            let mut fits: Vec<&str> = fits.map(|(source, _)| source.as_str()).collect();
            // Spines of the clock network share bits, but only one of them passes a tile.
            if fits.len() > 1 {
                fits.retain(|source| database.passes(source, row, column));
            }
            let [source] = fits[..] else {
                let what = format!("the switch to {sink} has bits that are not known");
                return Err(bits.unknown(&what));
            };
            let (sink_wire, source_wire) = (wire(sink)?, wire(source)?);
            if let Some(other) = self.switched.insert(sink_wire, source_wire)
                && other != source_wire
            {
                return Err(bits.unknown(&format!("the wire {sink} has two sources")));
            }
            bits.know(&used);
            ends.extend(kind.isolated.contains_key(sink).then(|| sink.clone()));
            self.set += 1;
        }
        for (wire, isolated) in &kind.isolated {
            if isolated.iter().all(|bit| bits.is_set(*bit)) {
                bits.know(isolated);
                ends.insert(wire.clone());
                self.set += 1;
            }
        }
        Ok(ends)
    }

    /// Checks that each long wire that is in use is driven at one end alone: at the other, it must be cut off where it is connected
    /// without set bits.
    fn check_long_wires(&self, database: &GowinDatabase) -> Result<(), BitstreamError> {
        for ends in database.long_wires() {
            let [(row, column, name), _] = ends;
            let is_used = database
                .wire(row, column, name)
                .is_some_and(|wire| self.switched.contains_key(&wire));
            let open = ends.into_iter().find(|(row, column, name)| {
                let is_connected = database
                    .kind(*row, *column)
                    .is_some_and(|kind| kind.isolated.contains_key(*name));
                let settings = self.tile_settings(*row, *column);
                is_connected && !settings.is_some_and(|settings| settings.ends.contains(*name))
            });
            if let (true, Some((row, column, name))) = (is_used, open) {
                return Err(BitstreamError::UnknownCell(format!(
                    "R{row}C{column}: the long wire {name} is driven at its other end, and is not cut off here"
                )));
            }
        }
        Ok(())
    }

    /// The settings of a tile; `None` for one without set bits.
    #[must_use]
    pub fn tile_settings(&self, row: u8, column: u8) -> Option<&TileSettings> {
        self.settings.get(&(row, column))
    }

    /// The use of a slice.
    #[must_use]
    pub fn slice(&self, row: u8, column: u8, slice: u8) -> Option<SliceUse> {
        let settings = self.tile_settings(row, column)?;
        settings.slices.get(usize::from(slice)).copied().flatten()
    }

    /// A look-up table; one without set bits is always high.
    #[must_use]
    pub fn table(&self, row: u8, column: u8, table: u8) -> u16 {
        let settings = self.tile_settings(row, column);
        let table = settings.and_then(|settings| settings.tables.get(usize::from(table)));
        table.copied().unwrap_or(EMPTY_TABLE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// Two by two tiles of four by two bits each, with two switches to A0, an end of a long wire, and a bit of the configuration.
    fn database() -> GowinDatabase {
        let kind = json!({
            "width": 4, "height": 2,
            "switches": {
                "A0": {"F1": [0], "N111": [0, 1]}, "LT02": {"A6": [2]}, "SN10": {"Q0": []}, "GT00": {"SPINE0": [4], "SPINE1": [4]}
            },
            "isolated": {"LT02": [3]}, "fixed": [], "configuration": [7], "tables": [], "slices": [], "pads": {}, "ports": {}, "memory": null
        });
        let segment = json!({
            "column": 0, "index": 0, "min_x": 0, "max_x": 1, "min_y": 0, "max_y": 1, "top_row": 0, "bottom_row": 1, "top_wire": "LT02",
            "bottom_wire": "LT02"
        });
        let text = json!({
            "version": super::super::database::VERSION, "grid": [[1, 1], [1, 1]], "kinds": {"1": kind}, "nodes": [],
            "spines": {"SPINE0": [[0, 1]], "SPINE1": [[0, 0], [1, 1]]}, "segments": [segment], "carry_tables": {},
            "bottom_wires": ["", ""], "memory_rows": [], "memory_columns": [], "pins": {}
        });
        GowinDatabase::read(&text.to_string()).unwrap()
    }

    /// The tiles with these bits, each of a row, a column and a number.
    fn decoded(bits: &[(u8, u8, u16)]) -> Result<DecodedTiles, BitstreamError> {
        let database = database();
        let mut rows = [[b'0'; 8]; 4];
        for (row, column, bit) in bits {
            let (top, left) = database.corner(*row, *column);
            let bit = usize::from(*bit);
            rows[top + bit / 4][7 - (left + bit % 4)] = b'1';
        }
        let rows = rows.map(|row| format!("{}{}\n", String::from_utf8_lossy(&row), "1".repeat(64)));
        let text = format!("{:032b}\n{}{:064b}\n", 0x3B80_0004u32, rows.concat(), 0x0Au64 << 56);
        let frames = GowinFrames::read(&text, database.bits()).unwrap();
        DecodedTiles::new(&frames, &database)
    }

    fn source(tiles: &DecodedTiles, row: u8, column: u8, name: &str) -> Option<GowinWire> {
        let wire = database().wire(row, column, name).unwrap();
        tiles.switched.get(&wire).copied()
    }

    #[test]
    fn switches_are_on_with_all_of_their_bits_and_wires_begin_in_other_tiles() {
        let tiles = decoded(&[(0, 0, 0), (1, 1, 0), (1, 1, 1), (0, 1, 7), (1, 1, 4)]).unwrap();
        let wire = |row, column, name| database().wire(row, column, name);
        assert_eq!(source(&tiles, 0, 0, "A0"), wire(0, 0, "F1"));
        // The wire that comes from below turns back at the edge.
        assert_eq!(source(&tiles, 1, 1, "A0"), wire(1, 1, "SN10"));
        assert_eq!(source(&tiles, 0, 1, "A0"), None);
        // One of the two spines with the same bits passes the tile.
        assert_eq!(source(&tiles, 1, 1, "GT00"), wire(1, 1, "SPINE1"));
        assert_eq!((tiles.set, tiles.unnamed), (3, vec![(0, 1, 7)]));
    }

    #[test]
    fn bits_without_a_meaning_and_long_wires_with_two_ends_are_refused() {
        for (bits, words) in [
            (&[(0, 0, 1)][..], "R0C0: the switch to A0 has bits that are not known"),
            (&[(0, 1, 5)], "R0C1: the bit 5 has no known meaning"),
            (&[(1, 0, 4)], "R1C0: the switch to GT00"),
            (
                &[(0, 0, 2)],
                "R1C0: the long wire LT02 is driven at its other end, and is not cut off here",
            ),
            (&[(0, 0, 2), (1, 0, 2)], "the wire LT02 has two sources"),
        ] {
            let message = decoded(bits).unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
        }
        let tiles = decoded(&[(0, 0, 2), (1, 0, 3)]).unwrap();
        assert_eq!(source(&tiles, 1, 0, "LT01"), database().wire(0, 0, "A6"));
    }
}
