//! The netlist of a Gowin bitstream: every cell on which an output pin depends, from what its tile's bits set and connect.

use super::kind::{PadDirection, SliceReset};
use super::memory;
use super::routing::{GowinOutput, GowinPort, GowinRouting, GowinSource};
use super::table::{constant_function, relevant, table_inputs};
use crate::BitstreamError;
use crate::boards::{PinUse, TopPin};
use crate::network::{Gate, HIGH, LOW, NetIndex, Network, NetworkMemory, OutputNets, State};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Entries of a table, for A and B with C and D low, that are the carry of a table whose result is low.
pub(super) const GENERATED: u16 = 0xF;
/// Carries of a tile.
const CARRIES: u8 = 6;

/// The netlist of the bits.
#[derive(Debug)]
pub struct GowinNetlist {
    /// The netlist in the form that is simulated.
    pub network: Network,
    /// The outputs of cells that are in use, with their nets.
    pub outputs: BTreeMap<GowinOutput, NetIndex>,
}

/// Decodes the netlist with these pins as its ports.
///
/// # Errors
/// [`BitstreamError::UnknownCell`] for a setting that is not known here.
pub fn decode(
    routing: &GowinRouting<'_>,
    pins: &[TopPin],
    memories: &memory::StoredContents<'_>,
) -> Result<GowinNetlist, BitstreamError> {
    let mut decoder = GowinDecoder::new(routing);
    for pin in pins {
        let (row, column, letter) = routing.database().pad(pin.pin)?;
        let direction = match pin.direction {
            PinUse::Input => PadDirection::Input,
            PinUse::Output => PadDirection::Output,
        };
        let pad = GowinOutput {
            row,
            column,
            port: GowinPort::Pad(letter),
        };
        let found = pad_direction(routing, pad);
        if found != direction {
            return Err(unknown(
                pad,
                &format!("an {direction:?} of the top, and in the bits {found:?}"),
            ));
        }
        match pin.direction {
            PinUse::Input => {
                let net = decoder.net(pad);
                decoder.network.inputs.push((pin.pin.to_owned(), net));
            }
            PinUse::Output => {
                let source = routing.source(row, column, &pad_wire(routing, pad, "I")?)?;
                let net = decoder.driven(source, pad)?;
                decoder.network.outputs.push((pin.pin.to_owned(), net));
            }
        }
    }
    only_these_pads(routing, pins)?;
    while let Some(output) = decoder.outputs.next() {
        decoder.cell(output, memories)?;
    }
    decoder.check_driven()?;
    Ok(GowinNetlist {
        network: decoder.network,
        outputs: decoder.outputs.into_sorted(),
    })
}

/// What the bits use a pad for.
fn pad_direction(routing: &GowinRouting<'_>, pad: GowinOutput) -> PadDirection {
    let settings = routing.tiles().tile_settings(pad.row, pad.column);
    let of_pad = settings.and_then(|settings| match pad.port {
        GowinPort::Pad(letter) => settings.pads.get(&letter),
        _ => None,
    });
    of_pad.map_or(PadDirection::None, |pad| pad.direction)
}

/// The wire at a port of a pad.
pub(super) fn pad_wire(routing: &GowinRouting<'_>, pad: GowinOutput, port: &str) -> Result<String, BitstreamError> {
    let kind = routing.database().kind(pad.row, pad.column);
    let name = match pad.port {
        GowinPort::Pad(letter) => kind.and_then(|kind| kind.ports.get(&format!("{letter}.{port}"))),
        _ => None,
    };
    name.cloned()
        .ok_or_else(|| unknown(pad, &format!("it has no port {port}")))
}

/// Checks that no other pads are in use than those of the board's pins.
fn only_these_pads(routing: &GowinRouting<'_>, pins: &[TopPin]) -> Result<(), BitstreamError> {
    let expected = pins.iter().map(|pin| routing.database().pad(pin.pin));
    let expected = expected.collect::<Result<HashSet<_>, BitstreamError>>()?;
    for ((row, column), settings) in &routing.tiles().settings {
        for (letter, pad) in &settings.pads {
            if pad.direction != PadDirection::None && !expected.contains(&(*row, *column, *letter)) {
                return Err(BitstreamError::UnknownCell(format!(
                    "a pad that the top does not use, R{row}C{column} pad {letter}: {:?}",
                    pad.direction
                )));
            }
        }
    }
    Ok(())
}

pub(super) struct GowinDecoder<'a> {
    pub(super) routing: &'a GowinRouting<'a>,
    pub(super) network: Network,
    outputs: OutputNets<GowinOutput>,
    /// Tables of carry chains, before the carry.
    functions: HashMap<(u8, u8, u8), NetIndex>,
    memories: HashSet<(u8, u8)>,
}

