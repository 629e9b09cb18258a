//! The file of a shard.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use posicast_system::output;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::Shard;

/// Version of the format of the files.
pub const FORMAT: u32 = 1;

/// Settings that all shards of a campaign share.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CampaignHead {
    /// Version of the files' format, [`FORMAT`].
    pub posicast_campaign: u32,
    /// The program's version, with its commit.
    pub version: String,
    /// Kind of campaign: `lock-step`, `faults`, `mutants`, `sweep`.
    pub kind: String,
    /// The machine, for a campaign about one.
    pub machine: Option<MachineFileHash>,
    /// Seed of the campaign; that of a unit follows from it.
    pub seed: u64,
    /// Options that determine the units, by name.
    pub options: Map<String, Value>,
    /// Number of units of the whole campaign.
    pub units: u64,
}

/// A machine file, by its contents.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct MachineFileHash {
    /// Name of the machine.
    pub name: String,
    /// SHA-256 of the file, in hexadecimal digits.
    pub sha256: String,
}

/// Result of a unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct UnitResult {
    /// Number of the unit, from 0.
    pub unit: u64,
    /// Name of the subject. Units with the same name form one row of the table, which adds their numbers.
    pub name: String,
    /// Figures by the names of their columns: numbers, and texts for what is the same in all units of the name.
    pub figures: Map<String, Value>,
    /// Description of the failure; `None` if the unit passed.
    pub failure: Option<String>,
}

/// The file of a shard.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShardDocument {
    /// The campaign.
    #[serde(flatten)]
    pub head: CampaignHead,
    /// Part of the campaign.
    pub shard: Shard,
    /// Command that runs a single unit N when `--unit N` is appended.
    pub repeat: String,
    /// Duration of the units in seconds.
    pub seconds: f64,
    /// Duration of all else, such as reading the machine, in seconds.
    pub overhead_seconds: f64,
    /// Results of its units, in their order.
    pub results: Vec<UnitResult>,
}

/// Reason why a file is not usable as that of a shard.
#[derive(Debug, thiserror::Error)]
pub enum DocumentError {
    /// It cannot be read or written.
    #[error("{}: cannot {doing}: {cause}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The attempted action.
        doing: &'static str,
        /// Why it failed.
        cause: std::io::Error,
    },
    /// It is not as it was written: its checksum does not fit, or it has none.
    #[error(
        "{}: was changed since this shard was written: its checksum does not fit. Remove the file and run the shard again",
        path.display()
    )]
    Changed {
        /// The file.
        path: PathBuf,
    },
    /// Its contents are something else.
    #[error("{}: is not the file of a shard that this posicast reads: {reason}", path.display())]
    Other {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
}

impl ShardDocument {
    /// Reads a file; `None` if it does not exist.
    ///
    /// # Errors
    /// [`DocumentError`] for a file that cannot be read, has other contents, or was changed since it was written.
    pub fn read(path: &Path) -> Result<Option<Self>, DocumentError> {
        let text = match std::fs::read(path) {
            Err(cause) if cause.kind() == ErrorKind::NotFound => return Ok(None),
            text => text.map_err(|cause| of_file(path, "read it", cause))?,
        };
        let other = |reason: String| DocumentError::Other {
            path: path.to_owned(),
            reason,
        };
        let document: Self = serde_json::from_slice(&text).map_err(|error| other(error.to_string()))?;
        match document.head.posicast_campaign {
            FORMAT => {}
            format => return Err(other(format!("its format is {format}, not {FORMAT}"))),
        }
        if output::is_ours(path).map_err(|cause| of_file(path, "read it", cause))? {
            Ok(Some(document))
        } else {
            Err(DocumentError::Changed { path: path.to_owned() })
        }
    }

    /// Writes the file atomically: it never exists in part.
    ///
    /// # Errors
    /// [`DocumentError::File`].
    pub fn write(&self, path: &Path) -> Result<(), DocumentError> {
        let cannot = |cause| of_file(path, "write it", cause);
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(cannot)?;
        }
        let text = serde_json::to_string_pretty(self).map_err(|error| cannot(error.into()))?;
        output::write_text(path, &(text + "\n")).map_err(cannot)
    }
}

pub(super) fn of_file(path: &Path, doing: &'static str, cause: std::io::Error) -> DocumentError {
    DocumentError::File {
        path: path.to_owned(),
        doing,
        cause,
    }
}
