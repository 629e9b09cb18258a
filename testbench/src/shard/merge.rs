//! The results of all shards of a campaign as one.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Map, Number, Value};

use super::Shard;
use super::document::{CampaignHead, DocumentError, ShardDocument, UnitResult, of_file};

/// Number of missing shards that an error names.
const MOST_NAMED: usize = 10;

/// Why shards are not a whole campaign.
#[derive(Debug, thiserror::Error)]
pub enum MergeError {
    /// A file is not that of a shard.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// The folder has no file of a shard.
    #[error("{}: no file of a shard (*.json) is in this folder", .0.display())]
    Empty(PathBuf),
    /// Two files are of different campaigns.
    #[error("{} is of another campaign than {}: {what}", path.display(), first.display())]
    Unlike {
        /// The file.
        path: PathBuf,
        /// The first file.
        first: PathBuf,
        /// The difference.
        what: String,
    },
    /// A shard is there twice.
    #[error("shard {shard} is there twice: {} and {}", first.display(), second.display())]
    Doubled {
        /// The shard.
        shard: Shard,
        /// A file of it.
        first: PathBuf,
        /// Another.
        second: PathBuf,
    },
    /// Shards are missing.
    #[error("{count} of {of} shards are missing: {named}")]
    Missing {
        /// Number of missing shards.
        count: u64,
        /// Number of shards of the campaign.
        of: u64,
        /// Names of the first missing ones.
        named: String,
    },
    /// A shard's results are not those of its units.
    #[error("{}: its results are not those of the units of shard {shard}", path.display())]
    Units {
        /// The file.
        path: PathBuf,
        /// The shard.
        shard: Shard,
    },
}

/// A whole campaign.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Merged {
    /// The campaign.
    #[serde(flatten)]
    pub head: CampaignHead,
    /// One row for each name, with the sums of its figures.
    pub rows: Vec<MergedRow>,
    /// The units that failed, in their order.
    pub failures: Vec<UnitResult>,
    /// Results of all units, in their order.
    pub results: Vec<UnitResult>,
}

/// The units of one name.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MergedRow {
    /// The name.
    pub name: String,
    /// Number of its units.
    pub units: u64,
    /// Sums of the numbers, and the texts.
    pub figures: Map<String, Value>,
}

/// Reads the files `*.json` of a folder, in the order of their names.
///
/// # Errors
/// [`MergeError::Document`] for a file that is not usable, [`MergeError::Empty`] for a folder without files of shards.
pub fn read_folder(folder: &Path) -> Result<Vec<(PathBuf, ShardDocument)>, MergeError> {
    let entries = std::fs::read_dir(folder).map_err(|cause| of_file(folder, "read the folder", cause))?;
    let mut paths = Vec::new();
    for entry in entries {
        let path = entry.map_err(|cause| of_file(folder, "read the folder", cause))?.path();
        // A file that is still being written begins with a dot and has another ending.
        if path.extension().is_some_and(|extension| extension == "json") {
            paths.push(path);
        }
    }
    paths.sort();
    let mut documents = Vec::with_capacity(paths.len());
    for path in paths {
        // If the file was removed in the meantime, its shard counts as missing.
        documents.extend(ShardDocument::read(&path)?.map(|document| (path, document)));
    }
    if documents.is_empty() {
        Err(MergeError::Empty(folder.to_owned()))
    } else {
        Ok(documents)
    }
}

/// Joins the shards of a campaign.
///
/// # Errors
/// [`MergeError`] where they are not the shards of one campaign, each once.
pub fn merge(documents: Vec<(PathBuf, ShardDocument)>) -> Result<Merged, MergeError> {
    let mut shards: BTreeMap<Shard, &PathBuf> = BTreeMap::new();
    let Some((first, of_first)) = documents.first() else {
        return Err(MergeError::Empty(PathBuf::new()));
    };
    let of = of_first.shard.of();
    for (path, document) in &documents {
        if let Some(what) = difference(&of_first.head, &document.head).or_else(|| parts(of, document.shard.of())) {
            return Err(MergeError::Unlike {
                path: path.clone(),
                first: first.clone(),
                what,
            });
        }
        if let Some(earlier) = shards.insert(document.shard, path) {
            return Err(MergeError::Doubled {
                shard: document.shard,
                first: earlier.clone(),
                second: path.clone(),
            });
        }
        let done = document.results.iter().map(|result| result.unit);
        if !done.eq(document.shard.units(document.head.units)) {
            return Err(MergeError::Units {
                path: path.clone(),
                shard: document.shard,
            });
        }
    }
    missing(&shards, of)?;
    let head = of_first.head.clone();
    let mut results: Vec<UnitResult> = documents
        .into_iter()
        .flat_map(|(_, document)| document.results)
        .collect();
    results.sort_by_key(|result| result.unit);
    Ok(Merged {
        head,
        rows: rows(&results),
        failures: results
            .iter()
            .filter(|result| result.failure.is_some())
            .cloned()
            .collect(),
        results,
    })
}