impl<'a> GowinDecoder<'a> {
    fn new(routing: &'a GowinRouting<'a>) -> Self {
        Self {
            routing,
            network: Network::of_constants(),
            outputs: OutputNets::new(),
            functions: HashMap::new(),
            memories: HashSet::new(),
        }
    }

    /// The net of an output, whose cell is decoded later.
    pub(super) fn net(&mut self, output: GowinOutput) -> NetIndex {
        self.outputs.net(&mut self.network, output, GowinOutput::identifier)
    }

    /// The net of a source, which a cell needs.
    pub(super) fn driven(&mut self, source: GowinSource, of: GowinOutput) -> Result<NetIndex, BitstreamError> {
        match source {
            GowinSource::Constant(false) => Ok(LOW),
            GowinSource::Constant(true) => Ok(HIGH),
            GowinSource::Output(output) => Ok(self.net(output)),
            GowinSource::Nothing => Err(unknown(of, "an input that it needs has no driver")),
        }
    }

    /// The net that drives a wire of a cell's tile.
    fn input(&mut self, of: GowinOutput, name: &str) -> Result<NetIndex, BitstreamError> {
        let source = self.routing.source(of.row, of.column, name)?;
        self.driven(source, of)
    }

    /// Checks that something drives every output that is in use.
    fn check_driven(&self) -> Result<(), BitstreamError> {
        match self.outputs.undriven(&self.network) {
            Some(output) => Err(unknown(output, "a bit of a memory that nothing writes")),
            None => Ok(()),
        }
    }

    fn cell(&mut self, output: GowinOutput, memories: &memory::StoredContents<'_>) -> Result<(), BitstreamError> {
        let net = self.net(output);
        match output.port {
            GowinPort::Pad(_) => {
                if !self.network.inputs.iter().any(|(_, input)| *input == net) {
                    return Err(unknown(output, "a pad that is no input of the top"));
                }
            }
            GowinPort::Table(table) => {
                if self.is_carry(output, table) {
                    let function = self.function(output, table)?;
                    let Some(before) = carry_before(self.routing, output, table) else {
                        return Err(unknown(output, "the sum of a carry that nothing drives"));
                    };
                    let carry = self.net(before);
                    self.network.gates.push(Gate::sum(net, function, carry));
                } else {
                    self.table(output, table, net)?;
                }
            }
            GowinPort::Carry(table) => self.carry(output, table, net)?,
            GowinPort::Multiplexer(index) => {
                let (low, high) = multiplexed(output, index, self.routing.database().columns())?;
                let select = self.input(output, &format!("SEL{index}"))?;
                let (low, high) = (self.net(low), self.net(high));
                self.network.gates.push(Gate::choice(net, select, [low, high]));
            }
            GowinPort::Flop(flop) => self.flop(output, flop, net)?,
            GowinPort::Memory(_) => {
                let place = (output.row, output.column);
                if self.memories.insert(place) {
                    let memory = memory::decode(self, memories, place)?;
                    self.network.memories.push(NetworkMemory::Plain(memory));
                }
            }
        }
        Ok(())
    }

    fn is_carry(&self, of: GowinOutput, table: u8) -> bool {
        let slice = self.routing.tiles().slice(of.row, of.column, table / 2);
        slice.is_some_and(|slice| slice.carry)
    }

    /// A look-up table.
    fn table(&mut self, of: GowinOutput, table: u8, net: NetIndex) -> Result<(), BitstreamError> {
        let values = self.routing.tiles().table(of.row, of.column, table);
        let inputs = table_inputs(self.routing, of, table)?;
        let mut nets = [LOW; 4];
        for (net, source) in nets.iter_mut().zip(relevant(values, inputs)) {
            *net = self.driven(source, of)?;
        }
        self.network.gates.push(Gate::new(net, &nets, values));
        Ok(())
    }

    /// The output of a table of a carry chain before the carry; a constant has the constant's net.
    fn function(&mut self, of: GowinOutput, table: u8) -> Result<NetIndex, BitstreamError> {
        let place = (of.row, of.column, table);
        if let Some(net) = self.functions.get(&place) {
            return Ok(*net);
        }
        let values = self.routing.tiles().table(of.row, of.column, table);
        let inputs = relevant(values, table_inputs(self.routing, of, table)?);
        let net = match constant_function(values, inputs) {
            Some(false) => LOW,
            Some(true) => HIGH,
            None => {
                let net = self
                    .network
                    .new_net(format!("r{}c{}_function{table}", of.row, of.column));
                self.table(of, table, net)?;
                net
            }
        };
        self.functions.insert(place, net);
        Ok(net)
    }

