//! Checks mutants against the property file of a block.

use std::time::Duration;

use super::netlist::Netlist;
use super::{Mutant, Subject};
use posicast_testbench::Error;
use posicast_testbench::formal::{self, ProofVerdict};

/// Returns the name of a property that the mutant breaks; `None` if it breaks none, or the block has no property file
/// at this size.
pub(super) fn broken(
    subject: &Subject,
    netlist: &Netlist<'_>,
    mutant: &Mutant,
    limit: Duration,
) -> Result<Option<String>, Error> {
    if subject.tasks().is_empty() {
        return Ok(None);
    }
    let modules = netlist.with(mutant)?;
    for (at, task) in subject.tasks().iter().enumerate() {
        let mut task = task.clone();
        task.modules.clone_from(&modules);
        let folder = netlist.folder().join(format!("properties_{}_{at}", mutant.number));
        if let ProofVerdict::Counterexample { property, .. } = formal::search(&task, &folder, limit)? {
            return Ok(Some(property));
        }
    }
    Ok(None)
}