/// The first difference between the heads of two campaigns.
fn difference(first: &CampaignHead, other: &CampaignHead) -> Option<String> {
    let fields = |head: &CampaignHead| match serde_json::to_value(head) {
        Ok(Value::Object(fields)) => fields,
        _ => Map::new(),
    };
    let (first, other) = (fields(first), fields(other));
    let differs = first.iter().find(|(name, value)| other.get(*name) != Some(value));
    differs.map(|(name, value)| {
        let found = other.get(name).unwrap_or(&Value::Null);
        format!("`{name}` is {found}, not {value}")
    })
}

fn parts(first: u64, other: u64) -> Option<String> {
    (first != other).then(|| format!("it is one of {other} shards, not of {first}"))
}

fn missing(shards: &BTreeMap<Shard, &PathBuf>, of: u64) -> Result<(), MergeError> {
    let count = of.saturating_sub(shards.len() as u64);
    if count == 0 {
        return Ok(());
    }
    let all = (1..=of).map(|number| Shard { number, of });
    let absent = all.filter(|shard| !shards.contains_key(shard)).take(MOST_NAMED);
    let mut named = absent.map(String::from).collect::<Vec<_>>().join(", ");
    if count > MOST_NAMED as u64 {
        named.push_str(", …");
    }
    Err(MergeError::Missing { count, of, named })
}

/// Returns one row for each name, in the order in which the names first appear.
pub fn rows(results: &[UnitResult]) -> Vec<MergedRow> {
    let mut rows: Vec<MergedRow> = Vec::new();
    let mut places: BTreeMap<&str, usize> = BTreeMap::new();
    for result in results {
        let place = *places.entry(&result.name).or_insert_with(|| {
            rows.push(MergedRow {
                name: result.name.clone(),
                units: 0,
                figures: Map::new(),
            });
            rows.len() - 1
        });
        let row = &mut rows[place];
        row.units += 1;
        for (name, value) in &result.figures {
            let sum = row
                .figures
                .get(name)
                .map_or_else(|| value.clone(), |sum| added(sum, value));
            row.figures.insert(name.clone(), sum);
        }
    }
    rows
}

/// The sum of two numbers; of other values, the first.
fn added(sum: &Value, value: &Value) -> Value {
    match (sum.as_u64(), value.as_u64(), sum.as_f64(), value.as_f64()) {
        (Some(sum), Some(value), ..) => Value::from(sum.saturating_add(value)),
        (.., Some(sum), Some(value)) => Number::from_f64(sum + value).map_or(Value::Null, Value::Number),
        _ => sum.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shard::FORMAT;

    fn head() -> CampaignHead {
        CampaignHead {
            posicast_campaign: FORMAT,
            version: "1".to_owned(),
            kind: "lock-step".to_owned(),
            machine: None,
            seed: 1,
            options: Map::new(),
            units: 10,
        }
    }

    fn shard(text: &str) -> (PathBuf, ShardDocument) {
        let shard: Shard = text.parse().unwrap();
        let result = |unit| UnitResult {
            unit,
            name: ["pwm", "divider"][unit as usize % 2].to_owned(),
            figures: Map::from_iter([("clocks".to_owned(), Value::from(1000 + unit))]),
            failure: (unit == 7).then(|| "1 mismatch".to_owned()),
        };
        let document = ShardDocument {
            head: head(),
            shard,
            repeat: "posicast campaign".to_owned(),
            seconds: 1.0,
            overhead_seconds: 0.1,
            results: shard.units(10).map(result).collect(),
        };
        (PathBuf::from(text.replace('/', "_")), document)
    }

    fn shards(of: u64) -> Vec<(PathBuf, ShardDocument)> {
        (1..=of).map(|number| shard(&format!("{number}/{of}"))).collect()
    }

    #[test]
    fn the_results_do_not_depend_on_the_number_of_shards() {
        let whole = merge(shards(1)).unwrap();
        for of in [2, 3, 10, 12] {
            let mut parts = shards(of);
            parts.reverse();
            assert_eq!(merge(parts).unwrap(), whole, "{of} shards");
        }
        assert_eq!(whole.failures.len(), 1);
        assert_eq!(whole.failures[0].unit, 7);
        // 1000 + 1002 + … + 1008.
        assert_eq!(whole.rows[0].figures["clocks"], 5020);
        assert_eq!(whole.rows[1].name, "divider");
    }

    #[test]
    fn missing_doubled_and_foreign_shards_are_named() {
        let said = |documents| merge(documents).unwrap_err().to_string();
        let mut lost = shards(3);
        lost.remove(1);
        assert!(said(lost).contains("1 of 3 shards are missing: 2/3"));
        let mut twice = shards(3);
        twice.push((PathBuf::from("copy"), twice[1].1.clone()));
        assert!(said(twice).contains("shard 2/3 is there twice: 2_3 and copy"));
        let mut seed = shards(3);
        seed[2].1.head.seed = 5;
        assert!(said(seed).contains("`seed` is 5, not 1"));
        let mut version = shards(3);
        version[1].1.head.version = "2".to_owned();
        assert!(said(version).contains("`version` is \"2\", not \"1\""));
        let mut mixed = shards(3);
        mixed[0] = shard("1/4");
        assert!(said(mixed).contains("it is one of 3 shards, not of 4"));
        let mut cut = shards(3);
        cut[1].1.results.pop();
        assert!(said(cut).contains("not those of the units of shard 2/3"));
        assert!(matches!(merge(Vec::new()), Err(MergeError::Empty(_))));
    }
}
