//! The bench of `cascade`.

pub(crate) mod stimuli;
mod trials;

pub use self::stimuli::{CascadeCoverage, CascadeRandom};

use posicast_blocks::ClockedBlock;
use posicast_blocks::cascade::{Cascade, CascadeConfig, pass_clocks, ports};
use posicast_hdl::SimulationError;
use posicast_hdl::cascade::{emit, simulate, simulated_as};
use posicast_hdl::emit::{EmitError, Module, own_name};

use crate::Error;
use crate::blocks::registry::{AreaRow, RegistryRow, one, small};
use crate::blocks::{Bins, Block, named};
use crate::formal::{INDUCTION, Task, refused};
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "cascade",
    benches: |sizes| {
        let config = CascadeConfig::new(32, vec![26, 31, 38, 62]).map_err(refused)?;
        Ok(one(CascadeBlock::new(config, &sizes.prefix)))
    },
    small: || {
        let config = CascadeConfig::new(16, vec![7, 3, 12]).map_err(refused)?;
        Ok(small(CascadeBlock::new(config, ""), "16 bits, 3 stages"))
    },
    proofs: || Ok(vec![proof(16, vec![3, 5, 7])?, proof(32, vec![60; 8])?]),
    areas: || {
        Ok(vec![
            area(16, 2, 62, "16 bits, 2 stages, ring 64")?,
            area(32, 4, 62, "32 bits, 4 stages, ring 64")?,
            area(32, 10, 62, "32 bits, 10 stages, ring 64")?,
            area(32, 5, 1000, "32 bits, 5 stages, ring 1024")?,
        ])
    },
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// The cascade of one size.
#[derive(Debug, Clone)]
pub struct CascadeBlock {
    config: CascadeConfig,
    prefix: String,
    instance: String,
}

impl CascadeBlock {
    /// Creates the cascade `PREFIX_cascade`.
    pub fn new(config: CascadeConfig, prefix: &str) -> Self {
        Self {
            prefix: prefix.to_owned(),
            instance: format!("{} stages, {} bits", config.stages(), config.word_bits()),
            config,
        }
    }
}

impl Block for CascadeBlock {
    fn name(&self) -> &str {
        "cascade"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.config, &self.prefix)
    }

    fn top(&self) -> String {
        own_name(&self.prefix, "cascade")
    }

    fn model(&self, seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(Cascade::new(&self.config, seed))
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate(&self.config)
    }

    fn simulated_as(&self) -> Option<String> {
        simulated_as(&self.config)
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(CascadeRandom::new(&self.config, seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(OfSize {
            config: &self.config,
            coverage: CascadeCoverage::default(),
        })
    }
}

/// Coverage of a cascade; the limits of its word depend on the configuration.
struct OfSize<'a> {
    config: &'a CascadeConfig,
    coverage: CascadeCoverage,
}

impl Bins for OfSize<'_> {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.coverage.observe(self.config, clock);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        named(self.coverage.counts())
    }
}

fn proof(word_bits: u32, delays_samples: Vec<u32>) -> Result<Task, Error> {
    let config = CascadeConfig::new(word_bits, delays_samples).map_err(refused)?;
    let macros = [
        ("WORD", word_bits.to_string()),
        ("SUM", config.sum_bits().to_string()),
        ("INDEX", config.stage_index_bits().to_string()),
        ("ADDRESS", config.ring_address_bits().to_string()),
        ("STAGES", config.stages().to_string()),
        ("PASS_CLOCKS", format!("6'd{}", pass_clocks(config.stages()))),
    ];
    let block = (emit(&config, "")?, ports(config.word_bits() as usize));
    let size = format!("{word_bits} bits, {} stages, contents left out", config.stages());
    Ok(Task::new("cascade", &size, INDUCTION, block).properties(&macros, include_str!("cascade.sv")))
}

fn area(word_bits: u32, stages: usize, delay_samples: u32, size: &'static str) -> Result<AreaRow, Error> {
    let config = CascadeConfig::new(word_bits, vec![delay_samples; stages]).map_err(refused)?;
    Ok(AreaRow::new(size, emit(&config, "")?))
}
