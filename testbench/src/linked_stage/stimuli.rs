//! A host at the line of a stage: the driver of the stage's own bench, whose writes travel in requests; reads of every register; some
//! damaged frames; and the stage's pins.
//!
//! ```text
//! scenes and moods of StageRandom ─► writes that are due ─► one request ─► line ─► reply ─► the next
//!                     nothing due ─► a read of the next registers, or a tap or setting that is read back
//! ```
//!
//! A driver's pause begins when the reply to its writes has come, as in a driver that waits for each reply.

use std::collections::VecDeque;

use posicast_blocks::component::Component;
use posicast_blocks::link::{MOST_WORDS, Request};
use posicast_blocks::linked_stage::BridgeConfig;
use posicast_blocks::registers::{Access, RegisterMap};
use posicast_blocks::spi_bridge::LEAST_CLOCKS_PER_BIT;
use posicast_blocks::{Direction, Port};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::stage::StageRandom;
use crate::stimuli::Stimuli;
use crate::stimuli::link_host::{ReplyEnd, border_cases, damage, one_in};
use crate::stimuli::table::pick;

/// Inputs of the bus of a stage, after `rst`.
const BUS_INPUTS: usize = 5;
/// Largest numbers of a driver's words in a request.
const WRITTEN_WORDS: [usize; 4] = [4, 12, 24, 40];
/// Largest number of words of a read, so that reads do not hold up the driver.
const READ_WORDS: u8 = 6;
/// A host gives up after this many clocks of silence. The reply to a request of 40 words begins earlier.
const PATIENCE_CLOCKS: f64 = 3000.0;
/// Bits of a byte on a serial line.
const FRAME_BITS: u32 = 10;
/// Half a period of an SPI host's clock, in clocks: the fastest.
const HALF_CLOCKS: f64 = LEAST_CLOCKS_PER_BIT as f64 / 2.0;
/// Clocks, and levels of the silent line, of the reset after the opening.
const OPENING_RESET_CLOCKS: u32 = 16;
/// A mood lasts this many times as long as on the bus, because an access takes that much longer.
const LONGER_MOODS: u64 = 8;
/// The levels of idle lines.
const IDLE_UART: Levels = [true, false, false];
const IDLE_SPI: Levels = [false, true, false];
/// Levels of the inputs of the line: one, or `spi_sck`, `spi_cs_n`, `spi_mosi`.
type Levels = [bool; 3];

/// A frame, and the mask of the axes whose driver waits for the reply.
#[derive(Debug, Clone)]
struct Frame {
    bytes: Vec<u8>,
    waiting: u32,
}

/// Who drives the pins beside a line, and what the host at the line is to write.
pub(crate) trait BesideALine {
    /// Fills the inputs but those of the bus, for a driver that waits for the axes of the mask `waiting`; moods last `longer` times as
    /// long as on the bus.
    fn beside_a_line(&mut self, seen: &[u64], inputs: &mut [u64], waiting: u32, longer: u64);
    /// Returns at most `most` writes that the driver would make now, and the mask of their axes.
    fn due_writes(&mut self, most: usize) -> (Vec<(u32, u32)>, u32);
    /// Whether random writes may go to any register now.
    fn is_wild(&self) -> bool;
    /// Whether the driver is in a sequence of writes to an axis.
    fn writes(&self, axis: usize) -> bool;
}

impl BesideALine for StageRandom {
    fn beside_a_line(&mut self, seen: &[u64], inputs: &mut [u64], waiting: u32, longer: u64) {
        self.beside_a_line(seen, inputs, waiting, longer);
    }

    fn due_writes(&mut self, most: usize) -> (Vec<(u32, u32)>, u32) {
        self.due_writes(most)
    }

    fn is_wild(&self) -> bool {
        self.is_wild()
    }

    fn writes(&self, axis: usize) -> bool {
        self.writes(axis)
    }
}

/// The pins and the driver of a stage with these axes.
pub(super) fn pins(stage: &Component, axes: &[String], seed: u64) -> Box<dyn BesideALine> {
    Box::new(StageRandom::new(stage, axes, seed))
}

