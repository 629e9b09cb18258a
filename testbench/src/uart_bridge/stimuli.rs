//! A host at the end of the bridge's serial line: requests of every kind, right and wrong, frames that are damaged in every way,
//! pauses, other baud rates, and registers that wait.

use std::collections::VecDeque;

use posicast_blocks::uart_bridge::{INPUT_PORTS, OUTPUT_PORTS};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::lockstep::Clock;
use crate::stimuli::Stimuli;
use crate::stimuli::link_host::{BUSY, BridgeCoverage, HeardClock, LinkHost, damage, one_in, word};
use crate::stimuli::table::pick;

/// An eighth of a bit, in units of `baud_step` times clocks.
const EIGHTH: i64 = 1 << 16;

/// An endless random mixture of a host's requests.
#[derive(Debug, Clone)]
pub struct UartBridgeRandom {
    rng: Xoshiro256PlusPlus,
    clock: u64,
    baud_step: u64,
    silence_limit: u64,
    host: LinkHost,
    /// Levels of the line, with their durations in eighths of a bit.
    line: VecDeque<(bool, u32)>,
    level: bool,
    /// Time until the level changes.
    left: i64,
    /// Clocks until the host goes on although the bridge is silent.
    patience: u32,
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
            host: LinkHost::new(),
            line: VecDeque::new(),
            level: true,
            left: 0,
            patience: 0,
            waits: 8,
        }
    }

    /// Puts the next frame on the line.
    fn send(&mut self) {
        let directed = self.host.is_directed();
        if !directed && one_in(&mut self.rng, 8) {
            self.baud_step = *pick(
                &mut self.rng,
                &[0xffff, 0xffff, 0xffff, 0xffff, 0xf000, 0xc001, 0x7000, 16_000],
            );
            self.silence_limit = *pick(&mut self.rng, &[160, 400, 0xf_ffff, 300]);
            self.host.address_limit = *pick(&mut self.rng, &[300, 300, 512, 1, 0, 0xffff, 0x8000]);
            self.waits = *pick(&mut self.rng, &[1, 2, 8, 100]);
        }
        let mut frame = self.host.frame(&mut self.rng);
        if !directed && one_in(&mut self.rng, 6) {
            damage(&mut self.rng, &mut frame);
        }
        let cut = self.rng.random_range(0..=frame.len());
        let faults = if directed { 39..40 } else { 0..40 };
        let fault = self.rng.random_range(faults);
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
        self.patience = if !directed && one_in(&mut self.rng, 12) { 0 } else { 60 };
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
        let resets = !self.host.is_directed() && one_in(&mut self.rng, clocks_between_resets);
        *rst = u64::from(self.clock < 2 || resets);
        *uart_rx = u64::from(self.level(busy));
        *baud_step = self.baud_step;
        *silence_limit = self.silence_limit;
        *address_limit = u64::from(self.host.address_limit);
        *readdata = u64::from(word(&mut self.rng));
        *waitrequest = u64::from(self.rng.random_range(0..self.waits) != 0 && self.waits < 100);
        self.clock += 1;
    }
}

/// Counts of the events in a lockstep run of the bridge.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct UartBridgeCoverage(BridgeCoverage);

impl UartBridgeCoverage {
    /// Adds a clock.
    pub fn observe(&mut self, clock: &Clock<'_>) {
        let (Ok([rst, uart_rx, _, _, address_limit, _, waits]), Ok(outputs)) = (
            <&[u64; INPUT_PORTS]>::try_from(clock.inputs),
            <&[u64; OUTPUT_PORTS]>::try_from(clock.expected),
        ) else {
            return;
        };
        let heard = HeardClock {
            rst: *rst,
            speaks: *uart_rx == 0,
            address_limit: *address_limit,
            waits: *waits != 0,
        };
        self.0.observe(heard, outputs);
    }

    /// Returns each event's name and count.
    pub fn counts(&self) -> [(&'static str, u64); 11] {
        self.0.counts()
    }
}
