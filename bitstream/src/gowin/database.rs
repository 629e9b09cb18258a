//! What is wired to what in a Gowin device, and which bits of its tiles mean what: apycula's chip database, as a script of ours prints it.

use super::kind::TileKind;
use crate::BitstreamError;
use serde::Deserialize;
use std::collections::{BTreeMap, HashMap};

/// Prints the database as JSON; it runs in the Python of apycula.
pub const SCRIPT: &str = include_str!("database.py");
/// The version of apycula whose database is known here, and is that of the router.
pub const VERSION: &str = "0.32";
/// Name of the database, for errors.
const TOOL: &str = "apycula's database";

/// A wire of the device, at the tile where it is named.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct GowinWire {
    /// Row of the tile.
    pub row: u8,
    /// Column of the tile.
    pub column: u8,
    /// Its name there, an index of [`GowinDatabase::name`].
    name: u32,
}

/// The database of a device.
#[derive(Debug)]
pub struct GowinDatabase {
    file: DatabaseFile,
    names: Vec<String>,
    indices: HashMap<String, u32>,
    /// The wire that stands for each wire that is joined with others for good.
    joined: HashMap<GowinWire, GowinWire>,
    /// First row of bits of each row of tiles, and the end.
    row_starts: Vec<usize>,
    /// First column of bits of each column of tiles, and the end.
    column_starts: Vec<usize>,
}

/// What the script prints.
#[derive(Debug, Deserialize)]
struct DatabaseFile {
    version: String,
    grid: Vec<Vec<u32>>,
    kinds: HashMap<u32, TileKind>,
    nodes: Vec<Vec<(u8, u8, String)>>,
    spines: HashMap<String, Vec<(u8, u8)>>,
    segments: Vec<Segment>,
    carry_tables: HashMap<String, u16>,
    bottom_wires: [String; 2],
    memory_rows: Vec<u8>,
    memory_columns: Vec<[usize; 4]>,
    pins: HashMap<String, (u8, u8, char)>,
}

/// A long wire down a column, which serves some columns and rows.
#[derive(Debug, Deserialize)]
struct Segment {
    column: u8,
    index: u8,
    min_x: u8,
    max_x: u8,
    min_y: u8,
    max_y: u8,
    top_row: u8,
    bottom_row: u8,
    top_wire: String,
    bottom_wire: String,
}

impl GowinDatabase {
    /// Reads what the script has printed.
    ///
    /// # Errors
    /// [`BitstreamError::Unreadable`] for another form.
    pub fn read(text: &str) -> Result<Self, BitstreamError> {
        let file: DatabaseFile = serde_json::from_str(text).map_err(|error| unreadable(error.to_string()))?;
        if file.version != VERSION {
            return Err(unreadable(format!(
                "version {}; known here is {VERSION}, which fits the router: pip install Apycula=={VERSION}",
                file.version
            )));
        }
        let kind = |row: usize, column: usize| file.kinds.get(file.grid.get(row)?.get(column)?);
        let rows = (0..file.grid.len()).map(|row| kind(row, 0).map_or(0, |kind| kind.height));
        let columns = file.grid.first().map_or(0, Vec::len);
        let columns = (0..columns).map(|column| kind(0, column).map_or(0, |kind| kind.width));
        let mut database = Self {
            row_starts: starts(rows),
            column_starts: starts(columns),
            names: Vec::new(),
            indices: HashMap::new(),
            joined: HashMap::new(),
            file,
        };
        database.learn_names();
        database.join()?;
        Ok(database)
    }

    fn learn_names(&mut self) {
        let kinds = self.file.kinds.values();
        let names = kinds.flat_map(|kind| {
            let sources = kind.switches.values().flat_map(BTreeMap::keys);
            kind.switches.keys().chain(sources).chain(kind.ports.values())
        });
        for name in names.cloned().collect::<Vec<_>>() {
            self.new_wire(0, 0, &name);
        }
    }

