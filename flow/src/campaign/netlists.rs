//! `posicast campaign netlists`: simulates Yosys's netlist of each block and proves it equal to the RTL, one block per
//! unit.

use super::{UnitOutcome, Units, figures, only_blocks, row_name};
use crate::bench;
use crate::failure::Failure;
use crate::synth;
use posicast_ladder::netlist::{self, EquivalenceVerdict, MappedParts, NetlistParts};
use posicast_synth::yosys::{Family, Yosys, YosysError};
use posicast_testbench::blocks::{self, Block, Sources};
use posicast_testbench::shard::MachineFileHash;
use posicast_testbench::wording::counted;
use posicast_testbench::{formal, verilator};
use serde_json::{Map, Value};
use std::time::Duration;

/// The blocks whose netlists are compared with their models and their RTL.
#[derive(Debug, Clone)]
pub struct NetlistOptions {
    /// Only the blocks of these names; all without any.
    pub blocks: Vec<String>,
    /// Number of clocks for which each netlist is simulated, such as 1000000 or 1e6.
    pub clocks: u64,
}

/// Time limit of each engine of a proof.
const LIMIT: Duration = Duration::from_secs(300);

struct Netlists {
    yosys: Yosys,
    blocks: Vec<Box<dyn Block>>,
    clocks: u64,
}

pub(super) fn of(options: &NetlistOptions) -> Result<impl Units + use<>, Failure> {
    let mut blocks = blocks::library().map_err(bench::failure)?;
    // The stage consists of the other blocks.
    blocks.retain(|block| block.name() != "stage");
    only_blocks(&mut blocks, &options.blocks, |block| block.name())?;
    let yosys = Yosys::installed();
    if matches!(yosys, Err(YosysError::Missing(_))) {
        bench::require_installed(verilator::missing_tools().into_iter().chain(formal::missing_tools()))?;
    }
    Ok(Netlists {
        yosys: yosys.map_err(synth::failure)?,
        blocks,
        clocks: options.clocks,
    })
}

impl Netlists {
    fn block(&self, unit: u64) -> &dyn Block {
        self.blocks[unit as usize].as_ref()
    }
}

impl Units for Netlists {
    fn kind(&self) -> &'static str {
        "netlists"
    }

    fn machine(&self) -> Option<MachineFileHash> {
        None
    }

    fn options(&self) -> Map<String, Value> {
        figures([("clocks", self.clocks.into()), ("blocks", self.names())])
    }

    fn count(&self) -> u64 {
        self.blocks.len() as u64
    }

    fn name(&self, unit: u64) -> String {
        row_name(self.block(unit))
    }

    fn require_tools(&self) -> Result<(), Failure> {
        bench::require_installed(verilator::missing_tools().into_iter().chain(formal::missing_tools()))
    }

    fn run(&self, unit: u64, seed: u64) -> Result<UnitOutcome, Failure> {
        let block = self.block(unit);
        let parts = NetlistParts::of(block.modules().map_err(Failure::because)?);
        let written = |modules| Sources::of_modules(modules).map_err(bench::failure);
        let (logic, kept) = (written(&parts.logic)?, written(&parts.kept)?);
        let (files, kept) = (logic.files(), kept.files());
        let made = self.yosys.netlist(files, kept, &block.top(), Family::Cyclone4e);
        let made = made.map_err(synth::failure)?;
        let mapped = MappedParts {
            parts: &parts,
            netlist: &made.verilog,
        };
        let run = (self.clocks, blocks::row_seed(block, seed));
        let outcome = netlist::check(block, mapped, mapped, run, LIMIT).map_err(bench::failure)?;
        let mismatches = outcome.simulated.as_ref().map_or(0, |report| report.mismatches());
        let failure = match (mismatches, outcome.verdict) {
            (0, EquivalenceVerdict::Equivalent) => None,
            (0, EquivalenceVerdict::Different { clock }) => Some(format!("netlist and RTL differ in clock {clock}")),
            (0, EquivalenceVerdict::Unknown) => Some("no proof that netlist and RTL are equal".to_owned()),
            (count, _) => Some(counted(count, "mismatch")),
        };
        let [luts, flip_flops] = [made.luts, made.flip_flops].map(|count| count as u64);
        let clocks = outcome.simulated.map_or(0, |report| report.cycles);
        Ok(UnitOutcome {
            figures: figures([("LUT", luts), ("flip-flops", flip_flops), ("clocks", clocks)]),
            failure,
        })
    }
}
