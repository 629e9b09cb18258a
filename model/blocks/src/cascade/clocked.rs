//! The cascade, simulated clock by clock at its ports.

use super::config::{CascadeConfig, pass_clocks};
use super::rounded;
use crate::ports::ports;
use crate::shaper::{Arbitrary, wrap};
use crate::{ClockedBlock, Port, StepError};

ports! {
    cascade_ports(W);

    /// The input ports. Bits above a port's width are ignored.
    inputs Inputs {
        /// Synchronous reset, active high.
        rst: Bit as bool;
        /// For one clock: `x` is the next sample; ignored during a computation.
        strobe: Bit as bool;
        /// For one clock: restart; all samples before now count as `x`.
        start: Bit as bool;
        /// Command word.
        x: Signed(W) as i64;
        /// Clears `overrun`.
        clear_flags: Bit as bool;
    }

    /// The output ports, all of them registers.
    outputs Outputs {
        /// Shaped command; holds between samples.
        y: Signed(W) as i64;
        /// For one clock: `y` is new.
        valid: Bit as bool;
        /// A sample is being computed.
        busy: Bit as bool;
        /// Sticky: a strobe came during a computation, and its sample was lost. Setting wins over `clear_flags` in
        /// the same clock.
        overrun: Bit as bool;
    }
}

/// The cycle-accurate model of the cascade.
///
/// A sample is computed when its strobe comes, and shown when its clocks are over: no other strobe is accepted in
/// between.
pub struct Cascade {
    config: CascadeConfig,
    ports: Vec<Port>,
    /// Ring buffer of each stage, with the samples that went into it.
    rings: Vec<Vec<i64>>,
    head: usize,
    /// Samples since the start, at most 2^A − 1.
    age: u32,
    start_value: i64,
    /// Clocks until the sample is finished; 0 while none is computed.
    clocks_left: u32,
    result: i64,
    y: i64,
    valid: bool,
    overrun: bool,
}

impl Cascade {
    /// A cascade after reset. `seed` determines the arbitrary contents of its memory, which no output ever shows.
    pub fn new(config: &CascadeConfig, seed: u64) -> Self {
        let mut contents = Arbitrary::new(seed);
        let ring_samples = 1 << config.ring_address_bits();
        let sample = |word: u64| wrap(word as i64, config.sum_bits());
        let mut ring = |_| contents.by_ref().take(ring_samples).map(sample).collect();
        Self {
            ports: ports(config.word_bits() as usize),
            rings: (0..config.stages()).map(&mut ring).collect(),
            head: 0,
            age: 0,
            start_value: 0,
            clocks_left: 0,
            result: 0,
            y: 0,
            valid: false,
            overrun: false,
            config: config.clone(),
        }
    }

    /// Its build parameters.
    pub fn config(&self) -> &CascadeConfig {
        &self.config
    }

    /// The outputs in this clock.
    pub fn outputs(&self) -> Outputs {
        Outputs {
            y: self.y,
            valid: self.valid,
            busy: self.clocks_left > 0,
            overrun: self.overrun,
        }
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    #[inline]
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let outputs = self.outputs();
        if inputs.rst {
            self.start(0);
            self.head = 0;
            self.valid = false;
            self.overrun = false;
            return outputs;
        }
        if inputs.clear_flags {
            self.overrun = false;
        }
        let word = wrap(inputs.x, self.config.word_bits());
        if inputs.start {
            self.start(word);
        }
        let free = self.clocks_left == 0;
        self.count_down();
        if inputs.strobe && free {
            self.take_sample(word);
        }
        self.overrun |= inputs.strobe && !free;
        outputs
    }

    fn start(&mut self, word: i64) {
        self.age = 0;
        self.start_value = word;
        self.y = word;
        self.clocks_left = 0;
    }

    fn count_down(&mut self) {
        self.valid = self.clocks_left == 1;
        if self.valid {
            self.y = self.result;
        }
        self.clocks_left = self.clocks_left.saturating_sub(1);
    }

    /// Passes the sample through all stages, each of which stores its input.
    fn take_sample(&mut self, word: i64) {
        let mask = (1 << self.config.ring_address_bits()) - 1;
        self.head = (self.head + 1) & mask;
        self.age = (self.age + 1).min(mask as u32);
        let mut sum = word;
        for (stage, (ring, &delay)) in self.rings.iter_mut().zip(self.config.delays_samples()).enumerate() {
            ring[self.head] = sum;
            sum += if delay >= self.age {
                self.start_value << stage
            } else {
                ring[self.head.wrapping_sub(delay as usize) & mask]
            };
        }
        let stages = self.config.stages();
        self.result = rounded(sum, stages);
        self.clocks_left = pass_clocks(stages) - 1;
    }
}

impl ClockedBlock for Cascade {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        let (Ok(raw), OUTPUT_PORTS) = (<&[u64; INPUT_PORTS]>::try_from(inputs), outputs.len()) else {
            return Err(StepError(format!(
                "{} inputs and {} outputs: the cascade has {INPUT_PORTS} and {OUTPUT_PORTS}",
                inputs.len(),
                outputs.len()
            )));
        };
        let word_bits = self.config.word_bits() as usize;
        let shown = Cascade::step(self, &Inputs::from_raw(raw, word_bits));
        outputs.copy_from_slice(&shown.to_raw(word_bits));
        Ok(())
    }
}
