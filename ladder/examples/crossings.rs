//! Lists what is behind each asynchronous pin of the stage of `examples/xy-stage.toml`, on its netlist:
//! `cargo run --release --example crossings [-- --write]`.
//!
//! `--write` renews the table in ladder/RESULTS.md. Exit status: 0 if the page has this table, 1 if not, 2 if it cannot run, 3 without Yosys.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "this is a program")]

use std::process::ExitCode;

use posicast_ladder::crossings::{CROSSINGS_MARKS, crossings, crossings_table};
use posicast_machine::plan::design_machine;
use posicast_machine::{hardware, machine_file};
use posicast_testbench::Error;
use posicast_testbench::blocks::Block;
use posicast_testbench::stage::StageBlock;

fn main() -> ExitCode {
    match list() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(if error.is_missing_tool() { 3 } else { 2 })
        }
    }
}

fn list() -> Result<bool, Error> {
    let refused = |error: &dyn std::fmt::Display| Error::Option(format!("examples/xy-stage.toml: {error}"));
    let text = include_str!("../../examples/xy-stage.toml");
    let machine = machine_file::parse("xy-stage.toml", text).map_err(|error| refused(&error))?;
    let design = design_machine(&machine).map_err(|error| refused(&error))?;
    let stage = hardware::stage(&machine, &design).map_err(|error| refused(&error))?;
    let config = stage.ok_or_else(|| refused(&"it has no stage"))?.config;
    let block = StageBlock::new(&config, "xy_stage_stage").map_err(|error| refused(&error))?;
    let folder = std::env::temp_dir().join(format!("posicast-crossings-{}", std::process::id()));
    std::fs::create_dir_all(&folder).map_err(|error| refused(&error))?;
    let found = crossings(&block.modules()?, &folder);
    // A file that cannot be deleted stays in the temporary folder; that is no reason to fail.
    let _ = std::fs::remove_dir_all(&folder);
    let table = crossings_table(&found?);
    print!("{table}");
    if std::env::args().any(|word| word == "--write") {
        CROSSINGS_MARKS.renew(|_| table.clone())?;
    }
    Ok(CROSSINGS_MARKS.read()?.trim() == table.trim())
}
