//! The shaper, simulated clock by clock at its ports.

use super::banks::Banks;
use super::config::{CHANNELS_MAX, ShaperConfig};
use super::memory::Arbitrary;
use super::ports::{Inputs, Outputs, ports};
use super::{finish, wrap};
use crate::{ClockedBlock, FOREVER, Moore, Port, StepError};

/// The cycle-accurate model of the shaper.
///
/// It keeps only what the ports show: a pass is represented by the number of its remaining clocks, and its result is
/// computed in the last of them.
pub struct Shaper {
    config: ShaperConfig,
    ports: Vec<Port>,
    /// Ring buffer of each channel.
    rings: Vec<Vec<i64>>,
    head: usize,
    /// Samples since the start, at most 2^A − 1.
    age: u32,
    start_values: [i64; CHANNELS_MAX],
    /// Samples since the position command last changed, at most 2^A − 1.
    still: u32,
    /// The position command of the last sample.
    newest: i64,
    banks: Banks,
    /// Clocks until the pass has its result; 0 while none is running.
    clocks_left: u32,
    y: [i64; CHANNELS_MAX],
    valid: bool,
    saturated: bool,
    overrun: bool,
}

impl Shaper {
    /// A shaper after reset. `seed` determines the arbitrary contents of its memories, which no output ever shows.
    pub fn new(config: &ShaperConfig, seed: u64) -> Self {
        let mut contents = Arbitrary::new(seed);
        let banks = Banks::new(config, &mut contents);
        let ring_samples = 1 << config.ring_address_bits();
        let sample = |word: u64| wrap(word as i64, config.word_bits());
        let rings = (0..config.channels()).map(|_| contents.by_ref().take(ring_samples).map(sample).collect());
        Self {
            ports: ports(config),
            rings: rings.collect(),
            head: 0,
            age: 0,
            start_values: [0; CHANNELS_MAX],
            still: ring_samples as u32 - 1,
            newest: 0,
            banks,
            clocks_left: 0,
            y: [0; CHANNELS_MAX],
            valid: false,
            saturated: false,
            overrun: false,
            config: config.clone(),
        }
    }

    /// Its build parameters.
    pub fn config(&self) -> &ShaperConfig {
        &self.config
    }

