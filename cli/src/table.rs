//! Tables on a terminal.

use anstream::adapter::strip_str;

/// Number of visible characters of a cell, without escape sequences of colours.
fn seen(cell: &str) -> usize {
    strip_str(cell).to_string().chars().count()
}

/// A table for people: columns are as wide as their widest cell, and the caller chooses which are right-aligned.
pub(crate) struct Table {
    right: Vec<bool>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these headings; a heading that starts with `>` makes its column right-aligned.
    pub(crate) fn new(headings: &[&str]) -> Self {
        let right = headings.iter().map(|h| h.starts_with('>')).collect();
        let first = headings.iter().map(|h| h.trim_start_matches('>').to_owned()).collect();
        Self {
            right,
            rows: vec![first],
        }
    }

    /// Adds a row.
    pub(crate) fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// The text, each line indented.
    pub(crate) fn text(&self, indent: &str) -> String {
        let width = |column: usize| self.rows.iter().filter_map(|r| r.get(column)).map(|c| seen(c)).max();
        let widths: Vec<usize> = (0..self.right.len()).map(|c| width(c).unwrap_or(0)).collect();
        let mut text = String::new();
        for row in &self.rows {
            let mut line = indent.to_owned();
            for ((cell, width), right) in row.iter().zip(&widths).zip(&self.right) {
                let padding = " ".repeat(width.saturating_sub(seen(cell)));
                line += &if *right {
                    format!("{padding}{cell}  ")
                } else {
                    format!("{cell}{padding}  ")
                };
            }
            text += line.trim_end();
            text.push('\n');
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_aligns_its_columns_by_characters() {
        let mut table = Table::new(&["axis", ">ζ"]);
        table.row(["x".into(), "0.1578".into()]);
        assert_eq!(table.text("  "), "  axis       ζ\n  x     0.1578\n");
    }
}
