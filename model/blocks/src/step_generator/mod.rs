//! The step generator: it turns the position of every tick into the pulses of a drive with step inputs.
//!
//! The datasheet is `docs/step_generator.md`; the hardware is compared with this reference model.
//!
//! - Between two ticks the position moves on a straight line. A step is divided into `T · 2^F` units, for T clocks per
//!   tick and F fraction bits, so every clock moves by the whole number `p[n] − p[n−1]` of units: nothing is rounded, and
//!   nothing is ever lost. At a tick the demanded steps are the position, rounded half up.
//! - The first tick after enabling only says where the axis stands.
//! - A step that is demanded is owed until the pulser gives it: the times of the lines are minima, so a reversal has to
//!   wait, and its steps follow at the largest rate. Otherwise a step is given at once.
//! - A tick that demands more than the largest rate, or more owed steps than the limit, stops the axis with a cause.
//!   Owed steps are dropped then, and when `enable` is low; a pulse that has begun ends in its time, and `count` stays true.
//!
//! ```text
//! clock     n   n+1 …           n+k  n+k+1  n+k+2  n+k+3
//! tick     ‾‾‾\________________________________________
//! position < p >-----------------------------------------
//! moves        < 1st >  …      <kth>                      the k-th clock passes a middle between two steps
//! owed     ---- 0 ------------------------< 1 >< 0 >----
//! a        ____________________________________/‾‾‾‾‾‾‾
//! count    -----------------------------------< +1 >----
//! ```
//!
//! ```
//! use posicast_blocks::step_generator::{Inputs, StepGenerator, StepGeneratorConfig, StepMode, StepTimes};
//!
//! // 1000 clocks per tick, 8 fraction bits: from 0 to 3 steps in a tick.
//! let times = StepTimes { pulse_clocks: 12, space_clocks: 13, direction_setup_clocks: 10, direction_hold_clocks: 10 };
//! let config = StepGeneratorConfig::new(1000, 8, StepMode::StepDirection, times, 20)?;
//! let mut generator = StepGenerator::new(&config);
//! for clock in 0..2100 {
//!     let position = if clock < 1000 { 0 } else { 3 << 8 };
//!     generator.step(&Inputs { enable: true, tick: clock % 1000 == 0, position, ..Inputs::default() });
//! }
//! assert_eq!(generator.outputs().count, 3);
//! # Ok::<(), posicast_blocks::step_generator::StepGeneratorConfigError>(())
//! ```

mod config;
mod ideal;
mod ports;
mod pulser;

pub use config::{
    MOST_FRACTION_BITS, MOST_LINE_CLOCKS, MOST_OWED_STEPS, MOST_TICK_CLOCKS, StepGeneratorConfig,
    StepGeneratorConfigError, StepLinesActiveLow, StepMode, StepTimes, StepTimesInSeconds,
};
pub use ideal::{IdealStep, ideal_steps, rounded_steps};
pub use ports::{INPUT_PORTS, Inputs, OUTPUT_PORTS, Outputs, PORTS, ports};

use pulser::Pulser;

use super::{FOREVER, Moore, clocked_block, show_each};

/// Clocks from the moment in which a step is demanded to the edge of its line, where no reversal has to wait: a step
/// that the k-th clock of a tick demands shows in clock k + 3 after the tick.
pub const LATENCY_CLOCKS: u64 = 3;

/// The line from one sample to the next.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct Interpolation {
    /// Position of the last tick that was taken.
    taken: i32,
    /// Units per clock.
    difference: i32,
    /// Whether `difference` is new.
    fresh: bool,
    /// Clocks in which it still moves.
    left_clocks: u32,
    /// Units above the middle below, 0 ‥ units per step − 1.
    above_units: i64,
    /// The last clock has demanded a step, and whether it is up.
    demand: Option<bool>,
}

/// The cycle-accurate model of the step generator.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StepGenerator {
    config: StepGeneratorConfig,
    interpolation: Interpolation,
    pulser: Pulser,
    active: bool,
    owed: i32,
    count: i32,
    too_fast: bool,
    owed_exceeded: bool,
}

impl StepGenerator {
    /// A step generator after reset.
    pub fn new(config: &StepGeneratorConfig) -> Self {
        Self {
            config: *config,
            interpolation: Interpolation::default(),
            pulser: Pulser::new(),
            active: false,
            owed: 0,
            count: 0,
            too_fast: false,
            owed_exceeded: false,
        }
    }

    /// The outputs in this clock.
    pub fn outputs(&self) -> Outputs {
        let Pulser { up, pulsing, .. } = self.pulser;
        let (a, b) = match self.config.mode() {
            StepMode::StepDirection => (pulsing, up),
            StepMode::UpDown => (pulsing && up, pulsing && !up),
            StepMode::Quadrature => (matches!(self.count & 3, 1 | 2), self.count & 3 >= 2),
        };
        let low = self.config.lines_active_low();
        Outputs {
            a: a != low.a,
            b: b != low.b,
            count: self.count,
            owed: self.owed,
            active: self.active,
            too_fast: self.too_fast,
            owed_exceeded: self.owed_exceeded,
            tripped: self.too_fast || self.owed_exceeded,
        }
    }

