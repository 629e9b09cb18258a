//! The controller computes the drive's command from reference and measurement, by sliding mode, PD or PID.
//!
//! The datasheet is `docs/sliding_mode.md`; the hardware is compared with this reference model.
//!
//! ```text
//! e  = r − x                       s  = de + c·e                    f = sat(s/φ)
//! de = dr − v                      a  = c·de + k·s + ε·f                       sliding mode (notes 8.4)
//!                                  a  = D·de + P·e [+ I·∫e]                    PD [PID]
//! command = limit( KA·a + KF·ddr + KR·dr + KV·v + KC·sat(dr/fade) )            duty = KD·command
//! ```
//!
//! Everything is in counts and ticks T; unit conversions are in the gains (`posicast_machine::control`). One multiplier
//! computes a command in [`CONTROL_CLOCKS`], whatever the numbers are; each of its steps reads its gain at
//! `setting_address`.
//!
//! | type | |
//! |---|---|
//! | [`SlidingMode`] | cycle accurate at its ports, one [`SlidingMode::step`] per clock |
//! | [`TickController`] | the results without the clocks: one [`TickController::control`] per tick |
//! | [`Settings`], [`Gain`], [`SettingRow`] | gains and limit as the words that the hardware reads |
//!
//! ```
//! use posicast_blocks::sliding_mode::{Gain, Law, TickMotion, SettingRow, Settings, TickController};
//!
//! // PD with P = 0.5 and D = 0: half a unit of command per count.
//! let mut settings = Settings::default();
//! settings.set_gain(SettingRow::Proportional, Gain::nearest(0.5, SettingRow::Proportional)?);
//! settings.set_gain(SettingRow::Feedback, Gain::nearest(1.0, SettingRow::Feedback)?);
//! settings.set_limit(1000 << 12);
//! let mut controller = TickController::default();
//! let motion = TickMotion { position_reference: 7 << 8, position: 3, ..TickMotion::default() };
//! assert_eq!(controller.control(Law::Pd, false, &motion, &settings).command, 2 << 12);
//! # Ok::<(), posicast_blocks::sliding_mode::GainError>(())
//! ```

mod datapath;
mod ports;
mod settings;

pub use ports::{INPUT_PORTS, Inputs, Law, OUTPUT_PORTS, Outputs, PORTS, Saturation, TickMotion, ports};
pub use settings::{
    Gain, GainError, LIMIT_MAX, MANTISSA_BITS, MANTISSA_MAX, SETTINGS, SHIFT_MAX, SettingRow, Settings,
};

use self::datapath::{Datapath, LIMIT_STEP, STEPS, address, pass_clocks, step_clocks};
use super::{FOREVER, Moore, clocked_block, show_each};

/// Clock of a step in which its operand and its setting are taken.
const READ_PHASE: u8 = 1;
/// Clocks from the one in which a step's sum is taken to the next step's first.
const CLOCKS_AFTER: u8 = 2;
/// Clocks from `start` to `valid`, and the smallest distance of two starts without `overrun`.
pub const CONTROL_CLOCKS: u32 = pass_clocks() + 1;

/// All registers.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
struct State {
    datapath: Datapath,
    busy: bool,
    step: u8,
    phase: u8,
    valid: bool,
    overrun: bool,
}

impl State {
    #[inline]
    fn outputs(&self) -> Outputs {
        let data = &self.datapath;
        Outputs {
            setting_address: address(self.step, data.law),
            error: data.error_q16_16(),
            sliding: data.sliding,
            command: data.command,
            duty: data.duty,
            valid: self.valid,
            busy: self.busy,
            limited_high: data.limited_high,
            limited_low: data.limited_low,
            limited_ticks: data.limited_ticks,
            saturated_high: data.saturated_high,
            saturated_low: data.saturated_low,
            overrun: self.overrun,
            ends: self.step == STEPS - 1 && self.phase == step_clocks(self.step) - 1,
        }
    }

