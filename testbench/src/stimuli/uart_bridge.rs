//! A host at the end of the bridge's serial line: requests of every kind, right and wrong, frames that are damaged in every way,
//! pauses, other baud rates, and registers that wait.

use std::collections::VecDeque;

use posicast_model::link::{Crc, MOST_WORDS, Request, cobs};
use posicast_model::rtl::uart_bridge::{INPUT_PORTS, OUTPUT_PORTS};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::Stimuli;
use super::table::pick;
use crate::lockstep::Clock;

/// Places of outputs.
const READ: usize = 2;
const WRITE: usize = 3;
const BUSY: usize = 5;
const DROPPED: usize = 6;
/// An eighth of a bit, in units of `baud_step` times clocks.
const EIGHTH: i64 = 1 << 16;

/// An endless random mixture of a host's requests.
#[derive(Debug, Clone)]
pub struct UartBridgeRandom {
    rng: Xoshiro256PlusPlus,
    clock: u64,
    baud_step: u64,
    silence_limit: u64,
    address_limit: u16,
    /// Levels of the line, with their durations in eighths of a bit.
    line: VecDeque<(bool, u32)>,
    level: bool,
    /// Time until the level changes.
    left: i64,
    /// Clocks until the host goes on although the bridge is silent.
    patience: u32,
    sequence: u8,
    last_frame: Vec<u8>,
    waits: u32,
}

