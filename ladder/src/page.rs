//! The tables of `ladder/RESULTS.md`: each is between two marks, and the program that measures updates it.

use posicast_testbench::Error;

/// The lines of the page between which a table is.
#[derive(Debug, Clone, Copy)]
pub struct Marks {
    /// Line above the table.
    pub begin: &'static str,
    /// Line below the table.
    pub end: &'static str,
}

impl Marks {
    /// Returns the parts of `page` before, between and after the marks.
    fn parts<'a>(&self, page: &'a str) -> Result<[&'a str; 3], Error> {
        let Self { begin, end } = self;
        let parts = page.split_once(begin).and_then(|(before, rest)| {
            let (between, after) = rest.split_once(end)?;
            Some([before, between, after])
        });
        parts.ok_or_else(|| {
            Error::Option(format!(
                "the page has no place for the table: it needs the lines `{begin}` and `{end}`"
            ))
        })
    }

    /// Returns `page` with the text between the marks replaced by what `renew` makes of it.
    ///
    /// # Errors
    /// [`Error::Option`] where the page does not contain the two marks in order.
    pub fn renewed(&self, page: &str, renew: impl FnOnce(&str) -> String) -> Result<String, Error> {
        let Self { begin, end } = self;
        let [before, old, after] = self.parts(page)?;
        Ok(format!("{before}{begin}\n\n{}\n{end}{after}", renew(old)))
    }

    /// Updates the page itself.
    ///
    /// # Errors
    /// Those of [`renewed`](Self::renewed), and [`Error::File`] where the page cannot be read or written.
    pub fn renew(&self, renew: impl FnOnce(&str) -> String) -> Result<(), Error> {
        let page = std::fs::read_to_string(PAGE).map_err(failed("read"))?;
        std::fs::write(PAGE, self.renewed(&page, renew)?).map_err(failed("write"))
    }

    /// Returns the table on the page itself.
    ///
    /// # Errors
    /// [`Error::Option`] where the page does not contain the two marks in order, and [`Error::File`] where it cannot be
    /// read.
    pub fn read(&self) -> Result<String, Error> {
        let page = std::fs::read_to_string(PAGE).map_err(failed("read"))?;
        self.parts(&page).map(|[_, table, _]| table.to_owned())
    }
}

/// Returns a table with one row for each of these first cells: that of `new` if it has one, otherwise that of `old`.
pub(crate) fn merged(head: &str, old: &str, new: &str, first_cells: impl Iterator<Item = String>) -> String {
    let row = |cells: String| {
        let mut rows = new.lines().chain(old.lines());
        rows.find(|row| row.starts_with(&cells)).map(|row| format!("{row}\n"))
    };
    let rows: String = first_cells.filter_map(row).collect();
    format!("{head}{rows}")
}

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/RESULTS.md");

fn failed(doing: &'static str) -> impl Fn(std::io::Error) -> Error {
    move |source| Error::File {
        path: PAGE.into(),
        doing,
        source,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MARKS: Marks = Marks {
        begin: "<!-- here -->",
        end: "<!-- to here -->",
    };

    #[test]
    fn only_what_is_between_the_marks_is_renewed() {
        let page = "before\n<!-- here -->\nold\n<!-- to here -->\nafter\n";
        let once = MARKS
            .renewed(page, |old| old.replace("old", "new").trim().to_owned() + "\n")
            .unwrap();
        assert_eq!(once, "before\n<!-- here -->\n\nnew\n\n<!-- to here -->\nafter\n");
        assert_eq!(MARKS.renewed(&once, |old| old.trim().to_owned() + "\n").unwrap(), once);
        assert_eq!(MARKS.parts(&once).unwrap()[1], "\n\nnew\n\n");
        assert!(MARKS.renewed("no marks", str::to_owned).is_err());
        assert!(
            MARKS
                .renewed("<!-- to here -->\n<!-- here -->\n", str::to_owned)
                .is_err()
        );
    }
}
