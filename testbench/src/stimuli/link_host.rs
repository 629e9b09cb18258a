//! A host of the link, for any line: it sends valid and invalid requests of every kind, and frames with every kind of damage. This file
//! also lists the events that such a run must reach.

use std::collections::VecDeque;

use posicast_blocks::link::{Crc, MOST_WORDS, Request, cobs};
use posicast_blocks::uart_bridge::OUTPUT_PORTS;
use rand::{Rng, RngExt};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::table::pick;

/// Registers below this address exist in the beginning.
const LIMIT: u16 = 300;
/// Places of outputs, which all bridges have.
const ADDRESS: usize = 1;
const READ: usize = 2;
const WRITE: usize = 3;
pub(crate) const BUSY: usize = 5;
const DROPPED: usize = 6;

pub(crate) fn one_in(rng: &mut Xoshiro256PlusPlus, times: u32) -> bool {
    rng.random_range(0..times) == 0
}

/// A word with many zeros.
pub(crate) fn word(rng: &mut Xoshiro256PlusPlus) -> u32 {
    let any = rng.next_u32();
    *pick(rng, &[any, any, any & 0xff00_ff00, any & 0xff, any << 24, 0])
}

/// Makes the frames of a host.
#[derive(Debug, Clone)]
pub(crate) struct LinkHost {
    pub(crate) address_limit: u16,
    sequence: u8,
    last_frame: Vec<u8>,
    /// Frames to send before random ones.
    directed: VecDeque<Vec<u8>>,
}

impl LinkHost {
    /// A host of registers below [`LIMIT`].
    pub(crate) fn new() -> Self {
        Self {
            address_limit: LIMIT,
            sequence: 0,
            last_frame: Vec::new(),
            directed: border_cases(LIMIT, LIMIT / 2).into(),
        }
    }

    fn address(&self, rng: &mut Xoshiro256PlusPlus) -> u16 {
        let limit = self.address_limit;
        let any = rng.next_u32() as u16;
        let inside = any % limit.max(1);
        *pick(
            rng,
            &[inside, inside, inside, inside, inside, inside, 0, limit.wrapping_sub(1)],
        )
    }

    fn request(&self, rng: &mut Xoshiro256PlusPlus) -> Request {
        let any = rng.random_range(1..=MOST_WORDS);
        let count = match rng.random_range(0..24) {
            0 => any,
            1..=3 => MOST_WORDS,
            _ => 1 + any % 3,
        };
        let words: Vec<u32> = (0..count).map(|_| word(rng)).collect();
        let list: Vec<u16> = (0..count).map(|_| self.address(rng)).collect();
        let address = list[0].saturating_sub(u16::from(count) - u16::from(!one_in(rng, 8)));
        match rng.random_range(0..4) {
            0 => Request::Read { address, count },
            1 => Request::Write { address, words },
            2 => Request::ReadList(list),
            _ => Request::WriteList(list.into_iter().zip(words).collect()),
        }
    }

    /// A frame whose CRC holds, but which is no request.
    fn no_request(&self, rng: &mut Xoshiro256PlusPlus) -> Vec<u8> {
        let [any, other] = [rng.next_u32(), rng.next_u32()];
        let command = *pick(rng, &[0x10, 0x11, 0x12, 0x13, 0x14, 0x11 ^ (1 << (any % 8)) as u8]);
        let count = *pick(rng, &[0, 1, 2, 41, 64, other as u8]);
        let length = *pick(rng, &[9, 13, 8, 10, other as usize % 250]);
        let sequence = *pick(rng, &[self.sequence, 0, any as u8]);
        let write_without_sequence = (0, 0x11, 1, 13);
        let (sequence, command, count, length) = if one_in(rng, 4) {
            write_without_sequence
        } else {
            (sequence, command, count, length)
        };
        let mut bytes = vec![sequence, command, count];
        bytes.resize(length.saturating_sub(4), any as u8);
        bytes.extend(Crc::of(&bytes).to_le_bytes());
        let mut frame = cobs::encode(&bytes).unwrap_or_default();
        frame.push(0);
        frame
    }