impl UartBridgeRandom {
    /// Creates the host. Equal seeds give equal inputs.
    pub fn new(seed: u64) -> Self {
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            clock: 0,
            baud_step: 0xffff,
            silence_limit: 400,
            address_limit: 300,
            line: VecDeque::new(),
            level: true,
            left: 0,
            patience: 0,
            sequence: 0,
            last_frame: Vec::new(),
            waits: 8,
        }
    }

    fn one_in(&mut self, times: u32) -> bool {
        self.rng.random_range(0..times) == 0
    }

    fn address(&mut self) -> u16 {
        let limit = self.address_limit;
        let any = self.rng.next_u32() as u16;
        let inside = any % limit.max(1);
        *pick(
            &mut self.rng,
            &[inside, inside, inside, inside, inside, inside, 0, limit.wrapping_sub(1)],
        )
    }

    fn word(&mut self) -> u32 {
        let any = self.rng.next_u32();
        *pick(&mut self.rng, &[any, any, any & 0xff00_ff00, any & 0xff, any << 24, 0])
    }

    fn request(&mut self) -> Request {
        let any = self.rng.random_range(1..=MOST_WORDS);
        let count = match self.rng.random_range(0..24) {
            0 => any,
            1..=3 => MOST_WORDS,
            _ => 1 + any % 3,
        };
        let words: Vec<u32> = (0..count).map(|_| self.word()).collect();
        let list: Vec<u16> = (0..count).map(|_| self.address()).collect();
        let address = list[0].saturating_sub(u16::from(count) - u16::from(!self.one_in(8)));
        match self.rng.random_range(0..4) {
            0 => Request::Read { address, count },
            1 => Request::Write { address, words },
            2 => Request::ReadList(list),
            _ => Request::WriteList(list.into_iter().zip(words).collect()),
        }
    }

    /// A frame whose CRC holds, but which is no request.
    fn no_request(&mut self) -> Vec<u8> {
        let [any, other] = [self.rng.next_u32(), self.rng.next_u32()];
        let command = *pick(
            &mut self.rng,
            &[0x10, 0x11, 0x12, 0x13, 0x14, 0x11 ^ (1 << (any % 8)) as u8],
        );
        let count = *pick(&mut self.rng, &[0, 1, 2, 41, 64, other as u8]);
        let length = *pick(&mut self.rng, &[9, 13, 8, 10, other as usize % 250]);
        let sequence = *pick(&mut self.rng, &[self.sequence, 0, any as u8]);
        let write_without_sequence = (0, 0x11, 1, 13);
        let (sequence, command, count, length) = match self.one_in(4) {
            true => write_without_sequence,
            false => (sequence, command, count, length),
        };
        let mut bytes = vec![sequence, command, count];
        bytes.resize(length.saturating_sub(4), any as u8);
        bytes.extend(Crc::of(&bytes).to_le_bytes());
        let mut frame = cobs::encode(&bytes).unwrap_or_default();
        frame.push(0);
        frame
    }

    fn frame(&mut self) -> Vec<u8> {
        if self.one_in(6) && !self.last_frame.is_empty() {
            return self.last_frame.clone();
        }
        if self.one_in(8) {
            return self.no_request();
        }
        // A count from 0 alone would seldom come to the upper bits: it begins anew too often.
        self.sequence = match self.rng.random_range(0..20) {
            0 => 0,
            1 | 2 => self.rng.random(),
            _ => self.sequence % 255 + 1,
        };
        let request = self.request();
        let sequence = if request.is_write() {
            self.sequence.max(1)
        } else {
            self.sequence
        };
        self.last_frame = request.encode(sequence).unwrap_or_default();
        self.last_frame.clone()
    }

    /// Damages a frame, or puts something before it.
    fn damage(&mut self, frame: &mut Vec<u8>) {
        let place = self.rng.random_range(0..frame.len());
        match self.rng.random_range(0..8) {
            0 => {
                frame.remove(place);
            }
            1 => frame.insert(place, frame[place]),
            2 => frame[place] ^= 1 << self.rng.random_range(0..8),
            3 => frame.insert(place, 0),
            4 => frame.insert(place, 0xff),
            5 => frame.insert(0, 0),
            6 => frame.truncate(place),
            _ => {
                // A frame that is too long.
                let byte = 1 + self.rng.random_range(0..254_u8);
                let length = self.rng.random_range(245..260);
                frame.splice(0..0, vec![byte; length]);
            }
        }
    }

    /// Puts the next frame on the line.
    fn send(&mut self) {
        if self.one_in(8) {
            self.baud_step = *pick(
                &mut self.rng,
                &[0xffff, 0xffff, 0xffff, 0xffff, 0xf000, 0xc001, 0x7000, 16_000],
            );
            self.silence_limit = *pick(&mut self.rng, &[160, 400, 0xf_ffff, 300]);
            self.address_limit = *pick(&mut self.rng, &[300, 300, 512, 1, 0, 0xffff, 0x8000]);
            self.waits = *pick(&mut self.rng, &[1, 2, 8, 100]);
        }
        let mut frame = self.frame();
        if self.one_in(6) {
            self.damage(&mut frame);
        }
        let cut = self.rng.random_range(0..=frame.len());
        let fault = self.rng.random_range(0..40);
        for (place, byte) in frame.into_iter().enumerate() {
            if place == cut {
                match fault {
                    // A pause, a break, a glitch.
                    0 | 7..=9 => self.line.push_back((true, self.silence_limit.min(2000) as u32 + 60)),
                    1 => self.line.push_back((true, self.silence_limit.min(2000) as u32 - 100)),
                    2 => self.line.extend([(false, 100), (true, 30)]),
                    3 => self.line.extend([(false, 1), (true, 40)]),
                    4 => self.line.extend([(false, 3), (true, 40)]),
                    _ => {}
                }
            }
            self.line.push_back((false, 8));
            self.line.extend((0..8).map(|bit| (byte >> bit & 1 != 0, 8)));
            self.line.push_back((!(place == cut && fault == 5), 8));
            if fault == 6 || (place == cut && fault == 5) {
                self.line.push_back((true, self.rng.random_range(1..12)));
            }
        }
        self.patience = if self.one_in(12) { 0 } else { 60 };
    }

    /// The level of the line in the next clock.
    fn level(&mut self, busy: bool) -> bool {
        // The host's clock is not that of the bridge.
        let drift = self.rng.random_range(-3..=3);
        self.left -= self.baud_step as i64 * (100 + drift) / 100;
        while self.left <= 0 {
            match self.line.pop_front() {
                Some((level, eighths)) => {
                    self.level = level;
                    self.left += i64::from(eighths) * EIGHTH;
                }
                None => {
                    (self.level, self.left) = (true, 0);
                    self.patience -= u32::from(!busy && self.patience > 0);
                    if self.patience == 0 {
                        self.send();
                    }
                    break;
                }
            }
        }
        self.level
    }
}

