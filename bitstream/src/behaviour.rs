//! Lock step: the netlist of the bits beside the bit-exact model of the top, with the same random serial line, compared at every pin in
//! every clock.

use crate::BitstreamError;
use crate::model::BoardModel;
use crate::network::{NetlistSimulation, Network};
use crate::random::Random;
use crate::top::crc::checksum;
use crate::top::{BoardTop, COMMAND_MARK, PAUSE_BITS};
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::VecDeque;

/// Clocks between two reports of progress.
const STEP_CLOCKS: u64 = 1 << 14;

/// Result of a lock step.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct BehaviourReport {
    /// Clocks compared.
    pub clocks: u64,
    /// Shaped samples of each axis among them.
    pub samples: u64,
    /// Frames with commands that the model took.
    pub frames: u64,
    /// Taps with a command that is not 0, of all axes.
    pub taps_exercised: u64,
    /// Taps of all axes.
    pub taps: u64,
    /// Changes of the line to the host.
    pub line_changes: u64,
    /// Changes of the LED after the reset.
    pub led_changes: u64,
    /// The first difference, at which the comparison ends.
    pub first: Option<PinDifference>,
}

/// A difference between the bits and the model.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct PinDifference {
    /// Clock after power-up.
    pub clock: u64,
    /// Port of the top.
    pub port: &'static str,
    /// Level of the model.
    pub expected: bool,
    /// Level of the netlist of the bits.
    pub actual: bool,
}

impl BehaviourReport {
    /// Whether everything that the verdict covers was exercised and is equal.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.first.is_none() && self.samples > 0 && self.taps_exercised == self.taps
    }
}

/// Fewest clocks in which the stimuli exercise all taps, with some to spare.
#[must_use]
pub fn least_clocks(top: &BoardTop) -> u64 {
    const SPARE_SAMPLES: u64 = 32;
    let longest = top
        .axes()
        .iter()
        .map(|axis| axis.config.table().longest_delay_samples())
        .max();
    (u64::from(longest.unwrap_or(0)) + SPARE_SAMPLES) * u64::from(top.sample_clocks())
}

/// Compares the netlist of the bits with the model of the top; `progress` takes the clocks done.
///
/// # Errors
/// [`BitstreamError::UnknownCell`] if the netlist cannot be simulated.
pub fn compare(
    network: &Network,
    top: &BoardTop,
    (clocks, seed): (u64, u64),
    progress: &mut dyn FnMut(u64),
) -> Result<BehaviourReport, BitstreamError> {
    let [(_, clock), (_, rx), (line, tx), (led, led_pin)] = top.board().pins();
    let mut simulation = NetlistSimulation::new(network, clock.pin)?;
    let serial_rx = simulation.input(rx.pin)?;
    let outputs = [simulation.output(tx.pin)?, simulation.output(led_pin.pin)?];
    let mut model = BoardModel::new(top);
    let mut host = Host::new(top, seed);
    let mut report = BehaviourReport {
        clocks: 0,
        samples: 0,
        frames: 0,
        taps_exercised: 0,
        taps: top
            .axes()
            .iter()
            .map(|axis| axis.config.table().taps().len() as u64)
            .sum(),
        line_changes: 0,
        led_changes: 0,
        first: None,
    };
    let mut before = model.outputs();
    while report.clocks < clocks && report.first.is_none() {
        let level = host.level();
        simulation.set(serial_rx, level);
        simulation.settle();
        let expected = model.outputs();
        report.line_changes += u64::from(expected.serial_tx != before.serial_tx);
        report.led_changes += u64::from(expected.led != before.led);
        before = expected;
        let pairs = [(line, expected.serial_tx, outputs[0]), (led, expected.led, outputs[1])];
        let pairs = pairs.map(|(port, expected, net)| (port, expected, simulation.level(net)));
        let different = pairs.into_iter().find(|(_, expected, actual)| expected != actual);
        report.first = different.map(|(port, expected, actual)| PinDifference {
            clock: report.clocks,
            port,
            expected,
            actual,
        });
        model.clock(level);
        simulation.clock();
        report.clocks += 1;
        if report.clocks.is_multiple_of(STEP_CLOCKS) {
            progress(report.clocks);
        }
    }
    report.samples = model.samples();
    report.frames = model.frames();
    let exercised = top.axes().iter().enumerate().map(|(axis, of)| {
        let samples = model.samples_with_command(axis);
        of.config
            .table()
            .taps()
            .iter()
            .filter(|tap| u64::from(tap.delay_samples) < samples)
            .count() as u64
    });
    report.taps_exercised = exercised.sum();
    Ok(report)
}

/// A host that sends random frames: mostly whole ones, some with a wrong mark or checksum, some that break off, with pauses and spikes between.
struct Host {
    random: Random,
    bit_clocks: u64,
    axes: usize,
    word_bytes: usize,
    /// Levels that are still to be sent, with their clocks.
    waiting: VecDeque<(bool, u64)>,
}

impl Host {
    fn new(top: &BoardTop, seed: u64) -> Self {
        Self {
            random: Random::new(seed),
            bit_clocks: u64::from(top.bit_clocks()),
            axes: top.axes().len(),
            word_bytes: top.word_bytes() as usize,
            waiting: VecDeque::new(),
        }
    }

    /// The level of the line in the next clock.
    fn level(&mut self) -> bool {
        while self.waiting.is_empty() {
            self.think();
        }
        let Some((level, clocks)) = self.waiting.front_mut() else {
            return true;
        };
        let level = *level;
        *clocks -= 1;
        if *clocks == 0 {
            self.waiting.pop_front();
        }
        level
    }

    fn think(&mut self) {
        if self.random.once_in(16) {
            // A spike that is too short to be a start bit.
            self.waiting
                .push_back((false, 1 + self.random.below(self.bit_clocks / 4)));
            self.idle(2);
        }
        if self.random.once_in(6) {
            let bits = 1 + self.random.below(2 * u64::from(PAUSE_BITS));
            self.idle(bits);
        }
        let mark = if self.random.once_in(32) {
            self.random.next() as u8
        } else {
            COMMAND_MARK
        };
        let mut bytes = vec![mark];
        for _ in 0..self.axes {
            let word = self.word();
            bytes.extend(word.to_le_bytes().into_iter().take(self.word_bytes));
        }
        let crc = checksum(bytes.iter().copied());
        let is_wrong = self.random.once_in(16);
        bytes.push(if is_wrong { crc ^ 1 << self.random.below(8) } else { crc });
        if self.random.once_in(24) {
            bytes.truncate(1 + self.random.below(bytes.len() as u64) as usize);
        }
        for byte in bytes {
            self.waiting.push_back((false, self.bit_clocks));
            let bits = (0..8).map(|bit| (byte >> bit & 1 == 1, self.bit_clocks));
            self.waiting.extend(bits);
            self.idle(1);
        }
    }

    fn idle(&mut self, bits: u64) {
        self.waiting.push_back((true, bits * self.bit_clocks));
    }

    /// A command: an end of the range, a small number, or any number.
    fn word(&mut self) -> i64 {
        let any = self.random.next() as i64;
        match self.random.below(4) {
            0 => i64::MAX,
            1 => i64::MIN,
            2 => any >> 56,
            _ => any,
        }
    }
}
