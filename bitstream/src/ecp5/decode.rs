//! The netlist of the bits: every cell on which an output pin depends, from what its tile's bits set and connect.

use super::distributed_ram::{self, WriteEnable};
use super::memory;
use super::pads;
use super::routing::{CellPort, OutputPort, Routing, Source, slice_letter};
use super::slice::{Enable, FlopSettings, ResetLine, SliceSettings, carry_before, table_input};
use crate::BitstreamError;
use crate::boards::{PinUse, TopPin};
use crate::network::{Gate, HIGH, LOW, NetIndex, Network, NetworkMemory, OutputNets, State, TableWrite};
use std::collections::{BTreeMap, HashMap, HashSet};

/// The netlist of the bits.
#[derive(Debug)]
pub struct DecodedBits {
    /// The netlist in the form that is simulated.
    pub network: Network,
    /// The outputs of cells that are in use, with their nets.
    pub outputs: BTreeMap<CellPort, NetIndex>,
}

/// Decodes the netlist with these pins as its ports.
///
/// # Errors
/// [`BitstreamError::UnknownCell`] for a setting that is not known here.
pub fn decode(routing: &Routing<'_>, pins: &[TopPin]) -> Result<DecodedBits, BitstreamError> {
    let mut decoder = Decoder::new(routing);
    let database = routing.database();
    for pin in pins {
        let pad = database.pad(pin.pin)?;
        match pin.direction {
            PinUse::Input => {
                let net = decoder.net(pad.output());
                decoder.network.inputs.push((pin.pin.to_owned(), net));
            }
            PinUse::Output => {
                let net = decoder.source(pad.row, pad.column, &format!("PADDO{}_PIO", pad.letter))?;
                decoder.network.outputs.push((pin.pin.to_owned(), net));
            }
        }
    }
    while let Some(output) = decoder.outputs.next() {
        decoder.cell(output)?;
    }
    decoder.check_driven()?;
    pads::check(routing, database, pins)?;
    Ok(DecodedBits {
        network: decoder.network,
        outputs: decoder.outputs.into_sorted(),
    })
}

pub(super) struct Decoder<'a> {
    pub(super) routing: &'a Routing<'a>,
    pub(super) network: Network,
    outputs: OutputNets<CellPort>,
    /// Tables of carry chains, before the carry.
    functions: HashMap<(u8, u8, u8), NetIndex>,
    memories: HashSet<(u8, u8)>,
}

impl<'a> Decoder<'a> {
    fn new(routing: &'a Routing<'a>) -> Self {
        Self {
            routing,
            network: Network::of_constants(),
            outputs: OutputNets::new(),
            functions: HashMap::new(),
            memories: HashSet::new(),
        }
    }

    /// The net of an output, whose cell is decoded later.
    pub(super) fn net(&mut self, output: CellPort) -> NetIndex {
        self.outputs.net(&mut self.network, output, CellPort::identifier)
    }

    /// The net that drives a wire of a tile.
    pub(super) fn source(&mut self, row: u8, column: u8, name: &str) -> Result<NetIndex, BitstreamError> {
        Ok(match self.routing.source(row, column, name)? {
            Source::Constant(false) => LOW,
            Source::Constant(true) => HIGH,
            Source::Output(output) => self.net(output),
        })
    }

    /// The inverse of a net.
    pub(super) fn inverse(&mut self, net: NetIndex) -> NetIndex {
        match net {
            LOW => HIGH,
            HIGH => LOW,
            net => {
                let name = format!("not_{}", self.network.names[net as usize]);
                let output = self.network.new_net(name);
                self.network.gates.push(Gate::new(output, &[net], 0b01));
                output
            }
        }
    }

    /// Checks that something drives every output that is in use.
    fn check_driven(&self) -> Result<(), BitstreamError> {
        match self.outputs.undriven(&self.network) {
            Some(output) => Err(unknown(output, "an output of a port that also writes")),
            None => Ok(()),
        }
    }