    /// The outputs in this clock.
    pub fn outputs(&self) -> Outputs {
        let [y, y_rates @ ..] = self.y;
        let loaded = self.banks.loaded_tap();
        Outputs {
            y,
            y_rates,
            valid: self.valid,
            saturated: self.saturated,
            busy: self.clocks_left > 0,
            overrun: self.overrun,
            swap_pending: self.banks.pending(),
            bank: self.banks.active(),
            refused: self.banks.refused(),
            loaded_coefficient: loaded.coefficient,
            loaded_delay: loaded.delay_samples as u16,
            tap_read_waits: self.banks.read_waits(),
        }
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    #[inline]
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let outputs = self.outputs();
        if *inputs == Inputs::default() && !self.banks.read_waits() {
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
        let busy = self.clocks_left > 0;
        if inputs.clear_flags {
            self.saturated = false;
            self.overrun = false;
        }
        if inputs.start || inputs.strobe {
            let words = self.words(inputs);
            self.valid = false;
            if inputs.start {
                self.start(words);
            }
            self.overrun |= inputs.strobe && self.clocks_left > 0;
            self.banks.step(inputs, self.still, busy);
            if inputs.strobe {
                self.take_sample(words);
            }
        } else {
            self.count_down();
            self.banks.step(inputs, self.still, busy);
        }
    }

    /// The command words of the ports; 0 for channels that do not exist.
    fn words(&self, inputs: &Inputs) -> [i64; CHANNELS_MAX] {
        let [velocity, acceleration] = inputs.x_rates;
        let mut words = [inputs.x, velocity, acceleration].map(|word| wrap(word, self.config.word_bits()));
        words[self.config.channels()..].fill(0);
        words
    }

    fn reset(&mut self) {
        self.start([0; CHANNELS_MAX]);
        self.head = 0;
        self.valid = false;
        self.saturated = false;
        self.overrun = false;
        self.banks.reset();
    }

    fn start(&mut self, words: [i64; CHANNELS_MAX]) {
        self.age = 0;
        self.start_values = words;
        self.still = self.full_age();
        self.newest = words[0];
        self.y = words;
        self.clocks_left = 0;
    }

    /// Whether a start with these words changes nothing.
    fn has_started(&self, words: [i64; CHANNELS_MAX]) -> bool {
        let values = [self.start_values, self.y] == [words; 2] && self.newest == words[0];
        let counts = self.age == 0 && self.still == self.full_age() && self.clocks_left == 0;
        values && counts && !self.banks.hands_over()
    }

    fn full_age(&self) -> u32 {
        (1 << self.config.ring_address_bits()) - 1
    }

    /// Stores the sample in the ring buffers and begins a pass; a running pass is abandoned.
    fn take_sample(&mut self, words: [i64; CHANNELS_MAX]) {
        self.head = (self.head + 1) & self.full_age() as usize;
        for (ring, word) in self.rings.iter_mut().zip(words) {
            ring[self.head] = word;
        }
        self.age = (self.age + 1).min(self.full_age());
        self.still = if words[0] == self.newest {
            (self.still + 1).min(self.full_age())
        } else {
            0
        };
        self.newest = words[0];
        let products = self.banks.tables().products(self.config.channels());
        self.clocks_left = self.config.pass_clocks(products) - 1;
    }

    fn count_down(&mut self) {
        self.valid = self.clocks_left == 1;
        if self.valid {
            self.shape();
        }
        self.clocks_left = self.clocks_left.saturating_sub(1);
    }

    fn shape(&mut self) {
        let (mask, tables) = (self.full_age() as usize, self.banks.tables());
        for (channel, ring) in self.rings.iter().enumerate() {
            let sample = |delay: u32| {
                if delay >= self.age {
                    self.start_values[channel]
                } else {
                    ring[self.head.wrapping_sub(delay as usize) & mask]
                }
            };
            let (y, clamped) = finish(&self.config, channel, &tables, sample);
            self.y[channel] = y;
            self.saturated |= clamped;
        }
    }
}

impl ClockedBlock for Shaper {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        let expected = self.config.port_counts();
        if (inputs.len(), outputs.len()) != expected {
            return Err(StepError(format!(
                "{} inputs and {} outputs: the shaper has {} and {}",
                inputs.len(),
                outputs.len(),
                expected.0,
                expected.1
            )));
        }
        let shown = Shaper::step(self, &Inputs::from_raw(inputs, &self.config));
        shown.write_raw(&self.config, outputs);
        Ok(())
    }
}

impl Moore for Shaper {
    fn show(&self, outputs: &mut [u64]) {
        self.outputs().write_raw(&self.config, outputs);
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        let inputs = Inputs::from_raw(inputs, &self.config);
        let starts = inputs.start && !self.has_started(self.words(&inputs));
        let reads = self.banks.reads(inputs.tap_read, self.clocks_left > 0);
        let acts = inputs.rst || inputs.strobe || starts || inputs.tap_write || inputs.swap || reads;
        let clears = inputs.clear_flags && (self.saturated || self.overrun || self.banks.refused());
        match self.clocks_left {
            _ if acts || clears || self.valid => 0,
            0 => FOREVER,
            left => u64::from(left) - 1,
        }
    }

    fn pass(&mut self, _inputs: &[u64], clocks: u64) {
        if self.clocks_left > 0 {
            self.clocks_left -= clocks as u32;
        }
    }

    fn ignores(&self, input: &str) -> bool {
        matches!(
            input,
            "tap_bank" | "tap_index" | "tap_coefficient" | "tap_delay" | "swap_bank" | "swap_how"
        )
    }
}
