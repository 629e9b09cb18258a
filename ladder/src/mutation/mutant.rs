//! A mutant, as Yosys lists it.

use std::fmt;

/// One fault in a netlist.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mutant {
    /// Number in the list, from 1, which is also the value of `mutsel` that selects it.
    pub number: usize,
    /// Arguments of Yosys's `mutate` that make it.
    pub(super) arguments: String,
    /// Kind of the fault: `const0`, `const1`, `inv`, `cnot0` or `cnot1`.
    mode: String,
    pub(super) module: String,
    cell: String,
    port: String,
    /// Name of the register or wire to which the bit belongs, if it has one.
    wire: Option<String>,
    bit: String,
    /// Verilog file and line.
    source: Option<String>,
}

impl Mutant {
    /// Parses a line of `mutate -list … -ctrl NAME WIDTH VALUE`; `None` for the line that changes nothing.
    pub(super) fn parse(line: &str) -> Option<Self> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let after = |option: &str| {
            let at = words.iter().position(|word| *word == option)?;
            words.get(at + 1).copied().map(str::to_owned)
        };
        let control = words.iter().position(|word| *word == "-ctrl")?;
        let number = words.get(control + 3)?.parse().ok()?;
        let wire = after("-wire").map(|wire| match after("-wirebit") {
            Some(bit) => format!("{wire}[{bit}]"),
            None => wire,
        });
        Some(Self {
            number,
            arguments: words.get(control + 4..)?.join(" "),
            mode: after("-mode").filter(|mode| mode != "none")?,
            module: after("-module")?,
            cell: after("-cell")?,
            port: after("-port")?,
            wire,
            bit: after("-portbit")?,
            source: after("-src").map(|place| line_of(&place)),
        })
    }

    /// The mutant with another number.
    pub(super) fn numbered(self, number: usize) -> Self {
        Self { number, ..self }
    }

    /// Its line among those of unknown mutants, which may end with the clock that a search found. Numbers of lines are
    /// not compared: a comment moves them, and Yosys's number of the cell tells cells of one kind apart.
    pub(super) fn line_among<'a>(&self, lines: &'a [String]) -> Option<&'a str> {
        let own = without_lines(&self.to_string());
        let is_own = |line: &&String| without_lines(line.split("; ").next().unwrap_or(line)) == own;
        lines.iter().find(is_own).map(String::as_str)
    }

    /// Whether registers keep their properties. They do not with a fault at their output, with which Yosys loses the
    /// power-up value, or at their clock.
    pub(super) fn keeps_registers(&self) -> bool {
        self.port != "Q" && self.port != "CLK"
    }
}

/// Shortens `FILE:LINE.COLUMN-LINE.COLUMN` to `FILE:LINE`.
fn line_of(place: &str) -> String {
    place.split('.').take(2).collect::<Vec<_>>().join(".")
}

impl fmt::Display for Mutant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            mode,
            module,
            cell,
            port,
            bit,
            ..
        } = self;
        write!(f, "{mode} at {port}[{bit}] of {cell} in {module}")?;
        if let Some(wire) = &self.wire {
            write!(f, ", {wire}")?;
        }
        match &self.source {
            Some(source) => write!(f, ", {source}"),
            None => Ok(()),
        }
    }
}

/// Shortens each `FILE.v:LINE` to `FILE.v`.
fn without_lines(text: &str) -> String {
    let mut parts = text.split(".v:");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| {
        text + ".v" + part.trim_start_matches(|character: char| character.is_ascii_digit())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_yosys_are_read() {
        let line = "mutate -ctrl mutsel 16 2 -mode const1 -module velocity -cell $procmux$2533 -port Y -portbit 6 \
                    -wire borrow -wirebit 6 -src velocity.v:42.24-42.30 -src velocity.v:164.13-164.33";
        let mutant = Mutant::parse(line).unwrap();
        assert_eq!(mutant.number, 2);
        assert!(
            mutant.arguments.starts_with("-mode const1 -module velocity "),
            "{mutant:?}"
        );
        assert_eq!(
            mutant.to_string(),
            "const1 at Y[6] of $procmux$2533 in velocity, borrow[6], velocity.v:42"
        );
        assert!(mutant.keeps_registers());
        let found = format!("{mutant}; a search tells it from the block after 3 clocks");
        assert_eq!(
            mutant.line_among(&[mutant.to_string().replace("borrow[6]", "borrow[7]"), found.clone()]),
            Some(found.as_str())
        );
        let moved = found.replace("velocity.v:42", "velocity.v:43");
        assert_eq!(mutant.line_among(std::slice::from_ref(&moved)), Some(moved.as_str()));
        let register = Mutant::parse(&line.replace("-port Y", "-port Q")).unwrap();
        assert!(!register.keeps_registers());
        assert_eq!(Mutant::parse("mutate -ctrl mutsel 16 0 -mode none"), None);
    }
}
