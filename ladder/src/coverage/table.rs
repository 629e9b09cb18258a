//! The coverage table of `ladder/RESULTS.md`, between its marks.

use super::explanation::Explanation;
use super::{Measured, Share};
use crate::page::{self, Marks};
use posicast_testbench::blocks::Block;

/// Marks of the table.
pub const MARKS: Marks = Marks {
    begin: "<!-- coverage: written by `--example coverage -- --write` -->",
    end: "<!-- coverage: end -->",
};
const HEAD: &str =
    "| block | instance | lines | toggles | holes explained | conditions | bins |\n|---|---|---|---|---|---|---|\n";

/// A row per block.
pub fn markdown(measured: &[Measured], explanations: &[Explanation]) -> String {
    let mut table = HEAD.to_owned();
    for of in measured {
        let name = format!("{} {}", of.block, of.instance);
        let explained = of
            .holes
            .iter()
            .filter(|hole| explanations.iter().any(|e| e.explains(&name, hole)));
        table += &format!(
            "| {} | {} | {} | {} | {} of {} | {} | {} of {} |\n",
            of.block,
            of.instance,
            percent(of.lines),
            percent(of.toggles),
            explained.count(),
            of.holes.len(),
            percent(of.conditions),
            of.bins.reached,
            of.bins.all
        );
    }
    table
}

/// Percentage rounded down, so that 100 % means all.
fn percent(share: Share) -> String {
    let tenths = (share.reached * 1000).checked_div(share.all).unwrap_or(1000);
    format!("{}.{} % of {}", tenths / 10, tenths % 10, share.all)
}

/// Returns one row for each of these blocks: that of `new` if it has one, otherwise that of `old`.
pub fn merged(old: &str, new: &str, subjects: &[Box<dyn Block>]) -> String {
    let blocks = subjects.iter();
    let first_cells = blocks.map(|block| format!("| {} | {} |", block.name(), block.instance()));
    page::merged(HEAD, old, new, first_cells)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_renewed_and_the_others_stay() {
        let subjects = super::super::subjects().unwrap();
        let row = |index: usize, what: &str| {
            let block = &subjects[index];
            format!("| {} | {} | {what} |\n", block.name(), block.instance())
        };
        let old = format!("{HEAD}{}{}| gone | | |\n", row(0, "old"), row(2, "old"));
        let new = format!("{HEAD}{}{}", row(1, "new"), row(2, "new"));
        let expected = format!("{HEAD}{}{}{}", row(0, "old"), row(1, "new"), row(2, "new"));
        assert_eq!(merged(&old, &new, &subjects), expected);
    }

    #[test]
    fn percent_rounds_down_so_that_only_all_is_100() {
        let share = Share {
            reached: 1999,
            all: 2000,
        };
        assert_eq!(percent(share), "99.9 % of 2000");
    }
}
