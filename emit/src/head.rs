//! The head of a module's file: the documentation of its kernel's file as plain text for a Verilog comment.
//!
//! Links and the fences of drawings are removed. Characters outside ASCII, which some Verilog tools cannot read, are
//! replaced.

use posicast_blocks::in_ascii;

use super::Heads;

/// The head of the kernel with this tag, line by line; a paragraph is one line.
pub(super) fn head(heads: Heads, tag: &str) -> Vec<String> {
    let found = heads.iter().find(|(name, _)| *name == tag);
    found.map(|(_, text)| plain(text)).unwrap_or_default()
}

fn plain(text: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let (mut drawn, mut goes_on) = (false, false);
    for line in text.lines() {
        let line = line.strip_prefix(' ').unwrap_or(line);
        if line.starts_with("```") {
            (drawn, goes_on) = (!drawn, false);
        } else if drawn {
            lines.push(line.chars().map(drawing).collect());
        } else {
            let sentence = plain_words(line);
            let begins = sentence.is_empty() || sentence.starts_with(['-', '|', '#']);
            match lines.last_mut() {
                Some(last) if goes_on && !begins => {
                    last.push(' ');
                    last.push_str(sentence.trim_start());
                }
                _ => lines.push(sentence.clone()),
            }
            goes_on = !sentence.is_empty() && !sentence.starts_with('|');
        }
    }
    lines
}

/// A line of text without links and characters outside ASCII.
pub(super) fn plain_words(line: &str) -> String {
    let mut text = String::new();
    let mut rest = line;
    while let Some((before, link)) = rest.split_once('[') {
        let Some((name, after)) = link.split_once(']') else {
            break;
        };
        text.push_str(before);
        // A link has a target or is a name in backticks; other brackets enclose the bits of a word.
        let target = after.strip_prefix('(').and_then(|target| target.split_once(')'));
        rest = match target {
            Some((_, after)) => {
                text.push_str(name);
                after
            }
            None if name.starts_with('`') => {
                text.push_str(name);
                after
            }
            None => {
                text.push_str(&format!("[{name}]"));
                after
            }
        };
    }
    text.push_str(rest);
    let plain = text
        .replace("super::", "")
        .replace("\\|", "|")
        .replace('∫', "integral of ")
        .replace("integral of  ", "integral of ");
    in_ascii(&plain)
}

/// Replaces a character of a drawing by one character, so that columns stay aligned.
fn drawing(letter: char) -> char {
    match letter {
        '─' | '−' => '-',
        '‾' => '^',
        '►' | '≥' => '>',
        '≤' => '<',
        '·' => '*',
        '×' => 'x',
        '±' => '+',
        '…' => '~',
        'Σ' => 'S',
        '┤' | '├' | '└' | '│' => '|',
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_plain_and_paragraphs_are_lines() {
        let text = " Adds [`Two`](super::Two) words −\n of [many](x), `a[3:0]`.\n\n - one\n   thing\n - more\n\n ```text\n a ─► b\n ```";
        let expected = [
            "Adds `Two` words - of many, `a[3:0]`.",
            "",
            "- one thing",
            "- more",
            "",
            "a -> b",
        ];
        assert_eq!(plain(text), expected);
    }
}
