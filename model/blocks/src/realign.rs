//! What a host's correction of missing steps does in hardware: the deviation from the scale counts anew, and the steps are counted.
//!
//! A host that finds a resting axis off its scale accepts the scale's position as the axis's, and writes the number of missing steps to
//! `realign_steps`: the deviation is 0 from then on. Then it moves the axis back as in any move. So nothing is given twice, wherever the
//! host is interrupted.
//!
//! ```text
//! enabled    _/‾\_________________
//! correct    _________/‾\_________   with realign_steps = 64
//! align      _____/‾\_____/‾\_____   a clock later
//! corrected  ---- 0 ------| 64 ---
//! ```

use super::{Moore, clocked_block, ports, quiet_at_rest};

ports! {
    realign_ports;

    /// The input ports.
    inputs Inputs {
        /// Synchronous reset.
        rst: Bit as bool;
        /// One clock: the axis was switched on.
        enabled: Bit as bool;
        /// One clock: the host accepts the deviation.
        correct: Bit as bool;
        /// Steps that it gives for it.
        realign_steps: Signed(16) as i32, "counts";
    }

    /// The output ports, all of them registers.
    outputs Outputs {
        /// One clock: the deviation counts from now on.
        align: Bit as bool;
        /// Steps for which a host has realigned since reset, modulo 2^32.
        corrected_steps: Signed(32) as i32, "counts";
    }
}

/// The cycle-accurate model of the block.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Realign {
    align: bool,
    corrected: i32,
}

impl Realign {
    /// The block after reset.
    pub fn new() -> Self {
        Self::default()
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let shown = Outputs {
            align: self.align,
            corrected_steps: self.corrected,
        };
        if inputs.rst {
            *self = Self::default();
            return shown;
        }
        self.align = inputs.enabled || inputs.correct;
        if inputs.correct {
            self.corrected = self.corrected.wrapping_add(inputs.realign_steps);
        }
        shown
    }
}

impl Moore for Realign {
    fn show(&self, outputs: &mut [u64]) {
        if let [align, corrected] = outputs {
            (*align, *corrected) = (self.align.into(), u64::from(self.corrected as u32));
        }
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        quiet_at_rest(self, inputs, |next, raw| {
            next.step(&Inputs::from_raw(raw));
        })
    }
}

clocked_block!(Realign, "the realignment");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn either_event_aligns_and_only_the_hosts_steps_count() {
        let mut block = Realign::new();
        let of = |enabled, correct, realign_steps| Inputs {
            enabled,
            correct,
            realign_steps,
            ..Inputs::default()
        };
        let played = [
            of(true, false, 7),
            of(false, true, 64),
            of(false, false, 9),
            of(true, true, -70),
            of(false, false, 0),
        ];
        let shown = played.map(|inputs| block.step(&inputs));
        assert_eq!(shown.map(|of| of.align), [false, true, true, false, true]);
        assert_eq!(shown.map(|of| of.corrected_steps), [0, 0, 64, 64, -6]);
    }
}
