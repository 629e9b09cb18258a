//! Follows the wires of the device from an input of a cell back to what drives it.

use super::config::Config;
use super::database::{Database, Wire, place};
use crate::BitstreamError;
use std::collections::{BTreeMap, HashMap};
use std::fmt;

/// What drives a wire.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Source {
    /// Always this level. A wire that nothing drives is high.
    Constant(bool),
    /// An output of a cell, or an input pin.
    Output(CellPort),
}

/// An output of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CellPort {
    /// Row of the cell's tile.
    pub row: u8,
    /// Column of the cell's tile.
    pub column: u8,
    /// The output.
    pub port: OutputPort,
}

/// The outputs of the cells of a tile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum OutputPort {
    /// Look-up table 0 to 7, with the carry in a slice of a carry chain.
    Table(u8),
    /// Multiplexer between the two tables of slice 0 to 3.
    TwoTables(u8),
    /// Multiplexer between the results of two slices, in slice 0 to 3.
    TwoSlices(u8),
    /// Carry of look-up table 0 to 7.
    Carry(u8),
    /// Flip-flop 0 to 7.
    Flop(u8),
    /// A bit of the write address that slice 2 passes to the small RAMs of slices 0 and 1.
    WriteAddress(u8),
    /// A bit of their write data.
    WriteData(u8),
    /// A bit of port A of a block RAM.
    MemoryA(u8),
    /// A bit of port B of a block RAM.
    MemoryB(u8),
    /// An input pin, by the letter of its pad.
    Pad(char),
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Constant(level) => write!(f, "{}", u8::from(*level)),
            Self::Output(output) => write!(f, "{output}"),
        }
    }
}

impl fmt::Display for CellPort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "R{}C{} ", self.row, self.column)?;
        match self.port {
            OutputPort::Table(table) => write!(f, "F{table}"),
            OutputPort::TwoTables(slice) => write!(f, "OFX0 of slice {}", slice_letter(slice)),
            OutputPort::TwoSlices(slice) => write!(f, "OFX1 of slice {}", slice_letter(slice)),
            OutputPort::Carry(table) => write!(f, "carry of F{table}"),
            OutputPort::Flop(flop) => write!(f, "Q{flop}"),
            OutputPort::WriteAddress(bit) => write!(f, "WADO{bit}"),
            OutputPort::WriteData(bit) => write!(f, "WDO{bit}"),
            OutputPort::MemoryA(bit) => write!(f, "DOA{bit}"),
            OutputPort::MemoryB(bit) => write!(f, "DOB{bit}"),
            OutputPort::Pad(letter) => write!(f, "pad {letter}"),
        }
    }
}

/// The letter of slice 0 to 3.
pub(super) fn slice_letter(slice: u8) -> char {
    char::from(b'A' + slice)
}

impl OutputPort {
    /// The output of this name; `None` for any other wire.
    fn named(name: &str) -> Option<Self> {
        let number = |text: &str| text.parse::<u8>().ok();
        let slice = |text: &str| match text.as_bytes() {
            [letter @ b'A'..=b'D'] => Some(letter - b'A'),
            _ => None,
        };
        if let Some(of) = name.strip_suffix("_SLICE") {
            if let Some(of) = of.strip_prefix("FX").and_then(slice) {
                return Some(Self::TwoSlices(of));
            }
            if let Some(of) = of.strip_prefix("F5").and_then(slice) {
                return Some(Self::TwoTables(of));
            }
            let bit = |prefix: &str| of.strip_prefix(prefix)?.strip_suffix('C').and_then(number);
            return bit("WADO")
                .map(Self::WriteAddress)
                .or_else(|| bit("WDO").map(Self::WriteData))
                .or_else(|| of.strip_prefix('F').and_then(number).map(Self::Table))
                .or_else(|| of.strip_prefix('Q').and_then(number).map(Self::Flop));
        }
        if let Some(of) = name.strip_suffix("_EBR") {
            let bit = |prefix: &str| of.strip_prefix(prefix).and_then(number);
            return bit("JDOA")
                .map(Self::MemoryA)
                .or_else(|| bit("JDOB").map(Self::MemoryB));
        }
        let pad = name.strip_prefix("JPADDI")?.strip_suffix("_PIO")?;
        pad.chars().next().map(Self::Pad)
    }
}

/// What is connected in a bitstream.
#[derive(Debug)]
pub struct Routing<'a> {
    database: &'a Database,
    /// The source of each wire with a switch that is on.
    switched: HashMap<Wire, Wire>,
    /// Wires into a block that are tied to a level.
    tied: HashMap<Wire, bool>,
    settings: HashMap<(u8, u8), HashMap<&'a str, &'a str>>,
    contents: &'a BTreeMap<u32, Vec<u16>>,
}

