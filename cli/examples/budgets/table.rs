//! The page `docs/area.md`, and the figures that have grown since it was written.

use crate::Measured;
use posicast_synth::yosys::{Family, Resources};
use std::collections::BTreeMap;
use std::fmt::Write;

const HEAD: &str =
    "| block | size | LUT | flip-flops | LE | M4K | 18×18 | LE unpacked | LUT by Yosys alone | budget | note |
|---|---|---|---|---|---|---|---|---|---|---|
";

/// The name of the row of the whole stage.
pub(crate) const STAGE: &str = "stage";

/// The whole page.
pub(crate) fn page(tool: &str, measured: &[Measured]) -> String {
    let device = Family::Cyclone2.device();
    let mut text = format!(
        "# Area\n\n\
         This page lists what each block takes of an {} ({} LE, {} M4K blocks, {} multipliers). The figures are **an estimate by\n\
         {tool}**, before place and route; [synthesis](synthesis.md) explains how they are made. The page is written by\n\n\
         ```\n\
         cargo run --release -p posicast --example budgets -- --write\n\
         ```\n\n\
         Without `--write` the command compares, and fails if a figure has grown.\n\n\
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
    for one in measured {
        let Measured { row, resources, .. } = one;
        let budget = row.budget.map_or("–".to_owned(), |budget| {
            let above = resources.luts > budget.luts || resources.registers > budget.flip_flops;
            let mark = if above { "⚠ " } else { "" };
            format!("{mark}{} + {}", budget.luts, budget.flip_flops)
        });
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {budget} | {} |",
            row.block,
            row.size,
            figures(resources),
            resources.unpacked_cells,
            one.luts_by_yosys.map_or("–".to_owned(), |luts| luts.to_string()),
            row.note
        );
    }
    let cells = device.cells * 55 / 100;
    let _ = write!(
        text,
        "\n## The XY stage\n\n\
         The budget is {cells} LE (55 %), 18 M4K and 8 multipliers. `whole` is the complete stage with registers, flattened. Constants of the\n\
         machine file are folded, so it takes less than its blocks do alone.\n\n\
         | | LE | of the device | M4K | 18×18 | LE unpacked | of the device |\n|---|---|---|---|---|---|---|\n"
    );
    for one in measured.iter().filter(|one| one.row.block == STAGE) {
        let Resources {
            cells: taken,
            unpacked_cells: unpacked,
            m4k_blocks,
            multipliers,
            ..
        } = one.resources;
        let mark = if taken > cells { "⚠ " } else { "" };
        let [share, unpacked_share] = [taken, unpacked].map(|le| 100 * le / device.cells);
        let _ = writeln!(
            text,
            "| {} | {mark}{taken} | {share} % | {m4k_blocks} | {multipliers} | {unpacked} | {unpacked_share} % |",
            one.row.size
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

/// One line for each figure of `new` that is larger than that of `old`, or missing in `old`.
pub(crate) fn grown(old: &str, new: &str) -> Vec<String> {
    const NAMES: [&str; 5] = ["LUT", "flip-flops", "LE", "M4K", "18×18"];
    let written = rows(old);
    let mut lines = Vec::new();
    for (name, now) in rows(new) {
        let Some(before) = written.get(&name) else {
            lines.push(format!("{name}: is not in docs/area.md"));
            continue;
        };
        for ((what, now), before) in NAMES.iter().zip(now).zip(before) {
            if now > *before {
                lines.push(format!("{name}: {now} {what}, docs/area.md says {before}"));
            }
        }
    }
    lines
}

/// Figures of a page by block and size.
fn rows(page: &str) -> BTreeMap<String, Vec<u64>> {
    let row = |line: &str| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let figures: Result<Vec<u64>, _> = cells.get(3..8)?.iter().map(|cell| cell.parse()).collect();
        Some((format!("{} ({})", cells[1], cells[2]), figures.ok()?))
    };
    page.lines().filter_map(row).collect()
}
