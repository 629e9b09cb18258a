//! Compares block RAMs and distributed RAMs.

use super::super::distributed_ram::{self, WriteEnable};
use super::super::memory;
use super::super::routed::{RoutedCell, routed_contents};
use super::super::routing::{CellPort, OutputPort, Source};
use super::super::slice::table_input;
use super::{Comparison, constant};
use crate::BitstreamError;

impl Comparison<'_> {
    /// A block RAM.
    pub(super) fn memory(&mut self, cell: &RoutedCell<'_>) -> Result<(), BitstreamError> {
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

    /// What writes a table that is a bit of a distributed RAM.
    pub(super) fn written_table(&mut self, cell: &RoutedCell<'_>, index: u8) -> Result<(), BitstreamError> {
        let (row, column) = (cell.row, cell.column);
        let output = CellPort {
            row,
            column,
            port: OutputPort::Table(index),
        };
        let wires = distributed_ram::write_wires(index);
        // The routed netlist calls the address by its bits, the wires are in the order of the table's inputs.
        let address = ["WAD3", "WAD1", "WAD2", "WAD0"].into_iter().zip(&wires.address);
        let others = [("WD", &wires.data), ("WCK", &wires.clock)];
        for (port, wire) in address.chain(others) {
            let bits = self.routing.source(row, column, wire)?;
            self.connection(cell, port, self.routed.source(cell, port), bits);
        }
        let enable = distributed_ram::write_enable(self.routing, output)?;
        let routed = match cell.parameter("WREMUX") {
            "0" => WriteEnable::Never,
            "1" => WriteEnable::Always,
            "INV" => WriteEnable::Line { is_inverted: true },
            _ => WriteEnable::Line { is_inverted: false },
        };
        self.setting(cell, "distributed RAM: another write enable", enable == routed);
        self.setting(
            cell,
            "distributed RAM: another edge of the clock",
            cell.parameter("WCKMUX") != "INV",
        );
        if let WriteEnable::Line { .. } = enable {
            let bits = self.routing.source(row, column, &wires.enable)?;
            self.connection(cell, "WRE", self.routed.source(cell, "WRE"), bits);
        }
        Ok(())
    }

    /// The write port of a distributed RAM.
    pub(super) fn write_port(&mut self, cell: &RoutedCell<'_>) -> Result<(), BitstreamError> {
        self.report.distributed_rams += 1;
        let mode = self.routing.setting(cell.row, cell.column, "SLICEC.MODE");
        self.setting(cell, "another mode", mode == Some("RAMW"));
        let address = (0..distributed_ram::BITS).map(OutputPort::WriteAddress);
        let data = (0..distributed_ram::BITS).map(OutputPort::WriteData);
        for (pin, table) in address.chain(data).filter_map(distributed_ram::write_port_input) {
            let port = format!("{pin}{}", table - 4);
            let bits = table_input(self.routing, (cell.row, cell.column), table, pin)?;
            self.connection(cell, &port, self.routed.source(cell, &port), bits);
        }
        Ok(())
    }
}
