//! The excitation adds a test signal to the position reference between shaper and controller, so that it is not
//! shaped.
//!
//! The datasheet is `docs/excitation.md`; the hardware is compared with this reference model.
//!
//! ```text
//! valid ─► position_reference = y_0 + signal        velocity and acceleration: y_1, y_2 as they are
//!          then, for the next valid:
//!            angle  += frequency / period_ticks     of a turn, exactly: a period is period_ticks ticks
//!            PRBS:   ± amplitude, a new bit at every whole turn
//!            chirp:  amplitude · triangle(angle), then frequency += sweep / 65536 of the first
//!            square: ± amplitude, + in the first half turn
//! ```
//!
//! | part | what it does |
//! |---|---|
//! | [`Excitation`] | start, end and abort of a signal; the sum |
//! | `wave` | angle, frequency and PRBS; the product of amplitude and wave, one bit per clock |
//!
//! A signal starts at a `valid` with `enable`, `allowed`, a kind and a duration, and is added to the `duration_ticks`
//! samples that follow. `enable` or `allowed` low ends it at once. `enable` must have been low before the next one.
//!
//! ```text
//! clock               0   1     n   n+1          k·n  +1  +2       k = duration_ticks
//! valid              ‾‾‾\______/‾‾‾\____..______/‾‾‾\_________
//! excitation_active  ____/‾‾‾‾‾‾‾‾‾‾‾‾‾‾..‾‾‾‾‾‾‾‾‾‾‾‾‾‾\_____
//! excitation_value   ---- 0 -------< v₁ ..-----------< v_k ---     0 with the next valid
//! excitation_done    ___________________..______________/‾‾‾\_
//! ```
//!
//! ```
//! use posicast_blocks::excitation::{Excitation, Inputs, ExcitationKind, TICK_CLOCKS};
//!
//! // A square of 10 counts, 2 ticks high, 2 low.
//! let square = Inputs { enable: true, allowed: true, kind: ExcitationKind::Square, amplitude: 10 << 8, amplitude_limit: 20 << 8,
//!     period_ticks: 4, duration_ticks: 5, ..Inputs::default() };
//! let mut excitation = Excitation::new();
//! excitation.step(&Inputs { enable: false, ..square });
//! let mut tick = || {
//!     excitation.step(&Inputs { valid: true, y_0: 1000 << 8, ..square });
//!     (1..TICK_CLOCKS).for_each(|_| { excitation.step(&square); });
//!     excitation.outputs().position_reference >> 8
//! };
//! let positions: Vec<i32> = (0..8).map(|_| tick()).collect();
//! assert_eq!(positions, [1000, 1010, 1010, 990, 990, 1010, 1000, 1000]);
//! ```

mod ports;
mod wave;

pub use ports::{DURATION_BITS, ExcitationKind, INPUT_PORTS, Inputs, OUTPUT_PORTS, Outputs, PORTS, ports};
pub use wave::{FREQUENCY_BITS, FREQUENCY_FRACTION, PRBS_BITS, TURN_STEPS};

use self::wave::{SCALE_CLOCKS, Wave};
use super::{Moore, clocked_block, quiet_at_rest, show_each};

/// Clocks from `valid` to `reference_valid`.
pub const LATENCY_CLOCKS: u32 = 1;
/// Clocks from a `valid` until the next value of the signal is ready: one to advance, fewer than two turns, the step
/// that detects the end of the turn, and the scaling. Samples that come closer together change the shape of the signal,
/// but never exceed its bound.
pub const TICK_CLOCKS: u32 = 2 * TURN_STEPS + 2 + SCALE_CLOCKS as u32;

/// Phase between two `valid`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Phase {
    #[default]
    Rest,
    Advance,
    Turn,
    /// Scales the value; the number of its clocks that are over.
    Scale(u8),
}

/// All registers except the outputs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Signal {
    phase: Phase,
    wave: Wave,
    /// Value for the next `valid`, Q24.8 counts, 17 bits.
    value: i32,
    /// Number of samples to which it was added, 24 bits.
    ticks: u32,
}

impl Signal {
    /// Simulates one clock of a running signal. Returns whether the signal ends early because it has become too fast.
    fn clock(&mut self, inputs: &Inputs) -> bool {
        match self.phase {
            Phase::Rest => false,
            Phase::Advance => {
                self.phase = Phase::Turn;
                self.wave.advance(inputs).is_err()
            }
            Phase::Turn => {
                let turned = self.wave.turn(inputs.period_ticks);
                if turned == Ok(false) {
                    self.value = 0;
                    self.phase = Phase::Scale(0);
                }
                turned.is_err()
            }
            Phase::Scale(clock) => {
                self.value = self.wave.scale(self.value, clock, inputs);
                self.phase = match clock + 1 {
                    SCALE_CLOCKS => Phase::Rest,
                    next => Phase::Scale(next),
                };
                false
            }
        }
    }
}

/// The cycle-accurate model of the excitation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Excitation {
    signal: Signal,
    /// Whether `enable` was low since the last signal.
    armed: bool,
    shown: Outputs,
}

impl Default for Excitation {
    fn default() -> Self {
        Self::new()
    }
}

impl Excitation {
    /// An excitation after reset.
    pub fn new() -> Self {
        Self {
            signal: Signal::default(),
            armed: false,
            shown: Outputs::default(),
        }
    }

    /// The outputs in this clock.
    pub fn outputs(&self) -> Outputs {
        self.shown
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let before = self.shown;
        if inputs.rst {
            (self.signal, self.armed, self.shown) = Default::default();
            return before;
        }
        self.add(inputs);
        self.control(inputs);
        before
    }

    fn add(&mut self, inputs: &Inputs) {
        let shown = &mut self.shown;
        shown.reference_valid = inputs.valid;
        if inputs.valid {
            let value = self.signal.value;
            shown.position_reference = if inputs.modulo {
                inputs.y_0.wrapping_add(value)
            } else {
                inputs.y_0.saturating_add(value)
            };
            shown.velocity_reference = inputs.y_1;
            shown.acceleration_reference = inputs.y_2;
            shown.excitation_value = value;
        }
    }

    fn control(&mut self, inputs: &Inputs) {
        let wanted = inputs.enable && inputs.allowed && inputs.kind != ExcitationKind::None;
        let ended = self.signal.ticks == inputs.duration_ticks;
        self.shown.excitation_done = false;
        if self.shown.excitation_active {
            let too_fast = self.signal.clock(inputs);
            self.signal.wave.keep_frequency(inputs.kind);
            if inputs.valid {
                self.signal.ticks = (self.signal.ticks + 1) & ((1 << DURATION_BITS) - 1);
                self.signal.phase = Phase::Advance;
            }
            self.shown.excitation_done = wanted && (ended || too_fast);
            self.shown.excitation_active = wanted && !ended && !too_fast;
            if !self.shown.excitation_active {
                self.signal = Signal::default();
            }
        } else if inputs.valid && wanted && self.armed && !ended {
            self.shown.excitation_active = true;
            self.signal.phase = Phase::Scale(0);
            self.armed = false;
        }
        self.armed |= !inputs.enable;
    }
}

clocked_block!(Excitation, "the excitation");

impl Moore for Excitation {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.outputs().to_raw());
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        quiet_at_rest(self, inputs, |next, raw| {
            Excitation::step(next, &Inputs::from_raw(raw));
        })
    }
}
