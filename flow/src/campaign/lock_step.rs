//! `posicast campaign lock-step`: the lock step of `verify` over many clocks, each unit with a seed of its own.

use super::document::PreparedSimulations;
use super::{UnitOutcome, Units, figures, hash_of, row_name};
use crate::Outcome;
use crate::bench::{self, Simulator};
use crate::failure::Failure;
use crate::observer::Observer;
use crate::verify::{DEFAULT_SEED, Job};
use posicast_testbench::blocks::{self, Block, Sources};
use posicast_testbench::shard::MachineFileHash;
use posicast_testbench::wording::counted;
use serde_json::{Map, Value};
use std::path::PathBuf;

/// The Verilog that is compared with its model in every clock, over many seeds.
#[derive(Debug, Clone)]
pub struct LockStepOptions {
    /// Machine file, or a folder that `generate` or `run` wrote.
    pub source: PathBuf,
    /// Only the blocks of these names, such as `pulse_counter`; all without any.
    pub blocks: Vec<String>,
    /// Clocks to compare in every row, in whole units.
    pub clocks: u64,
    /// Clocks of a unit; more if it takes more to exercise every tap, bank and flag.
    pub unit_clocks: u64,
    /// Whether edited Verilog of the folder is judged by simulation alone.
    pub edited: bool,
}

/// Builds the simulations and does nothing else, so that the shards find them built.
///
/// # Errors
/// [`Failure`] for files that cannot be read or built, and for a missing tool.
pub fn prepare(options: &LockStepOptions, observer: &dyn Observer) -> Result<Outcome<PreparedSimulations>, Failure> {
    LockStep::new(options, observer)?.prepare(observer)
}

pub(super) struct LockStep {
    machine: MachineFileHash,
    rows: Vec<(Box<dyn Block>, Sources)>,
    names: Vec<String>,
    unit_clocks: u64,
    units_per_row: u64,
}

impl LockStep {
    pub(super) fn new(options: &LockStepOptions, observer: &dyn Observer) -> Result<Self, Failure> {
        let job = Job::new(&options.source, &options.blocks, options.edited, observer)?;
        if let Some(text) = job.folder_fails() {
            observer.say(text.trim_end());
            return Err(Failure::Check(
                "the folder is not what posicast generates from its machine file".to_owned(),
            ));
        }
        let (name, rows) = (job.machine.clone(), job.blocks);
        let mut texts = Vec::new();
        for path in rows.iter().flat_map(|(_, sources)| sources.files()) {
            texts.push(std::fs::read(path).map_err(Failure::of_file(path, "read it"))?);
        }
        let least = rows.iter().map(|(block, _)| block.least_clocks()).max().unwrap_or(0);
        let unit_clocks = options.unit_clocks.max(least);
        Ok(Self {
            machine: MachineFileHash {
                name,
                sha256: hash_of(texts.iter().map(Vec::as_slice)),
            },
            names: rows.iter().map(|(block, _)| row_name(block.as_ref())).collect(),
            rows,
            unit_clocks,
            units_per_row: options.clocks.div_ceil(unit_clocks).max(1),
        })
    }

    /// Returns the row of a unit, and the number of the unit within the row. Neighbouring units are of different rows, so that each shard
    /// has
    /// some of each.
    fn place(&self, unit: u64) -> (usize, u64) {
        let rows = self.rows.len() as u64;
        ((unit % rows) as usize, unit / rows)
    }

    fn prepare(&self, observer: &dyn Observer) -> Result<Outcome<PreparedSimulations>, Failure> {
        self.require_tools()?;
        let bar = observer.begin("building", Some(self.rows.len() as u64));
        for ((block, sources), name) in self.rows.iter().zip(&self.names) {
            bar.rename(&format!("building {name}"));
            sources
                .verilated(block.as_ref(), DEFAULT_SEED)
                .map_err(bench::failure)?;
            bar.advance(1);
        }
        let prepared = PreparedSimulations {
            simulations: self.rows.len(),
            units: self.count(),
        };
        Ok(Outcome::passed(prepared))
    }
}

impl Units for LockStep {
    fn kind(&self) -> &'static str {
        "lock-step"
    }

    fn machine(&self) -> Option<MachineFileHash> {
        Some(self.machine.clone())
    }

    fn options(&self) -> Map<String, Value> {
        let rows = self.names.iter().map(|name| Value::from(name.as_str())).collect();
        let mut options = figures([("unit_clocks", self.unit_clocks), ("units_per_row", self.units_per_row)]);
        options.insert("rows".to_owned(), Value::Array(rows));
        options
    }

    fn count(&self) -> u64 {
        self.units_per_row.saturating_mul(self.rows.len() as u64)
    }

    fn name(&self, unit: u64) -> String {
        self.names[self.place(unit).0].clone()
    }

    fn require_tools(&self) -> Result<(), Failure> {
        let rows = self.rows.iter().map(|(block, sources)| (block.as_ref(), sources));
        bench::require_tools(&[(Simulator::Verilator, rows.collect())], false)
    }

    fn run(&self, unit: u64, seed: u64) -> Result<UnitOutcome, Failure> {
        let (row, number) = self.place(unit);
        let (block, sources) = &self.rows[row];
        let seed = blocks::row_seed(block.as_ref(), seed.wrapping_add(number));
        let mut device = Simulator::Verilator
            .device(block.as_ref(), sources, seed)
            .map_err(bench::failure)?;
        let clocks = self.unit_clocks..=self.unit_clocks;
        let report =
            blocks::judge(block.as_ref(), device.as_mut(), clocks, seed, &mut |_| {}).map_err(bench::failure)?;
        let first = report.blocks.iter().find_map(|row| row.first.as_ref());
        let missing = report.not_exercised_names();
        let failure = match (report.mismatches(), first) {
            (0, _) if missing.is_empty() => None,
            (0, _) => Some(format!("not exercised: {}", missing.join(", "))),
            (count, None) => Some(counted(count, "mismatch")),
            (count, Some(first)) => Some(format!("{}, the first: {first}", counted(count, "mismatch"))),
        };
        Ok(UnitOutcome {
            figures: figures([("clocks", report.cycles), ("mismatches", report.mismatches())]),
            failure,
        })
    }
}
