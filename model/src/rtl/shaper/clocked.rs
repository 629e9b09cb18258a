//! The shaper at its ports, clock by clock.

use super::banks::Banks;
use super::config::{ShaperConfig, pass_clocks};
use super::memory::Arbitrary;
use super::{round_and_saturate, wrap};
use crate::rtl::{ClockedBlock, Direction, Port, StepError};
use crate::taps::COEFFICIENT_BITS;

/// The input ports. Bits above a port's width are ignored.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Inputs {
    /// Synchronous reset.
    pub rst: bool,
    /// One clock: `x` is a new sample.
    pub strobe: bool,
    /// One clock: begin anew, all samples before now count as `x`.
    pub start: bool,
    /// Command word, W bits.
    pub x: i64,
    /// Clears `saturated`, `overrun`, `refused`.
    pub clear_flags: bool,
    /// One clock: a tap for a loadable bank.
    pub tap_write: bool,
    /// The bank it is for, 1 or 2.
    pub tap_bank: u8,
    /// Its index, T bits: 0 begins a table, then one after the other.
    pub tap_index: u16,
    /// Its coefficient, 18 bits.
    pub tap_coefficient: i32,
    /// Its delay in samples, A bits, not all ones.
    pub tap_delay: u16,
    /// One clock: make `swap_bank` active at the next strobe.
    pub swap: bool,
    /// The bank to make active, 0..=2.
    pub swap_bank: u8,
}

/// The output ports, all of them registers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Outputs {
    /// Shaped command, W bits; holds between samples.
    pub y: i64,
    /// One clock: `y` is new.
    pub valid: bool,
    /// Sticky: some `y` was clamped.
    pub saturated: bool,
    /// A pass runs.
    pub busy: bool,
    /// Sticky: a strobe came while a pass ran.
    pub overrun: bool,
    /// A swap waits for the next strobe.
    pub swap_pending: bool,
    /// The active bank.
    pub bank: u8,
    /// Sticky: a write or a swap was refused.
    pub refused: bool,
}

/// The ports of a shaper in the order of the Verilog's port list, without `clk`.
pub fn ports(config: &ShaperConfig) -> Vec<Port> {
    use Direction::{Input, Output};
    let port = |name: &str, direction, width, signed| Port {
        name: name.to_owned(),
        direction,
        width,
        signed,
    };
    let word = config.word_bits();
    vec![
        port("rst", Input, 1, false),
        port("strobe", Input, 1, false),
        port("start", Input, 1, false),
        port("x", Input, word, true),
        port("clear_flags", Input, 1, false),
        port("tap_write", Input, 1, false),
        port("tap_bank", Input, 2, false),
        port("tap_index", Input, config.tap_index_bits(), false),
        port("tap_coefficient", Input, COEFFICIENT_BITS, true),
        port("tap_delay", Input, config.ring_address_bits(), false),
        port("swap", Input, 1, false),
        port("swap_bank", Input, 2, false),
        port("y", Output, word, true),
        port("valid", Output, 1, false),
        port("saturated", Output, 1, false),
        port("busy", Output, 1, false),
        port("overrun", Output, 1, false),
        port("swap_pending", Output, 1, false),
        port("bank", Output, 2, false),
        port("refused", Output, 1, false),
    ]
}

impl Inputs {
    /// From raw bit patterns, one per input port in port order.
    pub fn from_raw(raw: &[u64; 12]) -> Self {
        let [
            rst,
            strobe,
            start,
            x,
            clear_flags,
            tap_write,
            tap_bank,
            tap_index,
            tap_coefficient,
            tap_delay,
            swap,
            swap_bank,
        ] = *raw;
        Self {
            rst: rst & 1 != 0,
            strobe: strobe & 1 != 0,
            start: start & 1 != 0,
            x: x as i64,
            clear_flags: clear_flags & 1 != 0,
            tap_write: tap_write & 1 != 0,
            tap_bank: tap_bank as u8,
            tap_index: tap_index as u16,
            tap_coefficient: tap_coefficient as i32,
            tap_delay: tap_delay as u16,
            swap: swap & 1 != 0,
            swap_bank: swap_bank as u8,
        }
    }

    /// As raw bit patterns, one per input port in port order, each cut to its port's width.
    pub fn to_raw(&self, config: &ShaperConfig) -> [u64; 12] {
        let cut = |value: i64, bits: u32| value as u64 & ((1 << bits) - 1);
        [
            u64::from(self.rst),
            u64::from(self.strobe),
            u64::from(self.start),
            cut(self.x, config.word_bits()),
            u64::from(self.clear_flags),
            u64::from(self.tap_write),
            cut(i64::from(self.tap_bank), 2),
            cut(i64::from(self.tap_index), config.tap_index_bits()),
            cut(i64::from(self.tap_coefficient), COEFFICIENT_BITS),
            cut(i64::from(self.tap_delay), config.ring_address_bits()),
            u64::from(self.swap),
            cut(i64::from(self.swap_bank), 2),
        ]
    }
}

impl Outputs {
    /// From raw bit patterns, one per output port in port order.
    pub fn from_raw(raw: &[u64; 8], config: &ShaperConfig) -> Self {
        Self {
            y: wrap(raw[0] as i64, config.word_bits()),
            valid: raw[1] & 1 != 0,
            saturated: raw[2] & 1 != 0,
            busy: raw[3] & 1 != 0,
            overrun: raw[4] & 1 != 0,
            swap_pending: raw[5] & 1 != 0,
            bank: raw[6] as u8 & 3,
            refused: raw[7] & 1 != 0,
        }
    }

