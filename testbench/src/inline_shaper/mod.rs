//! The bench of `inline_shaper`: all axes of an inline shaper, with a controller's step pulses at the pins.

mod proofs;
mod reached;
pub(crate) mod stimuli;
mod trials;

pub use self::reached::InlineShaperCoverage;
pub use self::stimuli::InlineShaperRandom;

use posicast_blocks::ClockedBlock;
use posicast_blocks::divider::DividerConfig;
use posicast_blocks::inline_axis::{INLINE_FRACTION, InlineAxisConfig, InlineLinesActiveLow, MOST_TICK_STEPS};
use posicast_blocks::inline_shaper::{INLINE_MOTION, InlineConfig, InlineShaper, InlineShaperAxis};
use posicast_blocks::shaper::ShaperConfig;
use posicast_blocks::step_generator::{StepGeneratorConfig, StepMode, StepTimes};
use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module};
use posicast_hdl::inline_shaper::emit;

use crate::Error;
use crate::blocks::registry::{Benches, RegistryRow};
use crate::blocks::{Bins, Block, inside, named};
use crate::formal::refused;
use crate::lockstep::Clock;
use crate::shaper::tap_table;
use crate::stimuli::Stimuli;

/// Name of the top where no machine gives one.
const TOP: &str = "inline";

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "inline_shaper",
    benches: |sizes| {
        let shapers = sizes.inline.iter();
        let bench =
            |shaper: &InlineShaper| -> Box<dyn Block> { Box::new(InlineShaperBlock::new(shaper.clone(), TOP, TOP)) };
        Ok(shapers.map(bench).collect())
    },
    proofs: proofs::tasks,
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
    ..RegistryRow::EMPTY
};

/// An inline shaper, and the names of its modules.
#[derive(Debug, Clone)]
pub struct InlineShaperBlock {
    shaper: InlineShaper,
    top: String,
    prefix: String,
    instance: String,
}

impl InlineShaperBlock {
    /// Creates the inline shaper with the module `top`; modules whose contents depend on the machine begin with `prefix`.
    pub fn new(shaper: InlineShaper, top: &str, prefix: &str) -> Self {
        let axes: Vec<&str> = shaper.config().axes.iter().map(|axis| axis.name.as_str()).collect();
        Self {
            instance: axes.join(", "),
            shaper,
            top: top.to_owned(),
            prefix: prefix.to_owned(),
        }
    }

    /// The inline shaper.
    pub fn shaper(&self) -> &InlineShaper {
        &self.shaper
    }

    /// The blocks in it, each alone.
    ///
    /// # Errors
    /// As [`crate::shaper::ShaperBlock::new`].
    pub fn inner(&self) -> Result<Benches, Error> {
        inside::of_joined(self.shaper.whole(), &self.prefix, "in the inline shaper")
    }
}

impl Block for InlineShaperBlock {
    fn name(&self) -> &str {
        "inline_shaper"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.shaper, &self.top, &self.prefix)
    }

    fn top(&self) -> String {
        self.top.clone()
    }

    fn model(&self, seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(self.shaper.model(seed))
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        Err(SimulationError::Refused {
            block: "inline_shaper",
            reason: "its blocks are joined in Verilog; each of them is simulated alone".to_owned(),
        })
    }

    fn in_rusthdl(&self) -> bool {
        false
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(InlineShaperRandom::new(self.shaper.config(), seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(InlineShaperCoverage::new(self.shaper.config()))
    }

    fn least_clocks(&self) -> u64 {
        stimuli::first_acts_clocks(self.shaper.config())
    }

    fn fixed(&self) -> Vec<(String, &'static str)> {
        let mut fixed = Vec::new();
        for axis in &self.shaper.config().axes {
            let mut add = |flag: &str, reason| fixed.push((format!("{}_{flag}", axis.name), reason));
            if axis.input != StepMode::Quadrature {
                add("input_illegal", "no transition of these lines is illegal");
            }
            if !stimuli::exceeds_the_limit(axis, self.shaper.config().tick.tick_clocks().into()) {
                add("input_too_fast", "the lines cannot be faster than the limit");
            }
            add("steps_stopped", "the limit of the input stops the axis before");
        }
        fixed
    }
}

impl Bins for InlineShaperCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        named(self.counts())
    }
}

/// Two axes with short ticks and shapers: step and direction on both sides, with negative taps; and quadrature to up and
/// down, with the step line active low.
pub(crate) fn example() -> Result<InlineShaper, Error> {
    let tick_clocks = 200;
    let axis = |name: &str, input, output, taps: &[(u32, i32)]| -> Result<InlineShaperAxis, Error> {
        let times = StepTimes {
            pulse_clocks: 3,
            space_clocks: 4,
            direction_setup_clocks: 12,
            direction_hold_clocks: 8,
        };
        let steps = StepGeneratorConfig::new(tick_clocks, INLINE_FRACTION, output, times, 100).map_err(refused)?;
        let shaper = ShaperConfig::new(32, tap_table(14, taps)?).map_err(refused)?;
        let settle = u64::from(shaper.table().longest_delay_samples()) + 1;
        Ok(InlineShaperAxis {
            name: name.to_owned(),
            input,
            filter_clocks: 2,
            follower: InlineAxisConfig::new(10, settle).map_err(refused)?,
            shaper: shaper.for_motion(INLINE_MOTION).map_err(refused)?,
            steps,
            trace: None,
        })
    };
    let mut y = axis(
        "y",
        StepMode::Quadrature,
        StepMode::UpDown,
        &[(1, 8000), (2, 384), (9, 8000)],
    )?;
    y.follower = y.follower.active_low(InlineLinesActiveLow { a: true, b: false });
    let x_taps = [(0, 9000), (3, -1000), (4, 2384), (7, 6000)];
    InlineShaper::new(&InlineConfig {
        tick: DividerConfig::new(tick_clocks).map_err(refused)?,
        axes: vec![axis("x", StepMode::StepDirection, StepMode::StepDirection, &x_taps)?, y],
    })
    .map_err(refused)
}

/// One axis without a limit of the input, up and down to quadrature, whose step generator owes few steps.
pub(crate) fn unlimited() -> Result<InlineShaper, Error> {
    let times = StepTimes {
        pulse_clocks: 5,
        space_clocks: 5,
        direction_setup_clocks: 12,
        direction_hold_clocks: 8,
    };
    let tick_clocks = 120;
    let steps = StepGeneratorConfig::new(tick_clocks, INLINE_FRACTION, StepMode::Quadrature, times, 2);
    let shaper = ShaperConfig::new(32, tap_table(10, &[(0, 512), (5, 512)])?).map_err(refused)?;
    InlineShaper::new(&InlineConfig {
        tick: DividerConfig::new(tick_clocks).map_err(refused)?,
        axes: vec![InlineShaperAxis {
            name: "a".to_owned(),
            input: StepMode::UpDown,
            filter_clocks: 0,
            follower: InlineAxisConfig::new(u64::from(MOST_TICK_STEPS), 6).map_err(refused)?,
            shaper: shaper.for_motion(INLINE_MOTION).map_err(refused)?,
            steps: steps.map_err(refused)?,
            trace: None,
        }],
    })
    .map_err(refused)
}
