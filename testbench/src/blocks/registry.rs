//! The registry has one row for each kind of block, from which all rungs of the verification ladder take it.
//!
//! | field of a row | used by |
//! |---|---|
//! | [`benches`](RegistryRow::benches) | `posicast verify`, the second simulator, netlists, coverage |
//! | [`small`](RegistryRow::small) | mutants |
//! | [`proofs`](RegistryRow::proofs) | the formal proofs |
//! | [`areas`](RegistryRow::areas) | `docs/area.md` |
//! | [`trials`](RegistryRow::trials), [`mutants`](RegistryRow::mutants), [`proof_mutants`](RegistryRow::proof_mutants) | the tests (`testbench/tests/blocks.rs`) |
//!
//! The row of a new block is in the file of its bench; name the block in `lib.rs`, as a module and in [`REGISTRY`].

use posicast_blocks::divider::DividerConfig;
use posicast_blocks::inline_shaper::InlineShaper;
use posicast_blocks::pwm::PwmConfig;
use posicast_blocks::shaper::ShaperConfig;
use posicast_blocks::sliding_mode::Settings;
use posicast_blocks::stage::StageConfig;
use posicast_hdl::emit::Module;

use super::{Block, BlockMutant, ProofMutant, Trial};
use crate::bus_component::BusComponentBlock;
use crate::component::ComponentBlock;
use crate::formal::Task;
use crate::{Error, REGISTRY};

/// Benches of blocks.
pub(crate) type Benches = Vec<Box<dyn Block>>;

/// A kind of block.
pub(crate) struct RegistryRow {
    /// The name that the block has everywhere. Each component and each stage has its own name.
    pub(crate) name: &'static str,
    /// Creates the benches for a machine: one in all, or one for each block of this kind in the machine.
    pub(crate) benches: fn(&BenchSizes) -> Result<Benches, Error>,
    /// Creates the block at a small, named size: it has every path of the logic, but few mutants that repeat each other
    /// in the bits of wide words.
    pub(crate) small: fn() -> Result<Vec<SmallBench>, Error>,
    /// Makes its proofs.
    pub(crate) proofs: fn() -> Result<Vec<Task>, Error>,
    /// Makes the sizes whose area is checked.
    pub(crate) areas: fn() -> Result<Vec<AreaRow>, Error>,
    /// Makes the sizes that the tests compare.
    pub(crate) trials: fn() -> Result<Vec<Trial>, Error>,
    /// Faults in the Verilog that the stimuli must find.
    pub(crate) mutants: &'static [BlockMutant],
    /// Faults in the Verilog with which a proof must fail.
    pub(crate) proof_mutants: &'static [ProofMutant],
}

impl RegistryRow {
    /// An empty row, for `..RegistryRow::EMPTY`.
    pub(crate) const EMPTY: Self = Self {
        name: "",
        benches: |_| Ok(Vec::new()),
        small: || Ok(Vec::new()),
        proofs: || Ok(Vec::new()),
        areas: || Ok(Vec::new()),
        trials: || Ok(Vec::new()),
        mutants: &[],
        proof_mutants: &[],
    };
}

/// The sizes of benches: those of a machine, or of the [`library`](super::library()).
#[derive(Debug, Clone)]
pub struct BenchSizes {
    /// Prefix of the names of modules: the machine's name, or empty.
    pub prefix: String,
    /// Names of the axes that have an encoder, or `alone`.
    pub with_encoder: String,
    /// Names of the axes that have a controller, or `alone`.
    pub with_controller: String,
    /// Clocks per tick.
    pub tick: DividerConfig,
    /// The PWMs, each with its axes.
    pub pwms: Vec<(PwmConfig, String)>,
    /// The shaper for motion.
    pub motion: ShaperConfig,
    /// Number of axes.
    pub axes: usize,
    /// Settings of a controller.
    pub settings: Settings,
    /// The components.
    pub components: Vec<ComponentBlock>,
    /// The components on another bus that are compared too.
    pub buses: Vec<BusComponentBlock>,
    /// The stages that are compared too.
    pub stages: Vec<StageConfig>,
    /// The inline shaper, if there is one.
    pub inline: Option<InlineShaper>,
}

/// A block at a size, and the name of the size.
pub struct SmallBench {
    /// The block.
    pub block: Box<dyn Block>,
    /// Its size, for a table.
    pub size: &'static str,
}

/// A block at a size whose area is checked.
#[derive(Debug, Clone)]
pub struct AreaRow {
    /// The name that the block has everywhere.
    pub block: &'static str,
    /// Its size, if it has several.
    pub size: &'static str,
    /// Its Verilog, the top last.
    pub modules: Vec<Module>,
    /// Its budget, if the specification of the hardware states one.
    pub budget: Option<AreaBudget>,
    /// The reason why it exceeds its budget, or else what needs most of its area.
    pub note: &'static str,
}

/// Largest area of a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AreaBudget {
    /// Number of look-up tables.
    pub luts: u64,
    /// Number of flip-flops.
    pub flip_flops: u64,
}

impl AreaRow {
    /// Creates the row; the registry adds the block's name.
    pub(crate) fn new(size: &'static str, modules: Vec<Module>) -> Self {
        Self {
            block: "",
            size,
            modules,
            budget: None,
            note: "",
        }
    }

