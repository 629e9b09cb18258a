//! `posicast campaign merge`: the shards of a campaign as one result.

use super::{MOST_SHOWN, counts, of_failure, problem, table};
use crate::Outcome;
use crate::failure::Failure;
use posicast_testbench::shard::{self, MergeError, Merged, ShardDocument};
use posicast_testbench::wording::counted;
use std::path::Path;

/// Joins the shards of a campaign in a folder that contains no other `*.json` files.
///
/// # Errors
/// [`Failure`] for other files, and for a missing shard.
pub fn merge(folder: &Path) -> Result<Outcome<Merged>, Failure> {
    let documents = shard::read_folder(folder).map_err(merge_failure)?;
    let costs = costs(documents.iter().map(|(_, document)| document));
    let repeat = documents
        .first()
        .map_or_else(String::new, |(_, document)| document.repeat.clone());
    let merged = shard::merge(documents).map_err(merge_failure)?;
    let text = text(&merged, &costs, &repeat);
    Ok(Outcome {
        failed: problem(&merged.results, true),
        ..Outcome::passed(merged, text)
    })
}

/// Number of digits that the verdict shows of a machine's checksum.
const SHOWN_DIGITS: usize = 12;

/// A missing shard is a failed check; other files are bad input.
fn merge_failure(error: MergeError) -> Failure {
    match error {
        MergeError::Missing { .. } => Failure::Check(format!("no verdict: {error}; run them, then merge again")),
        MergeError::Empty(_) => Failure::input(error.to_string())
            .with_help("name the folder into which the shards were written with --json"),
        _ => Failure::because(error),
    }
}

/// Returns a sentence about the time that the shards took.
fn costs<'a>(documents: impl Iterator<Item = &'a ShardDocument>) -> String {
    let (mut count, mut sum, mut longest, mut overhead) = (0, 0.0, 0.0_f64, 0.0_f64);
    for document in documents {
        count += 1;
        sum += document.seconds;
        longest = longest.max(document.seconds);
        overhead = overhead.max(document.overhead_seconds);
    }
    format!(
        "{} of {sum:.1} s in all, the longest {longest:.1} s; overhead of at most {overhead:.2} s each",
        counted(count, "shard")
    )
}

fn text(merged: &Merged, costs: &str, repeat: &str) -> String {
    let mut text = table(&merged.rows);
    for result in merged.failures.iter().take(MOST_SHOWN) {
        text += &of_failure(result);
    }
    if let Some(first) = merged.failures.first() {
        text += &format!("to repeat the first failure alone: {repeat} --unit {}\n", first.unit);
    }
    let head = &merged.head;
    let machine = head.machine.as_ref().map_or_else(String::new, |machine| {
        let digits: String = machine.sha256.chars().take(SHOWN_DIGITS).collect();
        format!(" of {} (sha256 {digits}…)", machine.name)
    });
    text += &format!("{costs}\n");
    text += &format!(
        "{} {}{machine}, posicast {}, seed {}: {}\n",
        crate::style::message(if problem(&merged.results, true).is_none() {
            "PASS:"
        } else {
            "FAIL:"
        }),
        head.kind,
        head.version,
        head.seed,
        counts(&merged.results)
    );
    text
}
