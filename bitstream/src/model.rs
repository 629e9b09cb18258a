//! The bit-exact model of the board's top: what its pins show in every clock.
//!
//! It is written from the description of [`top`](crate::top), not from the Verilog; the shapers are those of `posicast-blocks`.

use crate::top::crc::checksum;
use crate::top::{BoardTop, COMMAND_MARK, PAUSE_BITS, RESET_CLOCKS, RESULT_MARK};
use posicast_blocks::shaper::{Inputs, Shaper, wrap};

/// The output pins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BoardOutputs {
    /// Level of the serial line to the host.
    pub serial_tx: bool,
    /// Level of the LED's pin.
    pub led: bool,
}

/// The model, clock by clock.
pub struct BoardModel {
    bit_clocks: u32,
    sample_clocks: u32,
    word_bits: u32,
    word_bytes: usize,
    led_is_active_low: bool,
    slowest: usize,
    resets: u32,
    receiver: Receiver,
    /// Bytes of the frame's words that are there; `None` before its mark.
    frame: Option<Vec<u8>>,
    idle: u32,
    commands: Vec<i64>,
    frames: u64,
    count: u32,
    strobe: bool,
    shapers: Vec<Shaper>,
    sender: Sender,
    samples: u64,
    /// Sample, from 0, with the first command of each axis that was not 0.
    first_commands: Vec<Option<u64>>,
    strobes: u64,
}

/// The receiver of bytes.
#[derive(Default)]
struct Receiver {
    line: [bool; 2],
    clocks: u32,
    /// Bits that are still to come.
    bits: u32,
    byte: u8,
    /// A byte that is complete.
    valid: bool,
}

/// The sender of frames.
struct Sender {
    /// Levels of the line that are still to come, the next one last; high if there are none.
    bits: Vec<bool>,
    clocks: u32,
    /// Before the reset, the register holds the 0 of power-up.
    has_been_reset: bool,
}

impl BoardModel {
    /// The model after power-up.
    #[must_use]
    pub fn new(top: &BoardTop) -> Self {
        let axes = top.axes();
        Self {
            bit_clocks: top.bit_clocks(),
            sample_clocks: top.sample_clocks(),
            word_bits: top.word_bits(),
            word_bytes: top.word_bytes() as usize,
            led_is_active_low: top.board().led_is_active_low,
            slowest: top.slowest_axis(),
            resets: 0,
            receiver: Receiver::default(),
            frame: None,
            idle: 0,
            commands: vec![0; axes.len()],
            frames: 0,
            count: 0,
            strobe: false,
            shapers: axes.iter().map(|axis| Shaper::new(&axis.config, 1)).collect(),
            sender: Sender {
                bits: Vec::new(),
                clocks: 0,
                has_been_reset: false,
            },
            samples: 0,
            first_commands: vec![None; axes.len()],
            strobes: 0,
        }
    }

    /// The pins before the next rising edge of the clock.
    #[must_use]
    pub fn outputs(&self) -> BoardOutputs {
        let lit = self
            .shapers
            .iter()
            .map(Shaper::outputs)
            .any(|out| out.saturated || out.overrun);
        BoardOutputs {
            serial_tx: self.sender.has_been_reset && self.sender.bits.last().copied().unwrap_or(true),
            led: lit != self.led_is_active_low,
        }
    }

    /// A rising edge of the clock, with this level of the line from the host.
    pub fn clock(&mut self, serial_rx: bool) {
        let rst = self.resets != RESET_CLOCKS;
        let shaped: Vec<_> = self.shapers.iter().map(Shaper::outputs).collect();
        let valid = shaped.get(self.slowest).is_some_and(|out| out.valid);
        self.send(rst, valid.then(|| shaped.iter().map(|out| out.y).collect()));
        self.samples += u64::from(valid && !rst);
        self.shape(rst);
        self.take_byte(rst);
        self.receiver.clock(rst, serial_rx, self.bit_clocks);
        self.resets = (self.resets + 1).min(RESET_CLOCKS);
    }

