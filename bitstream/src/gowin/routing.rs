//! Follows the wires of a Gowin device from an input of a cell back to what drives it.

use super::database::{GowinDatabase, GowinWire};
use super::tiles::DecodedTiles;
use crate::BitstreamError;
use std::collections::HashMap;
use std::fmt;

/// Longest way of a net, in wires: no device has as long a one without a loop.
const LONGEST_WAY: usize = 10_000;
/// Bits of the outputs of a block RAM.
pub(super) const MEMORY_OUTPUTS: u8 = 36;

/// What drives a wire.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum GowinSource {
    /// Always this level.
    Constant(bool),
    /// An output of a cell, or an input pin.
    Output(GowinOutput),
    /// Nothing: the wire has no switch that is on.
    Nothing,
}

/// An output of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct GowinOutput {
    /// Row of the cell's tile.
    pub row: u8,
    /// Column of the cell's tile.
    pub column: u8,
    /// The output.
    pub port: GowinPort,
}

/// The outputs of the cells of a tile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum GowinPort {
    /// Look-up table 0 to 7, with the carry in a carry chain.
    Table(u8),
    /// Multiplexer 0 to 7 behind the tables.
    Multiplexer(u8),
    /// Carry of look-up table 0 to 5.
    Carry(u8),
    /// Flip-flop 0 to 5.
    Flop(u8),
    /// A bit of the block RAM whose first tile this is.
    Memory(u8),
    /// An input pin, by the letter of its pad.
    Pad(char),
}

impl fmt::Display for GowinSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Constant(level) => write!(f, "{}", u8::from(*level)),
            Self::Output(output) => write!(f, "{output}"),
            Self::Nothing => f.write_str("nothing"),
        }
    }
}

impl fmt::Display for GowinOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "R{}C{} ", self.row, self.column)?;
        match self.port {
            GowinPort::Table(table) => write!(f, "F{table}"),
            GowinPort::Multiplexer(index) => write!(f, "OF{index}"),
            GowinPort::Carry(table) => write!(f, "COUT{table}"),
            GowinPort::Flop(flop) => write!(f, "Q{flop}"),
            GowinPort::Memory(bit) => write!(f, "DO{bit}"),
            GowinPort::Pad(letter) => write!(f, "pad {letter}"),
        }
    }
}

/// The output of this name in a tile with logic.
fn logic_output(name: &str) -> Option<GowinPort> {
    let number = |prefix: &str, count: u8| {
        let number = name.strip_prefix(prefix)?.parse::<u8>().ok()?;
        (number < count).then_some(number)
    };
    number("F", 8)
        .map(GowinPort::Table)
        .or_else(|| number("OF", 8).map(GowinPort::Multiplexer))
        .or_else(|| number("Q", 6).map(GowinPort::Flop))
}

/// What is connected in a bitstream.
#[derive(Debug)]
pub struct GowinRouting<'a> {
    database: &'a GowinDatabase,
    tiles: &'a DecodedTiles,
    /// Outputs of pads and memories.
    outputs: HashMap<GowinWire, GowinOutput>,
}

impl<'a> GowinRouting<'a> {
    /// The connections that these tiles make.
    #[must_use]
    pub fn new(tiles: &'a DecodedTiles, database: &'a GowinDatabase) -> Self {
        let mut outputs = HashMap::new();
        for row in 0..database.rows() {
            for column in 0..database.columns() {
                let kind = database.kind(row, column);
                for (port, name) in kind.into_iter().flat_map(|kind| &kind.ports) {
                    let letter = port.strip_suffix(".O").and_then(|letter| letter.chars().next());
                    let bit = port.strip_prefix("DO").and_then(|bit| bit.parse().ok());
                    let port = letter.map(GowinPort::Pad).or(bit.map(GowinPort::Memory));
                    if let (Some(port), Some(wire)) = (port, database.wire(row, column, name)) {
                        outputs.insert(wire, GowinOutput { row, column, port });
                    }
                }
            }
        }
        Self {
            database,
            tiles,
            outputs,
        }
    }

    /// The database.
    #[must_use]
    pub fn database(&self) -> &'a GowinDatabase {
        self.database
    }

    /// The tiles.
    #[must_use]
    pub fn tiles(&self) -> &'a DecodedTiles {
        self.tiles
    }

    /// What drives the wire `name` of a tile in the end.
    ///
    /// # Errors
    /// [`BitstreamError::UnknownCell`] for a wire that the database does not know, and for wires that drive each other in a loop.
    pub fn source(&self, row: u8, column: u8, name: &str) -> Result<GowinSource, BitstreamError> {
        let unknown = |what: &str| {
            Err(BitstreamError::UnknownCell(format!(
                "{name} at R{row}C{column}: {what}"
            )))
        };
        let Some(mut wire) = self.database.wire(row, column, name) else {
            return unknown("the database has no such wire");
        };
        for _ in 0..LONGEST_WAY {
            match self.database.name(wire) {
                "VCC" => return Ok(GowinSource::Constant(true)),
                "VSS" => return Ok(GowinSource::Constant(false)),
                _ => {}
            }
            if let Some(output) = self.output(wire) {
                return Ok(GowinSource::Output(output));
            }
            match self.driver(wire) {
                Some(driver) => wire = driver,
                None => return Ok(GowinSource::Nothing),
            }
        }
        unknown("the wires before it are a loop")
    }

    /// The output that this wire is.
    fn output(&self, wire: GowinWire) -> Option<GowinOutput> {
        if let Some(output) = self.outputs.get(&wire) {
            return Some(*output);
        }
        let kind = self.database.kind(wire.row, wire.column)?;
        let is_logic = !kind.slices.is_empty();
        let port = logic_output(self.database.name(wire)).filter(|_| is_logic)?;
        Some(GowinOutput {
            row: wire.row,
            column: wire.column,
            port,
        })
    }

    /// The wire that drives a wire at once: by the switch that is on, or else by the one without bits, which is always on.
    fn driver(&self, wire: GowinWire) -> Option<GowinWire> {
        if let Some(source) = self.tiles.switched.get(&wire) {
            return Some(*source);
        }
        let sources = self
            .database
            .kind(wire.row, wire.column)?
            .switches
            .get(self.database.name(wire))?;
        let mut idle = sources.iter().filter(|(_, bits)| bits.is_empty());
        let (source, _) = idle.next()?;
        self.database.wire(wire.row, wire.column, source)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outputs_of_logic_are_known_by_their_names() {
        for (name, port) in [
            ("F7", Some(GowinPort::Table(7))),
            ("OF3", Some(GowinPort::Multiplexer(3))),
            ("Q5", Some(GowinPort::Flop(5))),
            ("Q6", None),
            ("F8", None),
            ("OF30", None),
            ("A0", None),
        ] {
            assert_eq!(logic_output(name), port, "{name}");
        }
    }
}
