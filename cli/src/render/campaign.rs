//! The results of a campaign: a table with a row for each name, the first failures, and the numbers of units.

use crate::style;
use crate::table::Table;
use posicast_flow::campaign::{Document, MergedShards, PartFile, PreparedSimulations, REFUSED, ShardCosts, UnitCounts};
use posicast_flow::text::shell_word;
use posicast_testbench::shard::{MergedRow, UnitResult};
use posicast_testbench::wording::counted;
use serde_json::Value;

/// Number of failures that are shown in words.
const MOST_SHOWN: usize = 5;
/// Number of digits that the verdict shows of a machine's checksum.
const SHOWN_DIGITS: usize = 12;

/// A part of a campaign.
pub(crate) fn part(document: &Document) -> String {
    let file = match &document.file {
        PartFile::None => String::new(),
        PartFile::Written(path) => format!("; written to {}", shell_word(path)),
        PartFile::Finished => "; this shard was finished already and was not run again".to_owned(),
    };
    let (table, failures) = (table(&document.rows), failures(&document.failures));
    format!("{table}{failures}{}{file}\n", counts(document.counts))
}

/// The simulations that were built.
pub(crate) fn prepared(document: &PreparedSimulations) -> String {
    let built = counted(document.simulations as u64, "simulation");
    format!("{built} are built, for {} units\n", document.units)
}

/// All shards of a campaign, with the verdict last.
pub(crate) fn merged(document: &MergedShards) -> String {
    let merged = &document.merged;
    let mut text = table(&merged.rows) + &failures(&merged.failures);
    if let Some(first) = merged.failures.first() {
        let repeat = &document.repeat;
        text += &format!("to repeat the first failure alone: {repeat} --unit {}\n", first.unit);
    }
    let head = &merged.head;
    let machine = head.machine.as_ref().map_or_else(String::new, |machine| {
        let digits: String = machine.sha256.chars().take(SHOWN_DIGITS).collect();
        format!(" of {} (sha256 {digits}…)", machine.name)
    });
    text += &format!("{}\n", costs(&document.costs));
    text += &format!(
        "{} {}{machine}, posicast {}, seed {}: {}\n",
        style::message(if document.passed { "PASS:" } else { "FAIL:" }),
        head.kind,
        head.version,
        head.seed,
        counts(document.counts)
    );
    text
}

/// A sentence about the time that the shards took.
fn costs(costs: &ShardCosts) -> String {
    let ShardCosts {
        shards,
        sum_s,
        longest_s,
        overhead_s,
    } = costs;
    format!(
        "{} of {sum_s:.1} s in all, the longest {longest_s:.1} s; overhead of at most {overhead_s:.2} s each",
        counted(*shards, "shard")
    )
}

/// The numbers of units, of failed and of refused ones.
fn counts(counts: UnitCounts) -> String {
    let refused = match counts.refused {
        0 => String::new(),
        count => format!(", {count} refused"),
    };
    format!(
        "{}, {} failed{refused}",
        counted(counts.units as u64, "unit"),
        counts.failed
    )
}

/// The first failures, one a line.
fn failures(failures: &[UnitResult]) -> String {
    let shown = failures.iter().take(MOST_SHOWN);
    let lines = shown.map(|result| {
        let why = result.failure.as_deref().unwrap_or_default();
        format!("unit {}, {}: {why}\n", result.unit, result.name)
    });
    lines.collect()
}

/// A table with a row for each name, and a column for each figure; the reason of a refused unit is a line below it.
fn table(rows: &[MergedRow]) -> String {
    let mut columns: Vec<&str> = Vec::new();
    for row in rows {
        for name in row.figures.keys().filter(|name| *name != REFUSED) {
            if !columns.contains(&name.as_str()) {
                columns.push(name);
            }
        }
    }
    let headings: Vec<String> = columns.iter().map(|column| format!(">{column}")).collect();
    let headings = ["name", ">units"]
        .into_iter()
        .chain(headings.iter().map(String::as_str));
    let mut table = Table::new(&headings.collect::<Vec<_>>());
    for row in rows {
        let cell = |column: &&str| match row.figures.get(*column) {
            None | Some(Value::Null) => "–".to_owned(),
            Some(Value::String(text)) => text.clone(),
            Some(other) => other.to_string(),
        };
        let cells = columns.iter().map(cell);
        table.row([row.name.clone(), row.units.to_string()].into_iter().chain(cells));
    }
    let refused = rows
        .iter()
        .filter_map(|row| Some((&row.name, row.figures.get(REFUSED)?.as_str()?)));
    let lines = refused.map(|(name, why)| {
        let why: Vec<&str> = why.lines().map(str::trim).collect();
        format!("{name}: {}\n", why.join("; "))
    });
    table.text("") + &lines.collect::<String>()
}