    /// Joins the wires of each node, and those of each long wire.
    fn join(&mut self) -> Result<(), BitstreamError> {
        let mut nodes = std::mem::take(&mut self.file.nodes);
        for segment in &self.file.segments {
            let half = segment.index / 4;
            let mut long = vec![
                (segment.top_row, segment.column, segment.top_wire.clone()),
                (segment.bottom_row, segment.column, segment.bottom_wire.clone()),
            ];
            for row in segment.min_y..=segment.max_y {
                long.push((row, segment.column, format!("LT0{}", 1 + 3 * half)));
                let mut branch = vec![(row, segment.column, format!("LBO{half}"))];
                let columns = segment.min_x..=segment.max_x;
                branch.extend(columns.map(|column| (row, column, format!("LB{}1", segment.index))));
                nodes.push(branch);
            }
            nodes.push(long);
        }
        for node in nodes {
            // The wire with switches stands for all.
            let is_driven = |(row, column, name): &&(u8, u8, String)| {
                let kind = self.kind(*row, *column);
                kind.is_some_and(|kind| kind.switches.contains_key(name))
            };
            let first = node.iter().find(is_driven).or(node.first()).cloned();
            let wires: Vec<GowinWire> = node
                .iter()
                .map(|(row, column, name)| self.new_wire(*row, *column, name))
                .collect();
            let first = first.map(|(row, column, name)| self.new_wire(row, column, &name));
            let mut known = wires.iter().filter_map(|wire| self.joined.get(wire).copied());
            let stands_for = known.next().or(first);
            if known.any(|other| Some(other) != stands_for) {
                return Err(unreadable(format!("a wire of two nodes among {node:?}")));
            }
            let stands_for = stands_for.ok_or_else(|| unreadable("an empty node".to_owned()))?;
            self.joined.extend(wires.into_iter().map(|wire| (wire, stands_for)));
        }
        Ok(())
    }

    fn new_wire(&mut self, row: u8, column: u8, name: &str) -> GowinWire {
        let name = match self.indices.get(name) {
            Some(index) => *index,
            None => {
                let index = self.names.len() as u32;
                self.names.push(name.to_owned());
                self.indices.insert(name.to_owned(), index);
                index
            }
        };
        GowinWire { row, column, name }
    }

    /// Rows of tiles.
    #[must_use]
    pub fn rows(&self) -> u8 {
        self.file.grid.len() as u8
    }

    /// Columns of tiles.
    #[must_use]
    pub fn columns(&self) -> u8 {
        self.column_starts.len().saturating_sub(1) as u8
    }

    /// Rows and columns of bits.
    #[must_use]
    pub fn bits(&self) -> (usize, usize) {
        let end = |starts: &[usize]| starts.last().copied().unwrap_or(0);
        (end(&self.row_starts), end(&self.column_starts))
    }

    /// The first row and column of the bits of a tile.
    #[must_use]
    pub fn corner(&self, row: u8, column: u8) -> (usize, usize) {
        (
            self.row_starts[usize::from(row)],
            self.column_starts[usize::from(column)],
        )
    }

    /// The tile with this bit, and the bit's number in it.
    #[must_use]
    pub fn tile_with(&self, bit_row: usize, bit_column: usize) -> Option<(u8, u8, u16)> {
        let place = |starts: &[usize], at: usize| {
            let next = starts.iter().position(|start| *start > at)?;
            next.checked_sub(1).map(|index| (index as u8, at - starts[index]))
        };
        let (row, y) = place(&self.row_starts, bit_row)?;
        let (column, x) = place(&self.column_starts, bit_column)?;
        let width = self.kind(row, column)?.width;
        Some((row, column, (y * width + x) as u16))
    }

    /// The kind of the tile at a place.
    #[must_use]
    pub fn kind(&self, row: u8, column: u8) -> Option<&TileKind> {
        let number = self.file.grid.get(usize::from(row))?.get(usize::from(column))?;
        self.file.kinds.get(number)
    }

    /// The pad at a pin of the package: row, column and letter.
    ///
    /// # Errors
    /// [`BitstreamError::UnknownCell`] for a pin that the package does not have.
    pub fn pad(&self, pin: &str) -> Result<(u8, u8, char), BitstreamError> {
        let pad = self.file.pins.get(pin).copied();
        pad.ok_or_else(|| BitstreamError::UnknownCell(format!("the package has no pin {pin}")))
    }

    /// The table of a carry of this kind, as nextpnr names it.
    #[must_use]
    pub fn carry_table(&self, mode: &str) -> Option<u16> {
        self.file.carry_tables.get(mode).copied()
    }

