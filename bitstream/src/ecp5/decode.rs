//! The netlist of the bits: every cell on which an output pin depends, from what its tile's bits set and connect.

use super::database::{Database, Pad};
use super::memory;
use super::routing::{CellPort, OutputPort, Routing, Source, slice_letter};
use crate::BitstreamError;
use crate::boards::{PinUse, TopPin};
use crate::network::{Gate, HIGH, LOW, NetIndex, Network, NetworkMemory, State};
use std::collections::{BTreeMap, HashMap, HashSet};

/// The values of an exclusive or of two inputs.
const EXCLUSIVE_OR: u16 = 0b0110;
/// The values of a choice: the second input while the first is low, the third while it is high.
const CHOICE: u16 = 0b1110_0100;
/// A table without settings.
const OPEN_TABLE: u16 = u16::MAX;

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
    while let Some(output) = decoder.waiting.pop() {
        decoder.cell(output)?;
    }
    decoder.check_driven()?;
    pads(routing, database, pins)?;
    Ok(DecodedBits {
        network: decoder.network,
        outputs: decoder.nets.into_iter().collect(),
    })
}

impl Pad {
    /// What the pad drives inside the device.
    #[must_use]
    pub fn output(self) -> CellPort {
        CellPort {
            row: self.row,
            column: self.column,
            port: OutputPort::Pad(self.letter),
        }
    }
}

/// The beginning of the setting of a pad in this direction.
fn base_type(direction: PinUse) -> &'static str {
    match direction {
        PinUse::Input => "INPUT_",
        PinUse::Output => "OUTPUT_",
    }
}

/// Checks that the pads in use are those of the board's pins, each in its direction.
fn pads(routing: &Routing<'_>, database: &Database, pins: &[TopPin]) -> Result<(), BitstreamError> {
    let expected = pins.iter().map(|pin| Ok((database.pad(pin.pin)?, pin.direction)));
    let expected = expected.collect::<Result<Vec<_>, BitstreamError>>()?;
    for (row, column) in routing.places() {
        for (name, value) in routing.settings(row, column) {
            let letter = name
                .strip_prefix("PIO")
                .and_then(|name| name.strip_suffix(".BASE_TYPE"));
            let (Some(letter), true) = (letter, value != "NONE") else {
                continue;
            };
            // The settings of a pad lie in its tile, or in the one beside or below it.
            let is_here = |(pad, direction): &(Pad, PinUse)| {
                let near = pad.row.abs_diff(row) <= 2 && pad.column.abs_diff(column) <= 1;
                near && letter.starts_with(pad.letter) && value.starts_with(base_type(*direction))
            };
            if !expected.iter().any(is_here) {
                return Err(BitstreamError::UnknownCell(format!(
                    "a pad that the top does not use, PIO{letter} at R{row}C{column}: {value}"
                )));
            }
        }
    }
    Ok(())
}

pub(super) struct Decoder<'a> {
    pub(super) routing: &'a Routing<'a>,
    pub(super) network: Network,
    nets: HashMap<CellPort, NetIndex>,
    /// Tables of carry chains, before the carry.
    functions: HashMap<(u8, u8, u8), NetIndex>,
    /// Outputs whose cells are still to be decoded.
    waiting: Vec<CellPort>,
    memories: HashSet<(u8, u8)>,
}

impl<'a> Decoder<'a> {
    fn new(routing: &'a Routing<'a>) -> Self {
        Self {
            routing,
            network: Network::of_constants(),
            nets: HashMap::new(),
            functions: HashMap::new(),
            waiting: Vec::new(),
            memories: HashSet::new(),
        }
    }

