//! `posicast campaign identify`: identifies the modes of random machines from their logs, some logs per unit.

use super::{UnitOutcome, Units, case_seeds, figures};
use crate::failure::Failure;
use posicast_identify::trial;
use posicast_testbench::shard::MachineFileHash;
use serde_json::{Map, Value};

/// The logs of random machines whose modes are compared with those of the machines.
#[derive(Debug, Clone)]
pub struct TrialOptions {
    /// Number of logs, in whole units.
    pub logs: u64,
}

/// Number of logs of a unit: a second or two.
const UNIT_LOGS: u64 = 10;

struct Logs {
    units: u64,
}

pub(super) fn of(options: &TrialOptions) -> impl Units + use<> {
    Logs {
        units: options.logs.div_ceil(UNIT_LOGS),
    }
}

impl Units for Logs {
    fn kind(&self) -> &'static str {
        "identify"
    }

    fn machine(&self) -> Option<MachineFileHash> {
        None
    }

    fn options(&self) -> Map<String, Value> {
        figures([("unit_logs", UNIT_LOGS)])
    }

    fn count(&self) -> u64 {
        self.units
    }

    fn name(&self, _unit: u64) -> String {
        "logs of random machines".to_owned()
    }

    fn run(&self, unit: u64, seed: u64) -> Result<UnitOutcome, Failure> {
        let report = trial::run(case_seeds(seed, unit, UNIT_LOGS));
        Ok(UnitOutcome {
            figures: figures([
                ("logs", report.logs),
                ("modes", report.modes),
                ("frequencies within", report.frequencies_held),
                ("dampings within", report.dampings_held),
                ("wrong", report.wrong.len() as u64),
            ]),
            failure: report.wrong.first().cloned(),
        })
    }
}
