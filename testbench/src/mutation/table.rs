//! What became of the mutants, as the table of `docs/verification.md`.

use std::fmt::Write as _;

use super::{Fate, Mutant, Subject};
use crate::Error;

/// Lines of the page between which the table stands.
const MARKS: (&str, &str) = (
    "<!-- mutants: written by the example `mutate` -->",
    "<!-- end of mutants -->",
);

/// A block's line, and its mutants that are unknown.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Row {
    block: String,
    size: String,
    /// How many there were.
    pub mutants: usize,
    /// Killed by lock step.
    pub lockstep: usize,
    /// Of these, after more than 10,000 clocks.
    late: usize,
    /// Killed by a property.
    pub property: usize,
    /// Proven equivalent.
    pub equivalent: usize,
    /// Neither killed nor equivalent.
    pub unknown: Vec<String>,
}

impl Row {
    /// Counts.
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
                    row.late += usize::from(kill.seed > 1 || kill.clock >= 10_000);
                }
                Fate::Property(_) => row.property += 1,
                Fate::Equivalent => row.equivalent += 1,
                Fate::Unknown { differs: Some(clock) } => {
                    row.unknown.push(format!(
                        "{mutant}: a search tells it from the block after {clock} clocks"
                    ));
                }
                Fate::Unknown { differs: None } => row.unknown.push(mutant.to_string()),
            }
        }
        row
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
}

/// Rows, their sum, and the list of what is unknown.
pub fn table(rows: &[Row]) -> String {
    let sum = |count: fn(&Row) -> usize| rows.iter().map(count).sum::<usize>();
    let mut text = String::from(
        "| block | size | mutants | lock step | of these late | property | equivalent | unknown |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
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
    for row in rows.iter().filter(|row| !row.unknown.is_empty()) {
        let _ = writeln!(text, "\nUnknown in {}, {}:\n", row.block, row.size);
        for mutant in &row.unknown {
            let _ = writeln!(text, "- `{mutant}`");
        }
    }
    text
}

/// A page with this table between its marks.
///
/// # Errors
/// [`Error::Option`] where the page has no marks, one after the other.
pub fn renewed(page: &str, table: &str) -> Result<String, Error> {
    let parts = page.split_once(MARKS.0).and_then(|(before, rest)| {
        let (_, after) = rest.split_once(MARKS.1)?;
        Some((before, after))
    });
    let (before, after) = parts.ok_or_else(|| {
        Error::Option(format!(
            "the page has no place for the table: it needs the lines `{}` and `{}`",
            MARKS.0, MARKS.1
        ))
    })?;
    Ok(format!("{before}{}\n\n{table}\n{}{after}", MARKS.0, MARKS.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_only_what_is_between_the_marks_is_renewed() {
        let page = format!("before\n{}\nold\n{}\nafter\n", MARKS.0, MARKS.1);
        let first = renewed(&page, "new\n").unwrap();
        assert_eq!(first, format!("before\n{}\n\nnew\n\n{}\nafter\n", MARKS.0, MARKS.1));
        assert_eq!(renewed(&first, "new\n").unwrap(), first);
        assert!(renewed("no marks", "new").is_err());
    }
}