    /// The net of an output, whose cell is decoded later.
    pub(super) fn net(&mut self, output: CellPort) -> NetIndex {
        if let Some(net) = self.nets.get(&output) {
            return *net;
        }
        let net = self.network.new_net(output.identifier());
        self.nets.insert(output, net);
        self.waiting.push(output);
        net
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
        let driven = self.network.driven();
        match self.nets.iter().find(|(_, net)| !driven.contains(net)) {
            Some((output, _)) => Err(unknown(*output, "an output of a port that also writes")),
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
                let values = (0..16u16).fold(0, |values, index| {
                    let generates = generated >> (index >> 2) & 1;
                    let value = if index & 1 == 1 { index >> 1 & 1 } else { generates };
                    values | value << index
                });
                self.network
                    .gates
                    .push(Gate::new(net, &[function, carry, a?, b?], values));
            }
            OutputPort::TwoTables(slice) => {
                let select = self.selector(row, column, slice, 0)?;
                let low = self.source(row, column, &format!("F{}_SLICE", 2 * slice))?;
                let high = self.source(row, column, &format!("F{}_SLICE", 2 * slice + 1))?;
                self.network.gates.push(Gate::new(net, &[select, low, high], CHOICE));
            }
            OutputPort::TwoSlices(slice) => {
                let letter = slice_letter(slice);
                let select = self.selector(row, column, slice, 1)?;
                let low = self.source(row, column, &format!("FXA{letter}_SLICE"))?;
                let high = self.source(row, column, &format!("FXB{letter}_SLICE"))?;
                self.network.gates.push(Gate::new(net, &[select, low, high], CHOICE));
            }
            OutputPort::Flop(flop) => self.flop(output, flop, net)?,
            OutputPort::WriteAddress(_) | OutputPort::WriteData(_) => {
                return Err(unknown(output, "a small RAM"));
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
                    Gate::new(net, &[function, carry], EXCLUSIVE_OR)
                };
                self.network.gates.push(gate);
            }
            "DPRAM" => return Err(unknown(output, "a small RAM")),
            other => return Err(unknown(output, &format!("a slice in mode {other}"))),
        }
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

/// What drives an input of a table.
pub(super) fn table_input(
    routing: &Routing<'_>,
    (row, column): (u8, u8),
    table: u8,
    pin: &str,
) -> Result<Source, BitstreamError> {
    let key = format!("SLICE{}.{pin}{}MUX", slice_letter(table / 2), table % 2);
    match routing.setting(row, column, &key) {
        Some("1") => Ok(Source::Constant(true)),
        _ => routing.source(row, column, &format!("{pin}{table}_SLICE")),
    }
}

/// The table whose carry goes into a table; `None` where the chain begins.
pub(super) fn carry_before(routing: &Routing<'_>, row: u8, column: u8, table: u8) -> Option<CellPort> {
    let (row, column, before) = match table.checked_sub(1) {
        Some(before) => (row, column, before),
        None => {
            let (row, column) = routing.carry_from(row, column)?;
            (row, column, 7)
        }
    };
    routing.is_carry_chain(row, column, before / 2).then_some(CellPort {
        row,
        column,
        port: OutputPort::Carry(before),
    })
}

/// The settings of a table's half of a slice.
pub(super) struct SliceSettings<'a> {
    routing: &'a Routing<'a>,
    row: u8,
    column: u8,
    table: u8,
}

impl<'a> SliceSettings<'a> {
    pub(super) fn new(routing: &'a Routing<'a>, row: u8, column: u8, table: u8) -> Self {
        Self {
            routing,
            row,
            column,
            table,
        }
    }

    fn of_slice(&self, key: &str) -> Option<&'a str> {
        let key = format!("SLICE{}.{key}", slice_letter(self.table / 2));
        self.routing.setting(self.row, self.column, &key)
    }

    pub(super) fn mode(&self) -> &'a str {
        self.of_slice("MODE").unwrap_or("LOGIC")
    }

    /// The values of the table: bit `i` for inputs A, B, C and D whose levels are the bits of `i`.
    pub(super) fn table(&self) -> Result<u16, BitstreamError> {
        let key = format!("K{}.INIT", self.table % 2);
        match self.of_slice(&key) {
            None => Ok(OPEN_TABLE),
            Some(digits) => u16::from_str_radix(digits, 2).map_err(|_| self.unknown(&format!("{key} {digits}"))),
        }
    }

    /// Whether the table passes the carry on without adding it, and makes none.
    pub(super) fn is_carry_alone(&self) -> Result<bool, BitstreamError> {
        let key = format!("CCU2.INJECT1_{}", self.table % 2);
        match self.of_slice(&key) {
            None | Some("YES") => Ok(true),
            Some("NO") => Ok(false),
            Some(other) => Err(self.unknown(&format!("{key} {other}"))),
        }
    }

    fn unknown(&self, what: &str) -> BitstreamError {
        let output = CellPort {
            row: self.row,
            column: self.column,
            port: OutputPort::Table(self.table),
        };
        unknown(output, what)
    }
}

