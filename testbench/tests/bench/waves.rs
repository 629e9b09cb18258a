//! Reads a written file with independent readers, the crates `vcd` and `wellen`.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use vcd::{Command, IdCode, Parser, ScopeItem, TimescaleUnit};

/// Times and values of each signal, by its full name.
pub(crate) type Changes = BTreeMap<String, Vec<(u64, String)>>;

fn names(items: &[ScopeItem], scope: &str, found: &mut Vec<(IdCode, String)>) {
    for item in items {
        match item {
            ScopeItem::Scope(inner) => names(&inner.items, &format!("{scope}{}.", inner.identifier), found),
            ScopeItem::Var(var) => found.push((var.code, format!("{scope}{}", var.reference))),
            _ => {}
        }
    }
}

/// Returns the unit of time and all changes of single bits and vectors, as the crate `vcd` reads them.
pub(crate) fn read(path: &Path) -> (String, Changes) {
    let mut parser = Parser::new(BufReader::new(File::open(path).unwrap()));
    let header = parser.parse_header().unwrap();
    let (number, unit) = header.timescale.unwrap();
    let mut found = Vec::new();
    names(&header.items, "", &mut found);
    let mut by_id: BTreeMap<IdCode, Vec<(u64, String)>> = BTreeMap::new();
    let mut time = 0;
    for command in parser {
        match command.unwrap() {
            Command::Timestamp(now) => time = now,
            Command::ChangeScalar(id, value) => by_id.entry(id).or_default().push((time, value.to_string())),
            Command::ChangeVector(id, value) => by_id.entry(id).or_default().push((time, value.to_string())),
            _ => {}
        }
    }
    let changes = found
        .into_iter()
        .map(|(id, name)| (name, by_id.get(&id).cloned().unwrap_or_default()));
    (format!("{number} {unit}"), changes.collect())
}

/// Returns the times at which a bit becomes 1.
pub(crate) fn times_of_ones(changes: &[(u64, String)]) -> Vec<u64> {
    changes
        .iter()
        .filter(|(_, value)| value == "1")
        .map(|(time, _)| *time)
        .collect()
}

/// Returns the femtoseconds per unit of time as the crate `wellen` reads it, which must be a second divided by a power
/// of 1000, and the times of the file in these units.
pub(crate) fn unit_and_times(path: &Path) -> (u64, Vec<u64>) {
    let wave = wellen::simple::read(path).unwrap();
    let timescale = wave.hierarchy().timescale().unwrap();
    let exponent = timescale.unit.to_exponent().unwrap();
    assert_eq!(
        (timescale.factor, exponent % 3),
        (1, 0),
        "{}: {timescale:?}",
        path.display()
    );
    let header = Parser::new(BufReader::new(File::open(path).unwrap()))
        .parse_header()
        .unwrap();
    let units = [
        (TimescaleUnit::S, 0),
        (TimescaleUnit::MS, -3),
        (TimescaleUnit::US, -6),
        (TimescaleUnit::NS, -9),
        (TimescaleUnit::PS, -12),
        (TimescaleUnit::FS, -15),
    ];
    let unit = units.iter().find(|(_, found)| *found == i32::from(exponent)).unwrap().0;
    assert_eq!(header.timescale, Some((1, unit)));
    (10u64.pow((15 + i32::from(exponent)) as u32), wave.time_table().to_vec())
}
