//! The blocks that get mutants.

use posicast_testbench::Error;
use posicast_testbench::blocks::{self, Block, SmallBench};
use posicast_testbench::formal::Task;

/// A block at one size, with its proofs.
pub struct Subject {
    block: Box<dyn Block>,
    size: &'static str,
    tasks: Vec<Task>,
}

impl Subject {
    /// The block.
    pub fn block(&self) -> &dyn Block {
        self.block.as_ref()
    }

    /// Description of its size.
    pub fn size(&self) -> &str {
        self.size
    }

    /// The tasks whose properties hold for this block at this size.
    pub(super) fn tasks(&self) -> &[Task] {
        &self.tasks
    }
}

/// All of them.
///
/// # Errors
/// [`Error::Block`] where a block cannot be written as Verilog.
pub fn all() -> Result<Vec<Subject>, Error> {
    let tasks = blocks::proofs()?;
    let subject = |SmallBench { block, size }| {
        let modules = block.modules()?;
        Ok(Subject {
            tasks: tasks.iter().filter(|task| task.modules == modules).cloned().collect(),
            block,
            size,
        })
    };
    blocks::small_benches()?.into_iter().map(subject).collect()
}

/// The subjects of one block.
///
/// # Errors
/// Those of [`all`], and [`Error::Option`] where there is no such block.
pub fn named(name: &str) -> Result<Vec<Subject>, Error> {
    let all = all()?;
    let names: Vec<String> = all.iter().map(|subject| subject.block.name().to_owned()).collect();
    if !names.iter().any(|found| found == name) {
        return Err(Error::Option(format!(
            "no mutants for `{name}`: there are some for {}",
            names.join(", ")
        )));
    }
    Ok(all.into_iter().filter(|subject| subject.block.name() == name).collect())
}
