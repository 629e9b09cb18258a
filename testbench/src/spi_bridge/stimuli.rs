//! A host at the SPI lines of the bridge: requests of every kind, right and wrong, frames that are damaged in every way, selections that
//! end within a byte, other speeds, glitches, and registers that wait.

use std::collections::VecDeque;

use posicast_blocks::spi_bridge::{INPUT_PORTS, OUTPUT_PORTS};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::lockstep::Clock;
use crate::stimuli::Stimuli;
use crate::stimuli::link_host::{BUSY, BridgeCoverage, HeardClock, LinkHost, damage, one_in, word};
use crate::stimuli::table::pick;

/// Place of an output.
const MISO: usize = 0;
/// Most bytes 00 that the host sends to get a reply.
const MOST_READ: u32 = 200;

/// Levels of the lines for some clocks.
#[derive(Debug, Clone, Copy)]
struct Lines {
    cs_n: bool,
    sck: bool,
    mosi: bool,
    clocks: u32,
}

/// An endless random mixture of a host's requests.
#[derive(Debug, Clone)]
pub struct SpiBridgeRandom {
    rng: Xoshiro256PlusPlus,
    host: LinkHost,
    clock: u64,
    silence_limit: u64,
    /// Clocks of half a bit.
    half: u32,
    lines: VecDeque<Lines>,
    now: Lines,
    /// Bytes 00 that are still to be sent.
    reads: u32,
    waits: u32,
}

impl SpiBridgeRandom {
    /// Creates the host. Equal seeds give equal inputs.
    pub fn new(seed: u64) -> Self {
        Self {
            rng: Xoshiro256PlusPlus::seed_from_u64(seed),
            host: LinkHost::new(),
            clock: 0,
            silence_limit: 20,
            half: 4,
            lines: VecDeque::new(),
            now: Lines {
                cs_n: true,
                sck: false,
                mosi: false,
                clocks: 0,
            },
            reads: 0,
            waits: 8,
        }
    }

    fn push(&mut self, cs_n: bool, sck: bool, mosi: bool, clocks: u32) {
        self.lines.push_back(Lines {
            cs_n,
            sck,
            mosi,
            clocks,
        });
    }

    /// Deselects for a while, and selects again.
    fn deselect(&mut self, clocks: u32) {
        let half = self.half;
        self.push(true, false, false, clocks);
        self.push(false, false, false, half);
    }

    /// Sends the upper bits of a byte.
    fn bits(&mut self, byte: u8, count: u32) {
        for bit in 0..count {
            let mosi = byte >> (7 - bit) & 1 != 0;
            let half = self.half;
            self.push(false, false, mosi, half);
            self.push(false, true, mosi, half);
        }
    }

    fn byte(&mut self, byte: u8) {
        let faults = if self.host.is_directed() { 1599..1600 } else { 0..1600 };
        match self.rng.random_range(faults) {
            // The selection ends within the byte, or between two.
            0 => {
                let count = self.rng.random_range(1..8);
                self.bits(byte, count);
                self.deselect(10);
            }
            1..=40 => {
                self.bits(byte, 8);
                self.deselect(6);
            }
            // A pause.
            41 => {
                let pause = 64 * (self.silence_limit.min(40) as u32 + 2);
                self.bits(byte, 8);
                self.push(false, false, false, pause);
            }
            // A glitch of the clock.
            42 => {
                self.bits(byte, 3);
                self.push(false, false, false, 4);
                self.push(false, true, false, 1);
                self.bits(byte, 5);
            }
            // A selection together with an edge of the clock, which does not count.
            43 => {
                let half = self.half;
                self.push(true, false, false, 6);
                self.push(false, true, true, half);
                self.bits(byte, 8);
            }
            _ => self.bits(byte, 8),
        }
    }