    /// Whether directed requests are left. Until they are over, the line and the registers' side stay undisturbed.
    pub(crate) fn is_directed(&self) -> bool {
        !self.directed.is_empty()
    }

    pub(crate) fn frame(&mut self, rng: &mut Xoshiro256PlusPlus) -> Vec<u8> {
        if let Some(frame) = self.directed.pop_front() {
            return frame;
        }
        if one_in(rng, 6) && !self.last_frame.is_empty() {
            return self.last_frame.clone();
        }
        if one_in(rng, 8) {
            return self.no_request(rng);
        }
        // Counting from 0 alone would seldom reach the upper bits, because the count restarts too often.
        self.sequence = match rng.random_range(0..20) {
            0 => 0,
            1 | 2 => rng.random(),
            _ => self.sequence % 255 + 1,
        };
        let request = self.request(rng);
        let sequence = if request.is_write() {
            self.sequence.max(1)
        } else {
            self.sequence
        };
        self.last_frame = request.encode(sequence).unwrap_or_default();
        self.last_frame.clone()
    }
}

/// Damages a frame, or puts something before it.
pub(crate) fn damage(rng: &mut Xoshiro256PlusPlus, frame: &mut Vec<u8>) {
    let place = rng.random_range(0..frame.len());
    match rng.random_range(0..8) {
        0 => {
            frame.remove(place);
        }
        1 => frame.insert(place, frame[place]),
        2 => frame[place] ^= 1 << rng.random_range(0..8),
        3 => frame.insert(place, 0),
        4 => frame.insert(place, 0xff),
        5 => frame.insert(0, 0),
        6 => frame.truncate(place),
        _ => {
            // A frame that is too long.
            let byte = 1 + rng.random_range(0..254_u8);
            let length = rng.random_range(245..260);
            frame.splice(0..0, vec![byte; length]);
        }
    }
}

/// Each conversation begins with these requests, at the limits of what a bridge accepts: sequence numbers that differ only in their
/// upper bits, a request with the number 0 sent twice, addresses at and beside `limit`. Words are written only to `address` and to the
/// last address.
pub(crate) fn border_cases(limit: u16, address: u16) -> Vec<Vec<u8>> {
    let last = limit.wrapping_sub(1);
    let read = |address, count| Request::Read { address, count };
    let write = |word| Request::Write {
        address,
        words: vec![word],
    };
    let cases = [
        (0, read(address, 1)),
        (0, read(address, 1)),
        (0x15, write(0x1234)),
        // Bits 6 and 7 alone differ, then bit 7, then bit 6, then each lower one.
        (0xd5, write(0x2345)),
        (0x55, write(0x3456)),
        (0x15, write(0x4567)),
        (0x35, write(0x5678)),
        (0x25, write(0x6789)),
        (0x2d, write(0x789a)),
        (0x29, write(0x89ab)),
        (0x2b, write(0x9abc)),
        (0x2a, write(0xabcd)),
        (0x2a, write(0xabcd)),
        (0, read(address, 1)),
        (1, read(last, 1)),
        (2, read(limit, 1)),
        (3, read(last, 2)),
        (4, Request::ReadList(vec![address, limit])),
        (5, Request::WriteList(vec![(address, 1), (limit, 2)])),
        (
            6,
            Request::Write {
                address: limit,
                words: vec![3],
            },
        ),
        (7, Request::WriteList(vec![(last, 4), (address, 5)])),
    ];
    let frames = cases.iter().map(|(sequence, request)| request.encode(*sequence));
    frames.filter_map(Result::ok).collect()
}