/// An endless conversation of a driver with a stage, and everything at the pins.
pub struct LinkedStageRandom {
    rng: Xoshiro256PlusPlus,
    pins: Box<dyn BesideALine>,
    stage_inputs: Vec<u64>,
    stage_outputs: Vec<u64>,
    /// Place of `avs_readdata` among the stage's outputs.
    read_data: usize,
    /// Offsets of the registers.
    offsets: Vec<u16>,
    /// Place in `offsets` of the next register to read.
    next_read: usize,
    /// Per axis, offsets of the words that show its motion.
    motion: Vec<Vec<u16>>,
    /// Per axis, offsets of the registers that read back taps, then of those for settings, if it has any: address, command, word.
    read_back: Vec<Vec<[u16; 3]>>,
    words: u16,
    is_spi: bool,
    /// Clocks for which a level stays.
    level_clocks: f64,
    /// Levels that wait for the line.
    line: VecDeque<Levels>,
    levels: Levels,
    left: f64,
    /// Levels of silence until the host gives up.
    patience: u32,
    reply: ReplyEnd,
    /// Frames to send before anything else.
    frames: VecDeque<Frame>,
    /// Whether the first of them, which leave the stage in any state, have not been sent yet; a reset follows them.
    opens: bool,
    /// Clocks left of that reset.
    reset_clocks: u32,
    /// Mask of the axes whose writes are on the line.
    waiting: u32,
    sequence: u8,
}

impl LinkedStageRandom {
    /// Creates the host of a stage with these axes, at a clock in Hz; `with_opening` begins with the directed requests of a
    /// bridge's own bench, and with a write and a read of every register. Equal seeds give equal inputs.
    pub(crate) fn new(
        (stage, pins): (&Component, Box<dyn BesideALine>),
        axes: &[String],
        (config, clock_hz): (&BridgeConfig, f64),
        with_opening: bool,
        seed: u64,
    ) -> Self {
        let ports = stage.composition().ports();
        let count = |direction| ports.iter().filter(|port| port.direction == direction).count();
        let mut outputs = ports.iter().filter(|port| port.direction == Direction::Output);
        let is_spi = matches!(config, BridgeConfig::Spi(_));
        let level_clocks = match config {
            BridgeConfig::Uart(config) => clock_hz / f64::from(config.baud()),
            BridgeConfig::Spi(_) => HALF_CLOCKS,
        };
        let words = config.address_limit();
        let harmless = offset(stage.map(), "interrupt_enable");
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        // A host begins with a read with the number 0.
        let mut frames: Vec<Vec<u8>> = Request::Read { address: 0, count: 4 }.encode(0).into_iter().collect();
        if with_opening {
            frames.extend(border_cases(words, harmless));
            frames.extend(all_registers(stage.map(), &mut rng));
        }
        let frames = frames.into_iter().map(|bytes| Frame { bytes, waiting: 0 });
        Self {
            rng,
            pins,
            stage_inputs: vec![0; count(Direction::Input)],
            stage_outputs: vec![0; count(Direction::Output)],
            read_data: outputs.position(|port: &Port| port.name == "avs_readdata").unwrap_or(0),
            offsets: offsets(stage.map()),
            next_read: 0,
            motion: axes.iter().map(|axis| motion(stage.map(), axis)).collect(),
            read_back: axes.iter().map(|axis| read_back(stage.map(), axis)).collect(),
            words,
            is_spi,
            level_clocks,
            line: VecDeque::new(),
            levels: if is_spi { IDLE_SPI } else { IDLE_UART },
            left: 0.0,
            patience: 0,
            reply: ReplyEnd::new(level_clocks),
            frames: frames.collect(),
            opens: with_opening,
            reset_clocks: 0,
            waiting: 0,
            sequence: 0,
        }
    }

    /// Clocks of a byte on the line.
    pub(crate) fn byte_clocks(config: &BridgeConfig, clock_hz: f64) -> f64 {
        match config {
            BridgeConfig::Uart(config) => f64::from(FRAME_BITS) * clock_hz / f64::from(config.baud()),
            BridgeConfig::Spi(_) => 16.0 * HALF_CLOCKS,
        }
    }