    fn cell(&mut self, output: CellPort) -> Result<(), BitstreamError> {
        let CellPort { row, column, port } = output;
        let net = self.net(output);
        match port {
            OutputPort::Pad(_) => {
                if !self.network.inputs.iter().any(|(_, input)| *input == net) {
                    return Err(unknown(output, "a pad that is no input of the top"));
                }
            }
            OutputPort::Table(table) => self.table(output, table, net)?,
            OutputPort::Carry(table) => {
                let function = self.function(row, column, table)?;
                let carry = self.carry_into(row, column, table);
                let [a, b] = ["A", "B"].map(|pin| self.table_input(row, column, table, pin));
                let settings = SliceSettings::new(self.routing, row, column, table);
                let generated = match settings.is_carry_alone()? {
                    true => 0,
                    false => settings.table()? & 0xF,
                };
                let gate = Gate::carry(net, (function, carry), [a?, b?], generated);
                self.network.gates.push(gate);
            }
            OutputPort::TwoTables(slice) => {
                let select = self.selector(row, column, slice, 0)?;
                let low = self.source(row, column, &format!("F{}_SLICE", 2 * slice))?;
                let high = self.source(row, column, &format!("F{}_SLICE", 2 * slice + 1))?;
                self.network.gates.push(Gate::choice(net, select, [low, high]));
            }
            OutputPort::TwoSlices(slice) => {
                let letter = slice_letter(slice);
                let select = self.selector(row, column, slice, 1)?;
                let low = self.source(row, column, &format!("FXA{letter}_SLICE"))?;
                let high = self.source(row, column, &format!("FXB{letter}_SLICE"))?;
                self.network.gates.push(Gate::choice(net, select, [low, high]));
            }
            OutputPort::Flop(flop) => self.flop(output, flop, net)?,
            OutputPort::WriteAddress(_) | OutputPort::WriteData(_) => {
                let input = distributed_ram::write_port_input(port);
                let (pin, table) = input.ok_or_else(|| unknown(output, "another bit of a write port"))?;
                let source = self.table_input(row, column, table, pin)?;
                self.network.gates.push(Gate::wire(net, source));
            }
            OutputPort::MemoryA(_) | OutputPort::MemoryB(_) => {
                if self.memories.insert((row, column)) {
                    let memory = memory::decode(self, row, column)?;
                    self.network.memories.push(NetworkMemory::Plain(memory));
                }
            }
        }
        Ok(())
    }

    /// A look-up table.
    fn table(&mut self, output: CellPort, table: u8, net: NetIndex) -> Result<(), BitstreamError> {
        let CellPort { row, column, .. } = output;
        let settings = SliceSettings::new(self.routing, row, column, table);
        match settings.mode() {
            "LOGIC" => {
                let inputs = self.table_inputs(row, column, table)?;
                self.network.gates.push(Gate::new(net, &inputs, settings.table()?));
            }
            "CCU2" => {
                let function = self.function(row, column, table)?;
                let gate = if settings.is_carry_alone()? {
                    Gate::wire(net, function)
                } else {
                    let carry = self.carry_into(row, column, table);
                    Gate::sum(net, function, carry)
                };
                self.network.gates.push(gate);
            }
            "DPRAM" => self.distributed_ram(output, table, net)?,
            other => return Err(unknown(output, &format!("a slice in mode {other}"))),
        }
        Ok(())
    }

    /// A bit of a distributed RAM, which is the table that reads it.
    fn distributed_ram(&mut self, output: CellPort, table: u8, net: NetIndex) -> Result<(), BitstreamError> {
        let CellPort { row, column, .. } = output;
        let wires = distributed_ram::write_wires(table);
        let enable = match distributed_ram::write_enable(self.routing, output)? {
            WriteEnable::Never => LOW,
            WriteEnable::Always => HIGH,
            WriteEnable::Line { is_inverted } => {
                let line = self.source(row, column, &wires.enable)?;
                if is_inverted { self.inverse(line) } else { line }
            }
        };
        let mut address = [LOW; 4];
        for (bit, wire) in address.iter_mut().zip(&wires.address) {
            *bit = self.source(row, column, wire)?;
        }
        let write = TableWrite {
            output: net,
            clock: self.source(row, column, &wires.clock)?,
            enable,
            address,
            data: self.source(row, column, &wires.data)?,
        };
        self.network.table_writes.push(write);
        let inputs = self.table_inputs(row, column, table)?;
        let table = SliceSettings::new(self.routing, row, column, table).table()?;
        // Every entry can be written, whatever the inputs select now.
        self.network.gates.push(Gate {
            output: net,
            inputs,
            table,
        });
        Ok(())
    }

