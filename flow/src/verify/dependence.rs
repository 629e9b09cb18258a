//! Finds text in Verilog whose meaning differs between tools: simulators, synthesisers and linters.
//!
//! A simulation only shows how one tool reads a file. `` `ifdef VERILATOR `` shows that tool one circuit and every other tool another; so
//! do pragmas in comments, `$test$plusargs`, and macros that only some tools define. The Verilog that posicast generates contains none of
//! them. So if an edited file contains them, they are reported, and there is no match: neither simulator can see what the other tools read.
//!
//! These texts are reported:
//!
//! | text | why |
//! |---|---|
//! | `` `ifdef ``, `` `ifndef ``, `` `elsif ``, `` `else ``, `` `endif ``, `` `include ``, `` `pragma `` | what is read depends on the definitions and folders of a tool |
//! | a macro that the file does not define itself before | tools define different ones |
//! | a system function or task, but for those in [`PURE`] | it asks for the simulator's arguments, files, time or random numbers |
//! | a comment that begins with the name of a tool, or has a word of [`PRAGMA_WORDS`] | tools obey it, others ignore it |
//! | an attribute of [`ATTRIBUTES`] | a synthesiser obeys it, a simulator ignores it |

use std::collections::BTreeSet;

/// A place of such text: its line, from 1, and the text itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Dependent {
    pub(super) line: usize,
    pub(super) what: String,
}

/// Directives that apply to the following text, in the same way in every tool.
const PLAIN_DIRECTIVES: [&str; 5] = [
    "timescale",
    "default_nettype",
    "resetall",
    "celldefine",
    "endcelldefine",
];
/// Directives by which a file defines a macro.
const DEFINE: &str = "define";
const UNDEF: &str = "undef";
/// System functions and tasks whose result or effect on the circuit is the same everywhere.
const PURE: [&str; 14] = [
    "signed", "unsigned", "clog2", "bits", "rtoi", "itor", "display", "displayb", "displayh", "write", "strobe",
    "monitor", "finish", "stop",
];
/// First words of comments that a tool obeys.
const TOOLS: [&str; 16] = [
    "verilator",
    "synthesis",
    "synopsys",
    "pragma",
    "altera",
    "altera_attribute",
    "quartus",
    "xilinx",
    "vivado",
    "exemplar",
    "ambit",
    "cadence",
    "icarus",
    "yosys",
    "vcs",
    "verilint",
];
/// Words that make a comment an instruction to a tool, wherever they stand in it.
const PRAGMA_WORDS: [&str; 12] = [
    "translate_off",
    "translate_on",
    "synthesis_off",
    "synthesis_on",
    "full_case",
    "parallel_case",
    "lint_off",
    "lint_on",
    "coverage_off",
    "coverage_on",
    "rtl_synthesis",
    "message_off",
];
/// Attributes that change the result of a synthesiser.
const ATTRIBUTES: [&str; 9] = [
    "translate_off",
    "translate_on",
    "full_case",
    "parallel_case",
    "blackbox",
    "whitebox",
    "noblackbox",
    "init",
    "synthesis",
];

/// The places of `text` that depend on the tool, in their order.
pub(super) fn in_verilog(text: &str) -> Vec<Dependent> {
    let mut found = Vec::new();
    let mut defined = BTreeSet::new();
    let mut rest = Rest { text, line: 1 };
    while let Some(first) = rest.text.chars().next() {
        let line = rest.line;
        let after = &rest.text[first.len_utf8()..];
        let mut add = |what: String| found.push(Dependent { line, what });
        match first {
            '/' if after.starts_with('/') => {
                let comment = rest.take(rest.text.find('\n').unwrap_or(rest.text.len()));
                add_comment(comment, &mut add);
            }
            '/' if after.starts_with('*') => {
                let end = rest.text[2..].find("*/").map_or(rest.text.len(), |at| at + 4);
                let comment = rest.take(end);
                add_comment(comment, &mut add);
            }
            '"' => {
                let length = string_length(rest.text);
                rest.take(length);
            }
            // An escaped identifier ends at white space.
            '\\' => {
                let end = rest.text.find(char::is_whitespace).unwrap_or(rest.text.len());
                rest.take(end);
            }
            '(' if after.starts_with('*') && !after[1..].trim_start().starts_with(')') => {
                let end = rest.text[2..].find("*)").map_or(rest.text.len(), |at| at + 4);
                let attribute = rest.take(end);
                let words = words(attribute);
                if let Some(word) = words.iter().find(|word| ATTRIBUTES.contains(&word.as_str())) {
                    add(format!("the attribute `{word}`"));
                }
            }
            '`' => {
                let name = identifier(after);
                rest.take(1 + name.len());
                match name {
                    DEFINE => drop(defined.insert(identifier(rest.text.trim_start()).to_owned())),
                    UNDEF => drop(defined.remove(identifier(rest.text.trim_start()))),
                    _ if PLAIN_DIRECTIVES.contains(&name) || defined.contains(name) => {}
                    _ => {
                        let argument = identifier(rest.text.trim_start_matches([' ', '\t']));
                        let names_macro = ["ifdef", "ifndef", "elsif"].contains(&name);
                        add(if names_macro {
                            format!("`{name} {argument}")
                        } else {
                            format!("`{name}")
                        });
                    }
                }
                if [DEFINE, UNDEF].contains(&name) {
                    // The name is not a use of the macro.
                    let blank = rest.text.len() - rest.text.trim_start().len();
                    rest.take(blank + identifier(rest.text.trim_start()).len());
                }
            }
            '$' => {
                let name = identifier(after);
                rest.take(1 + name.len());
                if !name.is_empty() && !PURE.contains(&name) {
                    add(format!("${name}"));
                }
            }
            _ if is_of_identifier(first) => {
                let length = identifier(rest.text).len();
                rest.take(length);
            }
            _ => drop(rest.take(first.len_utf8())),
        }
    }
    found
}