    /// The carry of a table: the carry into it while its function is high, else what the table has for A and B with C and D low.
    fn carry(&mut self, of: GowinOutput, table: u8, net: NetIndex) -> Result<(), BitstreamError> {
        let function = self.function(of, table)?;
        let values = self.routing.tiles().table(of.row, of.column, table);
        let generated = values & GENERATED;
        let [a, b, ..] = table_inputs(self.routing, of, table)?;
        let low = GowinSource::Constant(false);
        let [a, b, ..] = relevant(generated, [a, b, low, low]);
        let (a, b) = match function {
            // What is generated does not matter.
            HIGH => (LOW, LOW),
            _ => (self.driven(a, of)?, self.driven(b, of)?),
        };
        let carry = match function {
            LOW => LOW,
            _ => match carry_before(self.routing, of, table) {
                Some(before) => self.net(before),
                None => return Err(unknown(of, "it depends on a carry that nothing drives")),
            },
        };
        let gate = Gate::carry(net, (function, carry), [a, b], generated);
        self.network.gates.push(gate);
        Ok(())
    }

    fn flop(&mut self, output: GowinOutput, flop: u8, net: NetIndex) -> Result<(), BitstreamError> {
        let slice = flop / 2;
        let Some(settings) = self.routing.tiles().slice(output.row, output.column, slice) else {
            return Err(unknown(output, "a flip-flop in a slice without settings"));
        };
        if settings.inverted {
            return Err(unknown(output, "a flip-flop at the falling edge"));
        }
        let data = self.net(GowinOutput {
            port: GowinPort::Table(flop),
            ..output
        });
        let clock = self.input(output, &format!("CLK{slice}"))?;
        let enable = self.input(output, &format!("CE{slice}"))?;
        let reset = match settings.reset {
            None => LOW,
            Some(_) => self.input(output, &format!("LSR{slice}"))?,
        };
        let level = settings.set[usize::from(flop % 2)];
        self.network.states.push(State {
            output: net,
            clock,
            data,
            enable,
            reset,
            is_asynchronous: settings.reset == Some(SliceReset::Asynchronous),
            reset_to: level,
            reset_needs_enable: false,
            initial: level,
        });
        Ok(())
    }
}

impl GowinOutput {
    /// The output as an identifier of Verilog.
    pub(super) fn identifier(self) -> String {
        let Self { row, column, port } = self;
        let what = match port {
            GowinPort::Table(table) => format!("f{table}"),
            GowinPort::Multiplexer(index) => format!("of{index}"),
            GowinPort::Carry(table) => format!("cout{table}"),
            GowinPort::Flop(flop) => format!("q{flop}"),
            GowinPort::Memory(bit) => format!("do{bit}"),
            GowinPort::Pad(letter) => format!("pad_{}", letter.to_ascii_lowercase()),
        };
        format!("r{row}c{column}_{what}")
    }
}

/// The table whose carry goes into a table; `None` where the chain begins.
pub(super) fn carry_before(routing: &GowinRouting<'_>, of: GowinOutput, table: u8) -> Option<GowinOutput> {
    let (column, before) = match table.checked_sub(1) {
        Some(before) => (of.column, before),
        None => (of.column.checked_sub(1)?, CARRIES - 1),
    };
    let slice = routing.tiles().slice(of.row, column, before / 2);
    slice.is_some_and(|slice| slice.carry).then_some(GowinOutput {
        row: of.row,
        column,
        port: GowinPort::Carry(before),
    })
}

/// What a multiplexer chooses from: the first while its select input is low, the second while it is high. The last one of a tile takes
/// one input from the tile on the right.
pub(super) fn multiplexed(
    of: GowinOutput,
    index: u8,
    columns: u8,
) -> Result<(GowinOutput, GowinOutput), BitstreamError> {
    let at = |port| GowinOutput { port, ..of };
    let multiplexer = |index| at(GowinPort::Multiplexer(index));
    Ok(match index {
        0 | 2 | 4 | 6 => (at(GowinPort::Table(index)), at(GowinPort::Table(index + 1))),
        1 => (multiplexer(2), multiplexer(0)),
        5 => (multiplexer(6), multiplexer(4)),
        3 => (multiplexer(5), multiplexer(1)),
        _ if of.column + 1 < columns => {
            let right = GowinOutput {
                column: of.column + 1,
                ..multiplexer(3)
            };
            (right, multiplexer(3))
        }
        _ => return Err(unknown(of, "a multiplexer without a tile on its right")),
    })
}

pub(super) fn unknown(output: GowinOutput, what: &str) -> BitstreamError {
    BitstreamError::UnknownCell(format!("{output}: {what}"))
}