    /// The two wires that a pad at the bottom needs at a level.
    #[must_use]
    pub fn bottom_wires(&self) -> &[String; 2] {
        &self.file.bottom_wires
    }

    /// Whether a spine of the clock network passes a tile.
    #[must_use]
    pub fn passes(&self, spine: &str, row: u8, column: u8) -> bool {
        let places = self.file.spines.get(spine);
        places.is_some_and(|places| places.contains(&(row, column)))
    }

    /// The two ends of each long wire: row, column and name.
    pub fn long_wires(&self) -> impl Iterator<Item = [(u8, u8, &str); 2]> {
        self.file.segments.iter().map(|segment| {
            [
                (segment.top_row, segment.column, segment.top_wire.as_str()),
                (segment.bottom_row, segment.column, segment.bottom_wire.as_str()),
            ]
        })
    }

    /// The rows of tiles with block RAMs, from the top.
    #[must_use]
    pub fn memory_rows(&self) -> &[u8] {
        &self.file.memory_rows
    }

    /// The column, from that of its first tile, of a bit of a block RAM's contents: bit 0 to 17 of a word of 18, and the highest two bits of
    /// its address.
    #[must_use]
    pub fn memory_column(&self, bit: usize, high: usize) -> Option<usize> {
        self.file.memory_columns.get(bit)?.get(high).copied()
    }

    /// The name of a wire at its tile.
    #[must_use]
    pub fn name(&self, wire: GowinWire) -> &str {
        &self.names[wire.name as usize]
    }

    /// The wire of this name at a tile, by the one that stands for all that are joined with it: a wire between tiles is named where it
    /// begins. `None` for a name that the database does not have.
    #[must_use]
    pub fn wire(&self, row: u8, column: u8, name: &str) -> Option<GowinWire> {
        let (row, column, name) = match self.origin(row, column, name) {
            Some((row, column, name)) => (row, column, *self.indices.get(&name)?),
            None => (row, column, *self.indices.get(name)?),
        };
        let wire = GowinWire { row, column, name };
        Some(self.joined.get(&wire).copied().unwrap_or(wire))
    }

    /// Where a wire between tiles begins: `N232` is, two tiles on, the wire `N230` of another tile. At the edge of the device, wires turn
    /// back. A wire of one tile's length to both sides begins as `SN10` or `EW10`.
    fn origin(&self, row: u8, column: u8, name: &str) -> Option<(u8, u8, String)> {
        let [direction, length, number, tiles] = name.as_bytes() else {
            return None;
        };
        if !matches!(length, b'1' | b'2' | b'8') || !number.is_ascii_digit() || !matches!(tiles, b'1'..=b'8') {
            return None;
        }
        let tiles = i16::from(tiles - b'0');
        let (down, right, back) = match direction {
            b'N' => (1, 0, b'S'),
            b'S' => (-1, 0, b'N'),
            b'E' => (0, -1, b'W'),
            b'W' => (0, 1, b'E'),
            _ => return None,
        };
        let mut direction = *direction;
        let mut reflected = |at: i16, end: u8| {
            let end = i16::from(end);
            let inside = if at < 0 {
                -1 - at
            } else if at >= end {
                2 * end - 1 - at
            } else {
                return at as u8;
            };
            direction = back;
            inside as u8
        };
        let row = reflected(i16::from(row) + down * tiles, self.rows());
        let column = reflected(i16::from(column) + right * tiles, self.columns());
        let (length, number) = (char::from(*length), char::from(*number));
        let name = match (length, number, direction) {
            ('1', '1' | '2', b'N' | b'S') => format!("SN{number}0"),
            ('1', '1' | '2', _) => format!("EW{number}0"),
            _ => format!("{}{length}{number}0", char::from(direction)),
        };
        Some((row, column, name))
    }
}

/// The beginnings of parts of these sizes, and the end of the last.
fn starts(sizes: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut starts = vec![0];
    for size in sizes {
        starts.push(starts.last().copied().unwrap_or(0) + size);
    }
    starts
}

fn unreadable(reason: String) -> BitstreamError {
    BitstreamError::Unreadable { tool: TOOL, reason }
}
