//! Compares what a Gowin bitstream's bits set and connect with the placed netlist of the router: cell by cell, connection by connection.
//!
//! Nets are compared by what drives them. A look-up table is compared as a function of its drivers.

use super::decode::{GENERATED, GowinNetlist, carry_before, multiplexed, pad_wire};
use super::kind::SliceReset;
use super::memory::{self, StoredContents};
use super::routed::{RoutedGowin, RoutedGowinCell, unreadable};
use super::routing::{GowinOutput, GowinPort, GowinRouting, GowinSource};
use super::table::table_inputs;
use crate::BitstreamError;
use crate::boards::TopPin;
use crate::function;
use crate::report::CellsReport;
use serde_json::Value;
use std::collections::BTreeSet;

/// Inputs of a table.
const TABLE_PINS: [&str; 4] = ["I0", "I1", "I2", "I3"];
/// Ports of a memory that repeat another one.
const REPEATED_PORTS: [&str; 1] = ["OCE"];

/// Compares the bits with the router's netlist.
///
/// # Errors
/// [`BitstreamError::Unreadable`] for a router's netlist of another form, [`BitstreamError::UnknownCell`] for a kind of cell that is not
/// compared here.
pub fn compare_cells(
    routing: &GowinRouting<'_>,
    bits: &GowinNetlist,
    stored: &StoredContents<'_>,
    routed: &Value,
    pins: &[TopPin],
) -> Result<CellsReport, BitstreamError> {
    let routed = RoutedGowin::read(routed)?;
    let mut comparison = GowinComparison {
        routing,
        routed: &routed,
        report: CellsReport::default(),
    };
    for cell in &routed.cells {
        match cell.kind {
            "LUT1" | "LUT2" | "LUT3" | "LUT4" => comparison.table(cell)?,
            "MUX2_LUT5" | "MUX2_LUT6" | "MUX2_LUT7" | "MUX2_LUT8" => comparison.multiplexer(cell)?,
            "ALU" => comparison.carry(cell)?,
            "SDP" | "DP" => comparison.memory(cell, stored)?,
            "IBUF" | "OBUF" => comparison.pad(cell)?,
            // The reset of the whole device, which is not in use.
            "GSR" if comparison.source(cell, "GSRI") == GowinSource::Constant(true) => {}
            // The ways onto the clock network are switches in the bits.
            "BUFG" | "GOWIN_VCC" | "GOWIN_GND" => {}
            kind if kind.starts_with("DFF") => comparison.flop(cell)?,
            other => {
                return Err(BitstreamError::UnknownCell(format!("{}: a cell {other}", cell.place())));
            }
        }
    }
    comparison.left_over(bits);
    comparison.pins(pins)?;
    Ok(comparison.report)
}

struct GowinComparison<'a> {
    routing: &'a GowinRouting<'a>,
    routed: &'a RoutedGowin<'a>,
    report: CellsReport,
}

