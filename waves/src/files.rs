//! Files that a comparison writes: the content is ours, the caller decides which names may be written to.

use std::io::{self, Write};
use std::path::Path;

use crate::WaveError;

/// Writes the content of a file.
pub type WriteContent<'a> = dyn FnMut(&mut dyn Write) -> Result<(), WaveError> + 'a;

/// Puts files in their places.
pub trait OutputSink {
    /// Returns words for a comment near the beginning of each file, by which the caller recognises it.
    fn mark(&self) -> String;

    /// Puts a file in its place, complete or not at all. `fill` writes its content, and is called once.
    ///
    /// # Errors
    /// Those of `fill`, after which nothing is there that was not before; [`WaveError::File`] where the file cannot be
    /// written.
    fn write(&self, path: &Path, fill: &mut WriteContent<'_>) -> Result<(), WaveError>;
}

/// Writes a text with the sink's mark in a comment.
///
/// # Errors
/// As [`OutputSink::write`].
pub fn write_text(sink: &dyn OutputSink, path: &Path, text: &str) -> Result<(), WaveError> {
    let text = marked(text, &sink.mark());
    sink.write(path, &mut |out| {
        out.write_all(text.as_bytes()).map_err(write_error(path))
    })
}

pub(crate) fn write_error(path: &Path) -> impl FnOnce(io::Error) -> WaveError {
    WaveError::file(path, "write")
}

/// Returns the text with the mark in a comment: of XML if it begins with `<`, of GTKWave's session files if it begins
/// with `[`, else in a second line that begins with `#`.
fn marked(text: &str, mark: &str) -> String {
    match text.as_bytes().first() {
        Some(b'<') => {
            // The comment comes after the declaration, else in the root element: readers look for either at the very
            // beginning.
            let end = if text.starts_with("<?") { "?>" } else { ">" };
            let (before, after) = text.split_at(text.find(end).map_or(0, |at| at + end.len()));
            format!("{before}\n<!-- {mark} -->\n{}", after.trim_start_matches('\n'))
        }
        Some(b'[') => format!("[*] {mark}\n{text}"),
        _ => {
            let (before, after) = text.split_at(text.find('\n').map_or(text.len(), |at| at + 1));
            format!("{before}# {mark}\n{after}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mark_goes_where_the_format_takes_a_comment() {
        for (text, expected) in [
            (
                "<?xml version=\"1.0\"?>\n<a/>\n",
                "<?xml version=\"1.0\"?>\n<!-- ours -->\n<a/>\n",
            ),
            (
                "<svg width=\"9\">\n</svg>\n",
                "<svg width=\"9\">\n<!-- ours -->\n</svg>\n",
            ),
            ("[dumpfile] \"a\"\n", "[*] ours\n[dumpfile] \"a\"\n"),
            ("load_file a\nzoom_fit\n", "load_file a\n# ours\nzoom_fit\n"),
        ] {
            assert_eq!(marked(text, "ours"), expected);
        }
    }
}
