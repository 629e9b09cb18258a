//! Selects the source of a stand-alone shaper's samples: the host's registers, or pins. The outputs come a clock
//! late.
//!
//! ```text
//! host_strobe, host_start, host_x_0 … ─┐
//!                                      ├─► register ─► strobe, start, x_0 …
//!  pin_strobe,  pin_start,  pin_x_0 … ─┘ from_pins
//! ```

use super::{ClockedBlock, FOREVER, Moore, Port, StepError, ports};

ports! {
    sample_select_ports(W, C);

    inputs {
        /// Synchronous reset.
        rst: Bit;
        /// High: the samples come from pins. Low: they come from the host.
        from_pins: Bit;
        /// One clock, from the host: its words are a sample.
        host_strobe: Bit;
        /// From the host: the sample is the first of a motion.
        host_start: Bit;
        /// From the host: a word per channel.
        host_x[C]: Signed(W);
        /// `host_strobe` from a pin.
        pin_strobe: Bit;
        /// `host_start` from a pin.
        pin_start: Bit;
        /// `host_x` from pins.
        pin_x[C]: Signed(W);
    }

    outputs {
        /// One clock: the words are a sample.
        strobe: Bit;
        /// The sample is the first of a motion.
        start: Bit;
        /// A word per channel.
        x[C]: Signed(W);
    }
}

/// The cycle-accurate model of the selection.
#[derive(Debug, Clone)]
pub struct SampleSelect {
    ports: Vec<Port>,
    shown: Vec<u64>,
}

impl SampleSelect {
    /// The state after reset, for words of this many bits and this many channels.
    pub fn new(word_bits: u32, channels: usize) -> Self {
        Self {
            ports: ports(word_bits as usize, channels),
            shown: vec![0; 2 + channels],
        }
    }
}

impl Moore for SampleSelect {
    fn show(&self, outputs: &mut [u64]) {
        for (output, value) in outputs.iter_mut().zip(&self.shown) {
            *output = *value;
        }
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        let [reset, from_pins, rest @ ..] = inputs else {
            return 0;
        };
        let (host, pins) = rest.split_at(rest.len() / 2);
        let selected = if from_pins & 1 != 0 { pins } else { host };
        let stays = if reset & 1 != 0 {
            self.shown.iter().all(|value| *value == 0)
        } else {
            self.shown == selected
        };
        if stays { FOREVER } else { 0 }
    }
}

impl ClockedBlock for SampleSelect {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        let values = self.shown.len();
        let ([reset, from_pins, rest @ ..], true) = (inputs, outputs.len() == values) else {
            return Err(StepError(format!(
                "{} inputs and {} outputs: the selection has others",
                inputs.len(),
                outputs.len()
            )));
        };
        if rest.len() != 2 * values {
            return Err(StepError(format!(
                "{} inputs: the selection has {}",
                inputs.len(),
                2 + 2 * values
            )));
        }
        self.show(outputs);
        let (host, pins) = rest.split_at(values);
        if reset & 1 != 0 {
            self.shown.fill(0);
        } else {
            self.shown.copy_from_slice(if from_pins & 1 != 0 { pins } else { host });
        }
        Ok(())
    }
}