impl GowinComparison<'_> {
    fn source(&self, cell: &RoutedGowinCell<'_>, port: &str) -> GowinSource {
        self.routed.source(cell, port)
    }

    /// Counts a connection, and a difference if the sources differ.
    fn connection(&mut self, cell: &RoutedGowinCell<'_>, port: &str, routed: GowinSource, bits: GowinSource) {
        self.report.connections += 1;
        if routed != bits || bits == GowinSource::Nothing {
            self.report.differs(format!(
                "{}, {port}: {routed} in the router's netlist, {bits} in the bits",
                cell.place()
            ));
        }
    }

    /// A difference if a setting of the router's netlist is not that of the bits.
    fn setting(&mut self, cell: &RoutedGowinCell<'_>, what: &str, is_equal: bool) {
        if !is_equal {
            self.report.differs(format!("{}: {what}", cell.place()));
        }
    }

    /// Whether a table of the bits is this function of the router's inputs. What the router leaves open may have any level.
    fn is_function(
        &mut self,
        cell: &RoutedGowinCell<'_>,
        width: usize,
        (values, found): (u16, u16),
    ) -> Result<bool, BitstreamError> {
        let index = cell.index()?;
        let bits = table_inputs(self.routing, cell.output(GowinPort::Table(index)), index)?;
        let routed = TABLE_PINS.map(|pin| self.source(cell, pin));
        let is_used = |source: &&GowinSource| matches!(source, GowinSource::Output(_));
        self.report.connections += routed[..width].iter().filter(is_used).count() as u64;
        let with_open_at = |level| {
            let open = GowinSource::Constant(level);
            routed.map(|source| if source == GowinSource::Nothing { open } else { source })
        };
        let is_same = |level: bool| {
            let inputs = with_open_at(level);
            function::is_same(constant, (&inputs[..width], values), (&bits[..width], found))
        };
        Ok(is_same(false) && is_same(true))
    }

    fn table(&mut self, cell: &RoutedGowinCell<'_>) -> Result<(), BitstreamError> {
        let index = cell.index()?;
        let found = self.routing.tiles().table(cell.row, cell.column, index);
        let values = cell.table("INIT")?;
        let is_same = self.is_function(cell, 4, (values, found))?;
        self.report.tables += 1;
        self.setting(cell, "look-up table: another function of its inputs", is_same);
        self.setting(cell, "a table, and in the bits a carry", !self.is_carry(cell, index));
        Ok(())
    }

    fn is_carry(&self, cell: &RoutedGowinCell<'_>, index: u8) -> bool {
        let slice = self.routing.tiles().slice(cell.row, cell.column, index / 2);
        slice.is_some_and(|slice| slice.carry)
    }

    /// A table with its carry.
    fn carry(&mut self, cell: &RoutedGowinCell<'_>) -> Result<(), BitstreamError> {
        let index = cell.index()?;
        let found = self.routing.tiles().table(cell.row, cell.column, index);
        let values = match cell.has("RAW_ALU_LUT") {
            true => cell.table("RAW_ALU_LUT")?,
            false => self.carry_table(cell)?,
        };
        self.report.carries += 1;
        self.setting(cell, "a carry, and in the bits a table", self.is_carry(cell, index));
        if cell.is_open("SUM") && cell.is_open("COUT") {
            self.setting(cell, "carry that is not in use: another table", values == found);
            return Ok(());
        }
        let is_same = self.is_function(cell, 4, (values, found))?;
        self.setting(cell, "carry: another function of its inputs", is_same);
        if !cell.is_open("COUT") {
            let is_same = self.is_function(cell, 2, (values & GENERATED, found & GENERATED))?;
            self.setting(cell, "carry: it is generated otherwise", is_same);
        }
        if !cell.is_open("CIN") {
            let before = carry_before(self.routing, cell.output(GowinPort::Carry(index)), index);
            let before = before.map_or(GowinSource::Nothing, GowinSource::Output);
            self.connection(cell, "CIN", self.source(cell, "CIN"), before);
        }
        Ok(())
    }

    /// The table of a carry that the router names.
    fn carry_table(&self, cell: &RoutedGowinCell<'_>) -> Result<u16, BitstreamError> {
        let mode = cell.parameter("ALU_MODE");
        let number = u64::from_str_radix(mode, 2).map(|number| number.to_string());
        let database = self.routing.database();
        let table = database.carry_table(mode);
        let table = table.or_else(|| database.carry_table(&number.ok()?));
        table.ok_or_else(|| BitstreamError::UnknownCell(format!("{}: a carry of mode {mode}", cell.place())))
    }

    fn multiplexer(&mut self, cell: &RoutedGowinCell<'_>) -> Result<(), BitstreamError> {
        let index = cell.index()?;
        let output = cell.output(GowinPort::Multiplexer(index));
        self.report.multiplexers += 1;
        let (low, high) = multiplexed(output, index, self.routing.database().columns())?;
        let select = self.routing.source(cell.row, cell.column, &format!("SEL{index}"))?;
        let bits = [GowinSource::Output(low), GowinSource::Output(high), select];
        for (port, bits) in ["I0", "I1", "S0"].into_iter().zip(bits) {
            self.connection(cell, port, self.source(cell, port), bits);
        }
        Ok(())
    }

    fn flop(&mut self, cell: &RoutedGowinCell<'_>) -> Result<(), BitstreamError> {
        let (index, routing) = (cell.index()?, self.routing);
        let slice = index / 2;
        self.report.flip_flops += 1;
        let Some(settings) = routing.tiles().slice(cell.row, cell.column, slice) else {
            self.setting(cell, "a flip-flop, and in the bits none", false);
            return Ok(());
        };
        let kind = cell.kind.trim_start_matches("DFF").trim_end_matches('E');
        let is_inverted = kind.starts_with('N');
        let (level, reset) = match kind.trim_start_matches('N') {
            "" => (false, None),
            "R" => (false, Some(("RESET", SliceReset::Synchronous))),
            "S" => (true, Some(("SET", SliceReset::Synchronous))),
            "C" => (false, Some(("CLEAR", SliceReset::Asynchronous))),
            "P" => (true, Some(("PRESET", SliceReset::Asynchronous))),
            _ => return Err(BitstreamError::UnknownCell(format!("{}: {}", cell.place(), cell.kind))),
        };
        self.setting(
            cell,
            "another value after a reset",
            settings.set[usize::from(index % 2)] == level,
        );
        self.setting(cell, "another edge of the clock", settings.inverted == is_inverted);
        self.setting(
            cell,
            "another kind of reset",
            settings.reset == reset.map(|(_, kind)| kind),
        );
        let wire = |name: &str| routing.source(cell.row, cell.column, &format!("{name}{slice}"));
        let data = GowinSource::Output(cell.output(GowinPort::Table(index)));
        self.connection(cell, "D", self.source(cell, "D"), data);
        self.connection(cell, "CLK", self.source(cell, "CLK"), wire("CLK")?);
        let enable = match cell.is_open("CE") {
            true => GowinSource::Constant(true),
            false => self.source(cell, "CE"),
        };
        self.connection(cell, "CE", enable, wire("CE")?);
        if let Some((port, _)) = reset {
            self.connection(cell, port, self.source(cell, port), wire("LSR")?);
        }
        Ok(())
    }

    fn memory(&mut self, cell: &RoutedGowinCell<'_>, stored: &StoredContents<'_>) -> Result<(), BitstreamError> {
        let place = (cell.row, cell.column);
        self.report.memories += 1;
        let uses = memory::uses(self.routing, place)?;
        let routed = cell.memory()?;
        self.setting(cell, "another width, mode or reset", uses.contains(&routed));
        for key in ["BLK_SEL_0", "BLK_SEL_1"] {
            self.setting(cell, "it is selected otherwise", cell.number(key) == Some(0));
        }
        let routed = cell.contents();
        for (word, (routed, bits)) in routed.into_iter().zip(stored.words(place)).enumerate() {
            self.setting(cell, &format!("word {word} of its contents"), routed == bits);
        }
        for port in cell.inputs().filter(|port| !REPEATED_PORTS.contains(port)) {
            if !cell.is_open(port) {
                let bits = memory::port_source(self.routing, place, port)?;
                self.connection(cell, port, self.source(cell, port), bits);
            }
        }
        Ok(())
    }

    fn pad(&mut self, cell: &RoutedGowinCell<'_>) -> Result<(), BitstreamError> {
        let pad = cell.pad()?;
        let routing = self.routing;
        let (row, column) = (cell.row, cell.column);
        if cell.kind == "OBUF" {
            let bits = routing.source(row, column, &pad_wire(routing, pad, "I")?)?;
            self.connection(cell, "I", self.source(cell, "I"), bits);
        }
        let wires = routing.database().bottom_wires();
        for (port, wire) in ["BOTTOM_IO_PORT_A", "BOTTOM_IO_PORT_B"].into_iter().zip(wires) {
            if !cell.is_open(port) {
                let bits = routing.source(row, column, wire)?;
                self.connection(cell, port, self.source(cell, port), bits);
            }
        }
        let settings = routing.tiles().tile_settings(row, column);
        let GowinPort::Pad(letter) = pad.port else {
            return Ok(());
        };
        let found = settings.and_then(|settings| settings.pads.get(&letter));
        let pull = cell.attribute("PULL_MODE").unwrap_or("UP");
        self.setting(cell, "another resistor", found.is_some_and(|found| found.pull == pull));
        if cell.kind == "OBUF" {
            let standard = cell.attribute("IO_TYPE");
            let is_same = found.is_some_and(|found| Some(found.standard.as_str()) == standard);
            self.setting(cell, "another standard", is_same);
        }
        Ok(())
    }

    /// Cells of the bits that the router's netlist does not have.
    fn left_over(&mut self, bits: &GowinNetlist) {
        let outputs = self.routed.cells.iter().flat_map(RoutedGowinCell::outputs);
        let known: BTreeSet<GowinOutput> = outputs.collect();
        for output in bits.outputs.keys().filter(|output| !known.contains(output)) {
            self.report.differs(format!("{output}: only in the bits"));
        }
    }

    /// Every pin has its pad in the router's netlist.
    fn pins(&mut self, pins: &[TopPin]) -> Result<(), BitstreamError> {
        for TopPin { port, pin, .. } in pins {
            let (row, column, letter) = self.routing.database().pad(pin)?;
            let pad = GowinOutput {
                row,
                column,
                port: GowinPort::Pad(letter),
            };
            let is_here = |cell: &RoutedGowinCell<'_>| {
                matches!(cell.kind, "IBUF" | "OBUF") && cell.pad().is_ok_and(|of_cell| of_cell == pad)
            };
            if !self.routed.cells.iter().any(is_here) {
                self.report.differs(format!("{port}: no pad in the router's netlist"));
            }
        }
        Ok(())
    }
}

/// The output of the cell that drives the net of this name in the router's netlist.
///
/// # Errors
/// [`BitstreamError::Unreadable`] if no cell drives it.
pub fn output_of_net(routed: &Value, name: &str) -> Result<GowinOutput, BitstreamError> {
    let net = routed["netnames"][name]["bits"][0].as_u64();
    let driver = net.and_then(|net| Some(RoutedGowin::read(routed).ok()?.driver(net)));
    match driver {
        Some(GowinSource::Output(output)) => Ok(output),
        _ => Err(unreadable(format!("no cell drives the net {name}"))),
    }
}

fn constant(source: GowinSource) -> Option<bool> {
    match source {
        GowinSource::Constant(level) => Some(level),
        _ => None,
    }
}