    pub(crate) fn budget(self, luts: u64, flip_flops: u64) -> Self {
        let budget = Some(AreaBudget { luts, flip_flops });
        Self { budget, ..self }
    }

    pub(crate) fn note(self, note: &'static str) -> Self {
        Self { note, ..self }
    }
}

/// Returns the single bench of a row.
pub(crate) fn one(block: impl Block + 'static) -> Benches {
    vec![Box::new(block)]
}

/// Returns the single small size of a row.
pub(crate) fn small(block: impl Block + 'static, size: &'static str) -> Vec<SmallBench> {
    let block = Box::new(block);
    vec![SmallBench { block, size }]
}

/// Returns the benches of every kind of block for a machine of these sizes.
///
/// # Errors
/// [`Error::Option`] if a size is refused, [`Error::Unlike`] if a shaper lacks a port that its stimuli drive.
pub fn benches(sizes: &BenchSizes) -> Result<Vec<Box<dyn Block>>, Error> {
    joined(|row| (row.benches)(sizes))
}

/// Returns every kind of block that is mutated, each at a small size.
///
/// # Errors
/// As [`benches`].
pub fn small_benches() -> Result<Vec<SmallBench>, Error> {
    joined(|row| (row.small)())
}

/// Returns all proofs.
///
/// # Errors
/// [`Error::Block`] if a block cannot be written as Verilog.
pub fn proofs() -> Result<Vec<Task>, Error> {
    joined(|row| (row.proofs)())
}

/// Returns all proofs, each with the name of the row that has it.
///
/// # Errors
/// As [`proofs`].
pub fn proofs_by_block() -> Result<Vec<(&'static str, Task)>, Error> {
    joined(|row| Ok((row.proofs)()?.into_iter().map(|task| (row.name, task)).collect()))
}

/// Returns the proofs of the block of this name; there may be none.
///
/// # Errors
/// As [`proofs`].
pub fn proofs_of(block: &str) -> Result<Vec<Task>, Error> {
    let rows = REGISTRY.iter().filter(|row| row.name == block);
    Ok(rows.map(|row| (row.proofs)()).collect::<Result<Vec<_>, _>>()?.concat())
}

/// Returns the proofs that use this property file; they all belong to one row.
///
/// # Errors
/// As [`proofs`], and [`Error::Option`] if there are none.
pub fn proofs_named(name: &str) -> Result<Vec<Task>, Error> {
    let is_likely = |row: &&RegistryRow| name.starts_with(row.name);
    let (likely, others): (Vec<_>, Vec<_>) = REGISTRY.iter().partition(is_likely);
    let mut names = Vec::new();
    // Writing the Verilog of all blocks takes longer than most of what is done with the proofs of one.
    for row in likely.into_iter().chain(others) {
        let of_row = (row.proofs)()?;
        names.extend(of_row.iter().map(|task| task.name));
        let wanted: Vec<Task> = of_row.into_iter().filter(|task| task.name == name).collect();
        if !wanted.is_empty() {
            return Ok(wanted);
        }
    }
    let names = names.join(", ");
    Err(Error::Option(format!(
        "no proofs for `{name}`: there are some for {names}"
    )))
}

/// Returns all sizes whose area is checked.
///
/// # Errors
/// As [`proofs`].
pub fn areas() -> Result<Vec<AreaRow>, Error> {
    joined(|row| {
        let of_row = |area| AreaRow {
            block: row.name,
            ..area
        };
        Ok((row.areas)()?.into_iter().map(of_row).collect())
    })
}

fn joined<T>(of: impl Fn(&RegistryRow) -> Result<Vec<T>, Error>) -> Result<Vec<T>, Error> {
    let lists: Result<Vec<Vec<T>>, Error> = REGISTRY.iter().map(of).collect();
    Ok(lists?.into_iter().flatten().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::blocks::library_sizes;

    /// Each row makes blocks with its name, for every rung, except components and stages, which have their own names.
    #[test]
    fn each_row_creates_blocks_with_its_own_name() {
        let sizes = library_sizes().unwrap();
        let has_own = |name: &str| !matches!(name, "component" | "stage");
        for row in REGISTRY.iter().filter(|row| has_own(row.name)) {
            let mut benches = (row.benches)(&sizes).unwrap();
            assert!(!benches.is_empty(), "{} has no bench", row.name);
            benches.extend((row.small)().unwrap().into_iter().map(|small| small.block));
            assert!(benches.iter().all(|bench| bench.name() == row.name), "{}", row.name);
        }
    }

    #[test]
    fn each_property_file_is_of_one_row() {
        let mut seen: Vec<&str> = Vec::new();
        for row in REGISTRY {
            let mut names: Vec<&str> = (row.proofs)().unwrap().iter().map(|task| task.name).collect();
            names.sort_unstable();
            names.dedup();
            for name in names {
                assert!(!seen.contains(&name), "{name} is of {} too", row.name);
                seen.push(name);
            }
        }
        assert!(seen.len() > 20, "{}", seen.len());
        let last = seen[seen.len() - 1];
        assert!(proofs_named(last).unwrap().iter().all(|task| task.name == last));
    }
}
