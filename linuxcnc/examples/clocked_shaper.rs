//! Compares the recording of `posicast_shaper` by LinuxCNC's sampler with the clocked model of the hardware, bit for bit.
//!
//! `clocked_shaper TABLES SAMPLES`: rows of the first axis's `word-in`, `word-out` and `table-used`, from the first servo period on.

#[path = "../tests/clocked.rs"]
mod clocked;

use clocked::Clocked;
use posicast_blocks::shaper_tables::ShaperTables;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let [tables, samples] = <[String; 2]>::try_from(std::env::args().skip(1).collect::<Vec<_>>())
        .map_err(|_| "usage: clocked_shaper TABLES SAMPLES")?;
    let tables = ShaperTables::parse(&std::fs::read_to_string(tables)?)?;
    let axis = tables.axes.first().ok_or("no axis")?;
    let (mut rows, mut moved, mut swaps, mut last) = (0, 0, 0, (0, 0));
    let mut hardware = None;
    for line in std::fs::read_to_string(samples)?.lines() {
        let row = line
            .split_whitespace()
            .map(str::parse::<i64>)
            .collect::<Result<Vec<_>, _>>();
        let [word, shaped, table] = row.map_err(|_| format!("not a row of three numbers: {line}"))?[..] else {
            return Err(format!("not a row of three numbers: {line}").into());
        };
        let hardware = match &mut hardware {
            Some(hardware) => hardware,
            None => hardware.insert(Clocked::new(axis, word)?),
        };
        let expected = hardware.sample(word, table as u32);
        if shaped != expected {
            return Err(format!("row {rows}: the component gave {shaped}, the model gives {expected}").into());
        }
        rows += 1;
        moved += u64::from(word != last.0);
        swaps += u64::from(table != last.1);
        last = (word, table);
    }
    if moved < 1000 || swaps < 10 {
        return Err(format!("only {moved} moves and {swaps} changes of table in {rows} samples").into());
    }
    #[allow(clippy::print_stdout, reason = "it is the result of the program")]
    {
        println!(
            "ok posicast_shaper equals the clocked model: {rows} samples, {moved} of them moving, {swaps} handovers"
        );
    }
    Ok(())
}
