//! Compares what the bits set and connect with the placed netlist of the router: cell by cell, connection by connection.
//!
//! Nets are compared by what drives them. A look-up table is compared as a function of its drivers, because the router may swap a table's
//! inputs.

use super::database::Pad;
use super::decode::{DecodedBits, Enable, FlopSettings, ResetLine, SliceSettings, carry_before, table_input};
use super::memory;
use super::routing::{CellPort, OutputPort, Routing, Source, slice_letter};
use crate::BitstreamError;
use crate::boards::TopPin;
use crate::function;
use crate::report::CellsReport;
use serde_json::Value;
use std::collections::{BTreeSet, HashMap};

/// Name of the program that wrote the netlist, for errors.
const TOOL: &str = "nextpnr-ecp5";
/// Inputs of a table.
const TABLE_PINS: [&str; 4] = ["A", "B", "C", "D"];

/// Compares the bits with the router's netlist.
///
/// # Errors
/// [`BitstreamError::Unreadable`] for a router's netlist of another form, [`BitstreamError::UnknownCell`] for a kind of cell that is not
/// compared here.
pub fn compare_cells(
    routing: &Routing<'_>,
    bits: &DecodedBits,
    routed: &Value,
    pins: &[TopPin],
) -> Result<CellsReport, BitstreamError> {
    let routed = RoutedNetlist::read(routed)?;
    let mut comparison = Comparison {
        routing,
        routed: &routed,
        report: CellsReport::default(),
    };
    for cell in &routed.cells {
        match cell.kind {
            "TRELLIS_COMB" => comparison.table(cell)?,
            "TRELLIS_FF" => comparison.flop(cell)?,
            "DP16KD" => comparison.memory(cell)?,
            "TRELLIS_IO" => comparison.pad(cell)?,
            // A clock's gate without an enable is always open.
            "DCCA" if cell.is_open("CE") => {}
            other => {
                return Err(BitstreamError::UnknownCell(format!("{}: a cell {other}", cell.place())));
            }
        }
    }
    comparison.left_over(bits);
    comparison.pins(pins)?;
    Ok(comparison.report)
}

/// The output of the cell that drives the net of this name in the router's netlist.
pub fn output_of_net(routed: &Value, name: &str) -> Result<CellPort, BitstreamError> {
    let net = routed["netnames"][name]["bits"][0].as_u64();
    let driver = net.and_then(|net| RoutedNetlist::read(routed).ok()?.drivers.get(&net).copied());
    match driver {
        Some(RoutedDriver::Output(output)) => Ok(output),
        _ => Err(unreadable(format!("no cell drives the net {name}"))),
    }
}

/// The router's netlist.
struct RoutedNetlist<'a> {
    cells: Vec<RoutedCell<'a>>,
    /// What drives each net.
    drivers: HashMap<u64, RoutedDriver<'a>>,
}

