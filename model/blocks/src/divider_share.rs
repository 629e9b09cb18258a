//! Shares one divider among all pulse counters of a stage: their divisions run one after the other, in a fixed order.
//!
//! ```text
//! clock             0   1   2        103 104 105      206 207
//! divide           ‾‾‾\_______________________________________
//! start            ____/‾‾‾\_____________/‾‾‾\_______________   to the divider, with steps and elapsed of channel 0, 1
//! done             __________________/‾‾‾\___________/‾‾‾\___   from the divider
//! quotient_valid_0 ______________________/‾‾‾\_______________
//! quotient_valid_1 __________________________________/‾‾‾\___   one clock after its done
//! ```
//!
//! - `divide` comes in the clock after a tick: the counters show their operands from then on, until the next tick.
//! - The quotient of channel k is always valid `(k + 1) ·` [`SHARE_CLOCKS`] clocks after `divide`.
//! - A `divide` while divisions are running is ignored; the counters then flag a missed velocity.

use super::divider::{DIVISION_CLOCKS, ELAPSED_BITS, STEP_BITS};
use super::{ClockedBlock, FOREVER, Moore, Port, StepError, ports, show_each};

/// Largest number of channels: four axes, each with a scale.
pub const MOST_CHANNELS: usize = 8;
/// Clocks that a channel takes.
pub const SHARE_CLOCKS: u32 = DIVISION_CLOCKS + 1;

ports! {
    divider_share_ports(C);

    inputs {
        /// Synchronous reset.
        rst: Bit;
        /// One clock: starts the divisions of all channels, one after the other.
        divide: Bit;
        /// Dividend: `steps` of the channel's pulse counter.
        steps_of[C]: Signed(18), "counts";
        /// Divisor: `elapsed` of the channel's pulse counter.
        elapsed_of[C]: Bits(24), "clocks";
        /// `done` of the divider.
        done: Bit;
    }

    outputs {
        /// One clock: to `start` of the divider.
        start: Bit;
        /// To `steps` of the divider.
        steps: Signed(18), "counts";
        /// To `elapsed` of the divider.
        elapsed: Bits(24), "clocks";
        /// One clock: the quotient of the divider belongs to this channel.
        quotient_valid[C]: Bit;
    }
}

/// The cycle-accurate model of the divider's share.
#[derive(Debug, Clone)]
pub struct DividerShare {
    ports: Vec<Port>,
    channels: usize,
    /// Channel whose division is running.
    turn: Option<usize>,
    start: bool,
    steps: u64,
    elapsed: u64,
    /// Channel whose quotient is valid.
    valid: Option<usize>,
}

impl DividerShare {
    /// The state after reset, for 1 to [`MOST_CHANNELS`] channels.
    pub fn new(channels: usize) -> Self {
        Self {
            ports: ports(channels),
            channels,
            turn: None,
            start: false,
            steps: 0,
            elapsed: 0,
            valid: None,
        }
    }

    fn clock(&mut self, divide: bool, steps: &[u64], elapsed: &[u64], done: bool) {
        let next = match self.turn {
            None => divide.then_some(0),
            Some(turn) if done => Some(turn + 1).filter(|next| *next < self.channels),
            Some(_) => None,
        };
        let over = self.turn.filter(|_| done);
        self.valid = over;
        if over.is_some() || self.turn.is_none() {
            self.turn = next;
        }
        self.start = next.is_some();
        if let Some(next) = next {
            self.steps = steps[next] & ((1 << STEP_BITS) - 1);
            self.elapsed = elapsed[next] & ((1 << ELAPSED_BITS) - 1);
        }
    }
}

impl Moore for DividerShare {
    fn show(&self, outputs: &mut [u64]) {
        let valid = (0..self.channels).map(|channel| u64::from(self.valid == Some(channel)));
        let shown = [self.start.into(), self.steps, self.elapsed].into_iter().chain(valid);
        show_each(outputs, shown);
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        let called = [0, 1, 2 + 2 * self.channels].iter().any(|at| inputs[*at] & 1 != 0);
        if called || self.start || self.valid.is_some() {
            0
        } else {
            FOREVER
        }
    }

    fn ignores(&self, input: &str) -> bool {
        input.starts_with("steps_of") || input.starts_with("elapsed_of")
    }
}

impl ClockedBlock for DividerShare {
    fn ports(&self) -> &[Port] {
        &self.ports
    }

    fn step(&mut self, inputs: &[u64], outputs: &mut [u64]) -> Result<(), StepError> {
        let channels = self.channels;
        if (inputs.len(), outputs.len()) != (3 + 2 * channels, 3 + channels) {
            return Err(StepError(format!(
                "{} inputs and {} outputs: a divider's share of {channels} channels has {} and {}",
                inputs.len(),
                outputs.len(),
                3 + 2 * channels,
                3 + channels,
            )));
        }
        self.show(outputs);
        if inputs[0] & 1 != 0 {
            *self = Self::new(channels);
            return Ok(());
        }
        let (steps, rest) = inputs[2..].split_at(channels);
        let (elapsed, done) = rest.split_at(channels);
        self.clock(inputs[1] & 1 != 0, steps, elapsed, done[0] & 1 != 0);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::divider::{Divider, DividerConfig, Inputs};

    #[test]
    fn every_channel_gets_its_own_quotient_in_its_own_clock() {
        let config = DividerConfig::new(5000).unwrap();
        let operands = [(3i32, 7500u32), (-200, 4999), (1, 0), (0, 12)];
        for channels in 1..=operands.len() {
            let mut share = DividerShare::new(channels);
            let mut divider = Divider::new(&config);
            let mut found = vec![None; channels];
            for clock in 0..1000u32 {
                let divided = divider.outputs();
                let mut inputs = vec![0, u64::from(clock == 0)];
                inputs.extend(operands[..channels].iter().map(|(steps, _)| *steps as u64 & 0x3_ffff));
                inputs.extend(operands[..channels].iter().map(|(_, elapsed)| u64::from(*elapsed)));
                inputs.push(divided.done.into());
                let mut outputs = vec![0; 3 + channels];
                share.step(&inputs, &mut outputs).unwrap();
                for (channel, found) in found.iter_mut().enumerate() {
                    if outputs[3 + channel] != 0 {
                        assert_eq!(*found, None);
                        *found = Some((clock, divided.quotient));
                    }
                }
                divider.step(&Inputs {
                    start: outputs[0] != 0,
                    steps: ((outputs[1] << 46) as i64 >> 46) as i32,
                    elapsed: outputs[2] as u32,
                    ..Inputs::default()
                });
            }
            for (channel, found) in found.iter().enumerate() {
                let (steps, elapsed) = operands[channel];
                let wanted = (1 + (channel as u32 + 1) * SHARE_CLOCKS, config.divide(steps, elapsed).0);
                assert_eq!(*found, Some(wanted), "{channel} of {channels}");
            }
        }
    }
}