/// Returns the places of `theirs` that depend on the tool and are not in `ours`, regardless of their lines.
pub(super) fn added(ours: &str, theirs: &str) -> Vec<Dependent> {
    let mut known: Vec<String> = in_verilog(ours).into_iter().map(|place| place.what).collect();
    let is_new = |place: &Dependent| match known.iter().position(|what| *what == place.what) {
        Some(at) => {
            known.swap_remove(at);
            false
        }
        None => true,
    };
    in_verilog(theirs).into_iter().filter(is_new).collect()
}

/// The rest of a text, and the line in which it begins.
struct Rest<'a> {
    text: &'a str,
    line: usize,
}

impl<'a> Rest<'a> {
    fn take(&mut self, bytes: usize) -> &'a str {
        let (taken, rest) = self.text.split_at(bytes);
        self.line += taken.matches('\n').count();
        self.text = rest;
        taken
    }
}

fn add_comment(comment: &str, add: &mut impl FnMut(String)) {
    let words = words(comment);
    let order = words.first().is_some_and(|first| TOOLS.contains(&first.as_str()));
    if order || words.iter().any(|word| PRAGMA_WORDS.contains(&word.as_str())) {
        add(format!(
            "the comment `{}`",
            comment.split_whitespace().collect::<Vec<_>>().join(" ")
        ));
    }
}

/// The words of a text in lower case.
fn words(text: &str) -> Vec<String> {
    let words = text
        .split(|c: char| !is_of_identifier(c))
        .filter(|word| !word.is_empty());
    words.map(str::to_lowercase).collect()
}

/// Length in bytes of the string at the beginning.
fn string_length(text: &str) -> usize {
    let mut is_escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            // A string ends at the end of its line, whether it is complete or not.
            '\n' => return at,
            '"' if !is_escaped => return at + 1,
            _ => is_escaped = c == '\\' && !is_escaped,
        }
    }
    text.len()
}

/// The identifier at the beginning, with the `$` in it.
fn identifier(text: &str) -> &str {
    let end = text.find(|c| !is_of_identifier(c) && c != '$').unwrap_or(text.len());
    &text[..end]
}

fn is_of_identifier(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> Vec<(usize, String)> {
        in_verilog(text)
            .into_iter()
            .map(|place| (place.line, place.what))
            .collect()
    }

    #[test]
    fn text_that_tools_read_differently_is_found_with_its_line() {
        for (text, what) in [
            ("`ifdef VERILATOR", "`ifdef VERILATOR"),
            ("  `ifndef  SYNTHESIS", "`ifndef SYNTHESIS"),
            ("`elsif __ICARUS__", "`elsif __ICARUS__"),
            ("`include \"other.v\"", "`include"),
            ("assign a = `__ICARUS__;", "`__ICARUS__"),
            ("initial if ($test$plusargs(\"x\")) a = 1;", "$test$plusargs"),
            ("initial a = $random;", "$random"),
            ("initial $readmemh(\"a.hex\", words);", "$readmemh"),
            ("// synthesis translate_off", "the comment `// synthesis translate_off`"),
            ("//synopsys full_case", "the comment `//synopsys full_case`"),
            (
                "/*verilator lint_off WIDTH*/",
                "the comment `/*verilator lint_off WIDTH*/`",
            ),
            ("// Verilator tracing_off", "the comment `// Verilator tracing_off`"),
            ("/* pragma translate_off */", "the comment `/* pragma translate_off */`"),
            ("// rtl_synthesis off", "the comment `// rtl_synthesis off`"),
            ("(* full_case, x = 1 *) case (a)", "the attribute `full_case`"),
            ("(* translate_off *)", "the attribute `translate_off`"),
        ] {
            assert_eq!(
                found(&format!("module m;\n{text}\nendmodule\n")),
                [(2, what.to_owned())],
                "{text}"
            );
        }
    }

    #[test]
    fn text_that_all_tools_read_alike_is_not_found() {
        for text in [
            "`default_nettype none\n`timescale 1ns/1ns",
            "`define WIDTH 8\nwire [`WIDTH-1:0] a;",
            "wire signed [3:0] a = $signed(b) + $unsigned(c);",
            "// as the synthesis sees it, and Verilator too",
            "/* a comment over\n two lines: `ifdef A */",
            "initial $display(\"`ifdef // $random \\\" (* full_case\");",
            "wire \\`ifdef ; wire \\$random ;",
            "always @(*) begin end",
            "always @( * ) begin end",
            "(* no_rw_check, ramstyle = \"no_rw_check\" *) reg [7:0] words [0:3];",
            "wire a$random; wire _b$time;",
            "assign a = b / c; assign d = (a * b) / (c);",
        ] {
            assert_eq!(found(text), [], "{text}");
        }
        assert_eq!(found("`define A 1\n`undef A\n`A"), [(3, "`A".to_owned())]);
        assert_eq!(found("`A\n`define A 1"), [(1, "`A".to_owned())]);
    }

    #[test]
    fn text_that_was_there_before_is_not_added() {
        let ours = "initial $readmemh(\"a\", b);\n// verilator lint_off WIDTH\n";
        let theirs =
            "// mine\n// verilator lint_off WIDTH\ninitial $readmemh(\"a\", b);\ninitial $readmemh(\"c\", b);\n";
        let added: Vec<usize> = added(ours, theirs).into_iter().map(|place| place.line).collect();
        assert_eq!(added, [4]);
    }
}
