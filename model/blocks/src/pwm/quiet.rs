//! The quiet clocks of the PWM: those in which only the carrier and a timer count, and those of a computation that no
//! output shows.

use super::ports::{INPUT_PORTS, Inputs};
use super::{LEAD_CLOCKS, Pattern, Pwm, PwmConfig, State};
use crate::FOREVER;
use crate::{Moore, OutputKind, show_each};

/// Largest number of clocks that are simulated to see whether an output changes: those of a computation.
const MOST_UNSEEN: u64 = LEAD_CLOCKS as u64;

impl State {
    /// Number of further clocks like the last one, which led from `before` to the present state; `None` if it did more
    /// than count.
    pub(super) fn more_of(&self, before: &Self, inputs: &Inputs) -> Option<u64> {
        let state = self;
        let mut counted = *before;
        counted.count(1);
        if counted != *state || state.is_busy() || inputs.sync || inputs.rst {
            return None;
        }
        let lead = state.period.wrapping_sub(LEAD_CLOCKS);
        let events = [
            Some(lead),
            Some(lead >> 1),
            Some(inputs.trigger_phase),
            state.astray.then_some(inputs.phase),
        ];
        let distances = events
            .into_iter()
            .flatten()
            .map(|position| position.wrapping_sub(state.position));
        let counts = state.leg.timer != before.leg.timer;
        let timer = if counts { state.leg.timer } else { u16::MAX };
        Some(u64::from(
            distances.fold(timer.min(state.command.same_level()), u16::min),
        ))
    }

    /// Advances by this many clocks in which it only counts: at most the distance to a position of 16 bits, and to the end of the timer.
    pub(super) fn count(&mut self, clocks: u16) {
        self.position = self.position.wrapping_add(clocks);
        self.command.count(clocks);
        if self.running && self.pattern != Pattern::Off {
            self.leg.timer = self.leg.timer.saturating_sub(clocks);
        }
    }

    /// Number of clocks from a busy one, after each of which all outputs are as now; [`FOREVER`] if the carrier waits.
    ///
    /// It simulates them, since a leg may switch meanwhile. That takes a fraction of what a composition needs to clock a
    /// block.
    fn unseen(&self, config: &PwmConfig, inputs: &Inputs) -> u64 {
        // A raw fault turns the pins off, in all of these clocks alike.
        let armed = Inputs {
            fault_n: true,
            pll_locked: true,
            ..*inputs
        };
        let shown = |state: &Self| state.outputs(config.active_low(), &armed);
        let (before, mut state) = (shown(self), *self);
        for clocks in 0..MOST_UNSEEN {
            let next = state.after(config, inputs);
            if next == state {
                return FOREVER;
            }
            if !state.is_busy() || shown(&next) != before {
                return clocks;
            }
            state = next;
        }
        MOST_UNSEEN
    }

    /// The state after one clock.
    fn after(mut self, config: &PwmConfig, inputs: &Inputs) -> Self {
        self.clock(config, inputs);
        self
    }

    /// Whether it computes a command, or a strobe is high, which falls in the next clock.
    fn is_busy(&self) -> bool {
        let strobes = self.at_valley || self.at_peak || self.valley || self.peak || self.trigger;
        strobes || self.command.step != 0 || self.command.works
    }
}

/// The pins of the gates depend on the raw faults of the same clock; `show` writes them as during a fault.
impl Moore for Pwm {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.outputs(&Inputs::default()).to_raw());
    }

    fn output_kind(&self, output: &str) -> OutputKind {
        match output {
            "a_high" | "a_low" | "b_high" | "b_low" => OutputKind::Combinational,
            _ => OutputKind::Register,
        }
    }

    fn show_with(&mut self, inputs: &[u64], outputs: &mut [u64]) {
        let inputs = <&[u64; INPUT_PORTS]>::try_from(inputs).map_or_else(|_| Inputs::default(), Inputs::from_raw);
        show_each(outputs, self.outputs(&inputs).to_raw());
    }

    /// Looks ahead during a computation. Else it tries one clock: if that only counts, it and all like it are quiet; if it
    /// changes nothing, because the carrier waits, all are.
    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        let Ok(inputs) = <&[u64; INPUT_PORTS]>::try_from(inputs).map(Inputs::from_raw) else {
            return 0;
        };
        if self.state.is_busy() {
            return self.state.unseen(&self.config, &inputs);
        }
        let next = self.state.after(&self.config, &inputs);
        if next == self.state {
            return FOREVER;
        }
        next.more_of(&self.state, &inputs).map_or(0, |more| 1 + more)
    }

    fn pass(&mut self, inputs: &[u64], clocks: u64) {
        if let Ok(raw) = <&[u64; INPUT_PORTS]>::try_from(inputs) {
            let inputs = Inputs::from_raw(raw);
            if self.state.is_busy() {
                for _ in 0..clocks {
                    let before = self.state;
                    self.state.clock(&self.config, &inputs);
                    if self.state == before {
                        break;
                    }
                }
            } else if !inputs.rst && !self.state.waits(&inputs) {
                self.state.count(clocks as u16);
            }
        }
    }
}
