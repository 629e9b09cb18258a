//! The serial line between the host and the bits, in simulated time.

use super::Bare;
use posicast_bitstream::BitstreamError;
use posicast_bitstream::behaviour::PinDifference;
use posicast_bitstream::boards::FpgaBoard;
use posicast_bitstream::network::{NetIndex, NetlistSimulation, Network};
use posicast_bitstream::top::stage::{POWER_ON_CLOCKS, is_high_when_healthy};
use posicast_bitstream::top::stand_in::{StandInModel, StandInPins};
use posicast_blocks::{ClockedBlock, Direction};
use posicast_testbench::blocks::Block;
use posicast_testbench::linked_stage::LinkedStageBlock;
use std::collections::VecDeque;
use std::io::{self, Read, Write};

/// Clocks between two reports of progress.
const STEP_CLOCKS: u64 = 1 << 16;
/// Time for which the host waits for a byte, in bits of the line.
const SILENCE_BITS: f64 = 20_000.0;

/// Places of an axis's ports among the inputs and outputs of the model.
struct BareAxis {
    model: StandInModel,
    lines: [usize; 2],
    /// Gates, drive and brake.
    pins: [usize; 6],
}

/// The line to a board, in simulated time.
pub(super) struct BareLine<'p> {
    simulation: NetlistSimulation,
    rx: NetIndex,
    /// Line to the host and LED.
    shown: [(&'static str, NetIndex); 2],
    led_is_active_low: bool,
    model: Box<dyn ClockedBlock>,
    inputs: Vec<u64>,
    outputs: Vec<u64>,
    rst: usize,
    uart_rx: usize,
    uart_tx: usize,
    axes: Vec<BareAxis>,
    bit_clocks: f64,
    pub(super) clocks: u64,
    limit: u64,
    pub(super) first: Option<PinDifference>,
    /// Clock at the middle of the next bit of the byte that comes, and its bits so far, the start bit first.
    coming: Option<(f64, Vec<bool>)>,
    received: VecDeque<u8>,
    progress: &'p mut dyn FnMut(u64),
}

impl<'p> BareLine<'p> {
    pub(super) fn new(
        bare: &Bare<'_>,
        network: &Network,
        (block, board): (&LinkedStageBlock, &FpgaBoard),
        (limit, seed): (u64, u64),
        progress: &'p mut dyn FnMut(u64),
    ) -> Result<Self, BitstreamError> {
        let simulation = NetlistSimulation::new(network, board.clock.pin)?;
        let model = block.model(seed);
        let names = |direction| -> Vec<String> {
            let ports = model.ports().iter().filter(|port| port.direction == direction);
            ports.map(|port| port.name.clone()).collect()
        };
        let (inputs, outputs) = (names(Direction::Input), names(Direction::Output));
        let place = |names: &[String], name: &str| {
            let found = names.iter().position(|other| other == name);
            found.ok_or_else(|| BitstreamError::UnknownCell(format!("the stage has no port {name}")))
        };
        let axes = bare.stand_ins.iter().map(|stand_in| {
            let axis = stand_in.axis();
            let lines = ["a", "b"].map(|line| place(&inputs, &format!("{axis}_{line}")));
            let pins = ["a_high", "a_low", "b_high", "b_low", "drive_enable", "brake_release"];
            let [p0, p1, p2, p3, p4, p5] = pins.map(|pin| place(&outputs, &format!("{axis}_{pin}")));
            let [a, b] = lines;
            Ok(BareAxis {
                model: StandInModel::new(stand_in),
                lines: [a?, b?],
                pins: [p0?, p1?, p2?, p3?, p4?, p5?],
            })
        });
        let led = if board.led_is_active_low { "led_n" } else { "led" };
        Ok(Self {
            rx: simulation.input(board.serial_rx.pin)?,
            shown: [
                ("uart_tx", simulation.output(board.serial_tx.pin)?),
                (led, simulation.output(board.led.pin)?),
            ],
            led_is_active_low: board.led_is_active_low,
            axes: axes.collect::<Result<_, BitstreamError>>()?,
            rst: place(&inputs, "rst")?,
            uart_rx: place(&inputs, "uart_rx")?,
            uart_tx: place(&outputs, "uart_tx")?,
            inputs: inputs.iter().map(|name| is_high_when_healthy(name).into()).collect(),
            outputs: vec![0; outputs.len()],
            bit_clocks: f64::from(board.oscillator_hz) / f64::from(block.config().speed().1),
            clocks: 0,
            limit,
            first: None,
            coming: None,
            received: VecDeque::new(),
            simulation,
            model,
            progress,
        })
    }

    /// A clock with this level of the line from the host.
    fn clock(&mut self, level: bool) -> io::Result<()> {
        if let Some(first) = &self.first {
            return Err(io::Error::other(format!("{} differs from the model", first.port)));
        }
        if self.clocks >= self.limit {
            return Err(io::Error::other(format!(
                "the move has not ended after {} clocks",
                self.limit
            )));
        }
        self.inputs[self.rst] = (self.clocks < POWER_ON_CLOCKS).into();
        self.inputs[self.uart_rx] = level.into();
        for axis in &self.axes {
            for (place, level) in axis.lines.into_iter().zip(axis.model.lines()) {
                self.inputs[place] = level.into();
            }
        }
        self.model
            .step(&self.inputs, &mut self.outputs)
            .map_err(|error| io::Error::other(error.to_string()))?;
        self.simulation.set(self.rx, level);
        self.simulation.settle();
        let tx = self.outputs[self.uart_tx] != 0;
        let is_lit = self.clocks >= POWER_ON_CLOCKS;
        for ((port, net), expected) in self.shown.into_iter().zip([tx, is_lit != self.led_is_active_low]) {
            let actual = self.simulation.level(net);
            if actual != expected {
                self.first.get_or_insert(PinDifference {
                    clock: self.clocks,
                    port,
                    expected,
                    actual,
                });
            }
        }
        self.receive(tx);
        for axis in &mut self.axes {
            let [gates @ .., drive_enable, brake_release] = axis.pins.map(|place| self.outputs[place] != 0);
            axis.model.clock(StandInPins {
                gates,
                drive_enable,
                brake_release,
            });
        }
        self.simulation.clock();
        self.clocks += 1;
        if self.clocks.is_multiple_of(STEP_CLOCKS) {
            (self.progress)(self.clocks);
        }
        Ok(())
    }

    /// Takes the level of the line to the host.
    fn receive(&mut self, level: bool) {
        let now = self.clocks as f64;
        let Some((middle, bits)) = &mut self.coming else {
            if !level && self.clocks > POWER_ON_CLOCKS {
                self.coming = Some((now + self.bit_clocks / 2.0, Vec::new()));
            }
            return;
        };
        if now < *middle {
            return;
        }
        *middle += self.bit_clocks;
        bits.push(level);
        if let [start, data @ .., stop] = bits.as_slice()
            && data.len() == 8
        {
            if !*start && *stop {
                let byte = data.iter().rev().fold(0, |byte, bit| byte << 1 | u8::from(*bit));
                self.received.push_back(byte);
            }
            self.coming = None;
        }
    }
}

impl Write for BareLine<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        for byte in bytes {
            let begin = self.clocks as f64;
            let data = (0..8).map(|bit| byte >> bit & 1 != 0);
            for (index, level) in std::iter::once(false).chain(data).chain([true]).enumerate() {
                let end = begin + (index + 1) as f64 * self.bit_clocks;
                while (self.clocks as f64) < end {
                    self.clock(level)?;
                }
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Read for BareLine<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let end = self.clocks + (SILENCE_BITS * self.bit_clocks) as u64;
        while self.received.is_empty() {
            if self.clocks >= end {
                return Err(io::Error::other("no reply came"));
            }
            self.clock(true)?;
        }
        self.received.read(bytes)
    }
}
