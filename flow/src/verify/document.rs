//! The result of `verify`: the rows, the findings, and what was compared and how much.

use super::folder::ComparedFolder;
use crate::bench::Simulator;
use crate::replay::Replayed;
use crate::text::few;
use posicast_testbench::lockstep::report::{LockstepReport, LockstepVerdict};
use schemars::JsonSchema;
use serde::Serialize;

/// The result of a comparison.
#[derive(Serialize, JsonSchema)]
pub struct Document {
    /// The rows.
    #[serde(flatten)]
    pub report: LockstepReport,
    /// Why there is no match; `None` if there is one.
    pub reason: Option<String>,
    /// Parts that a verdict would cover and that no clock of the run exercised; there is then no verdict.
    pub not_exercised: Vec<String>,
    /// Number of clocks that exercise all parts.
    #[serde(skip)]
    pub(super) least_clocks: u64,
    /// Whether `--cycles` set the number of clocks.
    #[serde(skip)]
    pub(super) cycles_given: bool,
    /// The files of the folder, if the source is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub folder: Option<ComparedFolder>,
    /// The simulator of the hardware.
    pub simulator: Simulator,
    /// Seed of the random stimuli.
    pub seed: u64,
    /// The recording, if there is one.
    #[serde(rename = "stimulus", skip_serializing_if = "Option::is_none")]
    pub replayed: Option<Replayed>,
}

/// The result of comparing the folder's files, apart from the simulation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FilesVerdict {
    /// The files are those that posicast generates, or edits of the Verilog are accepted; or there is no folder.
    Agree,
    /// Verilog was edited, and edits are not accepted.
    Edited,
    /// Verilog was edited so that it depends on the tool that reads it.
    DependOnTool,
    /// A table, the machine file or the list of modules differs.
    Contradict,
}

impl Document {
    /// Why the command fails; `None` if everything was exercised and equal.
    pub(super) fn failed(&self) -> Option<String> {
        if self.report.result == LockstepVerdict::Match {
            return None;
        }
        Some(match (self.report.mismatches(), self.files()) {
            (1.., _) if self.replayed.is_some() => "recording, RTL and model do not match".to_owned(),
            (1.., _) => "the RTL does not match the model".to_owned(),
            (0, FilesVerdict::Contradict) => {
                "the folder differs from what posicast generates from its machine file".to_owned()
            }
            (0, FilesVerdict::DependOnTool) => {
                "no verdict: edited Verilog of the folder depends on the tool that reads it".to_owned()
            }
            (0, FilesVerdict::Edited) => "no verdict: Verilog of the folder was edited".to_owned(),
            (0, FilesVerdict::Agree) if self.replayed.is_some() => {
                let rows = self.report.not_exercised_names();
                format!("no verdict: the recording has no data; {}", few(&rows))
            }
            (0, FilesVerdict::Agree) => format!("no verdict: too little was exercised; {}", self.remedy()),
        })
    }

    /// What the files of the folder say.
    #[must_use]
    pub fn files(&self) -> FilesVerdict {
        match &self.folder {
            Some(folder) if folder.contradicts() => FilesVerdict::Contradict,
            Some(folder) if folder.depends_on_tool() => FilesVerdict::DependOnTool,
            Some(folder) if folder.fails() => FilesVerdict::Edited,
            _ => FilesVerdict::Agree,
        }
    }

    /// What to do where too little was exercised.
    #[must_use]
    pub fn remedy(&self) -> String {
        match (self.least_clocks, self.cycles_given) {
            (least, true) if least > self.fewest_clocks() => {
                format!("compare more: --cycles {least}, or leave out --cycles")
            }
            (_, true) => "leave out --cycles".to_owned(),
            (_, false) => "the rows say why".to_owned(),
        }
    }

    /// Number of clocks of the shortest row that left something unexercised.
    fn fewest_clocks(&self) -> u64 {
        let rows = self.report.blocks.iter().filter(|row| !row.not_exercised.is_empty());
        rows.map(|row| row.cycles).min().unwrap_or(u64::MAX)
    }
}
