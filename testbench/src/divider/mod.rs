//! The bench of `divider`.

pub(crate) mod stimuli;
mod trials;

pub use self::stimuli::{DividerCoverage, DividerRandom};

use posicast_blocks::ClockedBlock;
use posicast_blocks::divider::{DIVISION_CLOCKS, Divider, DividerConfig, ports};
use posicast_hdl::SimulationError;
use posicast_hdl::divider::{emit, simulate};
use posicast_hdl::emit::{EmitError, Module};

use crate::Error;
use crate::blocks::registry::{AreaRow, RegistryRow, one, small};
use crate::blocks::{Bins, Block, named};
use crate::formal::{INDUCTION, Task, refused};
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "divider",
    benches: |sizes| Ok(one(DividerBlock::new(sizes.tick, &sizes.prefix))),
    small: || {
        let ticks = DividerConfig::new(97).map_err(refused)?;
        Ok(small(DividerBlock::new(ticks, ""), "97 clocks per tick"))
    },
    proofs: || [5000, 131_071].map(proof).into_iter().collect(),
    areas: || {
        let modules = emit(&DividerConfig::new(5000).map_err(refused)?, "")?;
        let row = AreaRow::new("5000 clocks per tick", modules).budget(200, 150);
        Ok(vec![row.note(
            "The 35-bit register and the remainder select between two or three sources.",
        )])
    },
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// The divider for ticks of one length.
#[derive(Debug, Clone)]
pub struct DividerBlock {
    config: DividerConfig,
    prefix: String,
    instance: String,
}

impl DividerBlock {
    /// Creates the divider `PREFIX_divider`.
    pub fn new(config: DividerConfig, prefix: &str) -> Self {
        Self {
            config,
            prefix: prefix.to_owned(),
            instance: format!("{} clocks per tick", config.tick_clocks()),
        }
    }

    /// Renames the block to `instance` in the report.
    pub fn called(self, instance: &str) -> Self {
        Self {
            instance: instance.to_owned(),
            ..self
        }
    }
}

impl Block for DividerBlock {
    fn name(&self) -> &str {
        "divider"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.config, &self.prefix)
    }

    fn top(&self) -> String {
        posicast_hdl::divider::name(&self.config, &self.prefix)
    }

    fn model(&self, _seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(Divider::new(&self.config))
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate(&self.config)
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(DividerRandom::new(&self.config, seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(DividerCoverage::default())
    }
}

impl Bins for DividerCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        named(self.counts())
    }
}

fn proof(tick_clocks: u64) -> Result<Task, Error> {
    let config = DividerConfig::new(tick_clocks).map_err(refused)?;
    let macros = [
        ("TICK_CLOCKS", format!("17'd{tick_clocks}")),
        ("DIVISION_CLOCKS", format!("7'd{DIVISION_CLOCKS}")),
    ];
    let size = format!("{tick_clocks} clocks per tick, full width");
    Ok(Task::new("divider", &size, INDUCTION, (emit(&config, "")?, ports()))
        .properties(&macros, include_str!("divider.sv")))
}