/// Detects the end of a reply: the byte 0 after other bytes.
#[derive(Debug, Clone)]
pub(crate) struct ReplyEnd {
    bit_clocks: f64,
    /// Clocks until the next look at a serial line; `None` between bytes.
    look: Option<f64>,
    byte: u32,
    bits: u32,
    began: bool,
    over: bool,
}

impl ReplyEnd {
    /// Creates the detector; `bit_clocks` is the number of clocks per bit of a serial line.
    pub(crate) fn new(bit_clocks: f64) -> Self {
        Self {
            bit_clocks,
            look: None,
            byte: 0,
            bits: 0,
            began: false,
            over: true,
        }
    }

    /// Starts to wait for the reply to a request that is being sent.
    pub(crate) fn begin(&mut self) {
        let bit_clocks = self.bit_clocks;
        *self = Self {
            over: false,
            ..Self::new(bit_clocks)
        };
    }

    /// Whether the reply is complete.
    pub(crate) fn is_over(&self) -> bool {
        self.over
    }

    /// Whether no byte of a reply is arriving or has arrived.
    pub(crate) fn is_silent(&self) -> bool {
        self.look.is_none() && !self.began
    }

    /// Takes the level of the serial line to the host, once per clock.
    pub(crate) fn serial(&mut self, level: bool) {
        let Some(look) = &mut self.look else {
            if !level {
                (self.look, self.byte, self.bits) = (Some(1.5 * self.bit_clocks), 0, 0);
            }
            return;
        };
        *look -= 1.0;
        if *look > 0.0 {
            return;
        }
        *look += self.bit_clocks;
        if self.bits == 8 {
            self.look = None;
            self.byte();
            return;
        }
        self.byte |= u32::from(level) << self.bits;
        self.bits += 1;
    }

    /// Takes the level of MISO at a rising edge of the SPI clock.
    pub(crate) fn spi_bit(&mut self, level: bool) {
        self.byte = self.byte << 1 | u32::from(level);
        self.bits += 1;
        if self.bits == 8 {
            self.byte();
            (self.byte, self.bits) = (0, 0);
        }
    }

    fn byte(&mut self) {
        match self.byte & 0xff {
            0 => self.over |= self.began,
            _ => self.began = true,
        }
    }
}

/// Inputs of a bridge in a clock: the line, and the registers' side.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HeardClock {
    pub(crate) rst: u64,
    /// Whether the host is sending.
    pub(crate) speaks: bool,
    pub(crate) address_limit: u64,
    pub(crate) waits: bool,
}

/// Counts of the events in a lockstep run of a bridge.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct BridgeCoverage {
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

impl BridgeCoverage {
    /// Adds a clock.
    pub(crate) fn observe(&mut self, heard: HeardClock, outputs: &[u64; OUTPUT_PORTS]) {
        let HeardClock { rst, waits, .. } = heard;
        let [reads, writes, busy] = [READ, WRITE, BUSY].map(|output| outputs[output] != 0);
        self.resets += rst;
        self.resets_while_busy += rst & outputs[BUSY];
        self.dropped += outputs[DROPPED];
        self.spoken_while_busy += u64::from(busy && heard.speaks);
        let accesses = (reads || writes) && !waits;
        self.waited += u64::from((reads || writes) && waits);
        self.read += u64::from(reads && accesses);
        self.written += u64::from(writes && accesses);
        self.at_the_last_address += u64::from(accesses && outputs[ADDRESS] + 1 == heard.address_limit);
        if busy && !self.was_busy {
            (self.requests, self.words) = (self.requests + 1, 0);
        }
        self.words += u64::from(accesses);
        if !busy && self.was_busy {
            self.without_access += u64::from(self.words == 0);
            self.of_most_words += u64::from(self.words == u64::from(MOST_WORDS));
        }
        self.was_busy = busy && rst == 0;
    }

    /// Returns each event's name and count.
    pub(crate) fn counts(&self) -> [(&'static str, u64); 11] {
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
