//! The netlist that nextpnr has placed and routed.

use super::routing::{CellPort, OutputPort, Source};
use crate::BitstreamError;
use serde_json::Value;
use std::collections::HashMap;

/// Name of the program that wrote the netlist, for errors.
const TOOL: &str = "nextpnr-ecp5";

/// The router's netlist.
pub(super) struct RoutedNetlist<'a> {
    pub(super) cells: Vec<RoutedCell<'a>>,
    /// What drives each net.
    drivers: HashMap<u64, RoutedDriver<'a>>,
}

/// A cell of the router's netlist.
#[derive(Clone, Copy)]
pub(super) struct RoutedCell<'a> {
    pub(super) kind: &'a str,
    pub(super) cell: &'a Value,
    pub(super) row: u8,
    pub(super) column: u8,
    /// Its name in its tile, such as `SLICEA.K0`.
    pub(super) site: &'a str,
}

#[derive(Clone, Copy)]
enum RoutedDriver<'a> {
    Output(CellPort),
    /// A clock's gate.
    Gate(RoutedCell<'a>),
}

impl<'a> RoutedCell<'a> {
    fn read(cell: &'a Value) -> Option<Self> {
        let place = cell["attributes"]["NEXTPNR_BEL"].as_str()?;
        let mut parts = place.split('/');
        let column = parts.next()?.strip_prefix('X')?.parse().ok()?;
        let row = parts.next()?.strip_prefix('Y')?.parse().ok()?;
        Some(Self {
            kind: cell["type"].as_str()?,
            cell,
            row,
            column,
            site: parts.next()?,
        })
    }

    pub(super) fn place(&self) -> String {
        format!("R{}C{} {}", self.row, self.column, self.site)
    }

    /// Index 0 to 7 of the table or flip-flop in its tile.
    pub(super) fn index(&self) -> Result<u8, BitstreamError> {
        let letter = self.site.strip_prefix("SLICE").and_then(|site| site.bytes().next());
        let half = self.site.bytes().next_back();
        match (letter, half) {
            (Some(letter @ b'A'..=b'D'), Some(half @ b'0'..=b'1')) => Ok(2 * (letter - b'A') + half - b'0'),
            _ => Err(unreadable(format!("a cell at {}", self.place()))),
        }
    }

    /// A parameter as text; empty if there is none.
    pub(super) fn parameter(&self, name: &str) -> &'a str {
        self.cell["parameters"][name].as_str().unwrap_or_default().trim()
    }

    /// A parameter of binary digits as a number.
    pub(super) fn number(&self, name: &str) -> u64 {
        u64::from_str_radix(self.parameter(name), 2).unwrap_or_default()
    }

    pub(super) fn net(&self, port: &str) -> Option<u64> {
        self.cell["connections"][port][0].as_u64()
    }

    pub(super) fn is_open(&self, port: &str) -> bool {
        self.net(port).is_none()
    }

    /// The cell's output at a port; `None` if that is an input.
    pub(super) fn output(&self, port: &str) -> Option<OutputPort> {
        let bit = |prefix: &str| port.strip_prefix(prefix).and_then(|bit| bit.parse().ok());
        match (self.kind, port) {
            ("TRELLIS_COMB", "F") => self.index().ok().map(OutputPort::Table),
            ("TRELLIS_COMB", "FCO") => self.index().ok().map(OutputPort::Carry),
            ("TRELLIS_COMB", "OFX") => self.index().ok().map(|index| match index % 2 {
                0 => OutputPort::TwoTables(index / 2),
                _ => OutputPort::TwoSlices(index / 2),
            }),
            ("TRELLIS_RAMW", _) => bit("WADO")
                .map(OutputPort::WriteAddress)
                .or_else(|| bit("WDO").map(OutputPort::WriteData)),
            ("TRELLIS_FF", "Q") => self.index().ok().map(OutputPort::Flop),
            ("DP16KD", _) => bit("DOA")
                .map(OutputPort::MemoryA)
                .or_else(|| bit("DOB").map(OutputPort::MemoryB)),
            ("TRELLIS_IO", "O") => self.site.chars().last().map(OutputPort::Pad),
            _ => None,
        }
    }
}

impl<'a> RoutedNetlist<'a> {
    pub(super) fn read(module: &'a Value) -> Result<Self, BitstreamError> {
        let cells = module["cells"].as_object().into_iter().flatten();
        let cells = cells.map(|(name, cell)| {
            RoutedCell::read(cell).ok_or_else(|| unreadable(format!("the cell {name} has no place")))
        });
        let cells = cells.collect::<Result<Vec<_>, _>>()?;
        let mut drivers = HashMap::new();
        for cell in &cells {
            for port in cell.cell["connections"]
                .as_object()
                .into_iter()
                .flat_map(|ports| ports.keys())
            {
                let Some(net) = cell.net(port) else {
                    continue;
                };
                if (cell.kind, port.as_str()) == ("DCCA", "CLKO") {
                    drivers.insert(net, RoutedDriver::Gate(*cell));
                } else if let Some(port) = cell.output(port) {
                    let (row, column) = (cell.row, cell.column);
                    drivers.insert(net, RoutedDriver::Output(CellPort { row, column, port }));
                }
            }
        }
        Ok(Self { cells, drivers })
    }

    /// What drives a port; an open one is high.
    pub(super) fn source(&self, cell: &RoutedCell<'_>, port: &str) -> Option<Source> {
        let mut net = cell.net(port);
        // A clock passes at most one gate, and its pad.
        for _ in 0..4 {
            let Some(of) = net else {
                return Some(Source::Constant(true));
            };
            match self.drivers.get(&of)? {
                RoutedDriver::Output(output) => return Some(Source::Output(*output)),
                RoutedDriver::Gate(gate) => net = gate.net("CLKI"),
            }
        }
        None
    }
}

/// The output of the cell that drives the net of this name in the router's netlist.
pub(super) fn output_of_net(routed: &Value, name: &str) -> Result<CellPort, BitstreamError> {
    let net = routed["netnames"][name]["bits"][0].as_u64();
    let driver = net.and_then(|net| RoutedNetlist::read(routed).ok()?.drivers.get(&net).copied());
    match driver {
        Some(RoutedDriver::Output(output)) => Ok(output),
        _ => Err(unreadable(format!("no cell drives the net {name}"))),
    }
}

/// Contents of a memory of the router's netlist, in words of 9 bits.
pub(super) fn routed_contents(cell: &RoutedCell<'_>) -> Vec<u16> {
    /// Each parameter has 16 pairs of words, padded to 20 bits.
    const ROWS: usize = 64;
    const PAIRS: usize = 16;
    const PAIR_DIGITS: usize = 20;
    const WORD_DIGITS: usize = 9;
    let rows = (0..ROWS).flat_map(|row| {
        let mut digits: Vec<u8> = cell.parameter(&format!("INITVAL_{row:02X}")).bytes().rev().collect();
        digits.resize(PAIRS * PAIR_DIGITS, b'0');
        let words = digits.chunks(PAIR_DIGITS).flat_map(|pair| {
            let words = pair[..2 * WORD_DIGITS].chunks(WORD_DIGITS);
            words
                .map(|word| {
                    word.iter()
                        .rev()
                        .fold(0u16, |word, digit| word << 1 | u16::from(*digit == b'1'))
                })
                .collect::<Vec<_>>()
        });
        words.collect::<Vec<_>>()
    });
    rows.collect()
}

fn unreadable(reason: String) -> BitstreamError {
    BitstreamError::Unreadable { tool: TOOL, reason }
}
