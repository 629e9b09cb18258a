//! The bench of `inline_axis`.

pub(crate) mod stimuli;
mod trials;

pub use self::stimuli::{InlineAxisCoverage, InlineAxisRandom};

use posicast_blocks::ClockedBlock;
use posicast_blocks::inline_axis::{InlineAxis, InlineAxisConfig, InlineLinesActiveLow, ports};
use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module};
use posicast_hdl::inline_axis::{emit, name, simulate};

use crate::blocks::registry::{AreaRow, RegistryRow, small};
use crate::blocks::{Bins, Block, named};
use crate::formal::{INDUCTION, Task, refused};
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "inline_axis",
    benches: |sizes| {
        let Some(shaper) = &sizes.inline else {
            return Ok(Vec::new());
        };
        let of_axis = |axis: &posicast_blocks::inline_shaper::InlineShaperAxis| -> Box<dyn Block> {
            Box::new(InlineAxisBlock::new(axis.follower, &sizes.prefix, &axis.name))
        };
        Ok(shaper.config().axes.iter().map(of_axis).collect())
    },
    small: || {
        let config = InlineAxisConfig::new(3, 5).map_err(refused)?;
        Ok(small(InlineAxisBlock::new(config, "", "alone"), "3 steps per tick"))
    },
    proofs: || {
        let low = InlineLinesActiveLow { a: true, b: false };
        let config = InlineAxisConfig::new(200, 400).map_err(refused)?.active_low(low);
        let macros = [
            ("LIMIT", format!("18'd{}", config.limit_steps())),
            ("SETTLE", format!("14'd{}", config.settle_ticks())),
            ("A_LOW", "1'b1".to_owned()),
            ("B_LOW", "1'b0".to_owned()),
        ];
        let task = Task::new(
            "inline_axis",
            "200 steps per tick, settled after 400 ticks",
            INDUCTION,
            (emit(&config, "")?, ports()),
        );
        Ok(vec![task.properties(&macros, include_str!("inline_axis.sv"))])
    },
    areas: || {
        let config = InlineAxisConfig::new(200, 400).map_err(refused)?;
        Ok(vec![AreaRow::new("", emit(&config, "")?).note(
            "Half of it are the position for the step generator and the offset of the two counts, of 32 bits each.",
        )])
    },
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// An axis of the inline shaper at one size.
#[derive(Debug, Clone)]
pub struct InlineAxisBlock {
    config: InlineAxisConfig,
    prefix: String,
    instance: String,
}

impl InlineAxisBlock {
    /// Creates the block `PREFIX_inline_axis_…`; `instance` names the axis that it serves.
    pub fn new(config: InlineAxisConfig, prefix: &str, instance: &str) -> Self {
        Self {
            config,
            prefix: prefix.to_owned(),
            instance: instance.to_owned(),
        }
    }
}

impl Block for InlineAxisBlock {
    fn name(&self) -> &str {
        "inline_axis"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.config, &self.prefix)
    }

    fn top(&self) -> String {
        name(&self.config, &self.prefix)
    }

    fn model(&self, _seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(InlineAxis::new(&self.config))
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate(&self.config)
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(InlineAxisRandom::new(&self.config, seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(InlineAxisCoverage::new(&self.config))
    }

    fn least_clocks(&self) -> u64 {
        stimuli::least_clocks(&self.config)
    }
}

impl Bins for InlineAxisCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        named(self.counts())
    }
}