/// Longest way of a net, in wires: no device has as long a one without a loop.
const LONGEST_WAY: usize = 10_000;

impl<'a> Routing<'a> {
    /// Joins the switches that are on with the wires that are fixed.
    ///
    /// # Errors
    /// [`BitstreamError::UnknownCell`] for a wire with two sources, for a bit without a meaning, and for a tile or a wire that the database
    /// does not know.
    pub fn new(config: &'a Config, database: &'a Database) -> Result<Self, BitstreamError> {
        let unknown = |what: String| Err(BitstreamError::UnknownCell(what));
        let mut switched: HashMap<Wire, Wire> = HashMap::new();
        let mut settings: HashMap<(u8, u8), HashMap<&str, &str>> = HashMap::new();
        for tile in &config.tiles {
            let Some(first) = tile.names.first() else {
                continue;
            };
            if let Some(bit) = tile.unknown.first()
                && tile.names.iter().any(|name| is_of_netlist(name))
            {
                return unknown(format!("{first}: the bit {bit} has no known meaning"));
            }
            for name in &tile.names {
                // Tiles without a place have settings of banks and of the whole device alone.
                if let Some((row, column, _)) = place(name) {
                    let here = settings.entry((row, column)).or_default();
                    here.extend(
                        tile.settings
                            .iter()
                            .map(|[name, value]| (name.as_str(), value.as_str())),
                    );
                } else if !tile.arcs.is_empty() {
                    return unknown(format!("{name}: wires of a tile without a place"));
                }
            }
            let Some((row, column, _)) = place(first) else {
                continue;
            };
            for [sink, source] in &tile.arcs {
                let ends = [sink, source].map(|wire| database.wire(row, column, wire));
                let [Some(sink_wire), Some(source_wire)] = ends else {
                    return unknown(format!("{first}: a switch from {source} to {sink}"));
                };
                if let Some(other) = switched.insert(sink_wire, source_wire)
                    && other != source_wire
                {
                    return unknown(format!("{first}: the wire {sink} has two sources"));
                }
            }
        }
        let mut tied = HashMap::new();
        for ((row, column), values) in &settings {
            for (name, value) in values {
                let wire = name.strip_prefix("CIB.").and_then(|name| name.strip_suffix("MUX"));
                if let (Some(name), "0" | "1") = (wire, *value)
                    && let Some(wire) = database.own_wire(*row, *column, name)
                {
                    // The database calls a tied reset or clock 0; the router, which inverts it to switch a reset off, takes it for 1.
                    let level = *value == "1" || name.starts_with("JLSR") || name.starts_with("JCLK");
                    tied.insert(wire, level);
                }
            }
        }
        Ok(Self {
            database,
            switched,
            tied,
            settings,
            contents: &config.memories,
        })
    }