    /// The output of a table of a carry chain before the carry.
    fn function(&mut self, row: u8, column: u8, table: u8) -> Result<NetIndex, BitstreamError> {
        if let Some(net) = self.functions.get(&(row, column, table)) {
            return Ok(*net);
        }
        let values = SliceSettings::new(self.routing, row, column, table).table()?;
        let inputs = self.table_inputs(row, column, table)?;
        let net = self.network.new_net(format!("r{row}c{column}_function{table}"));
        self.network.gates.push(Gate::new(net, &inputs, values));
        self.functions.insert((row, column, table), net);
        Ok(net)
    }

    /// The carry into a table; low where the chain begins.
    fn carry_into(&mut self, row: u8, column: u8, table: u8) -> NetIndex {
        carry_before(self.routing, row, column, table).map_or(LOW, |output| self.net(output))
    }

    fn table_inputs(&mut self, row: u8, column: u8, table: u8) -> Result<[NetIndex; 4], BitstreamError> {
        let mut inputs = [LOW; 4];
        for (input, pin) in inputs.iter_mut().zip(["A", "B", "C", "D"]) {
            *input = self.table_input(row, column, table, pin)?;
        }
        Ok(inputs)
    }

    fn table_input(&mut self, row: u8, column: u8, table: u8, pin: &str) -> Result<NetIndex, BitstreamError> {
        Ok(match table_input(self.routing, (row, column), table, pin)? {
            Source::Constant(false) => LOW,
            Source::Constant(true) => HIGH,
            Source::Output(output) => self.net(output),
        })
    }

    /// The input that selects one of two results.
    fn selector(&mut self, row: u8, column: u8, slice: u8, half: u8) -> Result<NetIndex, BitstreamError> {
        let key = format!("SLICE{}.M{half}MUX", slice_letter(slice));
        match self.routing.setting(row, column, &key) {
            Some("1") => Ok(HIGH),
            _ => self.source(row, column, &format!("M{}_SLICE", 2 * slice + half)),
        }
    }

    fn flop(&mut self, output: CellPort, flop: u8, net: NetIndex) -> Result<(), BitstreamError> {
        let CellPort { row, column, .. } = output;
        let settings = FlopSettings::new(self.routing, row, column, flop)?;
        let data = match settings.is_from_table {
            true => self.source(row, column, &format!("DI{flop}_SLICE"))?,
            false => self.selector(row, column, flop / 2, flop % 2)?,
        };
        let clock = match settings.clock {
            Some(line) => self.source(row, column, &format!("CLK{line}"))?,
            None => return Err(unknown(output, "a flip-flop without a clock")),
        };
        let enable = match settings.enable {
            Enable::Always => HIGH,
            Enable::Never => LOW,
            Enable::Line { is_inverted } => {
                let line = self.source(row, column, &format!("CE{}_SLICE", flop / 2))?;
                if is_inverted { self.inverse(line) } else { line }
            }
        };
        let reset = match settings.reset {
            None => LOW,
            Some(ResetLine { line, is_inverted, .. }) => {
                let line = self.source(row, column, &format!("LSR{line}"))?;
                if is_inverted { self.inverse(line) } else { line }
            }
        };
        self.network.states.push(State {
            output: net,
            clock,
            data,
            enable,
            reset,
            is_asynchronous: settings.reset.is_some_and(|reset| reset.is_asynchronous),
            reset_to: settings.reset_to,
            reset_needs_enable: false,
            initial: settings.reset_to,
        });
        Ok(())
    }
}

impl CellPort {
    /// The output as an identifier of Verilog.
    fn identifier(self) -> String {
        let Self { row, column, port } = self;
        let what = match port {
            OutputPort::Table(table) => format!("f{table}"),
            OutputPort::TwoTables(slice) => format!("ofx0_{slice}"),
            OutputPort::TwoSlices(slice) => format!("ofx1_{slice}"),
            OutputPort::Carry(table) => format!("carry{table}"),
            OutputPort::Flop(flop) => format!("q{flop}"),
            OutputPort::WriteAddress(bit) => format!("wado{bit}"),
            OutputPort::WriteData(bit) => format!("wdo{bit}"),
            OutputPort::MemoryA(bit) => format!("doa{bit}"),
            OutputPort::MemoryB(bit) => format!("dob{bit}"),
            OutputPort::Pad(letter) => format!("pad_{}", letter.to_ascii_lowercase()),
        };
        format!("r{row}c{column}_{what}")
    }
}

pub(super) fn unknown(output: CellPort, what: &str) -> BitstreamError {
    BitstreamError::UnknownCell(format!("{output}: {what}"))
}
