//! The motion shaper sample by sample, without the clocks.

use super::config::{CHANNELS_MAX, ShaperConfig};
use super::finish;
use super::ports::swap_how;
use super::sample::{LoadError, loadable};
use super::tables::Tables;
use super::wrap;
use posicast_taps::TapTable;
use std::sync::Arc;

/// A swap in progress.
#[derive(Debug, Clone)]
struct Change {
    table: Arc<TapTable>,
    how: u8,
}

/// The motion shaper sample by sample, with its channels, handover and modulo axis. It gives the results of
/// [`super::Shaper`] where strobes come slowly enough.
///
/// Unlike that model, this one fills its ring buffers at a start instead of knowing their age, and never ends a
/// handover: it keeps the old table for as long as one of its taps reaches behind the change.
///
/// [`Self::push`] and [`Self::swap_shared`] allocate nothing, and free nothing while the caller holds [`Self::active`] of the
/// beginning and all tables that it swaps to: a real-time thread can call both.
#[derive(Debug, Clone)]
pub struct MotionShaper {
    config: ShaperConfig,
    rings: Vec<Vec<i64>>,
    head: usize,
    active: Arc<TapTable>,
    before: Option<(Arc<TapTable>, u32)>,
    change: Option<Change>,
    saturated: bool,
}

impl MotionShaper {
    /// A shaper after reset: start values 0, the machine's table active.
    pub fn new(config: &ShaperConfig) -> Self {
        Self {
            rings: vec![vec![0; 1 << config.ring_address_bits()]; config.channels()],
            head: 0,
            active: Arc::new(config.table().clone()),
            before: None,
            change: None,
            saturated: false,
            config: config.clone(),
        }
    }

    /// Restarts: all samples before now count as `words` (wrapped to the word width). Returns the outputs after
    /// that.
    pub fn start(&mut self, words: [i64; CHANNELS_MAX]) -> [i64; CHANNELS_MAX] {
        let mut outputs = [0; CHANNELS_MAX];
        for ((ring, word), output) in self.rings.iter_mut().zip(words).zip(&mut outputs) {
            *output = wrap(word, self.config.word_bits());
            ring.fill(*output);
        }
        self.before = None;
        outputs
    }

    /// Takes one sample of every channel and returns the shaped one: position, velocity, acceleration; 0 for channels
    /// that do not exist.
    pub fn push(&mut self, words: [i64; CHANNELS_MAX]) -> [i64; CHANNELS_MAX] {
        self.change_table();
        let mask = (1usize << self.config.ring_address_bits()) - 1;
        self.head = (self.head + 1) & mask;
        let mut outputs = [0; CHANNELS_MAX];
        let tables = Tables {
            active: self.active.taps(),
            handover: self.before.as_ref().map(|(table, since)| (table.taps(), *since)),
            unity: 1 << self.config.coefficient_fraction(),
        };
        for (channel, ring) in self.rings.iter_mut().enumerate() {
            ring[self.head] = wrap(words[channel], self.config.word_bits());
            let sample = |delay: u32| ring[self.head.wrapping_sub(delay as usize) & mask];
            let (y, clamped) = finish(&self.config, channel, &tables, sample);
            outputs[channel] = y;
            self.saturated |= clamped;
        }
        outputs
    }

    /// Makes another table active in the way `how` (one of [`swap_how`]; other values mean at once). A swap in progress is
    /// dropped and a handover cut short, whereas the hardware would refuse the swap; see [`Self::changes`].
    ///
    /// # Errors
    /// [`LoadError`] where the shaper cannot hold the table; the active table then stays.
    pub fn swap(&mut self, table: &TapTable, how: u8) -> Result<(), LoadError> {
        self.swap_shared(&Arc::new(table.clone()), how)
    }

    /// As [`Self::swap`], of a table that the caller keeps.
    ///
    /// # Errors
    /// [`LoadError`] where the shaper cannot hold the table; the active table then stays.
    pub fn swap_shared(&mut self, table: &Arc<TapTable>, how: u8) -> Result<(), LoadError> {
        loadable(&self.config, table)?;
        self.change = Some(Change {
            table: Arc::clone(table),
            how,
        });
        Ok(())
    }

    /// The active table.
    pub fn active(&self) -> &Arc<TapTable> {
        &self.active
    }

    /// Whether a swap waits or hands over; while it does, the hardware refuses the next.
    pub fn changes(&self) -> bool {
        self.change.is_some() || self.before.is_some()
    }

    /// Whether any sample since [`Self::new`] was clamped.
    pub fn saturated(&self) -> bool {
        self.saturated
    }

    fn change_table(&mut self) {
        if let Some((before, since)) = self.before.take() {
            let reach = before.longest_delay_samples().max(self.active.longest_delay_samples());
            self.before = (since < reach).then_some((before, since + 1));
        }
        let Some(change) = self.change.take() else {
            return;
        };
        let reach = self
            .active
            .longest_delay_samples()
            .max(change.table.longest_delay_samples());
        if change.how == swap_how::WHEN_SETTLED && !self.still_for(reach) {
            self.change = Some(change);
            return;
        }
        let before = std::mem::replace(&mut self.active, change.table);
        self.before = (change.how == swap_how::HANDOVER && reach > 0).then_some((before, 1));
    }

    /// Whether the last sample of the position equals the `samples` before it.
    fn still_for(&self, samples: u32) -> bool {
        let ring = &self.rings[0];
        let mask = ring.len() - 1;
        let back = |delay: u32| ring[self.head.wrapping_sub(delay as usize) & mask];
        (1..=samples).all(|delay| back(delay) == back(0))
    }
}
