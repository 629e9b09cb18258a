//! The tables of `docs/verification.md`: each is between two marks, and the program that measures updates it.

use std::path::Path;

use crate::Error;

/// The lines of the page between which a table is.
#[derive(Debug, Clone, Copy)]
pub struct Marks {
    /// Line above the table.
    pub begin: &'static str,
    /// Line below the table.
    pub end: &'static str,
}

impl Marks {
    /// Returns `page` with the text between the marks replaced by what `renew` makes of it.
    ///
    /// # Errors
    /// [`Error::Option`] where the page does not contain the two marks in order.
    pub fn renewed(&self, page: &str, renew: impl FnOnce(&str) -> String) -> Result<String, Error> {
        let Self { begin, end } = self;
        let parts = page.split_once(begin).and_then(|(before, rest)| {
            let (old, after) = rest.split_once(end)?;
            Some((before, old, after))
        });
        let (before, old, after) = parts.ok_or_else(|| {
            Error::Option(format!(
                "the page has no place for the table: it needs the lines `{begin}` and `{end}`"
            ))
        })?;
        Ok(format!("{before}{begin}\n\n{}\n{end}{after}", renew(old)))
    }

    /// Updates the page itself.
    ///
    /// # Errors
    /// Those of [`renewed`](Self::renewed), and [`Error::File`] where the page cannot be read or written.
    pub fn renew(&self, renew: impl FnOnce(&str) -> String) -> Result<(), Error> {
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/verification.md"));
        let failed = |doing| {
            move |source| Error::File {
                path: path.to_owned(),
                doing,
                source,
            }
        };
        let page = std::fs::read_to_string(path).map_err(failed("read"))?;
        std::fs::write(path, self.renewed(&page, renew)?).map_err(failed("write"))
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
    fn unit_only_what_is_between_the_marks_is_renewed() {
        let page = "before\n<!-- here -->\nold\n<!-- to here -->\nafter\n";
        let once = MARKS
            .renewed(page, |old| old.replace("old", "new").trim().to_owned() + "\n")
            .unwrap();
        assert_eq!(once, "before\n<!-- here -->\n\nnew\n\n<!-- to here -->\nafter\n");
        assert_eq!(MARKS.renewed(&once, |old| old.trim().to_owned() + "\n").unwrap(), once);
        assert!(MARKS.renewed("no marks", str::to_owned).is_err());
        assert!(
            MARKS
                .renewed("<!-- to here -->\n<!-- here -->\n", str::to_owned)
                .is_err()
        );
    }
}