    /// Simulates one clock: returns the outputs before the rising edge, then clocks.
    #[inline]
    pub fn step(&mut self, inputs: &Inputs) -> Outputs {
        let outputs = self.outputs();
        if inputs.rst {
            *self = Self::new(&self.config);
        } else {
            self.clock(inputs);
        }
        outputs
    }

    fn clock(&mut self, inputs: &Inputs) {
        let too_fast =
            self.interpolation.fresh && self.interpolation.difference.unsigned_abs() > self.config.largest_difference();
        let exceeds = self.owed.unsigned_abs() > u32::from(self.config.owed_limit());
        let keeps = self.active && inputs.enable && !too_fast && !exceeds;
        let stands = !self.active && inputs.enable && !self.too_fast && !self.owed_exceeded;

        let wants_up = (self.active && inputs.enable && self.owed != 0).then_some(self.owed > 0);
        let given = match (self.pulser.clock(&self.config, wants_up), self.pulser.up) {
            (false, _) => 0,
            (true, true) => 1,
            (true, false) => -1,
        };
        self.count = self.count.wrapping_add(given);
        let demanded = self.interpolation.demand.map_or(0, |up| if up { 1 } else { -1 });
        self.owed = if keeps { self.owed + demanded - given } else { 0 };
        self.active = keeps || (stands && inputs.tick);
        self.too_fast = too_fast || (self.too_fast && !inputs.clear_flags);
        self.owed_exceeded = exceeds || (self.owed_exceeded && !inputs.clear_flags);

        if keeps {
            let position = inputs.tick.then_some(inputs.position);
            self.interpolation.clock(&self.config, position);
        } else if stands && inputs.tick {
            self.interpolation = Interpolation::standing_at(&self.config, inputs.position);
        } else {
            self.interpolation = Interpolation::default();
        }
    }
}

impl Interpolation {
    /// Standing at a position, with the steps rounded: the line begins at the last half or whole step below it, so that
    /// no product has to be computed. From the end of the next tick on it is exact.
    fn standing_at(config: &StepGeneratorConfig, position: i32) -> Self {
        let units = i64::from(config.step_units());
        let half = (1 << config.fraction_bits()) >> 1;
        Self {
            taken: position & -half.max(1),
            above_units: if position & half == 0 { units / 2 } else { 0 },
            ..Self::default()
        }
    }

    /// Simulates one clock, with the position of a tick or without.
    fn clock(&mut self, config: &StepGeneratorConfig, position: Option<i32>) {
        let units = i64::from(config.step_units());
        self.demand = None;
        if self.left_clocks > 0 {
            self.left_clocks -= 1;
            self.above_units += i64::from(self.difference);
            if self.above_units >= units {
                self.above_units -= units;
                self.demand = Some(true);
            } else if self.above_units < 0 {
                self.above_units += units;
                self.demand = Some(false);
            }
        }
        self.fresh = false;
        // A tick that comes too early is left out: the difference of the next one contains it.
        if let (Some(position), 0) = (position, self.left_clocks) {
            self.difference = position.wrapping_sub(self.taken);
            self.taken = position;
            self.fresh = true;
            self.left_clocks = config.tick_clocks();
        }
    }

    /// Coming clocks that demand no step and do not end the tick's movement.
    fn quiet_clocks(&self, config: &StepGeneratorConfig) -> u64 {
        if self.left_clocks == 0 {
            return FOREVER;
        }
        let moves = i64::from(self.difference);
        let until_step = match moves {
            0 => FOREVER,
            1.. => ((i64::from(config.step_units()) - 1 - self.above_units) / moves) as u64,
            _ => (self.above_units / -moves) as u64,
        };
        until_step.min(u64::from(self.left_clocks - 1))
    }

    fn pass(&mut self, clocks: u64) {
        if self.left_clocks > 0 {
            self.left_clocks -= clocks as u32;
            self.above_units += i64::from(self.difference) * clocks as i64;
        }
    }
}

clocked_block!(StepGenerator, "the step generator");

impl Moore for StepGenerator {
    fn show(&self, outputs: &mut [u64]) {
        show_each(outputs, self.outputs().to_raw());
    }

    fn quiet_clocks(&self, inputs: &[u64]) -> u64 {
        let Ok(raw) = <&[u64; INPUT_PORTS]>::try_from(inputs) else {
            return 0;
        };
        let inputs = Inputs::from_raw(raw);
        let clears = inputs.clear_flags && (self.too_fast || self.owed_exceeded);
        let settled = self.owed == 0 && self.interpolation.demand.is_none() && !self.interpolation.fresh;
        if inputs.rst || inputs.tick || clears || !settled || (self.active && !inputs.enable) {
            return 0;
        }
        let pulse = self.pulser.quiet_clocks(&self.config).unwrap_or(FOREVER);
        pulse.min(self.interpolation.quiet_clocks(&self.config))
    }

    fn pass(&mut self, _inputs: &[u64], clocks: u64) {
        self.interpolation.pass(clocks);
        self.pulser.rest(&self.config, clocks);
    }

    fn ignores(&self, input: &str) -> bool {
        input == "position"
    }
}
