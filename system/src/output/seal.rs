//! The seal by which posicast recognises a file that it wrote.
//!
//! Near its beginning, in a comment of its format, such a file contains
//!
//! ```text
//! written by posicast 0.1.0 sha256:5f70bf18a086007016e948b04aed3b82103a36bea41755b6cddfaf10ace3c6ef
//! ```
//!
//! The digits are the SHA-256 of the whole file with 64 zeros in their place. So a file that only mentions posicast
//! is not ours, nor is one that was edited since: both are the user's work.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

use sha2::{Digest, Sha256};

/// The seal lies within this many bytes from the beginning.
const HEAD_BYTES: usize = 4096;
const DIGITS: usize = 64;
const NAME: &str = "written by posicast ";
const HASH: &str = " sha256:";

/// The seal with zeros, to be written into a comment. [`Draft::put`](super::Draft::put) fills in the digits.
pub fn blank() -> String {
    format!("{NAME}{}{HASH}{}", env!("CARGO_PKG_VERSION"), "0".repeat(DIGITS))
}

/// The text with a blank seal in a comment: of XML where it begins with `<`, of GTKWave's session files where it
/// begins with `[`, of JSON (the key `$comment`) where it begins with `{`, of man pages where it begins with `.`,
/// else a second line that begins with `#`.
pub(super) fn with_blank(text: &str) -> String {
    let seal = blank();
    match text.as_bytes().first() {
        Some(b'<') => {
            // The seal follows the declaration, or is inside the root element: readers expect either at the very
            // beginning.
            let end = if text.starts_with("<?") { "?>" } else { ">" };
            let (before, after) = text.split_at(text.find(end).map_or(0, |at| at + end.len()));
            format!("{before}\n<!-- {seal} -->\n{}", after.trim_start_matches('\n'))
        }
        Some(b'[') => format!("[*] {seal}\n{text}"),
        Some(b'{') => format!("{{\n  \"$comment\": \"{seal}\",{}", text.trim_start_matches('{')),
        Some(b'.') => format!(".\\\" {seal}\n{text}"),
        // The seal follows the first line, which a reader of the file looks for first.
        _ => {
            let (before, after) = text.split_at(text.find('\n').map_or(text.len(), |at| at + 1));
            format!("{before}# {seal}\n{after}")
        }
    }
}

/// Range of the digits in the beginning of a file.
fn place(head: &[u8]) -> Option<usize> {
    let find = |from: usize, what: &str| {
        let windows = head.get(from..)?.windows(what.len());
        windows
            .into_iter()
            .position(|window| window == what.as_bytes())
            .map(|at| from + at + what.len())
    };
    let digits = find(find(0, NAME)?, HASH)?;
    let found = head.get(digits..digits + DIGITS)?;
    found.iter().all(u8::is_ascii_hexdigit).then_some(digits)
}

fn head(file: &mut File) -> io::Result<Vec<u8>> {
    let mut head = Vec::new();
    file.seek(SeekFrom::Start(0))?;
    file.take(HEAD_BYTES as u64).read_to_end(&mut head)?;
    Ok(head)
}

fn text_of(hash: Sha256) -> String {
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Fills in the seal of a file, if it has a blank one. `hash` has seen all of the file.
pub(super) fn fill_in(file: &mut File, hash: Sha256) -> io::Result<()> {
    let head = head(file)?;
    let Some(at) = place(&head).filter(|at| head[*at..at + DIGITS].iter().all(|digit| *digit == b'0')) else {
        return Ok(());
    };
    file.seek(SeekFrom::Start(at as u64))?;
    file.write_all(text_of(hash).as_bytes())
}

/// Whether posicast wrote the file and nobody changed it since. `path` is a plain file.
///
/// # Errors
/// An error if the file cannot be read.
pub fn is_ours(path: &Path) -> io::Result<bool> {
    let mut file = File::open(path)?;
    let mut head = head(&mut file)?;
    let Some(at) = place(&head) else {
        return Ok(false);
    };
    let found = head[at..at + DIGITS].to_vec();
    head[at..at + DIGITS].fill(b'0');
    let mut hash = Sha256::new();
    hash.update(&head);
    let mut buffer = vec![0; 1 << 16];
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok(text_of(hash).as_bytes() == found),
            count => hash.update(&buffer[..count]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_seal_goes_where_the_format_takes_a_comment() {
        let xml = with_blank("<?xml version=\"1.0\"?>\n<a/>\n");
        assert!(
            xml.starts_with("<?xml version=\"1.0\"?>\n<!-- written by posicast ") && xml.ends_with(" -->\n<a/>\n"),
            "{xml}"
        );
        let svg = with_blank("<svg width=\"9\">\n</svg>\n");
        assert!(
            svg.starts_with("<svg width=\"9\">\n<!-- written by posicast ") && svg.ends_with(" -->\n</svg>\n"),
            "{svg}"
        );
        assert!(with_blank("[dumpfile] \"a\"\n").starts_with("[*] written by posicast "));
        let object = with_blank("{\n  \"a\": 1\n}\n");
        assert!(
            object.starts_with("{\n  \"$comment\": \"written by posicast ") && object.ends_with("\",\n  \"a\": 1\n}\n"),
            "{object}"
        );
        let page = with_blank(".TH posicast 1\n");
        assert!(
            page.starts_with(".\\\" written by posicast ") && page.ends_with("\n.TH posicast 1\n"),
            "{page}"
        );
        let commands = with_blank("load_file a\nzoom_fit\n");
        assert!(
            commands.starts_with("load_file a\n# written by posicast ") && commands.ends_with("\nzoom_fit\n"),
            "{commands}"
        );
    }

    #[test]
    fn only_a_whole_seal_is_found() {
        let seal = blank();
        let at = place(seal.as_bytes()).unwrap();
        assert_eq!(&seal[at..], "0".repeat(DIGITS));
        for wrong in [
            &seal[1..],
            &seal[..seal.len() - 1],
            &seal.replace("sha256", "sha512"),
            "written by posicast",
        ] {
            assert_eq!(place(wrong.as_bytes()), None, "{wrong}");
        }
    }
}
