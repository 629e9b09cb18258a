//! Quoting for the Tcl files that Platform Designer and Quartus read.

/// Quotes any text as one word of a Tcl command.
pub(super) fn word(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_./:-".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        return text.to_owned();
    }
    if !text.contains(['{', '}', '\\']) {
        return format!("{{{text}}}");
    }
    let escaped = text.chars().fold(String::new(), |mut word, c| {
        if "\\\"$[]{}".contains(c) {
            word.push('\\');
        }
        word.push(c);
        word
    });
    format!("\"{escaped}\"")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_word_is_bare_braced_or_quoted() {
        assert_eq!(word("xy_stage.v"), "xy_stage.v");
        assert_eq!(word(""), "{}");
        assert_eq!(word("of $x [y]"), "{of $x [y]}");
        assert_eq!(word("a}b"), "\"a\\}b\"");
    }

    proptest! {
        #[test]
        fn prop_no_character_ends_a_word_early(text in "[a{}\\\\\"$\\[\\] ]{0,12}") {
            let word = word(&text);
            let inside: String = match word.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')) {
                Some(quoted) => {
                    let mut escaped = false;
                    quoted.chars().filter(|&c| {
                        let keeps = escaped || c != '\\';
                        escaped = !keeps;
                        keeps
                    }).collect()
                }
                None => word.trim_start_matches('{').trim_end_matches('}').to_owned(),
            };
            prop_assert_eq!(inside, text);
        }
    }
}