    #[inline]
    fn clock(&mut self, inputs: &Inputs) {
        if inputs.rst {
            *self = Self::default();
            return;
        }
        if inputs.clear_flags {
            self.datapath.clear_flags();
            self.overrun = false;
        }
        self.datapath.raise_flags();
        self.valid = false;
        let clocks = step_clocks(self.step);
        // This is the clock before the sum of the integral begins.
        let opens = self.step + 1 == LIMIT_STEP && self.phase == clocks - 1;
        if self.busy {
            self.overrun |= inputs.start;
            if self.phase == READ_PHASE {
                self.datapath.multiply(self.step, &inputs.motion(), inputs.setting);
            } else if self.phase == clocks - CLOCKS_AFTER {
                self.datapath.settle(self.step);
            }
            self.phase = (self.phase + 1) % clocks;
            if self.phase == 0 {
                self.step = (self.step + 1) % STEPS;
                self.valid = self.step == 0;
                self.busy = !self.valid;
            }
        } else if inputs.start {
            let law = Law::from_bits(inputs.law);
            self.datapath.capture(law, inputs.modulo, &inputs.motion());
            self.busy = true;
        }
        if inputs.clear_integral {
            self.datapath.clear_integral();
        }
        if opens {
            self.datapath.open_integral();
        }
    }

    /// During a computation, the clocks after one that reads a setting, up to the one that stores the result.
    fn quiet_clocks(&self, inputs: &Inputs) -> u64 {
        let data = &self.datapath;
        let flags = self.overrun || data.saturated_high | data.saturated_low != 0;
        let clears = (inputs.clear_flags && flags) || (inputs.clear_integral && data.has_integral());
        if inputs.rst || inputs.start || clears || self.valid || data.has_found() {
            return 0;
        }
        if !self.busy {
            return FOREVER;
        }
        let left = match self.phase {
            0..=READ_PHASE => 0,
            phase => (step_clocks(self.step) - CLOCKS_AFTER).saturating_sub(phase),
        };
        left.into()
    }

    fn pass(&mut self, clocks: u64) {
        if self.busy {
            self.phase += clocks as u8;
        }
    }
}

/// The cycle-accurate model of the controller.
#[derive(Default)]
pub struct SlidingMode {
    state: State,
}

impl SlidingMode {
    /// A controller after reset.
    pub fn new() -> Self {
        Self::default()
    }

    /// The outputs in this clock.
    pub fn outputs(&self) -> Outputs {
        self.state.outputs()
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    #[inline]
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let outputs = self.state.outputs();
        self.state.clock(inputs);
        outputs
    }
}

clocked_block!(SlidingMode, "the controller");

impl Moore for SlidingMode {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.state.outputs().to_raw());
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        <&[u64; INPUT_PORTS]>::try_from(inputs).map_or(0, |raw| self.state.quiet_clocks(&Inputs::from_raw(raw)))
    }

    fn pass(&mut self, _inputs: &[u64], clocks: u64) {
        self.state.pass(clocks);
    }

    fn ignores(&self, input: &str) -> bool {
        !matches!(input, "rst" | "start" | "clear_integral" | "clear_flags")
    }
}

/// The controller without clocks: a tick in one call, with the outputs at the end of its computation.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct TickController {
    datapath: Datapath,
}

impl TickController {
    /// Computes one tick. The settings are those in the memory during the computation; `motion` does not change
    /// meanwhile.
    pub fn control(&mut self, law: Law, modulo: bool, motion: &TickMotion, settings: &Settings) -> Outputs {
        self.datapath.capture(law, modulo, motion);
        self.datapath.raise_flags();
        for step in 0..STEPS {
            if step == LIMIT_STEP {
                self.datapath.open_integral();
            }
            let setting = settings.word(usize::from(address(step, law)));
            self.datapath.multiply(step, motion, setting);
            self.datapath.settle(step);
            self.datapath.raise_flags();
        }
        let ended = State {
            datapath: self.datapath.clone(),
            valid: true,
            ..State::default()
        };
        ended.outputs()
    }

    /// Clears the integral, as at the start of a motion.
    pub fn clear_integral(&mut self) {
        self.datapath.clear_integral();
    }

    /// Clears the sticky flags.
    pub fn clear_flags(&mut self) {
        self.datapath.clear_flags();
    }
}
