//! The page `docs/area.md`, and the figures that have grown since it was written.

use crate::Measured;
use posicast_synth::yosys::{Family, Resources};
use posicast_testbench::blocks::AreaRow;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::Write;

const HEAD: &str =
    "| block | size | LUT | flip-flops | LE | M4K | 18×18 | LE unpacked | LUT by Yosys alone | budget | note | Verilog |
|---|---|---|---|---|---|---|---|---|---|---|---|
";

/// The name of the row of the whole stage.
pub(crate) const STAGE: &str = "stage";

/// Checksum of a row's Verilog: 8 hexadecimal digits.
pub(crate) fn checksum(row: &AreaRow) -> String {
    let mut hash = Sha256::new();
    for module in &row.modules {
        hash.update(&module.text);
    }
    hash.finalize()
        .iter()
        .take(4)
        .map(|byte| format!("{byte:02x}"))
        .collect()
}

/// The line of a row.
pub(crate) fn line(one: &Measured<'_>) -> String {
    let Measured { row, resources, .. } = one;
    let budget = row.budget.map_or("–".to_owned(), |budget| {
        let above = resources.luts > budget.luts || resources.registers > budget.flip_flops;
        let mark = if above { "⚠ " } else { "" };
        format!("{mark}{} + {}", budget.luts, budget.flip_flops)
    });
    format!(
        "| {} | {} | {} | {} | {} | {budget} | {} | {} |",
        row.block,
        row.size,
        figures(resources),
        resources.unpacked_cells,
        one.luts_by_yosys.map_or("–".to_owned(), |luts| luts.to_string()),
        row.note,
        one.checksum
    )
}

/// The whole page, of the lines of the rows in their order.
pub(crate) fn page(tool: &str, lines: &[(usize, String)]) -> String {
    let device = Family::Cyclone2.device();
    let mut text = format!(
        "# Area\n\n\
         This page lists what each block takes of an {} ({} LE, {} M4K blocks, {} multipliers). The figures are **an estimate by\n\
         {tool}**, before place and route; [synthesis](synthesis.md) explains how they are made. The page is written by\n\n\
         ```\n\
         cargo run --release -p posicast --example budgets -- --write\n\
         ```\n\n\
         Without `--write` the command compares, and fails if a figure has grown. It measures the rows whose Verilog has another checksum\n\
         than the last column says; `--again` measures all.\n\n\
         - **LUT**: logic, mapped with the carry chain and the synchronous clear of a logic element. **LUT by Yosys alone** is without both,\n  \
         because `synth_intel -family cycloneive` does not map them: sums and resets then count as logic.\n\
         - **LE**: the LUTs, and the flip-flops that cannot be packed. A flip-flop is packed if a LUT drives it, if a multiplier has it built\n  \
         in, or if a LUT of at most three inputs is left to share its element with it. **LE unpacked** is without that sharing. Quartus\n  \
         shares only as much as a design needs to fit, so in a device with room its figure is nearer to this one.\n\
         - **M4K**: counted by the shape of the ports. **18×18**: multipliers, counted by the width of their operands.\n\
         - **budget**: LUT + flip-flops, for blocks that have one. The note says what exceeds it (⚠), or what takes most.\n\n\
         {HEAD}",
        device.name, device.cells, M4K_BLOCKS, device.multipliers
    );
    for (_, line) in lines {
        let _ = writeln!(text, "{line}");
    }
    let cells = device.cells * 55 / 100;
    let _ = write!(
        text,
        "\n## The XY stage\n\n\
         The budget is {cells} LE (55 %), 18 M4K and 8 multipliers. `whole` is the complete stage with registers, flattened. Constants of the\n\
         machine file are folded, so it takes less than its blocks do alone.\n\n\
         | | LE | of the device | M4K | 18×18 | LE unpacked | of the device |\n|---|---|---|---|---|---|---|\n"
    );
    for line in lines.iter().map(|(_, line)| line) {
        let cells_of: Vec<&str> = line.split('|').map(str::trim).collect();
        let (STAGE, [_, _, taken, m4k_blocks, multipliers, unpacked]) = (cells_of[1], numbers(line)) else {
            continue;
        };
        let mark = if taken > cells { "⚠ " } else { "" };
        let [share, unpacked_share] = [taken, unpacked].map(|le| 100 * le / device.cells);
        let _ = writeln!(
            text,
            "| {} | {mark}{taken} | {share} % | {m4k_blocks} | {multipliers} | {unpacked} | {unpacked_share} % |",
            cells_of[2]
        );
    }
    text
}

/// M4K blocks of the device.
const M4K_BLOCKS: u64 = 52;

fn figures(resources: &Resources) -> String {
    let figures = [
        resources.luts,
        resources.registers,
        resources.cells,
        resources.m4k_blocks,
        resources.multipliers,
    ];
    figures.map(|figure| figure.to_string()).join(" | ")
}

/// What is compared, in the order of the columns from the third.
const COMPARED: [&str; 5] = ["LUT", "flip-flops", "LE", "M4K", "18×18"];

/// The rows of a page that was written.
pub(crate) struct Written(BTreeMap<String, String>);

impl Written {
    /// The rows of this page.
    pub(crate) fn of(page: &str) -> Self {
        let row = |line: &str| {
            let cells: Vec<&str> = line.split('|').map(str::trim).collect();
            let name = format!("{} ({})", cells.get(1)?, cells.get(2)?);
            (cells.len() > 10).then(|| (name, line.to_owned()))
        };
        Self(page.lines().filter_map(row).collect())
    }

    /// The line of this row.
    pub(crate) fn line(&self, row: &AreaRow) -> Option<String> {
        self.0.get(&name(row)).cloned()
    }

    /// Whether the page has this row, with the same Verilog and the same note.
    pub(crate) fn is_of(&self, row: &AreaRow) -> bool {
        let end = format!("| {} | {} |", row.note, checksum(row));
        self.line(row).is_some_and(|line| line.ends_with(&end))
    }

    /// One line for each figure that is larger than that of the page, or for a row that is not there.
    pub(crate) fn grown(&self, one: &Measured<'_>) -> Vec<String> {
        let name = name(one.row);
        let Some(before) = self.line(one.row) else {
            return vec![format!("{name}: is not in docs/area.md")];
        };
        let figures = COMPARED.iter().zip(numbers(&line(one))).zip(numbers(&before));
        let grown = figures.filter(|((_, now), before)| now > before);
        let said = grown.map(|((what, now), before)| format!("{name}: {now} {what}, docs/area.md says {before}"));
        said.collect()
    }
}

/// Name of a row.
fn name(row: &AreaRow) -> String {
    format!("{} ({})", row.block, row.size)
}

/// LUT, flip-flops, LE, M4K, 18×18 and LE unpacked in a row's line; 0 for what is no number.
fn numbers(line: &str) -> [u64; 6] {
    let mut cells = line.split('|').skip(3);
    std::array::from_fn(|_| cells.next().and_then(|cell| cell.trim().parse().ok()).unwrap_or(0))
}
