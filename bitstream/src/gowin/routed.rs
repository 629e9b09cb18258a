//! The placed netlist that nextpnr writes for a Gowin device.

use super::kind::{MemoryPorts, MemoryUse};
use super::memory::{WORD_BITS, WORDS};
use super::routing::{GowinOutput, GowinPort, GowinSource, MEMORY_OUTPUTS};
use crate::BitstreamError;
use serde_json::Value;
use std::collections::HashMap;

/// Name of the program that wrote the netlist, for errors.
const TOOL: &str = "nextpnr-himbaechel-gowin";

/// The router's netlist.
pub(super) struct RoutedGowin<'a> {
    pub(super) cells: Vec<RoutedGowinCell<'a>>,
    /// What drives each net.
    drivers: HashMap<u64, GowinSource>,
    /// The net before each net of the clock network that a buffer drives.
    buffered: HashMap<u64, u64>,
}

/// A cell of the router's netlist.
#[derive(Clone, Copy)]
pub(super) struct RoutedGowinCell<'a> {
    pub(super) kind: &'a str,
    cell: &'a Value,
    pub(super) row: u8,
    pub(super) column: u8,
    /// Its name in its tile, such as `LUT3`.
    site: &'a str,
}

impl<'a> RoutedGowin<'a> {
    pub(super) fn read(module: &'a Value) -> Result<Self, BitstreamError> {
        let cells = module["cells"].as_object().into_iter().flatten();
        let cells = cells.map(|(name, cell)| {
            RoutedGowinCell::read(cell).ok_or_else(|| unreadable(format!("the cell {name} has no place")))
        });
        let cells = cells.collect::<Result<Vec<_>, _>>()?;
        let (mut drivers, mut buffered) = (HashMap::new(), HashMap::new());
        for cell in &cells {
            if let ("BUFG", Some(input), Some(output)) = (cell.kind, cell.net("I"), cell.net("O")) {
                buffered.insert(output, input);
            }
            for (port, source) in cell.sources() {
                if let Some(net) = cell.net(port) {
                    drivers.insert(net, source);
                }
            }
        }
        Ok(Self {
            cells,
            drivers,
            buffered,
        })
    }

    /// What drives a net.
    pub(super) fn driver(&self, net: u64) -> GowinSource {
        let net = self.buffered.get(&net).copied().unwrap_or(net);
        self.drivers.get(&net).copied().unwrap_or(GowinSource::Nothing)
    }

    /// What drives a port.
    pub(super) fn source(&self, cell: &RoutedGowinCell<'_>, port: &str) -> GowinSource {
        cell.net(port).map_or(GowinSource::Nothing, |net| self.driver(net))
    }
}

impl<'a> RoutedGowinCell<'a> {
    fn read(cell: &'a Value) -> Option<Self> {
        let place = cell["attributes"]["NEXTPNR_BEL"].as_str()?;
        let mut parts = place.split('/');
        let column = parts.next()?.strip_prefix('X')?;
        let (column, row) = column.split_once('Y')?;
        Some(Self {
            kind: cell["type"].as_str()?,
            cell,
            row: row.parse().ok()?,
            column: column.parse().ok()?,
            site: parts.next()?,
        })
    }

    pub(super) fn place(&self) -> String {
        format!("R{}C{} {}", self.row, self.column, self.site)
    }

    /// Its output at a port of its tile.
    pub(super) fn output(&self, port: GowinPort) -> GowinOutput {
        GowinOutput {
            row: self.row,
            column: self.column,
            port,
        }
    }

    /// The digit at the end of its site.
    pub(super) fn index(&self) -> Result<u8, BitstreamError> {
        let digit = self.site.bytes().next_back().filter(u8::is_ascii_digit);
        digit
            .map(|digit| digit - b'0')
            .ok_or_else(|| unreadable(format!("a cell at {}", self.place())))
    }

    /// The pad of a buffer.
    pub(super) fn pad(&self) -> Result<GowinOutput, BitstreamError> {
        let letter = self.site.strip_prefix("IOB").and_then(|letter| letter.chars().next());
        letter
            .map(|letter| self.output(GowinPort::Pad(letter)))
            .ok_or_else(|| unreadable(format!("a pad at {}", self.place())))
    }

