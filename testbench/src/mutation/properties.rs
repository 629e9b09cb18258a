//! The property file of a block, asked about its mutants.

use std::time::Duration;

use super::netlist::Netlist;
use super::{Mutant, Subject};
use crate::Error;
use crate::formal::{self, Verdict};

/// A property that the mutant breaks: none where the block has no property file at this size.
pub(super) fn broken(
    subject: &Subject,
    netlist: &Netlist<'_>,
    mutant: &Mutant,
    limit: Duration,
) -> Result<Option<String>, Error> {
    let Some(task) = subject.task() else { return Ok(None) };
    let mut task = task.clone();
    task.modules = netlist.with(mutant)?;
    let folder = netlist.folder().join(format!("properties_{}", mutant.number));
    match formal::run(&task, &folder, limit)?.verdict {
        Verdict::Counterexample { property, .. } => Ok(Some(property)),
        Verdict::Proven | Verdict::Unknown => Ok(None),
    }
}