/// How a flip-flop is enabled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Enable {
    Always,
    Never,
    Line { is_inverted: bool },
}

/// The reset of a flip-flop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ResetLine {
    /// 0 or 1 of the tile's two.
    pub(super) line: u8,
    pub(super) is_inverted: bool,
    pub(super) is_asynchronous: bool,
}

/// The settings of a flip-flop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct FlopSettings {
    /// Whether it takes its data from the table beside it, not from its own wire.
    pub(super) is_from_table: bool,
    /// Its clock: 0 or 1 of the tile's two.
    pub(super) clock: Option<u8>,
    pub(super) enable: Enable,
    pub(super) reset: Option<ResetLine>,
    /// Its value after a reset, and after configuration.
    pub(super) reset_to: bool,
}

impl FlopSettings {
    pub(super) fn new(routing: &Routing<'_>, row: u8, column: u8, flop: u8) -> Result<Self, BitstreamError> {
        let output = CellPort {
            row,
            column,
            port: OutputPort::Flop(flop),
        };
        let (slice, half) = (flop / 2, flop % 2);
        let letter = slice_letter(slice);
        let setting = |key: String| routing.setting(row, column, &key);
        let one_of = |key: String, default: &'static str, known: [&'static str; 2]| {
            let value = setting(key.clone()).unwrap_or(default);
            let index = known.iter().position(|name| *name == value);
            index
                .ok_or_else(|| unknown(output, &format!("{key} {value}")))
                .map(|index| index == 1)
        };
        // The tile's clock or reset that a slice takes.
        let line = |wire: String| {
            let name = routing.driver_name(row, column, &wire)?;
            name.as_bytes().last().map(|digit| digit - b'0')
        };
        let register = |key: &str| format!("SLICE{letter}.REG{half}.{key}");
        if one_of(register("LSRMODE"), "LSR", ["LSR", "PRLD"])? {
            return Err(unknown(output, "a flip-flop that loads at its reset"));
        }
        let clock = line(format!("MUXCLK{slice}"));
        if let Some(clock) = clock
            && one_of(format!("CLK{clock}.CLKMUX"), "CLK", ["CLK", "INV"])?
        {
            return Err(unknown(output, "a flip-flop at the falling edge"));
        }
        let reset = match line(format!("MUXLSR{slice}")) {
            None => None,
            Some(reset) => {
                let mode = format!("LSR{reset}.SRMODE");
                Some(ResetLine {
                    line: reset,
                    is_inverted: one_of(format!("LSR{reset}.LSRMUX"), "LSR", ["LSR", "INV"])?,
                    is_asynchronous: one_of(mode, "LSR_OVER_CE", ["LSR_OVER_CE", "ASYNC"])?,
                })
            }
        };
        let enable = match setting(format!("SLICE{letter}.CEMUX")).unwrap_or("CE") {
            "CE" => Enable::Line { is_inverted: false },
            "INV" => Enable::Line { is_inverted: true },
            "1" => Enable::Always,
            "0" => Enable::Never,
            other => return Err(unknown(output, &format!("CEMUX {other}"))),
        };
        Ok(Self {
            is_from_table: one_of(register("SD"), "1", ["0", "1"])?,
            clock,
            enable,
            reset,
            reset_to: one_of(register("REGSET"), "SET", ["RESET", "SET"])?,
        })
    }
}

fn unknown(output: CellPort, what: &str) -> BitstreamError {
    BitstreamError::UnknownCell(format!("{output}: {what}"))
}
