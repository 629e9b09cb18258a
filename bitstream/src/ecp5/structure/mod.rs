//! Compares what the bits set and connect with the placed netlist of the router: cell by cell, connection by connection.
//!
//! Nets are compared by what drives them. A look-up table is compared as a function of its drivers, because the router may swap a table's
//! inputs.

mod memories;

use super::database::Pad;
use super::decode::DecodedBits;
use super::distributed_ram;
use super::memory;
use super::routed::{RoutedCell, RoutedNetlist};
use super::routing::{CellPort, OutputPort, Routing, Source, slice_letter};
use super::slice::{Enable, FlopSettings, ResetLine, SliceSettings, carry_before, table_input};
use crate::BitstreamError;
use crate::boards::TopPin;
use crate::function;
use crate::report::CellsReport;
use serde_json::Value;
use std::collections::BTreeSet;

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
            // Where a write port takes the place of two tables, the router puts marks into theirs.
            "TRELLIS_COMB" if cell.parameter("MODE") == "RAMW_BLOCK" => {}
            "TRELLIS_COMB" => comparison.table(cell)?,
            "TRELLIS_FF" => comparison.flop(cell)?,
            "TRELLIS_RAMW" => comparison.write_port(cell)?,
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
        if mode == "DPRAM" {
            let is_same_memory = routed.as_ref() == Some(&bits) && init == found;
            self.setting(
                cell,
                "distributed RAM: other contents, or another address that is read",
                is_same_memory,
            );
            self.written_table(cell, index)?;
        } else {
            self.setting(cell, "look-up table: another function of its inputs", is_same_table);
        }
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
                "TRELLIS_COMB" if cell.parameter("MODE") == "RAMW_BLOCK" => {}
                "TRELLIS_COMB" => {
                    known.extend([OutputPort::Table(index), OutputPort::Carry(index)].map(at));
                    known.insert(at(cell.output("OFX").unwrap_or(OutputPort::Table(index))));
                }
                "TRELLIS_FF" => _ = known.insert(at(OutputPort::Flop(index))),
                "TRELLIS_RAMW" => {
                    let address = (0..distributed_ram::BITS).map(OutputPort::WriteAddress);
                    known.extend(
                        address
                            .chain((0..distributed_ram::BITS).map(OutputPort::WriteData))
                            .map(at),
                    );
                }
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

fn constant(source: Source) -> Option<bool> {
    match source {
        Source::Constant(level) => Some(level),
        Source::Output(_) => None,
    }
}
