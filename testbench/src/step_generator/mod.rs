//! The bench of `step_generator`.

pub(crate) mod proofs;
mod reached;
pub(crate) mod stimuli;
mod trials;

pub use self::reached::StepGeneratorCoverage;
pub use self::stimuli::StepGeneratorRandom;

use posicast_blocks::ClockedBlock;
use posicast_blocks::step_generator::{StepGenerator, StepGeneratorConfig, StepMode, StepTimes};
use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module};
use posicast_hdl::step_generator::{emit, name, simulate, simulated_as};

use crate::Error;
use crate::blocks::registry::{AreaRow, RegistryRow, one, small};
use crate::blocks::{Bins, Block, named};
use crate::formal::refused;
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// The fraction bits that a machine's positions have by default.
const FRACTION_BITS: u32 = 8;

/// Two million steps per second at 50 MHz, and directions as optocouplers want them.
const FAST: StepTimes = StepTimes {
    pulse_clocks: 12,
    space_clocks: 13,
    direction_setup_clocks: 250,
    direction_hold_clocks: 25,
};

/// Number of ticks after which the stimuli have driven every flag.
const LEAST_TICKS: u64 = 20;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "step_generator",
    benches: |sizes| {
        let tick_clocks = u64::from(sizes.tick.tick_clocks());
        let config =
            StepGeneratorConfig::new(tick_clocks, FRACTION_BITS, StepMode::StepDirection, FAST, 10).map_err(refused)?;
        Ok(one(StepGeneratorBlock::new(config, &sizes.prefix)))
    },
    small: || {
        let config = trials::small(StepMode::StepDirection)?;
        Ok(small(StepGeneratorBlock::new(config, ""), "50 clocks per tick"))
    },
    proofs: proofs::all,
    areas: || {
        let row = |size, mode| -> Result<AreaRow, Error> {
            let config = StepGeneratorConfig::new(5000, FRACTION_BITS, mode, FAST, 100).map_err(refused)?;
            Ok(AreaRow::new(size, emit(&config, "")?).budget(300, 200))
        };
        Ok(vec![
            row("step and direction, 5000 clocks per tick", StepMode::StepDirection)?,
            row("quadrature, 5000 clocks per tick", StepMode::Quadrature)?,
        ])
    },
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// The step generator at one size.
#[derive(Debug, Clone)]
pub struct StepGeneratorBlock {
    config: StepGeneratorConfig,
    prefix: String,
    instance: String,
}

impl StepGeneratorBlock {
    /// Creates the step generator `PREFIX_step_generator_…`.
    pub fn new(config: StepGeneratorConfig, prefix: &str) -> Self {
        Self {
            config,
            prefix: prefix.to_owned(),
            instance: format!("{} clocks per tick", config.tick_clocks()),
        }
    }

    /// Sets the instance that a report names.
    #[must_use]
    pub fn called(self, instance: &str) -> Self {
        Self {
            instance: instance.to_owned(),
            ..self
        }
    }
}

impl Block for StepGeneratorBlock {
    fn name(&self) -> &str {
        "step_generator"
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
        Box::new(StepGenerator::new(&self.config))
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate(&self.config)
    }

    fn simulated_as(&self) -> Option<String> {
        simulated_as(&self.config)
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(StepGeneratorRandom::new(&self.config, seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(StepGeneratorCoverage::new(&self.config))
    }

    fn fixed(&self) -> Vec<(String, &'static str)> {
        // The steps that wait for one reversal are taken off before those of the next are added.
        let unreachable = u64::from(self.config.owed_limit()) > self.config.reversal_steps();
        let reason = "more steps may be owed than a reversal at the largest rate leaves";
        Vec::from_iter(unreachable.then(|| ("owed_exceeded".to_owned(), reason)))
    }

    fn least_clocks(&self) -> u64 {
        LEAST_TICKS * u64::from(self.config.tick_clocks())
    }
}

impl Bins for StepGeneratorCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        named(self.counts())
    }
}
