//! The bench of `error_table`.

use posicast_hdl::SimulationError;
use posicast_hdl::emit::{EmitError, Module};
use posicast_hdl::error_table::{emit, name, simulate};
use posicast_model::rtl::ClockedBlock;
use posicast_model::rtl::error_table::{EntryUnit, ErrorTable, ErrorTableConfig, ErrorTableFormat};

use super::{Bins, Block, named};
use crate::Error;
use crate::lockstep::Clock;
use crate::stimuli::{ErrorTableCoverage, ErrorTableRandom, Stimuli};

/// The error table of one machine.
#[derive(Debug, Clone)]
pub struct ErrorTableBlock {
    config: ErrorTableConfig,
    prefix: String,
    instance: String,
}

impl ErrorTableBlock {
    /// The error table `PREFIX_error_table`.
    pub fn new(config: ErrorTableConfig, prefix: &str, instance: &str) -> Self {
        Self {
            config,
            prefix: prefix.to_owned(),
            instance: instance.to_owned(),
        }
    }

    /// One of so many entries, 2^`spacing_bits` counts apart, that go up and down as steeply as is allowed, for the ladder of verification.
    ///
    /// # Errors
    /// [`Error::Option`] where there is no such table.
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
