//! The bench of `error_table`.

pub(crate) mod stimuli;
mod trials;

pub use self::stimuli::{ErrorTableCoverage, ErrorTableRandom};

use posicast_blocks::ClockedBlock;
use posicast_blocks::error_table::{EntryUnit, ErrorTable, ErrorTableConfig, ErrorTableFormat, ports};
use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module};
use posicast_hdl::error_table::{emit, name, simulate};

use crate::Error;
use crate::blocks::registry::{AreaRow, RegistryRow, one, small};
use crate::blocks::{Bins, Block, named};
use crate::formal::{INDUCTION, Task, part};
use crate::lockstep::Clock;
use crate::stimuli::Stimuli;

/// The block's row in the registry.
pub(crate) const ROW: RegistryRow = RegistryRow {
    name: "error_table",
    benches: |sizes| {
        let table = ErrorTableBlock::of_size(9, 6)?;
        Ok(one(ErrorTableBlock::new(table, &sizes.prefix, "9 entries")))
    },
    small: || {
        let table = ErrorTableBlock::of_size(9, 6)?;
        Ok(small(ErrorTableBlock::new(table, "", "alone"), "9 entries"))
    },
    proofs: || {
        let mut tasks = Vec::new();
        for (entries, spacing_bits) in [(9, 6), (256, 12)] {
            let config = ErrorTableBlock::of_size(entries, spacing_bits)?;
            tasks.push(table_proof(&config)?);
            tasks.push(lookup_proof(&config)?);
        }
        Ok(tasks)
    },
    areas: || {
        let modules = emit(&ErrorTableBlock::of_size(256, 12)?, "")?;
        Ok(vec![AreaRow::new("256 entries", modules).note(
            "It has no multiplier: an adder of 18 bits averages, a bit per clock. A quarter is the sum and the \
             place, 32 bits each; a fifth checks what a host loads.",
        )])
    },
    trials: trials::all,
    mutants: trials::MUTANTS,
    proof_mutants: trials::PROOF_MUTANTS,
};

/// The error table of one machine.
#[derive(Debug, Clone)]
pub struct ErrorTableBlock {
    config: ErrorTableConfig,
    prefix: String,
    instance: String,
}

impl ErrorTableBlock {
    /// Creates the error table `PREFIX_error_table`.
    pub fn new(config: ErrorTableConfig, prefix: &str, instance: &str) -> Self {
        Self {
            config,
            prefix: prefix.to_owned(),
            instance: instance.to_owned(),
        }
    }

    /// Creates a table for the verification ladder: `entries` entries, 2^`spacing_bits` counts apart, which rise and
    /// fall as steeply as is allowed.
    ///
    /// # Errors
    /// [`Error::Option`] if such a table is not allowed.
    pub fn of_size(entries: usize, spacing_bits: u32) -> Result<ErrorTableConfig, Error> {
        let format = ErrorTableFormat {
            first_counts: -100,
            spacing_bits,
            unit: EntryUnit::Fine,
        };
        let most = format.most_step().min(1 << 15);
        let entry = |index: usize| (index * index * 37 % 101) as i32 * most / 101 - most / 2;
        ErrorTableConfig::new(format, (0..entries).map(entry).collect())
            .map_err(|error| Error::Option(error.to_string()))
    }
}

impl Block for ErrorTableBlock {
    fn name(&self) -> &str {
        "error_table"
    }

    fn instance(&self) -> &str {
        &self.instance
    }

    fn modules(&self) -> Result<Vec<Module>, EmitError> {
        emit(&self.config, &self.prefix)
    }

    fn top(&self) -> String {
        name(&self.prefix)
    }

    fn model(&self, _seed: u64) -> Box<dyn ClockedBlock> {
        Box::new(ErrorTable::new(&self.config))
    }

    fn simulate(&self) -> Result<Box<dyn ClockedBlock>, SimulationError> {
        simulate(&self.config)
    }

    fn stimuli(&self, _cycles: u64, seed: u64) -> Box<dyn Stimuli + '_> {
        Box::new(ErrorTableRandom::new(&self.config, seed))
    }

    fn coverage(&self) -> Box<dyn Bins + '_> {
        Box::new(ErrorTableCoverage::new(&self.config))
    }
}

impl Bins for ErrorTableCoverage {
    fn observe(&mut self, clock: &Clock<'_>) {
        self.observe(clock);
    }

    fn counts(&self) -> Vec<(String, u64)> {
        named(self.counts())
    }
}

fn size_of(config: &ErrorTableConfig) -> String {
    let (entries, spacing_bits) = (config.entries().len(), config.format().spacing_bits);
    format!("{entries} entries, 2^{spacing_bits} counts apart, contents left out")
}

fn table_proof(config: &ErrorTableConfig) -> Result<Task, Error> {
    let format = config.format();
    let sign = if format.first_counts < 0 { "-" } else { "" };
    let macros = [
        ("LAST", format!("8'd{}", config.last())),
        ("MOST_STEP", format!("20'sd{}", format.most_step())),
        ("FIRST", format!("{sign}32'sd{}", format.first_counts.unsigned_abs())),
    ];
    let block = (emit(config, "")?, ports());
    Ok(
        Task::new("error_table", &size_of(config), INDUCTION, block)
            .properties(&macros, include_str!("error_table.sv")),
    )
}

/// Creates the proof of the arithmetic, on `lookup` alone.
fn lookup_proof(config: &ErrorTableConfig) -> Result<Task, Error> {
    let macros = [
        ("FRACTION", format!("7'd{}", config.format().spacing_bits + 8)),
        ("LAST", format!("8'd{}", config.last())),
    ];
    let block = part(emit(config, "")?, "error_lookup")?;
    Ok(Task::new("error_lookup", &size_of(config), INDUCTION, block)
        .properties(&macros, include_str!("error_lookup.sv")))
}