    /// As raw bit patterns, one per output port in port order.
    pub fn to_raw(&self, config: &ShaperConfig) -> [u64; 8] {
        [
            self.y as u64 & ((1 << config.word_bits()) - 1),
            u64::from(self.valid),
            u64::from(self.saturated),
            u64::from(self.busy),
            u64::from(self.overrun),
            u64::from(self.swap_pending),
            u64::from(self.bank),
            u64::from(self.refused),
        ]
    }
}

/// The shaper, cycle accurate at its ports.
///
/// Between the ports it keeps only what they show: a pass is a count of the clocks that are left of it, and its result
/// is computed in the last of them.
pub struct Shaper {
    config: ShaperConfig,
    ports: Vec<Port>,
    ring: Vec<i64>,
    head: usize,
    /// Samples since the start, at most 2^A − 1.
    age: u32,
    start_value: i64,
    banks: Banks,
    /// Clocks until the pass has its result; 0 while none runs.
    clocks_left: u32,
    y: i64,
    valid: bool,
    saturated: bool,
    overrun: bool,
}

impl Shaper {
    /// A shaper after reset. `seed` gives the arbitrary contents of its memories, which no output ever shows.
    pub fn new(config: &ShaperConfig, seed: u64) -> Self {
        let mut contents = Arbitrary::new(seed);
        let banks = Banks::new(config, &mut contents);
        let ring_samples = 1 << config.ring_address_bits();
        let sample = |word: u64| wrap(word as i64, config.word_bits());
        Self {
            ports: ports(config),
            ring: contents.take(ring_samples).map(sample).collect(),
            head: 0,
            age: 0,
            start_value: 0,
            banks,
            clocks_left: 0,
            y: 0,
            valid: false,
            saturated: false,
            overrun: false,
            config: config.clone(),
        }
    }

    /// What it was built from.
    pub fn config(&self) -> &ShaperConfig {
        &self.config
    }

    /// What the outputs show now.
    pub fn outputs(&self) -> Outputs {
        Outputs {
            y: self.y,
            valid: self.valid,
            saturated: self.saturated,
            busy: self.clocks_left > 0,
            overrun: self.overrun,
            swap_pending: self.banks.pending(),
            bank: self.banks.active(),
            refused: self.banks.refused(),
        }
    }

    /// One clock: what the outputs show before the rising edge, then the edge.
    #[inline]
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let outputs = self.outputs();
        if *inputs == Inputs::default() {
            self.count_down();
        } else {
            self.clock(inputs);
        }
        outputs
    }

    fn clock(&mut self, inputs: &Inputs) {
        if inputs.rst {
            self.reset();
            return;
        }
        if inputs.clear_flags {
            self.saturated = false;
            self.overrun = false;
        }
        if inputs.start || inputs.strobe {
            let word = wrap(inputs.x, self.config.word_bits());
            self.valid = false;
            if inputs.start {
                self.start(word);
            }
            self.overrun |= inputs.strobe && self.clocks_left > 0;
            self.banks.step(inputs);
            if inputs.strobe {
                self.take_sample(word);
            }
        } else {
            self.count_down();
            self.banks.step(inputs);
        }
    }

    fn reset(&mut self) {
        self.start(0);
        self.head = 0;
        self.valid = false;
        self.saturated = false;
        self.overrun = false;
        self.banks.reset();
    }

    fn start(&mut self, word: i64) {
        self.age = 0;
        self.start_value = word;
        self.y = word;
        self.clocks_left = 0;
    }

    /// The ring takes the sample and a pass begins, in place of one that runs.
    fn take_sample(&mut self, word: i64) {
        self.head = (self.head + 1) & (self.ring.len() - 1);
        self.ring[self.head] = word;
        self.age = (self.age + 1).min(self.ring.len() as u32 - 1);
        self.clocks_left = pass_clocks(self.banks.active_taps().len() as u32) - 1;
    }

    fn count_down(&mut self) {
        self.valid = self.clocks_left == 1;
        if self.valid {
            let (y, clamped) = self.shaped();
            self.y = y;
            self.saturated |= clamped;
        }
        self.clocks_left = self.clocks_left.saturating_sub(1);
    }

    fn shaped(&self) -> (i64, bool) {
        let mask = self.ring.len() - 1;
        let mut sum = 0;
        for tap in self.banks.active_taps() {
            let sample = if tap.delay_samples >= self.age {
                self.start_value
            } else {
                self.ring[self.head.wrapping_sub(tap.delay_samples as usize) & mask]
            };
            sum += i64::from(tap.coefficient) * sample;
        }
        round_and_saturate(sum, self.config.coefficient_fraction(), self.config.word_bits())
    }
}

impl ClockedBlock for Shaper {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        let (Ok(raw), 8) = (<&[u64; 12]>::try_from(inputs), outputs.len()) else {
            return Err(StepError(format!(
                "{} inputs and {} outputs: the shaper has 12 and 8",
                inputs.len(),
                outputs.len()
            )));
        };
        let shown = Shaper::step(self, &Inputs::from_raw(raw));
        outputs.copy_from_slice(&shown.to_raw(&self.config));
        Ok(())
    }
}
