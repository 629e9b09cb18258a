//! The bench of `linear_scale`.

pub(crate) mod stimuli;
mod trials;

pub use self::stimuli::{LinearScaleCoverage, LinearScaleRandom};

use posicast_blocks::ClockedBlock;
use posicast_blocks::linear_scale::{LinearScale, ports};
use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module, shared_name};
use posicast_hdl::linear_scale::{emit, simulate};

use crate::Error;
use crate::blocks::registry::{AreaRow, RegistryRow, one, small};
use crate::blocks::{Bins, Block, named};
use crate::formal::{INDUCTION, Task, part};
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "linear_scale",
    benches: |sizes| Ok(one(LinearScaleBlock::new(&sizes.prefix, "alone"))),
    small: || Ok(small(LinearScaleBlock::new("", "alone"), "nothing tied")),
    proofs: || {
        let task = Task::new("linear_scale", "all ratios", INDUCTION, (emit("")?, ports()));
        let whole = task.properties(&[], include_str!("linear_scale.sv"));
        let parts = [1, 0, 16, 31].map(serial_ratio);
        std::iter::once(Ok(whole)).chain(parts).collect()
    },
    areas: || {
        Ok(vec![AreaRow::new("nothing tied", emit("")?).note(
            "With the machine's constants tied, it takes 269 LE with the loop on the scale, and 194 as a \
                 monitor. It has six registers of 32 bits.",
        )])
    },
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// The linear scale, which has one size.
#[derive(Debug, Clone)]
pub struct LinearScaleBlock {
    prefix: String,
    instance: String,
}

impl LinearScaleBlock {
    /// Creates the linear scale `PREFIX_linear_scale`; `instance` names the axes that it serves.
    pub fn new(prefix: &str, instance: &str) -> Self {
        Self {
            prefix: prefix.to_owned(),
            instance: instance.to_owned(),
        }
    }
}

impl Block for LinearScaleBlock {
    fn name(&self) -> &str {
        "linear_scale"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.prefix)
    }

    fn top(&self) -> String {
        shared_name(&self.prefix, "linear_scale")
    }

    fn model(&self, _seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(LinearScale::new())
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate()
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(LinearScaleRandom::new(seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(LinearScaleCoverage::default())
    }
}

impl Bins for LinearScaleCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        named(self.counts())
    }
}

/// Creates the proof of the arithmetic, on the module that computes it.
fn serial_ratio(shift: u32) -> Result<Task, Error> {
    let block = part(emit("")?, "serial_ratio")?;
    let size = format!("all mantissas, 2^-{shift}");
    Ok(Task::new("serial_ratio", &size, INDUCTION, block)
        .properties(&[("SHIFT", format!("5'd{shift}"))], include_str!("serial_ratio.sv")))
}