    /// The next frame: what the driver is to write, or else a read.
    fn frame(&mut self) -> Frame {
        if let Some(frame) = self.frames.pop_front() {
            return frame;
        }
        let most = *pick(&mut self.rng, &WRITTEN_WORDS);
        let (writes, waiting) = self.pins.due_writes(most);
        let (request, waiting) = if writes.is_empty() {
            (self.idle_request(), 0)
        } else {
            (self.written(writes), waiting)
        };
        self.sequence = self.sequence % u8::MAX + 1;
        let bytes = request.encode(self.sequence).unwrap_or_default();
        let frame = Frame { bytes, waiting };
        match self.rng.random_range(0..40) {
            // The bridge answers the same request with the same reply and does not execute it again. A damaged frame has no effect, and
            // is sent again.
            0..=2 => self.frames.push_back(frame.clone()),
            3 => {
                self.frames.push_back(frame.clone());
                let mut damaged = frame.bytes;
                damage(&mut self.rng, &mut damaged);
                return Frame {
                    bytes: damaged,
                    waiting,
                };
            }
            _ => {}
        }
        frame
    }

    /// A request with these writes, which are not none.
    fn written(&mut self, writes: Vec<(u32, u32)>) -> Request {
        let pairs: Vec<(u16, u32)> = writes.into_iter().map(|(offset, word)| (offset as u16, word)).collect();
        let follow = pairs.windows(2).all(|pair| pair[0].0 + 1 == pair[1].0);
        if follow && one_in(&mut self.rng, 2) {
            Request::Write {
                address: pairs[0].0,
                words: pairs.iter().map(|(_, word)| *word).collect(),
            }
        } else {
            Request::WriteList(pairs)
        }
    }

    /// A request while the driver waits.
    fn idle_request(&mut self) -> Request {
        let count = self.rng.random_range(1..=READ_WORDS);
        if self.pins.is_wild() && one_in(&mut self.rng, 2) {
            let any = |rng: &mut Xoshiro256PlusPlus| rng.next_u32() >> rng.random_range(0..32);
            let pairs = (0..count).map(|_| (self.any_address(), any(&mut self.rng)));
            return Request::WriteList(pairs.collect());
        }
        match self.rng.random_range(0..8) {
            0 => self.read_back(),
            1 => Request::ReadList((0..count).map(|_| self.any_address()).collect()),
            2 | 3 => Request::ReadList(pick(&mut self.rng, &self.motion).clone()),
            4 => {
                let address = self.next_offset();
                Request::Read { address, count }
            }
            _ => Request::ReadList((0..count).map(|_| self.next_offset()).collect()),
        }
    }

    fn next_offset(&mut self) -> u16 {
        self.next_read = (self.next_read + 1) % self.offsets.len().max(1);
        self.offsets.get(self.next_read).copied().unwrap_or(0)
    }

    /// Address of a register, or of any word; or the last address that exists, or the first that does not.
    fn any_address(&mut self) -> u16 {
        match self.rng.random_range(0..20) {
            0 => self.rng.random_range(0..self.words + 2),
            1 => self.words - 1,
            2 => self.words,
            _ => *pick(&mut self.rng, &self.offsets),
        }
    }

    /// Reads back a tap or a setting, unless the driver is writing such words; the read of the word follows.
    fn read_back(&mut self) -> Request {
        let axis = self.rng.random_range(0..self.read_back.len());
        let kind = self.rng.random_range(0..self.read_back[axis].len());
        let [address, command, word] = self.read_back[axis][kind];
        if self.pins.writes(axis) {
            return Request::Read {
                address: word,
                count: 1,
            };
        }
        let place = self.rng.next_u32() & 0x307;
        let read = Request::Read {
            address: word,
            count: 1,
        };
        let bytes = read.encode(0).unwrap_or_default();
        self.frames.push_back(Frame { bytes, waiting: 0 });
        Request::WriteList(vec![(address, place), (command, 0)])
    }

