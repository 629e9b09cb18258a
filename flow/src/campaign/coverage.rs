//! `posicast campaign coverage`: which lines, nets and bins of each block the lock step reaches, one block per unit.

use super::{UnitOutcome, Units, figures, only_blocks, row_name};
use crate::bench;
use crate::failure::Failure;
use posicast_ladder::coverage::explanation::{self, Explanation};
use posicast_ladder::coverage::{self, CLOCKS, Share};
use posicast_testbench::blocks::Block;
use posicast_testbench::shard::MachineFileHash;
use posicast_testbench::verilator;
use serde_json::{Map, Value};

/// The blocks whose reached lines, nets and bins are measured.
#[derive(Debug, Clone)]
pub struct CoverageOptions {
    /// Only the blocks of these names; all without any.
    pub blocks: Vec<String>,
}

struct Coverage {
    blocks: Vec<Box<dyn Block>>,
    explanations: Vec<Explanation>,
}

pub(super) fn of(options: &CoverageOptions) -> Result<impl Units + use<>, Failure> {
    let mut blocks = coverage::subjects().map_err(bench::failure)?;
    only_blocks(&mut blocks, &options.blocks, |block| block.name())?;
    Ok(Coverage {
        blocks,
        explanations: explanation::all().map_err(bench::failure)?,
    })
}

impl Coverage {
    fn block(&self, unit: u64) -> &dyn Block {
        self.blocks[unit as usize].as_ref()
    }
}

impl Units for Coverage {
    fn kind(&self) -> &'static str {
        "coverage"
    }

    fn machine(&self) -> Option<MachineFileHash> {
        None
    }

    fn options(&self) -> Map<String, Value> {
        figures([("clocks", CLOCKS.into()), ("blocks", self.names())])
    }

    fn count(&self) -> u64 {
        self.blocks.len() as u64
    }

    fn name(&self, unit: u64) -> String {
        row_name(self.block(unit))
    }

    fn require_tools(&self) -> Result<(), Failure> {
        bench::require_installed(verilator::missing_tools())
    }

    /// The explanations of unreached places apply to the seed of the ladder, so the seed of the campaign is not used.
    fn run(&self, unit: u64, _seed: u64) -> Result<UnitOutcome, Failure> {
        let measured = coverage::measure(self.block(unit), CLOCKS).map_err(bench::failure)?;
        let of = |share: &Share| format!("{} of {}", share.reached, share.all);
        Ok(UnitOutcome {
            figures: figures([
                ("lines", of(&measured.lines)),
                ("toggles", of(&measured.toggles)),
                ("conditions", of(&measured.conditions)),
                ("bins", of(&measured.bins)),
            ]),
            failure: measured.problems(&self.explanations).into_iter().next(),
        })
    }
}
