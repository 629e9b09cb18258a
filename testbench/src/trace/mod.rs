//! The bench of `trace`.

pub(crate) mod stimuli;
mod trials;

pub use self::stimuli::{TraceCoverage, TraceRandom};

use posicast_blocks::ClockedBlock;
use posicast_blocks::trace::{SIGNALS, Trace, TraceConfig, ports};
use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module};
use posicast_hdl::trace::{emit, simulate, simulated_as};

use crate::Error;
use crate::blocks::registry::{AreaRow, RegistryRow, one, small};
use crate::blocks::{Bins, Block};
use crate::formal::{INDUCTION, Task, refused};
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "trace",
    benches: |sizes| {
        let config = TraceConfig::new(1024).map_err(refused)?;
        Ok(one(TraceBlock::new(config, &sizes.prefix)))
    },
    small: || {
        let config = TraceConfig::new(256).map_err(refused)?;
        Ok(small(TraceBlock::new(config, ""), "256 samples"))
    },
    // These are the smallest and the largest memory.
    proofs: || [256, 2048].map(proof).into_iter().collect(),
    areas: || {
        let modules = emit(&TraceConfig::new(1024).map_err(refused)?, "")?;
        let row = AreaRow::new("1024 samples", modules);
        Ok(vec![row.note(
            "320 LUT select one of 16 signals of 32 bits; signals that are tied disappear.",
        )])
    },
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// The trace memory of one size.
#[derive(Debug, Clone)]
pub struct TraceBlock {
    config: TraceConfig,
    prefix: String,
    instance: String,
}

impl TraceBlock {
    /// Creates the trace memory `PREFIX_trace`.
    pub fn new(config: TraceConfig, prefix: &str) -> Self {
        Self {
            config,
            prefix: prefix.to_owned(),
            instance: format!("{} samples", config.samples()),
        }
    }
}

impl TraceBlock {
    /// Renames the block to `instance` in the report.
    pub fn called(self, instance: &str) -> Self {
        Self {
            instance: instance.to_owned(),
            ..self
        }
    }
}

impl Block for TraceBlock {
    fn name(&self) -> &str {
        "trace"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.config, &self.prefix)
    }

    fn top(&self) -> String {
        posicast_hdl::trace::name(&self.config, &self.prefix)
    }

    fn model(&self, _seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(Trace::new(&self.config))
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate(&self.config)
    }

    fn simulated_as(&self) -> Option<String> {
        simulated_as(&self.config)
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(TraceRandom::new(&self.config, seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(TraceCoverage::new(&self.config))
    }
}

impl Bins for TraceCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        self.counts().map(|(name, count)| (name.to_owned(), count)).collect()
    }
}

fn proof(samples: u64) -> Result<Task, Error> {
    let config = TraceConfig::new(samples).map_err(refused)?;
    let signals: Vec<String> = (0..SIGNALS).rev().map(|signal| format!("signal_{signal}")).collect();
    let macros = [
        ("SAMPLES", format!("12'd{samples}")),
        ("ADDRESS_BITS", config.address_bits().to_string()),
        ("ALL_SIGNALS", format!("{{{}}}", signals.join(", "))),
    ];
    let block = (emit(&config, "")?, ports());
    Ok(Task::new("trace", &format!("{samples} words"), INDUCTION, block).properties(&macros, include_str!("trace.sv")))
}
