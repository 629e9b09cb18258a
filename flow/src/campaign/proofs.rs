//! `posicast campaign proofs`: proves the property files of the blocks, one proof per unit.

use super::{UnitOutcome, Units, figures, only_blocks};
use crate::bench;
use crate::failure::Failure;
use crate::verilog::scratch_folder;
use posicast_testbench::blocks;
use posicast_testbench::formal::{self, ProofVerdict, Task};
use posicast_testbench::shard::MachineFileHash;
use serde_json::{Map, Value};
use std::time::Duration;

/// The blocks whose properties are proven.
#[derive(Debug, Clone)]
pub struct ProofOptions {
    /// Only the properties of the blocks of these names; all without any.
    pub blocks: Vec<String>,
}

/// Time limit of each run of an engine.
const LIMIT: Duration = Duration::from_secs(900);

struct Proofs {
    tasks: Vec<Task>,
}

pub(super) fn of(options: &ProofOptions) -> Result<impl Units + use<>, Failure> {
    let mut tasks = blocks::proofs().map_err(bench::failure)?;
    only_blocks(&mut tasks, &options.blocks, |task| task.name)?;
    Ok(Proofs { tasks })
}

impl Proofs {
    fn task(&self, unit: u64) -> &Task {
        &self.tasks[unit as usize]
    }
}

impl Units for Proofs {
    fn kind(&self) -> &'static str {
        "proofs"
    }

    fn machine(&self) -> Option<MachineFileHash> {
        None
    }

    fn options(&self) -> Map<String, Value> {
        figures([("proofs", self.names())])
    }

    fn count(&self) -> u64 {
        self.tasks.len() as u64
    }

    fn name(&self, unit: u64) -> String {
        let task = self.task(unit);
        format!("{}, {}, {}", task.name, task.size, task.engine.name())
    }

    fn require_tools(&self) -> Result<(), Failure> {
        bench::require_installed(formal::missing_tools())
    }

    /// A proof does not depend on the seed.
    fn run(&self, unit: u64, _seed: u64) -> Result<UnitOutcome, Failure> {
        let folder = scratch_folder()?;
        let outcome = formal::run(self.task(unit), &folder.path().join("proof"), LIMIT).map_err(bench::failure)?;
        let missed: Vec<&str> = outcome
            .covers
            .iter()
            .filter(|cover| cover.clock.is_none())
            .map(|cover| cover.name.as_str())
            .collect();
        let failure = match &outcome.verdict {
            ProofVerdict::Counterexample { property, clock, .. } => {
                Some(format!("`{property}` fails in clock {clock}"))
            }
            ProofVerdict::Unknown => Some("neither proven nor refuted within the time limit".to_owned()),
            ProofVerdict::Proven if missed.is_empty() => None,
            ProofVerdict::Proven => Some(format!("covers that are not reached: {}", missed.join(", "))),
        };
        let reached = outcome.covers.len() - missed.len();
        Ok(UnitOutcome {
            figures: figures([
                ("properties", outcome.assertions as u64),
                ("covers reached", reached as u64),
            ]),
            failure,
        })
    }
}
