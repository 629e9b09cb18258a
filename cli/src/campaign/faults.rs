//! `posicast campaign faults`: the fault campaign of the stage, some cases a unit.

use super::{Outcome, Part, Units, figures};
use crate::failure::Failure;
use posicast_testbench::fault_campaign::{self, Bed};
use posicast_testbench::shard::MachineFileHash;
use serde_json::{Map, Value};

/// Inject faults into the stage of the example machine, and check how it reacts
#[derive(clap::Args)]
pub(super) struct Args {
    /// Number of faults, in whole units
    #[arg(long, default_value_t = 10_000, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    cases: u64,
    #[command(flatten)]
    pub(super) part: Part,
}

/// Number of faults of a unit: some seconds.
const UNIT_CASES: u64 = 50;

struct Faults {
    units: u64,
}

pub(super) fn of(args: &Args) -> impl Units + use<> {
    Faults {
        units: args.cases.div_ceil(UNIT_CASES),
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

    fn run(&self, unit: u64, seed: u64) -> Result<Outcome, Failure> {
        let bed = Bed::new().map_err(Failure::because)?;
        let cases = unit * UNIT_CASES..(unit + 1) * UNIT_CASES;
        let report = fault_campaign::run(&bed, cases, seed, 1).map_err(Failure::because)?;
        let failed: u64 = report.kinds().iter().map(|kind| kind.failed).sum();
        Ok(Outcome {
            figures: figures([("cases", report.cases()), ("failed", failed)]),
            failure: report.failures().first().cloned(),
        })
    }
}
