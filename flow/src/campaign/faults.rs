//! `posicast campaign faults`: the fault campaign of the stage, some cases per unit.

use super::{UnitOutcome, Units, figures};
use crate::failure::Failure;
use posicast_closed_loop::fault_campaign::{self, Bed};
use posicast_testbench::shard::MachineFileHash;
use serde_json::{Map, Value};

/// The faults that are injected into the stage of the example machine.
#[derive(Debug, Clone)]
pub struct FaultOptions {
    /// Number of faults, in whole units.
    pub cases: u64,
}

/// Number of faults of a unit: some seconds.
const UNIT_CASES: u64 = 50;

struct Faults {
    units: u64,
}

pub(super) fn of(options: &FaultOptions) -> impl Units + use<> {
    Faults {
        units: options.cases.div_ceil(UNIT_CASES),
    }
}

impl Units for Faults {
    fn kind(&self) -> &'static str {
        "faults"
    }

    fn machine(&self) -> Option<MachineFileHash> {
        None
    }

    fn options(&self) -> Map<String, Value> {
        figures([("unit_cases", UNIT_CASES)])
    }

    fn count(&self) -> u64 {
        self.units
    }

    fn name(&self, _unit: u64) -> String {
        "faults of a stage".to_owned()
    }

    fn run(&self, unit: u64, seed: u64) -> Result<UnitOutcome, Failure> {
        let bed = Bed::new().map_err(Failure::because)?;
        let cases = unit * UNIT_CASES..(unit + 1) * UNIT_CASES;
        let report = fault_campaign::run(&bed, cases, seed, 1).map_err(Failure::because)?;
        let failed: u64 = report.kinds().iter().map(|kind| kind.failed).sum();
        Ok(UnitOutcome {
            figures: figures([("cases", report.cases()), ("failed", failed)]),
            failure: report.failures().first().cloned(),
        })
    }
}
