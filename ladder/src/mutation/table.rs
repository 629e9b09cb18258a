//! The results of the mutants as the table of `ladder/RESULTS.md`.
//!
//! The page has a row per block, so that a run of one block updates its own and leaves the others; sums and the list
//! of unknown mutants follow from the rows.

use std::fmt::Write as _;

use super::{Fate, Mutant, Subject};
use crate::page::Marks;

/// Marks of the table.
pub const MARKS: Marks = Marks {
    begin: "<!-- mutants: written by the example `mutate` -->",
    end: "<!-- end of mutants -->",
};
const HEAD: &str = "| block | size | mutants | lock step | of these late | property | equivalent | unknown |\n\
                    |---|---|---|---|---|---|---|---|\n";
/// A detection counts as late after this many clocks of the first run, and always in a later run.
const LATE_CLOCKS: u64 = 10_000;

/// Row of a block, with its unknown mutants.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct MutationRow {
    /// Name of the block.
    pub block: String,
    /// Description of its size.
    pub size: String,
    /// Number of mutants.
    pub mutants: usize,
    /// Number detected by lock step.
    pub lockstep: usize,
    /// Number of these detected in the second run or after 10,000 clocks.
    pub late: usize,
    /// Number detected by a property.
    pub property: usize,
    /// Number proven equivalent.
    pub equivalent: usize,
    /// Descriptions of those neither detected nor proven equivalent.
    pub unknown: Vec<String>,
}

impl MutationRow {
    /// Counts the results.
    pub fn new(subject: &Subject, fates: &[(Mutant, Fate)]) -> Self {
        let mut row = Self {
            block: subject.block().name().to_owned(),
            size: subject.size().to_owned(),
            mutants: fates.len(),
            ..Self::default()
        };
        for (mutant, fate) in fates {
            match fate {
                Fate::Lockstep(kill) => {
                    row.lockstep += 1;
                    row.late += usize::from(kill.seed > 1 || kill.clock >= LATE_CLOCKS);
                }
                Fate::Property(_) => row.property += 1,
                Fate::Equivalent => row.equivalent += 1,
                Fate::Unknown { differs: Some(clock) } => row.unknown.push(format!(
                    "{mutant}; a search tells it from the block after {clock} clocks"
                )),
                Fate::Unknown { differs: None } => row.unknown.push(mutant.to_string()),
                Fate::Listed(line) => row.unknown.push(line.clone()),
            }
        }
        row
    }

    /// Parses a row of the table; the unknown mutants are listed elsewhere.
    fn parse(line: &str) -> Option<Self> {
        let cells: Vec<&str> = line.strip_prefix("| ")?.strip_suffix(" |")?.split(" | ").collect();
        let [block, size, counts @ .., _unknown] = cells.as_slice() else {
            return None;
        };
        let counts: Vec<usize> = counts.iter().map(|count| count.parse().ok()).collect::<Option<_>>()?;
        let [mutants, lockstep, late, property, equivalent] = counts.try_into().ok()?;
        Some(Self {
            block: (*block).to_owned(),
            size: (*size).to_owned(),
            mutants,
            lockstep,
            late,
            property,
            equivalent,
            unknown: Vec::new(),
        })
    }

    fn cells(&self) -> String {
        format!(
            "| {} | {} | {} | {} | {} | {} | {} | {} |",
            self.block,
            self.size,
            self.mutants,
            self.lockstep,
            self.late,
            self.property,
            self.equivalent,
            self.unknown.len()
        )
    }

    fn is_of(&self, subject: &Subject) -> bool {
        self.block == subject.block().name() && self.size == subject.size()
    }

    /// Prefix of each of its unknown mutants in the list.
    fn mark(&self) -> String {
        format!("- {}, {}: `", self.block, self.size)
    }
}

/// Writes rows, their sum, and the list of unknown mutants.
pub fn table(rows: &[MutationRow]) -> String {
    let sum = |count: fn(&MutationRow) -> usize| rows.iter().map(count).sum::<usize>();
    let mut text = HEAD.to_owned();
    for row in rows {
        let _ = writeln!(text, "{}", row.cells());
    }
    let _ = writeln!(
        text,
        "| **all** | | **{}** | **{}** | **{}** | **{}** | **{}** | **{}** |",
        sum(|row| row.mutants),
        sum(|row| row.lockstep),
        sum(|row| row.late),
        sum(|row| row.property),
        sum(|row| row.equivalent),
        sum(|row| row.unknown.len())
    );
    if rows.iter().any(|row| !row.unknown.is_empty()) {
        text.push_str("\nUnknown:\n\n");
    }
    for row in rows {
        for mutant in &row.unknown {
            let _ = writeln!(text, "{}{mutant}`", row.mark());
        }
    }
    text
}

/// The table of these subjects, with these rows, and with those of `old` where there is no new one.
pub fn merged(old: &str, rows: &[MutationRow], subjects: &[Subject]) -> String {
    let old = on_page(old);
    let of = |subject: &Subject| {
        let mut found = rows.iter().chain(&old);
        found.find(|row| row.is_of(subject)).cloned()
    };
    let rows: Vec<MutationRow> = subjects.iter().filter_map(of).collect();
    table(&rows)
}

/// The unknown mutants of these rows that a table in the format of [`table`] does not list, each with its block.
pub fn unlisted(text: &str, rows: &[MutationRow]) -> Vec<String> {
    let unknown = rows
        .iter()
        .flat_map(|row| row.unknown.iter().map(|mutant| format!("{}{mutant}`", row.mark())));
    unknown
        .filter(|line| !text.lines().any(|listed| listed == line))
        .collect()
}

/// The unknown mutants of a subject that a table in the format of [`table`] lists.
pub fn unknown_of(text: &str, subject: &Subject) -> Vec<String> {
    let row = on_page(text).into_iter().find(|row| row.is_of(subject));
    row.map(|row| row.unknown).unwrap_or_default()
}

/// The rows of a table in the format of [`table`].
fn on_page(text: &str) -> Vec<MutationRow> {
    let mut rows: Vec<MutationRow> = text.lines().filter_map(MutationRow::parse).collect();
    for row in &mut rows {
        let mark = row.mark();
        let unknown = text
            .lines()
            .filter_map(|line| line.strip_prefix(&mark)?.strip_suffix('`'));
        row.unknown = unknown.map(str::to_owned).collect();
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(block: &str, unknown: &[&str]) -> MutationRow {
        MutationRow {
            block: block.to_owned(),
            size: "2 axes".to_owned(),
            mutants: 60,
            lockstep: 51,
            late: 3,
            property: 2,
            equivalent: 5,
            unknown: unknown.iter().map(|text| (*text).to_owned()).collect(),
        }
    }

    #[test]
    fn a_table_is_read_as_it_was_written() {
        let rows = [row("a", &["inv at Y[1] of $and$a.v:3$7 in a, a.v:3"]), row("b", &[])];
        let text = table(&rows);
        assert!(
            text.contains("| **all** | | **120** | **102** | **6** | **4** | **10** | **1** |"),
            "{text}"
        );
        assert_eq!(on_page(&text), rows);
    }

    #[test]
    fn only_the_same_mutant_of_the_same_block_is_listed() {
        let text = table(&[row("a", &["inv at Y[1]"]), row("b", &[])]);
        assert_eq!(unlisted(&text, &[row("a", &["inv at Y[1]"])]), [""; 0]);
        let others = [row("a", &["inv at Y[10]", "inv at Y"]), row("b", &["inv at Y[1]"])];
        assert_eq!(unlisted(&text, &others).len(), 3);
    }
}