    fn send(&mut self) {
        if self.opens && self.frames.is_empty() {
            (self.opens, self.reset_clocks) = (false, OPENING_RESET_CLOCKS);
            let idle = if self.is_spi { IDLE_SPI } else { IDLE_UART };
            self.line.extend([idle; OPENING_RESET_CLOCKS as usize]);
            return;
        }
        let frame = self.frame();
        self.waiting = frame.waiting;
        match self.is_spi {
            false => frame.bytes.into_iter().for_each(|byte| self.serial_byte(byte)),
            true => {
                // A host takes the reply in a selection of its own, or in that of the request.
                self.line.push_back([false, false, false]);
                frame.bytes.into_iter().for_each(|byte| self.spi_byte(byte));
                if one_in(&mut self.rng, 2) {
                    self.line.extend([IDLE_SPI; 2]);
                }
            }
        }
        self.reply.begin();
        self.patience = (PATIENCE_CLOCKS / self.level_clocks) as u32 + FRAME_BITS;
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

    /// The level of the line that follows now.
    fn next_level(&mut self) -> Levels {
        let idle = if self.is_spi { IDLE_SPI } else { IDLE_UART };
        if let Some(level) = self.line.pop_front() {
            return level;
        }
        if self.reply.is_over() || self.patience == 0 {
            self.send();
            return idle;
        }
        if self.reply.is_silent() {
            self.patience -= 1;
        }
        if !self.is_spi {
            return idle;
        }
        self.spi_byte(0);
        self.line.pop_front().unwrap_or(idle)
    }

    fn levels(&mut self, to_host: bool) -> Levels {
        if !self.is_spi {
            self.reply.serial(to_host);
        }
        self.left -= 1.0;
        while self.left <= 0.0 {
            self.left += self.level_clocks;
            let before = self.levels;
            self.levels = self.next_level();
            if self.is_spi && self.levels[0] && !before[0] {
                self.reply.spi_bit(to_host);
            }
        }
        if self.reply.is_over() {
            self.waiting = 0;
        }
        self.levels
    }
}

fn offset(map: &RegisterMap, name: &str) -> u16 {
    let offset = map.register(name).map(|register| register.offset);
    offset.and_then(|offset| u16::try_from(offset).ok()).unwrap_or(0)
}

/// Offsets of all words, the bases of entries included.
fn offsets(map: &RegisterMap) -> Vec<u16> {
    let offsets = map.registers().iter().map(|register| register.offset);
    offsets.filter_map(|offset| u16::try_from(offset).ok()).collect()
}

/// Requests that write every register that takes a word, at random, then read every one.
fn all_registers(map: &RegisterMap, rng: &mut Xoshiro256PlusPlus) -> Vec<Vec<u8>> {
    let all = || map.registers().iter();
    let written =
        all().filter(|register| !matches!(register.access, Access::Constant | Access::Live | Access::Shadow { .. }));
    let pairs: Vec<(u16, u32)> = written
        .map(|register| (register.offset as u16, rng.next_u32()))
        .collect();
    let read: Vec<u16> = offsets(map);
    let writes = pairs
        .chunks(MOST_WORDS.into())
        .map(|pairs| Request::WriteList(pairs.to_vec()));
    let reads = read
        .chunks(MOST_WORDS.into())
        .map(|list| Request::ReadList(list.to_vec()));
    let numbered = (100..).zip(writes.chain(reads));
    numbered
        .filter_map(|(number, request)| request.encode(number).ok())
        .collect()
}

fn motion(map: &RegisterMap, axis: &str) -> Vec<u16> {
    let of_stage = [
        "status",
        "shaped_position",
        "shaped_velocity",
        "velocity",
        "error",
        "duty",
    ];
    let of_inline = ["status", "input_steps", "given_steps", "owed_steps"];
    let has_input = map.register(&format!("{axis}_input_steps")).is_some();
    let names: &[&str] = if has_input { &of_inline } else { &of_stage };
    names
        .iter()
        .map(|name| offset(map, &format!("{axis}_{name}")))
        .collect()
}

fn read_back(map: &RegisterMap, axis: &str) -> Vec<[u16; 3]> {
    let taps = ["tap_address", "tap_read", "tap_loaded"];
    let settings = ["setting_address", "setting_read", "setting_loaded"];
    let has_input = map.register(&format!("{axis}_input_steps")).is_some();
    let kinds: &[[&str; 3]] = if has_input { &[taps] } else { &[taps, settings] };
    let of = |names: &[&str; 3]| names.map(|name| offset(map, &format!("{axis}_{name}")));
    kinds.iter().map(of).collect()
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
        let levels = self.levels(*to_host != 0);
        self.pins
            .beside_a_line(&self.stage_outputs, &mut self.stage_inputs, self.waiting, LONGER_MOODS);
        pins.copy_from_slice(&self.stage_inputs[1 + BUS_INPUTS..]);
        *rst = self.stage_inputs[0] | u64::from(self.reset_clocks > 0);
        self.reset_clocks = self.reset_clocks.saturating_sub(1);
        lines
            .iter_mut()
            .zip(levels)
            .for_each(|(line, level)| *line = level.into());
    }
}
