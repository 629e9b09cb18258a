//! Compares a folder's files with those that posicast generates from the machine file in it: tables, and any other
//! edits.
//!
//! The simulation shows whether the Verilog behaves like the model of the machine file. It does not show whether a
//! table that few samples reach matches the machine file, nor whether the Verilog was generated from this machine file.
//! Both are compared directly: a difference in a table, or in the machine file, is no match, whatever the simulation
//! shows. Verilog with other edits is reported, and is no match either, because no random run detects every fault that
//! an edit may introduce. A user who edits on purpose gives `--edited`, and both simulators then decide. Text that
//! [depends on the tool](super::dependence) is refused even then.

use super::dependence::{self, Dependent};
use crate::failure::Failure;
use posicast_hdl::emit::Module;
use posicast_synth::package::Contents;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Width of a coefficient, which is in the low bits of a word of a tap table; the other bits are the delay.
const COEFFICIENT_BITS: u32 = 18;
/// Suffix of the name of a tap table's module.
const TAPS: &str = "machine_taps";
/// Number of differences that the text shows; JSON has all.
const SHOWN: usize = 12;

/// A place where the folder differs from what posicast generates from the machine file in it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub(super) struct Difference {
    /// Path of the file in the folder.
    file: String,
    /// The first line that differs, from 1; `None` where the difference is the file as a whole.
    line: Option<usize>,
    kind: Kind,
    /// Description of the difference.
    what: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
enum Kind {
    /// The machine file was edited after the Verilog was generated.
    Machine,
    /// A word of a ROM differs.
    Table,
    /// A module that the machine file asks for is missing.
    Missing,
    /// The Verilog differs in another way.
    Verilog,
    /// The Verilog depends on the tool that reads it, and what posicast generates does not.
    Tool,
    /// Comments or white space differ.
    Comment,
    /// The folder has a file that posicast does not generate.
    Extra,
}

impl Kind {
    /// Whether the folder contradicts its machine file: a table, the machine file or the list of modules differs.
    fn contradicts(self) -> bool {
        matches!(self, Self::Machine | Self::Table | Self::Missing)
    }
}

/// The findings about a folder.
#[derive(Debug, Default, Serialize, JsonSchema)]
#[schemars(rename = "Folder")]
pub struct ComparedFolder {
    /// Number of Verilog files that are, byte for byte, what posicast generates.
    pub identical: usize,
    differences: Vec<Difference>,
    /// Whether the user asked that the simulation alone judges edited Verilog.
    edits_accepted: bool,
    #[serde(skip)]
    path: PathBuf,
}

impl ComparedFolder {
    /// Compares the folder `root` with these modules, which were generated from the machine file in it. With
    /// `edits_accepted`, edited Verilog is reported and does not fail.
    pub(super) fn compare(
        root: &Path,
        contents: &Contents,
        modules: &[Module],
        edits_accepted: bool,
    ) -> Result<Self, Failure> {
        let mut folder = Self {
            path: root.to_owned(),
            edits_accepted,
            ..Self::default()
        };
        if contents.edited.iter().any(|path| path == "machine.toml") {
            let what =
                "was edited after the Verilog was generated: its hash is not the one in posicast.json".to_owned();
            folder.add("machine.toml", None, Kind::Machine, what);
        }
        let mut rest: Vec<&PathBuf> = contents.rtl.iter().collect();
        let mut edited = String::new();
        for module in modules {
            let name = format!("{}.v", module.name);
            let file = format!("rtl/{name}");
            let Some(at) = rest.iter().position(|path| path.ends_with(&name)) else {
                let what = "is missing, and the machine file requires it".to_owned();
                folder.add(&file, None, Kind::Missing, what);
                continue;
            };
            let path = rest.swap_remove(at);
            let text = std::fs::read(path).map_err(Failure::of_file(path, "read it"))?;
            let text = String::from_utf8_lossy(&text);
            if text == module.text {
                folder.identical += 1;
            } else {
                folder.file(&file, &module.name, &module.text, &text);
                edited += &text;
            }
        }
        for path in rest {
            // No tool reads a file that no edited file can reach.
            let text = std::fs::read(path).map_err(Failure::of_file(path, "read it"))?;
            let text = String::from_utf8_lossy(&text).into_owned();
            if modules_in(&text).any(|module| names_in(&edited).any(|name| name == module)) {
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                folder.depending(&format!("rtl/{name}"), &dependence::in_verilog(&text));
            }
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let what = "is not a file that posicast generates for this machine".to_owned();
            folder.add(&format!("rtl/{name}"), None, Kind::Extra, what);
        }
        Ok(folder)
    }

