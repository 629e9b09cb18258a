//! The plain shaper sample by sample, without the clocks.

use super::config::{ShaperConfig, ShaperConfigError};
use super::{round_and_saturate, wrap};
use posicast_taps::TapTable;

/// Why a table cannot be loaded into a shaper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum LoadError {
    /// The table has another number of fraction bits.
    #[error("the table has {found} fraction bits, but the shaper is built for {allowed}: digitise it with that many")]
    Fraction {
        /// Fraction bits F of the table.
        found: u32,
        /// Fraction bits F of the shaper.
        allowed: u32,
    },
    /// The shaper's memories do not hold the table.
    #[error("the shaper that was built does not hold the table: {0}")]
    Size(ShaperConfigError),
}

/// The plain shaper sample by sample. It gives the results of [`super::Shaper`] where strobes come slowly enough.
///
/// [`super::MotionShaper`] has channels and the other motion features. Unlike the clocked model, this one fills its
/// ring buffer at a start instead of knowing its age, and so needs no test per tap.
#[derive(Debug, Clone)]
pub struct SampleShaper {
    config: ShaperConfig,
    ring: Vec<i64>,
    head: usize,
    taps: Vec<(usize, i64)>,
    saturated: bool,
}

impl SampleShaper {
    /// A shaper after reset: start value 0, the machine's table active.
    pub fn new(config: &ShaperConfig) -> Self {
        Self {
            ring: vec![0; 1 << config.ring_address_bits()],
            head: 0,
            taps: offsets(config.table()),
            saturated: false,
            config: config.clone(),
        }
    }

    /// Restarts: all samples before now count as `x` (wrapped to the word width), which is also the output after
    /// that.
    pub fn start(&mut self, x: i64) -> i64 {
        let x = wrap(x, self.config.word_bits());
        self.ring.fill(x);
        x
    }

    /// Takes one sample and returns the shaped one. `x` is wrapped to the word width, as a port of that width would
    /// do.
    pub fn push(&mut self, x: i64) -> i64 {
        let mask = self.ring.len() - 1;
        self.head = (self.head + 1) & mask;
        self.ring[self.head] = wrap(x, self.config.word_bits());
        let product =
            |&(delay, coefficient): &(usize, i64)| coefficient * self.ring[self.head.wrapping_sub(delay) & mask];
        let sum = self.taps.iter().map(product).sum();
        let (y, clamped) = round_and_saturate(sum, self.config.coefficient_fraction(), self.config.word_bits());
        self.saturated |= clamped;
        y
    }

    /// Makes another table active from the next sample on; the history stays.
    ///
    /// # Errors
    /// [`LoadError`] where the shaper cannot hold the table; the active table then stays.
    pub fn swap(&mut self, table: &TapTable) -> Result<(), LoadError> {
        loadable(&self.config, table)?;
        self.taps = offsets(table);
        Ok(())
    }

    /// Whether any sample since [`Self::new`] was clamped.
    pub fn saturated(&self) -> bool {
        self.saturated
    }
}

/// Checks that a shaper of `config` can load `table`.
pub(super) fn loadable(config: &ShaperConfig, table: &TapTable) -> Result<(), LoadError> {
    let allowed = config.coefficient_fraction();
    let found = table.coefficient_fraction();
    if found != allowed {
        return Err(LoadError::Fraction { found, allowed });
    }
    config.holds(table.taps()).map_err(LoadError::Size)
}

fn offsets(table: &TapTable) -> Vec<(usize, i64)> {
    let offset = |tap: &posicast_taps::Tap| (tap.delay_samples as usize, i64::from(tap.coefficient));
    table.taps().iter().map(offset).collect()
}
