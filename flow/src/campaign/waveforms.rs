//! `posicast campaign waveforms`: compares randomly damaged recordings, a hundred per unit.

use super::{UnitOutcome, Units, case_seeds, figures, hash_of};
use crate::failure::Failure;
use crate::verilog::scratch_folder;
use posicast_testbench::shard::MachineFileHash;
use serde_json::{Map, Value};
use std::path::PathBuf;
use wavecmp::damage::{self, Survival};

/// The recordings that are damaged at random; comparing them must neither panic nor give a wrong result.
#[derive(Debug, Clone)]
pub struct WaveformOptions {
    /// Small recordings, VCD or FST; each case damages one of them.
    pub recordings: Vec<PathBuf>,
    /// Number of damaged recordings, in whole units.
    pub cases: u64,
}

/// Number of cases of a unit: about a second.
const UNIT_CASES: u64 = 100;

struct Waveforms {
    recordings: Vec<Vec<u8>>,
    units: u64,
}

pub(super) fn of(options: &WaveformOptions) -> Result<impl Units + use<>, Failure> {
    let read = |path: &PathBuf| {
        std::fs::read(path).map_err(|cause| {
            Failure::input(format!("{}: cannot read it: {cause}", path.display()))
                .with_help("name recordings that exist, VCD or FST")
        })
    };
    Ok(Waveforms {
        recordings: options.recordings.iter().map(read).collect::<Result<_, _>>()?,
        units: options.cases.div_ceil(UNIT_CASES),
    })
}

impl Units for Waveforms {
    fn kind(&self) -> &'static str {
        "waveforms"
    }

    fn machine(&self) -> Option<MachineFileHash> {
        None
    }

    fn options(&self) -> Map<String, Value> {
        figures([
            ("unit_cases", Value::from(UNIT_CASES)),
            (
                "recordings_sha256",
                hash_of(self.recordings.iter().map(Vec::as_slice)).into(),
            ),
        ])
    }

    fn count(&self) -> u64 {
        self.units
    }

    fn name(&self, _unit: u64) -> String {
        "damaged recordings".to_owned()
    }

    fn run(&self, unit: u64, seed: u64) -> Result<UnitOutcome, Failure> {
        let folder = scratch_folder()?;
        let (mut read, mut wrong, mut first) = (0_u64, 0_u64, None);
        for case_seed in case_seeds(seed, unit, UNIT_CASES) {
            match damage::trial(&self.recordings, case_seed, folder.path()) {
                Ok(survival) => read += u64::from(survival == Survival::Read),
                Err(problem) => {
                    wrong += 1;
                    first.get_or_insert_with(|| format!("case {case_seed}: {problem}"));
                }
            }
        }
        Ok(UnitOutcome {
            figures: figures([("cases", UNIT_CASES), ("still read", read), ("wrong", wrong)]),
            failure: first,
        })
    }
}