    fn add(&mut self, file: &str, line: Option<usize>, kind: Kind, what: String) {
        self.differences.push(Difference {
            file: file.to_owned(),
            line,
            kind,
            what,
        });
    }

    /// Adds the places of a file that depend on the tool.
    fn depending(&mut self, file: &str, places: &[Dependent]) {
        for place in places {
            let what = format!("{} means something else to another tool", place.what);
            self.add(file, Some(place.line), Kind::Tool, what);
        }
    }

    /// Compares a file of the module `name`, whose text differs from the `wanted` one.
    fn file(&mut self, file: &str, name: &str, wanted: &str, text: &str) {
        self.depending(file, &dependence::added(wanted, text));
        let (ours, theirs) = (words(wanted), words(text));
        for (address, (_, word)) in &ours {
            let found = theirs.get(address);
            if found.is_none_or(|(_, found)| found != word) {
                let line = found.map(|(line, _)| *line);
                let found = found.map(|(_, found)| found.as_str());
                self.add(file, line, Kind::Table, word_difference(name, *address, found, word));
            }
        }
        for (address, (line, found)) in &theirs {
            if !ours.contains_key(address) {
                let what = format!("word {address} is {found}; the machine file has no such word");
                self.add(file, Some(*line), Kind::Table, what);
            }
        }
        let (ours, theirs) = (code(wanted), code(text));
        let first = first_difference(&ours, &theirs);
        let tables = self.differences.iter().any(|d| d.file == file && d.kind == Kind::Table);
        match first {
            Some((line, found)) => {
                let what = format!("is not what posicast generates; first: `{found}`");
                self.add(file, Some(line), Kind::Verilog, what);
            }
            None if !tables => {
                let what = "differs from what posicast generates in comments or white space".to_owned();
                self.add(file, None, Kind::Comment, what);
            }
            None => {}
        }
    }

    /// Whether the folder is no match, whatever the simulation shows.
    pub(super) fn fails(&self) -> bool {
        self.contradicts() || self.depends_on_tool() || (self.edited() > 0 && !self.edits_accepted)
    }

    /// Whether a table, the machine file or the list of modules differs from posicast's.
    pub(super) fn contradicts(&self) -> bool {
        self.differences.iter().any(|difference| difference.kind.contradicts())
    }

    /// Whether Verilog was edited so that it depends on the tool that reads it.
    pub(super) fn depends_on_tool(&self) -> bool {
        self.differences.iter().any(|difference| difference.kind == Kind::Tool)
    }

    /// Names of the edited files whose edits are accepted, so that the simulation decides.
    pub(super) fn accepted(&self) -> Vec<&str> {
        let edited = self.differences.iter().filter(|d| d.kind == Kind::Verilog);
        let names = edited.filter_map(|d| Path::new(&d.file).file_name()?.to_str());
        names.filter(|_| self.edits_accepted && !self.fails()).collect()
    }

    /// Number of edited files of Verilog, without tables.
    #[must_use]
    pub fn edited(&self) -> usize {
        self.differences.iter().filter(|d| d.kind == Kind::Verilog).count()
    }