/// A cell of the router's netlist.
#[derive(Clone, Copy)]
struct RoutedCell<'a> {
    kind: &'a str,
    cell: &'a Value,
    row: u8,
    column: u8,
    /// Its name in its tile, such as `SLICEA.K0`.
    site: &'a str,
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

    fn place(&self) -> String {
        format!("R{}C{} {}", self.row, self.column, self.site)
    }

    /// Index 0 to 7 of the table or flip-flop in its tile.
    fn index(&self) -> Result<u8, BitstreamError> {
        let letter = self.site.strip_prefix("SLICE").and_then(|site| site.bytes().next());
        let half = self.site.bytes().next_back();
        match (letter, half) {
            (Some(letter @ b'A'..=b'D'), Some(half @ b'0'..=b'1')) => Ok(2 * (letter - b'A') + half - b'0'),
            _ => Err(unreadable(format!("a cell at {}", self.place()))),
        }
    }

    /// A parameter as text; empty if there is none.
    fn parameter(&self, name: &str) -> &'a str {
        self.cell["parameters"][name].as_str().unwrap_or_default().trim()
    }

    /// A parameter of binary digits as a number.
    fn number(&self, name: &str) -> u64 {
        u64::from_str_radix(self.parameter(name), 2).unwrap_or_default()
    }

    fn net(&self, port: &str) -> Option<u64> {
        self.cell["connections"][port][0].as_u64()
    }

    fn is_open(&self, port: &str) -> bool {
        self.net(port).is_none()
    }

    /// The cell's output at a port; `None` if that is an input.
    fn output(&self, port: &str) -> Option<OutputPort> {
        let bit = |prefix: &str| port.strip_prefix(prefix).and_then(|bit| bit.parse().ok());
        match (self.kind, port) {
            ("TRELLIS_COMB", "F") => self.index().ok().map(OutputPort::Table),
            ("TRELLIS_COMB", "FCO") => self.index().ok().map(OutputPort::Carry),
            ("TRELLIS_COMB", "OFX") => self.index().ok().map(|index| match index % 2 {
                0 => OutputPort::TwoTables(index / 2),
                _ => OutputPort::TwoSlices(index / 2),
            }),
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
    fn read(module: &'a Value) -> Result<Self, BitstreamError> {
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
    fn source(&self, cell: &RoutedCell<'_>, port: &str) -> Option<Source> {
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

struct Comparison<'a> {
    routing: &'a Routing<'a>,
    routed: &'a RoutedNetlist<'a>,
    report: CellsReport,
}

impl Comparison<'_> {
    /// Counts a connection, and a difference if the sources differ.
    fn connection(&mut self, cell: &RoutedCell<'_>, port: &str, routed: Option<Source>, bits: Source) {
        self.report.connections += 1;
        if routed != Some(bits) {
            let routed = routed.map_or_else(|| "nothing".to_owned(), |source| source.to_string());
            self.report.differs(format!(
                "{}, {port}: {routed} in the router's netlist, {bits} in the bits",
                cell.place()
            ));
        }
    }

    /// A difference if a setting of the router's netlist is not that of the bits.
    fn setting(&mut self, cell: &RoutedCell<'_>, what: &str, is_equal: bool) {
        if !is_equal {
            self.report.differs(format!("{}: {what}", cell.place()));
        }
    }

    /// A look-up table, its carry, and the multiplexer behind it.
    fn table(&mut self, cell: &RoutedCell<'_>) -> Result<(), BitstreamError> {
        let (row, column, index) = (cell.row, cell.column, cell.index()?);
        let settings = SliceSettings::new(self.routing, row, column, index);
        let mode = match cell.parameter("MODE") {
            "" => "LOGIC",
            mode => mode,
        };
        self.setting(cell, "another mode", mode == settings.mode());
        let routed = TABLE_PINS.map(|pin| self.routed.source(cell, pin));
        let mut bits = Vec::new();
        for pin in TABLE_PINS {
            bits.push(table_input(self.routing, (row, column), index, pin)?);
        }
        let (init, found) = (cell.number("INITVAL") as u16, settings.table()?);
        self.report.tables += 1;
        self.report.connections += routed
            .iter()
            .filter(|source| !matches!(source, Some(Source::Constant(_))))
            .count() as u64;
        let routed: Option<Vec<Source>> = routed.into_iter().collect();
        let is_same = |width: usize, ours: u16, theirs: u16| {
            let routed = routed.as_ref();
            routed.is_some_and(|routed| function::is_same(constant, (&routed[..width], ours), (&bits[..width], theirs)))
        };
        let is_same_table = is_same(4, init, found);
        let is_same_pair = is_same(2, init & 0xF, found & 0xF);
        self.setting(cell, "look-up table: another function of its inputs", is_same_table);
        if mode == "CCU2" {
            self.report.carries += 1;
            let is_alone = cell.parameter("CCU2_INJECT1") != "NO";
            self.setting(
                cell,
                "carry: it is injected otherwise",
                is_alone == settings.is_carry_alone()?,
            );
            self.setting(cell, "carry: another function of its inputs", is_alone || is_same_pair);
            // Where a chain begins, the carry of the tile on the left comes in, too. It must not go on: the table is 0 then, so that the
            // carry is that of its own inputs, and the sum is not in use.
            let stops = function::is_same(constant, (&[], 0), (&bits, found)) && cell.is_open("F");
            if !(cell.is_open("FCI") && stops) {
                let before = carry_before(self.routing, row, column, index);
                let before = before.map_or(Source::Constant(false), Source::Output);
                let routed = match cell.is_open("FCI") {
                    true => Some(Source::Constant(false)),
                    false => self.routed.source(cell, "FCI"),
                };
                self.connection(cell, "FCI", routed, before);
            }
        }
        if !cell.is_open("OFX") {
            self.multiplexer(cell, index)?;
        }
        Ok(())
    }

    fn multiplexer(&mut self, cell: &RoutedCell<'_>, index: u8) -> Result<(), BitstreamError> {
        let (row, column, slice) = (cell.row, cell.column, index / 2);
        let letter = slice_letter(slice);
        self.report.multiplexers += 1;
        let select = match self
            .routing
            .setting(row, column, &format!("SLICE{letter}.M{}MUX", index % 2))
        {
            Some("1") => Source::Constant(true),
            _ => self.routing.source(row, column, &format!("M{index}_SLICE"))?,
        };
        self.connection(cell, "M", self.routed.source(cell, "M"), select);
        if index.is_multiple_of(2) {
            let above = CellPort {
                row,
                column,
                port: OutputPort::Table(index + 1),
            };
            let routed = self.routed.source(cell, "F1");
            self.connection(cell, "F1", routed, Source::Output(above));
        } else {
            for port in ["FXA", "FXB"] {
                let bits = self.routing.source(row, column, &format!("{port}{letter}_SLICE"))?;
                self.connection(cell, port, self.routed.source(cell, port), bits);
            }
        }
        Ok(())
    }

    fn flop(&mut self, cell: &RoutedCell<'_>) -> Result<(), BitstreamError> {
        let (row, column, index) = (cell.row, cell.column, cell.index()?);
        let (slice, routing) = (index / 2, self.routing);
        let settings = FlopSettings::new(routing, row, column, index)?;
        self.report.flip_flops += 1;
        let is_from_table = cell.parameter("SD") == "1";
        self.setting(
            cell,
            "it takes its data elsewhere",
            is_from_table == settings.is_from_table,
        );
        let (port, bits) = match settings.is_from_table {
            true => ("DI", routing.source(row, column, &format!("DI{index}_SLICE"))?),
            false => {
                let key = format!("SLICE{}.M{}MUX", slice_letter(slice), index % 2);
                let source = match routing.setting(row, column, &key) {
                    Some("1") => Source::Constant(true),
                    _ => routing.source(row, column, &format!("M{index}_SLICE"))?,
                };
                ("M", source)
            }
        };
        self.connection(cell, port, self.routed.source(cell, port), bits);
        let is_set = cell.parameter("REGSET") == "SET";
        self.setting(cell, "another value after a reset", is_set == settings.reset_to);
        let enable = match cell.parameter("CEMUX") {
            "0" => Enable::Never,
            "CE" => Enable::Line { is_inverted: false },
            "INV" => Enable::Line { is_inverted: true },
            _ => Enable::Always,
        };
        self.setting(cell, "another enable", enable == settings.enable);
        if let Enable::Line { .. } = settings.enable {
            let bits = routing.source(row, column, &format!("CE{slice}_SLICE"))?;
            self.connection(cell, "CE", self.routed.source(cell, "CE"), bits);
        }
        let clock = settings.clock.unwrap_or_default();
        let bits = routing.source(row, column, &format!("CLK{clock}"))?;
        self.connection(cell, "CLK", self.routed.source(cell, "CLK"), bits);
        self.setting(cell, "another edge of the clock", cell.parameter("CLKMUX") != "INV");
        let is_asynchronous = cell.parameter("SRMODE") == "ASYNC";
        let is_bits_asynchronous = settings.reset.is_some_and(|reset| reset.is_asynchronous);
        self.setting(
            cell,
            "another kind of reset",
            cell.is_open("LSR") || is_asynchronous == is_bits_asynchronous,
        );
        let routed = match cell.is_open("LSR") {
            true => Some(Source::Constant(false)),
            false => self.routed.source(cell, "LSR"),
        };
        let is_routed_inverted = cell.parameter("LSRMUX") == "INV" && !cell.is_open("LSR");
        let (bits, is_inverted) = match settings.reset {
            None => (Source::Constant(false), false),
            Some(ResetLine { line, is_inverted, .. }) => match routing.source(row, column, &format!("LSR{line}"))? {
                Source::Constant(level) => (Source::Constant(level != is_inverted), false),
                source => (source, is_inverted),
            },
        };
        self.connection(cell, "LSR", routed, bits);
        self.setting(cell, "another polarity of the reset", is_inverted == is_routed_inverted);
        Ok(())
    }

    fn memory(&mut self, cell: &RoutedCell<'_>) -> Result<(), BitstreamError> {
        self.report.memories += 1;
        let settings = memory::Settings::new(self.routing, cell.row, cell.column)?;
        for (key, value) in cell.cell["parameters"].as_object().into_iter().flatten() {
            let value = value.as_str().unwrap_or_default().trim();
            let bits = settings.routed_values(key, value);
            self.setting(
                cell,
                &format!("{key} is {value} in the router's netlist"),
                bits != Some(false),
            );
        }
        let decoded = memory::MemorySettings::new(self.routing, cell.row, cell.column)?;
        let mut stored = self.routing.contents(decoded.contents).to_vec();
        stored.resize(memory::PARTS, 0);
        let routed = routed_contents(cell);
        for (index, _) in stored
            .iter()
            .zip(&routed)
            .enumerate()
            .filter(|(_, (bits, routed))| bits != routed)
        {
            self.setting(cell, &format!("word {index} of its contents"), false);
        }
        for port in memory::inputs() {
            let routed = match (cell.parameter(&format!("{port}MUX")), self.routed.source(cell, &port)) {
                ("0", _) => Some(Source::Constant(false)),
                ("1", _) => Some(Source::Constant(true)),
                ("INV", Some(Source::Constant(level))) => Some(Source::Constant(!level)),
                (_, source) => source,
            };
            let is_routed_inverted = cell.parameter(&format!("{port}MUX")) == "INV";
            let is_inverted = settings.is_inverted(&port, decoded.bits);
            let bits = match self.routing.source(cell.row, cell.column, &format!("J{port}_EBR"))? {
                Source::Constant(level) => Source::Constant(level != is_inverted),
                source => {
                    self.setting(
                        cell,
                        &format!("{port}: another polarity"),
                        is_inverted == is_routed_inverted,
                    );
                    source
                }
            };
            // What the netlist leaves open may be tied to any level.
            let is_open = cell.is_open(&port) && cell.parameter(&format!("{port}MUX")).is_empty();
            let any_level = is_open || !memory::is_used(&port, decoded.bits);
            let constants = [routed.and_then(constant), constant(bits)];
            if !(any_level && constants.iter().all(Option::is_some)) {
                self.connection(cell, &port, routed, bits);
            }
        }
        Ok(())
    }

    /// An output pad.
    fn pad(&mut self, cell: &RoutedCell<'_>) -> Result<(), BitstreamError> {
        self.setting(cell, "an output that is switched off at times", cell.is_open("T"));
        if cell.parameter("DIR") == "OUTPUT" {
            let letter = cell.site.chars().last().unwrap_or_default();
            let bits = self
                .routing
                .source(cell.row, cell.column, &format!("PADDO{letter}_PIO"))?;
            self.connection(cell, "I", self.routed.source(cell, "I"), bits);
        }
        Ok(())
    }

    /// Cells of the bits that the router's netlist does not have.
    fn left_over(&mut self, bits: &DecodedBits) {
        let mut known = BTreeSet::new();
        for cell in &self.routed.cells {
            let at = |port| CellPort {
                row: cell.row,
                column: cell.column,
                port,
            };
            let index = cell.index().unwrap_or_default();
            match cell.kind {
                "TRELLIS_COMB" => {
                    known.extend([OutputPort::Table(index), OutputPort::Carry(index)].map(at));
                    known.insert(at(cell.output("OFX").unwrap_or(OutputPort::Table(index))));
                }
                "TRELLIS_FF" => _ = known.insert(at(OutputPort::Flop(index))),
                "DP16KD" => {
                    let bits = (0..memory::PORT_BITS as u8).map(OutputPort::MemoryA);
                    known.extend(
                        bits.chain((0..memory::PORT_BITS as u8).map(OutputPort::MemoryB))
                            .map(at),
                    );
                }
                "TRELLIS_IO" => known.extend(cell.output("O").map(at)),
                _ => {}
            }
        }
        for output in bits.outputs.keys().filter(|output| !known.contains(output)) {
            self.report.differs(format!("{output}: only in the bits"));
        }
    }

    /// Every pin has its pad in the router's netlist.
    fn pins(&mut self, pins: &[TopPin]) -> Result<(), BitstreamError> {
        for TopPin { port, pin, .. } in pins {
            let Pad { row, column, letter } = self.routing.database().pad(pin)?;
            let is_here = |cell: &&RoutedCell<'_>| {
                cell.kind == "TRELLIS_IO" && (cell.row, cell.column) == (row, column) && cell.site.ends_with(letter)
            };
            if !self.routed.cells.iter().any(|cell| is_here(&cell)) {
                self.report.differs(format!("{port}: no pad in the router's netlist"));
            }
        }
        Ok(())
    }
}

/// Contents of a memory of the router's netlist, in words of 9 bits.
fn routed_contents(cell: &RoutedCell<'_>) -> Vec<u16> {
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

fn constant(source: Source) -> Option<bool> {
    match source {
        Source::Constant(level) => Some(level),
        Source::Output(_) => None,
    }
}

fn unreadable(reason: String) -> BitstreamError {
    BitstreamError::Unreadable { tool: TOOL, reason }
}
