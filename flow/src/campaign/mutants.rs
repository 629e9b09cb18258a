//! `posicast campaign mutants`: mutants of the blocks, some mutants of one block per unit.

use super::{UnitOutcome, Units, figures, only_blocks};
use crate::bench;
use crate::failure::Failure;
use crate::verilog::scratch_folder;
use posicast_ladder::mutation::{self, MutationOptions, MutationRow, Subject};
use posicast_testbench::shard::MachineFileHash;
use posicast_testbench::{formal, verilator};
use serde_json::{Map, Value};

/// The mutants that lock step or proofs must detect.
#[derive(Debug, Clone)]
pub struct MutantOptions {
    /// Only the blocks of these names; all without any.
    pub blocks: Vec<String>,
    /// Number of mutants of each block, in whole units; a block with fewer places for them has fewer.
    pub mutants: u64,
}

/// Number of mutants of a unit: most blocks take seconds for them, the largest minutes.
const UNIT_MUTANTS: u64 = 10;

struct Mutants {
    subjects: Vec<Subject>,
    units_per_block: u64,
}

pub(super) fn of(options: &MutantOptions) -> Result<impl Units + use<>, Failure> {
    let mut subjects = mutation::all().map_err(bench::failure)?;
    only_blocks(&mut subjects, &options.blocks, |subject| subject.block().name())?;
    Ok(Mutants {
        subjects,
        units_per_block: options.mutants.div_ceil(UNIT_MUTANTS),
    })
}

impl Mutants {
    fn subject(&self, unit: u64) -> &Subject {
        &self.subjects[(unit % self.subjects.len() as u64) as usize]
    }
}

impl Units for Mutants {
    fn kind(&self) -> &'static str {
        "mutants"
    }

    fn machine(&self) -> Option<MachineFileHash> {
        None
    }

    fn options(&self) -> Map<String, Value> {
        let of_subject = |subject: &Subject| Value::from(format!("{} {}", subject.block().name(), subject.size()));
        let mut options = figures([
            ("unit_mutants", UNIT_MUTANTS),
            ("units_per_block", self.units_per_block),
        ]);
        let blocks = self.subjects.iter().map(of_subject).collect();
        options.insert("blocks".to_owned(), Value::Array(blocks));
        options
    }

    fn count(&self) -> u64 {
        self.units_per_block.saturating_mul(self.subjects.len() as u64)
    }

    fn name(&self, unit: u64) -> String {
        let subject = self.subject(unit);
        format!("{}, {}", subject.block().name(), subject.size())
    }

    fn require_tools(&self) -> Result<(), Failure> {
        bench::require_installed(verilator::missing_tools().into_iter().chain(formal::missing_tools()))
    }

    fn run(&self, unit: u64, seed: u64) -> Result<UnitOutcome, Failure> {
        let options = MutationOptions {
            mutants: UNIT_MUTANTS as usize,
            seed: seed.wrapping_add(unit / self.subjects.len() as u64),
            ..MutationOptions::default()
        };
        let folder = scratch_folder()?;
        let subject = self.subject(unit);
        let fates = mutation::run(subject, &options, &folder.path().join("work")).map_err(bench::failure)?;
        let row = MutationRow::new(subject, &fates);
        let counts = [
            ("mutants", row.mutants),
            ("lock step", row.lockstep),
            ("property", row.property),
            ("equivalent", row.equivalent),
            ("unknown", row.unknown.len()),
        ];
        Ok(UnitOutcome {
            figures: figures(counts.map(|(name, count)| (name, count as u64))),
            failure: (!row.unknown.is_empty())
                .then(|| format!("neither detected nor equivalent: {}", row.unknown.join("; "))),
        })
    }
}
