//! `posicast campaign merge`: the shards of a campaign as one result.

use super::document::{MergedShards, ShardCosts, UnitCounts, problem};
use crate::Outcome;
use crate::failure::Failure;
use posicast_testbench::shard::{self, MergeError};
use std::path::Path;

/// Joins the shards of a campaign in a folder that contains no other `*.json` files.
///
/// # Errors
/// [`Failure`] for other files, and for a missing shard.
pub fn merge(folder: &Path) -> Result<Outcome<MergedShards>, Failure> {
    let documents = shard::read_folder(folder).map_err(merge_failure)?;
    let costs = ShardCosts::of(documents.iter().map(|(_, document)| document));
    let repeat = documents
        .first()
        .map_or_else(String::new, |(_, document)| document.repeat.clone());
    let merged = shard::merge(documents).map_err(merge_failure)?;
    let failed = problem(&merged.results, true);
    let document = MergedShards {
        counts: UnitCounts::of(&merged.results),
        merged,
        costs,
        repeat,
        passed: failed.is_none(),
    };
    Ok(Outcome {
        failed,
        ..Outcome::passed(document)
    })
}

/// A missing shard is a failed check; other files are bad input.
fn merge_failure(error: MergeError) -> Failure {
    match error {
        MergeError::Missing { .. } => Failure::Check(format!("no verdict: {error}; run them, then merge again")),
        MergeError::Empty(_) => Failure::input(error.to_string())
            .with_help("name the folder into which the shards were written with --json"),
        _ => Failure::because(error),
    }
}