    /// Number of shaped samples so far.
    #[must_use]
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// Number of whole frames that were taken.
    #[must_use]
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Samples since the first command of this axis that was not 0, with it; a tap whose delay is smaller has had a product.
    #[must_use]
    pub fn samples_with_command(&self, axis: usize) -> u64 {
        // A sample counts when its result has come.
        let first = self.first_commands.get(axis).copied().flatten();
        first.map_or(0, |first| self.samples.saturating_sub(first))
    }

    fn shape(&mut self, rst: bool) {
        for (index, shaper) in self.shapers.iter_mut().enumerate() {
            let x = self.commands[index];
            shaper.step(&Inputs {
                rst,
                strobe: self.strobe,
                x,
                ..Inputs::default()
            });
            if self.strobe && !rst && x != 0 && self.first_commands[index].is_none() {
                self.first_commands[index] = Some(self.strobes);
            }
        }
        self.strobes += u64::from(self.strobe && !rst);
        let is_last = self.count == self.sample_clocks - 1;
        self.strobe = !rst && is_last;
        self.count = if rst || is_last { 0 } else { self.count + 1 };
    }

    fn take_byte(&mut self, rst: bool) {
        if rst {
            self.frame = None;
            return;
        }
        if !self.receiver.valid {
            if self.idle == PAUSE_BITS * self.bit_clocks {
                self.frame = None;
            } else {
                self.idle += 1;
            }
            return;
        }
        self.idle = 0;
        let Some(bytes) = &mut self.frame else {
            self.frame = (self.receiver.byte == COMMAND_MARK).then(Vec::new);
            return;
        };
        let words = self.word_bytes * self.commands.len();
        if bytes.len() < words {
            bytes.push(self.receiver.byte);
            return;
        }
        if self.receiver.byte == checksum([COMMAND_MARK].into_iter().chain(bytes.iter().copied())) {
            for (command, word) in self.commands.iter_mut().zip(bytes.chunks(self.word_bytes)) {
                let value = word.iter().rev().fold(0, |value, byte| value << 8 | i64::from(*byte));
                *command = wrap(value, self.word_bits);
            }
            self.frames += 1;
        }
        self.frame = None;
    }

    fn send(&mut self, rst: bool, words: Option<Vec<i64>>) {
        let sender = &mut self.sender;
        let last = self.bit_clocks - 1;
        if rst {
            sender.has_been_reset = true;
            sender.bits.clear();
            sender.clocks = 0;
        } else if let Some(words) = words {
            let bytes = words
                .iter()
                .flat_map(|word| word.to_le_bytes().into_iter().take(self.word_bytes));
            let bytes: Vec<u8> = std::iter::once(RESULT_MARK).chain(bytes).collect();
            let crc = checksum(bytes.iter().copied());
            let framed = bytes.into_iter().chain([crc]).flat_map(|byte| {
                let data = (0..8).map(move |bit| byte >> bit & 1 == 1);
                std::iter::once(false).chain(data).chain([true])
            });
            sender.bits = framed.collect();
            sender.bits.reverse();
            sender.clocks = last;
        } else if sender.clocks != 0 {
            sender.clocks -= 1;
        } else {
            sender.clocks = last;
            sender.bits.pop();
        }
    }
}

impl Receiver {
    fn clock(&mut self, rst: bool, serial_rx: bool, bit_clocks: u32) {
        let level = self.line[1];
        self.line = [serial_rx, self.line[0]];
        self.valid = false;
        if rst {
            self.bits = 0;
        } else if self.bits == 0 {
            self.clocks = bit_clocks / 2 - 1;
            if !level {
                self.bits = 10;
            }
        } else if self.clocks != 0 {
            self.clocks -= 1;
        } else {
            self.clocks = bit_clocks - 1;
            self.valid = self.bits == 1 && level;
            if self.bits != 1 {
                self.byte = self.byte >> 1 | u8::from(level) << 7;
            }
            // A start bit that was only a spike ends the byte.
            self.bits = if self.bits == 10 && level { 0 } else { self.bits - 1 };
        }
    }
}