impl Stimuli for UartBridgeRandom {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        let [
            rst,
            uart_rx,
            baud_step,
            silence_limit,
            address_limit,
            readdata,
            waitrequest,
        ] = inputs
        else {
            return;
        };
        let busy = seen.get(BUSY).is_some_and(|busy| *busy != 0);
        // Most of the time the host speaks, and a reset then meets no request.
        let clocks_between_resets = if busy { 8_000 } else { 40_000 };
        *rst = u64::from(self.clock < 2 || self.one_in(clocks_between_resets));
        *uart_rx = u64::from(self.level(busy));
        *baud_step = self.baud_step;
        *silence_limit = self.silence_limit;
        *address_limit = u64::from(self.address_limit);
        *readdata = u64::from(self.word());
        *waitrequest = u64::from(self.rng.random_range(0..self.waits) != 0 && self.waits < 100);
        self.clock += 1;
    }
}

/// Counts of the events in a lockstep run of the bridge.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct UartBridgeCoverage {
    was_busy: bool,
    /// Words accessed by the request.
    words: u64,
    resets: u64,
    resets_while_busy: u64,
    requests: u64,
    without_access: u64,
    read: u64,
    written: u64,
    waited: u64,
    of_most_words: u64,
    at_the_last_address: u64,
    dropped: u64,
    spoken_while_busy: u64,
}

impl UartBridgeCoverage {
    /// Adds a clock.
    pub fn observe(&mut self, clock: &Clock<'_>) {
        let (Ok([rst, uart_rx, _, _, limit, _, waits]), Ok(outputs)) = (
            <&[u64; INPUT_PORTS]>::try_from(clock.inputs),
            <&[u64; OUTPUT_PORTS]>::try_from(clock.expected),
        ) else {
            return;
        };
        let [reads, writes, busy] = [READ, WRITE, BUSY].map(|output| outputs[output] != 0);
        self.resets += rst;
        self.resets_while_busy += rst & outputs[BUSY];
        self.dropped += outputs[DROPPED];
        self.spoken_while_busy += u64::from(busy && *uart_rx == 0);
        let accesses = (reads || writes) && *waits == 0;
        self.waited += u64::from((reads || writes) && *waits != 0);
        self.read += u64::from(reads && accesses);
        self.written += u64::from(writes && accesses);
        self.at_the_last_address += u64::from(accesses && outputs[1] + 1 == *limit);
        if busy && !self.was_busy {
            (self.requests, self.words) = (self.requests + 1, 0);
        }
        self.words += u64::from(accesses);
        if !busy && self.was_busy {
            self.without_access += u64::from(self.words == 0);
            self.of_most_words += u64::from(self.words == u64::from(MOST_WORDS));
        }
        self.was_busy = busy && *rst == 0;
    }

    /// Returns each event's name and count.
    pub fn counts(&self) -> [(&'static str, u64); 11] {
        [
            ("resets", self.resets),
            ("resets while busy", self.resets_while_busy),
            ("requests", self.requests),
            ("requests that are refused or repeated", self.without_access),
            ("words read", self.read),
            ("words written", self.written),
            ("clocks that the registers wait", self.waited),
            ("requests of 40 words", self.of_most_words),
            ("accesses to the last address", self.at_the_last_address),
            ("frames dropped", self.dropped),
            (
                "clocks in which the host speaks to a busy bridge",
                self.spoken_while_busy,
            ),
        ]
    }
}
