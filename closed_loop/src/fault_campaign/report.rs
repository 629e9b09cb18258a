//! Figures of a campaign: one row per kind.

use std::fmt;

use super::kind::FaultRow;
use super::run::FaultOutcome;

/// Number of failures that are shown in words.
const MOST_SHOWN: usize = 20;

/// Figures over the cases of a kind; the largest of each.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct KindFigures {
    /// Number of cases.
    pub cases: u64,
    /// Number of cases that did not meet the expectation.
    pub failed: u64,
    /// Clocks to another state, from the fault or from its detection.
    pub state_clocks: Option<u64>,
    /// Clocks until gates and drive are off, where outputs are switched off at once.
    pub off_clocks: Option<u64>,
    /// Ticks from QUICK_STOP to its end.
    pub stop_ticks: Option<u64>,
}

/// Result of a campaign.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FaultReport {
    seed: u64,
    rows: Vec<FaultRow>,
    kinds: Vec<KindFigures>,
    failures: Vec<String>,
}

impl FaultReport {
    /// A report of these kinds of faults without cases.
    pub(super) fn new(rows: &[FaultRow], seed: u64) -> Self {
        Self {
            seed,
            rows: rows.to_vec(),
            kinds: vec![KindFigures::default(); rows.len()],
            failures: Vec::new(),
        }
    }

    /// Adds a case.
    pub(super) fn add(&mut self, outcome: &FaultOutcome) {
        let place = (outcome.case.number % self.rows.len() as u64) as usize;
        let kind = &mut self.kinds[place];
        kind.cases += 1;
        kind.failed += u64::from(!outcome.failures.is_empty());
        // `None` compares as less than any number.
        kind.state_clocks = kind.state_clocks.max(outcome.figures.state_clocks);
        kind.off_clocks = kind.off_clocks.max(outcome.figures.off_clocks);
        kind.stop_ticks = kind.stop_ticks.max(outcome.figures.stop_ticks);
        let (number, name) = (outcome.case.number, outcome.case.row.name);
        let failures = outcome.failures.iter();
        self.failures
            .extend(failures.map(|what| format!("case {number}, {name}: {what}")));
    }

    /// Number of all cases.
    pub fn cases(&self) -> u64 {
        self.kinds.iter().map(|kind| kind.cases).sum()
    }

    /// Figures per kind, in the order of the bed's rows.
    pub fn kinds(&self) -> &[KindFigures] {
        &self.kinds
    }

    /// Descriptions of failures, with the numbers of the cases: with the seed they can be repeated.
    pub fn failures(&self) -> &[String] {
        &self.failures
    }
}

impl fmt::Display for FaultReport {
    /// A table in Markdown, and the first failures.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "| fault | cases | failed | to the state, clocks | to off, clocks | quick stop, ticks |"
        )?;
        writeln!(f, "|---|---|---|---|---|---|")?;
        let shown = |figure: Option<u64>| figure.map_or_else(|| "–".to_owned(), |figure| figure.to_string());
        for (row, kind) in self.rows.iter().zip(&self.kinds) {
            writeln!(
                f,
                "| {} | {} | {} | {} | {} | {} |",
                row.name,
                kind.cases,
                kind.failed,
                shown(kind.state_clocks),
                shown(kind.off_clocks),
                shown(kind.stop_ticks)
            )?;
        }
        let failed: u64 = self.kinds.iter().map(|kind| kind.failed).sum();
        writeln!(f, "\n{} cases, {failed} failed, seed {}", self.cases(), self.seed)?;
        for failure in self.failures.iter().take(MOST_SHOWN) {
            writeln!(f, "{failure}")?;
        }
        Ok(())
    }
}