    /// A line per difference, then the remedy: a message of the step, and a part of its result.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = String::new();
        for difference in self.differences.iter().take(SHOWN) {
            let line = difference.line.map_or_else(String::new, |line| format!(":{line}"));
            text += &format!("{}{line}: {}\n", difference.file, difference.what);
        }
        if self.differences.len() > SHOWN {
            text += &format!("… and {} more, all of them in --json\n", self.differences.len() - SHOWN);
        }
        if self.fails() {
            let path = self.path.display();
            text += &format!(
                "To write the Verilog of the machine file anew: posicast generate {path}/machine.toml -o {path}_new. "
            );
            text += match (self.contradicts(), self.depends_on_tool()) {
                (true, _) => {
                    "To keep a table that was edited, put it into the machine file instead (kind = \"custom\").\n"
                }
                (false, true) => "Remove the text that depends on the tool; --edited does not accept it.\n",
                (false, false) => {
                    "Use --edited to let only the simulation, in both simulators, judge the edited files.\n"
                }
            };
        }
        text
    }
}

/// Names of the modules that a text defines.
fn modules_in(text: &str) -> impl Iterator<Item = &str> {
    let mut before = "";
    names_in(text).filter(move |name| std::mem::replace(&mut before, name) == "module")
}

/// The words of a text, some of which are names of modules.
fn names_in(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !(c.is_alphanumeric() || "_$".contains(c)))
        .filter(|name| !name.is_empty())
}

type Words = std::collections::BTreeMap<u64, (usize, String)>;

/// Address and value of a statement `words[N] = VALUE;`.
fn words_of(line: &str) -> Option<(u64, String)> {
    let (address, rest) = line.trim().strip_prefix("words[")?.split_once(']')?;
    let (value, after) = rest.trim().strip_prefix('=')?.split_once(';')?;
    // If another statement follows in the line, the line is code.
    let is_comment = after.trim().is_empty() || after.trim().starts_with("//");
    let is_number = value
        .trim()
        .chars()
        .all(|c| c.is_ascii_alphanumeric() || "'_".contains(c));
    (is_comment && is_number).then_some(())?;
    Some((address.trim().parse().ok()?, value.trim().to_owned()))
}

/// The words of a ROM: the value by its address, with its line.
fn words(text: &str) -> Words {
    let words = (1..).zip(text.lines());
    words
        .filter_map(|(line, text)| words_of(text).map(|(address, value)| (address, (line, value))))
        .collect()
}

/// The lines with code, without comments and with single spaces, with their numbers. Words of a ROM are left out.
fn code(text: &str) -> Vec<(usize, String)> {
    let lines = (1..).zip(text.lines());
    let plain = lines
        .filter(|(_, line)| words_of(line).is_none())
        .map(|(number, line)| {
            let code = line.split_once("//").map_or(line, |(code, _)| code);
            (number, code.split_whitespace().collect::<Vec<_>>().join(" "))
        });
    plain.filter(|(_, line)| !line.is_empty()).collect()
}

/// The first line of `theirs` that differs from `ours`, with its number.
fn first_difference(ours: &[(usize, String)], theirs: &[(usize, String)]) -> Option<(usize, String)> {
    let differs = ours.iter().zip(theirs).find(|((_, our), (_, their))| our != their);
    if let Some((_, (line, found))) = differs {
        return Some((*line, found.clone()));
    }
    match ours.len().cmp(&theirs.len()) {
        std::cmp::Ordering::Equal => None,
        std::cmp::Ordering::Less => theirs.get(ours.len()).cloned(),
        std::cmp::Ordering::Greater => {
            let last = theirs.last().map_or(1, |(line, _)| *line);
            Some((last, "the end of the file".to_owned()))
        }
    }
}

/// Describes a differing word in the table of `module`.
fn word_difference(module: &str, address: u64, found: Option<&str>, wanted: &str) -> String {
    let Some(found) = found else {
        return format!("word {address} is missing; the machine file gives {wanted}");
    };
    match (module.ends_with(TAPS), tap(found), tap(wanted)) {
        (true, Some(found), Some(wanted)) => {
            let [found, wanted] =
                [found, wanted].map(|(coefficient, delay)| format!("coefficient {coefficient} after {delay} samples"));
            format!("tap {address} has {found}; the machine file gives {wanted}")
        }
        _ => format!("word {address} is {found}; the machine file gives {wanted}"),
    }
}

