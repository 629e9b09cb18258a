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

/// The shaped samples have no room, or too much.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{command} command words, but room for {shaped} shaped ones: both must be as long")]
pub struct LengthError {
    /// Number of command words.
    pub command: usize,
    /// Number of shaped words that fit.
    pub shaped: usize,
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

    /// Takes many samples, and writes the shaped ones to `shaped`, which must be as long: the same as [`Self::push`] for each, several
    /// times faster.
    ///
    /// # Errors
    /// [`LengthError`] where the lengths differ; nothing is taken then.
    pub fn shape<W: CommandWord>(&mut self, command: &[W], shaped: &mut [W]) -> Result<(), LengthError> {
        if command.len() != shaped.len() {
            return Err(LengthError {
                command: command.len(),
                shaped: shaped.len(),
            });
        }
        let (fraction, word_bits) = (self.config.coefficient_fraction(), self.config.word_bits());
        let reach = self.ring.len() - 1;
        // The ring unrolled, so that a tap reads one slice: the history, the oldest sample first, and the samples of a piece.
        let piece = PIECE_SAMPLES.max(reach);
        let mut line = vec![0; reach + piece];
        for (age, word) in line[..reach].iter_mut().rev().enumerate() {
            *word = self.ring[self.head.wrapping_sub(age) & reach];
        }
        let mut sums = vec![0; piece];
        for (command, shaped) in command.chunks(piece).zip(shaped.chunks_mut(piece)) {
            let taken = command.len();
            for (word, x) in line[reach..].iter_mut().zip(command) {
                *word = wrap(x.to_word(), word_bits);
            }
            let sums = &mut sums[..taken];
            sums.fill(0);
            for taps in self.taps.chunks(TAPS_AT_ONCE) {
                add_products(sums, taps, |delay| &line[reach - delay..][..taken]);
            }
            for (y, sum) in shaped.iter_mut().zip(sums) {
                let (word, clamped) = round_and_saturate(*sum, fraction, word_bits);
                self.saturated |= clamped;
                *y = W::from_word(word);
            }
            line.copy_within(taken..taken + reach, 0);
        }
        for (age, word) in line[..reach].iter().rev().enumerate() {
            self.ring[self.head.wrapping_sub(age) & reach] = *word;
        }
        Ok(())
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

/// Number of samples that [`SampleShaper::shape`] takes at once, or as many as the ring holds: they and their sums stay in the processor's
/// cache.
const PIECE_SAMPLES: usize = 2048;
/// Number of taps whose products are added before a sum is stored.
const TAPS_AT_ONCE: usize = 4;

/// Adds the products of up to [`TAPS_AT_ONCE`] taps to the sums of a piece; `delayed` has the samples of a piece, delayed.
fn add_products<'a>(sums: &mut [i64], taps: &[(usize, i64)], delayed: impl Fn(usize) -> &'a [i64]) {
    if let [(a, of_a), (b, of_b), (c, of_c), (d, of_d)] = taps {
        let late = delayed(*a).iter().zip(delayed(*b)).zip(delayed(*c)).zip(delayed(*d));
        for (sum, (((a, b), c), d)) in sums.iter_mut().zip(late) {
            *sum += of_a * a + of_b * b + of_c * c + of_d * d;
        }
        return;
    }
    for (delay, coefficient) in taps {
        for (sum, x) in sums.iter_mut().zip(delayed(*delay)) {
            *sum += coefficient * x;
        }
    }
}

/// A type in which command words are stored.
pub trait CommandWord: Copy {
    /// The word as the model computes with it.
    fn to_word(self) -> i64;

    /// Stores a word, which has 32 bits at most.
    fn from_word(word: i64) -> Self;
}

impl CommandWord for i64 {
    fn to_word(self) -> i64 {
        self
    }

    fn from_word(word: i64) -> Self {
        word
    }
}

impl CommandWord for i32 {
    fn to_word(self) -> i64 {
        self.into()
    }

    fn from_word(word: i64) -> Self {
        word as i32
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
