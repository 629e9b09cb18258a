//! The result of a lock step, as data (the contract's `verify --json`) and as text for engineers.

use std::fmt::{self, Write as _};

use posicast_blocks::{Direction, Port};
use schemars::JsonSchema;
use serde::Serialize;

use super::window::{Row, Window};
use crate::blocks::ReachedCount;
use wavecmp::diff::{Shown, View, value, value_and_digits};

/// Verdict of a lock step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LockstepVerdict {
    /// Every value of every clock was equal, and all that the verdict speaks of was exercised.
    Match,
    /// At least one value differed.
    Mismatch,
    /// No value differed, but nothing was compared, or too little was exercised.
    NoVerdict,
}

/// Result of a whole run, which serialises to `verify --json`.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct LockstepReport {
    /// The verdict over all blocks. There is none on a run without clocks, which shows nothing, nor on one that has not
    /// exercised all that it should ([`BlockReport::not_exercised`]).
    pub result: LockstepVerdict,
    /// Number of clocks compared.
    pub cycles: u64,
    /// Number of output samples compared, over all blocks: clocks in which the model's `valid` was high.
    pub samples: u64,
    /// One entry per instance.
    pub blocks: Vec<BlockReport>,
}

impl LockstepReport {
    /// Makes the report of one run from its blocks.
    pub fn new(cycles: u64, blocks: Vec<BlockReport>) -> Self {
        let shows_all = cycles > 0 && !blocks.is_empty() && blocks.iter().all(|block| block.not_exercised.is_empty());
        let differs = blocks.iter().any(|block| block.mismatches > 0);
        Self {
            result: match (differs, shows_all) {
                (true, _) => LockstepVerdict::Mismatch,
                (false, true) => LockstepVerdict::Match,
                (false, false) => LockstepVerdict::NoVerdict,
            },
            cycles,
            samples: blocks.iter().filter_map(|b| b.samples).sum(),
            blocks,
        }
    }

    /// Joins the reports of several runs: their blocks one after the other, clocks and samples added.
    pub fn joined(reports: Vec<LockstepReport>) -> Self {
        let cycles = reports.iter().map(|r| r.cycles).fold(0, u64::saturating_add);
        let is_match = reports.iter().all(|r| r.result == LockstepVerdict::Match);
        let mut all = Self::new(cycles, reports.into_iter().flat_map(|r| r.blocks).collect());
        // One of them may have had no clock.
        if !is_match && all.result == LockstepVerdict::Match {
            all.result = LockstepVerdict::NoVerdict;
        }
        all
    }

    /// Adds what was not exercised, each with the instance of its row.
    pub fn without(mut self, missing: Vec<(String, String)>) -> Self {
        for (instance, what) in missing {
            let row = self.blocks.iter_mut().find(|block| block.instance == instance);
            if let Some(row) = row {
                row.not_exercised.push(what);
            }
        }
        Self::new(self.cycles, self.blocks)
    }

    /// Adds what the clocks reached, each with the instance of its row. What is below its bar counts as not exercised. Samples
    /// are those counted here where a block has no `valid`.
    pub fn with_reached(mut self, counts: Vec<(String, ReachedCount)>) -> Self {
        let low = counts.iter().filter(|(_, count)| count.is_low());
        let low = low.map(|(row, count)| {
            (
                row.clone(),
                format!("{} {} of at least {}", count.count, count.what, count.least),
            )
        });
        let low: Vec<(String, String)> = low.collect();
        for block in &mut self.blocks {
            let own = counts.iter().filter(|(row, _)| *row == block.instance);
            block.reached = own.map(|(_, count)| count.clone()).collect();
            let samples = block.reached.iter().filter(|count| count.what.starts_with("samples"));
            let samples = samples.map(|count| count.count).reduce(|all, more| all + more);
            block.samples = block.samples.or(samples);
        }
        self.without(low)
    }

    /// Adds bits of words that never changed, each with the instance of its row.
    pub fn with_unchanged(mut self, bits: Vec<(String, String)>) -> Self {
        for (instance, bits) in bits {
            let row = self.blocks.iter_mut().find(|block| block.instance == instance);
            row.into_iter().for_each(|row| row.unchanged.push(bits.clone()));
        }
        self
    }

    /// Number of things that were not exercised, in all rows.
    pub fn not_exercised(&self) -> usize {
        self.blocks.iter().map(|block| block.not_exercised.len()).sum()
    }

    /// Names of what was not exercised, each with the name of its row.
    pub fn not_exercised_names(&self) -> Vec<String> {
        let of_block = |block: &BlockReport| -> Vec<String> {
            let name = |what: &String| format!("{} {}: {what}", block.name, block.instance);
            block.not_exercised.iter().map(name).collect()
        };
        self.blocks.iter().flat_map(of_block).collect()
    }

    /// Number of wrong values over all blocks.
    pub fn mismatches(&self) -> u64 {
        self.blocks.iter().map(|b| b.mismatches).sum()
    }
}

/// Result for one instance of a block.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct BlockReport {
    /// Name of the block.
    pub name: String,
    /// The axis, or the size.
    pub instance: String,
    /// Number of clocks compared.
    pub cycles: u64,
    /// Number of output samples compared; `None` if the block has no `valid`.
    #[serde(skip)]
    pub samples: Option<u64>,
    /// Number of wrong values: outputs times clocks.
    pub mismatches: u64,
    /// The first wrong value.
    pub first: Option<Mismatch>,
    /// What the run should have exercised and did not, in words: a tap, a bank, a flag.
    pub not_exercised: Vec<String>,
    /// Bits of words that kept one level during the whole run, as `word[31:20]`: mostly the upper bits of counters.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unchanged: Vec<String>,
    /// What the clocks reached, with the bars.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub reached: Vec<ReachedCount>,
    /// Findings of a directed test that the lock step cannot see, in words.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<String>,
}

