//! The output of `verify`: the rows, the findings, and a last line about what was compared and how much.

use super::folder::Folder;
use crate::bench::Simulator;
use crate::replay::Replayed;
use crate::style;
use crate::text::{Table, few};
use posicast_testbench::lockstep::report::{LockstepReport, LockstepVerdict};
use schemars::JsonSchema;
use serde::Serialize;

/// The result of a comparison.
#[derive(Serialize, JsonSchema)]
pub struct Document {
    #[serde(flatten)]
    pub(super) report: LockstepReport,
    /// Why there is no match; `None` if there is one.
    pub(super) reason: Option<String>,
    /// Parts that a verdict would cover and that no clock of the run exercised; there is then no verdict.
    pub(super) not_exercised: Vec<String>,
    /// Number of clocks that exercise all parts.
    #[serde(skip)]
    pub(super) least_clocks: u64,
    /// Whether `--cycles` set the number of clocks.
    #[serde(skip)]
    pub(super) cycles_given: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) folder: Option<Folder>,
    pub(super) simulator: Simulator,
    pub(super) seed: u64,
    #[serde(rename = "stimulus", skip_serializing_if = "Option::is_none")]
    pub(super) replayed: Option<Replayed>,
}

/// The result of comparing the folder's files, apart from the simulation.
enum Files {
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
        Some(match (self.report.mismatches(), self.state_of_files()) {
            (1.., _) if self.replayed.is_some() => "recording, RTL and model do not match".to_owned(),
            (1.., _) => "the RTL does not match the model".to_owned(),
            (0, Files::Contradict) => {
                "the folder differs from what posicast generates from its machine file".to_owned()
            }
            (0, Files::DependOnTool) => {
                "no verdict: edited Verilog of the folder depends on the tool that reads it".to_owned()
            }
            (0, Files::Edited) => "no verdict: Verilog of the folder was edited".to_owned(),
            (0, Files::Agree) if self.replayed.is_some() => {
                let rows = self.report.not_exercised_names();
                format!("no verdict: the recording has no data; {}", few(&rows))
            }
            (0, Files::Agree) => format!("no verdict: too little was exercised; {}", self.remedy()),
        })
    }

    fn state_of_files(&self) -> Files {
        match &self.folder {
            Some(folder) if folder.contradicts() => Files::Contradict,
            Some(folder) if folder.depends_on_tool() => Files::DependOnTool,
            Some(folder) if folder.fails() => Files::Edited,
            _ => Files::Agree,
        }
    }

    fn remedy(&self) -> String {
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

    pub(super) fn text(&self) -> String {
        let mut table = Table::new(&["block", "instance", ">clocks", ">mismatches"]);
        for block in &self.report.blocks {
            let counts = [block.cycles.to_string(), block.mismatches.to_string()];
            table.row([block.name.clone(), block.instance.clone()].into_iter().chain(counts));
        }
        let mut text = table.text("");
        for block in &self.report.blocks {
            let row = format!("{} {}", block.name, block.instance);
            if let Some(first) = &block.first {
                text += &format!("\n{row}: {first}\n");
            }
            for finding in &block.findings {
                text += &format!("{row}: {finding}\n");
            }
            if !block.not_exercised.is_empty() {
                text += &format!("{row}: not exercised: {}\n", few(&block.not_exercised));
            }
        }
        text += &self.folder.as_ref().map_or_else(String::new, Folder::text);
        text += &self.replayed.as_ref().map_or_else(String::new, Replayed::text);
        text + &style::message(&self.verdict()) + "\n"
    }

    /// The last line.
    fn verdict(&self) -> String {
        let report = &self.report;
        let verdict = match (report.result, report.mismatches(), self.state_of_files()) {
            (LockstepVerdict::Match, ..) => "match: every output of every clock is equal to the model's".to_owned(),
            (_, 1.., _) => "MISMATCH".to_owned(),
            (_, 0, Files::Contradict) => {
                "MISMATCH: the files are not those of the machine file, although the simulation is equal".to_owned()
            }
            (_, 0, Files::Edited) => "NO VERDICT: the simulation is equal, but Verilog was edited, and no simulation \
                                      sees every fault"
                .to_owned(),
            (_, 0, Files::DependOnTool) => {
                "NO VERDICT: the simulation is equal, but edited Verilog depends on the tool that \
                                            reads it, and no simulation sees what the other tools read"
                    .to_owned()
            }
            (_, 0, Files::Agree) if self.replayed.is_some() => {
                "NO VERDICT: nothing differs, but the recording has no data".to_owned()
            }
            (_, 0, Files::Agree) => format!(
                "NO VERDICT: the comparison is equal, but {} things were not exercised; {}",
                self.not_exercised.len(),
                self.remedy()
            ),
        };
        let rows = match report.blocks.len() {
            1 => "1 row".to_owned(),
            rows => format!("{rows} rows"),
        };
        let mut compared = vec![
            rows,
            format!("{} clocks", report.cycles),
            format!("{} samples", report.samples),
        ];
        let shapers = report
            .blocks
            .iter()
            .any(|block| block.name == "shaper" && block.samples.is_some());
        if report.result == LockstepVerdict::Match && self.replayed.is_none() {
            compared.push(if shapers {
                "every tap and bank of the shapers and every flag of all rows exercised".to_owned()
            } else {
                "every flag of all rows exercised".to_owned()
            });
        }
        compared.extend(self.replayed.as_ref().map(Replayed::summary));
        compared.extend(self.folder.as_ref().map(Folder::summary));
        if let Some(missing) = self
            .replayed
            .as_ref()
            .map(Replayed::missing_inputs)
            .filter(|missing| !missing.is_empty())
        {
            compared.push(format!(
                "{} inputs that are not in the recording held at 0 ({})",
                missing.len(),
                few(missing)
            ));
        }
        format!(
            "{verdict}; {}, simulator {}, seed {}",
            compared.join(", "),
            self.simulator,
            self.seed
        )
    }
}
