//! The table of ports in a block's datasheet agrees with its list of ports. `scripts/regenerate` writes it again.

use posicast_blocks::{Direction, PORT_LISTS, PortList, SIZED_PORT_LISTS, SizedPortRow};
use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

const TITLE: &str = "| port | | width |";

/// Returns a row of the table.
fn row(name: &str, direction: Direction, width: &str, signed: bool, unit: &str, meaning: &[&str]) -> String {
    let direction = match direction {
        Direction::Input => "in",
        Direction::Output => "out",
    };
    let signed = if signed { ", signed" } else { "" };
    let meaning: Vec<_> = meaning.iter().map(|line| line.trim()).collect();
    let meaning = meaning
        .join(" ")
        .replace('|', "\\|")
        .replace("[`", "`")
        .replace("`]", "`");
    let unit = if unit.is_empty() {
        String::new()
    } else {
        format!("{unit} ")
    };
    format!("| {name} | {direction} | {width}{signed} | {unit}| {meaning} |\n")
}

fn table(rows: impl Iterator<Item = String>) -> String {
    let head = format!("{TITLE} unit | meaning |\n|---|---|---|---|---|\n| `clk` | in | 1 | | Clock. |\n");
    head + &rows.collect::<String>()
}

fn fixed(list: PortList) -> String {
    table(list.iter().map(|port| {
        let name = match port.count {
            Some(count) => format!("`{0}_0` … `{0}_{1}`", port.name, count - 1),
            None => format!("`{}`", port.name),
        };
        let width = port.width.to_string();
        row(&name, port.direction, &width, port.signed, port.unit, port.meaning)
    }))
}

fn sized(list: &[SizedPortRow]) -> String {
    table(list.iter().map(|port| {
        let name = match port.count {
            Some(count) => format!("`{0}_0` … `{0}_`({count} − 1)", port.name),
            None => format!("`{}`", port.name),
        };
        row(&name, port.direction, port.width, port.signed, port.unit, port.meaning)
    }))
}

/// Returns `datasheet` with each of its tables of ports replaced; `None` if it does not have as many as `tables`.
fn with_tables(datasheet: &str, tables: &[String]) -> Option<String> {
    let mut parts = datasheet.split(TITLE);
    let mut derived = parts.next()?.to_owned();
    for table in tables {
        let (_, after) = parts.next()?.split_once("\n\n")?;
        derived += &format!("{table}\n{after}");
    }
    parts.next().is_none().then_some(derived)
}

#[test]
fn golden_the_tables_of_ports_are_what_the_lists_say() -> Result<(), Box<dyn Error>> {
    let mut tables: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for (block, list) in PORT_LISTS {
        tables.entry(block).or_default().push(fixed(list));
    }
    for (block, list) in SIZED_PORT_LISTS {
        tables.entry(block).or_default().push(sized(list));
    }
    for (block, tables) in tables {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../docs/{block}.md"));
        let committed = std::fs::read_to_string(&file)?;
        let derived = with_tables(&committed, &tables).ok_or_else(|| {
            format!(
                "docs/{block}.md has not {} tables that begin with {TITLE}",
                tables.len()
            )
        })?;
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
