//! A host at the serial line of a stage: requests for its registers, some of them damaged; and the stage's pins.

use std::collections::VecDeque;

use posicast_model::link::Request;
use posicast_model::rtl::component::Component;
use posicast_model::rtl::uart_bridge::UartBridgeConfig;
use posicast_model::rtl::{Direction, Port};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::table::pick;
use super::{StageRandom, Stimuli};

/// Inputs of the bus of a stage, after `rst`.
const BUS_INPUTS: usize = 5;
/// Most words of a request, so that many requests fit into a run.
const WORDS: u8 = 6;
/// Number of bits for which the host waits after a request and after the last edge of a reply.
const PATIENCE_BITS: f64 = 60.0;
/// Bits of a byte on the line.
const FRAME_BITS: u32 = 10;

/// An endless random mixture of a host's requests, and of everything at the pins.
pub struct LinkedStageRandom {
    rng: Xoshiro256PlusPlus,
    pins: StageRandom,
    stage_inputs: Vec<u64>,
    stage_outputs: Vec<u64>,
    /// Place of `avs_readdata` among the stage's outputs.
    read_data: usize,
    /// Offsets of the registers.
    offsets: Vec<u16>,
    words: u16,
    clocks_per_bit: f64,
    /// Levels that wait for the line, a bit each.
    line: VecDeque<bool>,
    level: bool,
    left: f64,
    quiet_bits: f64,
    sequence: u8,
    last: Vec<u8>,
    clock: u64,
}

impl LinkedStageRandom {
    /// Creates the host of a stage with these axes, at a clock in Hz. Equal seeds give equal inputs.
    pub fn new(stage: &Component, axes: &[String], (config, clock_hz): (&UartBridgeConfig, f64), seed: u64) -> Self {
        let ports = stage.composition().ports();
        let count = |direction| ports.iter().filter(|port| port.direction == direction).count();
        let mut outputs = ports.iter().filter(|port| port.direction == Direction::Output);
        let registers = stage.map().registers().iter();
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            pins: StageRandom::new(stage, axes, seed),
            stage_inputs: vec![0; count(Direction::Input)],
            stage_outputs: vec![0; count(Direction::Output)],
            read_data: outputs.position(|port: &Port| port.name == "avs_readdata").unwrap_or(0),
            offsets: registers
                .filter_map(|register| u16::try_from(register.offset).ok())
                .collect(),
            words: config.address_limit(),
            clocks_per_bit: clock_hz / f64::from(config.baud()),
            line: VecDeque::new(),
            level: true,
            left: 0.0,
            quiet_bits: 0.0,
            sequence: 0,
            last: Vec::new(),
            clock: 0,
        }
    }

    fn address(&mut self) -> u16 {
        match self.rng.random_range(0..20) {
            0 => self.rng.random_range(0..self.words + 2),
            _ => *pick(&mut self.rng, &self.offsets),
        }
    }

    fn frame(&mut self) -> Vec<u8> {
        if self.rng.random_range(0..8) == 0 && !self.last.is_empty() {
            return self.last.clone();
        }
        let count = self.rng.random_range(1..=WORDS);
        let list: Vec<u16> = (0..count).map(|_| self.address()).collect();
        let words: Vec<u32> = list
            .iter()
            .map(|_| self.rng.next_u32() >> self.rng.random_range(0..32))
            .collect();
        let address = list[0];
        let request = match self.rng.random_range(0..4) {
            0 => Request::Read { address, count },
            1 => Request::Write { address, words },
            2 => Request::ReadList(list),
            _ => Request::WriteList(list.into_iter().zip(words).collect()),
        };
        self.sequence = self.sequence % u8::MAX + 1;
        self.last = request.encode(self.sequence).unwrap_or_default();
        self.last.clone()
    }

    fn send(&mut self) {
        let mut frame = self.frame();
        let place = self.rng.random_range(0..frame.len().max(1));
        match self.rng.random_range(0..24) {
            0 => drop(frame.pop()),
            1 => frame.truncate(place),
            2 => frame.iter_mut().skip(place).take(1).for_each(|byte| *byte ^= 0x10),
            _ => {}
        }
        for byte in frame {
            let bits = 1 << (FRAME_BITS - 1) | u32::from(byte) << 1;
            self.line.extend((0..FRAME_BITS).map(|bit| bits >> bit & 1 != 0));
        }
        self.quiet_bits = 0.0;
    }

    fn level(&mut self, uart_tx: bool) -> bool {
        self.left -= 1.0;
        while self.left <= 0.0 {
            self.left += self.clocks_per_bit;
            self.level = self.line.pop_front().unwrap_or(true);
        }
        self.quiet_bits = match uart_tx && self.line.is_empty() {
            true => self.quiet_bits + 1.0 / self.clocks_per_bit,
            false => 0.0,
        };
        if self.quiet_bits > PATIENCE_BITS {
            self.send();
        }
        self.level
    }
}

impl Stimuli for LinkedStageRandom {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        let ([uart_tx, shown @ ..], [rst, uart_rx, pins @ ..]) = (seen, &mut *inputs) else {
            return;
        };
        let behind = shown.len().min(self.read_data);
        self.stage_outputs[..behind].copy_from_slice(&shown[..behind]);
        self.stage_outputs[behind + 1..].copy_from_slice(&shown[behind..]);
        self.pins.fill(&self.stage_outputs, &mut self.stage_inputs);
        pins.copy_from_slice(&self.stage_inputs[1 + BUS_INPUTS..]);
        *rst = u64::from(self.clock < 2 || self.rng.random_range(0..200_000) == 0);
        *uart_rx = u64::from(self.level(*uart_tx != 0));
        self.clock += 1;
    }
}
