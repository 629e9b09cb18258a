//! Wraps long lines of Verilog: comments between words, code at its outermost operators and commas.

/// Longest line that is not wrapped, in columns.
const COLUMNS: usize = 100;

/// Returns `line`, wrapped if it is too long. Further lines of code are indented by four more columns; those of a
/// comment like its text, and in an item of a list by two more.
pub(super) fn wrapped(line: &str) -> String {
    let mut rest = line.to_owned();
    let code = line.trim_start();
    let indent = &line[..line.len() - code.len()];
    let lead = match code.strip_prefix("//") {
        // The text of a comment can be indented, as in a drawing.
        Some(text) => {
            let spaces = text.len() - text.trim_start().len() + if text.starts_with(" - ") { 2 } else { 0 };
            format!("{indent}//{}", " ".repeat(spaces))
        }
        None => format!("{indent}    "),
    };
    let mut lines = Vec::new();
    while rest.chars().count() > COLUMNS {
        let place = if code.starts_with("//") {
            between_words(&rest, lead.len())
        } else {
            at_an_operator(&rest, lead.len())
        };
        let Some(place) = place else { break };
        let after = format!("{lead}{}", rest[place..].trim_start());
        rest.truncate(place);
        lines.push(rest.trim_end().to_owned());
        rest = after;
    }
    lines.push(rest);
    lines.join("\n")
}

/// Position of the space before the first word that does not fit; `None` in tables and drawings, whose spaces matter.
fn between_words(line: &str, lead: usize) -> Option<usize> {
    if line[lead..].trim_start().contains("  ") {
        return None;
    }
    let fits = line.char_indices().nth(COLUMNS).map_or(line.len(), |(at, _)| at);
    line[lead..=fits].rfind(' ').map(|at| lead + at)
}

/// The last break among those inside the fewest brackets; a break is before an operator or after a comma.
fn at_an_operator(line: &str, lead: usize) -> Option<usize> {
    let (mut depth, mut quoted) = (0_u32, false);
    let mut best: Option<(u32, usize)> = None;
    for (at, letter) in line.char_indices().take_while(|(at, _)| *at <= COLUMNS) {
        match letter {
            '"' => quoted = !quoted,
            '(' | '{' | '[' => depth += 1,
            ')' | '}' | ']' => depth = depth.saturating_sub(1),
            ' ' if at > lead && !quoted && may_break(line, at) && best.is_none_or(|(least, _)| depth <= least) => {
                best = Some((depth, at));
            }
            _ => {}
        }
    }
    best.map(|(_, at)| at)
}

/// Whether a line may be broken at the space `at`.
fn may_break(line: &str, at: usize) -> bool {
    let operator = line[at + 1..].split(' ').next().unwrap_or_default();
    line[..at].ends_with(',') || matches!(operator, "|" | "||" | "&" | "&&" | "^" | "+" | "-" | "?" | ":")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_fits_stays() {
        let line = format!("    assign a = {};", "b".repeat(80));
        assert_eq!(wrapped(&line), line);
    }

    #[test]
    fn code_breaks_at_its_outermost_operators() {
        let name = |letter: &str| letter.repeat(30);
        let line = format!(
            "  assign x = ({} & {}) | ({} & {});",
            name("a"),
            name("b"),
            name("c"),
            name("d")
        );
        let expected = format!(
            "  assign x = ({} & {})\n      | ({} & {});",
            name("a"),
            name("b"),
            name("c"),
            name("d")
        );
        assert_eq!(wrapped(&line), expected);
    }

    #[test]
    fn a_list_breaks_behind_a_comma() {
        let names = ["a", "b", "c", "d"].map(|letter| letter.repeat(30));
        let line = format!("x <= {{{}}};", names.join(", "));
        let expected = format!("x <= {{{}, {},\n    {}, {}}};", names[0], names[1], names[2], names[3]);
        assert_eq!(wrapped(&line), expected);
    }

    #[test]
    fn a_comment_breaks_between_words_and_a_table_never() {
        let long = format!("    // {}", ["word"; 40].join(" "));
        let text = wrapped(&long);
        assert!(
            text.lines()
                .all(|line| line.len() <= COLUMNS && line.starts_with("    // word"))
        );
        let words: Vec<&str> = text.split_whitespace().filter(|word| *word != "//").collect();
        assert_eq!(words.len(), 40);
        let drawn = wrapped(&format!("//          {}", ["word"; 40].join(" ")));
        assert!(
            drawn.lines().all(|line| line.starts_with("//          word")),
            "{drawn}"
        );
        let table = format!("// name  {}", ["value"; 40].join(" "));
        assert_eq!(wrapped(&table), table);
    }
}
