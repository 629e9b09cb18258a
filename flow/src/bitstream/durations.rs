//! How long the parts of a bitstream took in the last run of the same kind, from which the time left is estimated.
//!
//! A kind is a family of devices, what is built and the number of its axes. The times are kept for a month beside the routed designs, and
//! belong to the computer that they were measured on. Without an earlier run no time is estimated.

use super::evidence::{KEPT_PREFIX, keep};
use crate::observer::ExpectedTime;
use posicast_system::kept;
use std::fs;
use std::path::PathBuf;
use std::time::Duration;

/// A part of a bitstream, in the order of the work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Synthesis,
    PlaceAndRoute,
    ReadingBack,
    /// Lock step and faults.
    Checks,
}

/// Number of parts.
const PARTS: usize = 4;

impl Part {
    /// What is shown while it runs.
    pub(super) fn what(self) -> &'static str {
        match self {
            Self::Synthesis => "Yosys synthesises",
            Self::PlaceAndRoute => "nextpnr places and routes",
            Self::ReadingBack => "reading the bits back",
            Self::Checks => "comparing the bits",
        }
    }
}

/// Times of the last run of a kind, in seconds; `None` for a part that no run has finished.
type Seconds = [Option<f64>; PARTS];

/// The times of a kind of bitstream.
pub(super) struct Durations {
    file: PathBuf,
    last: Seconds,
}

impl Durations {
    /// The times of the last run of this kind, a name without blanks.
    pub(super) fn of_kind(kind: &str) -> Self {
        Self::in_file(kept::folder().join(format!("{KEPT_PREFIX}times-{kind}.json")))
    }

    fn in_file(file: PathBuf) -> Self {
        let text = kept::holds(&file).then(|| fs::read(&file).ok()).flatten();
        let last = text.and_then(|text| serde_json::from_slice(&text).ok());
        Self {
            file,
            last: last.unwrap_or_default(),
        }
    }

    /// The time of a part that begins, and of those that follow; `None` if one of them is not known.
    pub(super) fn expected(&self, part: Part) -> Option<ExpectedTime> {
        let [first, rest @ ..] = &self.last[part as usize..] else {
            return None;
        };
        let duration = |seconds: &Option<f64>| Duration::try_from_secs_f64((*seconds)?).ok();
        let rest: Option<Vec<Duration>> = rest.iter().map(duration).collect();
        Some(ExpectedTime {
            part: duration(first)?,
            after: rest?.into_iter().sum(),
        })
    }

    /// A part has taken this long.
    pub(super) fn took(&mut self, part: Part, time: Duration) {
        self.last[part as usize] = Some(time.as_secs_f64());
        // Where nothing can be kept, the next run estimates no time.
        let _ = keep(&self.last, &self.file);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_expected_only_if_an_earlier_run_tells_it() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("bitstream-times-ecp5-stage-1.json");
        let mut first = Durations::in_file(file.clone());
        assert_eq!(first.expected(Part::Synthesis), None);
        let seconds = Duration::from_secs;
        first.took(Part::Synthesis, seconds(90));
        first.took(Part::PlaceAndRoute, seconds(120));
        first.took(Part::ReadingBack, seconds(10));
        // The run was interrupted: how long the checks take is not known, and so the time left is not either.
        assert_eq!(Durations::in_file(file.clone()).expected(Part::Synthesis), None);
        first.took(Part::Checks, seconds(60));
        let later = Durations::in_file(file);
        let expected = later.expected(Part::PlaceAndRoute).unwrap();
        assert_eq!((expected.part, expected.after), (seconds(120), seconds(70)));
        assert_eq!(later.expected(Part::Checks).unwrap().after, seconds(0));
    }
}
