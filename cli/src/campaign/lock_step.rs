//! `posicast campaign lock-step`: the lock step of `verify` over many clocks, each unit with a seed of its own.

use super::{Outcome, Part, Units, figures, hash_of, row_name, run_part};
use crate::bench::{self, Simulator};
use crate::failure::Failure;
use crate::output;
use crate::progress;
use crate::verify::{DEFAULT_SEED, Job};
use posicast_testbench::blocks::{self, Block, Sources};
use posicast_testbench::shard::MachineFileHash;
use posicast_testbench::wording::counted;
use serde_json::{Map, Value};
use std::path::PathBuf;
use std::time::Instant;

/// Compare the Verilog of a machine with its model in every clock, over many seeds
#[derive(clap::Args)]
pub(super) struct Args {
    /// Machine file, or a folder that `generate` or `run` wrote
    source: PathBuf,
    /// Only the blocks of this name, such as pulse_counter; may be given several times
    #[arg(long = "block", value_name = "NAME")]
    blocks: Vec<String>,
    /// Clocks to compare in every row, in whole units
    #[arg(long, default_value_t = 100_000_000, value_parser = crate::bench::clocks)]
    clocks: u64,
    /// Clocks of a unit; more where it takes more to see every tap, bank and flag
    #[arg(long, default_value_t = 10_000_000, value_parser = crate::bench::clocks)]
    unit_clocks: u64,
    /// Let the simulation alone judge Verilog of the folder that was edited
    #[arg(long)]
    edited: bool,
    /// Build the simulations and do nothing else, so that the shards find them built
    #[arg(long, conflicts_with_all = ["shard", "unit", "json"])]
    prepare: bool,
    #[command(flatten)]
    part: Part,
}

pub(super) fn run(args: &Args, started: Instant) -> Result<(), Failure> {
    let campaign = LockStep::new(args)?;
    match args.prepare {
        true => campaign.prepare(),
        false => run_part(&campaign, &args.part, started),
    }
}

struct LockStep {
    machine: MachineFileHash,
    rows: Vec<(Box<dyn Block>, Sources)>,
    names: Vec<String>,
    unit_clocks: u64,
    units_per_row: u64,
}

impl LockStep {
    fn new(args: &Args) -> Result<Self, Failure> {
        let job = Job::new(&args.source, &args.blocks, args.edited)?;
        if let Some(text) = job.folder_fails() {
            output::say(text.trim_end());
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
        let unit_clocks = args.unit_clocks.max(least);
        Ok(Self {
            machine: MachineFileHash {
                name,
                sha256: hash_of(texts.iter().map(Vec::as_slice)),
            },
            names: rows.iter().map(|(block, _)| row_name(block.as_ref())).collect(),
            rows,
            unit_clocks,
            units_per_row: args.clocks.div_ceil(unit_clocks).max(1),
        })
    }

    /// The row of a unit, and the number of the unit among those of the row. Neighbours are of different rows, so that each shard has
    /// some of each.
    fn place(&self, unit: u64) -> (usize, u64) {
        let rows = self.rows.len() as u64;
        ((unit % rows) as usize, unit / rows)
    }

    fn prepare(&self) -> Result<(), Failure> {
        self.require_tools()?;
        let bar = progress::bar("building", self.rows.len() as u64);
        for ((block, sources), name) in self.rows.iter().zip(&self.names) {
            bar.set_message(format!("building {name}"));
            sources
                .verilated(block.as_ref(), DEFAULT_SEED)
                .map_err(bench::failure)?;
            bar.inc(1);
        }
        bar.finish_and_clear();
        let built = counted(self.rows.len() as u64, "simulation");
        output::print(&format!("{built} are built, for {} units\n", self.count()))
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

    fn run(&self, unit: u64, seed: u64) -> Result<Outcome, Failure> {
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
        Ok(Outcome {
            figures: figures([("clocks", report.cycles), ("mismatches", report.mismatches())]),
            failure,
        })
    }
}
