//! The rungs of the verification ladder in one table: blocks by rungs.
//!
//! ```text
//! rung ─► a program ─► its table, a row per block instance ─► sums of some columns, per block ─► a cell
//!                   └─► its exit status ─► whether the rung holds
//! ```
//!
//! All programs print Markdown tables whose first column is the block; this is their common format. A rung without a
//! row does not hold, whatever its exit status is.

use std::fmt::Write as _;
use std::time::Duration;

/// Columns that are summed, each with the unit that follows the sum in the cell.
pub type Columns = &'static [(&'static str, &'static str)];

/// Result of a rung.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rung {
    /// Name of the rung.
    pub name: String,
    /// Cells by block, in the order of the program's output.
    pub cells: Vec<(String, String)>,
    /// Whether the exit status is 0 and the table is not empty.
    pub holds: bool,
    /// Duration of the rung.
    pub time: Duration,
}

impl Rung {
    /// A rung with these rows, each a block with its numbers, which are summed per block.
    pub fn new(name: &str, units: &[&str], rows: &[(String, Vec<u64>)], succeeded: bool, time: Duration) -> Self {
        let mut sums: Vec<(String, Vec<u64>)> = Vec::new();
        for (block, numbers) in rows {
            match sums.iter_mut().find(|(other, _)| other == block) {
                Some((_, sum)) => sum
                    .iter_mut()
                    .zip(numbers)
                    .for_each(|(sum, n)| *sum = sum.saturating_add(*n)),
                None => sums.push((block.clone(), numbers.clone())),
            }
        }
        let cell = |numbers: &[u64]| {
            let figures = numbers
                .iter()
                .zip(units)
                .map(|(n, unit)| format!("{n} {unit}").trim().to_owned());
            figures.collect::<Vec<_>>().join(", ")
        };
        Self {
            name: name.to_owned(),
            holds: succeeded && !sums.is_empty(),
            cells: sums
                .into_iter()
                .map(|(block, numbers)| (block, cell(&numbers)))
                .collect(),
            time,
        }
    }
}

/// The rows of the tables in a program's output that have a column `block` and these columns, as block and numbers.
pub fn rows(output: &str, columns: Columns) -> Vec<(String, Vec<u64>)> {
    let mut rows = Vec::new();
    let mut places: Option<(usize, Vec<usize>)> = None;
    for line in output.lines() {
        let Some(cells) = cells(line) else {
            places = None;
            continue;
        };
        let Some((block, numbers)) = &places else {
            let place = |name: &str| cells.iter().position(|cell| *cell == name);
            let numbers = columns.iter().map(|(name, _)| place(name)).collect::<Option<Vec<_>>>();
            places = place("block").zip(numbers);
            continue;
        };
        // This skips the line below the headings, and sums, which are in bold.
        if cells.iter().all(|cell| cell.chars().all(|c| c == '-')) || cells.iter().any(|cell| cell.starts_with("**")) {
            continue;
        }
        let found = numbers.iter().map(|at| cells.get(*at).map_or(0, |cell| number(cell)));
        rows.push((cells.get(*block).copied().unwrap_or("?").to_owned(), found.collect()));
    }
    rows
}

fn cells(line: &str) -> Option<Vec<&str>> {
    let inner = line.strip_prefix('|')?.strip_suffix('|')?;
    Some(inner.split('|').map(str::trim).collect())
}

/// Returns the number at the start of a cell; 0 if there is none.
fn number(cell: &str) -> u64 {
    let digits: String = cell
        .chars()
        .filter(|c| *c != ',')
        .take_while(char::is_ascii_digit)
        .collect();
    digits.parse().unwrap_or(0)
}

/// The table of all rungs: a row per block in the order of appearance, a column per rung, and at the end whether each
/// holds and its duration.
pub fn table(rungs: &[Rung]) -> String {
    let mut blocks: Vec<&str> = Vec::new();
    for (block, _) in rungs.iter().flat_map(|rung| &rung.cells) {
        if !blocks.contains(&block.as_str()) {
            blocks.push(block);
        }
    }
    let line = |first: &str, cells: Vec<String>| format!("| {first} | {} |\n", cells.join(" | "));
    let mut text = line("block", rungs.iter().map(|rung| rung.name.clone()).collect());
    let _ = writeln!(text, "|{}", "---|".repeat(rungs.len() + 1));
    for block in blocks {
        let cell = |rung: &Rung| {
            let found = rung.cells.iter().find(|(name, _)| name == block);
            found.map_or_else(|| "–".to_owned(), |(_, cell)| cell.clone())
        };
        text += &line(block, rungs.iter().map(cell).collect());
    }
    let holds = |rung: &Rung| if rung.holds { "holds" } else { "**FAILS**" }.to_owned();
    text += &line("all", rungs.iter().map(holds).collect());
    text + &line(
        "seconds",
        rungs.iter().map(|rung| rung.time.as_secs().to_string()).collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const OUTPUT: &str = "said before\n| block | size | properties | covers |\n|---|---|---|---|\n| a | 1 | 3 | 2 of 2 |\n\
                          | a | 2 | 4 | 1 of 1 |\n| b | 1 | 1,000 | none |\n\
                          | **all** | | **1007** | |\n\n| what | else |\n|---|---|\n| c | 5 |\n";

    #[test]
    fn numbers_are_summed_per_block() {
        let found = rows(OUTPUT, &[("properties", ""), ("covers", "covers")]);
        let rung = Rung::new("proofs", &["", "covers"], &found, true, Duration::from_secs(3));
        let cells = [("a", "7, 3 covers"), ("b", "1000, 0 covers")];
        assert_eq!(
            rung.cells,
            cells.map(|(block, cell)| (block.to_owned(), cell.to_owned()))
        );
        assert!(rung.holds);
        let other = Rung::new("runs", &["clocks"], &[("b".to_owned(), vec![9])], false, Duration::ZERO);
        let wanted = "| block | proofs | runs |\n|---|---|---|\n| a | 7, 3 covers | – |\n| b | 1000, 0 covers | 9 clocks |\n\
                      | all | holds | **FAILS** |\n| seconds | 3 | 0 |\n";
        assert_eq!(table(&[rung, other]), wanted);
    }

    #[test]
    fn a_rung_without_rows_does_not_hold() {
        let nothing = rows("| block | clocks |\n|---|---|\n", &[("clocks", "")]);
        assert!(!Rung::new("empty", &[""], &nothing, true, Duration::ZERO).holds);
        assert!(rows(OUTPUT, &[("absent", "")]).is_empty());
    }
}
