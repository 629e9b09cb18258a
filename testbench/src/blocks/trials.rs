//! What the tests of a block take from its row: the sizes that they compare, and faults that must be found.

use super::Block;
use super::registry::RegistryRow;
use crate::{Error, REGISTRY};

/// A block at a size that the tests compare, in a million clocks per seed.
pub struct Trial {
    /// The block.
    pub block: Box<dyn Block>,
    /// Its size, or empty if the tests compare one only.
    pub size: &'static str,
    /// Seeds of the runs.
    pub seeds: &'static [u64],
    /// Smallest count of each case that a run must reach.
    pub least: u64,
    /// Cases that it must reach more than 20 times.
    pub often: &'static [&'static str],
    /// Whether only `scripts/verify-all` compares this size.
    pub long: bool,
}

impl Trial {
    /// Creates it without a size.
    pub(crate) fn new(block: impl Block + 'static, seeds: &'static [u64], least: u64) -> Self {
        Self {
            block: Box::new(block),
            size: "",
            seeds,
            least,
            often: &[],
            long: false,
        }
    }

    /// The seed that `scripts/test` runs, if any, and those that only `scripts/verify-all` runs.
    pub fn short_and_long_seeds(&self) -> (&'static [u64], &'static [u64]) {
        self.seeds.split_at(usize::from(!self.long))
    }

    pub(crate) fn long(self) -> Self {
        Self { long: true, ..self }
    }

    pub(crate) fn size(self, size: &'static str) -> Self {
        Self { size, ..self }
    }

    pub(crate) fn often(self, often: &'static [&'static str]) -> Self {
        Self { often, ..self }
    }
}

/// A fault in a block's Verilog: the first `from` is replaced by `to`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BlockMutant {
    /// The fault in words, which follow "the stimuli find".
    pub name: &'static str,
    /// Size of the trial that gets it; empty for the first.
    pub size: &'static str,
    /// Text of the Verilog.
    pub from: &'static str,
    /// Text that replaces `from`.
    pub to: &'static str,
    /// Number of clocks in which the stimuli must find it.
    pub clocks: u64,
}

impl BlockMutant {
    /// Creates a fault that is found within 300,000 clocks of the first trial.
    pub(crate) const fn new(name: &'static str, from: &'static str, to: &'static str) -> Self {
        Self {
            name,
            size: "",
            from,
            to,
            clocks: 300_000,
        }
    }

    pub(crate) const fn of(self, size: &'static str) -> Self {
        Self { size, ..self }
    }

    pub(crate) const fn within(self, clocks: u64) -> Self {
        Self { clocks, ..self }
    }
}

/// A fault in a block's Verilog with which a proof must fail: the first `from` is replaced by `to`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ProofMutant {
    /// The fault in words.
    pub name: &'static str,
    /// Property file of the proof, the first one that uses it; empty if it has the block's name.
    pub properties: &'static str,
    /// Text of the Verilog.
    pub from: &'static str,
    /// Text that replaces `from`.
    pub to: &'static str,
    /// Beginning of the name of the property that a counterexample must violate; it may be empty. `None` if every counterexample is
    /// further from the reset than the search goes: then the proof only must not succeed.
    pub violated: Option<&'static str>,
}

impl ProofMutant {
    /// Creates a fault with which the proof of the block's own property file does not succeed.
    pub(crate) const fn new(name: &'static str, from: &'static str, to: &'static str) -> Self {
        Self {
            name,
            properties: "",
            from,
            to,
            violated: None,
        }
    }

    /// Name of the property file, for a fault of this block.
    pub fn file(&self, block: &'static str) -> &'static str {
        if self.properties.is_empty() {
            block
        } else {
            self.properties
        }
    }

    pub(crate) const fn of(self, properties: &'static str) -> Self {
        Self { properties, ..self }
    }

    pub(crate) const fn violates(self, property: &'static str) -> Self {
        Self {
            violated: Some(property),
            ..self
        }
    }
}

/// The tests of a kind of block.
pub struct BlockTrials {
    /// The block's name.
    pub name: &'static str,
    /// Its sizes.
    pub trials: Vec<Trial>,
    /// Its faults.
    pub mutants: &'static [BlockMutant],
    /// The faults with which its proofs must fail.
    pub proof_mutants: &'static [ProofMutant],
}

/// Returns the tests of every kind of block.
///
/// # Errors
/// As [`benches`](super::benches).
pub fn trials() -> Result<Vec<BlockTrials>, Error> {
    let of_row = |row: &RegistryRow| {
        Ok(BlockTrials {
            name: row.name,
            trials: (row.trials)()?,
            mutants: row.mutants,
            proof_mutants: row.proof_mutants,
        })
    };
    REGISTRY.iter().map(of_row).collect()
}