/// The first wrong value of a block, with the clocks around it. `Display` draws the table.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Mismatch {
    /// Number of clocks since the start of the run.
    pub time: u64,
    /// Name of the output.
    pub signal: String,
    /// Value of the model as a binary string, most significant bit first.
    pub expected: String,
    /// Value of the device, which may contain `x`.
    pub actual: String,
    /// Values of model and device in a form for people.
    #[serde(skip)]
    shown: [String; 2],
    /// The clocks around it, with a row per port.
    #[serde(skip)]
    table: Table,
}

#[derive(Debug, Clone, PartialEq, Eq)]
struct Table {
    times: Vec<u64>,
    /// Names and cells; the block's own outputs occur twice, model above device, where they differ.
    rows: Vec<(String, Vec<String>)>,
}

impl Mismatch {
    /// Values of model and device, in readable form.
    pub fn shown(&self) -> [&str; 2] {
        self.shown.each_ref().map(String::as_str)
    }

    pub(super) fn new(ports: &[Port], own: &[String], window: &Window) -> Self {
        let (time, output) = window.mismatch;
        let outputs: Vec<&Port> = outputs_of(ports).collect();
        let port = outputs[output];
        let at = window.rows().iter().find(|row| row.time == time);
        let (expected, actual, unknown) = at.map_or((0, 0, 0), |row| {
            (row.expected[output], row.actual[output], row.unknown[output])
        });
        let (expected, actual) = (binary(port.width, expected, 0), binary(port.width, actual, unknown));
        Self {
            time,
            signal: port.name.clone(),
            shown: [&expected, &actual].map(|digits| value_and_digits(&Shown::Bits(digits.clone()), view(port))),
            expected,
            actual,
            table: Table::new(ports, own, window.rows()),
        }
    }
}

impl Table {
    fn new(ports: &[Port], own: &[String], rows: &[Row]) -> Self {
        let mut table = Self {
            times: rows.iter().map(|row| row.time).collect(),
            rows: Vec::new(),
        };
        let inputs = ports.iter().filter(|p| p.direction == Direction::Input);
        for (at, port) in inputs.enumerate() {
            let cells = rows.iter().map(|row| number(port, row.inputs[at], 0));
            table.rows.push((port.name.clone(), cells.collect()));
        }
        for (at, port) in outputs_of(ports).enumerate() {
            if !own.contains(&port.name) {
                continue;
            }
            let expected: Vec<String> = rows.iter().map(|row| number(port, row.expected[at], 0)).collect();
            let actual = rows.iter().map(|row| number(port, row.actual[at], row.unknown[at]));
            let actual: Vec<String> = actual.collect();
            if expected == actual {
                table.rows.push((port.name.clone(), expected));
            } else {
                let marked = actual.into_iter().zip(&expected);
                let marked = marked.map(|(a, e)| if a == *e { a } else { format!("*{a}") }).collect();
                table.rows.push((format!("{} (model)", port.name), expected));
                table.rows.push((format!("{} (device)", port.name), marked));
            }
        }
        table
    }
}

/// A binary string, most significant bit first, with unknown bits as `x`.
fn binary(width: u32, value: u64, unknown: u64) -> String {
    let bit = |at: u32| match (unknown >> at & 1, value >> at & 1) {
        (1, _) => 'x',
        (_, 1) => '1',
        _ => '0',
    };
    (0..width.min(64)).rev().map(bit).collect()
}

/// View of a port for engineers: a number, with a sign if the port has one.
fn view(port: &Port) -> View {
    match (port.width, port.signed) {
        (..=1, _) => View::Bits,
        (_, true) => View::Signed { fraction: 0 },
        (_, false) => View::Unsigned { fraction: 0 },
    }
}

/// A value for engineers: decimal, or hexadecimal if bits are unknown.
fn number(port: &Port, bits: u64, unknown: u64) -> String {
    value(&Shown::Bits(binary(port.width, bits, unknown)), view(port))
}

/// Number of columns of the text.
const COLUMNS: usize = 100;

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "first mismatch in clock {}: `{}` is {}, the model has {}",
            self.time, self.signal, self.shown[1], self.shown[0]
        )?;
        let names = self.table.rows.iter().map(|(name, _)| name.chars().count());
        let name_width = names.max().unwrap_or(0).max("clock".len());
        let mut lines = vec![format!("{:name_width$}", "clock")];
        lines.extend(self.table.rows.iter().map(|(name, _)| format!("{name:name_width$}")));
        for (column, time) in self.table.times.iter().enumerate() {
            let cells = self.table.rows.iter().map(|(_, cells)| cells[column].as_str());
            let width = cells.clone().map(str::len).max().unwrap_or(0);
            let head = time.to_string();
            let width = width.max(head.len());
            // Clocks after the mismatch that do not fit are left out.
            if *time > self.time && lines[0].chars().count() + 2 + width > COLUMNS {
                break;
            }
            for (line, cell) in lines.iter_mut().zip(std::iter::once(head.as_str()).chain(cells)) {
                // Writing to a `String` cannot fail.
                let _ = write!(line, "  {cell:>width$}");
            }
        }
        f.write_str(&lines.join("\n"))
    }
}

pub(super) fn outputs_of(ports: &[Port]) -> impl Iterator<Item = &Port> {
    ports.iter().filter(|p| p.direction == Direction::Output)
}