    /// The database.
    #[must_use]
    pub fn database(&self) -> &'a Database {
        self.database
    }

    /// A setting of the tiles at a place; `None` if it has the value of a device without settings.
    #[must_use]
    pub fn setting(&self, row: u8, column: u8, name: &str) -> Option<&'a str> {
        self.settings.get(&(row, column))?.get(name).copied()
    }

    /// All settings of the tiles at a place.
    pub fn settings(&self, row: u8, column: u8) -> impl Iterator<Item = (&'a str, &'a str)> + '_ {
        let here = self.settings.get(&(row, column));
        here.into_iter().flatten().map(|(name, value)| (*name, *value))
    }

    /// Contents of the block RAMs by number: words of 9 bits; none if they are all 0.
    #[must_use]
    pub fn contents(&self, number: u32) -> &'a [u16] {
        self.contents.get(&number).map_or(&[], Vec::as_slice)
    }

    /// All places with settings.
    pub fn places(&self) -> impl Iterator<Item = (u8, u8)> + '_ {
        self.settings.keys().copied()
    }

    /// The wire that drives a wire at once.
    fn driver(&self, wire: Wire) -> Option<Wire> {
        self.switched.get(&wire).copied().or_else(|| self.database.idle(wire))
    }

    /// The name of the wire that drives the wire `name` of a tile at once.
    #[must_use]
    pub fn driver_name(&self, row: u8, column: u8, name: &str) -> Option<&str> {
        let driver = self.driver(self.database.own_wire(row, column, name)?)?;
        Some(self.database.name(driver))
    }

    /// The table whose carry comes in from the tile on the left, as its row and column; `None` if the carry begins here.
    #[must_use]
    pub fn carry_from(&self, row: u8, column: u8) -> Option<(u8, u8)> {
        let mut wire = self.database.own_wire(row, column, "FCI")?;
        // The carry passes at most two names of the same wire.
        for _ in 0..4 {
            wire = self.driver(wire)?;
            if self.database.name(wire) == "FCO_SLICE" {
                return Some((wire.row, wire.column));
            }
        }
        None
    }

    /// What drives the wire `name` of a tile in the end.
    ///
    /// # Errors
    /// [`BitstreamError::UnknownCell`] for a wire that the database does not know, for one that an unknown block drives, and for wires that
    /// drive each other in a loop.
    pub fn source(&self, row: u8, column: u8, name: &str) -> Result<Source, BitstreamError> {
        let unknown = |what: &str| {
            Err(BitstreamError::UnknownCell(format!(
                "{name} at R{row}C{column}: {what}"
            )))
        };
        let Some(first) = self.database.own_wire(row, column, name) else {
            return unknown("the database has no such wire");
        };
        let mut wire = first;
        for _ in 0..LONGEST_WAY {
            if let Some(level) = self.tied.get(&wire) {
                return Ok(Source::Constant(*level));
            }
            let name = self.database.name(wire);
            if let Some(port) = OutputPort::named(name) {
                return Ok(Source::Output(CellPort {
                    row: wire.row,
                    column: wire.column,
                    port: self.of_sum(wire, port),
                }));
            }
            // A clock's gate, which is always open.
            let next = match name.strip_prefix("G_CLKO_") {
                Some(gate) => self.database.own_wire(0, 0, &format!("G_CLKI_{gate}")),
                None => self.driver(wire),
            };
            match next {
                Some(driver) => wire = driver,
                None if wire != first && is_of_block(name) => {
                    return unknown(&format!(
                        "{name} drives it, an output of a block that is not known here"
                    ));
                }
                None => return Ok(Source::Constant(true)),
            }
        }
        unknown("the wires before it are a loop")
    }

    /// In a slice of a carry chain, the bits that choose a multiplexer at an output of a slice say something else: the output is that of
    /// its table.
    fn of_sum(&self, wire: Wire, port: OutputPort) -> OutputPort {
        let (slice, table) = match port {
            OutputPort::TwoTables(slice) => (slice, 2 * slice),
            OutputPort::TwoSlices(slice) => (slice, 2 * slice + 1),
            _ => return port,
        };
        if self.is_carry_chain(wire.row, wire.column, slice) {
            OutputPort::Table(table)
        } else {
            port
        }
    }

    /// Whether a slice is part of a carry chain.
    #[must_use]
    pub fn is_carry_chain(&self, row: u8, column: u8, slice: u8) -> bool {
        self.setting(row, column, &format!("SLICE{}.MODE", slice_letter(slice))) == Some("CCU2")
    }
}

/// Whether a wire belongs to a block, such as `JP5_MULT18`, not to the routing or to the clock network.
fn is_of_block(name: &str) -> bool {
    name.contains('_') && !["G_", "L_", "R_"].iter().any(|begins| name.starts_with(begins))
}

/// Whether a tile has cells or wires of the netlist: the database names all bits that make them. It does not name all bits of pads, of the
/// clock's spines and of the configuration interface, of which the router sets some in every bitstream.
fn is_of_netlist(name: &str) -> bool {
    place(name).is_some_and(|(_, _, kind)| {
        ["PLC2", "CIB", "MIB_EBR", "TAP"]
            .iter()
            .any(|begins| kind.starts_with(begins))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wires_of_blocks_are_told_from_those_of_the_routing() {
        for name in ["JP5_MULT18", "JCLKOP_PLL", "JQ_IOLOGIC"] {
            assert!(is_of_block(name), "{name}");
        }
        for name in ["V02N0301", "JF3", "G_VPTX0000", "L_HPBX0100"] {
            assert!(!is_of_block(name), "{name}");
        }
    }

    #[test]
    fn outputs_are_known_by_their_names() {
        for (name, port) in [
            ("F3_SLICE", Some(OutputPort::Table(3))),
            ("F5B_SLICE", Some(OutputPort::TwoTables(1))),
            ("FXD_SLICE", Some(OutputPort::TwoSlices(3))),
            ("Q7_SLICE", Some(OutputPort::Flop(7))),
            ("WADO2C_SLICE", Some(OutputPort::WriteAddress(2))),
            ("WDO1C_SLICE", Some(OutputPort::WriteData(1))),
            ("JDOA17_EBR", Some(OutputPort::MemoryA(17))),
            ("JPADDIB_PIO", Some(OutputPort::Pad('B'))),
            ("FXAA_SLICE", None),
            ("A3_SLICE", None),
            ("F3", None),
        ] {
            assert_eq!(OutputPort::named(name), port, "{name}");
        }
    }
}