    /// A parameter as text; empty if there is none.
    pub(super) fn parameter(&self, name: &str) -> &'a str {
        self.cell["parameters"][name].as_str().unwrap_or_default().trim()
    }

    pub(super) fn has(&self, parameter: &str) -> bool {
        self.cell["parameters"].get(parameter).is_some()
    }

    /// A parameter of binary digits as a number.
    pub(super) fn number(&self, name: &str) -> Option<u64> {
        u64::from_str_radix(self.parameter(name), 2).ok()
    }

    /// A table of at most 16 entries; a shorter one is repeated.
    pub(super) fn table(&self, name: &str) -> Result<u16, BitstreamError> {
        const ENTRIES: usize = 16;
        let digits = self.parameter(name).as_bytes();
        let digits = &digits[digits.len().saturating_sub(ENTRIES)..];
        if digits.is_empty() || !ENTRIES.is_multiple_of(digits.len()) {
            return Err(unreadable(format!("{}: {name} {}", self.place(), self.parameter(name))));
        }
        let entries = digits.iter().cycle().take(ENTRIES);
        Ok(entries.fold(0, |table, digit| table << 1 | u16::from(*digit == b'1')))
    }

    /// A setting of a pad, which nextpnr writes as an attribute `&NAME=VALUE`.
    pub(super) fn attribute(&self, name: &str) -> Option<&'a str> {
        let attributes = self.cell["attributes"].as_object()?;
        let mut settings = attributes
            .keys()
            .filter_map(|key| key.strip_prefix('&')?.split_once('='));
        settings.find(|(key, _)| *key == name).map(|(_, value)| value)
    }

    fn net(&self, port: &str) -> Option<u64> {
        self.cell["connections"][port][0].as_u64()
    }

    pub(super) fn is_open(&self, port: &str) -> bool {
        self.net(port).is_none()
    }

    /// The names of its inputs.
    pub(super) fn inputs(&self) -> impl Iterator<Item = &'a str> {
        let ports = self.cell["port_directions"].as_object().into_iter().flatten();
        ports
            .filter(|(_, direction)| *direction == "input")
            .map(|(port, _)| port.as_str())
    }

    /// Its outputs, with their ports.
    fn sources(&self) -> Vec<(&'a str, GowinSource)> {
        let index = self.index();
        let at = |port: &'a str, of: fn(u8) -> GowinPort| {
            let index = index.as_ref().ok().copied();
            index.map(|index| (port, GowinSource::Output(self.output(of(index)))))
        };
        let found: Vec<Option<(&'a str, GowinSource)>> = match self.kind {
            "GOWIN_VCC" => vec![Some(("V", GowinSource::Constant(true)))],
            "GOWIN_GND" => vec![Some(("G", GowinSource::Constant(false)))],
            "IBUF" => vec![self.pad().ok().map(|pad| ("O", GowinSource::Output(pad)))],
            "SDP" | "DP" => {
                let ports = self.cell["connections"].as_object().into_iter().flatten();
                let bit = |port: &'a str| {
                    let name = port.strip_prefix("DO")?;
                    let bit = match name.strip_prefix('B') {
                        Some(bit) => MEMORY_OUTPUTS / 2 + bit.parse::<u8>().ok()?,
                        None => name.trim_start_matches('A').parse().ok()?,
                    };
                    Some((port, GowinSource::Output(self.output(GowinPort::Memory(bit)))))
                };
                ports.map(|(port, _)| bit(port)).collect()
            }
            "ALU" => vec![at("SUM", GowinPort::Table), at("COUT", GowinPort::Carry)],
            kind if kind.starts_with("LUT") => vec![at("F", GowinPort::Table)],
            kind if kind.starts_with("MUX2") => vec![at("O", GowinPort::Multiplexer)],
            kind if kind.starts_with("DFF") => vec![at("Q", GowinPort::Flop)],
            _ => Vec::new(),
        };
        found.into_iter().flatten().collect()
    }

    /// The outputs that it may have in the bits.
    pub(super) fn outputs(&self) -> Vec<GowinOutput> {
        if matches!(self.kind, "SDP" | "DP") {
            let bits = 0..MEMORY_OUTPUTS;
            return bits.map(|bit| self.output(GowinPort::Memory(bit))).collect();
        }
        let outputs = self.sources().into_iter().filter_map(|(_, source)| match source {
            GowinSource::Output(output) => Some(output),
            _ => None,
        });
        outputs.collect()
    }

    /// The use of a memory.
    pub(super) fn memory(&self) -> Result<MemoryUse, BitstreamError> {
        let refused = |what: &str| BitstreamError::UnknownCell(format!("{}: a memory with {what}", self.place()));
        let number = |key: &str| self.number(key).and_then(|number| u8::try_from(number).ok());
        let (kind, reads, modes) = match self.kind {
            "SDP" => (MemoryPorts::Simple, ["READ_MODE"; 2], [Some(0); 2]),
            _ => {
                let modes = ["WRITE_MODE0", "WRITE_MODE1"].map(number);
                (MemoryPorts::Dual, ["READ_MODE0", "READ_MODE1"], modes)
            }
        };
        let [Some(width), Some(other)] = ["BIT_WIDTH_0", "BIT_WIDTH_1"].map(number) else {
            return Err(refused("no width"));
        };
        if width != other || reads.map(number) != [Some(0); 2] {
            return Err(refused("ports of other widths, or with a second register"));
        }
        let [Some(first), Some(second)] = modes else {
            return Err(refused("no modes"));
        };
        Ok(MemoryUse {
            kind,
            modes: [first, second],
            // Words of 8 bits leave the ninth out.
            width: if width.is_multiple_of(8) { width / 8 * 9 } else { width },
            registered: false,
            asynchronous: self.parameter("RESET_MODE") == "ASYNC",
        })
    }

    /// Contents of a memory, in words of 18 bits.
    pub(super) fn contents(&self) -> Vec<u64> {
        const PART: usize = WORD_BITS / 2;
        const ROWS: usize = 64;
        let has_ninth = self.cell["attributes"]["BSRAM_SUBTYPE"].as_str().map(str::trim) == Some("X9");
        let part_digits = if has_ninth { PART } else { PART - 1 };
        let rows = (0..ROWS).flat_map(|row| {
            let mut digits: Vec<u8> = self.parameter(&format!("INIT_RAM_{row:02X}")).bytes().rev().collect();
            digits.resize(2 * part_digits * WORDS / ROWS, b'0');
            let words = digits.chunks(2 * part_digits).map(|word| {
                let parts = word.chunks(part_digits).map(|part| {
                    let bits = part.iter().rev();
                    bits.fold(0u64, |value, digit| value << 1 | u64::from(*digit == b'1'))
                });
                parts.rev().fold(0, |word, part| word << PART | part)
            });
            words.collect::<Vec<_>>()
        });
        rows.collect()
    }
}

pub(super) fn unreadable(reason: String) -> BitstreamError {
    BitstreamError::Unreadable { tool: TOOL, reason }
}