    fn send(&mut self) {
        let directed = self.host.is_directed();
        if !directed && one_in(&mut self.rng, 8) {
            self.half = *pick(&mut self.rng, &[4, 4, 4, 4, 3, 3, 2, 5, 12]);
            self.silence_limit = *pick(&mut self.rng, &[40, 20, 0xf_ffff, 30]);
            self.host.address_limit = *pick(&mut self.rng, &[300, 300, 512, 1, 0, 0xffff, 0x8000]);
            self.waits = *pick(&mut self.rng, &[1, 2, 8, 100]);
        }
        let mut frame = self.host.frame(&mut self.rng);
        if !directed && one_in(&mut self.rng, 6) {
            damage(&mut self.rng, &mut frame);
        }
        for byte in frame {
            self.byte(byte);
        }
        self.reads = if !directed && one_in(&mut self.rng, 12) {
            self.rng.random_range(0..20)
        } else {
            MOST_READ
        };
    }

    fn next(&mut self, busy: bool) {
        if self.now.clocks > 0 {
            self.now.clocks -= 1;
            return;
        }
        if self.lines.is_empty() {
            // As long as the bridge is busy, and for a byte or two after it.
            if self.reads > 0 {
                self.reads = if busy { self.reads - 1 } else { self.reads.min(3) - 1 };
                let speaks = !self.host.is_directed() && one_in(&mut self.rng, 200);
                let byte = if speaks { self.rng.random() } else { 0 };
                self.byte(byte);
            } else {
                // Now and then, the selection stays.
                if !one_in(&mut self.rng, 6) {
                    self.deselect(9);
                }
                self.send();
            }
        }
        if let Some(lines) = self.lines.pop_front() {
            self.now = lines;
            self.now.clocks = self.now.clocks.saturating_sub(1);
        }
    }
}

impl Stimuli for SpiBridgeRandom {
    fn fill(&mut self, seen: &[u64], inputs: &mut [u64]) {
        let [
            rst,
            sck,
            cs_n,
            mosi,
            silence_limit,
            address_limit,
            readdata,
            waitrequest,
        ] = inputs
        else {
            return;
        };
        let busy = seen.get(BUSY).is_some_and(|busy| *busy != 0);
        let resets = if busy { 12_000 } else { 40_000 };
        let resets = !self.host.is_directed() && one_in(&mut self.rng, resets);
        *rst = u64::from(self.clock < 2 || resets);
        self.next(busy);
        [*sck, *cs_n, *mosi] = [self.now.sck, self.now.cs_n, self.now.mosi].map(u64::from);
        *silence_limit = self.silence_limit;
        *address_limit = u64::from(self.host.address_limit);
        *readdata = u64::from(word(&mut self.rng));
        *waitrequest = u64::from(self.rng.random_range(0..self.waits) != 0 && self.waits < 100);
        self.clock += 1;
    }
}

/// Counts of the events in a lockstep run of the bridge.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SpiBridgeCoverage {
    frames: BridgeCoverage,
    /// `spi_sck` of the clock before, and rising edges in this selection.
    was_high: bool,
    edges: u64,
    cut: u64,
    between: u64,
    answered: u64,
}

impl SpiBridgeCoverage {
    /// Adds a clock.
    pub fn observe(&mut self, clock: &Clock<'_>) {
        let (Ok([rst, sck, cs_n, mosi, _, address_limit, _, waits]), Ok(outputs)) = (
            <&[u64; INPUT_PORTS]>::try_from(clock.inputs),
            <&[u64; OUTPUT_PORTS]>::try_from(clock.expected),
        ) else {
            return;
        };
        let [high, selected] = [*sck != 0, *cs_n == 0];
        let heard = HeardClock {
            rst: *rst,
            speaks: selected && *mosi != 0,
            address_limit: *address_limit,
            waits: *waits != 0,
        };
        self.frames.observe(heard, outputs);
        if selected {
            self.edges += u64::from(high && !self.was_high);
            self.answered += u64::from(high && !self.was_high && outputs[MISO] != 0);
        } else if self.edges > 0 {
            let whole = self.edges.is_multiple_of(8);
            self.cut += u64::from(!whole);
            self.between += u64::from(whole && outputs[BUSY] != 0);
            self.edges = 0;
        }
        self.was_high = high;
    }

    /// Returns each event's name and count.
    pub fn counts(&self) -> Vec<(&'static str, u64)> {
        let mut counts = self.frames.counts().to_vec();
        counts.extend([
            ("selections that end within a byte", self.cut),
            ("selections that end between bytes of a busy bridge", self.between),
            ("bits of 1 for the host", self.answered),
        ]);
        counts
    }
}
