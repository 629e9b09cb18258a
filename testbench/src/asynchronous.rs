//! Tests effects that no clock samples: pulses between two clock edges, in Icarus, on the block's own Verilog.
//!
//! A lock step has one set of inputs per clock, so a latch that needs the clock looks the same as one that does not.
//! A block with such a path has a testbench of its own ([`Block::asynchronous`]), which prints a line `not …` for
//! each failed check, and `passed` at its end.

use crate::Error;
use crate::blocks::{Block, Sources};
use crate::icarus;
use crate::lockstep::report::{self, LockstepReport};

/// Suffix of the row's instance.
const INSTANCE: &str = "pulses between clocks";

/// Runs the block's directed test, if it has one, and returns a report of one row.
///
/// # Errors
/// [`Error::ToolMissing`] without Icarus; [`Error::ToolFailed`] where it refuses the Verilog.
pub fn check(block: &dyn Block, sources: &Sources) -> Result<Option<LockstepReport>, Error> {
    let Some((bench, top)) = block.asynchronous() else {
        return Ok(None);
    };
    let said = icarus::directed(&bench, top, sources.files())?;
    let mut findings: Vec<String> = said
        .lines()
        .filter(|line| line.contains(": not "))
        .map(|line| line.trim().to_owned())
        .collect();
    let clocks = said.lines().find_map(|line| line.trim().strip_prefix("passed after "));
    let clocks = clocks.and_then(|text| text.split(' ').next()?.parse().ok());
    if clocks.is_none() && findings.is_empty() {
        findings.push("the directed test did not come to its end: no pin was ever switched on".to_owned());
    }
    let cycles: u64 = clocks.unwrap_or(1);
    let row = report::BlockReport {
        name: block.name().to_owned(),
        instance: format!("{}, {INSTANCE}", block.instance()),
        cycles,
        samples: None,
        mismatches: findings.len() as u64,
        first: None,
        not_exercised: Vec::new(),
        unchanged: Vec::new(),
        reached: Vec::new(),
        findings,
    };
    Ok(Some(LockstepReport::new(cycles, vec![row])))
}
