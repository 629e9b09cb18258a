//! A host at the line of a stage: requests for its registers, some of them damaged; and the stage's pins.

use std::collections::VecDeque;

use posicast_model::link::Request;
use posicast_model::rtl::component::Component;
use posicast_model::rtl::linked_stage::BridgeConfig;
use posicast_model::rtl::spi_bridge::LEAST_CLOCKS_PER_BIT;
use posicast_model::rtl::{Direction, Port};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::table::pick;
use super::{StageRandom, Stimuli};

/// Inputs of the bus of a stage, after `rst`.
const BUS_INPUTS: usize = 5;
/// Most words of a request, so that many requests fit into a run.
const WORDS: u8 = 6;
/// Number of levels for which the host waits after a request and after the last edge of a reply.
const PATIENCE: f64 = 60.0;
/// Bits of a byte on a serial line.
const FRAME_BITS: u32 = 10;
/// Half a period of an SPI host's clock, in clocks: the fastest.
const HALF_CLOCKS: f64 = LEAST_CLOCKS_PER_BIT as f64 / 2.0;
/// Bytes 00 by which an SPI host gets a reply.
const REPLY_BYTES: usize = 48;
/// The levels of idle lines.
const IDLE_UART: Levels = [true, false, false];
const IDLE_SPI: Levels = [false, true, false];
/// Levels of the inputs of the line: one, or `spi_sck`, `spi_cs_n`, `spi_mosi`.
type Levels = [bool; 3];

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
    is_spi: bool,
    /// Clocks for which a level stays.
    level_clocks: f64,
    /// Levels that wait for the line.
    line: VecDeque<Levels>,
    levels: Levels,
    left: f64,
    quiet: f64,
    sequence: u8,
    last: Vec<u8>,
    clock: u64,
}

impl LinkedStageRandom {
    /// Creates the host of a stage with these axes, at a clock in Hz. Equal seeds give equal inputs.
    pub fn new(stage: &Component, axes: &[String], (config, clock_hz): (&BridgeConfig, f64), seed: u64) -> Self {
        let ports = stage.composition().ports();
        let count = |direction| ports.iter().filter(|port| port.direction == direction).count();
        let mut outputs = ports.iter().filter(|port| port.direction == Direction::Output);
        let registers = stage.map().registers().iter();
        let is_spi = matches!(config, BridgeConfig::Spi(_));
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
            is_spi,
            level_clocks: match config {
                BridgeConfig::Uart(config) => clock_hz / f64::from(config.baud()),
                BridgeConfig::Spi(_) => HALF_CLOCKS,
            },
            line: VecDeque::new(),
            levels: if is_spi { IDLE_SPI } else { IDLE_UART },
            left: 0.0,
            quiet: 0.0,
            sequence: 0,
            last: Vec::new(),
            clock: 0,
        }
    }

    /// Address of a register, or of any word; or the last address that exists, or the first that does not.
    fn address(&mut self) -> u16 {
        match self.rng.random_range(0..20) {
            0 => self.rng.random_range(0..self.words + 2),
            1 => self.words - 1,
            2 => self.words,
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
        match self.is_spi {
            false => frame.into_iter().for_each(|byte| self.serial_byte(byte)),
            true => {
                // A host takes the reply in a selection of its own, or in that of the request.
                frame.into_iter().for_each(|byte| self.spi_byte(byte));
                if self.rng.random_range(0..2) == 0 {
                    self.line.extend([IDLE_SPI; 2]);
                }
                (0..REPLY_BYTES).for_each(|_| self.spi_byte(0));
                self.line.extend([IDLE_SPI; 2]);
            }
        }
        self.quiet = 0.0;
    }

    fn serial_byte(&mut self, byte: u8) {
        let bits = 1 << (FRAME_BITS - 1) | u32::from(byte) << 1;
        let levels = (0..FRAME_BITS).map(|bit| [bits >> bit & 1 != 0, false, false]);
        self.line.extend(levels);
    }

    fn spi_byte(&mut self, byte: u8) {
        let levels = (0..8).rev().map(|bit| byte >> bit & 1 != 0);
        self.line
            .extend(levels.flat_map(|mosi| [[false, false, mosi], [true, false, mosi]]));
    }

    /// Clocks of a byte on the line.
    pub(crate) fn byte_clocks(config: &BridgeConfig, clock_hz: f64) -> f64 {
        match config {
            BridgeConfig::Uart(config) => f64::from(FRAME_BITS) * clock_hz / f64::from(config.baud()),
            BridgeConfig::Spi(_) => 16.0 * HALF_CLOCKS,
        }
    }

    fn levels(&mut self, to_host: bool) -> Levels {
        self.left -= 1.0;
        while self.left <= 0.0 {
            self.left += self.level_clocks;
            let idle = if self.is_spi { IDLE_SPI } else { IDLE_UART };
            self.levels = self.line.pop_front().unwrap_or(idle);
        }
        self.quiet = match (to_host || self.is_spi) && self.line.is_empty() {
            true => self.quiet + 1.0 / self.level_clocks,
            false => 0.0,
        };
        if self.quiet > PATIENCE {
            self.send();
        }
        self.levels
    }
}

impl Stimuli for LinkedStageRandom {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        let ([to_host, shown @ ..], [rst, rest @ ..]) = (seen, &mut *inputs) else {
            return;
        };
        let count = if self.is_spi { 3 } else { 1 };
        let Some((lines, pins)) = rest.split_at_mut_checked(count) else {
            return;
        };
        let behind = shown.len().min(self.read_data);
        self.stage_outputs[..behind].copy_from_slice(&shown[..behind]);
        self.stage_outputs[behind + 1..].copy_from_slice(&shown[behind..]);
        self.pins.fill(&self.stage_outputs, &mut self.stage_inputs);
        pins.copy_from_slice(&self.stage_inputs[1 + BUS_INPUTS..]);
        *rst = u64::from(self.clock < 2 || self.rng.random_range(0..200_000) == 0);
        let levels = self.levels(*to_host != 0);
        lines
            .iter_mut()
            .zip(levels)
            .for_each(|(line, level)| *line = level.into());
        self.clock += 1;
    }
}
