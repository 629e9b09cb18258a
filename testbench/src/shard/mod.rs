//! Campaigns in parts: a campaign is a list of units of work, and a shard of it does every n-th of them.
//!
//! ```text
//!  units      0  1  2  3  4  5  6  7  8  9 …      each with its own seed, from a fresh start
//!  shard 1/3  ▪        ▪        ▪        ▪   ─► 1.json ─┐
//!  shard 2/3     ▪        ▪        ▪         ─► 2.json ─┼─► merge ─► the results of all units, in their order
//!  shard 3/3        ▪        ▪        ▪      ─► 3.json ─┘
//! ```
//!
//! A unit does not depend on the shard that runs it, so the merged results are the same, byte for byte, for any number of shards; times
//! are in the shards only. A shard's file is written as a whole when the shard is finished. An interrupted shard leaves no file and is
//! run again; a shard that has its file is not.

mod document;
mod merge;

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

pub use self::document::{CampaignHead, DocumentError, FORMAT, MachineFileHash, ShardDocument, UnitResult};
pub use self::merge::{MergeError, Merged, MergedRow, merge, read_folder, rows};

/// A part of a campaign: `3/40` is the third of forty.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Shard {
    number: u64,
    of: u64,
}

impl Shard {
    /// A campaign in one part.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Number of this part, from 1.
    pub fn number(self) -> u64 {
        self.number
    }

    /// Number of parts.
    pub fn of(self) -> u64 {
        self.of
    }

    /// Returns the numbers of the part's units, in a campaign of `all` units.
    pub fn units(self, all: u64) -> impl Iterator<Item = u64> {
        let mut next = Some(self.number - 1);
        std::iter::from_fn(move || {
            let unit = next.filter(|unit| *unit < all)?;
            next = unit.checked_add(self.of);
            Some(unit)
        })
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text
            .split_once('/')
            .and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
        match numbers {
            Some((number, of)) if 1 <= number && number <= of => Ok(Self { number, of }),
            _ => Err(format!(
                "`{text}` is not a shard: `3/40` is the third of forty, counted from 1"
            )),
        }
    }
}

impl TryFrom<String> for Shard {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<Shard> for String {
    fn from(shard: Shard) -> Self {
        shard.to_string()
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shards_of_a_campaign_do_each_unit_once() {
        for of in [1, 2, 3, 7, 40] {
            let mut done: Vec<u64> = (1..=of).flat_map(|number| Shard { number, of }.units(23)).collect();
            done.sort_unstable();
            assert_eq!(done, (0..23).collect::<Vec<_>>(), "{of} shards");
        }
    }

    #[test]
    fn shards_are_written_as_fractions() {
        assert_eq!("3/40".parse(), Ok(Shard { number: 3, of: 40 }));
        assert_eq!(Shard { number: 3, of: 40 }.to_string(), "3/40");
        for wrong in ["", "3", "0/4", "5/4", "-1/4", "1/x", "1/99999999999999999999"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }
}
