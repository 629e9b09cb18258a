//! The table of `docs/verification.md`, between its marks.

use super::explanation::Explanation;
use super::{Measured, Share};
use crate::Error;

const BEGIN: &str = "<!-- coverage: written by `--example coverage -- --write` -->\n";
const END: &str = "<!-- coverage: end -->\n";

/// A row per block.
pub fn markdown(measured: &[Measured], explanations: &[Explanation]) -> String {
    let mut table =
        "| block | instance | lines | toggles | holes explained | bins |\n|---|---|---|---|---|---|\n".to_owned();
    for of in measured {
        let name = format!("{} {}", of.block, of.instance);
        let explained = of
            .holes
            .iter()
            .filter(|hole| explanations.iter().any(|e| e.explains(&name, hole)));
        table += &format!(
            "| {} | {} | {} | {} | {} of {} | {} of {} |\n",
            of.block,
            of.instance,
            percent(of.lines),
            percent(of.toggles),
            explained.count(),
            of.holes.len(),
            of.bins.reached,
            of.bins.all
        );
    }
    table
}

/// Rounded down, so that 100 % is all.
fn percent(share: Share) -> String {
    let tenths = (share.reached * 1000).checked_div(share.all).unwrap_or(1000);
    format!("{}.{} % of {}", tenths / 10, tenths % 10, share.all)
}

/// The page with the table in place of what stands between the marks.
///
/// # Errors
/// [`Error::Option`] where the page has no marks.
pub fn renewed(page: &str, table: &str) -> Result<String, Error> {
    let parts = page
        .split_once(BEGIN)
        .and_then(|(before, rest)| Some((before, rest.split_once(END)?.1)));
    let (before, after) =
        parts.ok_or_else(|| Error::Option(format!("docs/verification.md lacks the marks {BEGIN} and {END}")))?;
    Ok(format!("{before}{BEGIN}{table}{END}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_only_what_is_between_the_marks_is_renewed() {
        let page = format!("before\n{BEGIN}old\n{END}after\n");
        assert_eq!(
            renewed(&page, "new\n").unwrap(),
            format!("before\n{BEGIN}new\n{END}after\n")
        );
        assert!(renewed("no marks", "new").is_err());
        assert_eq!(
            percent(Share {
                reached: 1999,
                all: 2000
            }),
            "99.9 % of 2000"
        );
    }
}
