//! The table of ports in a block's datasheet is what its list of ports says. `scripts/regenerate` writes it anew.

use posicast_model::rtl::{
    Direction, PortList, PortRow, axis, divider, drive_command, encoder_generator, excitation, linear_scale,
    pulse_counter, pwm, segments, sliding_mode, trace,
};
use std::error::Error;
use std::path::Path;

/// The datasheets with a derived table, and the lists that they show.
const DATASHEETS: [(&str, PortList); 11] = [
    ("axis", axis::PORTS),
    ("divider", divider::PORTS),
    ("drive_command", drive_command::PORTS),
    ("encoder_generator", encoder_generator::PORTS),
    ("excitation", excitation::PORTS),
    ("linear_scale", linear_scale::PORTS),
    ("pulse_counter", pulse_counter::PORTS),
    ("pwm", pwm::PORTS),
    ("segments", segments::PORTS),
    ("sliding_mode", sliding_mode::PORTS),
    ("trace", trace::PORTS),
];

const TITLE: &str = "| port | | width |";

/// A row of the table.
fn row(row: &PortRow) -> String {
    let name = match row.count {
        Some(count) => format!("`{0}_0` … `{0}_{1}`", row.name, count - 1),
        None => format!("`{}`", row.name),
    };
    let direction = match row.direction {
        Direction::Input => "in",
        Direction::Output => "out",
    };
    let signed = if row.signed { ", signed" } else { "" };
    let meaning: Vec<_> = row.meaning.iter().map(|line| line.trim()).collect();
    let meaning = meaning
        .join(" ")
        .replace('|', "\\|")
        .replace("[`", "`")
        .replace("`]", "`");
    let unit = if row.unit.is_empty() {
        String::new()
    } else {
        format!("{} ", row.unit)
    };
    format!("| {name} | {direction} | {}{signed} | {unit}| {meaning} |\n", row.width)
}

fn table(list: PortList) -> String {
    let head = format!("{TITLE} unit | meaning |\n|---|---|---|---|---|\n| `clk` | in | 1 | | Clock. |\n");
    head + &list.iter().map(row).collect::<String>()
}

/// `datasheet` with its table of ports from the list.
fn with_table(datasheet: &str, list: PortList) -> Option<String> {
    let (before, from) = datasheet.split_once(TITLE)?;
    let (_, after) = from.split_once("\n\n")?;
    Some(format!("{before}{}\n{after}", table(list)))
}

#[test]
fn golden_the_tables_of_ports_are_what_the_lists_say() -> Result<(), Box<dyn Error>> {
    for (block, list) in DATASHEETS {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../docs/{block}.md"));
        let committed = std::fs::read_to_string(&file)?;
        let derived = with_table(&committed, list).ok_or_else(|| format!("docs/{block}.md has no table of ports"))?;
        if std::env::var_os("POSICAST_REGENERATE").is_some() {
            std::fs::write(&file, &derived)?;
        } else {
            assert!(
                committed == derived,
                "docs/{block}.md: its table is not what `ports!` says; if the change is meant: scripts/regenerate"
            );
        }
    }
    Ok(())
}
