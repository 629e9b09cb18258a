//! The result of a lock step, as data (the contract's `verify --json`) and as text for an engineer.

use std::fmt::{self, Write as _};

use posicast_model::rtl::{Direction, Port};
use serde::Serialize;

use super::window::{Row, Window};
use wavecmp::diff::{Shown, View, value, value_and_digits};

/// Match or mismatch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum LockstepVerdict {
    /// Every value of every clock was equal.
    Match,
    /// At least one was not.
    Mismatch,
}

/// A whole run. Serialises to `verify --json`.
#[derive(Debug, Clone, Serialize)]
pub struct LockstepReport {
    /// The verdict over all blocks. A run of no clocks is a mismatch: it shows nothing; nor does one that has not
    /// exercised all it should ([`BlockReport::not_exercised`]).
    pub result: LockstepVerdict,
    /// Clocks compared.
    pub cycles: u64,
    /// Output samples compared, over all blocks: clocks in which the model's `valid` was high.
    pub samples: u64,
    /// One entry per instance.
    pub blocks: Vec<BlockReport>,
}

impl LockstepReport {
    /// From the blocks of one run.
    pub fn new(cycles: u64, blocks: Vec<BlockReport>) -> Self {
        let holds = |block: &BlockReport| block.mismatches == 0 && block.not_exercised.is_empty();
        let equal = cycles > 0 && !blocks.is_empty() && blocks.iter().all(holds);
        Self {
            result: if equal {
                LockstepVerdict::Match
            } else {
                LockstepVerdict::Mismatch
            },
            cycles,
            samples: blocks.iter().filter_map(|b| b.samples).sum(),
            blocks,
        }
    }

    /// Several runs as one: their blocks after one another, clocks and samples added.
    pub fn joined(reports: Vec<LockstepReport>) -> Self {
        let cycles = reports.iter().map(|r| r.cycles).fold(0, u64::saturating_add);
        let equal = !reports.is_empty() && reports.iter().all(|r| r.result == LockstepVerdict::Match);
        let mut all = Self::new(cycles, reports.into_iter().flat_map(|r| r.blocks).collect());
        if !equal {
            all.result = LockstepVerdict::Mismatch;
        }
        all
    }

    /// The same, where this was not exercised: the instance of a row, and what it is.
    pub fn without(mut self, missing: Vec<(String, String)>) -> Self {
        for (instance, what) in missing {
            let row = self.blocks.iter_mut().find(|block| block.instance == instance);
            if let Some(row) = row {
                row.not_exercised.push(what);
            }
        }
        Self::new(self.cycles, self.blocks)
    }

    /// The same, where these bits of words never changed: the instance of a row, and the bits.
    pub fn with_unchanged(mut self, bits: Vec<(String, String)>) -> Self {
        for (instance, bits) in bits {
            let row = self.blocks.iter_mut().find(|block| block.instance == instance);
            row.into_iter().for_each(|row| row.unchanged.push(bits.clone()));
        }
        self
    }

    /// What was not exercised, in all rows: how much.
    pub fn not_exercised(&self) -> usize {
        self.blocks.iter().map(|block| block.not_exercised.len()).sum()
    }

    /// What was not exercised, each behind the name of its row.
    pub fn not_exercised_names(&self) -> Vec<String> {
        let of_block = |block: &BlockReport| -> Vec<String> {
            let name = |what: &String| format!("{} {}: {what}", block.name, block.instance);
            block.not_exercised.iter().map(name).collect()
        };
        self.blocks.iter().flat_map(of_block).collect()
    }

    /// Wrong values over all blocks.
    pub fn mismatches(&self) -> u64 {
        self.blocks.iter().map(|b| b.mismatches).sum()
    }
}

/// One instance of a block.
#[derive(Debug, Clone, Serialize)]
pub struct BlockReport {
    /// The block's name.
    pub name: String,
    /// The axis, or the size.
    pub instance: String,
    /// Clocks compared.
    pub cycles: u64,
    /// Output samples compared; none where the block has no `valid`.
    #[serde(skip)]
    pub samples: Option<u64>,
    /// Wrong values: outputs times clocks.
    pub mismatches: u64,
    /// The first of them.
    pub first: Option<Mismatch>,
    /// What the run should have driven and did not, in words: a tap, a bank, a flag.
    pub not_exercised: Vec<String>,
    /// Bits of words that had one level all the run, as `word[31:20]`: the upper ones of counters, mostly.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unchanged: Vec<String>,
    /// What a directed test found that the lock step cannot see, in its words.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<String>,
}

/// The first wrong value of a block, with the clocks around it. `Display` draws the table.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Mismatch {
    /// Clocks since the start of the run.
    pub time: u64,
    /// The output.
    pub signal: String,
    /// What the model says, as a binary string, most significant bit first.
    pub expected: String,
    /// What the device shows; may hold `x`.
    pub actual: String,
    /// What the model says and what the device shows, as people read it.
    #[serde(skip)]
    shown: [String; 2],
    /// The clocks around it: a row per port.
    #[serde(skip)]
    table: Table,
}

#[derive(Debug, Clone, PartialEq, Eq)]
struct Table {
    times: Vec<u64>,
    /// Name and cells; the block's own outputs twice, model above device, where they differ.
    rows: Vec<(String, Vec<String>)>,
}

impl Mismatch {
    /// What the model says and what the device shows, as people read it.
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

/// Binary, most significant bit first, unknown bits as `x`.
fn binary(width: u32, value: u64, unknown: u64) -> String {
    let bit = |at: u32| match (unknown >> at & 1, value >> at & 1) {
        (1, _) => 'x',
        (_, 1) => '1',
        _ => '0',
    };
    (0..width.min(64)).rev().map(bit).collect()
}

/// How an engineer reads a port: as a number, with sign where the port has one.
fn view(port: &Port) -> View {
    match (port.width, port.signed) {
        (..=1, _) => View::Bits,
        (_, true) => View::Signed { fraction: 0 },
        (_, false) => View::Unsigned { fraction: 0 },
    }
}

/// As an engineer reads it: decimal, hexadecimal where bits are unknown.
fn number(port: &Port, bits: u64, unknown: u64) -> String {
    value(&Shown::Bits(binary(port.width, bits, unknown)), view(port))
}

/// Columns of the text.
const COLUMNS: usize = 100;

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "first mismatch in clock {}: `{}` is {}, the model says {}",
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
            // Clocks behind the mismatch that do not fit are left out.
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