/// Coefficient and delay of a word such as `25'h0982e5e`.
fn tap(word: &str) -> Option<(i64, u64)> {
    let (_, digits) = word.split_once("'h")?;
    let word = u64::from_str_radix(digits, 16).ok()?;
    let unused = 64 - COEFFICIENT_BITS;
    Some((((word << unused) as i64) >> unused, word >> COEFFICIENT_BITS))
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROM: &str =
        "module m_machine_taps;\n    words[0] = 25'h000634c; // 0.38\n    words[1] = 25'h0982e5e;\nendmodule\n";

    fn compared(text: &str) -> ComparedFolder {
        let mut folder = ComparedFolder::default();
        folder.file("rtl/m_machine_taps.v", "m_machine_taps", ROM, text);
        folder
    }

    #[test]
    fn a_changed_delay_is_a_difference_of_the_table_and_named() {
        let folder = compared(&ROM.replace("25'h0982e5e", "25'h0942e5e"));
        assert!(folder.fails());
        let [difference] = folder.differences.as_slice() else {
            panic!("{folder:?}");
        };
        assert_eq!((difference.kind, difference.line), (Kind::Table, Some(3)));
        assert_eq!(
            difference.what,
            "tap 1 has coefficient 11870 after 37 samples; the machine file gives coefficient 11870 after 38 samples"
        );
    }

    #[test]
    fn only_edited_verilog_fails_unless_it_is_accepted() {
        for (from, to, kind) in [
            ("// 0.38", "// three eighths", Kind::Comment),
            ("    words[1]", "\twords[1]", Kind::Comment),
            ("endmodule", "initial $stop;\nendmodule", Kind::Verilog),
        ] {
            let mut folder = compared(&ROM.replace(from, to));
            assert_eq!(folder.fails(), kind == Kind::Verilog, "{to}");
            folder.edits_accepted = true;
            assert!(!folder.fails() && !folder.contradicts(), "{to}");
            assert_eq!(folder.differences.len(), 1, "{to}: {folder:?}");
            assert_eq!(folder.differences[0].kind, kind, "{to}");
        }
    }

    #[test]
    fn text_that_depends_on_the_tool_fails_even_if_edits_are_accepted() {
        for (to, line) in [
            ("`ifdef VERILATOR\n`endif\nendmodule", 4),
            ("// synthesis translate_off\nendmodule", 4),
            ("initial if ($test$plusargs(\"a\")) $stop;\nendmodule", 4),
        ] {
            let mut folder = compared(&ROM.replace("endmodule", to));
            folder.edits_accepted = true;
            assert!(
                folder.fails() && !folder.contradicts() && folder.accepted().is_empty(),
                "{to}"
            );
            assert_eq!(
                (folder.differences[0].kind, folder.differences[0].line),
                (Kind::Tool, Some(line)),
                "{to}"
            );
        }
    }

    #[test]
    fn a_statement_behind_a_word_is_code() {
        for to in ["25'h0982e5e; initial words[0] = 25'h0;", "25'h0982e5e + y;"] {
            let folder = compared(&ROM.replace("25'h0982e5e;", to));
            assert!(
                folder
                    .differences
                    .iter()
                    .any(|d| d.kind == Kind::Verilog || d.kind == Kind::Table),
                "{to}"
            );
            assert!(folder.fails(), "{to}");
        }
    }

    #[test]
    fn words_that_are_missing_or_new_fail() {
        assert!(compared(&ROM.replace("    words[1] = 25'h0982e5e;\n", "")).fails());
        assert!(compared(&ROM.replace("endmodule", "    words[7] = 25'h0000001;\nendmodule")).fails());
    }
}
