//! The results of a part of a campaign, and of all its parts.

use super::REFUSED;
use posicast_testbench::shard::{self, Merged, MergedRow, ShardDocument, UnitResult};
use posicast_testbench::wording::counted;
use serde::Serialize;
use std::path::PathBuf;

/// The results of a part of a campaign.
#[derive(Debug, Serialize)]
pub struct Document {
    /// The figures of the units, joined by name.
    pub rows: Vec<MergedRow>,
    /// The units that failed.
    pub failures: Vec<UnitResult>,
    /// Numbers of units.
    pub counts: UnitCounts,
    /// Where the results are.
    pub file: PartFile,
}

/// The file of a part's results.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PartFile {
    /// None was asked for.
    None,
    /// It was written.
    Written(PathBuf),
    /// It had the results already, so that nothing was run.
    Finished,
}

/// Numbers of units.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct UnitCounts {
    /// All of them.
    pub units: usize,
    /// Those that failed.
    pub failed: usize,
    /// Those that could not be done, with a reason that is no failure.
    pub refused: usize,
}

/// The simulations that the shards of a lock step find built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct PreparedSimulations {
    /// Number of simulations.
    pub simulations: usize,
    /// Number of units that they are for.
    pub units: u64,
}

/// All shards of a campaign; in JSON the merged results alone, which do not depend on the number of shards.
#[derive(Debug, Serialize)]
#[serde(transparent)]
pub struct MergedShards {
    /// The results.
    pub merged: Merged,
    /// Numbers of units.
    #[serde(skip)]
    pub counts: UnitCounts,
    /// The time that the shards took.
    #[serde(skip)]
    pub costs: ShardCosts,
    /// The command without the options that select a part.
    #[serde(skip)]
    pub repeat: String,
    /// Whether every unit passed.
    #[serde(skip)]
    pub passed: bool,
}

/// The time that the shards of a campaign took.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ShardCosts {
    /// Number of shards.
    pub shards: u64,
    /// Time of all shards.
    pub sum_s: f64,
    /// Time of the longest.
    pub longest_s: f64,
    /// Largest time from the start of a shard to its first unit.
    pub overhead_s: f64,
}

impl Document {
    pub(super) fn new(results: &[UnitResult], file: PartFile) -> Self {
        let failed = results.iter().filter(|result| result.failure.is_some());
        Self {
            rows: shard::rows(results),
            failures: failed.cloned().collect(),
            counts: UnitCounts::of(results),
            file,
        }
    }
}

impl UnitCounts {
    pub(super) fn of(results: &[UnitResult]) -> Self {
        Self {
            units: results.len(),
            failed: results.iter().filter(|result| result.failure.is_some()).count(),
            refused: results.iter().filter(|result| is_refused(result)).count(),
        }
    }
}

impl ShardCosts {
    pub(super) fn of<'a>(documents: impl Iterator<Item = &'a ShardDocument>) -> Self {
        documents.fold(Self::default(), |sum, document| Self {
            shards: sum.shards + 1,
            sum_s: sum.sum_s + document.seconds,
            longest_s: sum.longest_s.max(document.seconds),
            overhead_s: sum.overhead_s.max(document.overhead_seconds),
        })
    }
}

fn is_refused(result: &UnitResult) -> bool {
    result.figures.contains_key(REFUSED)
}

/// Returns why a part of a campaign, or all of it, fails. A part without a unit has checked nothing, nor has a campaign whose units were
/// all refused.
pub(super) fn problem(results: &[UnitResult], are_all: bool) -> Option<String> {
    let failed = UnitCounts::of(results).failed;
    if results.is_empty() {
        Some("no unit was done: this part of the campaign is empty".to_owned())
    } else if are_all && results.iter().all(is_refused) {
        Some("no unit was done: all were refused".to_owned())
    } else {
        (failed > 0).then(|| format!("{failed} of {} failed", counted(results.len() as u64, "unit")))
    }
}
